"""Joints that hold one scalar function of their markers at zero, from the function's formula alone."""

from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import Any, ClassVar

from ..compiled.kernels import RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..model.channels import Channel
from ..model.markers import Marker2D
from .base import Form, JointElement, Numbering, Row
from .formula2d import (
    NO_NUMBERS,
    Arguments,
    FormKey,
    argument_names,
    caller_of,
    derivatives,
    form_ahead,
    plain_function,
)
from .geometry2d import constrain

KIND = "scalar_joint2d"
"""Of its kernels in the library of machine code."""


class ScalarConstraint:
    """The constraint formula(markers, numbers) = 0; made by `scalar_constraint`."""

    def __init__(self, formula: Callable[..., Any]) -> None:
        self.formula = plain_function(formula)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of its arguments."""
        return argument_names(self.formula)

    def form(self, arguments: Arguments) -> Form:
        """Kernel and patterns: those derivatives that the formula has."""
        ahead = form_ahead(KIND, (self.formula,), arguments)
        if ahead is not None:
            return ahead
        found = derivatives(self.formula, arguments)
        tangent = {*found.second, *((j, i) for i, j in found.second)}
        return Form(_kernel(self.formula, arguments), 1, tuple(sorted(tangent)), tuple((0, j) for j in found.first))


def scalar_constraint(formula: Callable[..., Any]) -> ScalarConstraint:
    """A constraint from a formula of points and directions, for `ScalarJoint2D`.

    `formula` is a Python function of numbers (a numba one too): arithmetic, comparisons, abs, min, max and the
    functions of `math`. Its arguments are named as fields of the joint: a marker has x, y, angle (rad), ex, ey (its
    first axis). Gradient and Hessian are exact to rounding; the compiled kernel is kept on disk.

    Raises
    ------
    ModelError : if it is no function.
    """
    return ScalarConstraint(formula)


@cache
def _kernel(formula: Callable[..., Any], arguments: Arguments) -> Any:
    from ..compiled.formula_code import formula_internal
    from ..compiled.jet_functions import gradient_of, hessian_of, value_of

    call, n = caller_of(formula, arguments, 0), arguments.size

    def scalar_joint2d_kernel(job: int, t: float, b: Any) -> None:
        if job != RESIDUAL and job != TANGENT:
            return
        par, coord, row = mat(b.par, b.count, b.npar), imat(b.coord, b.count, n), imat(b.row, b.count, 1)
        q = vec(b.q, b.n_extended)
        for e in range(b.count):
            g = call(q, coord[e], par[e])
            constrain(b, job, e, row[e, 0], 0, value_of(g), gradient_of(g), hessian_of(g))

    return formula_internal(scalar_joint2d_kernel, (formula,), arguments)


class ScalarJoint2D(JointElement):
    """Base of joints with one equation, formula = 0, a user's own too.

    A subclass says its markers and numbers as fields, and its `formula`, made by `scalar_constraint`. Class attribute
    `multiplier`: name, unit and meaning of the channel of its multiplier; the joint's force on the coordinates is
    -(gradient of the formula) (multiplier).
    """

    symbol: ClassVar[str] = "link"

    formula: ClassVar[ScalarConstraint]
    constraint_rows: ClassVar[int] = 1
    multiplier: ClassVar[tuple[str, str, str]] = ("multiplier", "N", "force against the growth of its formula")
    derived: ClassVar[tuple[str, ...]] = ()
    """Arguments of the formula that are no fields, but follow from where the model starts: `numbers` gives them."""

    def numbers(self, numbering: Numbering) -> Mapping[str, float]:
        """Values of the `derived` arguments."""
        return NO_NUMBERS

    def arguments(self) -> Arguments:
        """What its formula takes."""
        return Arguments.of(self, self.formula.names, dict.fromkeys(self.derived, 0.0))

    def form_key(self) -> FormKey:
        """Kind and formulas of its kernel, by which the library of machine code has it."""
        return KIND, (self.formula.formula,)

    def form(self) -> Form:
        return self.formula.form(self.arguments())

    def markers(self) -> Sequence[Marker2D]:
        return self.arguments().marked(self)

    def row(self, numbering: Numbering) -> Row:
        arguments = self.arguments()
        columns = arguments.columns(self, self.numbers(numbering))
        return Row(columns, arguments.coordinates(self, numbering))

    def multiplier_channels(self) -> Sequence[Channel]:
        name, unit, text = self.multiplier
        return (Channel(f"{self.name}.{name}", unit, text),)
