"""Dual numbers in compiled code: a value with its partial derivatives by two variables, exact to rounding.

Arithmetic, comparisons (of the values) and the usual functions of `math` and numpy work on them, mixed with plain
numbers, so that a formula written for numbers gives its derivatives when it is called with duals. Importing this
module teaches numba the type; only who differentiates a formula pays for that.
"""

import builtins
import math
import operator
from collections.abc import Callable
from typing import Any

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.typeconv import Conversion
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import (
    intrinsic,
    lower_builtin,
    lower_cast,
    make_attribute_wrapper,
    models,
    overload,
    register_model,
)


class DualType(types.Type):
    """numba's type of x + a e1 + b e2, e1 e1 = e1 e2 = e2 e2 = 0."""

    def __init__(self) -> None:
        super().__init__(name="Dual")

    def unify(self, typing_context: Any, other: Any) -> Any:
        """A variable that is a number in one branch and a dual in another is a dual."""
        return self if isinstance(other, types.Number) else None

    def can_convert_from(self, typing_context: Any, other: Any) -> Any:
        return Conversion.safe if isinstance(other, types.Float | types.Integer) else None


DUAL = DualType()


@register_model(DualType)
class _DualModel(models.StructModel):
    def __init__(self, manager: Any, kind: Any) -> None:
        super().__init__(manager, kind, [(name, types.float64) for name in ("x", "a", "b")])


for _name in ("x", "a", "b"):
    make_attribute_wrapper(DualType, _name, _name)


@intrinsic
def dual(typing_context: Any, x: Any, a: Any, b: Any) -> Any:
    """dual(x, a, b): the value x with derivatives a and b."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return _made(context, builder, *args)

    return DUAL(types.float64, types.float64, types.float64), codegen


@intrinsic
def lift(typing_context: Any, value: Any) -> Any:
    """A number as a constant dual; a dual as it is."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return args[0]

    return DUAL(DUAL), codegen


@lower_cast(types.Float, DualType)
@lower_cast(types.Integer, DualType)
def _number_to_dual(context: Any, builder: Any, source: Any, target: Any, value: Any) -> Any:
    zero = context.get_constant(types.float64, 0.0)
    return _made(context, builder, context.cast(builder, value, source, types.float64), zero, zero)


def _parts(context: Any, builder: Any, value: Any) -> tuple[Any, Any, Any]:
    proxy = cgutils.create_struct_proxy(DUAL)(context, builder, value=value)
    return proxy.x, proxy.a, proxy.b


def _made(context: Any, builder: Any, x: Any, a: Any, b: Any) -> Any:
    proxy = cgutils.create_struct_proxy(DUAL)(context, builder)
    proxy.x, proxy.a, proxy.b = x, a, b
    return proxy._getvalue()


def _mixed(*kinds: Any) -> bool:
    """Whether at least one is a dual, and the others are numbers."""
    return any(isinstance(kind, DualType) for kind in kinds) and all(
        isinstance(kind, DualType | types.Number) for kind in kinds
    )


