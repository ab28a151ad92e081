"""Wrong input is refused with a message that names it, before anything is computed."""

import json
import math

import numpy as np
import pytest
from helpers import GROUND, ball_over_floor, circle_pendulum, floor_contact, on, point_pendulum, rod_pendulum
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    Bushing2D,
    Bushing3D,
    ConsistencyError,
    Constant,
    CoordinateDriver,
    Disk2D,
    DiskOnDisk2D,
    Distance2D,
    EquationError,
    EquationSystem,
    Flores,
    Gonthier,
    Input,
    InputSignal,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    Parameter,
    PointMass2D,
    Polynomial,
    Revolute2D,
    RigidBody2D,
    Simulation,
    SimulationError,
    SpringDamper2D,
    Table,
    simulate,
)
from tlismni.models import load

NAN, INF = math.nan, math.inf


@pytest.mark.parametrize(
    "arguments, word",
    [
        ({"method": "runge"}, "runge"),
        ({"method": ""}, "unknown method"),
        ({"alpha": -0.1}, "alpha"),
        ({"method": "hht", "alpha": 0.5}, "alpha"),
        ({"method": "hht", "alpha": NAN}, "alpha"),
        ({"k": 9}, "k"),
        ({"k": 2.5}, "whole"),
        ({"k": "4"}, "number"),
        ({"k": True}, "number"),
        ({"method": "bdf", "order": 7}, "order"),
        ({"method": "bdf", "order": 0}, "order"),
        ({"step": -0.1}, "step"),
        ({"step": 0.0}, "step"),
        ({"step": NAN}, "step"),
        ({"step": INF}, "step"),
        ({"step": "0.1"}, "step"),
        ({"max_step": 0.0}, "max_step"),
        ({"first_step": -1.0}, "first_step"),
        ({"rtol": 0.0}, "rtol"),
        ({"rtol": -1e-6}, "rtol"),
        ({"rtol": NAN}, "rtol"),
        ({"rtol": 1e-18}, "rtol"),
        ({"atol": 0.0}, "atol"),
        ({"atol": INF}, "atol"),
        ({"outer": "picard"}, "picard"),
        ({"newton_tolerance": 0.0}, "newton_tolerance"),
        ({"start_tolerance": -1.0}, "start_tolerance"),
        ({"t0": NAN}, "t0"),
        ({"t0": 2.0}, "t0"),
        ({"t_eval": [0.5, 0.2]}, "t_eval"),
        ({"t_eval": [0.5, 1.5]}, "t_eval"),
        ({"t_eval": [-0.5, 0.5]}, "t_eval"),
        ({"t_eval": [0.5, NAN]}, "t_eval"),
        ({"t_eval": [[0.5]]}, "t_eval"),
        ({"t_eval": ["a"]}, "t_eval"),
    ],
)
def test_bad_argument_of_simulate_is_named(arguments, word):
    with pytest.raises(ModelError, match=word):
        simulate(point_pendulum(), 1.0, **arguments)


@pytest.mark.parametrize("t_end", [NAN, INF, "1", None, True, -1.0])
def test_bad_end_time_is_named(t_end):
    with pytest.raises(ModelError, match="t_end"):
        simulate(point_pendulum(), t_end)


def test_no_time_at_all_gives_the_start():
    result = simulate(point_pendulum(0.3), 0.0)
    assert len(result) >= 1 and result.t[-1] == 0.0
    assert len(simulate(point_pendulum(0.3), 1.0, t_eval=[])) == 0


