"""The parameters of a scenario: name, default, unit, range, meaning.

One table serves the builder, its checks, `tlismni list` and the command line.
"""

import difflib
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from ..core.errors import ModelError

LARGEST_INTEGER = 20_000.0
"""Largest value of an integer parameter that does not say its own."""

Value = float | int | bool | str | None


class ScenarioError(ModelError):
    """An unknown scenario, an unknown parameter, or a value that a parameter cannot take."""


@dataclass(frozen=True)
class ScenarioParameter:
    """One parameter of a scenario.

    `kind` follows from `default`: "number", "integer", "switch" or "choice". An integer without `maximum` goes up to
    LARGEST_INTEGER: integers count parts of a model, and a slip of the pen must not fill the memory.

    Raises
    ------
    ScenarioError : if the default is not in the range, or the range is empty.
    """

    name: str
    default: Value
    unit: str
    description: str
    minimum: float | None = None
    maximum: float | None = None
    exclusive: bool = False
    """True if the value must lie strictly above `minimum`."""
    choices: tuple[str, ...] = ()
    optional: bool = False
    """True if None is allowed (the description says what it means)."""

    @property
    def kind(self) -> str:
        if self.choices:
            return "choice"
        if isinstance(self.default, bool):
            return "switch"
        return "integer" if isinstance(self.default, int) else "number"

    def __post_init__(self) -> None:
        if self.kind == "integer" and self.maximum is None:
            object.__setattr__(self, "maximum", LARGEST_INTEGER)
        if self.minimum is not None and self.maximum is not None and self.minimum > self.maximum:
            raise ScenarioError(
                f"parameter '{self.name}' has minimum {self.minimum:g} above maximum {self.maximum:g}: no value fits"
            )
        if self.default is not None:
            self.check(self.default)

    def check(self, value: Any) -> Value:
        """`value` in the parameter's type. Raises ScenarioError if it cannot be."""
        if value is None and self.optional:
            return None
        if self.kind == "choice":
            if value not in self.choices:
                raise ScenarioError(
                    f"parameter '{self.name}' = {value!r} is not one of {list(self.choices)}"
                    f"{_nearest(str(value), self.choices)}"
                )
            return str(value)
        if self.kind == "switch":
            if not isinstance(value, bool):
                raise ScenarioError(f"parameter '{self.name}' = {value!r} must be true or false")
            return value
        return self._check_number(value)

    def _check_number(self, value: Any) -> float | int:
        try:
            number = float(value)
        except (TypeError, ValueError):
            number = math.nan
        if isinstance(value, bool | str) or not math.isfinite(number):
            raise ScenarioError(f"parameter '{self.name}' = {value!r} must be a finite number, unit {self.unit}")
        if self.kind == "integer" and number != int(number):
            raise ScenarioError(f"parameter '{self.name}' = {value!r} must be a whole number")
        too_low = self.minimum is not None and (number < self.minimum or (self.exclusive and number == self.minimum))
        if too_low or (self.maximum is not None and number > self.maximum):
            raise ScenarioError(f"parameter '{self.name}' = {number:g} is outside {self.range_text()}")
        return int(number) if self.kind == "integer" else number

    def parse(self, text: str) -> Value:
        """The value that `text` (from a command line) means. Raises ScenarioError."""
        word = text.strip().lower()
        if self.optional and word in {"none", "auto", ""}:
            return None
        if self.kind == "switch" and word in {"true", "yes", "on", "1"}:
            return True
        if self.kind == "switch" and word in {"false", "no", "off", "0"}:
            return False
        if self.kind in {"number", "integer"}:
            try:
                return self.check(float(word))
            except ValueError as error:
                if isinstance(error, ScenarioError):
                    raise
                raise ScenarioError(f"parameter '{self.name}': '{text}' is not a number") from None
        return self.check(text.strip())

    def range_text(self) -> str:
        """The range in words, e.g. "(0, 1]"; empty if there is none."""
        if self.minimum is None and self.maximum is None:
            return ""
        low = "(-inf" if self.minimum is None else f"{'(' if self.exclusive else '['}{self.minimum:g}"
        high = "inf)" if self.maximum is None else f"{self.maximum:g}]"
        return f"{low}, {high}"


def unknown(kind: str, given: str, known: Iterable[str]) -> ScenarioError:
    """The error for a name that is not there: lists what is, and the nearest match."""
    names = sorted(known)
    return ScenarioError(f"there is no {kind} '{given}'{_nearest(given, names)}; there are {names}")


def fill(owner: str, table: Sequence[ScenarioParameter], given: Mapping[str, Any]) -> dict[str, Value]:
    """All values of the parameters in `table`: the given ones, checked, and the defaults of the others."""
    by_name = {parameter.name: parameter for parameter in table}
    for name in given:
        if name not in by_name:
            raise unknown(f"parameter of scenario '{owner}' named", name, by_name)
    return {name: p.check(given[name]) if name in given else p.default for name, p in by_name.items()}


def _nearest(given: str, known: Iterable[str]) -> str:
    match = difflib.get_close_matches(given, list(known), n=1, cutoff=0.5)
    return f" (did you mean '{match[0]}'?)" if match else ""
