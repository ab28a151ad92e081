"""numba where it is needed: for what a user writes, and for what is in no library of machine code."""

import sys
from collections.abc import Mapping
from typing import Any

from ..errors import ModelError

EXTRA = "own"
"""The extra of the package that brings numba."""


_LIBM: dict[str, int] = {}


class NumbaMissingError(ModelError, ImportError):
    """Something has to be compiled, and numba is not installed."""


def numba_module() -> Any:
    """The module numba.

    Raises
    ------
    NumbaMissingError : where it is not installed; the message says how to have it.
    """
    try:
        import numba
    except ImportError as error:
        raise NumbaMissingError(_missing(error)) from error
    if _LIBM:
        _bind()
    return numba


def use_libm(addresses: Mapping[str, int]) -> None:
    """Let code that numba compiles in this process call these functions of numbers, by name. Nothing is imported."""
    _LIBM.update(addresses)


def _bind() -> None:
    import llvmlite.binding as llvm
    from numba.core.externals import c_math_functions

    c_math_functions.install(None)  # numba's own choice, which would else come later and replace ours
    for name, address in _LIBM.items():
        llvm.add_symbol(name, address)
    _LIBM.clear()


def compiler_module() -> Any:
    """The module `compiler`, which imports numba. Raises NumbaMissingError."""
    numba_module()
    from . import compiler

    return compiler


def _missing(error: ImportError) -> str:
    return (
        f"this needs a compiler ({error}): own laws, elements and formulas are compiled when they are first used, and "
        "so is everything where the package has no machine code for this platform: "
        f'pip install "tlismni[{EXTRA}]"'
    )


def compile_errors() -> tuple[type[Exception], ...]:
    """What numba raises for what it cannot compile; nothing as long as it is not loaded."""
    if "numba" not in sys.modules:
        return ()
    from numba.core.errors import NumbaError

    return (NumbaError,)
