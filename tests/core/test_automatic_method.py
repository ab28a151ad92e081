"""`method="auto"`: what it takes for typical models, that what it says is so, and that it is the method it took."""

from dataclasses import replace

import numpy as np
import pytest
from tlismni.core import (
    AppliedForce2D,
    Bushing2D,
    Constant,
    CoulombFriction,
    Disk2D,
    DiskOnSegment2D,
    EquationSystem,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    Ramp,
    RigidBody2D,
    Segment2D,
    Simulation,
    compile_model,
    simulate,
)
from tlismni.core.methods.automatic import METHOD_NAMES, Start, choose, described
from tlismni.core.methods.default import DEFAULT_METHOD
from tlismni.core.methods.registry import METHODS
from tlismni.core.simulation.start_figures import measure_start
from tlismni.core.state.workspace_records import control_of
from tlismni.models import load

SMOOTH, STOPPED, CABLE = "chain", "pendulum_stop", "cable_pendulum"


def chosen(name, rtol, **parameters):
    return Simulation(load(name, **parameters).model, "auto", rtol, record=False).settings


@pytest.mark.parametrize("name", [SMOOTH, "slider_crank", "heavy_top", "universal_pendulum", "bricard"])
@pytest.mark.parametrize("rtol, order", [(1e-3, 6), (1e-6, 6), (1e-9, 8)])
def test_smooth_mechanisms_are_solved_with_one_stage_a_step(name, rtol, order):
    settings = chosen(name, rtol)
    assert (settings.method, settings.method_options) == ("adams", {"order": order})
    assert "nothing is stiff or damped" in settings.method_chosen or "resolve decay" in settings.method_chosen


@pytest.mark.parametrize(
    "name, method, words",
    [
        (STOPPED, "adams", "nothing is stiff"),
        ("rod_wall", "adams", "impacts excite vibrations"),
        ("dropped_box", "irk", "8 contacts"),
        ("cable_ground", "irk", "8 contacts"),
        ("sphere_beam", "irk", "force laws"),
    ],
)
def test_contacts_decide_by_their_number_and_what_they_excite(name, method, words):
    settings = chosen(name, 1e-6)
    assert settings.method == method and words in settings.method_chosen


def test_impacts_on_a_fine_mesh_are_met_with_a_formula_that_is_stable_with_any_step():
    mesh = Start(contacts=1, rate=1.0, vibration=1e5, slowest=1e2, waves=True)
    rod, damped = replace(mesh, slowest=1e5), replace(mesh, vibration=1e3, decay=1e4)
    taken = [choose(start, 1e-6) for start in (mesh, rod, damped)]
    assert [choice.method for choice in taken] == ["irk", "adams", "irk"]
    assert "100 to 1e+05 rad/s" in taken[0].reason and "decay of up to 1e+04" in taken[2].reason


@pytest.mark.parametrize(
    "elements, rtol, taken",
    [
        (8, 1e-2, "adams"),
        (128, 1e-3, "irk"),
        (512, 1e-3, "irk"),
        (32, 1e-2, "irk"),
        (32, 1e-6, "adams"),
        (64, 1e-3, "adams"),
        (64, 1e-2, "irk"),
        (128, 1e-4, "adams"),
    ],
)
def test_waves_of_a_mesh_are_followed_only_where_the_tolerance_does(elements, rtol, taken):
    settings = chosen(CABLE, rtol, elements=elements)
    assert settings.method == taken
    assert "vibrations" in settings.method_chosen


def test_stiff_springs_and_dampers_ask_for_formulas_that_are_stable_with_any_step():
    soft, stiff = chosen("slider_crank", 1e-3), chosen("slider_crank", 1e-3, bushing_stiffness=1e8)
    assert (soft.method, stiff.method) == ("adams", "irk")
    start = Start(rate=1.0, decay=1e5)
    choice = choose(start, 1e-6)
    assert choice.method == "ebdf" and "decay of up to 1e+05 1/s dies out" in choice.reason


