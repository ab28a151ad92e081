"""How Python calls a function of the library: numba's calling convention through ctypes.

A function takes the place of its result, the place of a pointer to what it raises, and its arguments; of an array these
are memory and owner (null here), number and size of its items, address, shape, strides. It returns a status.
"""

import ctypes
import operator
import pickle
from collections.abc import Callable
from typing import Any, NoReturn

import numpy as np

from .signatures import split_signature, split_types

_VALUES: dict[str, Any] = {"d": ctypes.c_double, "q": ctypes.c_int64, "?": ctypes.c_bool, "I": ctypes.c_uint32}
_DTYPES = {"d": np.dtype(np.float64), "q": np.dtype(np.int64), "I": np.dtype(np.uint32)}
_WORD, _PLACE = ctypes.c_int64, ctypes.c_void_p
NONE = -2
"""Status of a function that returns nothing; 0 is that of one that returns a value."""


class Unfit(Exception):
    """The arguments are not of the types that the function was compiled for."""


class _Raised(ctypes.Structure):
    """What numba's functions leave of an exception: a pickle of its class, its arguments and its place."""

    _fields_ = [("pickle", _PLACE), ("size", ctypes.c_int32), ("hash", _PLACE), ("unwrap", _PLACE), ("owned", ctypes.c_int32)]  # fmt: skip # noqa: E501


def raise_from(status: int, place: ctypes.c_void_p) -> NoReturn:
    """Raise what compiled code has raised."""
    if status < 0 or not place.value:
        raise SystemError(f"compiled code ended with status {status}")
    raised = _Raised.from_address(place.value)
    kind, arguments, *_ = pickle.loads(ctypes.string_at(raised.pickle, raised.size))
    raise kind(*(arguments or ()))


def record_address(record: Any) -> int:
    """Address of a record, in whatever shape it is handed over."""
    try:
        return int(record.address)
    except AttributeError:
        if not isinstance(record, np.void | np.ndarray):
            raise Unfit from None
    return int(record.__array_interface__["data"][0])


def array_words(array: Any, dtype: np.dtype, ndim: int) -> tuple[Any, ...]:
    """The arguments that one array is."""
    try:
        fits = array.dtype is dtype or array.dtype == dtype  # the first is ten times as fast, and nearly always so
        if not fits or array.ndim != ndim or not array.flags.c_contiguous:
            raise Unfit
    except AttributeError:
        raise Unfit from None
    try:
        begin = ctypes.addressof(ctypes.c_char.from_buffer(array))
    except (TypeError, ValueError):  # nobody may write into it, or it is empty
        begin = array.__array_interface__["data"][0]  # takes five times as long
    return (None, None, array.size, dtype.itemsize, begin, *array.shape, *array.strides)


def _whole(number: Any) -> int:
    try:
        return operator.index(number)
    except TypeError:
        raise Unfit from None


def _flatten(kind: str, name: str) -> tuple[list[Any], str]:
    """ctypes' types of an argument, and the source of what is passed for it."""
    if kind == "R":
        return [_PLACE], f"record({name})"
    if kind in "qI":
        return [_VALUES[kind]], f"whole({name})"
    if kind in "d?":
        return [_VALUES[kind]], name
    if kind[0] == "A":
        ndim = int(kind[2])
        return [_PLACE, _PLACE, _WORD, _WORD, _PLACE, *(_WORD,) * (2 * ndim)], f"*array({name}, {kind[1]}, {ndim})"
    parts = [_flatten(part, f"{name}[{k}]") for k, part in enumerate(split_types(kind[1:-1]))]
    return [x for types, _ in parts for x in types], ", ".join(source for _, source in parts)


def crossing(function: Any, signature: str) -> Callable[..., Any]:
    """A Python function that calls a ctypes function of the library; it raises Unfit for other arguments."""
    result, arguments = split_signature(signature)
    names = [f"x{k}" for k in range(len(arguments))]
    parts = [_flatten(kind, name) for kind, name in zip(arguments, names, strict=True)]
    function.argtypes = [_PLACE, _PLACE, *(x for types, _ in parts for x in types)]
    function.restype = ctypes.c_int32
    known: dict[str, Any] = {
        "function": function, "record": record_address, "whole": _whole, "array": array_words, "byref": ctypes.byref,
        "Raised": _PLACE, "raise_from": raise_from, **_DTYPES, "Unfit": Unfit, "ArgumentError": ctypes.ArgumentError,
    }  # fmt: skip
    if result[0] == "(":
        inside = split_types(result[1:-1])
        if set(inside) != {"d"}:
            raise TypeError(f"{signature}: results of this type cannot be handed to Python")
        known["Result"], give = ctypes.c_double * len(inside), "tuple(found)"
    else:
        known["Result"] = ctypes.c_int64 if result == "v" else _VALUES[result]
        give = "None" if result == "v" else "found.value"
    call = ", ".join(("byref(found)", "byref(raised)", *(source for _, source in parts)))
    exec(
        f"def call({', '.join(names)}):\n"
        "    found, raised = Result(), Raised()\n"
        f"    try:\n        status = function({call})\n"
        "    except ArgumentError:\n        raise Unfit from None\n"
        f"    if status == 0 or status == {NONE}:\n        return {give}\n"
        "    raise_from(status, raised)\n",
        known,
    )
    made: Callable[..., Any] = known["call"]
    return made
