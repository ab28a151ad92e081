"""The catalogue: scenarios by name."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

from .parameters import ScenarioError, ScenarioParameter, fill, unknown
from .scenario import Scenario


@dataclass(frozen=True)
class Entry:
    """One scenario of the catalogue: its name, what it is, its parameters, its builder."""

    name: str
    description: str
    parameters: tuple[ScenarioParameter, ...]
    build: Callable[..., Scenario]


_ENTRIES: dict[str, Entry] = {}


def scenario(
    name: str, description: str, parameters: Sequence[ScenarioParameter]
) -> Callable[[Callable[..., Scenario]], Callable[..., Scenario]]:
    """Decorator: put a builder into the catalogue. The builder gets every parameter by keyword, checked."""

    def register(build: Callable[..., Scenario]) -> Callable[..., Scenario]:
        _ENTRIES[name] = Entry(name, description, tuple(parameters), build)
        return build

    return register


def load(name: str, **parameters: Any) -> Scenario:
    """The scenario `name` with the given parameters, the others at their defaults.

    Raises
    ------
    ScenarioError : for an unknown scenario or parameter (with what there is), or a value that cannot be.

    Examples
    --------
    >>> load("pendulum_stop", restitution=0.5).parameters["restitution"]
    0.5
    """
    entry = _entry(name)
    values = fill(name, entry.parameters, parameters)
    built = entry.build(**values)
    # a builder may have filled in parameters that were left to it; those win
    return replace(
        built, name=name, description=entry.description, parameters={**values, **built.parameters}, given=values
    )


def names() -> tuple[str, ...]:
    """Names of the scenarios."""
    return tuple(sorted(_ENTRIES))


def catalogue() -> tuple[Entry, ...]:
    """All scenarios with their parameters (names, defaults, units, descriptions)."""
    return tuple(_ENTRIES[name] for name in names())


def _entry(name: str) -> Entry:
    if not isinstance(name, str):
        raise ScenarioError(f"a scenario's name is needed, a text, not {name!r}; there are {sorted(_ENTRIES)}")
    if name not in _ENTRIES:
        raise unknown("scenario", name, _ENTRIES)
    return _ENTRIES[name]