def _teach_operator(function: Any, result: Any, code: Callable[..., Any]) -> None:
    """`code(context, builder, p, q)` makes the result from two duals; numbers are cast to duals before.

    Written as machine instructions, not as compiled Python: a formula is made of these, and compiles twice as fast.
    """

    class Typed(AbstractTemplate):
        def generic(self, args: Any, keywords: Any) -> Any:
            return signature(result, DUAL, DUAL) if len(args) == 2 and _mixed(*args) else None

    infer_global(function)(Typed)

    @lower_builtin(function, DUAL, DUAL)
    def lowered(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return code(context, builder, *args)


def _add(context: Any, builder: Any, p: Any, q: Any) -> Any:
    pairs = zip(_parts(context, builder, p), _parts(context, builder, q), strict=True)
    return _made(context, builder, *(builder.fadd(u, v) for u, v in pairs))


def _sub(context: Any, builder: Any, p: Any, q: Any) -> Any:
    pairs = zip(_parts(context, builder, p), _parts(context, builder, q), strict=True)
    return _made(context, builder, *(builder.fsub(u, v) for u, v in pairs))


def _mul(context: Any, builder: Any, p: Any, q: Any) -> Any:
    (x, *slopes), (y, *others) = _parts(context, builder, p), _parts(context, builder, q)
    rule = (builder.fadd(builder.fmul(u, y), builder.fmul(x, v)) for u, v in zip(slopes, others, strict=True))
    return _made(context, builder, builder.fmul(x, y), *rule)


def _div(context: Any, builder: Any, p: Any, q: Any) -> Any:
    (x, *slopes), (y, *others) = _parts(context, builder, p), _parts(context, builder, q)
    z = builder.fdiv(x, y)
    rule = (builder.fdiv(builder.fsub(u, builder.fmul(z, v)), y) for u, v in zip(slopes, others, strict=True))
    return _made(context, builder, z, *rule)


def _chooses(comparison: str) -> Callable[..., Any]:
    """max and min: the dual whose value compares so with the other's."""

    def code(context: Any, builder: Any, p: Any, q: Any) -> Any:
        x, y = _parts(context, builder, p)[0], _parts(context, builder, q)[0]
        return builder.select(builder.fcmp_ordered(comparison, x, y), p, q)

    return code


def _compares(comparison: str) -> Callable[..., Any]:
    def code(context: Any, builder: Any, p: Any, q: Any) -> Any:
        compare = builder.fcmp_unordered if comparison == "!=" else builder.fcmp_ordered
        return compare(comparison, _parts(context, builder, p)[0], _parts(context, builder, q)[0])

    return code


for _function, _code in (
    (operator.add, _add), (operator.iadd, _add), (operator.sub, _sub), (operator.isub, _sub),
    (operator.mul, _mul), (operator.imul, _mul), (operator.truediv, _div), (operator.itruediv, _div),
    (builtins.max, _chooses(">=")), (builtins.min, _chooses("<=")),
):  # fmt: skip
    _teach_operator(_function, DUAL, _code)

for _function, _comparison in (
    (operator.lt, "<"), (operator.le, "<="), (operator.gt, ">"), (operator.ge, ">="), (operator.eq, "=="),
    (operator.ne, "!="),
):  # fmt: skip
    _teach_operator(_function, types.boolean, _compares(_comparison))


def _pow_number(p: Any, q: Any) -> Any:
    # a power 0 has no slope, also where p = 0
    slope = q * p.x ** (q - 1.0) if q != 0.0 else 0.0
    return dual(p.x**q, slope * p.a, slope * p.b)


def _pow_dual(p: Any, q: Any) -> Any:
    value, slope = p.x**q.x, q.x * p.x ** (q.x - 1.0)
    # x^y ln x goes to 0 with x for y > 0
    growth = value * math.log(p.x) if p.x > 0.0 else 0.0
    return dual(value, slope * p.a + growth * q.a, slope * p.b + growth * q.b)


def _number_pow(p: Any, q: Any) -> Any:
    value = p**q.x
    growth = value * math.log(p) if p > 0.0 else 0.0
    return dual(value, growth * q.a, growth * q.b)


def _pow_typed(p: Any, q: Any) -> Any:
    if not _mixed(p, q):
        return None
    if not isinstance(q, DualType):
        return _pow_number
    return _pow_dual if isinstance(p, DualType) else _number_pow


for _function in (operator.pow, operator.ipow, builtins.pow, math.pow):
    overload(_function)(_pow_typed)


def _teach_unary(functions: tuple[Any, ...], rule: Callable[[Any], Any]) -> None:
    """`rule(p)` gives the dual."""

    def typed(p: Any) -> Any:
        return rule if isinstance(p, DualType) else None

    for function in functions:
        overload(function)(typed)


def _sqrt(p: Any) -> Any:
    root = math.sqrt(p.x)
    return dual(root, 0.5 * p.a / root, 0.5 * p.b / root)


def _exp(p: Any) -> Any:
    value = math.exp(p.x)
    return dual(value, value * p.a, value * p.b)


def _expm1(p: Any) -> Any:
    slope = math.exp(p.x)
    return dual(math.expm1(p.x), slope * p.a, slope * p.b)


def _log(p: Any) -> Any:
    return dual(math.log(p.x), p.a / p.x, p.b / p.x)


def _log1p(p: Any) -> Any:
    return dual(math.log1p(p.x), p.a / (1.0 + p.x), p.b / (1.0 + p.x))


def _sin(p: Any) -> Any:
    slope = math.cos(p.x)
    return dual(math.sin(p.x), slope * p.a, slope * p.b)


def _cos(p: Any) -> Any:
    slope = -math.sin(p.x)
    return dual(math.cos(p.x), slope * p.a, slope * p.b)


def _tan(p: Any) -> Any:
    value = math.tan(p.x)
    slope = 1.0 + value * value
    return dual(value, slope * p.a, slope * p.b)


def _atan(p: Any) -> Any:
    slope = 1.0 / (1.0 + p.x * p.x)
    return dual(math.atan(p.x), slope * p.a, slope * p.b)


def _sinh(p: Any) -> Any:
    slope = math.cosh(p.x)
    return dual(math.sinh(p.x), slope * p.a, slope * p.b)


def _cosh(p: Any) -> Any:
    slope = math.sinh(p.x)
    return dual(math.cosh(p.x), slope * p.a, slope * p.b)


def _tanh(p: Any) -> Any:
    value = math.tanh(p.x)
    slope = 1.0 - value * value
    return dual(value, slope * p.a, slope * p.b)


def _absolute(p: Any) -> Any:
    return dual(-p.x, -p.a, -p.b) if p.x < 0.0 else p


def _negative(p: Any) -> Any:
    return dual(-p.x, -p.a, -p.b)


def _positive(p: Any) -> Any:
    return p


for _functions, _unary in (
    ((math.sqrt, np.sqrt), _sqrt), ((math.exp, np.exp), _exp), ((math.expm1, np.expm1), _expm1),
    ((math.log, np.log), _log), ((math.log1p, np.log1p), _log1p), ((math.sin, np.sin), _sin),
    ((math.cos, np.cos), _cos), ((math.tan, np.tan), _tan), ((math.atan, np.arctan), _atan),
    ((math.sinh, np.sinh), _sinh), ((math.cosh, np.cosh), _cosh), ((math.tanh, np.tanh), _tanh),
    ((builtins.abs, math.fabs, np.abs), _absolute), ((operator.neg,), _negative), ((operator.pos,), _positive),
):  # fmt: skip
    _teach_unary(_functions, _unary)
