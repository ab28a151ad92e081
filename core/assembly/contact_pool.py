"""Contact pools of a model as tables: shapes, groups and slots, and the pairs that never touch."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..contacts.contact3d import HalfSpace3D
from ..contacts.element import ContactElement
from ..contacts.pooled3d import FAR, PooledContact3D
from ..elements.base import Numbering
from ..model.markers import GROUND, Marker3D
from ..state.pool_records import POOL_GROUP, POOL_SHAPE, pair_number, shapes_of_pair

NO_GROUP = -1
"""Group of the shapes of slots that no pair has."""


@dataclass
class ContactPool:
    """The pools of a model; each group has its shapes and slots side by side."""

    shapes: NDArray[Any]
    """(shapes,) POOL_SHAPE; the last two are the point and the plane of slots that no pair has."""
    groups: NDArray[Any]
    """(groups,) POOL_GROUP."""
    contacts: NDArray[np.int64]
    """(slots,): which contact each slot is."""
    excluded: NDArray[np.int64]
    """Numbers of the pairs that never touch, ascending."""
    names: tuple[str, ...]
    """Of the groups."""
    bodies: tuple[str, ...]
    """Name of the body of each shape."""

    def name_of(self, number: int) -> str:
        """Name of the contact of a pair, as a group without a pool calls it: name_body1_body2, with a number behind
        where the two bodies have several."""
        if number not in self._named:
            first, second = shapes_of_pair(number, len(self.shapes))
            group = int(self.shapes["group"][first])
            ones, others = (self._shapes_of[group, self.bodies[x]] for x in (first, second))
            pairs = sorted((min(i, j), max(i, j)) for i in ones for j in others)
            label = f"{self.names[group]}_{self.bodies[first]}_{self.bodies[second]}"
            self._named[number] = label if len(pairs) == 1 else f"{label}_{pairs.index((first, second)) + 1}"
        return self._named[number]

    @cached_property
    def _named(self) -> dict[int, str]:
        """Names of pairs that have been asked for: each event of a run asks."""
        return {}

    @cached_property
    def _shapes_of(self) -> dict[tuple[int, str], list[int]]:
        """The shapes of each body, by group and body."""
        found: dict[tuple[int, str], list[int]] = {}
        for shape, body in enumerate(self.bodies):
            found.setdefault((int(self.shapes["group"][shape]), body), []).append(shape)
        return found

    def has(self, name: str) -> bool:
        """Whether a pair of shapes has this name, as far as the names of both bodies tell."""
        bodies = {body for _, body in self._shapes_of}
        for group, first in self._shapes_of:
            start = f"{self.names[group]}_{first}_"
            second = name.removeprefix(start)
            if name.startswith(start) and {second, second.rpartition("_")[0]} & bodies:
                return True
        return False


def same_pools(a: ContactPool | None, b: ContactPool | None) -> bool:
    """True if two pools differ in numbers only."""
    if a is None or b is None:
        return a is b
    same = a.names == b.names and a.bodies == b.bodies and len(a.shapes) == len(b.shapes)
    same = same and np.array_equal(a.groups, b.groups) and np.array_equal(a.contacts, b.contacts)
    fields = ("coord", "half_space", "group", "body")
    return (
        same
        and np.array_equal(a.excluded, b.excluded)
        and all(np.array_equal(a.shapes[name], b.shapes[name]) for name in fields)
    )


def pool_of(contacts: Sequence[ContactElement], numbering: Numbering) -> ContactPool | None:
    """The pools that the slots among the contacts belong to; None: there are none."""
    first_slots = [(k, c) for k, c in enumerate(contacts) if isinstance(c, PooledContact3D) and c.slot == 0]
    if not first_slots:
        return None
    shapes = np.zeros(sum(len(c.pool.shapes) for _, c in first_slots) + 2, POOL_SHAPE)
    groups = np.zeros(len(first_slots), POOL_GROUP)
    bodies: list[str] = []
    number_of: dict[str, int] = {}
    excluded: list[int] = []
    slots: list[int] = []
    for g, (k, contact) in enumerate(first_slots):
        pool, first = contact.pool, len(bodies)
        count = sum(1 for c in contacts if isinstance(c, PooledContact3D) and c.pool is pool)
        groups[g] = (len(slots), count, first, len(pool.shapes))
        slots += range(k, k + count)
        for at, shape in enumerate(pool.shapes, first):
            marker, own = shape.marker, shapes[at]
            _place(own, marker, numbering, isinstance(shape, HalfSpace3D))
            own["group"], own["radius"] = g, getattr(shape, "radius", 0.0)
            own["body"] = number_of.setdefault(marker.body, len(number_of))
            bodies.append(marker.body)
        of: dict[str, list[int]] = {}
        for at in range(first, len(bodies)):
            of.setdefault(bodies[at], []).append(at)
        # the shapes of one body never touch each other
        together = [(a, b) for a, b in pool.except_bodies if a != b and a in of and b in of]
        together += [(body, body) for body, members in of.items() if len(members) > 1 or body == GROUND]
        excluded += [
            pair_number(min(i, j), max(i, j), len(shapes)) for a, b in together for i in of[a] for j in of[b] if i != j
        ]
    _place(shapes[-2], Marker3D(point=(0.0, 0.0, FAR * numbering.length)), numbering, False)
    _place(shapes[-1], Marker3D(), numbering, True)
    shapes["group"][-2:] = NO_GROUP
    return ContactPool(
        shapes, groups, np.array(slots, dtype=np.int64), np.unique(np.array(excluded, dtype=np.int64)),
        tuple(c.name.rsplit("_", 1)[0] for _, c in first_slots), tuple(bodies),
    )  # fmt: skip


def _place(own: Any, marker: Marker3D, numbering: Numbering, half_space: bool) -> None:
    own["coord"], own["rest"], own["half_space"] = numbering.frame(marker), numbering.at_rest(marker)[3], half_space
    own["point"], own["axes"] = marker.point, marker.axes().T.ravel()
