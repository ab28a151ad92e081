"""Models and references for the tests of the core. The references use minimal coordinates and scipy only."""

import math

import numpy as np
from scipy.integrate import solve_ivp
from tlismni.core import (
    Disk2D,
    DiskOnHalfPlane2D,
    Distance2D,
    EquationSystem,
    HalfPlane2D,
    Marker2D,
    Model,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
)

G = 9.81
GROUND = Marker2D()


def on(body, x=0.0, y=0.0, angle=0.0):
    """Marker at (x, y) of a body."""
    return Marker2D(body=body, point=(x, y), angle=angle)


def floor_contact(law, body="ball", name="floor", radius=0.0, height=0.0):
    """Contact of a disk at the centre of `body` with a floor at `height`."""
    plane = HalfPlane2D(marker=Marker2D(point=(0.0, height)))
    return DiskOnHalfPlane2D(name=name, plane=plane, disk=Disk2D(marker=on(body), radius=radius), law=law)


def ball_over_floor(law, height=1.0, speed=0.0, mass=1.0, gravity=G, **parts):
    """A point mass at `height` over a floor, moving with `speed` upwards."""
    ball = PointMass2D(name="ball", mass=mass, position=(0.0, height), velocity=(0.0, speed))
    return Model(bodies=[ball], contacts=[floor_contact(law)], gravity=(0.0, -gravity), **parts)


def point_pendulum(angle=0.0, rate=0.0, length=1.0, mass=1.0, gravity=G):
    """A point mass on a massless rod; `angle` from the horizontal, counter-clockwise."""
    position = (length * math.cos(angle), length * math.sin(angle))
    velocity = (-rate * position[1], rate * position[0])
    return Model(
        gravity=(0.0, -gravity),
        bodies=[PointMass2D(name="bob", mass=mass, position=position, velocity=velocity)],
        joints=[Distance2D(name="rod", a=GROUND, b=on("bob"), length=length)],
    )


def circle_pendulum(angle=0.0, rate=0.0):
    """The same (length 1, mass 1) as user-written equations."""
    position = np.array([math.cos(angle), math.sin(angle)])
    return EquationSystem(
        mass=np.eye(2),
        force=np.array([0.0, -G]),
        constraint=lambda t, q: q[0] ** 2 + q[1] ** 2 - 1.0,
        q0=position,
        v0=rate * np.array([-position[1], position[0]]),
        potential=lambda t, q: G * q[1],
    )


def rod_pendulum(angle=0.0, rate=0.0, length=1.0, mass=1.0, gravity=G, **parts):
    """A slender rod on a pin at the origin."""
    c, s = 0.5 * length * math.cos(angle), 0.5 * length * math.sin(angle)
    rod = RigidBody2D(
        name="rod", mass=mass, inertia=mass * length**2 / 12.0, position=(c, s), angle=angle,
        velocity=(-rate * s, rate * c), angular_velocity=rate,
    )  # fmt: skip
    pin = Revolute2D(name="pin", a=GROUND, b=on("rod", -0.5 * length))
    parts["joints"] = [pin, *parts.get("joints", [])]
    return Model(gravity=(0.0, -gravity), bodies=[rod], **parts)


def integrate(rhs, y0, times, max_step=math.inf):
    """Reference solution of y' = rhs(t, y) at `times` (N,), as (N, len(y0))."""
    times = np.asarray(times, dtype=float)
    found = solve_ivp(
        rhs, (0.0, max(times[-1], 1e-9)), y0, "DOP853", dense_output=True, rtol=1e-13, atol=1e-13, max_step=max_step
    )
    assert found.success
    return found.sol(times).T


def pendulum_angles(times, angle=0.0, rate=0.0, stiffness=G):
    """(angle, rate) of theta'' = -stiffness cos(theta) at `times`: g/L for a point, 3 g/(2 L) for a slender rod."""
    return integrate(lambda t, y: [y[1], -stiffness * math.cos(y[0])], [angle, rate], times, max_step=0.02)


def events(result, *kinds):
    """The events of the given kinds."""
    return [event for event in result.events if event.kind in kinds]


def residuals(result):
    """Largest constraint violation at position, velocity and acceleration level over all samples."""
    return [np.abs(result[f"residual.{level}"]).max() for level in ("position", "velocity", "acceleration")]


def order(errors, ratio=2.0):
    """Observed order from the errors at steps h and h/ratio."""
    return math.log(errors[-2] / errors[-1]) / math.log(ratio)
