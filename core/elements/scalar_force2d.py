"""Forces along one scalar function of their markers, from formulas of the function, the force and its energy."""

from collections.abc import Callable, Sequence
from functools import cache
from typing import Any, ClassVar

from ..compiled.kernels import ENERGY, POWER, RESIDUAL, TANGENT
from ..compiled.views import imat, mat, vec
from ..errors import ModelError
from ..model.markers import Marker2D
from .base import ForceElement, Form, Numbering, Row
from .formula2d import MARKER_COLUMNS, Arguments, argument_names, caller_of, derivatives, plain_function
from .geometry2d import add_hessian, add_product, along

Function = Callable[..., Any]


class ScalarForce:
    """A force along the gradient of a measure x(markers, numbers); made by `scalar_force`."""

    def __init__(self, measure: Function, force: Function, energy: Function | None) -> None:
        self.measure, self.force = plain_function(measure), plain_function(force)
        self.energy = None if energy is None else plain_function(energy)
        for function, least, what in ((self.force, 2, "(x, rate, ...)"), (self.energy, 1, "(x, ...)")):
            if function is not None and len(argument_names(function)) < least:
                raise ModelError(f"{function.__qualname__} takes {argument_names(function)}, {what} is needed")

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the arguments that are fields."""
        more = argument_names(self.force)[2:]
        return (*argument_names(self.measure), *more, *(argument_names(self.energy)[1:] if self.energy else ()))

    def form(self, arguments: Arguments) -> Form:
        """Kernel and patterns."""
        found = derivatives(self.measure, arguments)
        bent = {k for pair in found.second for k in pair}
        pattern = {(i, j) for i in found.first for j in {*found.first, *bent}}
        pattern |= {*found.second, *((j, i) for i, j in found.second)}
        return Form(_kernel(self, arguments), 0, tuple(sorted(pattern)), ())


def scalar_force(measure: Function, force: Function, energy: Function | None = None) -> ScalarForce:
    """A force from formulas, for `ScalarForce2D`.

    Parameters
    ----------
    measure : x of markers and numbers, as in `scalar_constraint`: a length, an angle ...
    force : F(x, rate, ...) that works against the growth of x: the generalised force on the coordinates is
        -F (gradient of x). In N for x in m, in N m for x in rad.
    energy : E(x, ...), J, whose derivative is the elastic part of F; the rest of F counts as dissipated. Left out: all
        of it.

    Further arguments are named as fields of the element. Derivatives are exact to rounding.

    Raises
    ------
    ModelError : for what is no function, or takes too few arguments.
    """
    return ScalarForce(measure, force, energy)


def _caller_of_law(function: Function, known: int, arguments: Arguments) -> Any:
    """Numba function law(..., par) with the first `known` arguments given."""
    begin = MARKER_COLUMNS * len(arguments.markers)
    given = ", ".join(f"x{k}" for k in range(known))
    more = "".join(f", par[{begin + arguments.numbers.index(n)}]" for n in argument_names(function)[known:])
    from numba import njit

    names: dict[str, Any] = {"function": njit(error_model="numpy")(function)}
    exec(f"def call({given}, par):\n    return function({given}{more})\n", names)
    return njit(error_model="numpy")(names["call"])


@cache
def _kernel(law: ScalarForce, arguments: Arguments) -> Any:
    from ..compiled.dual import dual, lift
    from ..compiled.formula_code import formula_internal
    from ..compiled.jet_functions import gradient_of, hessian_of, value_of

    call, force = caller_of(law.measure, arguments, 0), _caller_of_law(law.force, 2, arguments)
    energy = _caller_of_law(law.energy or _nothing, 1, arguments)
    n = arguments.size  # known to the compiler

    def scalar_force2d_kernel(job: int, t: float, b: Any) -> None:
        par, coord = mat(b.par, b.count, b.npar), imat(b.coord, b.count, n)
        q, v = vec(b.q, b.n_extended), vec(b.v, b.n_extended)
        for e in range(b.count):
            g = call(q, coord[e], par[e])
            x, gradient, hessian = value_of(g), gradient_of(g), hessian_of(g)
            rate = along(gradient, v, coord[e])
            if job == RESIDUAL:
                r, f = vec(b.r, b.n_extended), lift(force(dual(x, 1.0, 0.0), dual(rate, 0.0, 1.0), par[e])).x
                for i in range(len(gradient)):
                    r[coord[e, i]] += f * gradient[i]
            elif job == TANGENT:
                p = lift(force(dual(x, 1.0, 0.0), dual(rate, 0.0, 1.0), par[e]))
                values, coef = vec(b.values, b.n_values), vec(b.coef, 2)
                slot = imat(b.slot_s + 8 * n * n * e, n, n)
                add_hessian(values, slot, gradient, hessian, coef[0] * p.x)
                by_value, by_rate = coef[0] * p.a + coef[1] * p.b, coef[0] * p.b
                add_product(values, slot, gradient, gradient, hessian, v, coord[e], by_value, by_rate)
            elif job == ENERGY:
                vec(b.energy, 3)[2] += lift(energy(dual(x, 1.0, 0.0), par[e])).x
            elif job == POWER:
                f = lift(force(dual(x, 1.0, 0.0), dual(rate, 0.0, 1.0), par[e])).x
                elastic = lift(energy(dual(x, 1.0, 0.0), par[e])).a
                vec(b.a, b.n_extended)[imat(b.extra, b.count, 1)[e, 0]] += (f - elastic) * rate

    formulas = (law.measure, law.force, law.energy or _nothing)
    return formula_internal(scalar_force2d_kernel, formulas, arguments)


def _nothing(x: float) -> float:
    return 0.0 * x


class ScalarForce2D(ForceElement):
    """Base of forces along one scalar function of their markers, a user's own too.

    A subclass says its markers and numbers as fields, and its `formula`, made by `scalar_force`.
    """

    formula: ClassVar[ScalarForce]

    def arguments(self) -> Arguments:
        """What its formulas take."""
        return Arguments.of(self, self.formula.names)

    def form(self) -> Form:
        return self.formula.form(self.arguments())

    def markers(self) -> Sequence[Marker2D]:
        return self.arguments().marked(self)

    def row(self, numbering: Numbering) -> Row:
        arguments = self.arguments()
        account = (numbering.work("dampers"),)
        return Row(arguments.columns(self), arguments.coordinates(self, numbering), account)
