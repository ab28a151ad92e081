"""Into jets and out of them: seeding variables, reading values and derivatives from a function's result."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .jet import Jet, LineJet

Array = NDArray[np.float64]


def variables(arguments: tuple[Any, ...], wrt: tuple[int, ...], order: int) -> tuple[list[Any], int]:
    """The arguments with those numbered in `wrt` made independent variables.

    Parameters
    ----------
    arguments : floats and (n,) arrays.
    wrt : which of them are variables; the derivatives follow their order.
    order : 1 or 2.

    Returns
    -------
    The arguments (jets, object arrays of jets) and the number k of variables.
    """
    k = sum(int(np.size(arguments[i])) for i in wrt)
    unit, zero = np.eye(k), np.zeros((k, k)) if order == 2 else None
    seeded: list[Any] = list(arguments)
    position = 0
    for i in wrt:
        x = arguments[i]
        if isinstance(x, np.ndarray):
            jets = np.empty(x.size, dtype=object)
            for j in range(x.size):
                jets[j] = Jet(x[j], unit[position + j], zero)
            seeded[i] = jets
            position += x.size
        else:
            seeded[i] = Jet(x, unit[position], zero)
            position += 1
    return seeded, k


def along_curve(arguments: tuple[Any, ...], first: tuple[Any, ...], second: tuple[Any, ...] | None) -> list[Any]:
    """The arguments as points of a curve with the given first and second derivatives (None: stays plain)."""
    seeded: list[Any] = []
    for i, (x, rate) in enumerate(zip(arguments, first, strict=True)):
        bend = None if second is None else second[i]
        if rate is None:
            seeded.append(x)
        elif isinstance(x, np.ndarray):
            jets = np.empty(x.size, dtype=object)
            for j in range(x.size):
                jets[j] = LineJet(x[j], float(rate[j]), None if bend is None else float(bend[j]))
            seeded.append(jets)
        else:
            seeded.append(LineJet(x, float(rate), None if bend is None else float(bend)))
    return seeded


def as_array(result: Any) -> NDArray[Any]:
    """A function's result as a float array, or as an object array where it contains jets.

    Raises
    ------
    TypeError, ValueError : if it is ragged or contains something that is no number.
    """
    if isinstance(result, np.ndarray) and result.dtype.kind in "fiub":
        return result.astype(float)
    if not isinstance(result, np.ndarray):
        try:
            array = np.array(result)
        except ValueError:  # ragged, or jets among arrays
            array = np.array(result, dtype=object)
        if array.dtype.kind in "fiub":
            return array.astype(float)
    array = np.array(result, dtype=object)
    for i, x in enumerate(array.flat):
        if isinstance(x, np.ndarray) and x.ndim == 0:
            array.flat[i] = x.item()
        elif x is None or isinstance(x, str | bytes):
            raise TypeError(f"{x!r} is no number")
    if any(isinstance(x, Jet) for x in array.flat):
        return array
    return array.astype(float)


def values_of(array: NDArray[Any]) -> Array:
    """Values of an array with jets, of its shape."""
    if array.dtype != object:
        return array
    return np.array([x.value if isinstance(x, Jet) else float(x) for x in array.flat]).reshape(array.shape)


def split(array: NDArray[Any], k: int) -> tuple[Array, Array]:
    """Values (shape) and gradients (shape + (k,)) of an array with jets."""
    gradient = np.zeros((array.size, k))
    for i, x in enumerate(array.flat if array.dtype == object else ()):
        if isinstance(x, Jet):
            gradient[i] = x.gradient
    return values_of(array), gradient.reshape((*array.shape, k))


def split_twice(array: NDArray[Any], k: int) -> tuple[Array, Array, Array]:
    """Values, gradients and Hessians (shape + (k, k)) of an array with jets of second order."""
    hessian = np.zeros((array.size, k, k))
    for i, x in enumerate(array.flat if array.dtype == object else ()):
        if isinstance(x, Jet):
            hessian[i] = x.hessian
    return *split(array, k), hessian.reshape((*array.shape, k, k))
