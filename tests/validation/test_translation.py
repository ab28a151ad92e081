"""The translation to exudyn against closed forms and against scipy in minimal coordinates."""

import math
from typing import Any

import numpy as np
import pytest
from momentum import momentum_drift
from scipy.integrate import solve_ivp
from scipy.special import ellipk
from tlismni.core import simulate
from tlismni.core.elements import (
    AppliedForce2D,
    AppliedTorque2D,
    Bushing2D,
    CoordinateDriver,
    CoordinateLoad,
    Distance2D,
    LinearSystem,
    MovingFrame2D,
    PointMass2D,
    Prismatic2D,
    Revolute2D,
    RigidBody2D,
    SpringDamper2D,
)
from tlismni.core.model.channels import Input
from tlismni.core.model.markers import Marker2D
from tlismni.core.model.signals import InputSignal, Polynomial, Ramp, Sine, Step, Table
from tlismni.core.multibody_model import Model
from tlismni.models import load
from tlismni.validation.errors import NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.exudyn_run import ExudynSettings, run_exudyn

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
WEIGHTLESS = {"gravity": (0.0, 0.0)}


def reference(f: Any, t: np.ndarray, y0: list[float]) -> np.ndarray:
    """The solution of y' = f(t, y) at times t, to about 1e-11."""
    run = solve_ivp(f, (0.0, t[-1]), y0, "DOP853", t_eval=t, rtol=1e-12, atol=1e-12)
    assert run.success
    return np.asarray(run.y)


def test_free_fall_of_a_point_mass_and_a_turning_body_is_exact() -> None:
    model = Model(
        gravity=(0.3, -9.81),
        bodies=(
            PointMass2D(name="p", mass=3.0, position=(1.0, 2.0), velocity=(0.5, -0.2)),
            RigidBody2D(name="b", mass=0.1, inertia=2.0, velocity=(0.0, 4.0), angle=0.3, angular_velocity=-7.0),
        ),
    )
    r = run_exudyn(model, 0.8, 1e-2)
    assert np.allclose(r["p.x"], 1.0 + 0.5 * r.t + 0.15 * r.t**2, atol=1e-12)
    assert np.allclose(r["p.y"], 2.0 - 0.2 * r.t - 4.905 * r.t**2, atol=1e-12)
    assert np.allclose(r["b.vy"], 4.0 - 9.81 * r.t, atol=1e-12)
    assert np.allclose(r["b.angle"], 0.3 - 7.0 * r.t, atol=1e-12)
    assert np.allclose(r["b.ay"], -9.81)
    assert r.t[-1] == pytest.approx(0.8)


def test_pendulum_quarter_period_is_the_elliptic_integral() -> None:
    model = load("pendulum_stop", law="hertz").model.model_copy(update={"contacts": ()})
    quarter = ellipk(0.5) / math.sqrt(1.5 * 9.81)
    r = run_exudyn(model, 0.6, 1e-4)
    k = int(np.argmax(r["pendulum.angle"] < -math.pi / 2))
    before, after = r["pendulum.angle"][k - 1 : k + 1] + math.pi / 2
    assert r.t[k - 1] + 1e-4 * before / (before - after) == pytest.approx(quarter, abs=2e-8)


def test_revolute_force_channels_are_the_force_on_body_b() -> None:
    """At release from the horizontal a slender rod needs mg/4 at its pin, and none along it."""
    model = load("pendulum_stop", law="hertz").model
    r = run_exudyn(model, 0.01, 1e-3)
    assert r["pin.force_y"][0] == pytest.approx(9.81 / 4.0)
    assert r["pin.force_x"][0] == pytest.approx(0.0, abs=1e-9)


def test_double_pendulum_follows_minimal_coordinates() -> None:
    r = run_exudyn(load("chain", links=2).model, 1.0, 2e-4)

    def motion(t: float, y: np.ndarray) -> list[float]:
        a, b, wa, wb = y
        c, s = math.cos(a - b), math.sin(a - b)
        m = np.array([[4.0 / 3.0, 0.5 * c], [0.5 * c, 1.0 / 3.0]])
        f = [-0.5 * s * wb**2 - 9.81 * 1.5 * math.cos(a), 0.5 * s * wa**2 - 9.81 * 0.5 * math.cos(b)]
        return [wa, wb, *np.linalg.solve(m, f)]

    exact = reference(motion, r.t, [0.0] * 4)
    assert np.abs(r["link2.angle"] - exact[1]).max() < 2e-5
    assert np.abs(r["link2.x"] - np.cos(exact[0]) - 0.5 * np.cos(exact[1])).max() < 2e-5
    hinge = r["link1.x"] + 0.5 * np.cos(r["link1.angle"]) - r["link2.x"] + 0.5 * np.cos(r["link2.angle"])
    assert np.abs(hinge).max() < 1e-10