@pytest.mark.parametrize(
    "build, word",
    [
        (lambda: PointMass2D(name="p", mass=-1.0), "mass"),
        (lambda: PointMass2D(name="p", mass=0.0), "mass"),
        (lambda: PointMass2D(name="p", mass=NAN), "mass"),
        (lambda: PointMass2D(name="p", mass=INF), "mass"),
        (lambda: PointMass2D(name="p", mass=1.0, position=(NAN, 0.0)), "position"),
        (lambda: PointMass2D(name="p", mass=1.0, velocity=(0.0, INF)), "velocity"),
        (lambda: PointMass2D(name="p", mass=1.0, position=(0.0,)), "position"),
        (lambda: PointMass2D(name="1p", mass=1.0), "name"),
        (lambda: PointMass2D(name="p.x", mass=1.0), "name"),
        (lambda: PointMass2D(name="", mass=1.0), "name"),
        (lambda: PointMass2D(name="p"), "mass"),
        (lambda: PointMass2D(name="p", mass=1.0, weight=3.0), "weight"),
        (lambda: RigidBody2D(name="b", mass=1.0, inertia=0.0), "inertia"),
        (lambda: RigidBody2D(name="b", mass=1.0, inertia=1.0, angle=NAN), "angle"),
        (lambda: Distance2D(name="d", a=GROUND, b=on("p"), length=0.0), "length"),
        (lambda: SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=-1.0, natural_length=1.0), "stiffness"),
        (
            lambda: SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=1.0, natural_length=1.0, damping=-1.0),
            "damping",
        ),
        (lambda: Bushing2D(name="s", a=GROUND, b=on("p"), stiffness=-1.0), "stiffness"),
        (lambda: Bushing2D(name="s", a=GROUND, b=on("p"), stiffness=1.0, damping=-1.0), "damping"),
        (lambda: Bushing2D(name="s", a=GROUND, b=on("p"), stiffness=1.0, rotational_damping=NAN), "rotational_damping"),
        (lambda: NewtonImpact(restitution=1.1), "restitution"),
        (lambda: NewtonImpact(restitution=-0.1), "restitution"),
        (lambda: NewtonImpact(restitution=NAN), "restitution"),
        (lambda: Flores(stiffness=1e5, restitution=0.0), "restitution"),
        (lambda: Gonthier(stiffness=0.0, restitution=0.5), "stiffness"),
        (lambda: Flores(stiffness=1e5, restitution=0.5, exponent=-1.0), "exponent"),
        (lambda: Disk2D(marker=on("p"), radius=-0.1), "radius"),
        (lambda: Table(times=(0.0, 1.0, 1.0, 2.0), values=(0.0, 0.0, 0.0, 0.0)), "times"),
        (lambda: Table(times=(0.0, 1.0, 2.0, 3.0), values=(0.0,) * 5), "values"),
        (lambda: Polynomial(coefficients=()), "coefficients"),
        (
            lambda: Model(
                bodies=[P], joints=[CoordinateDriver(name="d", body="p", coordinate="z", motion=Constant(value=0.0))]
            ),
            r"'d' acts on coordinate 'z' of 'p', but a PointMass2D has only \['x', 'y'\]",
        ),
        (lambda: PointMass2D(name="p", mass="3"), r"mass: a number is needed, not the text '3'"),
        (lambda: PointMass2D(name="p", mass=True), "mass: a number is needed, not the truth value True"),
        (lambda: PointMass2D(name="p", mass=np.True_), "mass: .*truth value"),
        (lambda: PointMass2D(name="p", mass=1.0, position=(0.0, "1")), r"position\.1: .*text '1'"),
        (lambda: Polynomial(coefficients=[0.0, False]), r"coefficients\.1: .*False"),
        (lambda: Parameter(name="m", minimum="0", targets=["p.mass"]), "minimum: .*text '0'"),
        (
            lambda: Parameter(name="m", minimum=2.0, maximum=1.0, targets=["p.mass"]),
            "'m' has minimum 2 above maximum 1",
        ),
    ],
)
def test_bad_field_of_a_record_is_named(build, word):
    with pytest.raises(ValueError, match=word):
        build()


