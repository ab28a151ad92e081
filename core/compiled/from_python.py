"""A Python function in place of a compiled one that is called by its address."""

import ctypes
from collections.abc import Callable
from typing import Any

NO_VALUE = -1
"""What compiled code gets where the Python function has raised: no status."""


class FromPython:
    """`function(step)` -> status, at an address that takes (record, record, record, step), as steps and trials do.

    The calling convention is numba's: where to write the value, where to write an exception (none ever is), the
    arguments; the returned 0 says that there is a value.

    Attributes
    ----------
    address : of the entry, as long as this object lives.
    error : what the function has raised last; compiled code got NO_VALUE then. Raise it when that has returned.
    """

    def __init__(self, function: Callable[[float], int]) -> None:
        self.error: BaseException | None = None

        def entry(value: Any, exception: int, first: int, second: int, third: int, step: float) -> int:
            try:
                value[0] = function(step)
            except BaseException as error:  # kept, not swallowed: it cannot pass through compiled code
                self.error = error
                value[0] = NO_VALUE
            return 0

        pointer = ctypes.c_void_p
        kind = ctypes.CFUNCTYPE(
            ctypes.c_int32, ctypes.POINTER(ctypes.c_int64), pointer, pointer, pointer, pointer, ctypes.c_double
        )
        self._entry = kind(entry)
        self.address = int(ctypes.cast(self._entry, pointer).value or 0)
