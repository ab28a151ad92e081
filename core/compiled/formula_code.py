"""Kept code of formulas that users write, and of kernels that are made from them.

numba looks only at the file of a function. A formula may call functions of other files and read global numbers, and a
kernel made by a factory has its source in the factory's file, not in the formula's: here the key of kept code holds all
that the formulas can reach. What cannot be told so (a formula typed at a prompt, one that reads a global list) is
compiled in every process anew.
"""

import hashlib
import inspect
from collections.abc import Callable, Iterator
from pathlib import Path
from types import CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np
from numba import njit

from .kept import KeptCode, _source_stamp

_LIBRARY = Path(inspect.__file__).parent  # Python's own
_PLAIN = (bool, int, float, complex, str, type(None), np.generic)


class _Unknown(Exception):
    """A formula reads what has no content that could be compared."""


class FormulaCode(KeptCode):
    """Kept code of `made`: a formula itself, or a kernel made from `formulas` with the `layout` of its tables."""

    def __init__(self, made: Callable[..., Any], formulas: tuple[Callable[..., Any], ...], layout: Any = None) -> None:
        super().__init__(made)
        factory = _source_stamp(self._source)
        self._source = Path(inspect.getfile(formulas[0]))
        names = ", ".join(f"{formula.__module__}.{formula.__qualname__}" for formula in formulas)
        self._name = names if made is formulas[0] else f"{self._name} of {names}"
        self._first = formulas[0]
        try:
            self._content: str | None = f"{_digest(formulas)} {layout!r} {factory}"
        except _Unknown:
            self._content = None

    def _index_key(self, sig: Any, codegen: Any) -> Any:
        return sig, codegen.magic_tuple(), self._content

    def _folder(self) -> Path | None:
        return None if self._content is None else super()._folder()

    def _stem(self) -> str:
        name = f"{self._source.stem}.{self._first.__qualname__}.{self._py_func.__name__}"
        return f"{name.replace('<', '').replace('>', '')}-{self._first.__code__.co_firstlineno}"


def formula_internal(made: Callable[..., Any], formulas: tuple[Callable[..., Any], ...], layout: Any = None) -> Any:
    """The same as the decorator `internal`, for `formulas` and kernels made from them."""
    inlined = made is formulas[0]  # so that what a formula does not use of its frames is not computed
    dispatcher = njit(error_model="numpy", no_cpython_wrapper=True, no_cfunc_wrapper=True, forceinline=inlined)(made)
    dispatcher._cache = FormulaCode(made, formulas, layout)
    return dispatcher


def _digest(formulas: tuple[Callable[..., Any], ...]) -> str:
    """Of all that the formulas can reach. Raises _Unknown."""
    digest, seen = hashlib.sha256(), set[int]()
    for formula in formulas:
        for piece in _pieces(formula, seen):
            digest.update(piece + b"\0")
    return digest.hexdigest()


def _pieces(value: Any, seen: set[int]) -> Iterator[bytes]:
    value = getattr(value, "py_func", value)
    if isinstance(value, _PLAIN) or (isinstance(value, tuple) and all(isinstance(x, _PLAIN) for x in value)):
        yield repr(value).encode()
    elif isinstance(value, ModuleType):
        yield f"{value.__name__} {getattr(value, '__version__', '')}".encode()
        if _is_users(value):
            yield _source_stamp(Path(str(value.__file__))).encode()
    elif isinstance(value, FunctionType):
        if id(value) in seen:
            return
        seen.add(id(value))
        yield _code_text(value.__code__).encode()
        yield repr(value.__defaults__).encode()
        for cell in value.__closure__ or ():
            yield from _pieces(cell.cell_contents, seen)
        names = _names(value.__code__)
        for name in sorted(names & value.__globals__.keys()):
            found = value.__globals__[name]
            yield name.encode()
            yield from _pieces(found, seen)
            if isinstance(found, ModuleType) and _is_users(found):
                for each in sorted(names & vars(found).keys()):
                    yield from _pieces(vars(found)[each], seen)
    elif not callable(value) or inspect.getmodule(value) is None:
        raise _Unknown
    else:  # a builtin function of math or numpy
        yield f"{value!r}".encode() if inspect.isbuiltin(value) else _named(value)


def _is_users(module: ModuleType) -> bool:
    """Whether a module is a file that a user may change from run to run."""
    file = Path(getattr(module, "__file__", None) or "")
    return file.suffix == ".py" and "site-packages" not in file.parts and not file.is_relative_to(_LIBRARY)


def _named(value: Any) -> bytes:
    module = inspect.getmodule(value)
    if isinstance(value, np.ufunc) or (module is not None and module.__name__.split(".")[0] == "numpy"):
        return f"{value!r}".encode()
    raise _Unknown


def _code_text(code: CodeType) -> str:
    """What a function does, as text (marshal's bytes depend on how often its strings are used elsewhere)."""
    constants = [
        _code_text(c) if isinstance(c, CodeType) else repr(sorted(map(repr, c)) if isinstance(c, frozenset) else c)
        for c in code.co_consts
    ]
    return repr((code.co_code, constants, code.co_names, code.co_varnames, code.co_freevars, code.co_argcount))


def _names(code: CodeType) -> set[str]:
    found = set(code.co_names)
    for constant in code.co_consts:
        if isinstance(constant, CodeType):
            found |= _names(constant)
    return found
