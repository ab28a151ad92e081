"""Channels that are functions of coordinates, their rates, multipliers and work accounts: of markers, attitudes, loads.

A group of them is one compiled function of a row of numbers, with two tables: where in the row its arguments stand, and
numbers of the model. So Python, an FMU and a run without Python compute the same bits.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from ..compiled import types
from ..compiled.jit import address_of, caller, compiled, internal
from .channels import Channel

NOT_KNOWN = -1
"""The rate of a channel that is none of the others."""
Floats = NDArray[np.float64]

_REALS, _WHOLES = types.Array(types.float64, 1, "C"), types.Array(types.int64, 1, "C")
DERIVE_SIGNATURE = types.void(_REALS, _WHOLES, _REALS, _REALS)
"""kernel(row, places, numbers, out): `places` and `numbers` are the group's own; it fills `out` with its channels."""
call_derive = caller(DERIVE_SIGNATURE)

# columns of `heads`: address of the kernel; first and number of places, of numbers and of channels
KERNEL, FIRST_PLACE, PLACES, FIRST_NUMBER, NUMBERS, FIRST_CHANNEL, CHANNELS = range(7)
HEAD_SIZE = 7


@internal
def derive_row(row: Any, heads: Any, places: Any, numbers: Any, out: Any) -> None:
    """All channels of the groups `heads` (groups, HEAD_SIZE) from one row."""
    for k in range(len(heads)):
        derive_group(row, heads, k, places, numbers, out)


@internal
def derive_group(row: Any, heads: Any, k: int, places: Any, numbers: Any, out: Any) -> None:
    """The channels of group k."""
    place, number, channel = heads[k, FIRST_PLACE], heads[k, FIRST_NUMBER], heads[k, FIRST_CHANNEL]
    call_derive(
        heads[k, KERNEL], row, places[place : place + heads[k, PLACES]],
        numbers[number : number + heads[k, NUMBERS]], out[channel : channel + heads[k, CHANNELS]],
    )  # fmt: skip


@compiled
def derive_rows(rows: Any, heads: Any, places: Any, numbers: Any, out: Any) -> None:
    """The same of many rows (N, columns), into (N, channels)."""
    for i in range(len(rows)):
        derive_row(rows[i], heads, places, numbers, out[i])


@dataclass(frozen=True)
class Places:
    """Where in a row coordinates, velocities, accelerations and multipliers begin."""

    q: int
    v: int
    a: int
    multipliers: int
    work: Callable[[str], int]
    """Where the work account of this name stands."""

    def of(self, first: int, index: Sequence[int]) -> list[int]:
        """Coordinates `index` of the part that begins at `first`; -1, one that is not there, stays -1."""
        return [first + k if k >= 0 else -1 for k in index]


@dataclass(frozen=True)
class Columns:
    """What N samples say: coordinates, velocities, accelerations (N, n), multipliers (N, m), work accounts."""

    q: Floats
    v: Floats
    a: Floats
    multipliers: Floats
    work: Callable[[str], Floats]
    """Values (N,) of the work account of this name."""

    def __len__(self) -> int:
        return len(self.q)

    def rows(self, accounts: Sequence[str]) -> tuple[Floats, Places]:
        """All of it side by side, with these accounts, and what stands where."""
        n, m = self.q.shape[1], self.multipliers.shape[1]
        work = [np.asarray(self.work(name), dtype=np.float64)[:, None] for name in accounts]
        rows = np.concatenate([self.q, self.v, self.a, self.multipliers, *work], axis=1, dtype=np.float64)
        return rows, Places(0, n, 2 * n, 3 * n, lambda name: 3 * n + m + accounts.index(name))


class Derived:
    """Base of a group of channels that are computed together.

    Attributes
    ----------
    channels : what they are.
    rate_of : number of the channel that is the rate of each, or NOT_KNOWN.
    """

    kernel: ClassVar[Any]
    """numba function of DERIVE_SIGNATURE."""
    channels: Sequence[Channel] = ()
    rate_of: Sequence[int] = ()
    accounts: Sequence[str] = ()
    """Names of the work accounts that it reads."""

    def places(self, at: Places) -> Sequence[int]:
        """Where in a row the arguments of its kernel stand."""
        raise NotImplementedError(f"{type(self).__name__} must say where its arguments stand")

    def numbers(self) -> Sequence[float]:
        """The model's numbers that its kernel takes."""
        return ()

    def __call__(self, columns: Columns) -> Floats:
        """All of them (N, channels)."""
        rows, at = columns.rows(tuple(self.accounts))
        return DerivedTable((self,), at)(rows)


class DerivedTable:
    """Tables of several groups.

    Attributes
    ----------
    heads, places, numbers : (groups, HEAD_SIZE), (places,) int64; (numbers,) float64: what `derive_row` takes.
    size : number of their channels, one group's after the other's.
    """

    def __init__(self, groups: Sequence[Derived], at: Places) -> None:
        heads: list[tuple[int, ...]] = []
        places: list[int] = []
        numbers: list[float] = []
        self.size = 0
        for group in groups:
            own_places, own_numbers = group.places(at), group.numbers()
            address, count = address_of(type(group).kernel, DERIVE_SIGNATURE), len(group.channels)
            heads.append((address, len(places), len(own_places), len(numbers), len(own_numbers), self.size, count))
            places += own_places
            numbers += own_numbers
            self.size += count
        self.heads = np.array(heads, dtype=np.int64).reshape(-1, HEAD_SIZE)
        self.places, self.numbers = np.array(places, dtype=np.int64), np.array(numbers, dtype=np.float64)

    def __call__(self, rows: Floats) -> Floats:
        """All channels (N, size) of rows (N, columns)."""
        out = np.empty((len(rows), self.size))
        if self.size:
            derive_rows(np.ascontiguousarray(rows), self.heads, self.places, self.numbers, out)
        return out
