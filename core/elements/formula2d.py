"""Scalar functions of markers from a formula of their points and directions: derivatives by jets, no index arithmetic.

A formula is a Python function of frames and numbers, `def formula(a, b, length)`. Its arguments are the fields (or
properties) of the record it belongs to, by name: a `Marker2D` arrives as a `Frame2D`, a number as itself.
"""

import inspect
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from types import MappingProxyType
from typing import Any, NamedTuple

from ..compiled.jit import inlined
from ..compiled.library import LIBRARY, known_as
from ..compiled.needed import compile_errors, numba_module
from ..errors import ModelError
from ..model.base import Record
from ..model.markers import Marker2D
from .base import Form, Numbering

MARKER_COLUMNS = 5
"""Of each marker in the table of parameters: point (2), angle, its cosine and sine."""
FormKey = tuple[str, tuple[Callable[..., Any], ...]]
"""Kind of a kernel, and the formulas that it is made of."""
NO_NUMBERS: Mapping[str, float] = MappingProxyType({})


class Frame2D(NamedTuple):
    """A marker in space, as formulas see it."""

    x: float
    """Its point, m."""
    y: float
    angle: float
    """Of its first axis, rad; it counts turns."""
    ex: float
    """Its first axis, a unit vector; the second one is (-ey, ex)."""
    ey: float


def plain_function(function: Callable[..., Any]) -> Callable[..., Any]:
    """The Python function of a numba function, or the function as it is. Raises ModelError for what is none."""
    plain = getattr(function, "py_func", function)
    if not inspect.isfunction(plain):
        raise ModelError(
            f"{function!r} is no formula: a Python function (or a numba one) of markers and numbers is needed"
        )
    return plain


def argument_names(function: Callable[..., Any]) -> tuple[str, ...]:
    """Names of a formula's arguments."""
    return tuple(inspect.signature(function).parameters)


@dataclass(frozen=True)
class Arguments:
    """What formulas take from their record: names of markers and of numbers, in the order of the tables."""

    markers: tuple[str, ...]
    numbers: tuple[str, ...]

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return 3 * len(self.markers)

    @classmethod
    def of(cls, record: Record, names: Sequence[str], numbers: Mapping[str, float] = NO_NUMBERS) -> "Arguments":
        """Those of a record with the formula arguments `names`; `numbers` are known besides its fields.

        Raises
        ------
        ModelError : for a name that the record does not have.
        """
        names = tuple(dict.fromkeys(names))
        for name in names:
            if name not in numbers and not hasattr(record, name):
                known = [field for field in type(record).model_fields if field not in ("name", "type")]
                raise ModelError(
                    f"a formula of {type(record).__name__} has an argument '{name}', which is none of its fields "
                    f"{known}: name the arguments of a formula as the fields, or define a property of this name"
                )
        markers = tuple(n for n in names if n not in numbers and isinstance(getattr(record, n), Marker2D))
        if not markers:
            raise ModelError(
                f"the formula of {type(record).__name__} has no argument that is a Marker2D (its arguments are "
                f"{list(names)}): without a marker it depends on nothing that moves"
            )
        return cls(markers, tuple(n for n in names if n not in markers))

    def marked(self, record: Record) -> tuple[Marker2D, ...]:
        """The record's markers."""
        return tuple(getattr(record, name) for name in self.markers)

    def columns(self, record: Record, numbers: Mapping[str, float] = NO_NUMBERS) -> tuple[float, ...]:
        """The record's parameters in the table: markers, then numbers. Raises ModelError for what is no number."""
        found: list[float] = []
        for marker in self.marked(record):
            found += [*marker.point, marker.angle, math.cos(marker.angle), math.sin(marker.angle)]
        for name in self.numbers:
            value = numbers[name] if name in numbers else getattr(record, name)
            if not isinstance(value, bool | int | float):
                raise ModelError(
                    f"{type(record).__name__}.{name} = {value!r} is no number to call its formula with: give it a "
                    "number, or the formula another argument"
                )
            found.append(float(value))
        return tuple(found)

    def coordinates(self, record: Record, numbering: Numbering) -> tuple[int, ...]:
        """Indices of (x, y, theta) of the markers' bodies."""
        return tuple(i for marker in self.marked(record) for i in numbering.coordinates(marker.body))


