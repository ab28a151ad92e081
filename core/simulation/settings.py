"""The settings of a run, checked."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from ..assembly.assembly import Assembly
from ..errors import ModelError
from ..methods.method import Formula
from ..rounding import CONSTRAINT_TOLERANCES, FINEST
from ..stage import OUTER_LOOPS
from ..stage.simple import MOST_DEPTH
from ..time_loop.controllers import CONTROLLERS

ACCELERATIONS = ("none", "aitken", "anderson")
START_TOLERANCE = 1e-3
"""How far q0 (relative to the size of the mechanism) and v0 (relative to the speeds) may be moved, by default."""
REDUNDANT = ("drop", "refuse")
"""What is done with constraints that repeat others."""
CONSTRAINT_SHARE = 0.002
"""Of the finest absolute tolerance: what a violation of the constraints may be. The solution of the constraints and the
level of the coordinates (`position_level`) enlarge it by ten and more."""
LEAST_EXACTNESS = 1e-2
"""Rounding allows no more (`exactness`)."""
TOLERANCE_KINDS = ("length", "angle", "speed", "angular_speed")
"""What absolute tolerances can be told apart by: translations, rotations and their rates."""
SINGULAR_NOISE = 2.5e13
"""A hundredth of the inverse of rounding, since the outer loop stops at a hundredth of the tolerance; and a tenth for
coordinates of ten."""


@dataclass(frozen=True)
class Settings:
    """What a run is started with."""

    method: str
    rtol: float
    atol: float | Mapping[str, float]
    step: float | None
    max_step: float | None
    first_step: float | None
    t0: float
    outer: str
    acceleration: str
    depth: int
    fallback: bool
    controller: str
    newton_tolerance: float | None
    start_tolerance: float
    redundant: str = "drop"
    max_steps: int | None = None
    method_options: dict[str, Any] = field(default_factory=dict)
    method_chosen: str = field(default="", repr=False)
    """What `method="auto"` took, and why; `method` is what was taken. States are of that, whoever chose it."""

    @property
    def of_choice(self) -> dict[str, Any]:
        """Arguments of `Simulation` that take the chosen method again, whatever the model; none if none was chosen."""
        return {"method": self.method, **self.method_options} if self.method_chosen else {}

    def __post_init__(self) -> None:
        for name in ("rtol", "step", "max_step", "first_step", "newton_tolerance", "start_tolerance"):
            value = getattr(self, name)
            if value is None and name not in ("rtol", "start_tolerance"):
                continue
            _check_positive(name, value, infinite=name == "max_step")
        if isinstance(self.atol, Mapping):
            unknown = set(self.atol) - set(TOLERANCE_KINDS)
            if unknown:
                raise ModelError(f"atol has no kind {sorted(unknown)}; there are {list(TOLERANCE_KINDS)}")
            for kind, value in self.atol.items():
                _check_positive(f"atol of {kind}", value)
        else:
            _check_positive("atol", self.atol)
        if self.rtol < 1e-14:
            raise ModelError(f"rtol = {self.rtol!r} is below what double precision can resolve; use at least 1e-13")
        if not isinstance(self.t0, int | float) or not math.isfinite(self.t0):
            raise ModelError(f"t0 must be a finite number, not {self.t0!r}")
        for name, choices in (
            ("outer", tuple(OUTER_LOOPS)),
            ("acceleration", ACCELERATIONS),
            ("controller", tuple(CONTROLLERS)),
            ("redundant", REDUNDANT),
        ):
            if getattr(self, name) not in choices:
                raise ModelError(f"{name} = {getattr(self, name)!r} is unknown; there are {list(choices)}")
        if self.acceleration != "none" and self.outer != "simple":
            raise ModelError(
                f"acceleration = '{self.acceleration}' belongs to outer = 'simple', not to outer = '{self.outer}'"
            )
        if isinstance(self.depth, bool) or not isinstance(self.depth, int) or not 1 <= self.depth <= MOST_DEPTH:
            raise ModelError(
                f"depth = {self.depth!r} of Anderson's acceleration must be a whole number 1 to {MOST_DEPTH}"
            )
        if self.max_steps is not None and (
            isinstance(self.max_steps, bool) or not isinstance(self.max_steps, int) or self.max_steps < 1
        ):
            raise ModelError(f"max_steps must be a whole number of at least 1, or None, not {self.max_steps!r}")
        if not isinstance(self.fallback, bool):
            raise ModelError(f"fallback must be True or False, not {self.fallback!r}")


def _check_positive(name: str, value: Any, infinite: bool = False) -> None:
    if isinstance(value, bool) or not isinstance(value, int | float) or not value > 0.0:
        raise ModelError(f"{name} must be a positive number, not {value!r}")
    if not math.isfinite(value) and not infinite:
        raise ModelError(f"{name} must be finite, not {value!r}")


SPEEDS = 0.1
"""Of the speeds that the model's time makes of its lengths: what its default tolerances are a part of. That time is
that of the fastest of its motions and forces, and most of what moves is slower."""
DEFAULT_NEWTON_TOLERANCE = 1e-10
"""Of runs with fixed steps: a part of the lengths, and of all the speeds that the model's time makes of them, since
what rounding leaves in stiff bodies is not far below."""


def set_control(settings: Settings, formula: Formula, assembly: Assembly, control: Any) -> None:
    """Fill the workspace's control numbers, but for those of the outer loop (`Engine.use_outer_loop`) and those that
    the model's own scales are needed for (`begin_measure.py`)."""
    if settings.step is not None:
        # fixed steps have no error weights: the outer loop's tolerance takes their place, with weight 1
        control.rtol = control.atol = settings.newton_tolerance or DEFAULT_NEWTON_TOLERANCE
        control.newton_tolerance = 1.0
    else:
        control.rtol = formula.working_tolerance(settings.rtol)
        control.newton_tolerance = settings.newton_tolerance or max(
            formula.newton_tolerance, min(0.01, FINEST / control.rtol)
        )
    control.position_tolerance, control.velocity_tolerance, control.acceleration_tolerance = CONSTRAINT_TOLERANCES
    control.acceleration = {"none": 0.0, "aitken": 1.0, "anderson": 1.0 + settings.depth}[settings.acceleration]
    # with a contraction of a tenth, down to CONSTRAINT_TOLERANCES
    control.max_inner = 13.0
    control.most_slack = formula.slack
    control.is_linear = float(assembly.linear)
    # accelerations carry the rounding of the constraints times condition^3: from here on the outer loop would see it
    control.most_condition = max(6.0, (control.rtol * SINGULAR_NOISE) ** (1.0 / 3.0))
