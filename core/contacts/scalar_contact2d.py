"""Contacts from formulas: a gap function, and a sliding distance for friction."""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from itertools import combinations
from typing import Any, ClassVar

from ..compiled.jit import internal
from ..compiled.kernels import shown, shown_at
from ..compiled.views import imat, mat, vec
from ..elements.base import BodyElement, Form, Numbering, Row
from ..elements.formula2d import (
    Arguments,
    FormKey,
    Frame2D,
    argument_names,
    caller_of,
    derivatives,
    form_ahead,
    plain_function,
)
from ..errors import ModelError
from ..laws.friction import LuGreFriction
from ..model.markers import Marker2D
from .bristle2d import act_bristles
from .contact2d import Contact2D
from .geometry_kinds import OUTLINE, are
from .normal2d import act
from .sliding2d import act_sliding

KIND, SLIDING_KIND, BRISTLE_KIND = "scalar_contact2d", "sliding_scalar_contact2d", "bristle_scalar_contact2d"
"""Of its kernels in the library of machine code."""
PERIOD, FIRST_PARAMETER = 0, 16
"""Columns of the table of parameters: by how much the sliding distance may jump, and the first one of the formulas;
7 to 15 are those of the laws."""
PROBES, NOT_EVEN = 7, 1e-9
"""Directions in which a gap is looked at, and what rounding may do to it, in parts of the shape's size."""


