"""The connections of a system, checked against the variables, and the order in which values pass along them.

A link is one connection. A link into an instance and a link out of it hang together where the output depends on the
input at once (feedthrough). What an output declares about that counts; of one that declares nothing it is tried, by
moving the input a little in initialization mode and looking. Links that hang together in a ring are an algebraic loop.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from graphlib import TopologicalSorter
from typing import Literal

import numpy as np
from scipy.sparse import csr_array
from scipy.sparse.csgraph import connected_components

from ...core.model.units import BaseUnit, parse_unit
from .description import Connection, Hold
from .errors import MasterError, near
from .instance import Instance
from .rates import time_derivatives
from .variable import Variable


@dataclass(frozen=True)
class Link:
    """An output that feeds an input: input = factor * output, both in SI units of their own variables."""

    source: int
    """Number of the instance."""
    output: Variable
    target: int
    input: Variable
    factor: float
    hold: Hold | Literal["meet"]
    label: str
    """"instance.input", as in results."""
    origin: str
    """"instance.output"."""
    rate: int | None = None
    """Of a link with hold `meet`, the link that brings the velocity."""


@dataclass(frozen=True)
class Stage:
    """Links whose values can pass at once; in a `loop` they depend on each other."""

    links: tuple[int, ...]
    loop: bool


@dataclass(frozen=True)
class Graph:
    """Links, and the stages in which values pass along them."""

    links: tuple[Link, ...]
    stages: tuple[Stage, ...]
    unconnected: tuple[str, ...]
    """Inputs that nothing feeds: they keep their start values."""

    @property
    def loops(self) -> list[str]:
        """Each algebraic loop, as the inputs in it."""
        return [" -> ".join(self.links[k].label for k in stage.links) for stage in self.stages if stage.loop]


def resolve(
    connections: Iterable[Connection], hold: Hold, instances: Sequence[Instance]
) -> tuple[tuple[Link, ...], tuple[str, ...]]:
    """The links that `connections` make, with `hold` where they say nothing, and the inputs that nothing feeds.

    Raises
    ------
    MasterError : for unknown instances and variables, wrong causalities and kinds, units that do not fit, an input
        that is fed twice.
    """
    number = {instance.name: k for k, instance in enumerate(instances)}
    links = tuple(_link(connection, number, instances, hold) for connection in connections)
    fed: dict[str, Link] = {}
    for link in links:
        if link.label in fed:
            raise MasterError(
                f"input '{link.label}' is fed twice, by '{fed[link.label].origin}' and '{link.origin}': remove one"
            )
        fed[link.label] = link
    links = tuple(_with_rate(link, links, instances) if link.hold == "meet" else link for link in links)
    inputs = (f"{instance.name}.{name}" for instance in instances for name in instance.names("input"))
    return links, tuple(name for name in inputs if name not in fed)


def _link(connection: Connection, number: Mapping[str, int], instances: Sequence[Instance], hold: Hold) -> Link:
    ends = []
    for text, causality in ((connection.source, "output"), (connection.target, "input")):
        instance, _, name = text.partition(".")
        if instance not in number:
            raise MasterError(f"connection '{text}': there is no instance '{instance}'; {near(instance, number)}")
        place = instances[number[instance]]
        alike = place.names(causality)
        if name not in place.variables:
            raise MasterError(
                f"connection '{text}': there is no such variable; of the {causality}s {near(name, alike)}"
            )
        variable = place.variables[name]
        if variable.causality != causality:
            raise MasterError(
                f"connection '{text}': it is of causality {variable.causality}, an {causality} is needed; "
                f"of those {near(name, alike)}"
            )
        if not variable.is_real:
            raise MasterError(f"connection '{text}': it is of type {variable.kind}; only real variables are coupled")
        ends.append((number[instance], variable))
    (source, output), (target, input_) = ends
    scale = _conversion(connection, output, input_)
    return Link(source, output, target, input_, connection.factor * scale, connection.hold or hold,
                connection.target, connection.source)  # fmt: skip


def _with_rate(link: Link, links: Sequence[Link], instances: Sequence[Instance]) -> Link:
    """A link with hold `meet`, with the link that brings its velocity."""
    derivatives = time_derivatives(instances[link.source], link.output)[:1]
    for k, other in enumerate(links):
        if (other.source, other.target) == (link.source, link.target) and other.output in derivatives:
            return replace(link, rate=k)
    name = derivatives[0].name if derivatives else "its derivative in time"
    raise MasterError(
        f"connection '{link.origin} -> {link.label}' has hold = 'meet' but its velocity does not come along: connect "
        f"'{instances[link.source].name}.{name}' to the input for the velocity, or leave out hold"
    )


def _conversion(connection: Connection, output: Variable, input_: Variable) -> float:
    """Factor from the output's unit, times that of the connection's factor, to the input's unit."""
    if output.unit is None or input_.unit is None:
        return 1.0
    units = [parse_unit(text) for text in (output.unit, connection.unit, input_.unit)]
    names = f"'{connection.source}' is in {output.unit}, '{connection.target}' in {input_.unit}"
    if units[1] is None:
        raise MasterError(f"unit '{connection.unit}' of the factor from '{connection.source}' is not understood")
    if units[0] is None or units[2] is None:
        if connection.unit == "1" and output.unit != input_.unit:
            raise MasterError(f"{names}: units that are not understood must be the same")
        return 1.0
    given, needed = _times(units[0], units[1]), units[2]
    if given.exponents != needed.exponents:
        raise MasterError(
            f"{names}{'' if connection.unit == '1' else f', the factor in {connection.unit}'}: the units do not fit; "
            "connect other variables, or give the connection a factor with its unit"
        )
    return given.factor / needed.factor


