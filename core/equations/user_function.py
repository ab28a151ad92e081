"""One user function: its plain value with checks, and its derivatives by jets or by the complex step."""

import dis
import threading
import types
import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .arity import check_arity
from .errors import EquationError, NotDifferentiableError
from .rebind import rebind
from .seeding import Array, along_curve, as_array, split, split_twice, values_of, variables

COMPLEX_STEP = 1e-150  # its square vanishes against 1; large enough that scaling by 1e-150 does not underflow
_CONFIRM_STEP = 1e-5  # step and tolerance of the plausibility check of the complex step
_CONFIRM_TOLERANCE = 1e-4
_WARNINGS = threading.RLock()
"""What is a warning and what an error is one choice for all threads."""
_DYNAMIC_NAMES = {"locals", "vars", "eval", "exec"}


class UserFunction:
    """A function given by the user, or a constant in its place.

    Parameters
    ----------
    name : the argument's name, for messages ("constraint").
    arguments : its signature, for messages ("t, q").
    function : the function, plain Python or compiled with numba; or a constant array.
    shape : shape of the result; None: a vector whose length the first call decides.
    """

    def __init__(self, name: str, arguments: str, function: Any, shape: tuple[int, ...] | None) -> None:
        self.name = name
        self.signature = f"{name}({arguments})"
        self.shape = shape
        self.constant: Array | None = None
        self.original: Any = function
        if not callable(function):
            self.constant = self._shaped(function)
            self.constant.flags.writeable = False
            return
        check_arity(name, arguments, function)
        self._python: Callable[..., Any] = getattr(function, "py_func", function)
        self._variants: list[Callable[..., Any]] = [self._python]
        self._rebound_confirmed = False
        self._confirmed = False

    def value(self, *arguments: Any) -> Array:
        """Plain value, shape `self.shape`. The function gets copies: it cannot change the state."""
        if self.constant is not None:
            return self.constant.copy()
        try:
            result = self.original(*_copies(arguments))
        except Exception as error:
            error.add_note(f"raised in {self.signature} at {_place(arguments)}")
            raise
        return self._shaped(result)

    def gradient(self, arguments: tuple[Any, ...], wrt: tuple[int, ...]) -> tuple[Array, Array]:
        """Value and first derivatives, shape + (k,), with respect to the arguments numbered in `wrt`."""
        seeded, k = variables(arguments, wrt, 1)
        if self.constant is not None:
            return self.constant, np.zeros((*self.constant.shape, k))
        try:
            return split(self._jets(seeded, arguments), k)
        except NotDifferentiableError as error:
            return self._complex_gradient(arguments, wrt, k, error)

    def hessian(self, arguments: tuple[Any, ...], wrt: tuple[int, ...]) -> tuple[Array, Array, Array]:
        """Value, first and second derivatives, shape + (k, k); by jets only."""
        seeded, k = variables(arguments, wrt, 2)
        return split_twice(self._jets(seeded, arguments), k)

    def along(
        self, arguments: tuple[Any, ...], first: tuple[Any, ...], second: tuple[Any, ...]
    ) -> tuple[Array, Array, Array]:
        """Value and first two derivatives along a curve of the arguments; by jets only."""
        value, gradient, hessian = split_twice(self._jets(along_curve(arguments, first, second), arguments), 1)
        return value, gradient[..., 0], hessian[..., 0, 0]

    def slope(self, arguments: tuple[Any, ...], rates: tuple[Any, ...]) -> tuple[Array, Array]:
        """Value and first derivative along a line; arguments of rate None stay plain."""
        if self.constant is not None:
            return self.constant, np.zeros(self.constant.shape)
        try:
            value, gradient = split(self._jets(along_curve(arguments, rates, None), arguments), 1)
            return value, gradient[..., 0]
        except NotDifferentiableError as error:
            return self._complex_slope(arguments, rates, error)

    def uses_first_argument(self) -> bool:
        """False only where the code provably never reads its first argument (the time)."""
        f, first = getattr(self, "_python", None), 0
        if isinstance(f, types.MethodType):
            f, first = f.__func__, 1
        if not isinstance(f, types.FunctionType):
            return self.constant is None
        code = f.__code__
        if code.co_argcount <= first or _DYNAMIC_NAMES & set(code.co_names):
            return True
        name = code.co_varnames[first]
        return name in code.co_cellvars or any(
            name == x.argval or (isinstance(x.argval, tuple) and name in x.argval) for x in dis.get_instructions(code)
        )

    def _shaped(self, result: Any) -> Array:
        """The result as a float array of the right shape, or an error that says what is wrong."""
        try:
            array = as_array(result)
        except (TypeError, ValueError) as error:
            raise EquationError(
                f"{self.signature} gave {result!r}, which is no array of real numbers: return a list, a "
                f"tuple or an array of floats{self._needed()}"
            ) from error
        return self._reshaped(array)

    def _needed(self) -> str:
        return "" if self.shape is None else f" of shape {self.shape}"

    def _reshaped(self, array: NDArray[Any]) -> NDArray[Any]:
        if self.shape is None and array.ndim <= 1:
            self.shape = (array.size,)
        if array.shape == self.shape:
            return array
        if self.shape is not None:
            # A number for a single equation; a flat row for the Jacobian of one.
            if array.ndim == 0 and set(self.shape) == {1}:
                return array.reshape(self.shape)
            if len(self.shape) == 2 and self.shape[0] == 1 and array.shape == self.shape[1:]:
                return array.reshape(self.shape)
            if array.size == 0 and 0 in self.shape:
                return array.reshape(self.shape)
        needed = "a vector, one entry for each equation" if self.shape is None else f"shape {self.shape}"
        hint = " (numpy.diag makes a matrix of a diagonal)" if self.name == "mass" and array.ndim == 1 else ""
        raise EquationError(f"{self.signature} gave an array of shape {array.shape}; needed is {needed}{hint}")

    def _jets(self, seeded: list[Any], arguments: tuple[Any, ...]) -> NDArray[Any]:
        """The function of jets: as it is, and where that fails with numpy and math that know jets."""
        cause: Exception | None = None
        attempts = list(self._variants)
        for i, function in enumerate(attempts):
            try:
                array = as_array(function(*_copies(seeded)))
            except Exception as error:
                cause = cause or error
                if len(attempts) == 1:
                    attempts.append(rebind(self._python))
                    self._variants = list(attempts)
                continue
            if attempts[i] is not self._python and not self._rebound_confirmed:
                self._compare(self._reshaped(array), arguments)
            if i > 0:  # what works comes first from now on; a new list, as another thread may read the old one
                self._variants = [function, *(f for f in attempts if f is not function)]
            return self._reshaped(array)
        self.value(*arguments)  # an error of the function itself is the user's to see, not a lack of derivatives
        raise NotDifferentiableError(self._complaint(f"{type(cause).__name__}: {cause}")) from cause

    def _compare(self, jets: NDArray[Any], arguments: tuple[Any, ...]) -> None:
        """Once: the copy made for jets must give the function's own value."""
        plain, value = self.value(*arguments), values_of(jets)
        size = np.max(np.abs(plain), initial=0.0)
        if not np.allclose(value, plain, rtol=1e-9, atol=1e-9 * size, equal_nan=True):
            raise NotDifferentiableError(self._complaint("its value changes when numpy and math work on jets"))
        self._rebound_confirmed = True

    def _complaint(self, cause: str) -> str:
        remedies = {
            "constraint": ", or give constraint_jacobian= and gamma= (in time also constraint_rate=)",
            "constraint_jacobian": ", or leave constraint_jacobian out, so that constraint is differentiated",
        }
        return (
            f"{self.signature} cannot be differentiated automatically ({cause}). Write it with numpy "
            f"functions (numpy.sin, not math.sin; no float() of a coordinate){remedies.get(self.name, '')}"
        )

    def _complex_call(self, arguments: list[Any], cause: Exception) -> NDArray[Any]:
        try:
            with _WARNINGS, warnings.catch_warnings():
                # An imaginary part that is dropped is a derivative that is lost.
                warnings.simplefilter("error", np.exceptions.ComplexWarning)
                array = np.array(self._python(*arguments), dtype=complex)
        except Exception:
            raise cause from cause.__cause__
        return self._reshaped(array)

    def _complex_gradient(
        self, arguments: tuple[Any, ...], wrt: tuple[int, ...], k: int, cause: Exception
    ) -> tuple[Array, Array]:
        value = self.value(*arguments)
        gradient = np.empty((*value.shape, k))
        column = 0
        for i in wrt:
            for j in range(np.size(arguments[i])):
                direction: list[Any] = [None] * len(arguments)
                direction[i] = np.eye(np.size(arguments[i]))[j] if np.ndim(arguments[i]) else 1.0
                gradient[..., column] = self._complex_slope(arguments, tuple(direction), cause, confirm=False)[1]
                column += 1
        if not self._confirmed:
            rates = tuple(np.ones(np.shape(x)) if i in wrt else None for i, x in enumerate(arguments))
            self._confirm(arguments, rates, gradient.sum(axis=-1))
        return value, gradient

    def _complex_slope(
        self, arguments: tuple[Any, ...], rates: tuple[Any, ...], cause: Exception, confirm: bool = True
    ) -> tuple[Array, Array]:
        """First derivative along a line by the complex step (Squire and Trapp, SIAM Review 40 (1998) 110)."""
        shifted = [
            x if rate is None else x + 1j * COMPLEX_STEP * rate for x, rate in zip(arguments, rates, strict=True)
        ]
        array = self._complex_call(shifted, cause)
        slope = array.imag / COMPLEX_STEP
        if confirm and not self._confirmed:
            self._confirm(arguments, rates, slope)
        return array.real.copy(), slope

    def _confirm(self, arguments: tuple[Any, ...], rates: tuple[Any, ...], slope: Array) -> None:
        """Once, by plain differences: refuse the complex step where it loses imaginary parts (abs, norm)."""
        ends = []
        for sign in (1.0, -1.0):
            step = sign * _CONFIRM_STEP
            ends.append(self.value(*(x if r is None else x + step * r for x, r in zip(arguments, rates, strict=True))))
        difference = (ends[0] - ends[1]) / (2.0 * _CONFIRM_STEP)
        size = 1.0 + np.max(np.abs(difference), initial=0.0) + np.max(np.abs(ends[0]), initial=0.0)
        if not np.all(np.abs(slope - difference) <= _CONFIRM_TOLERANCE * size):
            raise NotDifferentiableError(
                self._complaint("neither automatic differentiation nor the complex step gives its derivative")
            )
        self._confirmed = True


def _copies(arguments: Any) -> list[Any]:
    return [x.copy() if isinstance(x, np.ndarray) else x for x in arguments]


def _place(arguments: tuple[Any, ...]) -> str:
    return ", ".join(f"{name}={np.asarray(x).tolist()}" for name, x in zip("tqv", arguments, strict=False))
