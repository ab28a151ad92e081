"""Everything that a run's records reach: which arrays, and which of their words are addresses.

Nobody lists what a record points to. An address is a word that lies within an array that the run's Python objects hold,
or is that of a function of the library. What looks like an address and is neither is an error: it would be one of a
process that is gone.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from .errors import NativeError

Array = NDArray[Any]
Whole = NDArray[np.int64]

ADDRESSES = 1 << 32, 1 << 48
"""Sizes, indices and counters are smaller; numbers with a fraction, but for those below 1e-309, are larger."""


class Found(NamedTuple):
    """Arrays that are reached, in the order of their addresses and none a part of another."""

    arrays: list[Array]
    begin: Whole
    end: Whole
    rank: Whole
    """Of each array its number in an order that does not depend on addresses: two processes have the same."""

    def in_order(self) -> list[Array]:
        """The arrays by rank."""
        return [self.arrays[k] for k in np.argsort(self.rank).tolist()]

    def owner(self, words: Whole) -> Whole:
        """Number of the array that each word points into; -1: into none."""
        if not self.arrays:
            return np.full(words.shape, -1)
        at = np.searchsorted(self.begin, words, side="right") - 1
        return np.where((at >= 0) & (words < self.end[at]), at, -1)


def begin_of(array: Array) -> int:
    """Address of the first number."""
    return int(array.__array_interface__["data"][0])


def held_by(*roots: Any) -> Iterator[Array]:
    """All arrays that Python objects hold, through attributes, slots and containers."""
    seen: set[int] = set()
    left = list(roots)
    while left:
        x = left.pop()
        if id(x) in seen or isinstance(x, str | bytes | int | float | type | None):
            continue
        seen.add(id(x))
        if isinstance(x, np.ndarray):
            yield x
            left.append(x.base)
        elif isinstance(x, Mapping):
            left += x.values()
        elif isinstance(x, list | tuple | set | frozenset):
            left += x
        elif type(x).__module__.startswith("tlismni"):
            left += getattr(x, "__dict__", {}).values()
            names = [name for kind in type(x).__mro__ for name in getattr(kind, "__slots__", ())]
            left += [getattr(x, name, None) for name in names if name != "_numba_type_"]  # which would import numba


def without_parts(arrays: Iterable[Array]) -> Found:
    """The arrays that are no parts of others, empty ones left out; ranked as they are given.

    Raises
    ------
    NativeError : for two that share a part of each other only.
    """
    found: list[Array] = []
    ranks: list[int] = []
    end = 0
    given = [x for x in arrays if x.nbytes]
    # of views of the same memory the one of 8-byte numbers says most
    for k in sorted(range(len(given)), key=lambda k: (begin_of(x := given[k]), -x.nbytes, x.dtype.itemsize % 8)):
        x = given[k]
        begin = begin_of(x)
        if begin >= end and x.flags.c_contiguous:
            found.append(x)
            ranks.append(k)
            end = begin + x.nbytes
        elif x.flags.c_contiguous and begin + x.nbytes > end:
            raise NativeError("two arrays of the run overlap in a part: it cannot be written as an image")
    begins = np.array([begin_of(x) for x in found], dtype=np.int64)
    ends = begins + np.array([x.nbytes for x in found], dtype=np.int64)
    return Found(found, begins, ends, np.array(ranks, dtype=np.int64))


def words_of(array: Array) -> Whole:
    """An array as words; none where its numbers are smaller, and so no addresses."""
    if array.dtype.itemsize % 8:
        return np.zeros(0, dtype=np.int64)
    return array.reshape(-1).view(np.int64)


def reached(first: Sequence[Array], held: Found) -> Found:
    """What the arrays `first` point to, and all that this points to, and so on: ranked in the order in which words
    point to them."""
    seen = dict.fromkeys(held.owner(np.array([begin_of(x) for x in first])).tolist())
    left = list(seen)
    while left:
        owners = held.owner(words_of(held.arrays[left.pop()]))
        new = [k for k in dict.fromkeys(owners[owners >= 0].tolist()) if k not in seen]
        seen.update(dict.fromkeys(new))
        left += new
    return without_parts(held.arrays[k] for k in seen)


def like_addresses(words: Whole) -> NDArray[np.bool_]:
    """Which words may be addresses."""
    return (words >= ADDRESSES[0]) & (words < ADDRESSES[1])


def holds_reals(array: Array) -> bool:
    """Whether words of an array may be any bits."""
    fields = (array.dtype.fields or {"": (array.dtype,)}).values()
    return any(field[0].base.kind == "f" for field in fields)


def check_words(left: Whole, empty: frozenset[int]) -> None:
    """`left` are words like addresses that are known to be none of arrays or functions of the library. Raises
    NativeError unless they are of `empty` arrays."""
    for word in left.tolist():
        if word not in empty:
            raise NativeError(
                f"the run has an address ({word:#x}) of nothing that can be written to an image: a law, an element or "
                "another function that is compiled in this process, not part of the library of machine code. Use the "
                "FMU that runs with Python"
            )
