"""Third opinions on rods and beams: waves and modes."""

import math

from ...core.elements import AxialRod
from ...models import Scenario
from ..third_opinion import Opinion, opinion


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
