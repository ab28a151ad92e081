"""Solver settings of a slave: what an FMU carries beside the model."""

import math
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from ..core.equations.system import EquationSystem
from ..core.methods.default import DEFAULT_METHOD
from ..core.multibody_model import Model
from ..core.tolerances import DEFAULT_ATOL
from .errors import FmuValueError, SourceError

OWN = ("method", "rtol", "atol", "step", "t_end", "communication_step")


@dataclass(frozen=True)
class Settings:
    """How a slave solves.

    Attributes
    ----------
    method : integration method of `tlismni.core`.
    rtol, atol : relative and absolute tolerance of the error control. atol's default, 1e-9, is a part of the model's
        own scales, another number counts in the units of the coordinates and velocities.
    step : fixed internal step, s; 0 for error control.
    options : further options of the method. Those that are a bool, int, float or str become FMU parameters.
    t_end : end of the default experiment, s, or None.
    communication_step : preferred communication step, s, or None.
    """

    method: str = DEFAULT_METHOD
    rtol: float = 1e-6
    atol: float = float(DEFAULT_ATOL)
    step: float = 0.0
    options: Mapping[str, Any] = field(default_factory=dict)
    t_end: float | None = None
    communication_step: float | None = None

    def __post_init__(self) -> None:
        for name in ("rtol", "atol", "step", "t_end", "communication_step"):
            value = getattr(self, name)
            if value is not None:
                check_solver_value(name, value)

    @classmethod
    def of(cls, source: Any, **given: Any) -> "tuple[Model, Settings]":
        """The model and the settings of a model or scenario; `given` wins over the scenario's own.

        Raises
        ------
        SourceError (a TypeError) : if `source` is neither a Model nor has a `.model` that is one.
        FmuValueError : for a setting out of range.
        """
        model = source if isinstance(source, Model) else getattr(source, "model", None)
        if isinstance(source, EquationSystem) or isinstance(model, EquationSystem):
            raise SourceError(
                "an EquationSystem cannot become a slave or an FMU: an FMU embeds its model as data, which any "
                "machine can read and check, and user functions are code; describe the system as a "
                "tlismni.core.Model, or step it in Python with tlismni.core.Simulation"
            )
        if not isinstance(model, Model):
            raise SourceError(
                f"a Model or a Scenario is needed, not {type(source).__name__}; "
                "use tlismni.core.Model.load(path) or tlismni.models.load(name)"
            )
        merged: dict[str, Any] = dict(getattr(source, "options", None) or {}) if source is not model else {}
        if source is not model:
            merged |= {k: getattr(source, k) for k in OWN if getattr(source, k, None) is not None}
        merged |= given
        own = {k: merged.pop(k) for k in OWN if k in merged}
        if own.get("step", 0.0) is None:  # the solver's word for error control
            own["step"] = 0.0
        own = {k: v for k, v in own.items() if v is not None}
        numbers = {k: float(v) for k, v in own.items() if k != "method"}
        return model, cls(method=str(own.get("method", cls.method)), options=merged, **numbers)

    @property
    def tolerance(self) -> float:
        """`atol` as the solver understands it: variables are plain numbers, which cannot say that they are a part."""
        return DEFAULT_ATOL if self.atol == DEFAULT_ATOL else self.atol

    def as_arguments(self) -> dict[str, Any]:
        """The settings as keyword arguments of `Settings.of`."""
        data = asdict(self)
        return {**data.pop("options"), **data}


def check_solver_value(name: str, value: float) -> None:
    """Refuse a solver figure out of range with FmuValueError."""
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise FmuValueError(f"'{name}' = {value!r} is not a finite number")
    if name == "step" and value < 0.0:
        raise FmuValueError(f"'step' = {value!r} s is negative: give a fixed step, or 0 for error control")
    if name != "step" and value <= 0.0:
        raise FmuValueError(f"'{name}' = {value!r} must be greater than 0")
