"""Smooth convex shapes in space by their support function: how far a shape reaches in a direction.

h(c) is the largest c . y over the points y of the shape, c and y along the axes of its marker; h(s c) = s h(c) for
s > 0. The point that is reached is y = grad h, and how it moves on the surface as the direction turns is Hess h
(Schneider 2014, Convex Bodies: The Brunn-Minkowski Theory, section 1.7): all that a contact with a half-space needs.
"""

import inspect
import math
from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np
from pydantic import model_validator

from ..compiled import types
from ..compiled.jit import caller
from ..compiled.needed import numba_module
from ..errors import ModelError
from ..laws.formula import FormulaRecord, formula_address
from ..model.markers import Marker3D
from .shape import Shape3D

SUPPORT_RESULT = types.UniTuple(types.float64, 10)
SUPPORT_SIGNATURE = SUPPORT_RESULT(*([types.float64] * 7))
SUPPORT_NUMBERS = 4
_PROBES = ((0.36, 0.48, 0.8), (-0.8, 0.36, 0.48), (0.28, -0.576, 0.768))
_NOT_EVEN = 1e-9

call_support = caller(SUPPORT_SIGNATURE)
"""call_support(address, x, y, z, p0, p1, p2, p3) -> (h, h_x, h_y, h_z, h_xx, h_xy, h_xz, h_yy, h_yz, h_zz)."""


class SmoothShape3D(FormulaRecord, Shape3D):
    """Base of smooth convex shapes about a marker that touch half-spaces, a user's own too.

    A subclass says its sizes as fields (at most four numbers) and its `formula`, made by `support_formula`.
    """

    own_type: ClassVar[bool] = True
    parameter_count: ClassVar[int] = SUPPORT_NUMBERS
    shared_fields: ClassVar[tuple[str, ...]] = ("marker",)

    marker: Marker3D
    """Its middle and axes."""

    @model_validator(mode="after")
    def _is_a_support_function(self) -> "SmoothShape3D":
        for direction in _PROBES:
            once, twice = self.support(direction), self.support(tuple(2.0 * x for x in direction))
            if not abs(twice[0] - 2.0 * once[0]) <= _NOT_EVEN * max(abs(once[0]), abs(twice[0])):
                raise ValueError(
                    f"the formula of {type(self).__name__} is {once[0]:g} in the direction {direction} and "
                    f"{twice[0]:g} in twice this vector: a support function grows as its argument does; write "
                    "sqrt(x*x + y*y + z*z) for each 1 that stands for the length of the direction"
                )
            bent = np.array([[once[4], once[5], once[6]], [once[5], once[7], once[8]], [once[6], once[8], once[9]]])
            values = np.linalg.eigvalsh(bent)
            if values[0] < -_NOT_EVEN * max(abs(values[-1]), abs(once[0])):
                raise ValueError(
                    f"the formula of {type(self).__name__} bends inwards in the direction {direction} (its second "
                    f"derivatives have the eigenvalue {values[0]:g}): it is no support function of a convex shape"
                )
        return self

    def support(self, direction: tuple[float, ...]) -> tuple[float, ...]:
        """How far it reaches in a direction along the marker's axes, m, with first and second derivatives (10,)."""
        x, y, z = direction
        return tuple(float(v) for v in type(self).formula(float(x), float(y), float(z), *self.formula_parameters()))

    def extent(self) -> float:
        """No point of it is farther from the marker, m: the corner of the box around it."""
        corner = 0.0
        for k in range(3):
            # beside the axes, on which a ring's derivatives do not exist
            near = [1e-6, 1e-6, 1e-6]
            near[k] = 1.0
            ends = (tuple(near), tuple(-x for x in near))
            corner += max(self.support(end)[0] for end in ends) ** 2
        return math.sqrt(corner)


def support_formula(support: Callable[..., Any]) -> Any:
    """Formula of a SmoothShape3D from h(x, y, z, p0, ...): how far it reaches in the direction (x, y, z), m.

    `support` is plain Python or a numba function of a direction and at most four numbers: arithmetic, comparisons,
    abs, min, max, and the functions of `math`. Its derivatives are exact to rounding. It is compiled when it is first
    used, and kept on disk.

    Raises
    ------
    ModelError : if `support` does not take 3 to 7 arguments.
    """
    plain = getattr(support, "py_func", support)
    count = len(inspect.signature(plain).parameters)
    if not 3 <= count <= 3 + SUPPORT_NUMBERS:
        raise ModelError(
            f"{plain.__name__} takes {count} arguments; a support function takes (x, y, z) and up to "
            f"{SUPPORT_NUMBERS} numbers"
        )
    numba_module()
    # numba learns the type of jets here and not before: not everyone differentiates
    from numba import njit

    from ..compiled.formula_code import FormulaCode
    from ..compiled.jet_functions import gradient_of, hessian_of, value_of, variable

    x_of, y_of, z_of = variable(3, 0), variable(3, 1), variable(3, 2)
    jit = njit(error_model="numpy")
    taken = "".join(f", p{k}" for k in range(count - 3))
    names: dict[str, Any] = {"support": jit(plain)}
    exec(f"def call(x, y, z, p0, p1, p2, p3):\n    return support(x, y, z{taken})\n", names)
    call = jit(names["call"])

    def formula(x: float, y: float, z: float, p0: float, p1: float, p2: float, p3: float) -> Any:
        h = call(x_of(x), y_of(y), z_of(z), p0, p1, p2, p3)
        g, c = gradient_of(h), hessian_of(h)
        return value_of(h), g[0], g[1], g[2], c[0], c[1], c[2], c[3], c[4], c[5]

    formula.__name__ = plain.__name__
    made = jit(formula)
    made._cache = FormulaCode(formula, (plain,))
    return made


def support_address(shape: SmoothShape3D) -> int:
    """Machine address of a shape's formula."""
    return formula_address(shape, SUPPORT_SIGNATURE)