def test_a_moving_frame_drags_what_is_on_it() -> None:
    """A mass on a spring to a frame that swings: the driven oscillator in closed form."""
    frame = MovingFrame2D(
        name="f", x=Sine(amplitude=0.1, angular_frequency=3.0), angle=Polynomial(coefficients=(0.2, 0.5))
    )
    mass = PointMass2D(name="p", mass=1.0, position=(1.0, 0.0))
    spring = Bushing2D(name="s", a=Marker2D(body="p", point=(0.0, 0.0)), b=Marker2D(body="f"), stiffness=25.0)
    model = Model(gravity=(0.0, -9.81), bodies=(frame, mass), forces=(spring,))
    r = run_exudyn(model, 1.0, 2e-4)
    assert np.allclose(r["f.x"], 0.1 * np.sin(3.0 * r.t), atol=1e-9)
    assert np.allclose(r["f.angle"], 0.2 + 0.5 * r.t, atol=1e-9)
    forced = 25.0 * 0.1 / (25.0 - 9.0)
    exact = forced * np.sin(3.0 * r.t) + np.cos(5.0 * r.t) - 3.0 * forced / 5.0 * np.sin(5.0 * r.t)
    assert np.abs(r["p.x"] - exact).max() < 1e-5


def test_linear_system_with_driver_and_load_follows_the_solver() -> None:
    """Constant matrices with a skew part in the damping; a coordinate is driven, another one loaded."""
    system = LinearSystem(
        name="s",
        coordinates=("u", "w", "z"),
        mass=((2.0, 0.3, 0.1), (0.3, 1.0, 0.2), (0.1, 0.2, 0.7)),
        damping=((0.4, 0.3, 0.0), (-0.3, 0.2, 0.1), (0.0, 0.1, 0.5)),
        stiffness=((40.0, -10.0, 0.0), (-10.0, 30.0, 5.0), (0.0, 5.0, 20.0)),
        force=(1.0, -2.0, 0.3),
        position=(0.1, 0.1, -0.2),
        velocity=(0.0, 0.6, 0.5),
    )
    model = Model(
        bodies=(system,),
        joints=(CoordinateDriver(name="d", body="s", coordinate="w", motion=Sine(amplitude=0.2, angular_frequency=3.0,
                                                                                 offset=0.1)),),
        forces=(CoordinateLoad(name="f", body="s", coordinate="z", load=Sine(amplitude=3.0, angular_frequency=5.0)),),
    )  # fmt: skip
    ours = simulate(model, 1.0, rtol=1e-10, atol=1e-12, t_eval=np.linspace(0.0, 1.0, 1001))
    r = run_exudyn(model, 1.0, 1e-3)
    for name in ("s.u", "s.w", "s.z", "s.d_u", "s.d_z"):
        assert np.abs(r[name] - ours[name]).max() < 2e-5, name
    # the multiplier of an index-3 formula rings at the start
    late = r.t > 0.2
    assert np.abs(r["d.reaction"] - ours["d.reaction"])[late].max() < 2e-4


def test_slider_on_a_turning_arm_follows_minimal_coordinates() -> None:
    """Prismatic joint on a moving body, with an axis that is not the body's."""
    axis, tilt = 0.4, 0.7  # of the joint in the arm's frame; of the slider against the arm
    model = Model(
        bodies=(
            RigidBody2D(name="arm", mass=2.0, inertia=0.5, angular_velocity=2.0),
            RigidBody2D(
                name="slider",
                mass=0.7,
                inertia=0.05,
                position=(0.3 * math.cos(axis), 0.3 * math.sin(axis)),
                velocity=(-0.6 * math.sin(axis), 0.6 * math.cos(axis)),
                angle=tilt,
                angular_velocity=2.0,
            ),
        ),
        joints=(
            Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="arm")),
            Prismatic2D(name="slide", a=Marker2D(body="arm", angle=axis), b=Marker2D(body="slider")),
        ),
    )
    r = run_exudyn(model, 0.5, 1e-4)

    def motion(t: float, y: np.ndarray) -> list[float]:
        angle, s, w, v = y
        lever = 0.55 + 0.7 * s**2
        torque = -2.0 * 0.7 * s * v * w - 0.7 * 9.81 * s * math.cos(angle + axis)
        return [w, v, torque / lever, s * w**2 - 9.81 * math.sin(angle + axis)]

    angle, s, _, _ = reference(motion, r.t, [0.0, 0.3, 2.0, 0.0])
    assert np.abs(r["arm.angle"] - angle).max() < 1e-6
    assert np.abs(r["slider.angle"] - angle - tilt).max() < 1e-6
    assert np.abs(r["slider.x"] - s * np.cos(angle + axis)).max() < 1e-6
    assert np.abs(r["slider.y"] - s * np.sin(angle + axis)).max() < 1e-6