@pytest.mark.parametrize(
    ("stiffness", "words"),
    [((1.0, 2.0, 3.0), ["stiffness.3: it is missing", "stiffness.5: it is missing"]),
     (((1.0, 2.0, 3.0, 4.0, 5.0, "6"), *((1.0,) * 6,) * 5), ["stiffness.0.5: a number is needed, not the text '6'"])],
)  # fmt: skip
def test_a_field_of_several_forms_says_what_the_nearest_form_needs(stiffness, words):
    """Stiffnesses of a bushing are six numbers or six rows of six; the types of both are not spelled out."""
    with pytest.raises(ModelError) as refused:
        Bushing3D(name="mount", a=Marker3D(), b=Marker3D(body="block"), stiffness=stiffness)
    assert all(word in str(refused.value) for word in words)
    assert "tuple" not in str(refused.value)
    assert len(refused.value.problems) < 4


def test_whole_numbers_and_numbers_of_numpy_are_numbers():
    body = PointMass2D(name="p", mass=2, position=[0, np.float32(0.5)], velocity=(np.int64(1), np.float64(2.0)))
    assert (body.mass, body.position, body.velocity) == (2.0, (0.0, 0.5), (1.0, 2.0))
    assert all(type(x) is float for x in (body.mass, *body.position, *body.velocity))


@pytest.mark.parametrize("mass", ['"3"', "true"])
def test_text_or_truth_value_for_a_number_in_a_model_file_is_named(mass):
    text = f'{{"bodies": [{{"type": "PointMass2D", "name": "p", "mass": {mass}}}]}}'
    with pytest.raises(ModelError, match=r"PointMass2D 'p': mass: a number is needed"):
        Model.from_json(text)


@pytest.mark.parametrize("value", ["2", True, None])
def test_new_value_of_a_parameter_must_be_a_number(value):
    model = Model(bodies=[P], parameters=[Parameter(name="m", minimum=0.5, targets=["p.mass"])])
    with pytest.raises(ModelError, match=f"parameter 'm' = {value!r}: a number is needed"):
        model.with_parameters({"m": value})


P = PointMass2D(name="p", mass=1.0, position=(1.0, 0.0))


@pytest.mark.parametrize(
    "parts, word",
    [
        ({"bodies": [P, P]}, "p"),
        ({"bodies": [P], "joints": [Distance2D(name="p", a=GROUND, b=on("p"), length=1.0)]}, "unique"),
        ({"bodies": [P], "joints": [Distance2D(name="d", a=GROUND, b=on("nobody"), length=1.0)]}, "nobody"),
        ({"bodies": [P], "contacts": [floor_contact(NewtonImpact(restitution=0.5), body="nobody")]}, "nobody"),
        ({"bodies": [P], "forces": [AppliedForce2D(name="f", marker=on("nobody"))]}, "nobody"),
        ({"bodies": [P], "forces": [AppliedForce2D(name="f", marker=on("p", 0.1))]}, "extension"),
        (
            {"joints": [CoordinateDriver(name="d", body="nobody", coordinate="x", motion=Constant(value=0.0))]},
            r"'d' refers to body 'nobody', which does not exist",
        ),
        (
            {"bodies": [P], "forces": [AppliedForce2D(name="f", marker=on("p"), force_x=InputSignal(channel="u"))]},
            "u",
        ),
        ({"bodies": [P], "inputs": [Input(name="p")]}, "unique"),
        ({"bodies": [P], "parameters": [Parameter(name="m", targets=["p.weight"])]}, "weight"),
        ({"bodies": [P], "parameters": [Parameter(name="m", targets=["q.mass"])]}, "q.mass"),
        ({"bodies": [P], "parameters": [Parameter(name="m", targets=["p.type"])]}, "no number"),
        (
            {"bodies": [P], "parameters": [Parameter(name="m", maximum=0.5, targets=["p.mass"])]},
            r"'m' = 1\.0 is outside its range \[-inf, 0\.5\]",
        ),
        ({"bodies": [PointMass2D(name="ground", mass=1.0)]}, "ground"),
        ({"bodies": [PointMass2D(name="energy", mass=1.0)]}, "energy"),
        ({"bodies": [P], "gravity": (0.0, NAN)}, "gravity"),
        ({"bodies": [{"type": "Sphere", "name": "s"}]}, "Sphere"),
        ({"bodies": [P], "springs": []}, "springs"),
        ({"format": "tlismni-model-9"}, "format"),
    ],
)
def test_bad_model_names_what_is_wrong(parts, word):
    with pytest.raises(ModelError, match=word):
        Model(**parts)


