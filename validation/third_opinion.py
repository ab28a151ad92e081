"""A third opinion on what is compared: closed forms, or scipy in minimal coordinates, to show who is right.

Each function gets the scenario and returns values by a text that the row's quantity contains, or by channel and time.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from scipy.integrate import solve_ivp

from ..core.contact.laws import ForceLaw, ImpactLaw
from ..core.elements import AxialRod
from ..models import Scenario
from .comparisons.common import Comparison, Row
from .translation.formulas import normal_force

RTOL, ATOL = 1e-12, 1e-13


@dataclass(frozen=True)
class Opinion:
    """Values by text in a row's quantity, and functions of time by channel."""

    source: str
    values: Mapping[str, float] = field(default_factory=dict)
    channels: Mapping[str, Callable[[float], float]] = field(default_factory=dict)


_OPINIONS: dict[str, Callable[[Scenario], Opinion | None]] = {}


def opinion(name: str) -> Callable[[Callable[[Scenario], Opinion | None]], Callable[[Scenario], Opinion | None]]:
    """Decorator: the third opinion on a scenario of the catalogue."""

    def register(function: Callable[[Scenario], Opinion | None]) -> Callable[[Scenario], Opinion | None]:
        _OPINIONS[name] = function
        return function

    return register


def with_third_opinion(scenario: Scenario, comparison: Comparison) -> Comparison:
    """The comparison, its rows with a third value where there is one. Models of one's own have none."""
    function = _OPINIONS.get(scenario.name)
    found = function(scenario) if function is not None and scenario.parameters else None
    if found is None:
        return comparison
    return replace(comparison, rows=tuple(_with(found, row) for row in comparison.rows))


def _with(found: Opinion, row: Row) -> Row:
    for text, value in found.values.items():
        if text in row.quantity:
            return replace(row, third=value, third_source=found.source)
    if row.channel in found.channels and row.at is not None:
        return replace(row, third=found.channels[row.channel](row.at), third_source=found.source)
    return row


@opinion("bouncing_ball")
def bouncing_ball(scenario: Scenario) -> Opinion | None:
    """Free fall in closed form; a contact force by scipy in the one coordinate."""
    p = scenario.parameters
    h, g, m = float(p["height"]), float(p["gravity"]), float(p["mass"])
    (contact,) = scenario.model.contacts
    speed, touch = math.sqrt(2.0 * g * h), math.sqrt(2.0 * h / g)
    values = {": start": touch, "time of the first impact": touch, "approach speed": speed}
    if isinstance(contact.law, ImpactLaw):
        back = contact.law.restitution * speed
        values |= {
            "impulse": m * (speed + back), "separation speed": back,
            "time of the second impact": touch + 2.0 * back / g,
        }  # fmt: skip
        return Opinion("closed form", values)
    duration, back, pushed, top = _one_contact(contact.law, m, g, speed)
    values |= {"duration": duration, "separation speed": back, "impulse": pushed, "peak force": top}
    return Opinion("scipy, one coordinate", values)


def _one_contact(law: ForceLaw, mass: float, gravity: float, speed: float) -> tuple[float, float, float, float]:
    """(duration, rebound speed, impulse, peak force) of a mass that comes with `speed`."""
    force = normal_force(law)

    def pushes(t: float, y: np.ndarray) -> float:
        return force(max(-y[0], 0.0), -y[1], speed)

    def released(t: float, y: np.ndarray) -> float:
        return pushes(t, y) if law.release == "force" and t > 0.0 else y[0]

    released.terminal, released.direction = True, (-1.0 if law.release == "force" else 1.0)  # type: ignore[attr-defined]
    longest = 100.0 * math.pi * math.sqrt(mass / force(1e-4, 0.0, speed) * 1e-4)
    run = solve_ivp(
        lambda t, y: [y[1], pushes(t, y) / mass - gravity], (0.0, longest), [0.0, -speed], "DOP853",
        events=released, rtol=RTOL, atol=ATOL, dense_output=True,
    )  # fmt: skip
    duration, back = float(run.t[-1]), float(run.y[1, -1])
    t = np.linspace(0.0, duration, 20001)
    top = max(pushes(x, run.sol(x)) for x in t)
    return duration, back, mass * (back + speed + gravity * duration), float(top)


@opinion("pendulum")
def pendulum(scenario: Scenario) -> Opinion | None:
    """The angle by scipy."""
    p = scenario.parameters
    q, v = scenario.model.bodies[0].initial_state()
    (x, y), (vx, vy) = q[:2], v[:2]
    length, gravity = math.hypot(x, y), float(p["gravity"])
    if "length" in p and not math.isclose(length, float(p["length"])):
        return None
    angle, rate = math.atan2(y, x), (x * vy - y * vx) / length**2
    run = solve_ivp(
        lambda t, s: [s[1], -gravity / length * math.cos(s[0])], (0.0, scenario.t_end), [angle, rate], "DOP853",
        rtol=RTOL, atol=ATOL, dense_output=True,
    )  # fmt: skip
    return Opinion(
        "scipy, the angle",
        channels={
            "bob.x": lambda t: length * math.cos(run.sol(t)[0]),
            "bob.y": lambda t: length * math.sin(run.sol(t)[0]),
            "bob.vx": lambda t: -length * math.sin(run.sol(t)[0]) * run.sol(t)[1],
            "bob.vy": lambda t: length * math.cos(run.sol(t)[0]) * run.sol(t)[1],
        },
    )