def test_distance_joint_is_a_rod_with_the_right_tension() -> None:
    model = Model(
        bodies=(PointMass2D(name="p", mass=2.0, position=(1.5, 0.0)),),
        joints=(Distance2D(name="rod", a=Marker2D(), b=Marker2D(body="p"), length=1.5),),
    )
    r = run_exudyn(model, 0.7, 1e-4)
    angle, w = reference(lambda t, y: [y[1], -9.81 / 1.5 * math.cos(y[0])], r.t, [0.0, 0.0])
    assert np.abs(r["p.x"] - 1.5 * np.cos(angle)).max() < 1e-6
    tension = 2.0 * (1.5 * w**2 - 9.81 * np.sin(angle))
    assert np.abs(r["rod.tension"] - tension)[10:].max() < 1e-3


@pytest.mark.parametrize("coordinate, unit", [("x", 2.0), ("y", 2.0), ("angle", 0.3)])
def test_driver_moves_its_coordinate_and_reports_the_reaction(coordinate: str, unit: float) -> None:
    k = ("x", "y", "angle").index(coordinate)
    q0, v0 = np.array([0.1, 0.2, 0.3]), np.zeros(3)
    v0[k] = 0.5 * 3.0
    model = Model(
        **WEIGHTLESS,
        bodies=(
            RigidBody2D(
                name="b", mass=2.0, inertia=0.3, position=tuple(q0[:2]), velocity=tuple(v0[:2]), angle=q0[2],
                angular_velocity=v0[2],
            ),
        ),
        joints=(
            CoordinateDriver(
                name="drive", body="b", coordinate=coordinate,
                motion=Sine(amplitude=0.5, angular_frequency=3.0, offset=q0[k]),
            ),
        ),
    )  # fmt: skip
    r = run_exudyn(model, 1.0, 1e-3)
    assert np.abs(r[f"b.{coordinate}"] - q0[k] - 0.5 * np.sin(3.0 * r.t)).max() < 1e-12
    acceleration = -4.5 * np.sin(3.0 * r.t)
    # exudyn starts prescribed motion with a wrong acceleration, which takes some steps to die out
    assert np.abs(r["drive.reaction"] + unit * acceleration)[200:].max() < 1e-4


def test_spring_damper_oscillates_with_its_frequency_and_damping() -> None:
    model = Model(
        **WEIGHTLESS,
        bodies=(PointMass2D(name="p", mass=2.0, position=(1.3, 0.0)),),
        forces=(
            SpringDamper2D(
                name="s", a=Marker2D(), b=Marker2D(body="p"), stiffness=200.0, damping=4.0, natural_length=1.0
            ),
        ),
    )
    r = run_exudyn(model, 2.0, 1e-3)
    decay, w = 1.0, math.sqrt(100.0 - 1.0)
    exact = 1.0 + 0.3 * np.exp(-decay * r.t) * (np.cos(w * r.t) + decay / w * np.sin(w * r.t))
    assert np.abs(r["p.x"] - exact).max() < 1e-4


def test_spring_between_two_bodies_off_their_centres_conserves_momentum() -> None:
    model = Model(
        **WEIGHTLESS,
        bodies=(
            RigidBody2D(name="a", mass=2.0, inertia=0.2, velocity=(0.1, 0.4), angular_velocity=1.0),
            RigidBody2D(name="b", mass=1.0, inertia=0.1, position=(1.0, 0.2)),
        ),
        forces=(
            SpringDamper2D(
                name="s", a=Marker2D(body="a", point=(0.1, 0.2)), b=Marker2D(body="b", point=(-0.2, 0.1)),
                stiffness=50.0, damping=0.3, natural_length=0.5,
            ),
        ),
    )  # fmt: skip
    assert momentum_drift(model, 1.0, 1e-3) < 1e-5


@pytest.mark.parametrize("turns", [0.0, -4.0, 9.0])
def test_bushing_between_two_bodies_follows_our_own_run(turns: float) -> None:
    """Off the centres, with all its four coefficients, wound up by more than one turn too."""
    model = Model(
        **WEIGHTLESS,
        bodies=(
            RigidBody2D(name="a", mass=2.0, inertia=0.2, velocity=(0.1, 0.4), angular_velocity=1.0),
            RigidBody2D(name="b", mass=1.0, inertia=0.1, position=(0.4, 0.2), angle=turns),
        ),
        forces=(
            Bushing2D(
                name="s", a=Marker2D(body="a", point=(0.1, 0.2), angle=0.3),
                b=Marker2D(body="b", point=(-0.2, 0.1), angle=-0.5), stiffness=50.0, damping=0.8,
                rotational_stiffness=1.5, rotational_damping=0.1,
            ),
        ),
    )  # fmt: skip
    r = run_exudyn(model, 1.0, 1e-3)
    ours = simulate(model, 1.0, rtol=1e-9, atol=1e-11, t_eval=r.t)
    for body in ("a", "b"):
        for name in ("x", "y", "angle"):
            assert np.abs(r[f"{body}.{name}"] - ours[f"{body}.{name}"]).max() < 2e-4
    assert np.ptp(ours["b.angle"]) > 0.5


