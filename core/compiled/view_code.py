"""The intrinsics behind `views.py`: numba's arrays on raw addresses.

One through an inlined `carray` costs numba 20-30 ms of compile time at each place where it is used.
"""

from typing import Any

from numba import types
from numba.core import cgutils
from numba.extending import intrinsic
from numba.np.arrayobj import populate_array
from numba.np.unsafe.ndarray import to_fixed_tuple


def _array_view(context: Any, builder: Any, array_type: Any, address: Any, shape: list[Any]) -> Any:
    """A row-major array structure on `address` without an owner."""
    array = context.make_array(array_type)(context, builder)
    item = context.get_data_type(array_type.dtype)
    itemsize = context.get_constant(types.intp, context.get_abi_sizeof(item))
    strides = [itemsize]
    for length in reversed(shape[1:]):
        strides.insert(0, builder.mul(strides[0], length))
    populate_array(
        array,
        data=builder.inttoptr(address, item.as_pointer()),
        shape=cgutils.pack_array(builder, shape),
        strides=cgutils.pack_array(builder, strides),
        itemsize=itemsize,
        meminfo=None,
    )
    return array._getvalue()


def vector_view(dtype: Any) -> Any:
    """Intrinsic view(address, n): n of a type from an address on."""

    @intrinsic
    def view(typing_context: Any, address: Any, n: Any) -> Any:
        array_type = types.Array(dtype, 1, "C")

        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return _array_view(context, builder, array_type, args[0], [args[1]])

        return array_type(types.int64, types.int64), codegen

    return view


def _matrix_view(dtype: types.Number) -> Any:
    @intrinsic
    def view(typing_context: Any, address: Any, n: Any, m: Any) -> Any:
        array_type = types.Array(dtype, 2, "C")

        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            return _array_view(context, builder, array_type, args[0], [args[1], args[2]])

        return array_type(types.int64, types.int64, types.int64), codegen

    return view


vec = vector_view(types.float64)
"""vec(address, n): view of n float64."""
ivec = vector_view(types.int64)
"""ivec(address, n): view of n int64."""
uvec = vector_view(types.uint32)
"""uvec(address, n): view of n uint32."""
mat = _matrix_view(types.float64)
"""mat(address, n, m): view of an n x m row-major float64 array."""
imat = _matrix_view(types.int64)
"""imat(address, n, m): view of an n x m row-major int64 array."""

__all__ = ["imat", "ivec", "mat", "to_fixed_tuple", "uvec", "vec", "vector_view"]
