"""The contacts of a pool that carry force in a sample, as a table."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.contact_pool import ContactPool
from ..assembly.sample_layout import SampleLayout
from ..state.modes import ACTIVE, CLOSED
from ..state.pool_records import NO_PAIR, shapes_of_pair

CONTACT_ROW = np.dtype(
    [
        ("contact", "O"),              # name of the pair
        ("point", np.float64, (3,)),   # on the surface of the first shape, m
        ("normal", np.float64, (3,)),  # from the first shape to the second
        ("gap", np.float64),           # m
        ("normal_force", np.float64),  # N
        ("friction_force", np.float64),    # N
        ("sliding_velocity", np.float64),  # m/s
    ]
)  # fmt: skip


def contact_table(sample: NDArray[np.float64], layout: SampleLayout, pool: ContactPool, group: int) -> NDArray[Any]:
    """(contacts,) CONTACT_ROW of the contacts of group number `group` that carry force, in the order of their pairs.
    For a half-space and a sphere the first shape is the half-space."""
    first = int(pool.groups["first_slot"][group])
    slots = np.arange(first, first + int(pool.groups["slots"][group]))
    pairs, contacts = sample[layout.slot_pairs][slots].astype(np.int64), pool.contacts[slots]
    modes = sample[layout.mode + contacts]
    carries = (pairs != NO_PAIR) & ((modes == CLOSED) | (modes == ACTIVE))
    order = np.flatnonzero(carries)[np.argsort(pairs[carries], kind="stable")]
    rows = np.zeros(len(order), CONTACT_ROW)
    for row, at in zip(rows, order.tolist(), strict=True):
        number, k = int(pairs[at]), int(contacts[at])
        one, other = shapes_of_pair(number, len(pool.shapes))
        if pool.shapes["half_space"][other]:
            one, other = other, one
        a, b = pool.shapes[one], pool.shapes[other]
        centres = [_turned(sample[layout.q], shape, shape["point"], True) for shape in (a, b)]
        if a["half_space"]:
            normal = _turned(sample[layout.q], a, a["axes"][6:], False)
        else:
            apart = centres[1] - centres[0]
            normal = apart / np.linalg.norm(apart)
        gap = sample[layout.gap + k]
        row["contact"], row["normal"], row["gap"] = pool.name_of(number), normal, gap
        row["point"] = centres[1] - (b["radius"] + gap) * normal
        row["normal_force"] = sample[layout.force + k]
        row["friction_force"], row["sliding_velocity"] = sample[layout.friction + k], sample[layout.sliding + k]
    return rows


def _turned(q: NDArray[np.float64], shape: Any, vector: NDArray[np.float64], placed: bool) -> NDArray[np.float64]:
    """A vector of the shape's body in space; `placed`: a point of it."""
    own = np.append(q, 0.0)[np.minimum(shape["coord"], len(q))]
    scalar, axis = shape["rest"] + own[3], own[4:]
    across = np.cross(axis, vector)
    turned = vector + 2.0 * (scalar * across + np.cross(axis, across))
    return np.asarray(turned + own[:3] if placed else turned)
