"""The scenario of the catalogue that a model comes from: the parameters of its builder as parameters of the slave.

A builder makes many fields of a model from few parameters: a length becomes positions, inertias and marker points. So
a changed parameter goes through the builder again, which gives what `tlismni.models.load` gives for it. The variables
of a slave are fixed, and with them the structure of its model: parameters that change it (numbers of elements, kinds of
laws, switches) are none of the slave's, and a value that would change it is refused.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from ..core.errors import ModelError
from ..core.multibody_model import Model
from .errors import FmuValueError
from .settings import Settings
from .structure import difference
from .variables import Variable

if TYPE_CHECKING:
    from ..models import Scenario, ScenarioParameter

PREFIX = "scenario."
"""Before the name of a parameter whose own name an input or channel has."""
KINDS = {"number": "real", "integer": "integer", "switch": "boolean"}
NEAR = 2.0**-10
"""Relative change by which it is tried what a number does to the model; of 0 it is the absolute one."""


@dataclass(frozen=True)
class Origin:
    """A scenario by its name and the values that its builder was given; None of what was left to the builder."""

    name: str
    given: Mapping[str, Any]

    @classmethod
    def of(cls, source: Any, model: Model) -> "Origin | None":
        """The origin of `source`; None if that is no scenario of the catalogue, or holds another model than its
        builder makes."""
        if isinstance(source, Model):
            return None
        from ..models import Scenario

        if not isinstance(source, Scenario) or not source.given:
            return None
        origin = cls(source.name, dict(source.given))
        return origin if origin._makes(model) else None

    def to_data(self) -> dict[str, Any]:
        """The origin as JSON data."""
        return {"name": self.name, "parameters": dict(self.given)}

    @property
    def base(self) -> "Scenario":
        """The scenario as it is without changes. Raises ScenarioError if the catalogue has none like it."""
        return _load(self.name, tuple(sorted(self.given.items())))

    def variables(self, taken: set[str], number: Iterator[int]) -> Iterator[Variable]:
        """The parameters that can be changed, with the next value references of `number`. `taken` are names that
        others have."""
        for p in _changeable(self.name, tuple(sorted(self.given.items()))):
            start: Any = self.base.parameters[p.name]
            text = p.description
            if self.given[p.name] is None:
                text += "; while it is at its start value, it follows from the other parameters"
            real = p.kind == "number"
            yield Variable(
                next(number), PREFIX + p.name if p.name in taken else p.name, KINDS[p.kind], "parameter", "scenario",  # type: ignore[arg-type]
                _unit(p.unit) if real else None, text, float(start) if real else start, p.minimum, p.maximum,
                nominal=abs(start) or None if real else None,
            )  # fmt: skip

    def check(self, variable: Variable, value: Any) -> None:
        """Refuse with FmuValueError a value that the parameter cannot take, or that alone gives another structure.

        What only fits together with other parameters is seen when the model is built.
        """
        name = variable.name.removeprefix(PREFIX)
        who = f"'{variable.name}' (value reference {variable.reference})"
        if value == variable.start:
            return
        known = {p.name: p for p in _table(self.name)}
        if name not in known:
            raise FmuValueError(
                f"{who} cannot be changed: the tlismni that runs here has no scenario '{self.name}' with it, which the "
                "FMU was exported from; use that version, or export the FMU anew"
            )
        try:
            known[name].check(value)
        except ModelError as error:
            raise FmuValueError(f"{who} was set to {value!r}: {error}") from None
        try:
            base, scenario = self.base, self._load({name: value})
        except ModelError:
            return
        where = difference(base.model, scenario.model)
        if where:
            raise FmuValueError(
                f"{who} was set to {value!r}, which gives a model of another structure ({where}), and the variables of "
                f"this FMU are fixed: export it with --set {name}={value!r}, or in Python from load({self.name!r}, "
                f"{name}={value!r})"
            )

    def changed(self, changes: Mapping[str, Any], model: Model) -> "Scenario":
        """The scenario with `changes`, by name of the variable; `model` is the one without.

        Raises
        ------
        ModelError : if the builder refuses the values, they give a model of another structure, or the catalogue here
            makes another model than the one of the FMU.
        """
        given = {name.removeprefix(PREFIX): value for name, value in changes.items()}
        if not self._makes(model):
            raise ModelError(
                f"{sorted(given)} cannot be changed: the tlismni that runs here builds scenario '{self.name}' "
                "otherwise than the one that exported the FMU; export it anew"
            )
        scenario = self._load(given)
        where = difference(model, scenario.model)
        if where:
            raise ModelError(
                f"the parameters {given} together give a model of another structure than the FMU's ({where}), whose "
                "variables are fixed: export the FMU with them"
            )
        return scenario

    def derived(self, scenario: "Scenario") -> dict[str, Any]:
        """Values that the builder gave the parameters left to it, by name of the variable."""
        found = {name: scenario.parameters[name] for name, value in self.given.items() if value is None}
        return {name: value for name, value in found.items() if value is not None}

    def settings(self, exported: Settings, scenario: "Scenario") -> Settings:
        """The settings with those that the builder gave the changed scenario, where the export had left them to it."""
        before, after = Settings.of(self.base)[1], Settings.of(scenario)[1]
        own = {
            name: getattr(after, name)
            for name in ("rtol", "atol", "step")
            if getattr(exported, name) == getattr(before, name)
        }
        if not exported.method == before.method == after.method:
            return replace(exported, **own)
        left = {k: v for k, v in after.options.items() if exported.options.get(k) == before.options.get(k)}
        return replace(exported, options={**exported.options, **left}, **own)

    def _load(self, changes: Mapping[str, Any]) -> "Scenario":
        from ..models import load

        return load(self.name, **{**self.given, **changes})

    def _makes(self, model: Model) -> bool:
        """Whether the builder makes `model`."""
        try:
            base = self.base
        except ModelError:
            return False
        return base.model is model or base.model.model_dump(mode="json") == model.model_dump(mode="json")


def _unit(text: str) -> str:
    """A unit as channels write it."""
    return "1" if text == "-" else text.replace("^2", "2").replace("^3", "3")


def _table(scenario: str) -> "tuple[ScenarioParameter, ...]":
    """The parameters of a scenario; none if the catalogue does not have it."""
    from ..models import catalogue

    return next((entry.parameters for entry in catalogue() if entry.name == scenario), ())


@lru_cache(maxsize=64)
def _load(name: str, given: tuple[tuple[str, Any], ...]) -> "Scenario":
    from ..models import load

    return load(name, **dict(given))


@lru_cache(maxsize=64)
def _changeable(name: str, given: tuple[tuple[str, Any], ...]) -> "tuple[ScenarioParameter, ...]":
    """The parameters that have a value and that change the model, or how it is solved, but not its structure."""
    return tuple(p for p in _table(name) if p.kind in KINDS and _can_change(_load(name, given), p))


def _can_change(base: "Scenario", p: "ScenarioParameter") -> bool:
    from ..models import load

    matters = False
    for value in _others(p, base.parameters[p.name]):
        try:
            other = load(base.name, **{**base.given, p.name: p.check(value)})
        except ModelError:  # out of range, or not with the other parameters: another one may be in
            continue
        if difference(base.model, other.model):
            return False
        matters |= other.model != base.model or _solver(other) != _solver(base)
    return matters


def _solver(scenario: "Scenario") -> Settings:
    """How a scenario is solved, the end of its time aside."""
    return replace(Settings.of(scenario)[1], t_end=None)


def _others(p: "ScenarioParameter", value: Any) -> tuple[Any, ...]:
    """Values near and far from `value` to try; none if it has none."""
    if value is None:
        return ()
    if p.kind == "switch":
        return (not value,)
    if p.kind == "integer":
        return (value + 1, value - 1)
    near = NEAR * abs(value) or NEAR
    return (value + near, value - near, *((2.0 * value, 0.5 * value) if value else ()))
