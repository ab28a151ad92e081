"""The arrays of the loop's record that contact pools need (`contact_pool.py`)."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.workspace import Workspace
from ..state.pool_records import NO_PAIR, POOL_GROUP, POOL_SHAPE
from .balls import take_pool_numbers


def build_pool(workspace: Workspace, count: int) -> dict[str, NDArray[Any]]:
    """Arrays by field of LOOP, for so many contacts."""
    pool = workspace.assembly.pool
    contacts = np.zeros(0, dtype=np.int64) if pool is None else pool.contacts
    slots, slot_of = len(contacts), np.full(count, -1, dtype=np.int64)
    slot_of[contacts] = np.arange(slots)
    return {
        "shapes": _words(np.zeros(0, POOL_SHAPE) if pool is None else pool.shapes),
        "groups": _words(np.zeros(0, POOL_GROUP) if pool is None else pool.groups),
        "slot_contact": contacts.copy(), "contact_slot": slot_of,
        "slot_pair": workspace.state["slot_pair"][0], "bound_pair": np.full(slots, NO_PAIR, dtype=np.int64),
        "excluded": np.zeros(0, dtype=np.int64) if pool is None else pool.excluded.copy(),
        "new_pairs": np.zeros(slots, dtype=np.int64), "slot_hash": np.zeros(_hash_size(slots), dtype=np.int64),
    }  # fmt: skip


def take_pool(arrays: Mapping[str, NDArray[Any]], assembly: Assembly) -> None:
    """The shapes of another assembly of the same tables, which may differ in numbers, for a run that has not begun."""
    if assembly.pool is None:
        return
    arrays["shapes"][:] = _words(assembly.pool.shapes)
    arrays["slot_pair"][:] = NO_PAIR
    arrays["bound_pair"][:] = NO_PAIR
    take_pool_numbers(arrays, assembly)


def pool_sizes(assembly: Assembly) -> dict[str, int]:
    """Their sizes by field of LOOP."""
    pool = assembly.pool
    if pool is None:
        return {"n_slots": 0, "n_shapes": 0, "n_groups": 0, "n_excluded": 0, "n_hash": 1}
    slots = len(pool.contacts)
    return {
        "n_slots": slots, "n_shapes": len(pool.shapes), "n_groups": len(pool.groups),
        "n_excluded": len(pool.excluded), "n_hash": _hash_size(slots),
    }  # fmt: skip


def _hash_size(slots: int) -> int:
    """A power of two, of which at most half is used."""
    return 1 << (2 * slots).bit_length()


def _words(records: NDArray[Any]) -> NDArray[np.int64]:
    """The memory of records of 8-byte numbers."""
    return np.ascontiguousarray(records).view(np.int64).copy()
