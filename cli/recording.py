"""How much of a run is recorded when nobody says: every step, unless that would fill the memory."""

import math
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..models import Scenario

LARGEST_RECORD = 5e8
"""Bytes of samples that a run may keep."""
ASSUMED_STEPS = 20_000
"""Of runs with error control, whose number of steps nobody knows before."""


def record_bytes(scenario: "Scenario") -> float:
    """About what samples of all steps would take: position, velocity and acceleration of every coordinate."""
    coordinates = sum(len(body.coordinate_names) for body in scenario.model.bodies)
    step = scenario.options.get("step")
    steps = scenario.t_end / step if step else ASSUMED_STEPS
    return 8.0 * 3.0 * coordinates * steps


def affordable_stride(scenario: "Scenario") -> int:
    """1 if all steps can be recorded, else the number k of which every k-th can."""
    return max(1, math.ceil(record_bytes(scenario) / LARGEST_RECORD))
