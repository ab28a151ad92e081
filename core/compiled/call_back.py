"""Calls from compiled code to a C function of (job, t) that returns an integer: to Python, through ctypes."""

from .library import LIBRARY

if LIBRARY is None:
    from .call_back_code import call_back
else:
    from .prebuilt import later

    call_back = later("call_back_code", "call_back")

__all__ = ["call_back"]
