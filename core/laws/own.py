"""A law from the formula of its force alone: derivatives by dual numbers, the spring's energy by quadrature."""

import inspect
import math
from collections.abc import Callable
from typing import Any

import numpy as np

from ..compiled.needed import numba_module
from ..errors import ModelError
from .base import ForceLaw

_POINTS, _WEIGHTS = np.polynomial.legendre.leggauss(8)
ROOTS = tuple(0.5 * (1.0 + _POINTS))
"""sqrt(x/delta) at the points x of the quadrature over 0 ... delta."""
SHARES = tuple(_WEIGHTS * ROOTS)
"""Their weights over delta: dx = 2 delta s ds, and the interval 0 ... 1 halves Gauss's weights."""


def force_formula(force: Callable[..., float]) -> Any:
    """Formula of a ForceLaw from F(delta, delta_dot, v0, p0, ...): the force in N, with at most four parameters.

    `force` is plain Python or a numba function, of numbers: arithmetic, comparisons, abs, min, max, and the functions
    of `math`. Its derivatives are exact to rounding; one that is not finite at delta = 0 (of a root) counts as 0 there.
    The elastic part is F(delta, 0, v0); its energy is integrated by Gauss's rule with 8 points in sqrt(delta), which is
    exact for springs delta^(k/2), k <= 13. It is compiled when it is first used, and kept on disk.

    Raises
    ------
    ModelError : if `force` does not take 3 to 7 arguments.
    """
    plain = getattr(force, "py_func", force)
    count, most = len(inspect.signature(plain).parameters), 3 + ForceLaw.parameter_count
    if not 3 <= count <= most:
        raise ModelError(
            f"{plain.__name__} takes {count} arguments; a force takes (delta, delta_dot, v0) and up to "
            f"{ForceLaw.parameter_count} parameters"
        )
    numba_module()
    # numba learns the type of dual numbers here and not before: not everyone differentiates
    from numba import njit

    from ..compiled.dual import dual, lift
    from ..compiled.formula_code import FormulaCode

    jit = njit(error_model="numpy")
    # the formula is called with all parameters, the force with those that it takes
    taken = ", ".join(f"p{k}" for k in range(count - 3))
    names: dict[str, Any] = {"force": jit(plain)}
    exec(f"def call(d, dd, v0, p0, p1, p2, p3):\n    return force(d, dd, v0, {taken})\n", names)
    call = jit(names["call"])

    def formula(d: float, dd: float, v0: float, p0: float, p1: float, p2: float, p3: float) -> Any:
        f = lift(call(dual(d, 1.0, 0.0), dual(dd, 0.0, 1.0), v0, p0, p1, p2, p3))
        energy = 0.0
        for k in range(8):
            energy += SHARES[k] * call(d * ROOTS[k] ** 2, 0.0, v0, p0, p1, p2, p3)
        # a root has no slope where shapes just touch; the force is none there yet, and the next point has one
        stiffness = f.a if d != 0.0 or math.isfinite(f.a) else 0.0
        damping = f.b if d != 0.0 or math.isfinite(f.b) else 0.0
        return f.x, stiffness, damping, float(call(d, 0.0, v0, p0, p1, p2, p3)), energy * d

    formula.__name__ = plain.__name__
    made = jit(formula)
    made._cache = FormulaCode(formula, (plain,))
    return made