@pytest.mark.parametrize(
    "element, kind",
    [
        (CoordinateDriver(name="turn", body="p", coordinate="angle", motion=Constant(value=0.0)), "joints"),
        (AppliedTorque2D(name="turn", body="p", torque=Constant(value=1.0)), "forces"),
    ],
)
def test_what_turns_a_point_mass_is_refused(element, kind):
    with pytest.raises(ModelError, match=r"'turn'.* 'angle' of 'p'.*PointMass2D has only \['x', 'y'\]"):
        Model(bodies=[P], **{kind: [element]})


def test_driver_of_the_ground_is_refused():
    driver = CoordinateDriver(name="quake", body="ground", coordinate="x", motion=Constant(value=0.0))
    with pytest.raises(ModelError, match=r"'quake'.*ground, which does not move"):
        Model(bodies=[P], joints=[driver])


@pytest.mark.parametrize("offset", [0.0, 1e-14])
def test_spring_of_length_zero_is_named_with_the_positions(offset):
    """Its direction is undefined: no silent NaN, and no riddle about a singular matrix."""
    half_turn = RigidBody2D(name="b", mass=1.0, inertia=1.0, position=(2.0 + offset, 1.0), angle=math.pi)
    anchor = Marker2D(point=(1.5, 1.0))
    spring = SpringDamper2D(name="s", a=anchor, b=on("b", 0.5), stiffness=1.0, natural_length=1.0)
    with pytest.raises(ConsistencyError, match=r"spring 's'.*'ground' is at \(1\.5, 1\).*'b' at \(1\.5, 1\)"):
        simulate(Model(bodies=[half_turn], forces=[spring]), 1.0)


def test_short_spring_is_no_spring_of_length_zero():
    body = PointMass2D(name="p", mass=1.0, position=(1e-6, 0.0))
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=1.0, natural_length=1e-6)
    result = simulate(Model(bodies=[body], forces=[spring], gravity=(0.0, 0.0)), 1.0)
    assert result["p.x"] == pytest.approx(1e-6, rel=1e-9)


# ---- starts ------------------------------------------------------------------------------------------


def test_second_identical_joint_is_named_as_redundant():
    again = Revolute2D(name="again", a=GROUND, b=on("rod", -0.5))
    with pytest.raises(ConsistencyError, match=r"'(again|pin)' is redundant: it repeats what (pin|again)"):
        simulate(rod_pendulum(joints=[again]), 1.0, redundant="refuse")


def test_contradictory_joints_are_named():
    other = Distance2D(name="other", a=GROUND, b=on("bob"), length=1.2)
    model = point_pendulum(0.3)
    with pytest.raises(ConsistencyError, match="other"):
        simulate(model.model_copy(update={"joints": (*model.joints, other)}), 1.0)


def test_contact_of_a_body_with_itself_is_refused():
    contact = DiskOnDisk2D(
        name="c",
        a=Disk2D(marker=on("p"), radius=0.1),
        b=Disk2D(marker=on("p"), radius=0.1),
        law=NewtonImpact(restitution=1.0),
    )
    with pytest.raises(ModelError, match="'c' are on 'p'"):
        simulate(Model(bodies=[P], contacts=[contact]), 1.0)


@pytest.mark.parametrize("step", [1e-20, 1e-14])
def test_steps_without_end_are_refused(step):
    with pytest.raises(ModelError, match="steps from t0 to t_end"):
        simulate(Model(bodies=[P]), 1.0, step=step)


