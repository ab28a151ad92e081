"""Jets in compiled code: numbers with their first and second derivatives, those that are zero by construction left out.

A jet's type says which derivatives it has: of x_b - x_a two first ones and no second one, of its square three second
ones. So nothing is computed that is zero whatever the values, and a formula costs what its derivatives written by hand
would. Arithmetic, comparisons (of the values) and the usual functions of `math` and numpy work on jets, mixed with
plain numbers. Importing this module teaches numba the type; only who differentiates a formula pays for that.

Rules: Griewank and Walther, Evaluating Derivatives, 2nd ed. (SIAM 2008), chapters 3 and 13.
"""

import builtins
import operator
from collections.abc import Callable, Iterable
from typing import Any

from numba import types
from numba.core import cgutils
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, lower_cast, make_attribute_wrapper, models, register_model


class JetType(types.Type):
    """numba's type of a number with derivatives by some of `size` variables: `first` holds the variables i, `second`
    the pairs (i, j), i <= j."""

    def __init__(self, size: int, first: Iterable[int] = (), second: Iterable[tuple[int, int]] = ()) -> None:
        self.size, self.first, self.second = size, tuple(sorted(first)), tuple(sorted(second))
        super().__init__(name=f"Jet({size}, {self.first}, {self.second})")

    def joined(self, other: "JetType", extra: Iterable[tuple[int, int]] = ()) -> "JetType":
        """The type with the derivatives of both, and more second ones."""
        return JetType(self.size, {*self.first, *other.first}, {*self.second, *other.second, *extra})

    def unify(self, typing_context: Any, other: Any) -> Any:
        """A variable that is this in one branch and that in another has the derivatives of both."""
        if isinstance(other, types.Number):
            return self
        return self.joined(other) if isinstance(other, JetType) and other.size == self.size else None

    def can_convert_from(self, typing_context: Any, other: Any) -> Any:
        if isinstance(other, JetType):
            fits = other.size == self.size and set(other.first) <= set(self.first)
            return Conversion.safe if fits and set(other.second) <= set(self.second) else None
        return Conversion.safe if isinstance(other, types.Float | types.Integer) else None


