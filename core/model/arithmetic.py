"""Arithmetic in model files: "mass * length**2 / 12" with numbers by name. Nothing else can be said in it.

The text is parsed by Python's own parser and walked here, node by node; what is not arithmetic is refused. So a file
with formulas is data still.
"""

import ast
import math
from collections.abc import Callable, Iterable, Mapping
from difflib import get_close_matches
from functools import lru_cache

LONGEST = 500
"""Characters of a formula: beyond that it is no formula that somebody can read."""
MOST_NODES = 200

FUNCTIONS: dict[str, Callable[..., float]] = {
    "sqrt": math.sqrt, "sin": math.sin, "cos": math.cos, "tan": math.tan, "asin": math.asin, "acos": math.acos,
    "atan": math.atan, "atan2": math.atan2, "hypot": math.hypot, "exp": math.exp, "log": math.log, "abs": abs,
    "min": min, "max": max,
}  # fmt: skip
CONSTANTS = {"pi": math.pi}
_BINARY: dict[type[ast.operator], Callable[[float, float], float]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
    ast.Pow: math.pow,
}


def names_in(text: str) -> tuple[str, ...]:
    """The numbers that a formula asks for, in alphabetic order. Raises ValueError if it is none."""
    called = {id(node.func) for node in ast.walk(_parsed(text)) if isinstance(node, ast.Call)}
    named = {n.id for n in ast.walk(_parsed(text)) if isinstance(n, ast.Name) and id(n) not in called}
    return tuple(sorted(named - CONSTANTS.keys()))


def evaluate(text: str, numbers: Mapping[str, float]) -> float:
    """The value of the formula `text`.

    Raises
    ------
    ValueError : if it is no arithmetic, asks for a name that `numbers` lacks, or has no finite value.
    """
    tree = _parsed(text)
    try:
        value = _value(tree.body, numbers, text)
    except (ArithmeticError, TypeError) as error:
        raise ValueError(f"formula '{text}' has no value: {error}") from None
    if not math.isfinite(value):
        raise ValueError(f"formula '{text}' has no finite value: it gives {value}")
    return value


@lru_cache(maxsize=512)
def _parsed(text: str) -> ast.Expression:
    if len(text) > LONGEST:
        raise ValueError(f"formula '{text[:40]}...' has {len(text)} characters: at most {LONGEST} can be read")
    try:
        tree = ast.parse(text.strip(), mode="eval")
    except (SyntaxError, ValueError, RecursionError, MemoryError):
        raise ValueError(f"formula '{text}' is no arithmetic: write it like 'mass * length**2 / 12'") from None
    if sum(1 for _ in ast.walk(tree)) > MOST_NODES:
        raise ValueError(f"formula '{text[:40]}...' is too long: divide it among parameters")
    return tree


def _value(node: ast.expr, numbers: Mapping[str, float], text: str) -> float:
    match node:
        case ast.Constant(value=bool()):
            pass
        case ast.Constant(value=int() | float() as number):
            return float(number)
        case ast.Name(id=name) if name in numbers or name in CONSTANTS:
            return float(numbers[name] if name in numbers else CONSTANTS[name])
        case ast.Name(id=name):
            raise ValueError(f"formula '{text}' asks for '{name}', which is no parameter{near(name, numbers)}")
        case ast.UnaryOp(op=ast.USub(), operand=inner):
            return -_value(inner, numbers, text)
        case ast.UnaryOp(op=ast.UAdd(), operand=inner):
            return _value(inner, numbers, text)
        case ast.BinOp(op=ast.BitXor()):
            raise ValueError(f"formula '{text}': '^' is no arithmetic here: write a power with '**'")
        case ast.BinOp(left=left, op=op, right=right) if type(op) in _BINARY:
            return _BINARY[type(op)](_value(left, numbers, text), _value(right, numbers, text))
        case ast.Call(func=ast.Name(id=name), args=given, keywords=[]) if name in FUNCTIONS:
            values = [_value(each, numbers, text) for each in given]
            try:
                return float(FUNCTIONS[name](*values))
            except ValueError as error:
                raise ArithmeticError(f"{error} in {name}") from None
        case ast.Call(func=ast.Name(id=name)):
            raise ValueError(f"formula '{text}': there is no function '{name}'; there are {sorted(FUNCTIONS)}")
    raise ValueError(
        f"formula '{text}': '{ast.unparse(node)}' is no arithmetic: numbers, parameters, + - * / **, brackets and "
        f"{', '.join(FUNCTIONS)} are"
    )


def near(name: str, known: Iterable[str]) -> str:
    """A near name in words, or all that there are."""
    there = sorted(known)
    close = get_close_matches(name, there, 1)
    return f" (did you mean '{close[0]}'?)" if close else f"; there are {there}"
