"""Numpy views on raw addresses, inside compiled code.

Compiled functions receive one small record of addresses and sizes instead of dozens of arrays: passing it
costs one pointer, and a view costs nothing because it is not reference-counted. Whoever builds the record
(`ArrayRecord`) keeps the arrays alive. `view_code.py` says what each name is.
"""

from .library import LIBRARY

if LIBRARY is None:
    from .view_code import imat, ivec, mat, to_fixed_tuple, uvec, vec
else:
    from .prebuilt import later

    vec, ivec, uvec, mat, imat, to_fixed_tuple = (
        later("view_code", name) for name in ("vec", "ivec", "uvec", "mat", "imat", "to_fixed_tuple")
    )

__all__ = ["imat", "ivec", "mat", "to_fixed_tuple", "uvec", "vec"]