@register_model(JetType)
class _JetModel(models.StructModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        names = ["x", *(f"g{i}" for i in kind.first), *(f"h{i}_{j}" for i, j in kind.second)]
        super().__init__(manager, kind, [(name, types.float64) for name in names])


make_attribute_wrapper(JetType, "x", "x")


class Parts:
    """A jet while code is written: machine values of the number and of the derivatives that there are."""

    def __init__(self, x: Any, first: dict[int, Any], second: dict[tuple[int, int], Any]) -> None:
        self.x, self.first, self.second = x, first, second


def parts_of(context: Any, builder: Any, kind: Any, value: Any) -> Parts:
    """The parts of a jet, or of a number of any type."""
    if not isinstance(kind, JetType):
        return Parts(context.cast(builder, value, kind, types.float64), {}, {})
    proxy = cgutils.create_struct_proxy(kind)(context, builder, value=value)
    first = {i: getattr(proxy, f"g{i}") for i in kind.first}
    return Parts(proxy.x, first, {(i, j): getattr(proxy, f"h{i}_{j}") for i, j in kind.second})


def made_of(context: Any, builder: Any, kind: JetType, parts: Parts) -> Any:
    """A jet of its parts; derivatives that it lacks are zero."""
    zero = context.get_constant(types.float64, 0.0)
    proxy = cgutils.create_struct_proxy(kind)(context, builder)
    proxy.x = parts.x
    for i in kind.first:
        setattr(proxy, f"g{i}", parts.first.get(i, zero))
    for i, j in kind.second:
        setattr(proxy, f"h{i}_{j}", parts.second.get((i, j), zero))
    return proxy._getvalue()


@lower_cast(types.Float, JetType)
@lower_cast(types.Integer, JetType)
@lower_cast(JetType, JetType)
def _cast(context: Any, builder: Any, source: Any, target: Any, value: Any) -> Any:
    return made_of(context, builder, target, parts_of(context, builder, source, value))


def _sum(builder: Any, terms: list[Any]) -> Any:
    total = terms[0]
    for term in terms[1:]:
        total = builder.fadd(total, term)
    return total


def _pairs(p: Iterable[int], q: Iterable[int]) -> set[tuple[int, int]]:
    return {(min(i, j), max(i, j)) for i in p for j in q}


def _mixed_terms(builder: Any, p: dict[int, Any], q: dict[int, Any], i: int, j: int) -> list[Any]:
    """What there is of p_i q_j + p_j q_i."""
    return [builder.fmul(p[k], q[m]) for k, m in ((i, j), (j, i)) if k in p and m in q]


def _composed(builder: Any, p: Parts, f: Any, f1: Any, f2: Any) -> Parts:
    """f(p), from the value and the derivatives of f."""
    second = {}
    for i, j in {*p.second, *_pairs(p.first, p.first)}:
        terms = [builder.fmul(f1, p.second[i, j])] if (i, j) in p.second else []
        if i in p.first and j in p.first:
            terms.append(builder.fmul(f2, builder.fmul(p.first[i], p.first[j])))
        second[i, j] = _sum(builder, terms)
    return Parts(f, {i: builder.fmul(f1, g) for i, g in p.first.items()}, second)


@intrinsic
def composed(typing_context: Any, p: Any, f: Any, f1: Any, f2: Any) -> Any:
    """composed(p, f, f1, f2): f(p) from the value and the two derivatives of a function at p.x."""
    if not isinstance(p, JetType):
        return None
    result = p.joined(p, _pairs(p.first, p.first))

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return made_of(context, builder, result, _composed(builder, parts_of(context, builder, p, args[0]), *args[1:]))

    return result(p, types.float64, types.float64, types.float64), codegen


def _of_two(p: Any, q: Any) -> tuple[JetType, JetType] | None:
    """The types of two operands of which one at least is a jet, a number as a jet without derivatives."""
    size = next((kind.size for kind in (p, q) if isinstance(kind, JetType)), None)
    if size is None or not all(isinstance(kind, JetType | types.Float | types.Integer) for kind in (p, q)):
        return None
    first, second = (kind if isinstance(kind, JetType) else JetType(size) for kind in (p, q))
    return (first, second) if first.size == second.size else None


def _linear_kind(p: JetType, q: JetType) -> JetType:
    return p.joined(q)


def _product_kind(p: JetType, q: JetType) -> JetType:
    return p.joined(q, _pairs(p.first, q.first))


def _quotient_kind(p: JetType, q: JetType) -> JetType:
    return p.joined(q, _pairs({*p.first, *q.first}, q.first))


def _add(context: Any, builder: Any, kind: JetType, p: Parts, q: Parts) -> Parts:
    first = {i: _sum(builder, [x[i] for x in (p.first, q.first) if i in x]) for i in kind.first}
    second = {k: _sum(builder, [x[k] for x in (p.second, q.second) if k in x]) for k in kind.second}
    return Parts(builder.fadd(p.x, q.x), first, second)


def _minus(builder: Any, p: Parts) -> Parts:
    first = {i: builder.fneg(x) for i, x in p.first.items()}
    return Parts(builder.fneg(p.x), first, {k: builder.fneg(x) for k, x in p.second.items()})


def _sub(context: Any, builder: Any, kind: JetType, p: Parts, q: Parts) -> Parts:
    return _add(context, builder, kind, p, _minus(builder, q))


def _mul(context: Any, builder: Any, kind: JetType, p: Parts, q: Parts) -> Parts:
    first, second = {}, {}
    for i in kind.first:
        terms = [builder.fmul(a.first[i], b.x) for a, b in ((p, q), (q, p)) if i in a.first]
        first[i] = _sum(builder, terms)
    for i, j in kind.second:
        terms = [builder.fmul(a.second[i, j], b.x) for a, b in ((p, q), (q, p)) if (i, j) in a.second]
        mixed = _mixed_terms(builder, p.first, q.first, i, j)
        second[i, j] = _sum(builder, [*terms, *(mixed[:1] if i == j else mixed), *(mixed[:1] if i == j else ())])
    return Parts(builder.fmul(p.x, q.x), first, second)


def _div(context: Any, builder: Any, kind: JetType, p: Parts, q: Parts) -> Parts:
    # z = p/q: z_i = (p_i - z q_i)/q, z_ij = (p_ij - z q_ij - z_i q_j - z_j q_i)/q
    z = builder.fdiv(p.x, q.x)
    down = builder.fneg(z)
    first, second = {}, {}
    for i in kind.first:
        terms = [p.first[i]] if i in p.first else []
        terms += [builder.fmul(down, q.first[i])] if i in q.first else []
        first[i] = builder.fdiv(_sum(builder, terms), q.x)
    less = {i: builder.fneg(x) for i, x in first.items()}
    for i, j in kind.second:
        terms = [p.second[i, j]] if (i, j) in p.second else []
        terms += [builder.fmul(down, q.second[i, j])] if (i, j) in q.second else []
        terms += _mixed_terms(builder, less, q.first, i, j)
        second[i, j] = builder.fdiv(_sum(builder, terms), q.x)
    return Parts(z, first, second)


def _chooses(comparison: str) -> Callable[..., Parts]:
    """max and min: the jet whose value compares so with the other's."""

    def code(context: Any, builder: Any, kind: JetType, p: Parts, q: Parts) -> Parts:
        zero, chosen = context.get_constant(types.float64, 0.0), builder.fcmp_ordered(comparison, p.x, q.x)
        first = {i: builder.select(chosen, p.first.get(i, zero), q.first.get(i, zero)) for i in kind.first}
        second = {k: builder.select(chosen, p.second.get(k, zero), q.second.get(k, zero)) for k in kind.second}
        return Parts(builder.select(chosen, p.x, q.x), first, second)

    return code


def _teach_operator(function: Any, kind_of: Callable[[JetType, JetType], JetType], code: Callable[..., Parts]) -> None:
    """`code(context, builder, kind, p, q)` gives the parts of the result, of the type `kind_of` says."""

    class Typed(AbstractTemplate):
        def generic(self, args: Any, keywords: Any) -> Any:
            kinds = _of_two(*args) if len(args) == 2 else None
            return None if kinds is None else signature(kind_of(*kinds), *args)

    infer_global(function)(Typed)

    @lower_builtin(function, JetType, JetType)
    @lower_builtin(function, JetType, types.Number)
    @lower_builtin(function, types.Number, JetType)
    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        p, q = (parts_of(context, builder, kind, value) for kind, value in zip(sig.args, args, strict=True))
        kind = sig.return_type
        return made_of(context, builder, kind, code(context, builder, kind, p, q))


def _teach_comparison(function: Any, comparison: str) -> None:
    class Typed(AbstractTemplate):
        def generic(self, args: Any, keywords: Any) -> Any:
            known = len(args) == 2 and _of_two(*args)
            return signature(types.boolean, *args) if known else None

    infer_global(function)(Typed)

    @lower_builtin(function, JetType, JetType)
    @lower_builtin(function, JetType, types.Number)
    @lower_builtin(function, types.Number, JetType)
    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        p, q = (parts_of(context, builder, kind, value).x for kind, value in zip(sig.args, args, strict=True))
        compare = builder.fcmp_unordered if comparison == "!=" else builder.fcmp_ordered
        return compare(comparison, p, q)


for _function, _kind, _code in (
    (operator.add, _linear_kind, _add), (operator.iadd, _linear_kind, _add),
    (operator.sub, _linear_kind, _sub), (operator.isub, _linear_kind, _sub),
    (operator.mul, _product_kind, _mul), (operator.imul, _product_kind, _mul),
    (operator.truediv, _quotient_kind, _div), (operator.itruediv, _quotient_kind, _div),
    (builtins.max, _linear_kind, _chooses(">=")), (builtins.min, _linear_kind, _chooses("<=")),
):  # fmt: skip
    _teach_operator(_function, _kind, _code)

for _function, _comparison in (
    (operator.lt, "<"), (operator.le, "<="), (operator.gt, ">"), (operator.ge, ">="), (operator.eq, "=="),
    (operator.ne, "!="),
):  # fmt: skip
    _teach_comparison(_function, _comparison)
