"""Third opinions on bodies whose spheres touch a floor: closed forms of blows, sliding and rolling, and scipy."""

import math
from typing import Any

import numpy as np

from ...core.laws import ForceLaw, NewtonImpact
from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .common import law_of
from .mechanism import LONGEST_STEP, Array, Course, Law
from .rotation import components, matrix, only_body, quaternion_rate, turn_rate

UP = np.array([0.0, 0.0, 1.0])
LAST = 1e-13
"""s: a flight as short as this is the last one."""
SLOW = 1e-3
"""m/s: where a sliding top is slower, what comes next is not ours to say."""
NAMES = ("x", "y", "z", "vx", "vy", "vz", "angular_velocity_x", "angular_velocity_y", "angular_velocity_z")


@opinion("spinning_sphere")
def spinning_sphere(scenario: Scenario) -> Opinion | None:
    """As a constraint in closed form throughout; by force by scipy."""
    p = scenario.parameters
    (contact,) = scenario.model.contacts
    if isinstance(contact.law, ForceLaw):
        return _by_force(scenario, ((0.0, float(p["radius"])),))
    if p["static_friction"] not in (None, p["friction"]) or not float(p["restitution"]) < 1.0:
        return None
    return _bounces(scenario)


def _bounces(scenario: Scenario) -> Opinion:
    """Parabolas; blows with P_N = m (1 + e) |v_n| and P_T = min(mu P_N, |s|/(1/m + R^2/J)) against the slip s; sliding
    with mu g until it rolls."""
    p = scenario.parameters
    ball, (contact,) = only_body(scenario), scenario.model.contacts
    m, r, g, mu, e = (float(p[name]) for name in ("mass", "radius", "gravity", "friction", "restitution"))
    moment = ball.inertia[0]
    x, v, w = (np.array(a, dtype=float) for a in (ball.position, ball.velocity, ball.angular_velocity))
    starts: list[float] = []
    phases: list[tuple[Array, Array, Array, Array, Array]] = []  # x, v, w at the start, v', w'
    values: dict[str, float] = {}
    arm = 1.0 / (1.0 / m + r * r / moment)

    def slip() -> Array:
        return (v - r * np.cross(w, UP)) * [1.0, 1.0, 0.0]

    def against(size: float) -> tuple[Array, Array]:
        """What a force, or an impulse, of this size against the slip does to v and w."""
        s = slip()
        push = -size * s / max(float(np.linalg.norm(s)), 1e-300)
        return push / m, np.cross(-r * UP, push) / moment

    t = 0.0
    while t < scenario.t_end:
        starts.append(t)
        phases.append((x, v, w, -g * UP, np.zeros(3)))
        flight = (v[2] + math.sqrt(v[2] ** 2 + 2.0 * g * max(x[2] - r, 0.0))) / g
        t += flight
        x = x + flight * v - 0.5 * g * flight**2 * UP
        v = v - g * flight * UP
        normal = -m * (1.0 + e) * v[2]
        if not values:
            speed = -float(v[2])
            values = {
                f"{contact.name}: start": t, f"{contact.name}: approach speed": speed,
                f"{contact.name}: impulse": normal, f"{contact.name}: separation speed": e * speed,
                f"{contact.name}: time of the first impact": t,
            }  # fmt: skip
        dv, dw = against(min(mu * normal, arm * float(np.linalg.norm(slip()))))
        v, w = v + dv + normal / m * UP, w + dw
        if 2.0 * v[2] / g < LAST:
            break
    v = v * [1.0, 1.0, 0.0]
    dv, dw = against(mu * m * g)
    lasts = float(np.linalg.norm(slip())) / (mu * m * g / arm) if mu > 0.0 else math.inf
    starts.append(t)
    phases.append((x, v, w, dv, dw))
    if math.isfinite(lasts):
        starts.append(t + lasts)
        phases.append((x + lasts * v + 0.5 * lasts**2 * dv, v + lasts * dv, w + lasts * dw, np.zeros(3), np.zeros(3)))

    def at(t: float) -> Array:
        k = max(int(np.searchsorted(starts, t, side="right")) - 1, 0)
        h, (x, v, w, dv, dw) = t - starts[k], phases[k]
        return np.concatenate([x + h * v + 0.5 * h * h * dv, v + h * dv, w + h * dw])

    return Opinion(
        "closed form of blows, sliding and rolling", values, components([f"{ball.name}.{name}" for name in NAMES], at)
    )


