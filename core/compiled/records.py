"""Records of addresses and sizes, and the arrays that they point to."""

from collections.abc import Mapping
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .image import Arrays, Take, begin_of
from .library import LIBRARY
from .types import from_dtype

_KINDS = frozenset((np.dtype(np.float64).char, np.dtype(np.int64).char))


@cache
def words_of(dtype: np.dtype) -> dict[str, int]:
    """Place of each field among the 8-byte words of the record."""
    return {name: field[1] // 8 for name, field in (dtype.fields or {}).items()}


@cache
def _type_of(dtype: np.dtype) -> Any:
    found = from_dtype(dtype)
    return found if LIBRARY is None else found.for_numba()


@cache
def fields_of(dtype: np.dtype) -> Any:
    """Class of views of one record of `dtype`, whose fields are all float64 or all int64, in the array of its numbers.

    `fields_of(CLOCK)(numbers).step_size` reads and writes a number of the array by its name, in a twentieth of the time
    of numpy's `recarray`. Compiled functions have the same fields at the array's address (`record_view`).
    """
    members: dict[str, Any] = {"__slots__": ("numbers",), "__init__": _take_numbers}
    for name, place in words_of(dtype).items():
        members[name] = property(_reader(place), _writer(place))
    return type("Fields", (), members)


def _take_numbers(view: Any, numbers: NDArray[Any]) -> None:
    view.numbers = numbers


def _reader(place: int) -> Any:
    return lambda view: view.numbers.item(place)


def _writer(place: int) -> Any:
    def write(view: Any, value: float) -> None:
        view.numbers[place] = value

    return write


class Record:
    """What compiled functions take for the one record of type `dtype` in `words`, whose memory it shares.

    Numba asks a numpy record for its type and its buffer, which describes itself field by field: 7 us at every call
    with a record of 70 fields. Of this it asks the same questions by the same names, and has the answers at once.
    """

    __slots__ = ("_dtype", "_numba_type_", "_words", "address", "data")

    def __init__(self, words: NDArray[np.int64], dtype: np.dtype) -> None:
        self._dtype, self._words = dtype, words
        self.data = words.view(np.uint8)
        self.address = begin_of(words)
        if LIBRARY is None:
            self._numba_type_ = _type_of(dtype)

    def __getattr__(self, name: str) -> Any:
        # with a library numba is asked only if a function is compiled in this process after all
        if name != "_numba_type_":
            raise AttributeError(name)
        self._numba_type_ = _type_of(self._dtype)
        return self._numba_type_

    def __getitem__(self, field: str) -> int:
        return self._words.item(words_of(self._dtype)[field])

    def word(self, place: int) -> int:
        """The field at this place (`words_of`), in a tenth of the time."""
        return self._words.item(place)


class ArrayRecord:
    """One numpy record whose integer fields are sizes or addresses of float64/int64 arrays.

    Parameters
    ----------
    dtype : structured dtype, every field int64.
    arrays : arrays by field name, C-contiguous, float64 or int64. They are kept alive and are reachable as
        `record.arrays[name]`; their fields hold their addresses.
    sizes : plain integers by field name.

    Raises
    ------
    TypeError : for an array of another dtype or layout, or a field left out.
    """

    def __init__(self, dtype: np.dtype, arrays: Mapping[str, NDArray], sizes: Mapping[str, int]) -> None:
        self.arrays: dict[str, NDArray[Any]] = dict(arrays)
        names = set(dtype.names or ())
        given = set(self.arrays) | set(sizes)
        if names != given:
            raise TypeError(
                f"the fields of the record are {sorted(names)}: missing {sorted(names - given)}, "
                f"unknown {sorted(given - names)}"
            )
        self._use(np.zeros(len(names), dtype=np.int64), dtype)
        for name, array in arrays.items():
            self._point(name, array)
        for name, size in sizes.items():
            self.set_size(name, size)

    def _use(self, words: NDArray[np.int64], dtype: np.dtype) -> None:
        self.words, self._dtype, self._place = words, dtype, words_of(dtype)
        """The record as numbers, (fields,)."""
        self.record = Record(words, dtype)
        """What to hand to a compiled function."""
        self.address = self.record.address
        """Address of the record itself, to be stored in another record."""

    @cached_property
    def table(self) -> NDArray[Any]:
        """The record as a structured array, (1,)."""
        return self.words.view(self._dtype)

    def set_array(self, name: str, array: NDArray) -> None:
        """Let field `name` point to `array`."""
        self._point(name, array)
        # copies of this record may look for arrays later, in what was here when they were made
        self.arrays = {**self.arrays, name: array}

    def _point(self, name: str, array: NDArray) -> None:
        if not isinstance(array, np.ndarray) or array.dtype.char not in _KINDS:
            raise TypeError(f"array '{name}' must be float64 or int64, not {getattr(array, 'dtype', type(array))}")
        if not array.flags.c_contiguous:
            raise TypeError(f"array '{name}' must be C-contiguous")
        # a word takes a tenth of the time of a field, this a third of that of `array.ctypes.data`
        self.words[self._place[name]] = begin_of(array)

    def set_size(self, name: str, size: int) -> None:
        """Let field `name` be `size`."""
        self.words[self._place[name]] = size

    def moved(self, take: Take) -> "ArrayRecord":
        """The same record in a copy of its memory (`image.py`)."""
        new = object.__new__(ArrayRecord)
        new._use(take(self.words), self._dtype)
        arrays = self.arrays
        new.arrays = Arrays(arrays, lambda name: take(arrays[name]))
        return new


class BlockRecord:
    """The same with all arrays as parts of one block of memory: for scratch, which is copied, moved and built at once.

    Parameters
    ----------
    dtype : structured dtype, every field int64.
    lengths : numbers (float64 or int64) in each array, by field name.
    sizes : plain integers by field name.
    """

    def __init__(self, dtype: np.dtype, lengths: Mapping[str, int], sizes: Mapping[str, int]) -> None:
        self._lengths, at = dict(lengths), 0
        self.table = np.zeros(1, dtype)
        self.block = np.zeros(sum(lengths.values()))
        begin = self.block.__array_interface__["data"][0]
        self._start: dict[str, int] = {}
        for name, length in lengths.items():
            self._start[name] = at
            self.table[name] = begin + 8 * at
            at += length
        for name, size in sizes.items():
            self.table[name] = size
        missing = set(dtype.names or ()) - set(lengths) - set(sizes)
        if missing:
            raise TypeError(f"fields of the record are missing: {sorted(missing)}")

    def whole(self, name: str) -> NDArray[np.int64]:
        """The integers of the array `name`."""
        return self.part(name).view(np.int64)

    def part(self, name: str) -> NDArray[np.float64]:
        """The numbers of the array `name`."""
        start = self._start[name]
        return self.block[start : start + self._lengths[name]]

    @property
    def address(self) -> int:
        """Address of the record itself."""
        return int(self.table.ctypes.data)

    def moved(self, take: Take) -> "BlockRecord":
        """The same record in a copy of its memory (`image.py`)."""
        new = object.__new__(BlockRecord)
        new._lengths, new._start = self._lengths, self._start
        new.table, new.block = take(self.table), take(self.block)
        return new