def _times(a: BaseUnit, b: BaseUnit) -> BaseUnit:
    exponents = {name: a.exponents.get(name, 0) + b.exponents.get(name, 0) for name in {*a.exponents, *b.exponents}}
    return BaseUnit(a.factor * b.factor, {name: n for name, n in exponents.items() if n})


def arrange(links: Sequence[Link], unconnected: Iterable[str], feedthrough: Iterable[tuple[int, int]]) -> Graph:
    """The graph of `links`; `feedthrough` holds pairs (link into an instance, link out of it) that hang together."""
    pairs = sorted(set(feedthrough))
    count = len(links)
    if not count:
        return Graph((), (), tuple(unconnected))
    rows, columns = np.array(pairs, dtype=int).reshape(-1, 2).T
    matrix = csr_array((np.ones(len(pairs)), (rows, columns)), shape=(count, count))
    _, component = connected_components(matrix, directed=True, connection="strong")
    members: dict[int, list[int]] = {}
    for k in range(count):
        members.setdefault(int(component[k]), []).append(k)
    before: dict[int, set[int]] = {c: set() for c in members}
    for a, b in pairs:
        if component[a] != component[b]:
            before[int(component[b])].add(int(component[a]))
    stages: list[Stage] = []
    sorter = TopologicalSorter(before)
    sorter.prepare()
    while sorter.is_active():
        ready = sorted(sorter.get_ready())
        loops = [c for c in ready if len(members[c]) > 1 or (members[c][0], members[c][0]) in pairs]
        plain = [members[c][0] for c in ready if c not in loops]
        if plain:
            stages.append(Stage(tuple(sorted(plain)), loop=False))
        stages += [Stage(tuple(members[c]), loop=True) for c in loops]
        sorter.done(*ready)
    return Graph(tuple(links), tuple(stages), tuple(unconnected))


def declared_feedthrough(
    links: Sequence[Link], instances: Sequence[Instance]
) -> tuple[list[tuple[int, int]], list[tuple[int, int]]]:
    """Pairs of links that hang together by what their outputs declare, and pairs of which nothing is declared."""
    known, open_ = [], []
    for a, into in enumerate(links):
        for b, out in enumerate(links):
            if into.target != out.source:
                continue
            declared = instances[out.source].dependencies.get(out.output.name)
            if declared is None:
                open_.append((a, b))
            elif into.input.name in declared:
                known.append((a, b))
    return known, open_
