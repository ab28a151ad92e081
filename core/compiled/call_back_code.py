"""The intrinsic behind `call_back.py`."""

from typing import Any

from llvmlite import ir
from numba import types
from numba.extending import intrinsic


@intrinsic
def call_back(typing_context: Any, address: Any, job: Any, t: Any) -> Any:
    """call_back(address, job, t) -> int."""
    signature = types.int64(types.int64, types.int64, types.float64)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        function_type = ir.FunctionType(ir.IntType(64), [ir.IntType(64), ir.DoubleType()])
        pointer = builder.inttoptr(args[0], function_type.as_pointer())
        return builder.call(pointer, args[1:])

    return signature, codegen
