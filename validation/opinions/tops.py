"""Third opinions on bodies that turn without contact: Euler's equations, and Lagrange's in two angles, by scipy."""

import math

import numpy as np

from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .mechanism import Array, Course, Mechanism, run
from .rotation import components, matrix, only_body, quaternion_rate, turn_rate

AXES = "xyz"


@opinion("free_body")
def free_body(scenario: Scenario) -> Opinion | None:
    """The angular velocity along the body's axes by Euler's equations."""
    body = only_body(scenario)
    inertia, start = np.array(body.inertia), np.array(body.angular_velocity)
    course = Course()
    course.go_on(lambda t, w: turn_rate(inertia, w, np.zeros(3)), start, scenario.t_end, [])
    return Opinion(
        "scipy, Euler's equations",
        channels=components([f"{body.name}.body_angular_velocity_{axis}" for axis in AXES], course.pieces[0]),
    )


@opinion("heavy_top")
def heavy_top(scenario: Scenario) -> Opinion | None:
    """Euler's equations about the pivot, with the weight's moment, and a quaternion."""
    body, (pivot,) = only_body(scenario), scenario.model.joints
    arm = -np.array(pivot.markers()[1].point)
    inertia = np.array(body.inertia) + body.mass * (arm @ arm - arm**2)
    weight = body.mass * np.array(scenario.model.gravity)
    q, _ = body.initial_state()
    p = np.array(q[3:])
    spin = matrix(p).T @ np.array(body.angular_velocity)

    def rates(t: float, y: Array) -> Array:
        p, w = y[:4], y[4:]
        torque = np.cross(arm, matrix(p).T @ weight)
        return np.concatenate([quaternion_rate(p, w), turn_rate(inertia, w, torque)])

    course = Course()
    course.go_on(rates, np.concatenate([p, spin]), scenario.t_end, [])

    def vector(t: float, spins: bool) -> Array:
        y = course.pieces[0](t)
        found: Array = matrix(y[:4]) @ (y[4:] if spins else arm)
        return found

    channels = components([f"{body.name}.{axis}" for axis in AXES], lambda t: vector(t, False))
    channels |= components([f"{body.name}.angular_velocity_{axis}" for axis in AXES], lambda t: vector(t, True))
    return Opinion("scipy, Euler's equations about the pivot", channels=channels)


@opinion("universal_pendulum")
def universal_pendulum(scenario: Scenario) -> Opinion | None:
    """Lagrange's equations in the joint's angles a (about x of the ground's frame) and b (about y of the body).

    w = (a' cos b, b', a' sin b) along the body's axes; A and C are the moments across and along it about the joint:
    (A c^2 + C s^2) a'' + 2 (C - A) s c a' b' = -V_a, A b'' - (C - A) s c a'^2 = -V_b.
    """
    p = scenario.parameters
    length, mass = float(p["length"]), float(p["mass"])
    across, along = float(p["transverse_inertia"]) + mass * length**2, float(p["axial_inertia"])
    body = only_body(scenario)
    frame = matrix(np.array(body.initial_state()[0][3:]))
    g = frame.T @ np.array(scenario.model.gravity)

    def force(t: float, q: Array, v: Array) -> Array:
        sa, ca, sb, cb = math.sin(q[0]), math.cos(q[0]), math.sin(q[1]), math.cos(q[1])
        # the centre of mass is at -length (sin b, -sin a cos b, cos a cos b)
        by_a = -length * np.array([0.0, -ca * cb, -sa * cb])
        by_b = -length * np.array([cb, sa * sb, -ca * sb])
        bent = (along - across) * sb * cb
        return np.array([mass * g @ by_a - 2.0 * bent * v[0] * v[1], mass * g @ by_b + bent * v[0] ** 2])

    two = Mechanism(
        mass=lambda q: np.diag([across * math.cos(q[1]) ** 2 + along * math.sin(q[1]) ** 2, across]), force=force
    )  # fmt: skip
    course = run(two, (0.0, 0.0), (float(p["rate_x"]), float(p["rate_y"])), scenario.t_end)

    def vectors(t: float) -> tuple[Array, Array]:
        (a, b), (va, vb) = course.state(t)
        place = -length * np.array([math.sin(b), -math.sin(a) * math.cos(b), math.cos(a) * math.cos(b)])
        # a' about x of the frame, b' about the y axis that a has turned
        spin = np.array([va, vb * math.cos(a), vb * math.sin(a)])
        return frame @ place, frame @ spin

    channels = components([f"{body.name}.{axis}" for axis in AXES], lambda t: vectors(t)[0])
    channels |= components([f"{body.name}.angular_velocity_{axis}" for axis in AXES], lambda t: vectors(t)[1])
    return Opinion("scipy, the joint's two angles", channels=channels)
