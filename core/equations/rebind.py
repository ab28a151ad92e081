"""A user's function prepared for jets: arrays may hold them, math functions and compiled helpers take them.

Compiled code cannot work with jets, and code written for a compiler fills float arrays (`out = np.zeros(3);
out[0] = ...`) and calls `math.sin`. The copy made here runs the same byte code with other meanings of the
global names `numpy` and `math` (under any alias, `from math import sin` included) and of helper functions;
everything else, module constants included, is looked up in the original globals at each call. Helpers reached
as attributes of other modules or objects stay as they are.
"""

import functools
import math
import types
from collections.abc import Callable
from typing import Any

import numpy as np

from .elementary import UNARY_NAMES
from .jet import Jet
from .jet_numpy import ELEMENTWISE, SCALAR, arctan2, hypot

_FOREIGN = ("numpy", "scipy", "numba", "math", "builtins", "functools", "itertools")


def _number(x: Any) -> Any:
    """`x`, taken out of a 0-d array."""
    return x.item() if isinstance(x, np.ndarray | np.generic) and np.ndim(x) == 0 else x


def _creator(function: Callable[..., Any]) -> Callable[..., Any]:
    """numpy.zeros and the like, with room for jets where floats are asked for."""

    def create(*arguments: Any, **options: Any) -> Any:
        array = function(*arguments, **options)
        return array.astype(object) if array.dtype.kind == "f" else array

    return create


def _converter(function: Callable[..., Any]) -> Callable[..., Any]:
    """numpy.array and the like: a dtype of floats is no reason to lose jets."""

    def convert(x: Any, dtype: Any = None, *arguments: Any, **options: Any) -> Any:
        if dtype is not None and np.dtype(dtype).kind == "f":
            dtype = object
        array = function(x, dtype, *arguments, **options)
        return array.astype(object) if array.dtype.kind == "f" else array

    return convert


def _elementwise(ufunc: np.ufunc) -> Callable[..., Any]:
    def apply(*arguments: Any, **options: Any) -> Any:
        arrays = [np.asarray(x) for x in arguments]
        if options or not any(x.dtype == object for x in arrays):
            return ufunc(*arguments, **options)
        return ELEMENTWISE[ufunc](*arguments)

    return apply


def _norm(x: Any, *arguments: Any, **options: Any) -> Any:
    """numpy.linalg.norm: the Euclidean norm of jets."""
    array = np.asarray(x)
    if array.dtype != object or arguments or options:
        return np.linalg.norm(x, *arguments, **options)
    flat = array.ravel()
    return SCALAR[np.sqrt](_number(np.dot(flat, flat)))


def _math_function(scalar: Callable[..., Any], plain: Callable[..., Any]) -> Callable[..., Any]:
    def apply(*arguments: Any) -> Any:
        numbers = [_number(x) for x in arguments]
        return scalar(*numbers) if any(isinstance(x, Jet) for x in numbers) else plain(*numbers)

    return apply


def _math_log(x: Any, *base: Any) -> Any:
    x = _number(x)
    if not isinstance(x, Jet):
        return math.log(x, *base)
    return x.log() / math.log(*base) if base else x.log()  # type: ignore[attr-defined]


class _Namespace:
    """A module with some of its names replaced."""

    def __init__(self, module: Any, replaced: dict[str, Any]) -> None:
        self.__dict__.update(replaced)
        self._module = module

    def __getattr__(self, name: str) -> Any:
        return getattr(self._module, name)


