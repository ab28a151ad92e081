"""The communication step that is recommended for a model: `DefaultExperiment stepSize` of its FMU."""

import math
from typing import Any

from ..core.analysis.time_scales import contact_durations, vibration_period
from ..core.multibody_model import Model
from .scales import Scales

POINTS = 20
"""Communication points within the shortest time that matters."""
LEAST_POINTS = 100
"""Communication points within the default experiment."""


def recommended_step(simulation: Any, model: Model, t_end: float | None) -> float | None:
    """A round step, s: at most a twentieth of the shortest of these times, and a hundredth of `t_end` (s):

    * the shortest period among the vibrations that make up 95 % of the compliance at the inputs,
    * the durations of blows in contacts with a force law, pi d/v,
    * if there is neither: the time of falling or flying through the model's dimensions.

    Contacts that are constraints have no duration: the slave finds their instants by itself. None if nothing is known.
    """
    if not hasattr(simulation, "assembly"):  # not of this package's solver: a power of ten
        return float(f"1e{math.floor(math.log10(t_end)) - 2}") if t_end else None
    scales = Scales.of(model, t_end)
    times = [vibration_period(simulation), *contact_durations(simulation, scales.length / scales.time).values()]
    times = [t for t in times if 0.0 < t < math.inf] or ([scales.time] if t_end or scales.time != 1.0 else [])
    limits = [t / POINTS for t in times] + ([t_end / LEAST_POINTS] if t_end else [])
    return round_down(min(limits)) if limits else None


def round_down(value: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above `value`, which is positive."""
    power = math.floor(math.log10(value))
    candidates = [float(f"{digit}e{power + shift}") for shift in (-1, 0, 1) for digit in (1, 2, 5)]
    return max(c for c in candidates if c <= value * (1.0 + 1e-12))
