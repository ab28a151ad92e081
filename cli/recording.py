"""How much of a run is recorded when nobody says: every step, unless that would fill the memory."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..models import Scenario

LARGEST_RECORD = 1e9
"""Bytes of samples that a run may keep."""
FEWEST_TIMES = 50
ASSUMED_STEPS = 20_000
"""Of runs with error control, whose number of steps nobody knows before."""


def record_bytes(scenario: "Scenario") -> float:
    """About what samples of all steps would take: position, velocity and acceleration of every coordinate."""
    coordinates = sum(len(body.coordinate_names) for body in scenario.model.bodies)
    step = scenario.options.get("step")
    steps = scenario.t_end / step if step else ASSUMED_STEPS
    return 8.0 * 3.0 * coordinates * steps


def affordable_times(scenario: "Scenario") -> Sequence[float] | None:
    """None if all steps can be recorded, else times at equal distances that fit."""
    needed = record_bytes(scenario)
    if needed <= LARGEST_RECORD:
        return None
    step = scenario.options.get("step")
    steps = scenario.t_end / step if step else ASSUMED_STEPS
    count = max(FEWEST_TIMES, int(steps * LARGEST_RECORD / needed))
    return [min(k * scenario.t_end / count, scenario.t_end) for k in range(count + 1)]