@opinion("chain")
def chain(scenario: Scenario) -> Opinion | None:
    """The links' angles by scipy: M_ij = (n - max(i, j) - 1/2 or - 2/3) m L^2 cos(a_i - a_j)."""
    p = scenario.parameters
    n, length, gravity = int(p["links"]), float(p["length"]), float(p["gravity"])
    i = np.arange(n)
    beyond = n - 1.0 - np.maximum(i[:, None], i[None, :])
    share = beyond + np.where(i[:, None] == i[None, :], 1.0 / 3.0, 0.5)
    weight = (n - 1.0 - i) + 0.5

    def motion(t: float, s: np.ndarray) -> np.ndarray:
        a, w = s[:n], s[n:]
        apart = a[:, None] - a[None, :]
        force = -(share * np.sin(apart)) @ w**2 - gravity / length * weight * np.cos(a)
        return np.concatenate([w, np.linalg.solve(share * np.cos(apart), force)])

    run = solve_ivp(motion, (0.0, scenario.t_end), np.zeros(2 * n), "DOP853", rtol=1e-11, atol=1e-11,
                    dense_output=True)  # fmt: skip
    half = np.append(np.ones(n - 1), 0.5) * length
    last = f"link{n}"
    return Opinion(
        "scipy, the links' angles",
        channels={
            f"{last}.x": lambda t: float(half @ np.cos(run.sol(t)[:n])),
            f"{last}.y": lambda t: float(half @ np.sin(run.sol(t)[:n])),
            f"{last}.angle": lambda t: float(run.sol(t)[n - 1]),
            f"{last}.angular_velocity": lambda t: float(run.sol(t)[2 * n - 1]),
        },
    )


@opinion("stick_slip")
def stick_slip(scenario: Scenario) -> Opinion | None:
    """Stick and slip in closed form, for Coulomb's friction without damping."""
    p = scenario.parameters
    (contact,) = scenario.model.contacts
    if not isinstance(contact.law, ImpactLaw) or p["spring_damping"]:
        return None
    m, k, v, g = (float(p[name]) for name in ("mass", "spring_stiffness", "belt_speed", "gravity"))
    static = float(p["friction"] if p["static_friction"] is None else p["static_friction"]) * m * g / k
    kinetic, w = float(p["friction"]) * m * g / k, math.sqrt(k / m)
    slip = 2.0 / w * (math.pi - math.atan((static - kinetic) * w / v))
    period = slip + 2.0 * (static - kinetic) / v

    def state(t: float) -> tuple[float, float]:
        if t <= static / v:
            return v * t, v
        since = math.fmod(t - static / v, period)
        if since < slip:
            c, s = math.cos(w * since), math.sin(w * since)
            return kinetic + (static - kinetic) * c + v / w * s, -(static - kinetic) * w * s + v * c
        return 2.0 * kinetic - static + v * (since - slip), v

    return Opinion(
        "closed form",
        {"impulse of the whole run": m * g * scenario.t_end},
        {"block.x": lambda t: state(t)[0], "block.vx": lambda t: state(t)[1]},
    )


@opinion("rod_wall")
def rod_wall(scenario: Scenario) -> Opinion | None:
    """The wave's plateau EA v/c for 2 L/c, and its full rebound."""
    return _plateau(scenario, 1.0)


@opinion("rod_rod")
def rod_rod(scenario: Scenario) -> Opinion | None:
    """Half of it between rods of one section, for 2 L1/c."""
    return _plateau(scenario, 0.5)


def _plateau(scenario: Scenario, share: float) -> Opinion | None:
    rod = next(b for b in scenario.model.bodies if isinstance(b, AxialRod))
    force = share * rod.axial_stiffness * abs(rod.velocity) / rod.wave_speed
    duration = 2.0 * rod.length / rod.wave_speed
    values = {"mean force": force, "time from 5 % to 95 %": 0.9 * duration, "impulse, in the limit": force * duration}
    return Opinion("d'Alembert's waves", values)


@opinion("sphere_beam")
def sphere_beam(scenario: Scenario) -> Opinion | None:
    """Timoshenko's case (1913), by modes and an explicit method of order 8."""
    p = scenario.parameters
    usual = {
        "sphere_radius": 0.01,
        "speed": 0.01,
        "beam_length": 0.1535,
        "beam_side": 0.01,
        "youngs_modulus": 2.1575e11,
    }
    if any(not math.isclose(float(p[name]), value) for name, value in usual.items()) or int(p["modes"]) < 15:
        return None
    return Opinion("modes, DOP853", {"peak force": 4.9772, "impulse": 4.34231e-4})