class ScalarContact:
    """Gap and sliding distance as formulas of markers and numbers; made by `scalar_contact`."""

    def __init__(self, gap: Callable[..., Any], slide: Callable[..., Any] | None, convex: bool = False) -> None:
        self.gap = plain_function(gap)
        self.slide = None if slide is None else plain_function(slide)
        self.convex = convex
        if convex:
            are(OUTLINE, self.gap)

    @property
    def formulas(self) -> tuple[Callable[..., Any], ...]:
        """Gap, and sliding distance if there is one."""
        return (self.gap,) if self.slide is None else (self.gap, self.slide)

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the arguments of both."""
        return (*argument_names(self.gap), *(() if self.slide is None else argument_names(self.slide)))


def scalar_contact(
    gap: Callable[..., Any], slide: Callable[..., Any] | None = None, *, convex: bool = False
) -> ScalarContact:
    """A contact from formulas, for `ScalarContact2D`.

    Parameters
    ----------
    gap : m, of markers and numbers, as in `scalar_constraint`: positive while the shapes are apart; its gradient is
        the direction of the normal force, so that |gradient| by the points is 1 for a force in N.
    slide : m, how far the shapes have slid on each other, for friction; its gradient is the direction of the friction
        force. For wheels it counts their rolling.
    convex : whether the gap is the distance of its second marker's point from a convex shape on its first one, less a
        number, as that of a disk: then it is bounded within a step, and no touch is missed (`separation.py`). Below
        zero it may be any convex continuation, such as that by the nearest side.

    Raises
    ------
    ModelError : for what is no function.
    """
    return ScalarContact(gap, slide, convex)


@internal
def _period(b: Any, e: int) -> float:
    return mat(b.par, b.count, b.npar)[e, PERIOD]


@cache
def _kernel(gap: Callable[..., Any], arguments: Arguments) -> Any:
    from ..compiled.formula_code import formula_internal
    from ..compiled.jet_functions import gradient_of, hessian_of, value_of

    call = caller_of(gap, arguments, FIRST_PARAMETER)

    def scalar_contact2d_kernel(job: int, t: float, b: Any) -> None:
        par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
        for i in range(shown(b)):
            e = shown_at(b, i)
            g = call(q, coord[e], par[e])
            act(b, job, e, value_of(g), gradient_of(g), hessian_of(g))

    return formula_internal(scalar_contact2d_kernel, (gap,), arguments)


@cache
def _rubbing_kernel(gap: Callable[..., Any], slide: Callable[..., Any], arguments: Arguments, bristles: bool) -> Any:
    from ..compiled.formula_code import formula_internal
    from ..compiled.jet_functions import gradient_of, hessian_of, value_of

    call, call_slide = caller_of(gap, arguments, FIRST_PARAMETER), caller_of(slide, arguments, FIRST_PARAMETER)

    def sliding_scalar_contact2d_kernel(job: int, t: float, b: Any) -> None:
        par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
        for i in range(shown(b)):
            e = shown_at(b, i)
            g, s = call(q, coord[e], par[e]), call_slide(q, coord[e], par[e])
            act_sliding(
                b, job, t, e, value_of(g), gradient_of(g), hessian_of(g), value_of(s), gradient_of(s), hessian_of(s),
                _period(b, e),
            )  # fmt: skip

    def bristle_scalar_contact2d_kernel(job: int, t: float, b: Any) -> None:
        par, coord, q = mat(b.par, b.count, b.npar), imat(b.coord, b.count, b.ncoord), vec(b.q, b.n_extended)
        for e in range(b.count):
            g, s = call(q, coord[e], par[e]), call_slide(q, coord[e], par[e])
            act_bristles(b, job, t, e, value_of(g), gradient_of(g), hessian_of(g), gradient_of(s), hessian_of(s))

    made = bristle_scalar_contact2d_kernel if bristles else sliding_scalar_contact2d_kernel
    return formula_internal(made, (gap, slide), arguments)


class ScalarContact2D(Contact2D):
    """Base of contacts whose gap is a formula of their markers, a user's own too.

    A subclass says its markers and numbers as fields, and its `formula`, made by `scalar_contact`. Laws and friction
    are those of all contacts; friction needs the sliding distance.
    """

    touch: ClassVar[str] = "gap"

    formula: ClassVar[ScalarContact]

    def slide_period(self) -> float:
        """By how much the sliding distance may jump where an angle goes round, m; 0: it does not."""
        return 0.0

    @property
    def kind(self) -> str | None:
        """Of its kernel in the library of machine code; None where there is no such kernel."""
        if self.friction is None:
            return KIND
        if self.formula.slide is None:
            return None
        return BRISTLE_KIND if isinstance(self.friction, LuGreFriction) else SLIDING_KIND

    def form_key(self) -> FormKey | None:
        """Kind and formulas of its kernel, by which the library of machine code has it; None where it has none."""
        return None if self.kind is None else (self.kind, self.formula.formulas)

    def geometry(self) -> Any:
        """The formula of its gap."""
        return self.formula.gap

    def arguments(self) -> Arguments:
        """What its formulas take."""
        return Arguments.of(self, self.formula.names)

    def markers(self) -> Sequence[Marker2D]:
        return self.arguments().marked(self)

    def form(self) -> Form:
        """Raises ModelError for friction without a sliding distance."""
        arguments, formula = self.arguments(), self.formula
        n, bristles = arguments.size, isinstance(self.friction, LuGreFriction)
        key = self.form_key()
        ahead = None if key is None else form_ahead(*key, arguments)
        if ahead is not None:
            return replace(ahead, rate_rows=self.rate_rows_of_slide())
        derivatives(formula.gap, arguments)
        if self.friction is None:
            kernel, rows = _kernel(formula.gap, arguments), 1
        elif formula.slide is None:
            raise ModelError(
                f"contact '{self.name}' has friction, but {type(self).__name__} says no sliding distance: give "
                "scalar_contact a second formula, or leave friction out"
            )
        else:
            derivatives(formula.slide, arguments)
            kernel, rows = _rubbing_kernel(formula.gap, formula.slide, arguments, bristles), 2
        size = n + bristles
        full = tuple((i, j) for i in range(size) for j in range(size))
        return Form(kernel, rows, full, tuple((k, j) for k in range(rows) for j in range(n)), self.rate_rows_of_slide())

    def check_in(self, bodies: Mapping[str, BodyElement]) -> None:
        super().check_in(bodies)
        if self.formula.convex and not self.formula.gap.__module__.startswith("tlismni."):
            self.check_convex()

    def check_convex(self) -> None:
        """Raise ValueError if its gap is no distance from a convex shape, by points around it."""
        arguments, gap = self.arguments(), self.formula.gap
        names, numbers = argument_names(gap), {name: float(getattr(self, name)) for name in arguments.numbers}
        if len(arguments.markers) != 2:
            raise ValueError(
                f"the gap of {type(self).__name__} is said to be that of a convex shape and a point, but it has "
                f"{len(arguments.markers)} markers: give it that of the shape and that of the point, or leave out "
                "`convex`"
            )
        frames = {arguments.markers[0]: Frame2D(0.0, 0.0, 0.0, 1.0, 0.0)}
        size = max((abs(x) for x in numbers.values()), default=0.0) or 1.0

        def at(x: float, y: float, angle: float = 0.0) -> float:
            frames[arguments.markers[1]] = Frame2D(x, y, angle, math.cos(angle), math.sin(angle))
            return float(gap(*({**numbers, **frames}[name] for name in names)))

        points = [(r * size * math.cos(k), r * size * math.sin(k)) for k in range(PROBES) for r in (0.5, 1.5, 4.0)]
        small, seen = NOT_EVEN * size, [(x, y, at(x, y)) for x, y in points]
        for (x, y, here), (u, w, there) in combinations(seen, 2):
            if abs(here - there) > math.dist((x, y), (u, w)) + small or abs(at(u, w, 1.0) - there) > small:
                what = "grows faster than its point goes, or turns with it"
            elif at(0.5 * (x + u), 0.5 * (y + w)) > 0.5 * (here + there) + small:
                what = "is larger between two points than at both in the mean"
            else:
                continue
            raise ValueError(
                f"the gap of {type(self).__name__} is said to be the distance from a convex shape, but {what}, from "
                f"({x:.3g}, {y:.3g}) and ({u:.3g}, {w:.3g}) m from the shape's marker: mend the formula, or leave out "
                "`convex`"
            )

    def row(self, numbering: Numbering) -> Row:
        arguments, law = self.arguments(), self._law_columns(numbering)
        columns = (self.slide_period(), *(0.0,) * 6, *law.parameters, *arguments.columns(self))
        return Row(columns, arguments.coordinates(self, numbering), law.extra)
