"""The catalogue: names, parameters, errors, and models that start consistently."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core.assembly.evaluate import evaluate_residuals
from tlismni.core.assembly.workspace import Workspace
from tlismni.core.elements import Clamp2D, CoordinateDriver, Distance2D, Joint3D, PlanarFrame, Prismatic2D, Revolute2D
from tlismni.core.laws import KelvinVoigt
from tlismni.core.laws.damping_ratio import restitution_without_pull
from tlismni.core.multibody_model import Model
from tlismni.models import ScenarioError, catalogue, load, names
from tlismni.models.laws import LAW_NAMES, kelvin_voigt_damping_ratio
from tlismni.models.parameters import ScenarioParameter
from tlismni.validation.translation.kinematics import BodyStates, States, gap_motion

WITH_CONTACT = ("bouncing_ball", "impact_oscillator", "pendulum_stop", "double_pendulum_wall", "slider_crank_stop")


def start_states(model: Model) -> States:
    """The motion of all bodies with a frame at the start, as arrays of length 1."""
    bodies, records = {}, {b.name: b for b in model.bodies}
    for b in model.bodies:
        if not isinstance(b, PlanarFrame):
            continue
        q, v = b.start_in(records)
        values = (*(*q, 0.0)[:3], *(*v, 0.0)[:3])
        bodies[b.name] = BodyStates(*(np.array([x]) for x in values))
    return States(1, bodies)


def check_levels(model: Model) -> None:
    """All rows of Phi that are constraints hold at the start, with their rates."""
    workspace = Workspace(model.assemble())
    workspace.arrays["q"][: workspace.assembly.n] = workspace.assembly.q0
    workspace.arrays["v"][: workspace.assembly.n] = workspace.assembly.v0
    evaluate_residuals(workspace.record)
    active = workspace.structure.active
    assert np.abs(workspace.arrays["phi"][active]).max() < 1e-14
    assert np.abs(workspace.arrays["phid"][active]).max() < 1e-12


@pytest.mark.parametrize("name", names())
def test_every_scenario_survives_json(name: str) -> None:
    model = load(name).model
    assert Model.from_json(model.to_json()) == model


@pytest.mark.parametrize("name", names())
def test_every_scenario_starts_with_closed_joints_at_rest_or_consistent_speed(name: str) -> None:
    model = load(name).model
    states = start_states(model)
    for joint in model.joints:
        if isinstance(joint, Joint3D):
            check_levels(model)
            continue
        if isinstance(joint, CoordinateDriver):
            body = next(b for b in model.bodies if b.name == joint.body)
            k = body.coordinate_names.index(joint.coordinate)
            start, rate = joint.motion.coefficients[:2]
            assert [x[k] for x in body.initial_state()] == [start, rate]
            continue
        (ax, ay), (avx, avy) = states.point(joint.a)
        (bx, by), (bvx, bvy) = states.point(joint.b)
        dx, dy, dvx, dvy = bx - ax, by - ay, bvx - avx, bvy - avy
        if isinstance(joint, Revolute2D | Clamp2D):
            assert np.allclose([dx, dy, dvx, dvy], 0.0, atol=1e-14)
        elif isinstance(joint, Distance2D):
            assert np.allclose([np.hypot(dx, dy) - joint.length, dx * dvx + dy * dvy], 0.0, atol=1e-14)
        else:
            assert isinstance(joint, Prismatic2D) and joint.a.body == "ground"
            nx, ny = -math.sin(joint.a.angle), math.cos(joint.a.angle)
            turning = states.of(joint.b.body).angular_velocity
            assert np.allclose([nx * dx + ny * dy, nx * dvx + ny * dvy, turning], 0.0, atol=1e-14)


@pytest.mark.sampled(40)
@pytest.mark.parametrize("name", WITH_CONTACT)
@pytest.mark.parametrize("law", LAW_NAMES)
def test_every_law_starts_with_an_open_gap(name: str, law: str) -> None:
    model = load(name, law=law).model
    (contact,) = model.contacts
    shapes = (contact.plane, contact.disk)
    assert gap_motion(shapes, start_states(model)).gap[0] > 0.1


@pytest.mark.parametrize("law", LAW_NAMES)
def test_every_law_reaches_all_contacts_of_the_cradle(law: str) -> None:
    model = load("newtons_cradle", law=law, balls=4, gap=1e-3).model
    states = start_states(model)
    gaps = [gap_motion((c.a, c.b), states).gap[0] for c in model.contacts]
    assert gaps[0] > 0.01 and gaps[1:] == pytest.approx([1e-3] * 2)
    if law != "newton":
        laws = [c.law for c in model.with_parameters({"stiffness": 5e6}).contacts]
        assert [law.stiffness for law in laws] == [5e6] * 3


def test_all_parameters_stand_in_the_scenario_with_their_values() -> None:
    for entry in catalogue():
        scenario = load(entry.name)
        assert set(scenario.parameters) == {p.name for p in entry.parameters}
        assert all(p.unit and p.description for p in entry.parameters)
    changed = load("pendulum_stop", restitution=0.4, length=2.0)
    assert changed.parameters["restitution"] == 0.4
    assert changed.model.contacts[0].law.restitution == 0.4


def test_model_parameters_reach_the_law() -> None:
    model = load("pendulum_stop", law="flores").model
    assert model.with_parameters({"stiffness": 5e6}).contacts[0].law.stiffness == 5e6
    assert model.with_parameters({"restitution": 0.3}).contacts[0].law.restitution == 0.3


@pytest.mark.parametrize("start, stop", [(0.0, -math.pi / 2), (-math.pi, -math.pi / 2), (0.5, -1.0), (-2.5, -1.2)])
def test_the_stop_faces_the_pendulum_from_either_side(start: float, stop: float) -> None:
    model = load("pendulum_stop", start_angle=start, stop_angle=stop, length=0.7).model
    (contact,) = model.contacts
    motion = gap_motion((contact.plane, contact.disk), start_states(model))
    assert motion.gap[0] == pytest.approx(0.7 * abs(math.sin(start - stop)))


@pytest.mark.parametrize(
    "call, text",
    [
        (lambda: load("pendulum_stp"), "did you mean 'pendulum_stop'"),
        (lambda: load("chain", link=3), "did you mean 'links'"),
        (lambda: load("chain", links=2.5), "whole number"),
        (lambda: load("chain", links=0), "outside"),
        (lambda: load("chain", links=1e9), r"'links' = 1e\+09 is outside \[1, 20000\]"),
        (lambda: load(3), r"a scenario's name is needed, a text, not 3; there are \[.*'bouncing_ball'"),
        (lambda: load(["chain"]), "a scenario's name is needed"),
        (lambda: ScenarioParameter("n", 3, "-", "a count", 1).check(10**6), r"outside \[1, 20000\]"),
        (lambda: ScenarioParameter("x", 3.0, "m", "a length", 0.0, 1.0), r"'x' = 3 is outside \[0, 1\]"),
        (lambda: ScenarioParameter("x", 1.5, "m", "a length", 2.0, 1.0), "minimum 2 above maximum 1"),
        (lambda: load("bouncing_ball", restitution=1.2), "outside"),
        (lambda: load("bouncing_ball", height=float("nan")), "finite"),
        (lambda: load("bouncing_ball", height="high"), "finite number"),
        (lambda: load("pendulum_stop", law="flors"), "did you mean 'flores'"),
        (lambda: load("pendulum_stop", stop_angle=0.0), "must differ"),
        (lambda: load("pendulum_stop", law="gonthier", restitution=0.0), "infinite"),
        (lambda: load("pendulum_stop", law="hertz", damping=3.0), "takes no damping"),
        (lambda: load("pendulum_stop", driven=1), "true or false"),
        (lambda: load("slider_crank", rod_length=0.15), "must exceed"),
        (lambda: load("slider_crank", bushing_damping=1.0), "needs bushing_stiffness"),
        (lambda: load("slider_crank", bushing_stiffness=10.0), "too soft"),
        (lambda: load("four_bar", loops=0), "outside"),
        (lambda: load("double_pendulum_wall", wall=0.9), "behind the touch with the wall"),
        (lambda: load("slider_crank_stop", stop_angle=-3.0), "must lie below stop_angle"),
        (lambda: load("slider_crank_stop", rod_length=0.15), "must exceed"),
        (lambda: load("newtons_cradle", balls=3, released=3), "must be below balls"),
        (lambda: load("rocking_block", tilt=0.3), "else the block falls over"),
        (lambda: load("stick_slip", static_friction=0.2), "below friction = 0.3"),
    ],
)
def test_wrong_names_and_values_are_refused_with_a_way_out(call, text: str) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(ScenarioError, match=text):
        call()


def test_text_from_a_command_line_is_understood() -> None:
    table = {p.name: p for p in next(e for e in catalogue() if e.name == "pendulum_stop").parameters}
    assert table["restitution"].parse("0.25") == 0.25
    assert table["driven"].parse("no") is False
    assert table["damping"].parse("none") is None
    assert table["law"].parse("hertz") == "hertz"
    with pytest.raises(ScenarioError, match="not a number"):
        table["length"].parse("long")


@pytest.mark.parametrize("e", [0.05, 0.2, 0.5, 0.8, 0.99])
def test_kelvin_voigt_damping_gives_the_restitution_when_it_is_integrated(e: float) -> None:
    """A free mass on a Kelvin-Voigt floor, integrated until the force is zero."""
    zeta = kelvin_voigt_damping_ratio(e)
    assert restitution_without_pull(zeta) == pytest.approx(e, rel=1e-10)

    def release(t: float, y: np.ndarray) -> float:
        return float(y[0] + 2.0 * zeta * y[1]) if t > 0.0 else 1.0

    release.terminal = True  # type: ignore[attr-defined]

    def motion(t: float, y: np.ndarray) -> list[float]:
        return [y[1], -y[0] - 2.0 * zeta * y[1]]

    run = solve_ivp(motion, (0.0, 100.0), [0.0, 1.0], "DOP853", events=release, rtol=1e-10, atol=1e-13)
    assert -run.y[1, -1] == pytest.approx(e, rel=1e-7)


def test_kelvin_voigt_scenario_takes_given_damping() -> None:
    law = load("bouncing_ball", law="kelvin_voigt", damping=12.0).model.contacts[0].law
    assert isinstance(law, KelvinVoigt)
    assert law.damping == 12.0


def test_a_scenario_cannot_be_changed_through_a_dict() -> None:
    scenario = load("chain", links=2)
    with pytest.raises(TypeError):
        scenario.parameters["links"] = 3  # type: ignore[index]