def test_inputs_are_all_checked_before_any_is_set():
    model = Model(bodies=[P], inputs=[Input(name="u")])
    sim = Simulation(model)
    with pytest.raises(ModelError, match="'z'"):
        sim.set_inputs({"u": 1.0, "z": 2.0})
    assert sim.workspace.arrays["inputs"][0, 0] == 0.0


def test_joint_between_ground_and_ground_is_named():
    nothing = Distance2D(name="nothing", a=GROUND, b=on("ground", 1.0), length=1.0)
    with pytest.raises(ConsistencyError, match="'nothing' is redundant: it constrains nothing"):
        simulate(Model(bodies=[P], joints=[nothing]), 1.0)


def test_start_far_off_the_constraints_is_refused_and_names_the_joint():
    rod = Distance2D(name="rod", a=GROUND, b=on("p"), length=0.5)
    with pytest.raises(ConsistencyError, match=r"positions q0.*'rod'"):
        simulate(Model(bodies=[P], joints=[rod]), 1.0)


def test_velocity_far_off_the_constraints_is_refused_and_names_the_joint():
    body = P.model_copy(update={"velocity": (1.0, 0.0)})
    rod = Distance2D(name="rod", a=GROUND, b=on("p"), length=1.0)
    with pytest.raises(ConsistencyError, match=r"velocities v0.*'rod'"):
        simulate(Model(bodies=[body], joints=[rod]), 1.0)


def test_start_slightly_off_is_moved_onto_the_constraints():
    body = PointMass2D(name="p", mass=1.0, position=(1.0 + 1e-5, 0.0), velocity=(1e-5, 2.0))
    rod = Distance2D(name="rod", a=GROUND, b=on("p"), length=1.0)
    result = simulate(Model(bodies=[body], joints=[rod]), 0.1)
    assert np.hypot(*result.q[0]) == pytest.approx(1.0, abs=1e-14)
    assert result.q[0] @ result.v[0] == pytest.approx(0.0, abs=1e-14)
    assert np.abs(result.q[0] - [1.0, 0.0]).max() < 2e-5 and abs(result.v[0][1] - 2.0) < 1e-4


def test_start_tolerance_decides_how_far_off_is_too_far():
    body = PointMass2D(name="p", mass=1.0, position=(1.05, 0.0))
    rod = Distance2D(name="rod", a=GROUND, b=on("p"), length=1.0)
    model = Model(bodies=[body], joints=[rod])
    with pytest.raises(ConsistencyError):
        simulate(model, 0.1)
    assert simulate(model, 0.1, start_tolerance=0.1).q[0] == pytest.approx([1.0, 0.0], abs=1e-14)


def test_correction_of_the_start_is_the_least_one_in_the_mass_norm():
    """A light and a heavy point on a rod of wrong length: the corrections are as the masses' inverses."""
    bodies = [
        PointMass2D(name="light", mass=1.0, position=(0.0, 0.0)),
        PointMass2D(name="heavy", mass=9.0, position=(1.0 + 1e-5, 0.0)),
    ]
    rod = Distance2D(name="rod", a=on("light"), b=on("heavy"), length=1.0)
    (q, *_) = simulate(Model(bodies=bodies, joints=[rod]), 0.01).q
    assert q[0] == pytest.approx(0.9e-5, rel=1e-4)
    assert q[2] == pytest.approx(1.0 + 0.9e-5, abs=1e-9)


def test_overlap_at_the_start_of_a_constraint_contact_is_refused():
    with pytest.raises(ConsistencyError, match=r"'floor'.*overlapping by 0\.1"):
        simulate(ball_over_floor(NewtonImpact(restitution=0.5), height=-0.1), 1.0)


