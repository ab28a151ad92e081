"""The types of compiled functions where numba is not loaded: their texts, and numba's own types once they are needed.

The names are those of `numba.types`, so that a source says a signature in the same words in both cases (`types.py`).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from .signatures import split_types


@dataclass(frozen=True)
class PlainType:
    """A type; called with others it is the result of a signature, as numba's types are."""

    text: str
    _numba: Callable[[Any], Any]
    """Makes numba's type; it gets the module numba."""

    def __call__(self, *arguments: "PlainType") -> "PlainSignature":
        return PlainSignature(self, arguments)

    @property
    def count(self) -> int:
        """How many types a tuple has."""
        return len(split_types(self.text[1:-1]))

    def for_numba(self) -> Any:
        """numba's type. Raises NumbaMissingError where numba is missing."""
        return self._numba(_numba())


@dataclass(frozen=True)
class PlainSignature:
    """Result and arguments of a function."""

    return_type: PlainType
    args: tuple[PlainType, ...]

    def for_numba(self) -> Any:
        """numba's signature. Raises NumbaMissingError where numba is missing."""
        return self.return_type.for_numba()(*(x.for_numba() for x in self.args))


def _numba() -> Any:
    from .needed import numba_module

    return numba_module()


def _scalar(text: str, name: str) -> PlainType:
    return PlainType(text, _Named(name))


@dataclass(frozen=True)
class _Named:
    name: str

    def __call__(self, numba: Any) -> Any:
        return getattr(numba.types, self.name)


@dataclass(frozen=True)
class _Array:
    dtype: PlainType
    ndim: int
    layout: str

    def __call__(self, numba: Any) -> Any:
        return numba.types.Array(self.dtype.for_numba(), self.ndim, self.layout)


@dataclass(frozen=True)
class _UniTuple:
    dtype: PlainType
    count: int

    def __call__(self, numba: Any) -> Any:
        return numba.types.UniTuple(self.dtype.for_numba(), self.count)


@dataclass(frozen=True)
class _Record:
    dtype: np.dtype

    def __call__(self, numba: Any) -> Any:
        return numba.from_dtype(self.dtype)


void, boolean = _scalar("v", "void"), _scalar("?", "boolean")
float64, int64, uint32 = _scalar("d", "float64"), _scalar("q", "int64"), _scalar("I", "uint32")


def Array(dtype: PlainType, ndim: int, layout: str) -> PlainType:
    """An array."""
    return PlainType(f"A{dtype.text}{ndim}", _Array(dtype, ndim, layout))


def UniTuple(dtype: PlainType, count: int) -> PlainType:
    """A tuple of so many of one type."""
    return PlainType(f"({dtype.text * count})", _UniTuple(dtype, count))


def from_dtype(dtype: np.dtype) -> PlainType:
    """A record."""
    return PlainType("R", _Record(dtype))