@cache
def _placing(count: int, k: int) -> Any:
    """(intrinsic, type of its result) that makes the frame of marker k of `count`."""
    # numba learns the type of jets here and not before: not everyone differentiates
    from numba import types
    from numba.extending import intrinsic

    from ..compiled.jets import JetType, Parts, made_of

    size, x, y, t = 3 * count, 3 * k, 3 * k + 1, 3 * k + 2
    turned = {(t, t)}
    kinds = (
        JetType(size, (x, t), turned), JetType(size, (y, t), turned), JetType(size, (t,)),
        JetType(size, (t,), turned), JetType(size, (t,), turned),
    )  # fmt: skip
    result = types.BaseTuple.from_types(kinds, Frame2D)

    @intrinsic
    def place(
        typing_context: Any,
        x0: Any,
        y0: Any,
        theta: Any,
        c: Any,
        s: Any,
        ux: Any,
        uy: Any,
        angle: Any,
        ca: Any,
        sa: Any,
    ) -> Any:
        def codegen(context: Any, b: Any, sig: Any, args: Any) -> Any:
            x0, y0, theta, c, s, ux, uy, angle, ca, sa = args
            one = context.get_constant(types.float64, 1.0)
            rx, ry = b.fsub(b.fmul(c, ux), b.fmul(s, uy)), b.fadd(b.fmul(s, ux), b.fmul(c, uy))
            ex, ey = b.fsub(b.fmul(c, ca), b.fmul(s, sa)), b.fadd(b.fmul(s, ca), b.fmul(c, sa))
            parts = (
                Parts(b.fadd(x0, rx), {x: one, t: b.fneg(ry)}, {(t, t): b.fneg(rx)}),
                Parts(b.fadd(y0, ry), {y: one, t: rx}, {(t, t): b.fneg(ry)}),
                Parts(b.fadd(theta, angle), {t: one}, {}),
                Parts(ex, {t: b.fneg(ey)}, {(t, t): b.fneg(ex)}),
                Parts(ey, {t: ex}, {(t, t): b.fneg(ey)}),
            )
            jets = [made_of(context, b, kind, part) for kind, part in zip(kinds, parts, strict=True)]
            return context.make_tuple(b, result, jets)

        return result(*(types.float64,) * 10), codegen

    return place, result


@cache
def _function(formula: Callable[..., Any]) -> Any:
    numba_module()
    from ..compiled.formula_code import formula_internal

    return formula_internal(formula, (formula,))


@cache
def derivatives(formula: Callable[..., Any], arguments: Arguments) -> Any:
    """JetType of what a formula returns: which derivatives it has.

    Raises
    ------
    ModelError : if it cannot be compiled, or depends on no coordinate.
    """
    numba_module()
    from numba import types

    from ..compiled import jet_functions  # noqa: F401, the functions of math learn jets
    from ..compiled.jets import JetType

    count = len(arguments.markers)
    kinds = {name: _placing(count, k)[1] for k, name in enumerate(arguments.markers)}
    signature = tuple(kinds.get(name, types.float64) for name in argument_names(formula))
    function = _function(formula)
    try:
        function.compile(signature)
    except compile_errors() as error:
        # numba goes on with where it was when it failed: only its first paragraphs say what is wrong
        cause = str(error).split("\n\nDuring:")[0]
        raise ModelError(
            f"the formula {formula.__qualname__} is not usable: {cause}\nA formula is arithmetic of its markers' x, y, "
            "angle, ex, ey and of numbers, with comparisons, abs, min, max and the functions of math"
        ) from error
    (found,) = [s.return_type for s in function.nopython_signatures if s.args == signature]
    if not isinstance(found, JetType) or not found.first:
        raise ModelError(
            f"the formula {formula.__qualname__} returns {found}, which does not depend on where its markers are: "
            "return a number that is computed from their x, y, angle, ex or ey"
        )
    return found


def form_name(kind: str, formulas: Sequence[Callable[..., Any]], arguments: Arguments) -> str:
    """What the library of machine code calls the kernel of such formulas."""
    names = "+".join(f"{known_as(formula.__module__)}.{formula.__qualname__}" for formula in formulas)
    return f"{kind}:{names}:{','.join(arguments.markers)};{','.join(arguments.numbers)}"


@cache
def form_ahead(kind: str, formulas: tuple[Callable[..., Any], ...], arguments: Arguments) -> Form | None:
    """Kernel and patterns of formulas of the package itself, from the library of machine code; None without it."""
    name = form_name(kind, formulas, arguments)
    found = None if LIBRARY is None else LIBRARY.forms.get(name)
    if found is None:
        return None
    from ..compiled.prebuilt import Prebuilt

    tangent, jacobian = (tuple((i, j) for i, j in found[pattern]) for pattern in ("tangent", "jacobian"))
    return Form(Prebuilt(formulas[0], "internal", name), found["rows"], tangent, jacobian)


def caller_of(formula: Callable[..., Any], arguments: Arguments, first: int) -> Any:
    """Numba function call(q, coord, par) -> jet of an element with its coordinates and parameters, the columns of
    `arguments` beginning at `first`."""
    count, lines = len(arguments.markers), []
    names: dict[str, Any] = {"formula": _function(formula), "turned": _turned}
    for k, name in enumerate(arguments.markers):
        names[f"place{k}"] = _placing(count, k)[0]
        columns = ", ".join(f"par[{first + MARKER_COLUMNS * k + i}]" for i in range(MARKER_COLUMNS))
        lines.append(f"c, s = turned(q[coord[{3 * k + 2}]])")
        where = f"q[coord[{3 * k}]], q[coord[{3 * k + 1}]], q[coord[{3 * k + 2}]], c, s"
        lines.append(f"_{name} = place{k}({where}, {columns})")
    begin = first + MARKER_COLUMNS * count
    given = [
        f"_{name}" if name in arguments.markers else f"par[{begin + arguments.numbers.index(name)}]"
        for name in argument_names(formula)
    ]
    body = "\n    ".join([*lines, f"return formula({', '.join(given)})"])
    exec(f"def call(q, coord, par):\n    {body}\n", names)
    from numba import njit

    return njit(error_model="numpy", forceinline=True)(names["call"])


@inlined
def _turned(theta: float) -> Any:
    return math.cos(theta), math.sin(theta)
