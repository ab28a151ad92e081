"""Third opinions on scenarios with impacts: scipy in minimal coordinates."""

import math
from functools import partial

import numpy as np

from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .common import law_of, opinion_on
from .mechanism import Array, Mechanism, run


@opinion("bouncing_ball")
def bouncing_ball(scenario: Scenario) -> Opinion | None:
    """The height."""
    p = scenario.parameters
    height, radius, gravity, mass = (float(p[name]) for name in ("height", "radius", "gravity", "mass"))
    (contact,) = scenario.model.contacts
    ball = Mechanism(
        mass=lambda q: np.array([[mass]]),
        force=lambda t, q, v: np.array([-mass * gravity]),
        gaps=lambda q: q,
        gradients=lambda q: np.ones((1, 1)),
        laws=(law_of(contact.law),),
    )
    course = run(ball, (height,), (0.0,), scenario.t_end)
    place, speed = course.q(0), course.v(0)
    channels = {"ball.y": lambda t: radius + place(t), "ball.vy": speed}
    return opinion_on(course, (contact.name,), channels, "scipy, the height")


@opinion("pendulum_stop")
def pendulum_stop(scenario: Scenario) -> Opinion | None:
    """The angle: m L^2/3 a'' = -m g L/2 cos a, gap L |sin(a - stop)|."""
    p = scenario.parameters
    length, mass, gravity, start, stop = (
        float(p[name]) for name in ("length", "mass", "gravity", "start_angle", "stop_angle")
    )
    side = math.copysign(1.0, start - stop)
    (contact,) = scenario.model.contacts
    rod = Mechanism(
        mass=lambda q: np.array([[mass * length**2 / 3.0]]),
        force=lambda t, q, v: np.array([-0.5 * mass * gravity * length * math.cos(q[0])]),
        gaps=lambda q: side * length * np.sin(q - stop),
        gradients=lambda q: np.array([[side * length * math.cos(q[0] - stop)]]),
        laws=(law_of(contact.law),),
    )
    course = run(rod, (start,), (0.0,), scenario.t_end)
    channels = {"pendulum.angle": course.q(0), "pendulum.angular_velocity": course.v(0)}
    return opinion_on(course, (contact.name,), channels, "scipy, the angle")


@opinion("double_pendulum_wall")
def double_pendulum_wall(scenario: Scenario) -> Opinion | None:
    """The two angles."""
    p = scenario.parameters
    l1, l2, m1, m2, g = (
        float(p[name]) for name in ("upper_length", "lower_length", "upper_mass", "lower_mass", "gravity")
    )
    a, b, c = (m1 / 3.0 + m2) * l1**2, 0.5 * m2 * l1 * l2, m2 * l2**2 / 3.0
    reach = float(p["wall"]) + float(p["radius"])

    def mass(q: Array) -> Array:
        coupled = b * math.cos(q[0] - q[1])
        return np.array([[a, coupled], [coupled, c]])

    def force(t: float, q: Array, v: Array) -> Array:
        turn = b * math.sin(q[0] - q[1])
        return np.array([
            -turn * v[1] ** 2 - (0.5 * m1 + m2) * g * l1 * math.cos(q[0]),
            turn * v[0] ** 2 - 0.5 * m2 * g * l2 * math.cos(q[1]),
        ])  # fmt: skip

    (contact,) = scenario.model.contacts
    rods = Mechanism(
        mass,
        force,
        gaps=lambda q: np.array([l1 * math.cos(q[0]) + l2 * math.cos(q[1]) - reach]),
        gradients=lambda q: np.array([[-l1 * math.sin(q[0]), -l2 * math.sin(q[1])]]),
        laws=(law_of(contact.law),),
    )
    start = (float(p["upper_angle"]), float(p["lower_angle"]))
    course = run(rods, start, (0.0, 0.0), scenario.t_end)
    channels = {
        "upper.angle": course.q(0), "lower.angle": course.q(1), "lower.angular_velocity": course.v(1),
    }  # fmt: skip
    return opinion_on(course, (contact.name,), channels, "scipy, the two angles")


