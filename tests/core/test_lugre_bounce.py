"""A disk that bounces with LuGre's friction, against the same equations by another integrator."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import Model, simulate
from tlismni.core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from tlismni.core.elements import RigidBody2D
from tlismni.core.laws import KelvinVoigt
from tlismni.core.laws.friction import LuGreFriction
from tlismni.core.model.markers import Marker2D
from tlismni.core.rounding import LEAST_DEFLECTION

MASS, INERTIA, RADIUS, FALL, GRAVITY = 1.0, 0.004, 0.1, 0.05, 9.81
STIFFNESS, DAMPING = 1e5, 100.0
KINETIC, STATIC, STRIBECK = 0.3, 0.4, 0.01


def spin_after(s0: float, s1: float, s2: float, speed: float, spin: float) -> float:
    """Spin (rad/s) after one bounce: no friction while the damper pulls, and below the least normal force friction and
    slip of the bristles in proportion to it."""
    fall = math.sqrt(2.0 * GRAVITY * FALL)
    size = RADIUS + FALL  # how far the model's points reach
    least = LEAST_DEFLECTION * size * s0 / KINETIC

    def normal(y: np.ndarray) -> float:
        return STIFFNESS * y[0] + DAMPING * y[1]

    def rates(t: float, y: np.ndarray) -> list[float]:
        _, sinking, along, turning, z = y
        push, v = normal(y), along + turning * RADIUS
        slip, rub = 0.0, 0.0
        if push > 0.0:
            g = max(push, least) * (KINETIC + (STATIC - KINETIC) * math.exp(-((v / STRIBECK) ** 2)))
            share = min(push / least, 1.0)
            slip = v - s0 * abs(v) * z / g
            slip, rub = share * slip, -share * (s0 * z + s1 * slip + s2 * v)
        return [sinking, GRAVITY - push / MASS, rub / MASS, rub * RADIUS / INERTIA, slip]

    def over(t: float, y: np.ndarray) -> float:
        return normal(y) if t > 1e-9 else 1.0

    over.terminal, over.direction = True, -1.0  # type: ignore[attr-defined]
    run = solve_ivp(rates, (0.0, 0.1), [0.0, fall, speed, spin, 0.0], "Radau", events=over, rtol=1e-9, atol=1e-13)
    assert run.status == 1
    return float(run.y[3, -1])


@pytest.mark.sampled(4)
@pytest.mark.parametrize("release", ["force", "gap"])
@pytest.mark.parametrize("bristles", [(1e4, 30.0, 0.0), (1e5, 100.0, 0.4), (1e3, 1.0, 0.0)], ids=str)
@pytest.mark.parametrize("speed, spin", [(1.0, 0.0), (0.05, -0.2)])
def test_spin_after_a_bounce(release: str, bristles: tuple[float, float, float], speed: float, spin: float) -> None:
    s0, s1, s2 = bristles
    friction = LuGreFriction(
        coefficient=KINETIC, static_coefficient=STATIC, stribeck_speed=STRIBECK, bristle_stiffness=s0,
        bristle_damping=s1, viscous_damping=s2,
    )  # fmt: skip
    ball = RigidBody2D(name="ball", mass=MASS, inertia=INERTIA, position=(0.0, RADIUS + FALL), velocity=(speed, 0.0),
                       angular_velocity=spin)  # fmt: skip
    contact = DiskOnHalfPlane2D(
        name="floor", plane=HalfPlane2D(), disk=Disk2D(marker=Marker2D(body="ball"), radius=RADIUS),
        law=KelvinVoigt(stiffness=STIFFNESS, damping=DAMPING, release_rule=release), friction=friction,
    )  # fmt: skip
    model = Model(gravity=(0.0, -GRAVITY), bodies=(ball,), contacts=(contact,))
    result = simulate(model, 0.15, "irk", 1e-8, 1e-10)
    assert [e.kind for e in result.events] == ["close", "open"]
    expected = spin_after(s0, s1, s2, speed, spin)
    assert abs(result["ball.angular_velocity"][-1] - expected) < 1e-5 * abs(expected - spin)
    assert np.abs(result["energy.balance"]).max() < 1e-8
