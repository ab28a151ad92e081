"""The methods by name: their step, their options and how much history they need."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..errors import ModelError
from .bdf import bdf_step
from .ebdf import ebdf_step
from .newmark import newmark_step
from .sdirk import C, sdirk_fine_step, sdirk_step


@dataclass(frozen=True)
class Option:
    """One option of a method."""

    default: float
    minimum: float
    maximum: float
    description: str
    integer: bool = False


@dataclass(frozen=True)
class Formula:
    """An integration formula ready to run."""

    step: Any
    order: int = 0
    parameters: tuple[float, ...] = ()
    rows: int = 1
    """Rows of history that a step needs; below that the starter works."""
    stages: tuple[float, ...] = (1.0,)
    """Times of the stages in units of the step: none of them should fall on a singular position."""
    growth: float = 2.0
    """Largest factor by which error control lets a multistep step grow, each time after `rows` equal steps."""


@dataclass(frozen=True)
class Method:
    """A method as users know it."""

    name: str
    description: str
    options: Mapping[str, Option]
    formula: Callable[[Mapping[str, float]], Formula] = field(repr=False)


STARTER_STAGES = tuple(float(c) for c in C)

# With growth by 2 after k + 1 equal steps the variable-step formulas are zero-stable up to k = 6; beyond, these are.
EBDF_GROWTH = {7: 1.5, 8: 1.2}


def _extended(k: int, modified: float) -> Formula:
    return Formula(ebdf_step, k, (modified,), k + 1, (1.0, 2.0), EBDF_GROWTH.get(k, 2.0))


def _hht(values: Mapping[str, float]) -> Formula:
    alpha = values["alpha"]
    return Formula(newmark_step, 2, (alpha, (1.0 - alpha) ** 2 / 4.0, 0.5 - alpha))


METHODS = {
    method.name: method
    for method in (
        Method(
            "newmark",
            "TLISMNI with Newmark's formula, accelerations as unknowns; order 2 for gamma = 1/2",
            {
                "beta": Option(0.25, 0.01, 2.0, "beta; 1/4 with gamma 1/2 is the average acceleration"),
                "gamma": Option(0.5, 0.5, 1.5, "gamma; above 1/2 it damps, at order 1"),
            },
            lambda o: Formula(newmark_step, 2, (0.0, o["beta"], o["gamma"])),
        ),
        Method(
            "hht",
            "TLISMNI with the HHT-alpha formula, accelerations as unknowns; order 2",
            {"alpha": Option(-0.05, -1.0 / 3.0, 0.0, "numerical damping: 0 none, -1/3 most")},
            _hht,
        ),
        Method(
            "bdf",
            "TLISMNI with the BDF of fixed order, coordinates and velocities as unknowns",
            {"order": Option(3, 1, 5, "order k", integer=True)},
            lambda o: Formula(bdf_step, int(o["order"]), (), int(o["order"]) + 1),
        ),
        Method(
            "ebdf",
            "TLISMNI with Cash's extended BDF of fixed k, order k + 1; A-stable up to k = 3",
            {"k": Option(4, 1, 8, "number of steps k; the order is k + 1", integer=True)},
            lambda o: _extended(int(o["k"]), 0.0),
        ),
        Method(
            "mebdf",
            "TLISMNI with the modified extended BDF: as ebdf, more stable, one matrix for all its stages",
            {"k": Option(4, 1, 8, "number of steps k; the order is k + 1", integer=True)},
            lambda o: _extended(int(o["k"]), 1.0),
        ),
        Method(
            "irk",
            "TLISMNI with the implicit Runge-Kutta method SDIRK of order 4, L-stable, self-starting",
            {},
            lambda o: Formula(sdirk_step, 4, stages=STARTER_STAGES),
        ),
    )
}

STARTER = sdirk_step
FINE_STARTER = sdirk_fine_step


def get_formula(name: str, options: Mapping[str, Any]) -> Formula:
    """The formula of method `name` with `options`.

    Raises
    ------
    ModelError : for an unknown method or option, or a value outside its range.
    """
    if name not in METHODS:
        raise ModelError(f"unknown method '{name}'; known are {sorted(METHODS)}")
    method = METHODS[name]
    unknown = set(options) - set(method.options)
    if unknown:
        raise ModelError(f"method '{name}' has no option {sorted(unknown)}; it has {sorted(method.options)}")
    values = {key: option.default for key, option in method.options.items()}
    for key, value in options.items():
        option = method.options[key]
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ModelError(f"option {key} of method '{name}' must be a number, not {value!r}")
        if option.integer and int(value) != value:
            raise ModelError(f"option {key} of method '{name}' must be a whole number, not {value!r}")
        if not option.minimum <= value <= option.maximum:
            raise ModelError(
                f"option {key} of method '{name}' must be from {option.minimum:g} to {option.maximum:g}, not {value!r}"
            )
        values[key] = float(value)
    return method.formula(values)
