"""The decorators of compiled functions, and their machine addresses.

Where there is a library of machine code (`library.py`) they give what it has, and numba is not loaded; elsewhere they
compile (`compiler.py`).
"""

from types import FunctionType
from typing import Any

from .library import LIBRARY

if LIBRARY is None:
    from .compiler import address_of, caller, compiled, compiled_unlocked, inlined, internal, record_view, records_view
else:
    from .prebuilt import address_of, caller, compiled, compiled_unlocked, inlined, internal, record_view, records_view

__all__ = [
    "address_of",
    "caller",
    "compiled",
    "compiled_unlocked",
    "inlined",
    "internal",
    "interpreted",
    "record_view",
    "records_view",
]


def interpreted(function: Any, *helpers: Any) -> Any:
    """The same source run by Python, its compiled `helpers` too: for inputs so small that compiling costs more."""
    source = function.py_func
    names = {**source.__globals__, **{helper.py_func.__name__: helper.py_func for helper in helpers}}
    return FunctionType(source.__code__, names, source.__name__, source.__defaults__)
