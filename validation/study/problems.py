"""The problems of `study iterations`: smooth motions of the catalogue, without events."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ...models import Scenario, ScenarioError, load, names

COUNT = 3
"""Problems in the study."""
QUICK_SHARE = 0.3
"""Of the time of a problem, with `quick`."""


@dataclass(frozen=True)
class Problem:
    """A scenario with parameters, and how long it runs."""

    scenario: str
    parameters: Mapping[str, Any] = field(default_factory=dict)
    t_end: float | None = None
    """s; None: the scenario's own."""

    @property
    def label(self) -> str:
        """As it stands in tables and titles."""
        values = ", ".join(f"{name} = {value:g}" for name, value in self.parameters.items())
        return f"{self.scenario} ({values})" if values else self.scenario

    def load(self) -> Scenario:
        """The scenario."""
        return load(self.scenario, **self.parameters)


PREFERRED = (
    Problem("chain", {"links": 5}, 1.0),
    Problem("pendulum"),
    Problem("slider_crank"),
    # a rod, before it strikes
    Problem("pendulum_stop", {"stop_angle": -3.0}, 0.8),
    Problem("chain", {"links": 2}, 1.0),
)
"""The first COUNT that the catalogue has are the study's problems."""


def problems(chosen: Iterable[str] | None = None) -> tuple[Problem, ...]:
    """The problems of the study, or those of the given scenarios (with the study's parameters where it has some).

    Raises ScenarioError for a scenario that the catalogue does not have.
    """
    if chosen is None:
        return tuple(problem for problem in PREFERRED if problem.scenario in names())[:COUNT]
    found = []
    for name in chosen:
        if name not in names():
            raise ScenarioError(f"unknown scenario '{name}'; there are {list(names())}")
        found.append(next((problem for problem in PREFERRED if problem.scenario == name), Problem(name)))
    return tuple(found)