@opinion("tippe_top")
def tippe_top(scenario: Scenario) -> Opinion | None:
    """Newton's and Euler's equations: on the large sphere as a constraint, while it slides; by force on both. On a
    patch friction against sliding and spinning lies on an ellipsoid."""
    p = scenario.parameters
    spheres = tuple((float(p[c]), float(p[r])) for c, r in (("centre", "radius"), ("stem_centre", "stem_radius")))
    if isinstance(scenario.model.contacts[0].law, NewtonImpact):
        return _slides(scenario, spheres)
    return _by_force(scenario, spheres)


class _Body:
    """y = (place, quaternion, velocity, angular velocity along the body's axes); spheres on its z axis."""

    def __init__(self, scenario: Scenario) -> None:
        body = only_body(scenario)
        self.name, self.mass, self.inertia = body.name, body.mass, np.array(body.inertia)
        self.weight = body.mass * np.array(scenario.model.gravity)
        q, v = body.initial_state()
        self.start = np.concatenate([q, v[:3], body.angular_velocity])
        # of the top
        self.patch = 2.0 / 3.0 * float(scenario.parameters.get("patch_radius", 0.0))

    def rubs(self, y: Array, slip: Array) -> tuple[float, Array, Array]:
        """Speed that friction is a law of, and for each of its newtons the force and the torque about the vertical."""
        spin = float((matrix(y[3:7]) @ y[10:13])[2])
        speed = math.hypot(float(np.linalg.norm(slip)), self.patch * spin)
        one = 1.0 / max(speed, 1e-300)
        return speed, -one * slip, -one * self.patch**2 * spin * UP

    def contact(self, y: Array, centre: float, radius: float) -> tuple[float, float, Array, Array]:
        """Gap, its rate, the arm of the lowest point (3,), the slip there (3,)."""
        turn = matrix(y[3:7])
        axis, w = turn[:, 2], turn @ y[10:13]
        arm = centre * axis - radius * UP
        velocity = y[7:10] + np.cross(w, arm)
        # the lowest point of the sphere and its centre rise alike
        return float(y[2] + arm[2]), float(velocity[2]), arm, velocity * [1.0, 1.0, 0.0]

    def rates(self, y: Array, force: Array, torque: Array) -> Array:
        """y' under a force and a torque about the centre of mass (3,), besides its weight."""
        turn = matrix(y[3:7])
        return np.concatenate([
            y[7:10], quaternion_rate(y[3:7], y[10:13]), (force + self.weight) / self.mass,
            turn_rate(self.inertia, y[10:13], turn.T @ torque),
        ])  # fmt: skip

    def opinion(self, course: Course, values: dict[str, float]) -> Opinion:
        """From a course of y."""

        def at(t: float) -> Array:
            if t > course.end * (1.0 + 1e-12):
                return np.full(9, math.nan)
            k = max(int(np.searchsorted(course.starts, t, side="right")) - 1, 0)
            y = course.pieces[k](min(t, course.end))
            return np.concatenate([y[:3], y[7:10], matrix(y[3:7]) @ y[10:13]])

        return Opinion(
            "scipy, Newton's and Euler's equations", values, components([f"{self.name}.{name}" for name in NAMES], at)
        )


