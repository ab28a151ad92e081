"""What a method is to its users: a name, options, and the formula that it makes of them."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ..errors import ModelError


@dataclass(frozen=True)
class Option:
    """One option of a method: a number from `minimum` to `maximum`, or one of the words in `choices`."""

    default: float | str
    minimum: float
    maximum: float
    description: str
    integer: bool = False
    choices: tuple[str, ...] = ()
    """Words that it may be; with minimum > maximum it must be one of them."""

    @property
    def numeric(self) -> bool:
        """True if it may be a number."""
        return self.minimum <= self.maximum

    @classmethod
    def word(cls, default: str, choices: tuple[str, ...], description: str) -> "Option":
        """An option that is one of `choices`."""
        return cls(default, 1.0, 0.0, description, choices=choices)

    def allowed(self) -> str:
        """What it may be, in words."""
        whole = "a whole number " if self.integer else ""
        numbers = [f"{whole}from {self.minimum:g} to {self.maximum:g}"] if self.numeric else []
        return " or ".join([*numbers, *(f"'{choice}'" for choice in self.choices)])

    def read(self, value: Any, name: str) -> float | str:
        """The value, checked. Raises ModelError naming the option."""
        if isinstance(value, str) and value in self.choices:
            return value
        number = not isinstance(value, bool) and isinstance(value, int | float)
        if not (self.numeric and number and self.minimum <= value <= self.maximum):
            raise ModelError(f"{name} must be {self.allowed()}, not {value!r}")
        if self.integer and int(value) != value:
            raise ModelError(f"{name} must be {self.allowed()}, not {value!r}")
        return float(value)


FINEST_WORKING = 1e-12
"""Tolerances of a step are not made finer than that: the error estimates of short steps are not far above rounding."""
MOST_SUMMED = 100.0
"""Number of steps whose errors are counted. More are taken only with tolerances that are too fine for the order, and
would become several times as many."""


@dataclass(frozen=True)
class Formula:
    """An integration formula ready to run."""

    step: Any
    k: int = 0
    """Number of steps of a multistep formula that has several; 0: its order is its own."""
    parameters: tuple[float, ...] = ()
    rows: int = 1
    """Rows of history that a step needs; below that the starter works."""
    stages: tuple[float, ...] = (1.0,)
    """Times of the stages in units of the step: none of them should fall on a singular position."""
    growth: float = 2.0
    """Largest factor by which error control lets a multistep step grow, each time after `rows` equal steps."""
    select: Any = None
    """Chooses the number of steps after an accepted step (a function of STEP_SIGNATURE); None: it is fixed."""
    stage: Any = None
    """The stage solver of a comparison method; None: that of TLISMNI with the chosen outer loop."""
    newton_tolerance: float = 0.01
    """Where the outer loop stops with error control, as a fraction of the error weights."""
    slack: float = 1e4
    """How many times looser than in the end the constraints may be met, at most, while the outer loop moves."""
    outer_loops: tuple[str, ...] = ("newton", "simple", "jfnk")
    """Outer loops that can solve its stages; a stage solver of its own knows newton alone."""
    weights: tuple[tuple[float, ...], ...] = ()
    """First content of the method record's `weights`, row by row."""
    carries: bool = False
    """True if it carries accelerations of its own from step to step, beside the true ones."""
    sums_up: float = 0.0
    """Order p (2 or more) of a formula that is judged by its own error of a step; 0: by that of a formula of one order
    less, which it is better than, or not at all (`working_tolerance`)."""
    embedded: bool = False
    """True if its error is the difference to an embedded formula, in all coordinates whether they depend or not."""
    impulses: bool = False
    """True if the contacts of a whole run are impulses of its steps, and no events are located."""
    sweeps: int = 1000
    """Sweeps over the contacts, at most, in a step of impulses."""
    exact: bool = True
    """True if the steps meet the constraints at all levels; then samples between steps are made to meet them too."""

    def working_tolerance(self, rtol: float) -> float:
        """The tolerance of the error of a step for errors of the run of about `rtol`.

        The errors of steps add up. Steps of size h with an error C h^(p+1) each leave C h^p a unit of time: where that
        of a step is tol, the sum falls as tol^(p/(p+1)) only, and is larger by the number of steps. So steps are held
        to rtol^((p+1)/p), that is rtol over the number of steps, rtol^(-1/p); then the error of the run falls as rtol.
        Radau5 (Hairer and Wanner) changes its tolerances in the same way. Formulas that are judged by a lower one have
        no need of it: their error falls as tol itself.
        """
        if self.sums_up < 2.0:
            return rtol
        return max(min(rtol, FINEST_WORKING), rtol * max(rtol ** (1.0 / self.sums_up), 1.0 / MOST_SUMMED))


@dataclass(frozen=True)
class Method:
    """A method as users know it."""

    name: str
    description: str
    options: Mapping[str, Option]
    formula: Callable[[Mapping[str, Any]], Formula] = field(repr=False)
    family: str = "TLISMNI"