@pytest.mark.parametrize("name, elements", [("chain", None), (CABLE, 8), (CABLE, 64), ("heavy_top", None)])
def test_it_measures_what_runs_measure(name, elements):
    model = load(name, **({"elements": elements} if elements else {})).model
    run, start = Simulation(model, record=False), measure_start(model.assemble(t0=0.0), 0.0)
    assert start.rate == pytest.approx(run.scales.rate, rel=0.2)
    assert start.vibration**2 == pytest.approx(control_of(run.workspace.arrays["control"]).stiffness_scale, rel=1e-6)
    assert start.waves == run.assembly.has_waves


@pytest.mark.parametrize("name, rtol", [(SMOOTH, 1e-6), ("dropped_box", 1e-4), (CABLE, 1e-2)])
def test_results_are_those_of_the_method_it_took(name, rtol):
    model = load(name).model
    auto = simulate(model, 0.1, "auto", rtol)
    said = auto.settings
    given = simulate(model, 0.1, said["method"], rtol, **said["method_options"])
    assert np.array_equal(auto.samples, given.samples, equal_nan=True)
    assert auto.method_chosen.startswith(said["method"]) and given.method_chosen == ""
    assert auto.method_chosen in str(auto)


@pytest.mark.parametrize("rtol", [1e-3, 1e-6, 1e-9])
def test_contacts_are_solved_with_order_five_or_ebdf(rtol):
    settings = chosen(STOPPED, rtol)
    expected = ("adams", {"order": 5}) if rtol > 1e-7 else ("ebdf", {})
    assert (settings.method, settings.method_options) == expected


@pytest.mark.parametrize("rtol", [1e-6, 1e-8, 1e-10])
def test_a_wheel_rolls_over_the_end_of_a_ledge_within_the_tolerance(rtol):
    """Its acceleration jumps there, without an event: 3/4 v^2 + g h is constant whatever the steps are. At the first of
    these speeds Adams formulas of orders 6 and 8 erred by up to 70 times
    a tolerance of 1e-6 while their starting formula did not see the jump."""
    radius, rng = 0.2, np.random.default_rng(5)
    for speed in (0.498, 0.607, 0.656, 0.674, 0.68, 0.684, 0.685, *rng.uniform(0.3, 0.9, 5)):
        wheel = RigidBody2D(
            name="wheel", mass=2.0, inertia=radius**2, position=(0.8, radius), velocity=(speed, 0.0),
            angular_velocity=-speed / radius,
        )  # fmt: skip
        ledge = DiskOnSegment2D(
            name="ledge", segment=Segment2D(length=1.0), disk=Disk2D(marker=Marker2D(body="wheel"), radius=radius),
            law=NewtonImpact(restitution=0.0), friction=CoulombFriction(coefficient=2.0),
        )  # fmt: skip
        run = simulate(Model(bodies=[wheel], contacts=[ledge]), 0.2 / speed + 0.2, rtol=rtol, atol=1e-2 * rtol)
        slips = [event.t for event in run.events if event.kind == "slip"]
        rolls = run.t < min([*slips, np.inf])
        energy = 0.75 * (run["wheel.vx"] ** 2 + run["wheel.vy"] ** 2) + 9.81 * (run["wheel.y"] - radius)
        assert np.abs(energy[rolls] / (0.75 * speed**2) - 1.0).max() < 6.0 * rtol


def test_states_are_of_the_method_whoever_chose_it():
    model = load(STOPPED).model
    auto, given = Simulation(model, "auto", 1e-4), Simulation(model, "adams", 1e-4, order=5)
    auto.advance(0.3)
    given.restore(auto.state())
    auto.advance(0.6)
    given.advance(0.6)
    assert auto.sample().tobytes() == given.sample().tobytes()


def test_a_compiled_model_chooses_once():
    compiled = compile_model(load("slider_crank", bushing_stiffness=1e8).model, "auto", 1e-3)
    runs = [compiled.simulation(), compiled.simulation(start={"slider.vy": 0.0})]
    assert {run.settings.method for run in runs} == {"irk"}
    assert len({run.settings.method_chosen for run in runs}) == 1


def test_equations_of_the_users_own():
    def system(stiffness):
        return EquationSystem(
            mass=lambda t, q: np.eye(1), force=lambda t, q, v: -stiffness * q + np.array([1.0]), q0=[2.0], v0=[0.0]
        )

    assert Simulation(system(1.0), "auto", 1e-4).settings.method == "adams"