def _slides(scenario: Scenario, spheres: tuple[tuple[float, float], ...]) -> Opinion:
    """The floor's force N (n - mu s/|s|) keeps the gap's second rate at zero, s with the spin on a patch; to the end of
    sliding, or the stem."""
    body, mu = _Body(scenario), float(scenario.parameters["friction"])
    floor, stem = spheres

    def along(y: Array) -> tuple[Array, Array]:
        _, _, arm, slip = body.contact(y, *floor)
        _, friction, drill = body.rubs(y, slip)
        pull = UP + mu * friction
        return pull, np.cross(arm, pull) + mu * drill

    def rises(y: Array, rate: Array) -> float:
        """The gap's second rate for y' = rate."""
        turn = matrix(y[3:7])
        axis, w, turned = turn[:, 2], turn @ y[10:13], turn @ rate[10:13]
        return float(rate[9] + floor[0] * (np.cross(turned, axis) + np.cross(w, np.cross(w, axis)))[2])

    def rates(t: float, y: Array) -> Array:
        pull, torque = along(y)
        free, pushed = body.rates(y, np.zeros(3), np.zeros(3)), body.rates(y, pull, torque)
        normal = -rises(y, free) / (rises(y, pushed) - rises(y, free))
        found: Array = free + normal * (pushed - free)
        return found

    def sticks(t: float, y: Array) -> float:
        return body.rubs(y, body.contact(y, *floor)[3])[0] - SLOW

    def strikes(t: float, y: Array) -> float:
        return body.contact(y, *stem)[0]

    for event in (sticks, strikes):
        event.terminal, event.direction = True, -1.0  # type: ignore[attr-defined]
    course = Course()
    course.go_on(rates, body.start, scenario.t_end, [sticks, strikes])
    return body.opinion(course, {})


def _by_force(scenario: Scenario, spheres: tuple[tuple[float, float], ...]) -> Opinion:
    """Each sphere's force by its law, from touch to release, with the friction of its sliding speed."""
    body, contacts = _Body(scenario), scenario.model.contacts
    laws = [law_of(contact.law, contact.friction) for contact in contacts]
    since: dict[int, float] = {}
    # behind the body's state stand the impulses of the contacts since they touched
    y, course = np.concatenate([body.start, np.zeros(len(spheres))]), Course()
    values: dict[str, float] = {}
    for number, sphere in enumerate(spheres):
        gap, rate, *_ = body.contact(y, *sphere)
        if abs(gap) < LAST and rate <= 0.0:
            since[number] = -rate
            values |= {f"{contacts[number].name}: approach speed": -rate, f"{contacts[number].name}: start": 0.0}

    def rates(t: float, y: Array) -> Array:
        force, torque, pushes = np.zeros(3), np.zeros(3), np.zeros(len(spheres))
        for k, speed in since.items():
            gap, rate, arm, slip = body.contact(y, *spheres[k])
            pushes[k] = push = _pushes(laws[k], gap, rate, speed)
            (slides, friction, drill), rubs = body.rubs(y, slip), laws[k].friction
            pull = push * UP
            if rubs is not None and push > 0.0 and slides > 0.0:
                size = -rubs(slides, push)
                pull, torque = pull + size * friction, torque + size * drill
            force, torque = force + pull, torque + np.cross(arm, pull)
        return np.concatenate([body.rates(y, force, torque), pushes])

    while course.end < scenario.t_end:
        events = [_event(body, laws[k], sphere, since.get(k), course.end) for k, sphere in enumerate(spheres)]
        y, happened = course.go_on(rates, y, scenario.t_end, events, LONGEST_STEP * scenario.t_end)
        if happened is None:
            break
        k = happened
        speed = -body.contact(y, *spheres[k])[1]
        if since.pop(k, None) is None:
            since[k], y[13 + k] = speed, 0.0
            values.setdefault(f"{contacts[k].name}: approach speed", speed)
            values.setdefault(f"{contacts[k].name}: start", course.end)
        else:
            values.setdefault(f"{contacts[k].name}: separation speed", -speed)
            values.setdefault(f"{contacts[k].name}: impulse", float(y[13 + k]))
    return body.opinion(course, values)


def _pushes(law: Law, gap: float, rate: float, speed: float) -> float:
    """Force of a contact that touches, N."""
    assert law.force is not None  # by force all are
    found = law.force(max(-gap, 0.0), -rate, speed)
    return max(found, 0.0) if law.release == "force" else found


def _event(body: _Body, law: Law, sphere: tuple[float, float], since: float | None, start: float) -> Any:
    """Zero where a sphere touches, or lets go."""

    def happens(t: float, y: Array) -> float:
        gap, rate, *_ = body.contact(y, *sphere)
        if since is not None and law.release == "force" and law.force is not None:
            return law.force(max(-gap, 0.0), -rate, since) if t > start else 1.0
        return gap

    happens.terminal = True  # type: ignore[attr-defined]
    happens.direction = 1.0 if since is not None and law.release == "gap" else -1.0  # type: ignore[attr-defined]
    return happens
