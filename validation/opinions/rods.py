"""Third opinions on rods and beams: waves and modes."""

import math
from collections.abc import Callable

import numpy as np
from scipy.integrate import solve_ivp

from ...core.elements import AxialRod
from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .common import law_of, opinion_on
from .mechanism import ATOL, RTOL, Array, Mechanism, run

SAMPLES = 2001
"""Of the force over a wave's way there and back."""


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
    if rod.damping_time:
        return None
    force = share * rod.axial_stiffness * abs(rod.velocity) / rod.wave_speed
    duration = 2.0 * rod.length / rod.wave_speed
    values = {"mean force": force, "time from 5 % to 95 %": 0.9 * duration, "impulse, in the limit": force * duration}
    return Opinion("d'Alembert's waves", values)


@opinion("mass_on_rod")
def mass_on_rod(scenario: Scenario) -> Opinion | None:
    """St. Venant's mass on a rod with a fixed end, by the wave's way there and back (Goldsmith, Impact, 1960, 3.4).

    With s(t) the force of the wave that leaves the struck end, T = 2 L/c, u = s(t) - s(t - T) = EA v/c and the force
    u + 2 s(t - T), the mass moves as m v' = -force. None for a rod with damping.
    """
    p = scenario.parameters
    rod = next(b for b in scenario.model.bodies if isinstance(b, AxialRod))
    if rod.damping_time:
        return None
    start = rod.axial_stiffness * float(p["velocity"]) / rod.wave_speed
    mass = float(p["mass_ratio"]) * rod.mass_per_length * rod.length
    rate, there_and_back = rod.axial_stiffness / (mass * rod.wave_speed), 2.0 * rod.length / rod.wave_speed
    t, force = struck_rod(start, rate, there_and_back)
    handed = np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(t))))
    at = {share: float(np.interp(share * handed[-1], handed, t)) for share in (0.05, 0.25, 0.75, 0.95)}
    values = {
        "mean force": 0.5 * float(handed[-1]) / (at[0.75] - at[0.25]),
        "time from 5 % to 95 %": at[0.95] - at[0.05],
        "impulse, in the limit": float(handed[-1]),
    }
    return Opinion("St. Venant's waves", values)


def struck_rod(start: float, rate: float, there_and_back: float) -> tuple[Array, Array]:
    """(t, force) while the mass touches, s and N: the first force EA v/c, EA/(c m) in 1/s, and 2 L/c in s."""
    waves: list[Callable[[float], float]] = [lambda t: 0.0]
    times, forces = [np.zeros(0)], [np.zeros(0)]
    u, ends = start, False
    while not ends:
        before = waves[-1]
        part = solve_ivp(
            lambda t, y, before=before: -rate * (y + 2.0 * before(t)), (0.0, there_and_back), [u], "DOP853", rtol=RTOL,
            atol=ATOL * start, dense_output=True,
        )  # fmt: skip
        t = np.linspace(0.0, there_and_back, SAMPLES)
        force = part.sol(t)[0] + 2.0 * np.array([before(x) for x in t])
        past = np.flatnonzero(force <= 0.0)
        ends = past.size > 0
        last = int(past[0]) if ends else SAMPLES
        times.append(t[:last] + there_and_back * (len(waves) - 1))
        forces.append(force[:last])

        def wave(
            t: float, own: Callable[[float], Array] = part.sol, before: Callable[[float], float] = before
        ) -> float:
            return float(own(t)[0]) + before(t)

        waves.append(wave)
        u = float(part.y[0, -1])
    return np.concatenate(times), np.concatenate(forces)


@opinion("sphere_beam")
def sphere_beam(scenario: Scenario) -> Opinion | None:
    """Timoshenko's case (1913): the beam's modes and the sphere, by scipy."""
    p = scenario.parameters
    length, side, radius, density = (float(p[n]) for n in ("beam_length", "beam_side", "sphere_radius", "density"))
    orders = np.arange(1, 2 * int(p["modes"]), 2)
    # a mode's amplitude at midspan: its sine is 1 or -1 there
    modal = np.full(len(orders), 0.5 * density * side**2 * length)
    bending = float(p["youngs_modulus"]) * side**4 / 12.0
    stiffness = np.concatenate([[0.0], 0.5 * bending * length * (orders * math.pi / length) ** 4])
    mass = np.diag(np.concatenate([[density * 4.0 / 3.0 * math.pi * radius**3], modal]))
    row = np.concatenate([[1.0], -np.sin(0.5 * math.pi * orders)])
    (contact,) = scenario.model.contacts
    blow = Mechanism(
        mass=lambda q: mass,
        force=lambda t, q, v: -stiffness * q,
        gaps=lambda q: np.array([row @ q]),
        gradients=lambda q: row[None, :],
        laws=(law_of(contact.law),),
    )
    rest = np.zeros(len(orders))
    course = run(blow, [float(p["gap"]), *rest], [-float(p["speed"]), *rest], scenario.t_end, 1)
    last, flies = (float(x[0]) for x in course.state(course.end))

    def height(t: float) -> float:
        # after the blow the sphere flies on, and the beam's high modes would take most of the time
        return radius + (course.q(0)(t) if t <= course.end else last + flies * (t - course.end))

    return opinion_on(course, (contact.name,), {"sphere.y": height}, "scipy, the beam's modes")