def test_fixed_steps_and_other_outer_loops_take_ebdf():
    model = load(SMOOTH).model
    for options, word in (({"step": 1e-3}, "fixed"), ({"outer": "jfnk"}, "jfnk")):
        settings = Simulation(model, "auto", **options).settings
        assert settings.method == "ebdf" and word in settings.method_chosen


@pytest.mark.parametrize("options", [{"k": 3}, {"k": "auto", "angle": 80.0}, {"k": 2, "step": 1e-3}])
def test_an_option_of_ebdf_means_ebdf_as_when_that_was_the_default(options):
    model = load(SMOOTH).model
    found, given = simulate(model, 0.1, **options), simulate(model, 0.1, "ebdf", **options)
    assert found.method_chosen.startswith("ebdf (k=") and np.array_equal(found.samples, given.samples, equal_nan=True)
    with pytest.raises(ModelError, match="k"):
        simulate(model, 0.1, k=100)


def test_options_of_other_methods_are_refused_and_owners_named():
    with pytest.raises(ModelError, match=r"'auto' has no option \['order'\].*\['bdf', 'adams'\]"):
        simulate(load(SMOOTH).model, 0.1, order=3)


def test_it_is_the_default():
    model = load(SMOOTH).model
    assert DEFAULT_METHOD == "auto" and simulate(model, 0.1).method_chosen.startswith("adams (order=6)")
    assert Simulation(model).settings.method == compile_model(model).simulation().settings.method == "adams"
    assert load(SMOOTH).method == "auto"


def test_what_rests_at_first_is_looked_at_when_it_has_begun():
    """A stiff bushing that a late force bends slowly: at the start nothing moves."""

    def start(force):
        body = RigidBody2D(name="body", mass=1.0, inertia=0.1)
        bushing = Bushing2D(name="bushing", a=Marker2D(), b=Marker2D(body="body"), stiffness=1e8)
        load_later = AppliedForce2D(name="force", marker=Marker2D(body="body"), force_x=force)
        model = Model(name="late", gravity=(0.0, 0.0), bodies=[body], forces=[bushing, load_later])
        return measure_start(model.assemble(t0=0.0), 0.0)

    still, late = start(Constant(value=0.0)), start(Ramp(start=0.5, duration=1.0, after=10.0))
    assert still.rate == 0.0 and "all rests" in choose(still, 1e-6).reason
    assert late.rate > 0.0 and choose(late, 1e-3).method == choose(still, 1e-3).method == "irk"


def test_friction_that_is_nearly_dry_is_seen_while_it_slides():
    def start(v):
        system = EquationSystem(
            mass=np.eye(1), force=lambda t, q, v: np.array([-np.tanh(1e4 * v[0])]), q0=[0.0], v0=[v], coordinates=["x"]
        )
        return measure_start(system.assemble(), 0.0)

    assert start(1.0).decay == pytest.approx(1e4, rel=1e-6) == start(0.0).decay
    assert choose(start(1.0), 1e-6).method == "ebdf"


def test_measuring_leaves_no_trace_in_the_run():
    model = load(CABLE).model
    auto, given = Simulation(model, "auto", 1e-6), Simulation(model, "adams", 1e-6, order=6)
    assert auto.state() == given.state() and auto.stats == given.stats


def test_a_start_that_cannot_be_measured_is_said_and_left_to_ebdf():
    """Constant power: no finite force at rest, where the measurement looks too."""
    system = EquationSystem(
        mass=np.eye(1), force=lambda t, q, v: np.array([1.0 / v[0]]), q0=[0.0], v0=[1.0], coordinates=["x"]
    )
    result = simulate(system, 4.0, rtol=1e-8)
    assert result.settings["method"] == "ebdf"
    assert "could not be measured (FloatingPointError: forces or constraints at t = 0 s" in result.method_chosen
    assert result["x"][-1] == pytest.approx((9.0**1.5 - 1.0) / 3.0, rel=1e-6)


def test_it_is_listed_last_so_that_numbers_of_others_stay():
    assert METHOD_NAMES[-1] == "auto" and described("auto").options == METHODS["ebdf"].options
