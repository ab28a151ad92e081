"""What a run of coupled instances gives: recorded values at the communication points, and counts."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...core.model.channels import Channel
from .errors import MasterError
from .graph import Link
from .instance import Instance
from .variable import Variable


@dataclass(frozen=True)
class SystemResult:
    """Recorded values of a coupled run.

    Attributes
    ----------
    t : communication points, s (N,).
    columns : by "instance.variable", values at these points (N,).
    channel_records : name, unit and description of each.
    stats : communication steps, rejected ones, passes, steps of all instances, rollbacks.
    unconnected : inputs that nothing feeds.
    loops : algebraic loops, as the inputs in them.
    """

    t: NDArray[np.float64]
    columns: dict[str, NDArray[np.float64]]
    channel_records: tuple[Channel, ...]
    stats: dict[str, Any]
    unconnected: tuple[str, ...] = ()
    loops: tuple[str, ...] = ()
    events: tuple[Any, ...] = field(default=())
    """None: events belong to the instances."""

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the columns."""
        return tuple(self.columns)

    def __getitem__(self, name: str) -> NDArray[np.float64]:
        try:
            return self.columns[name]
        except KeyError:
            raise MasterError(f"'{name}' was not recorded; there are {list(self.columns)}") from None


class Recorder:
    """Collects the values of all outputs and connected inputs that match one of the patterns."""

    def __init__(self, instances: Sequence[Instance], links: Sequence[Link], patterns: Sequence[str]) -> None:
        fed = {link.label for link in links}
        self._plan: list[tuple[Instance, list[Variable]]] = []
        self.channels: list[Channel] = []
        for instance in instances:
            chosen = [
                v
                for name, v in instance.variables.items()
                if v.kind != "String"
                and (v.causality == "output" or f"{instance.name}.{name}" in fed)
                and any(fnmatchcase(f"{instance.name}.{name}", pattern) for pattern in patterns)
            ]
            if chosen:
                self._plan.append((instance, chosen))
                self.channels += [
                    Channel(
                        f"{instance.name}.{v.name}", v.unit or "1", v.description,
                        "real" if v.is_real else "boolean" if v.kind == "Boolean" else "integer",
                    )
                    for v in chosen
                ]  # fmt: skip
        if not self.channels:
            raise MasterError(f"nothing to record matches {list(patterns)}: patterns are of 'instance.variable'")
        self._times: list[float] = []
        self._rows: list[list[float]] = []

    def take(self, t: float) -> None:
        """Record the present values as those at `t`, s."""
        self._times.append(t)
        self._rows.append([x for instance, variables in self._plan for x in instance.numbers(variables)])

    def columns(self) -> tuple[NDArray[np.float64], dict[str, NDArray[np.float64]]]:
        """Times, and values by name."""
        table = np.array(self._rows)
        named = {c.name: np.ascontiguousarray(table[:, k]) for k, c in enumerate(self.channels)}
        return np.array(self._times), named
