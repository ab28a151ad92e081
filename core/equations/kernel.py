"""The kernel of user-written equations: it calls back to Python through a C function pointer.

An exception in a user's function is kept by the callback; the kernel raises `CallbackError`, which ends the compiled
loop at once, and the simulation raises the user's own exception in its place.
"""

import ctypes
from typing import Any

from ..compiled.call_back import call_back
from ..compiled.jit import internal
from ..compiled.views import imat
from ..errors import CallbackError

CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64, ctypes.c_double)
"""(job, t) -> 0, or 1 after an exception."""


@internal
def equations_kernel(job: int, t: float, b: Any) -> None:
    if call_back(imat(b.extra, b.count, b.nextra)[0, 0], job, t) != 0:
        raise CallbackError("a user function raised an exception")
