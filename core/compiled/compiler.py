"""The one way in which the core compiles: cached on disk, and with IEEE division (a zero divisor gives inf or NaN,
which the step control sees, instead of an exception in the middle of a step)."""

from collections.abc import Callable
from typing import Any
from weakref import WeakKeyDictionary

from numba import njit, types
from numba.core import cgutils
from numba.core.dispatcher import Dispatcher
from numba.extending import intrinsic

from .kept import KeptCode
from .view_code import vector_view


def compiled(function: Callable[..., Any]) -> Any:
    """Decorator of compiled functions that Python calls; they are compiled when first used."""
    return _cached(njit(error_model="numpy")(function))


def compiled_unlocked(function: Callable[..., Any]) -> Any:
    """The same for what takes long: other threads of Python run on meanwhile, other instances of an FMU too.

    Whoever calls back to Python from in there takes its lock first (ctypes' callbacks and numba's objmode do). Others
    are not worth it: to give the lock away and to get it back takes longer than they do.
    """
    return _cached(njit(error_model="numpy", nogil=True)(function))


def internal(function: Callable[..., Any]) -> Any:
    """Decorator of functions that only compiled code calls (kernels and steps too): no wrapper for Python, which
    saves a third of the compile time of a small function."""
    return _cached(njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True)(function))


def _cached(dispatcher: Any) -> Any:
    # what numba's enable_caching does, with a cache that bears damage, full disks and several processes (`kept.py`)
    dispatcher._cache = KeptCode(dispatcher.py_func)
    return dispatcher


inlined = njit(inline="always", error_model="numpy")
"""Decorator of tiny helpers."""


_addresses: WeakKeyDictionary[Any, dict[Any, int]] = WeakKeyDictionary()


def address_of(function: Any, signature: Any) -> int:
    """Machine address of a numba function, compiled for `signature`.

    Raises
    ------
    TypeError : if it is not a numba function, or returns something else.
    """
    # to ask numba takes 0.1 ms, and a run asks for twenty
    known = _addresses.setdefault(function, {}) if isinstance(function, Dispatcher) else {}
    if signature not in known:
        known[signature] = _find_address(function, signature)
    return known[signature]


def _find_address(function: Any, signature: Any) -> int:
    if not hasattr(function, "get_compile_result"):
        raise TypeError(f"{function!r} must be a numba function: decorate it with @compiled")
    function.compile(signature)
    (matching,) = [s for s in function.nopython_signatures if s.args == signature.args]
    if matching.return_type != signature.return_type:
        raise TypeError(f"{function!r} returns {matching.return_type}, it must return {signature.return_type}")
    result = function.get_compile_result(matching)
    return int(result.library.get_pointer_to_function(result.fndesc.llvm_func_name))


def caller(signature: Any) -> Any:
    """Intrinsic call(address, *arguments) of compiled functions of one signature; their exceptions propagate."""
    arguments = signature.args
    result_type = signature.return_type

    def typed(typing_context: Any, address: Any, *given: Any) -> Any:
        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            function_type = context.call_conv.get_function_type(result_type, arguments)
            pointer = builder.inttoptr(args[0], function_type.as_pointer())
            status, result = context.call_conv.call_function(builder, pointer, result_type, arguments, args[1:])
            with cgutils.if_unlikely(builder, status.is_error):
                context.call_conv.return_status_propagate(builder, status)
            return context.get_dummy_value() if result_type == types.void else result

        return result_type(types.int64, *arguments), codegen

    names = ", ".join(f"x{k}" for k in range(len(arguments)))
    # numba reads the number of arguments off the function's own signature
    namespace: dict[str, Any] = {"typed": typed}
    exec(
        f"def call(typing_context, address, {names}):\n    return typed(typing_context, address, {names})\n", namespace
    )
    return intrinsic(namespace["call"])


def records_view(record_type: Any) -> Any:
    """Intrinsic view(address, n): n records of `record_type` from an address on."""
    return vector_view(record_type)


def record_view(record_type: Any) -> Any:
    """Intrinsic view(address): the record of `record_type` at an address."""

    @intrinsic
    def view(typing_context: Any, address: Any) -> Any:
        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return builder.inttoptr(args[0], context.get_value_type(record_type))

        return record_type(types.int64), codegen

    return view
