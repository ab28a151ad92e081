"""The catalogue: scenarios by name."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from importlib import import_module
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


_FILES = {
    name: name
    for name in (
        "arm_stop bouncing_ball bricard cable_ground cable_pendulum cantilever chain double_pendulum_wall dropped_box "
        "flexible_slider_crank_stop four_bar free_body heavy_top hub_beam_stop impact_oscillator mass_on_rod "
        "newtons_cradle pendulum pendulum_stop rocking_block rod_rod rod_wall rolling_disk slider_crank "
        "slider_crank_stop spatial_cradle spatial_slider_crank spatial_slider_crank_stop sphere_beam spinning_sphere "
        "stick_slip tippe_top universal_pendulum woodpecker"
    ).split()
} | dict.fromkeys(("split_striker", "split_wall", "split_whole"), "split_contact")
"""The file of each scenario: to import it puts it in the catalogue, which is done when it is first asked for."""
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
    entry = entry_of(name)
    values = fill(name, entry.parameters, parameters)
    built = entry.build(**values)
    # a builder may have filled in parameters that were left to it; those win
    return replace(
        built, name=name, description=entry.description, parameters={**values, **built.parameters}, given=values
    )


def names() -> tuple[str, ...]:
    """Names of the scenarios."""
    return tuple(sorted({*_FILES, *_ENTRIES}))


def catalogue() -> tuple[Entry, ...]:
    """All scenarios with their parameters (names, defaults, units, descriptions)."""
    return tuple(entry_of(name) for name in names())


def entry_of(name: str) -> Entry:
    """The entry of one scenario. Raises ScenarioError for an unknown name."""
    if not isinstance(name, str):
        raise ScenarioError(f"a scenario's name is needed, a text, not {name!r}; there are {list(names())}")
    if name not in _ENTRIES and name in _FILES:
        import_module(f".{_FILES[name]}", __package__)
    if name not in _ENTRIES:
        raise unknown("scenario", name, names())
    return _ENTRIES[name]