def test_overlap_of_two_disks_at_the_start_is_refused():
    bodies = [P, PointMass2D(name="o", mass=1.0, position=(1.5, 0.0))]
    disks = [Disk2D(marker=on(body), radius=0.3) for body in ("p", "o")]
    contact = DiskOnDisk2D(name="knock", a=disks[0], b=disks[1], law=NewtonImpact(restitution=0.5))
    with pytest.raises(ConsistencyError, match=r"'knock'.*overlapping by 0\.1"):
        simulate(Model(bodies=bodies, contacts=[contact]), 1.0)


def test_body_without_mass_in_user_equations_is_reported():
    with pytest.raises((ConsistencyError, EquationError), match="mass"):
        simulate(EquationSystem(mass=np.zeros((1, 1)), force=np.ones(1), q0=[0.0], v0=[0.0]), 1.0)


def test_force_that_becomes_nan_stops_the_run_and_keeps_what_was_computed():
    def force(t, q, v):
        return np.array([1.0 if t < 0.5 else np.nan])

    system = EquationSystem(mass=np.eye(1), force=force, q0=[0.0], v0=[0.0])
    with pytest.raises(SimulationError, match="infinite or NaN") as caught:
        simulate(system, 1.0)
    assert caught.value.t == pytest.approx(0.5, abs=1e-9)
    partial = caught.value.partial
    assert partial.t[-1] == pytest.approx(0.5, abs=1e-9) and np.all(np.isfinite(partial.q))
    assert partial.q[-1, 0] == pytest.approx(0.125, abs=1e-6)


def test_error_in_a_user_function_comes_out_as_it_is():
    def force(t, q, v):
        if t > 0.3:
            raise ZeroDivisionError("my own mistake")
        return np.zeros(1)

    system = EquationSystem(mass=np.eye(1), force=force, q0=[0.0], v0=[1.0])
    with pytest.raises(ZeroDivisionError, match="my own mistake"):
        simulate(system, 1.0)


@pytest.mark.parametrize("value", [NAN, INF])
def test_input_that_is_no_number_is_refused(value):
    sim = Simulation(load("pendulum_stop").model)
    with pytest.raises(ModelError, match="torque"):
        sim.set_inputs({"torque": value})
    with pytest.raises(ModelError, match="there is no input 'force'"):
        sim.set_inputs({"force": 1.0})


def test_unknown_channel_names_the_nearest():
    result = simulate(point_pendulum(), 0.01)
    with pytest.raises(KeyError, match=r"bob\.vx"):
        result["bob.v_x"]


@pytest.mark.parametrize("system", [{"bodies": []}, None, "pendulum_stop"])
def test_what_is_no_system_is_refused(system):
    with pytest.raises(ModelError, match="EquationSystem"):
        simulate(system, 1.0)


def test_model_without_bodies_is_refused():
    with pytest.raises(ModelError, match="bodies"):
        simulate(Model(), 1.0)


def test_user_equations_with_redundant_constraints_are_reported():
    system = EquationSystem(
        mass=np.eye(2),
        force=np.zeros(2),
        constraint=lambda t, q: np.array([q[0] - 1.0, 2.0 * q[0] - 2.0]),
        q0=[1.0, 0.0],
        v0=[0.0, 1.0],
    )
    with pytest.raises(ConsistencyError, match=r"constraint\[[01]\]"):
        simulate(system, 1.0, redundant="refuse")


def test_user_equations_far_off_their_constraint_are_refused():
    system = circle_pendulum()
    system.q0[:] = [2.0, 0.0]
    with pytest.raises(ConsistencyError, match=r"constraint\[0\]"):
        simulate(system, 1.0)


@pytest.mark.parametrize("kind", ["AxialRod", "Cable2D"])
def test_more_elements_than_memory_holds_are_refused_at_the_door(kind):
    body = {"type": kind, "name": "rod", "elements": 10**9, "length": 1.0}
    with pytest.raises(ModelError, match=r"(?s)elements.*100000"):
        Model.from_json(json.dumps({"name": "m", "bodies": [body]}))
