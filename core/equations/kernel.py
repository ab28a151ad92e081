"""The kernel of user-written equations: it calls back to Python through a C function pointer.

An exception in a user's function is kept by the callback; the kernel raises `CallbackError`, which ends the compiled
loop at once, and the simulation raises the user's own exception in its place.
"""

import ctypes
from typing import Any

from numba import types
from numba.extending import intrinsic

from ..compiled.jit import internal
from ..compiled.views import imat
from ..errors import CallbackError

CALLBACK = ctypes.CFUNCTYPE(ctypes.c_int64, ctypes.c_int64, ctypes.c_double)
"""(job, t) -> 0, or 1 after an exception."""


@intrinsic
def _call_back(typing_context: Any, address: Any, job: Any, t: Any) -> Any:
    signature = types.int64(types.int64, types.int64, types.float64)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        from llvmlite import ir

        function_type = ir.FunctionType(ir.IntType(64), [ir.IntType(64), ir.DoubleType()])
        pointer = builder.inttoptr(args[0], function_type.as_pointer())
        return builder.call(pointer, args[1:])

    return signature, codegen


@internal
def equations_kernel(job: int, t: float, b: Any) -> None:
    if _call_back(imat(b.extra, b.count, b.nextra)[0, 0], job, t) != 0:
        raise CallbackError("a user function raised an exception")
