"""A third opinion on what is compared: closed forms, or scipy in minimal coordinates, to show who is right.

The opinions themselves stand in `opinions`, one function for each scenario: from the scenario to values by a text that
a row's quantity contains, or by channel and time. They share nothing with the solver but the formulas of the laws'
parameters.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from importlib import import_module

from ..models import Scenario
from .comparisons.common import Comparison, Row


@dataclass(frozen=True)
class Opinion:
    """Values by text in a row's quantity (the first that fits), and functions of time by channel.

    A NaN says nothing: so does an integration after its end.
    """

    source: str
    values: Mapping[str, float] = field(default_factory=dict)
    channels: Mapping[str, Callable[[float], float]] = field(default_factory=dict)


Function = Callable[[Scenario], Opinion | None]
_OPINIONS: dict[str, Function] = {}


def opinion(name: str) -> Callable[[Function], Function]:
    """Decorator: the third opinion on a scenario of the catalogue."""

    def register(function: Function) -> Function:
        _OPINIONS[name] = function
        return function

    return register


def third_opinion(scenario: Scenario) -> Opinion | None:
    """The third opinion on a scenario; None if it has none. Models of one's own have none."""
    import_module(".opinions", __package__)  # they register themselves
    function = _OPINIONS.get(scenario.name)
    return function(scenario) if function is not None and scenario.parameters else None


def with_third_opinion(scenario: Scenario, comparison: Comparison) -> Comparison:
    """The comparison, its rows with a third value where there is one, and notes on whose side it is."""
    found = third_opinion(scenario)
    if found is None:
        return comparison
    rows = tuple(_with(found, row) for row in comparison.rows)
    return replace(comparison, rows=rows, notes=(*comparison.notes, *_sides(rows)))


def _with(found: Opinion, row: Row) -> Row:
    fitting = [text for text in found.values if text in row.quantity]
    if fitting:
        value = found.values[fitting[0]]
    elif row.channel in found.channels and row.at is not None:
        value = found.channels[row.channel](row.at)
    else:
        return row
    return row if math.isnan(value) else replace(row, third=value, third_source=found.source)


def _sides(rows: tuple[Row, ...]) -> list[str]:
    """Whose side the third opinion is on, wherever the two do not agree."""
    notes = []
    for row in rows:
        if row.third is None or row.verdict == "agree":
            continue
        ours, theirs = abs(row.ours - row.third), abs(row.exudyn - row.third)
        nearer = "ours" if ours < theirs else "exudyn's"
        notes.append(
            f"{row.quantity}: {nearer} is nearer to the third opinion (ours {ours:.1e} {row.unit} from it, exudyn's "
            f"{theirs:.1e} {row.unit})"
        )
    return notes