@opinion("impact_oscillator")
def impact_oscillator(scenario: Scenario) -> Opinion | None:
    """The position."""
    p = scenario.parameters
    damping, frequency, stop = (float(p[name]) for name in ("damping_ratio", "frequency", "stop_position"))
    (contact,) = scenario.model.contacts
    oscillator = Mechanism(
        mass=lambda q: np.eye(1),
        force=lambda t, q, v: np.array([math.cos(frequency * t)]) - 2.0 * damping * v - q,
        gaps=lambda q: stop - q,
        gradients=lambda q: -np.eye(1),
        laws=(law_of(contact.law),),
    )
    course = run(oscillator, (float(p["start_position"]),), (float(p["start_velocity"]),), scenario.t_end)
    channels = {"mass.x": course.q(0), "mass.vx": course.v(0)}
    return opinion_on(course, (contact.name,), channels, "scipy, the position")


@opinion("newtons_cradle")
def newtons_cradle(scenario: Scenario) -> Opinion | None:
    """The angles of the strings from the vertical; None for balls that touch."""
    p = scenario.parameters
    balls, released = int(p["balls"]), int(p["released"])
    length, radius, mass, gap, gravity = (float(p[name]) for name in ("length", "radius", "mass", "gap", "gravity"))
    if gap <= 0.0:
        return None
    spacing, each = 2.0 * radius + gap, np.arange(balls)

    def between(q: Array) -> tuple[Array, Array]:
        """From each centre to the next one, x and y."""
        return spacing + length * np.diff(np.sin(q)), -length * np.diff(np.cos(q))

    def gradients(q: Array) -> Array:
        dx, dy = between(q)
        distance, rows = np.hypot(dx, dy), np.zeros((balls - 1, balls))
        # where a centre goes with its angle: (cos, sin) L
        c, s = length * np.cos(q), length * np.sin(q)
        rows[each[:-1], each[:-1]] = -(dx * c[:-1] + dy * s[:-1]) / distance
        rows[each[:-1], each[1:]] = (dx * c[1:] + dy * s[1:]) / distance
        return rows

    contacts = scenario.model.contacts
    cradle = Mechanism(
        mass=lambda q: mass * length**2 * np.eye(balls),
        force=lambda t, q, v: -mass * gravity * length * np.sin(q),
        gaps=lambda q: np.hypot(*between(q)) - 2.0 * radius,
        gradients=gradients,
        laws=tuple(law_of(contact.law) for contact in contacts),
    )
    start = np.where(each < released, -float(p["angle"]), 0.0)
    course = run(cradle, start.tolist(), [0.0] * balls, scenario.t_end)

    def place(ball: int, t: float) -> float:
        return ball * spacing + length * math.sin(course.q(ball)(t))

    channels = {f"ball{k + 1}.x": partial(place, k) for k in (0, balls - 1)}
    return opinion_on(course, [c.name for c in contacts], channels, "scipy, the strings' angles")


@opinion("split_whole")
def split_whole(scenario: Scenario) -> Opinion | None:
    """The two positions."""
    p = scenario.parameters
    m1, m2 = float(p["hammer_mass"]), float(p["anvil_mass"])
    stiffness = np.array([m1 * float(p["hammer_frequency"]) ** 2, m2 * float(p["anvil_frequency"]) ** 2])
    damping = np.array([0.0, 2.0 * float(p["anvil_damping_ratio"]) * m2 * float(p["anvil_frequency"])])
    (contact,) = scenario.model.contacts
    pair = Mechanism(
        mass=lambda q: np.diag([m1, m2]),
        force=lambda t, q, v: -stiffness * q - damping * v,
        gaps=lambda q: q[:1] - q[1:],
        gradients=lambda q: np.array([[1.0, -1.0]]),
        laws=(law_of(contact.law),),
    )
    course = run(pair, (float(p["gap"]), 0.0), (-float(p["speed"]), 0.0), scenario.t_end)
    channels = {"hammer.x": course.q(0), "anvil.x": course.q(1)}
    return opinion_on(course, (contact.name,), channels, "scipy, the two positions")