def test_bushing_on_a_point_mass_oscillates_about_its_rest_point() -> None:
    model = Model(
        **WEIGHTLESS,
        bodies=(PointMass2D(name="p", mass=2.0, position=(0.3, 0.0), velocity=(0.0, 1.0)),),
        forces=(Bushing2D(name="s", a=Marker2D(), b=Marker2D(body="p"), stiffness=200.0, damping=4.0),),
    )
    r = run_exudyn(model, 2.0, 1e-3)
    w, decay = math.sqrt(100.0 - 1.0), np.exp(-r.t)
    assert np.abs(r["p.x"] - 0.3 * decay * (np.cos(w * r.t) + np.sin(w * r.t) / w)).max() < 1e-4
    assert np.abs(r["p.y"] - decay * np.sin(w * r.t) / w).max() < 1e-4


def test_bushing_with_a_rotational_part_needs_a_body_that_can_turn() -> None:
    bushing = Bushing2D(name="s", a=Marker2D(), b=Marker2D(body="p"), stiffness=1.0, rotational_stiffness=1.0)
    with pytest.raises(NotTranslatable, match="orientation of 'p'"):
        run_exudyn(Model(bodies=(PointMass2D(name="p", mass=2.0),), forces=(bushing,)), 0.1, 1e-2)


@pytest.mark.parametrize("follower", [False, True])
def test_applied_force_off_the_centre(follower: bool) -> None:
    model = Model(
        **WEIGHTLESS,
        bodies=(RigidBody2D(name="b", mass=2.0, inertia=0.5),),
        forces=(
            AppliedForce2D(
                name="f",
                marker=Marker2D(body="b", point=(0.3, 0.0), angle=0.7),
                force_x=Polynomial(coefficients=(1.0, 0.5)),
                force_y=Sine(amplitude=2.0, angular_frequency=4.0),
                follower=follower,
            ),
        ),
    )
    r = run_exudyn(model, 1.0, 2e-4)

    def motion(t: float, y: np.ndarray) -> list[float]:
        c, s = math.cos(y[2]), math.sin(y[2])
        fx, fy = 1.0 + 0.5 * t, 2.0 * math.sin(4.0 * t)
        if follower:  # along the axes of its marker
            along, across = math.cos(y[2] + 0.7), math.sin(y[2] + 0.7)
            fx, fy = along * fx - across * fy, across * fx + along * fy
        return [*y[3:], fx / 2.0, fy / 2.0, 0.3 * (c * fy - s * fx) / 0.5]

    exact = reference(motion, r.t, [0.0] * 6)
    for k, name in enumerate(("x", "y", "angle")):
        assert np.abs(r[f"b.{name}"] - exact[k]).max() < 1e-6


@pytest.mark.parametrize(
    "signal, impulse",
    [
        (Step(time=0.25, before=1.0, after=3.0), 0.25 + 0.75 * 3.0),
        (Ramp(start=0.2, duration=0.5, before=0.0, after=2.0), 0.5 + 0.6),
        (Table(times=(0.0, 0.3, 0.7, 1.0), values=(0.0, 0.09, 0.49, 1.0)), 1.0 / 3.0),
        (InputSignal(channel="u"), 1.5),
    ],
)
def test_time_functions_as_torques(signal: Any, impulse: float) -> None:
    """The angular momentum after 1 s is the integral of the torque."""
    model = Model(
        **WEIGHTLESS,
        bodies=(RigidBody2D(name="b", mass=2.0, inertia=0.5),),
        forces=(AppliedTorque2D(name="m", body="b", torque=signal),),
        inputs=(Input(name="u", unit="N.m", start=1.5),),
    )
    r = run_exudyn(model, 1.0, 1e-3)
    assert 0.5 * r["b.angular_velocity"][-1] == pytest.approx(impulse, abs=2e-3)


def test_trapezoidal_and_generalized_alpha_agree_on_smooth_motion() -> None:
    model = load("chain", links=3).model
    a = run_exudyn(model, 0.5, 5e-4)
    b = run_exudyn(model, 0.5, 5e-4, ExudynSettings(integrator="trapezoidal"))
    assert np.abs(a["link3.angle"] - b["link3.angle"]).max() < 1e-4