_CREATORS = (
    "zeros",
    "empty",
    "ones",
    "full",
    "eye",
    "identity",
    "zeros_like",
    "empty_like",
    "ones_like",
    "diag",
)
_NUMPY: dict[str, Any] = {
    **{name: _creator(getattr(np, name)) for name in _CREATORS},
    **{name: _converter(getattr(np, name)) for name in ("array", "asarray", "ascontiguousarray", "asanyarray")},
    **{f.__name__: _elementwise(f) for f in ELEMENTWISE},
    "float64": lambda x=0.0: x if isinstance(x, Jet) else np.float64(x),
    "linalg": _Namespace(np.linalg, {"norm": _norm}),
}
_MATH: dict[str, Any] = {
    **{
        short: _math_function(SCALAR[getattr(np, name)], getattr(math, short))
        for name in UNARY_NAMES
        if hasattr(math, short := name.replace("arc", "a"))
    },
    "log": _math_log,
    "atan2": _math_function(arctan2, math.atan2),
    "hypot": _math_function(hypot, math.hypot),
    "pow": _math_function(pow, math.pow),
    "fabs": _math_function(abs, math.fabs),
}
_MODULES = {
    id(np): _Namespace(np, _NUMPY),
    id(math): _Namespace(math, _MATH),
    id(np.linalg): _NUMPY["linalg"],
}
_FUNCTIONS = {
    **{id(getattr(np, name)): value for name, value in _NUMPY.items() if name != "linalg"},
    **{id(getattr(math, name)): value for name, value in _MATH.items()},
    id(np.linalg.norm): _norm,
}


class _Globals(dict):
    """Globals of a rebound function: names are looked up in the original ones at each access."""

    def __init__(self, original: dict[str, Any], rebinder: "_Rebinder") -> None:
        super().__init__()
        self._original = original
        self._rebinder = rebinder

    def __missing__(self, name: str) -> Any:
        return self._rebinder.substitute(self._original[name])


class _Rebinder:
    def __init__(self) -> None:
        self._done: dict[int, tuple[Any, Any]] = {}

    def substitute(self, value: Any) -> Any:
        """What stands for `value` inside a rebound function."""
        if isinstance(value, types.ModuleType):
            return _MODULES.get(id(value), value)
        if id(value) in _FUNCTIONS:
            return _FUNCTIONS[id(value)]
        if hasattr(value, "py_func") or isinstance(value, types.FunctionType | types.MethodType | functools.partial):
            return self.function(value)
        return value

    def function(self, f: Any) -> Any:
        """A copy of the function `f` for jets; `f` itself where it is nothing written in Python."""
        f = getattr(f, "py_func", f)
        if isinstance(f, functools.partial):
            return functools.partial(self.function(f.func), *f.args, **f.keywords)
        if isinstance(f, types.MethodType):
            return types.MethodType(self.function(f.__func__), f.__self__)
        if not isinstance(f, types.FunctionType):
            call = vars(type(f)).get("__call__")
            return types.MethodType(self.function(call), f) if isinstance(call, types.FunctionType) else f
        if (f.__module__ or "").split(".")[0] in _FOREIGN:
            return f
        if id(f) in self._done:
            return self._done[id(f)][1]
        # Cells are shared with the original (so that later assignments are seen), but for those substituted.
        cells = tuple(types.CellType() if self._changes(cell) else cell for cell in f.__closure__ or ())
        closure = cells if f.__closure__ is not None else None
        copy = types.FunctionType(f.__code__, _Globals(f.__globals__, self), f.__name__, f.__defaults__, closure)
        copy.__kwdefaults__ = f.__kwdefaults__
        self._done[id(f)] = (f, copy)
        for new, old in zip(cells, f.__closure__ or (), strict=True):
            if new is not old:
                new.cell_contents = self.substitute(old.cell_contents)
        return copy

    @staticmethod
    def _changes(cell: Any) -> bool:
        try:
            value = cell.cell_contents
        except ValueError:  # not yet assigned
            return False
        if id(value) in _FUNCTIONS or id(value) in _MODULES or hasattr(value, "py_func"):
            return True
        return isinstance(value, types.FunctionType | types.MethodType | functools.partial)


def rebind(f: Callable[..., Any]) -> Callable[..., Any]:
    """A copy of the user's function `f` that works with jets (see the module's text)."""
    return _Rebinder().function(f)
