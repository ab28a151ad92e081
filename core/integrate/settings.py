"""The settings of a run, checked."""

import math
from dataclasses import dataclass, field
from typing import Any

from numpy.typing import NDArray

from ..errors import ModelError
from ..system.records import (
    ACCELERATION_TOLERANCE,
    ATOL,
    MAX_INNER,
    MAX_OUTER,
    MOST_CONDITION,
    NEWTON_TOLERANCE,
    OUTER_LOOP,
    POSITION_TOLERANCE,
    RTOL,
    VELOCITY_TOLERANCE,
)

OUTER_LOOPS = ("newton", "simple")
REDUNDANT = ("drop", "refuse")
"""What is done with constraints that repeat others."""
CONSTRAINT_TOLERANCES = (1e-12, 1e-12, 1e-12)
"""At position, velocity and acceleration level: absolute below 1, relative to the largest entry above."""
SINGULAR_NOISE = 2.5e13
"""A hundredth of the inverse of rounding, since the outer loop stops at a hundredth of the tolerance; and a tenth for
coordinates of ten."""


@dataclass(frozen=True)
class Settings:
    """What a run is started with."""

    method: str
    rtol: float
    atol: float
    step: float | None
    max_step: float | None
    first_step: float | None
    t0: float
    outer: str
    newton_tolerance: float | None
    start_tolerance: float
    redundant: str = "drop"
    method_options: dict[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for name in ("rtol", "atol", "step", "max_step", "first_step", "newton_tolerance", "start_tolerance"):
            value = getattr(self, name)
            if value is None and name not in ("rtol", "atol", "start_tolerance"):
                continue
            if isinstance(value, bool) or not isinstance(value, int | float) or not value > 0.0:
                raise ModelError(f"{name} must be a positive number, not {value!r}")
            if not math.isfinite(value) and name != "max_step":
                raise ModelError(f"{name} must be finite, not {value!r}")
        if self.rtol < 1e-14:
            raise ModelError(f"rtol = {self.rtol!r} is below what double precision can resolve; use at least 1e-13")
        if not isinstance(self.t0, int | float) or not math.isfinite(self.t0):
            raise ModelError(f"t0 must be a finite number, not {self.t0!r}")
        if self.outer not in OUTER_LOOPS:
            raise ModelError(f"outer loop '{self.outer}' is unknown; there are {list(OUTER_LOOPS)}")
        if self.redundant not in REDUNDANT:
            raise ModelError(f"redundant must be one of {list(REDUNDANT)}, not {self.redundant!r}")


def set_control(settings: Settings, control: NDArray[Any]) -> None:
    """Fill the workspace's control numbers."""
    fixed = settings.step is not None
    if fixed:
        # fixed steps have no error weights: the outer loop's tolerance takes their place, with weight 1
        tolerance = settings.newton_tolerance or 1e-10
        control[RTOL] = control[ATOL] = tolerance
        control[NEWTON_TOLERANCE] = 1.0
    else:
        control[RTOL], control[ATOL] = settings.rtol, settings.atol
        control[NEWTON_TOLERANCE] = settings.newton_tolerance or 0.01
    control[POSITION_TOLERANCE], control[VELOCITY_TOLERANCE], control[ACCELERATION_TOLERANCE] = CONSTRAINT_TOLERANCES
    control[OUTER_LOOP] = float(OUTER_LOOPS.index(settings.outer))
    control[MAX_OUTER] = 10.0 if settings.outer == "newton" else 60.0
    control[MAX_INNER] = 12.0
    # accelerations carry the rounding of the constraints times condition^3: from here on the outer loop would see it
    control[MOST_CONDITION] = max(6.0, (control[RTOL] * SINGULAR_NOISE) ** (1.0 / 3.0))
