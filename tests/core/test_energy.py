"""The energy ledger: conservative motion keeps its energy, and with losses and work the ledger closes."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, ball_over_floor, events, floor_contact, on, point_pendulum, rod_pendulum
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    Constant,
    CoordinateDriver,
    EquationSystem,
    Flores,
    GapContact,
    Gonthier,
    Hertz,
    HuntCrossley,
    KelvinVoigt,
    LankaraniNikravesh,
    Model,
    NewtonImpact,
    PointMass2D,
    Polynomial,
    Prismatic2D,
    Ramp,
    Revolute2D,
    RigidBody2D,
    Sine,
    SpringDamper2D,
    Step,
    Tsuji,
    simulate,
)
from tlismni.core.laws import FORCE_LAWS
from tlismni.models import load

LAWS = [
    NewtonImpact(restitution=0.6),
    Hertz(stiffness=1e5),
    KelvinVoigt(stiffness=1e4, damping=20.0),
    HuntCrossley(stiffness=1e5, restitution=0.6),
    LankaraniNikravesh(stiffness=1e5, restitution=0.6),
    Flores(stiffness=1e5, restitution=0.6),
    Gonthier(stiffness=1e5, restitution=0.6),
]


def imbalance(result):
    """Largest error of the ledger relative to the largest kinetic energy."""
    return np.abs(result["energy.balance"]).max() / result["energy.kinetic"].max()


@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_chain_keeps_its_energy(method):
    """Drift over 2 s relative to the largest kinetic energy, which the fall has made out of potential energy."""
    result = simulate(load("chain", links=10).model, 2.0, method, rtol=1e-9, atol=1e-11)
    assert result["energy.kinetic"].max() > 100.0
    assert imbalance(result) < 1e-7


def test_energies_are_those_of_their_definitions():
    result = simulate(rod_pendulum(0.3, 1.0, length=2.0, mass=3.0), 0.7, rtol=1e-8)
    rate, y = result["rod.angular_velocity"], result["rod.y"]
    assert result["energy.kinetic"] == pytest.approx(0.5 * (3.0 * 4.0 / 3.0) * rate**2, rel=1e-12)
    assert result["energy.potential"] == pytest.approx(3.0 * G * y, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("law", LAWS, ids=lambda law: law.type)
def test_ledger_closes_with_contact(law):
    """Two or three bounces; to the tolerance of the integration."""
    coarse = simulate(ball_over_floor(law, height=0.3), 0.9, rtol=1e-6, atol=1e-9)
    fine = simulate(ball_over_floor(law, height=0.3), 0.9, rtol=1e-9, atol=1e-12)
    assert len(fine.events) >= 2
    assert imbalance(coarse) < 1e-4
    assert imbalance(fine) < 1e-7
    lost = fine["energy.dissipation"][-1] + fine["energy.impact_loss"][-1]
    assert lost == pytest.approx(0.0, abs=1e-7) if isinstance(law, Hertz) else lost > 0.1


@pytest.mark.parametrize("law", [NewtonImpact(restitution=0.5), Flores(stiffness=1e6, restitution=0.5)])
def test_ledger_closes_for_a_mechanism_that_strikes(law):
    model = rod_pendulum(0.8, contacts=[floor_contact(law, body="rod", radius=0.1, height=-0.3)], joints=[])
    result = simulate(model, 2.0, rtol=1e-9, atol=1e-12)
    assert len(result.events) > 4
    assert imbalance(result) < 1e-7


@pytest.mark.sampled(3)
@pytest.mark.parametrize("kind", FORCE_LAWS.values(), ids=lambda kind: kind.__name__)
def test_ledger_of_own_equations_is_that_of_the_model(kind):
    """A bounce and a start in touch, by a gap function and by shapes: the same strain energy and losses."""
    given = {"stiffness": 1e5, "restitution": 0.6, "damping": 20.0, "relaxation_time": 1e-3}
    if kind is Tsuji:
        del given["restitution"]
    law = kind(**{name: given[name] for name in kind.model_fields if name in given})
    for height in (0.05, -2e-3):
        own = EquationSystem(
            np.eye(1), np.array([-G]), q0=[height], v0=[0.0], potential=lambda t, q: G * q[0],
            contacts=[GapContact("floor", lambda t, q: q[0], law)],
        )  # fmt: skip
        grid = np.linspace(0.0, 0.13, 61)
        results = [
            simulate(system, 0.13, rtol=1e-8, atol=1e-11, t_eval=grid) for system in (own, ball_over_floor(law, height))
        ]
        largest = results[1]["energy.kinetic"].max()
        assert results[0]["energy.strain"].max() > 0.2 * largest
        for name in ("energy.strain", "energy.dissipation", "energy.impact_loss"):
            assert results[0][name] == pytest.approx(results[1][name], abs=1e-5 * largest), name
        assert imbalance(results[0]) < 1e-5


def test_damper_dissipates_what_is_missing():
    spring = SpringDamper2D(name="s", a=GROUND, b=on("p"), stiffness=50.0, damping=0.8, natural_length=1.0)
    model = Model(bodies=[PointMass2D(name="p", mass=1.0, position=(1.2, 0.1))], forces=[spring])
    result = simulate(model, 3.0, rtol=1e-9, atol=1e-12)
    assert imbalance(result) < 1e-7
    assert np.all(np.diff(result["energy.dissipation"]) > -1e-14)
    stored = sum(result[f"energy.{kind}"] for kind in ("kinetic", "potential", "strain"))
    assert stored[0] - stored[-1] == pytest.approx(result["energy.dissipation"][-1], rel=1e-6)


@pytest.mark.parametrize(
    "signal",
    [
        Constant(value=3.0),
        Sine(amplitude=4.0, angular_frequency=7.0, phase=0.3, offset=1.0),
        Polynomial(coefficients=(1.0, -2.0, 3.0)),
        Step(time=0.4, before=-1.0, after=5.0),
        Ramp(start=0.2, duration=0.5, before=0.0, after=6.0),
    ],
    ids=lambda signal: signal.type,
)
def test_work_of_applied_loads_is_what_is_put_in(signal):
    forces = [
        AppliedForce2D(name="f", marker=on("rod", 0.5, 0.1), force_x=signal),
        AppliedForce2D(name="g", marker=on("rod", 0.5), force_y=signal, follower=True),
        AppliedTorque2D(name="t", body="rod", torque=signal),
    ]
    result = simulate(rod_pendulum(forces=forces), 1.0, rtol=1e-9, atol=1e-12)
    assert imbalance(result) < 1e-7
    assert abs(result["energy.input_work"][-1]) > 0.1


@pytest.mark.parametrize(
    "motion, speed",
    [
        (Sine(amplitude=0.3, angular_frequency=5.0), 1.5),
        (Polynomial(coefficients=(0.0, 0.4, -1.0, 2.0)), 0.4),
        (Ramp(start=0.3, duration=0.5, before=0.0, after=0.4), 0.0),
    ],
    ids=["sine", "polynomial", "ramp"],
)
def test_work_of_drivers_is_what_is_put_in(motion, speed):
    """A pendulum on a driven slider; with the ramp the driver also does work in the velocity jumps."""
    start = {"velocity": (speed, 0.0)}
    model = Model(
        bodies=[
            RigidBody2D(name="slider", mass=2.0, inertia=0.1, **start),
            RigidBody2D(name="rod", mass=1.0, inertia=1.0 / 12.0, position=(0.0, -0.5), angle=-math.pi / 2, **start),
        ],
        joints=[
            Prismatic2D(name="rail", a=GROUND, b=on("slider")),
            Revolute2D(name="pin", a=on("slider"), b=on("rod", -0.5)),
            CoordinateDriver(name="drive", body="slider", coordinate="x", motion=motion),
        ],
    )
    result = simulate(model, 1.0, rtol=1e-9, atol=1e-12)
    assert imbalance(result) < 1e-6
    assert np.abs(result["energy.input_work"]).max() > 1e-3


def test_driver_pays_for_an_impact_on_what_it_drives():
    """A ball falls on a plate that is driven upwards: the driver does work during the impact."""
    from tlismni.core import Disk2D, DiskOnHalfPlane2D, HalfPlane2D

    plate = RigidBody2D(name="plate", mass=5.0, inertia=1.0, velocity=(0.0, 1.0))
    model = Model(
        bodies=[plate, PointMass2D(name="ball", mass=1.0, position=(0.0, 0.5))],
        joints=[
            Prismatic2D(name="rail", a=on("ground", angle=math.pi / 2), b=on("plate"), relative_angle=0.0),
            CoordinateDriver(name="drive", body="plate", coordinate="y", motion=Polynomial(coefficients=(0.0, 1.0))),
        ],
        contacts=[
            DiskOnHalfPlane2D(
                name="hit", plane=HalfPlane2D(marker=on("plate")), disk=Disk2D(marker=on("ball")),
                law=NewtonImpact(restitution=0.7),
            )
        ],
    )  # fmt: skip
    result = simulate(model, 0.5, rtol=1e-9, atol=1e-12)
    (impact, *_) = result.events
    t = (-1.0 + math.sqrt(1.0 + 2.0 * G * 0.5)) / G
    assert impact.t == pytest.approx(t, rel=1e-9)
    assert impact.approach_speed == pytest.approx(1.0 + G * t, rel=1e-9)
    # the plate does not feel the ball: the impulse is that on the ball alone
    assert impact.impulse == pytest.approx(1.7 * (1.0 + G * t), rel=1e-9)
    assert impact.energy_loss == pytest.approx(0.5 * (1.0 - 0.7**2) * (1.0 + G * t) ** 2, rel=1e-9)
    assert imbalance(result) < 1e-8


def test_momentum_of_a_free_system_is_kept():
    """Two bodies joined by a spring in free space, spinning: linear and angular momentum and energy."""
    spring = SpringDamper2D(
        name="s", a=on("a", 0.1, 0.2), b=on("b", -0.1), stiffness=80.0, damping=1.0, natural_length=0.5
    )
    bodies = [
        RigidBody2D(name="a", mass=1.0, inertia=0.1, velocity=(0.3, -0.2), angular_velocity=2.0),
        RigidBody2D(name="b", mass=2.0, inertia=0.3, position=(1.0, 0.0), velocity=(-0.1, 0.5), angular_velocity=-1.0),
    ]
    r = simulate(Model(gravity=(0.0, 0.0), bodies=bodies, forces=[spring]), 2.0, rtol=1e-10, atol=1e-12)
    momentum_x = r["a.vx"] + 2.0 * r["b.vx"]
    spin = 0.1 * r["a.angular_velocity"] + 0.3 * r["b.angular_velocity"]
    spin = spin + r["a.x"] * r["a.vy"] - r["a.y"] * r["a.vx"] + 2.0 * (r["b.x"] * r["b.vy"] - r["b.y"] * r["b.vx"])
    assert np.ptp(momentum_x) < 1e-9
    assert np.ptp(spin) < 1e-8
    assert imbalance(r) < 1e-8


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf"])
def test_sampling_between_steps_adds_no_error_to_the_ledger(method):
    times = np.linspace(0.0, 1.0, 333)
    model, tolerances = point_pendulum(0.2, 1.0), {"rtol": 1e-8, "atol": 1e-11}
    at_steps = imbalance(simulate(model, 1.0, method, **tolerances))
    between = imbalance(simulate(model, 1.0, method, t_eval=times, **tolerances))
    assert at_steps < 1e-5
    assert between < 2.0 * at_steps + 1e-8


@pytest.mark.parametrize("method", ["hht", "newmark", "trapezoidal", "park"])
def test_ledger_of_low_order_formulas_follows_the_tolerance_through_damped_contacts(method):
    """The damper's power jumps at the end of the contact: it must not leak into the step after."""
    system = ball_over_floor(KelvinVoigt(stiffness=200.0, damping=3.0))
    worst = []
    for rtol in (1e-6, 1e-8):
        result = simulate(system, 2.0, method, rtol, rtol * 1e-2)
        worst.append(np.abs(result["energy.balance"]).max() / 9.81)
        assert len(events(result, "open")) == 2
    assert worst[1] < 1e-5
    # of second order, h ~ rtol^(1/3)
    assert worst[1] < 0.15 * worst[0]
