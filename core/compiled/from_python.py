"""A Python function in place of a compiled one that is called by its address."""

import ctypes
from collections.abc import Callable
from typing import Any

NO_VALUE = -1
"""What compiled code gets where the Python function has raised: no status."""


def address_of(function: Any) -> int:
    """Machine address of a ctypes function. (After `ctypes.cast` the function refers to itself.)"""
    return int(ctypes.c_void_p.from_buffer(function).value or 0)


class FromPython:
    """`function(step)` -> status, at an address that takes (record, record, record, step), as steps and trials do.

    The calling convention is numba's: where to write the value, where to write an exception (none ever is), the
    arguments; the returned 0 says that there is a value.

    Attributes
    ----------
    address : of the entry, as long as this object lives.
    """

    def __init__(self, function: Callable[[float], int]) -> None:
        # the entry does not refer to this object: that would be a circle, which keeps the function's run
        self._errors = errors = list[BaseException]()

        def entry(value: Any, exception: int, first: int, second: int, third: int, step: float) -> int:
            try:
                value[0] = function(step)
            except BaseException as error:  # kept, not swallowed: it cannot pass through compiled code
                errors.append(error)
                value[0] = NO_VALUE
            return 0

        pointer = ctypes.c_void_p
        kind = ctypes.CFUNCTYPE(
            ctypes.c_int32, ctypes.POINTER(ctypes.c_int64), pointer, pointer, pointer, pointer, ctypes.c_double
        )
        self._entry = kind(entry)
        self.address = address_of(self._entry)

    def raise_error(self) -> None:
        """Raise what the function has raised, if it has: compiled code, which has returned, got NO_VALUE then."""
        if self._errors:
            last = self._errors.pop()
            self._errors.clear()
            try:
                raise last
            finally:
                del last
