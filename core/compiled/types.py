"""The types that signatures of compiled functions are made of: numba's, or plain ones that stand for them.

Where the library of machine code is there numba is not loaded: to import it takes longer than a short run.
"""

from .library import LIBRARY

if LIBRARY is None:
    from numba import from_dtype
    from numba.types import Array, UniTuple, boolean, float64, int64, uint32, void
else:
    from .plain_types import Array, UniTuple, boolean, float64, from_dtype, int64, uint32, void

__all__ = ["Array", "UniTuple", "boolean", "float64", "from_dtype", "int64", "uint32", "void"]
