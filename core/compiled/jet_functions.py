"""Functions of `math` and numpy on jets, and how jets begin and end: variables, gradients, Hessians."""

import builtins
import math
import operator
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
from numba import types
from numba.extending import intrinsic, overload

from .jets import JetType, Parts, _minus, composed, made_of, parts_of


@cache
def variable(size: int, k: int) -> Any:
    """Compiled function of a number: it as the jet of variable k of `size`."""
    kind = JetType(size, (k,))

    @intrinsic
    def as_variable(typing_context: Any, x: Any) -> Any:
        def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
            one = context.get_constant(types.float64, 1.0)
            return made_of(context, builder, kind, Parts(args[0], {k: one}, {}))

        return kind(types.float64), codegen

    return as_variable


@intrinsic
def negated(typing_context: Any, p: Any) -> Any:
    """-p."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return made_of(context, builder, p, _minus(builder, parts_of(context, builder, p, args[0])))

    return p(p), codegen


@intrinsic
def lift(typing_context: Any, like: Any, value: Any) -> Any:
    """lift(like, value): a number as a jet without derivatives, of the variables of the jet `like`; a jet as it is."""
    kind = value if isinstance(value, JetType) else JetType(like.size)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return made_of(context, builder, kind, parts_of(context, builder, value, args[1]))

    return kind(like, value), codegen


@intrinsic
def value_of(typing_context: Any, p: Any) -> Any:
    """The number alone."""

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        return parts_of(context, builder, p, args[0]).x

    return types.float64(p), codegen


@intrinsic
def gradient_of(typing_context: Any, p: Any) -> Any:
    """All first derivatives, a tuple of the length `size`."""
    result = types.UniTuple(types.float64, p.size)

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        zero, first = context.get_constant(types.float64, 0.0), parts_of(context, builder, p, args[0]).first
        return context.make_tuple(builder, result, [first.get(i, zero) for i in range(p.size)])

    return result(p), codegen


@intrinsic
def hessian_of(typing_context: Any, p: Any) -> Any:
    """All second derivatives: the upper triangle, row by row."""
    pairs = [(i, j) for i in range(p.size) for j in range(i, p.size)]
    result = types.UniTuple(types.float64, len(pairs))

    def codegen(context: Any, builder: Any, sig: Any, args: Any) -> Any:
        zero, second = context.get_constant(types.float64, 0.0), parts_of(context, builder, p, args[0]).second
        return context.make_tuple(builder, result, [second.get(pair, zero) for pair in pairs])

    return result(p), codegen


def _teach_unary(functions: tuple[Any, ...], rule: Callable[[Any], Any]) -> None:
    """`rule(p)` gives the jet."""

    def typed(p: Any) -> Any:
        return rule if isinstance(p, JetType) else None

    for function in functions:
        overload(function)(typed)


def _sqrt(p: Any) -> Any:
    root = math.sqrt(p.x)
    slope = 0.5 / root
    return composed(p, root, slope, -0.5 * slope / p.x)


def _exp(p: Any) -> Any:
    value = math.exp(p.x)
    return composed(p, value, value, value)


def _expm1(p: Any) -> Any:
    slope = math.exp(p.x)
    return composed(p, math.expm1(p.x), slope, slope)


def _log(p: Any) -> Any:
    slope = 1.0 / p.x
    return composed(p, math.log(p.x), slope, -slope * slope)


def _log1p(p: Any) -> Any:
    slope = 1.0 / (1.0 + p.x)
    return composed(p, math.log1p(p.x), slope, -slope * slope)


def _sin(p: Any) -> Any:
    value = math.sin(p.x)
    return composed(p, value, math.cos(p.x), -value)


def _cos(p: Any) -> Any:
    value = math.cos(p.x)
    return composed(p, value, -math.sin(p.x), -value)


def _tan(p: Any) -> Any:
    value = math.tan(p.x)
    slope = 1.0 + value * value
    return composed(p, value, slope, 2.0 * value * slope)


def _asin(p: Any) -> Any:
    slope = 1.0 / math.sqrt(1.0 - p.x * p.x)
    return composed(p, math.asin(p.x), slope, p.x * slope * slope * slope)


def _acos(p: Any) -> Any:
    slope = -1.0 / math.sqrt(1.0 - p.x * p.x)
    return composed(p, math.acos(p.x), slope, p.x * slope * slope * slope)


def _atan(p: Any) -> Any:
    slope = 1.0 / (1.0 + p.x * p.x)
    return composed(p, math.atan(p.x), slope, -2.0 * p.x * slope * slope)


def _sinh(p: Any) -> Any:
    value = math.sinh(p.x)
    return composed(p, value, math.cosh(p.x), value)


def _cosh(p: Any) -> Any:
    value = math.cosh(p.x)
    return composed(p, value, math.sinh(p.x), value)


def _tanh(p: Any) -> Any:
    value = math.tanh(p.x)
    slope = 1.0 - value * value
    return composed(p, value, slope, -2.0 * value * slope)


def _absolute(p: Any) -> Any:
    return negated(p) if p.x < 0.0 else p


def _negative(p: Any) -> Any:
    return negated(p)


def _positive(p: Any) -> Any:
    return p


for _functions, _rule in (
    ((math.sqrt, np.sqrt), _sqrt), ((math.exp, np.exp), _exp), ((math.expm1, np.expm1), _expm1),
    ((math.log, np.log), _log), ((math.log1p, np.log1p), _log1p), ((math.sin, np.sin), _sin),
    ((math.cos, np.cos), _cos), ((math.tan, np.tan), _tan), ((math.asin, np.arcsin), _asin),
    ((math.acos, np.arccos), _acos), ((math.atan, np.arctan), _atan), ((math.sinh, np.sinh), _sinh),
    ((math.cosh, np.cosh), _cosh), ((math.tanh, np.tanh), _tanh),
    ((builtins.abs, math.fabs, np.abs), _absolute), ((operator.neg,), _negative), ((operator.pos,), _positive),
):  # fmt: skip
    _teach_unary(_functions, _rule)


def _teach_steps(function: Any) -> None:
    """Functions that are constant between their jumps: the number alone."""

    def rule(p: Any) -> Any:
        return function(value_of(p))

    def typed(p: Any) -> Any:
        return rule if isinstance(p, JetType) else None

    overload(function)(typed)


for _stepping in (math.floor, math.ceil, np.floor, np.ceil, np.rint, np.sign):
    _teach_steps(_stepping)


def _pow_number(p: Any, q: Any) -> Any:
    # powers 0 and 1 have no slope, or a constant one, also where p = 0
    slope = q * p.x ** (q - 1.0) if q != 0.0 else 0.0
    bend = q * (q - 1.0) * p.x ** (q - 2.0) if q != 0.0 and q != 1.0 else 0.0
    return composed(p, p.x**q, slope, bend)


def _pow_jet(p: Any, q: Any) -> Any:
    return np.exp(q * np.log(p))


def _pow_typed(p: Any, q: Any) -> Any:
    if isinstance(p, JetType) and isinstance(q, types.Number):
        return _pow_number
    return _pow_jet if isinstance(q, JetType) and isinstance(p, JetType | types.Number) else None


for _power in (operator.pow, operator.ipow, builtins.pow, math.pow):
    overload(_power)(_pow_typed)


def _hypot(p: Any, q: Any) -> Any:
    return np.sqrt(p * p + q * q)


def _atan2(p: Any, q: Any) -> Any:
    # p/q and q/p have the same slopes as the angle but for its value: the smaller of the two is the one without a pole
    if abs(value_of(q)) >= abs(value_of(p)):
        angle = np.arctan(p / q)
    else:
        angle = -np.arctan(q / p)
    return angle + (math.atan2(value_of(p), value_of(q)) - value_of(angle))


def _of_pair(rule: Callable[[Any, Any], Any]) -> Callable[[Any, Any], Any]:
    def typed(p: Any, q: Any) -> Any:
        both = all(isinstance(kind, JetType | types.Number) for kind in (p, q))
        return rule if both and (isinstance(p, JetType) or isinstance(q, JetType)) else None

    return typed


for _known, _rule2 in (
    (math.hypot, _hypot), (np.hypot, _hypot), (math.atan2, _atan2), (np.arctan2, _atan2),
):  # fmt: skip
    overload(_known)(_of_pair(_rule2))
