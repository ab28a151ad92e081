"""`method="auto"`: what it takes for typical models, that what it says is so, and that it is the method it took."""

from dataclasses import replace

import numpy as np
import pytest
from tlismni.core import (
    EquationSystem,
    ModelError,
    Simulation,
    compile_model,
    simulate,
)
from tlismni.core.methods.automatic import METHOD_NAMES, Start, choose, described
from tlismni.core.simulation.start_figures import measure_start
from tlismni.core.state.workspace_records import STIFFNESS_SCALE
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
    [(8, 1e-2, "adams"), (128, 1e-3, "irk"), (512, 1e-3, "irk"), (32, 1e-2, "irk"), (32, 1e-6, "adams")],
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
    assert choice.method == "irk" and "decay of up to 1e+05 1/s" in choice.reason


@pytest.mark.parametrize("name, elements", [("chain", None), (CABLE, 8), (CABLE, 64), ("heavy_top", None)])
def test_it_measures_what_runs_measure(name, elements):
    model = load(name, **({"elements": elements} if elements else {})).model
    run, start = Simulation(model, record=False), measure_start(model.assemble(t0=0.0), 0.0)
    assert start.rate == pytest.approx(run.scales.rate, rel=0.2)
    assert start.vibration**2 == pytest.approx(run.workspace.arrays["control"][STIFFNESS_SCALE], rel=1e-6)
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


def test_states_are_of_the_method_whoever_chose_it():
    model = load(STOPPED).model
    auto, given = Simulation(model, "auto", 1e-4), Simulation(model, "adams", 1e-4, order=6)
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
            mass=lambda t, q: np.eye(1), force=lambda t, q, v: -stiffness * q + np.array([1.0]), q0=[1.0], v0=[0.0]
        )

    assert Simulation(system(1.0), "auto", 1e-4).settings.method == "adams"


def test_fixed_steps_and_other_outer_loops_take_the_default():
    model = load(SMOOTH).model
    for options, word in (({"step": 1e-3}, "fixed"), ({"outer": "jfnk"}, "jfnk")):
        settings = Simulation(model, "auto", **options).settings
        assert settings.method == "ebdf" and word in settings.method_chosen


def test_it_has_no_options():
    with pytest.raises(ModelError, match=r"'auto' has no option.*'k'.*options belong to the method"):
        simulate(load(SMOOTH).model, 0.1, "auto", k=3)


def test_it_is_listed_last_so_that_numbers_of_others_stay():
    assert METHOD_NAMES[-1] == "auto" and described("auto").options == {}
