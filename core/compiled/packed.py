"""Symmetric matrices as packed triangles, inside compiled code. `packed_code.py` says what each name is."""

from typing import Any

from .library import LIBRARY

curvature: Any
if LIBRARY is None:
    from .packed_code import curvature
else:
    from .prebuilt import later

    curvature = later("packed_code", "curvature")

__all__ = ["curvature"]
