"""Image: arrays and records that point to each other, as one block of memory that can be had again and again.

A new block is a copy of the bytes in which addresses of what is in the block are moved along; addresses of anything
else (index arrays, compiled functions) stay, so that all blocks share that.
"""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
Take = Callable[[Array], Array]
"""What stands in a new block for an array of the original; the array itself if all share it."""

_ALIGNED = 64


def twin(x: Any) -> Any:
    """A shallow copy of an object whose attributes are in its `__dict__`, in a tenth of the time of `copy.copy`."""
    new = object.__new__(type(x))
    new.__dict__.update(x.__dict__)
    return new


class Arrays(dict[str, Array]):
    """Arrays by name, each made when it is first asked for: most of a run's are only for compiled code.

    Parameters
    ----------
    names : all that there are. find : makes the array of a name.
    """

    def __init__(self, names: Iterable[str], find: Callable[[str], Array]) -> None:
        super().__init__()
        self.names, self._find = frozenset(names), find

    def __missing__(self, name: str) -> Array:
        if name not in self.names:
            raise KeyError(name)
        array = self[name] = self._find(name)
        return array

    def _all(self) -> None:
        for name in self.names - super().keys():
            self[name] = self._find(name)

    def __contains__(self, name: object) -> bool:
        return name in self.names or super().__contains__(name)

    def __len__(self) -> int:
        self._all()
        return super().__len__()

    def __iter__(self) -> Iterator[str]:
        self._all()
        return super().__iter__()

    def keys(self) -> Any:
        self._all()
        return super().keys()

    def values(self) -> Any:
        self._all()
        return super().values()

    def items(self) -> Any:
        self._all()
        return super().items()

    def copy(self) -> "Arrays":
        """Another with what has been made so far."""
        new = Arrays(self.names, self._find)
        new.update(dict.items(self))
        return new

    def get(self, name: str, other: Any = None) -> Any:
        return self[name] if name in self else other


class Image:
    """The memory of one run.

    Parameters
    ----------
    arrays : own arrays, C-contiguous; each is copied. Those that are parts of others stay parts of them.
    tables : records of addresses (or arrays of them), copied too.
    blank : own arrays of which only the room is wanted, not the content.
    """

    def __init__(self, arrays: Iterable[Array], tables: Iterable[Array], blank: Iterable[Array] = ()) -> None:
        self._kept = {id(x): x for x in (*arrays, *tables, *blank)}  # alive, so that no id is used again
        empty = {id(x) for x in blank}
        # larger ones first: parts come after what they are parts of
        own = sorted((x for x in self._kept.values() if x.nbytes), key=lambda x: (id(x) in empty, -x.nbytes))
        self._places: dict[int, tuple[tuple[int, ...], np.dtype, int]] = {}
        whole: list[tuple[Array, int]] = []
        known: list[tuple[int, int, int]] = []
        at, copied = 0, 0
        for x in own:
            begin = begin_of(x)
            outer = next((start + begin - first for first, size, start in known if first <= begin < first + size), None)
            self._places[id(x)] = x.shape, x.dtype, at if outer is None else outer
            if outer is not None:
                continue
            whole.append((x, at))
            known.append((begin, x.nbytes, at))
            at += -(-x.nbytes // _ALIGNED) * _ALIGNED
            if id(x) not in empty:
                copied = at
        self._size = at
        self._bytes = np.zeros(copied, dtype=np.uint8)
        for x, start in whole:
            if id(x) not in empty:
                self._bytes[start : start + x.nbytes] = x.reshape(-1).view(np.uint8)
        self._pointers = self._relative(whole, [x for x in tables if x.nbytes])

    def _relative(self, whole: list[tuple[Array, int]], tables: list[Array]) -> NDArray[np.intp]:
        """Make the addresses in `tables` relative to the block; returns where in the image they are, in words."""
        begin = np.array([begin_of(x) for x, _ in whole], dtype=np.int64)
        end = begin + [x.nbytes for x, _ in whole]
        offset = np.array([start for _, start in whole], dtype=np.int64)
        order = np.argsort(begin)
        begin, end, offset = begin[order], end[order], offset[order]
        words, where = self._bytes.view(np.int64), {key: start for key, (_, _, start) in self._places.items()}
        found = []
        for table in tables:
            first = where[id(table)] // 8
            values = words[first : first + table.nbytes // 8]
            owner = np.searchsorted(begin, values, side="right") - 1
            inside = np.flatnonzero((owner >= 0) & (values < end[owner]))
            values[inside] += offset[owner[inside]] - begin[owner[inside]]
            found.append(first + inside)
        return np.concatenate(found) if found else np.zeros(0, dtype=np.intp)

    @property
    def copied(self) -> int:
        """Bytes of a block that have content, at its beginning."""
        return len(self._bytes)

    def take(self) -> Take:
        """A new block, as the function that gives its arrays for those of the original."""
        block = np.empty(self._size, dtype=np.uint8)
        block[: len(self._bytes)] = self._bytes
        block[: len(self._bytes)].view(np.int64)[self._pointers] += block.ctypes.data
        places, make = self._places, np.ndarray

        def take(array: Array) -> Array:
            place = places.get(id(array))
            return array if place is None else make(place[0], place[1], block, place[2])

        return take


def begin_of(array: Array) -> int:
    """Address of the first number."""
    return int(array.__array_interface__["data"][0])
