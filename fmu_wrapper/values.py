"""The values of all variables of a slave: one vector for each kind."""

import json
import math
from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
import numpy.typing as npt

from ..core.model.signals import MOST_DERIVATIVES
from .errors import FmuValueError
from .settings import check_solver_value
from .variables import KINDS, Kind, Plan, Variable, VariableTable

DTYPES: dict[Kind, str] = {"real": "<f8", "integer": "<i4", "boolean": "|b1", "string": "object"}
NUMERIC: tuple[Kind, ...] = ("real", "integer", "boolean")
INT32 = range(-(2**31), 2**31)


class Values:
    """Values of the variables of `table`, at their start values; outputs start as 0.

    Attributes
    ----------
    vectors : values by kind; `inputs` are the positions of the inputs among the reals.
    slopes : (inputs, MOST_DERIVATIVES) time derivatives with which the inputs go on.
    slope_times : (inputs,) when these were set, s.
    sloped : whether any input has derivatives.
    """

    def __init__(self, table: VariableTable) -> None:
        self.table = table
        self.vectors: dict[Kind, npt.NDArray[Any]] = {}
        for kind in KINDS:
            variables = table.of_kind[kind]
            vector = np.zeros(len(variables), dtype=DTYPES[kind])
            for i, variable in enumerate(variables):
                vector[i] = ("" if kind == "string" else 0) if variable.start is None else variable.start
            self.vectors[kind] = vector
        inputs = table.block("input")
        self.inputs = np.array([table.position[v.reference] for v in inputs], dtype=np.intp)
        self.slopes = np.zeros((len(inputs), MOST_DERIVATIVES))
        self.slope_times = np.full(len(inputs), -np.inf)
        self.sloped = False

    def __getitem__(self, variable: Variable) -> Any:
        value = self.vectors[variable.kind][self.table.position[variable.reference]]
        return value if variable.kind == "string" else value.item()

    def __setitem__(self, variable: Variable, value: Any) -> None:
        self.vectors[variable.kind][self.table.position[variable.reference]] = value

    def copy(self) -> "Values":
        """An independent copy."""
        twin = object.__new__(Values)
        twin.table = self.table
        twin.vectors = {kind: vector.copy() for kind, vector in self.vectors.items()}
        twin.inputs, twin.slopes, twin.slope_times = self.inputs, self.slopes.copy(), self.slope_times.copy()
        twin.sloped = self.sloped
        return twin

    def forget_outputs(self) -> None:
        """Outputs start as 0 again: they follow from the rest."""
        for kind in NUMERIC:
            self.vectors[kind][self.table.outputs[kind]] = 0

    @property
    def courses(self) -> list[list[float]]:
        """The values of the inputs, and their first and second derivatives if any input has derivatives."""
        levels: list[list[float]] = [self.vectors["real"].take(self.inputs).tolist()]
        return levels + self.slopes.T.tolist() if self.sloped else levels

    def set_slopes(self, rows: Sequence[int], orders: Sequence[int], slopes: Sequence[float], now: float) -> None:
        """Give the inputs with these numbers derivatives of these orders at time `now`, s; other orders that were set
        before end."""
        given = np.asarray(rows, dtype=np.intp)
        self.slopes[given[self.slope_times[given] != now]] = 0.0
        self.slopes[rows, np.asarray(orders, dtype=np.intp) - 1] = slopes
        self.slope_times[rows] = now
        self.sloped = bool(self.slopes.any())

    def go_on(self, duration: float) -> bool:
        """Let the inputs follow their derivatives for `duration`, s. False if there is none with derivatives."""
        if not self.sloped:
            return False
        first, second = self.slopes.T
        self.vectors["real"][self.inputs] += duration * (first + 0.5 * duration * second)
        first += duration * second
        return True

    def end_slopes(self, positions: npt.NDArray[np.intp], now: float) -> None:
        """Forget the derivatives of the inputs among the reals at `positions`, unless they were set at this time."""
        self.slopes[np.isin(self.inputs, positions) & (self.slope_times != now)] = 0.0
        self.sloped = bool(self.slopes.any())

    def to_bytes(self) -> bytes:
        """The values bit for bit: reals, integers, booleans, then the strings as JSON."""
        numbers = b"".join(self.vectors[kind].tobytes() for kind in NUMERIC)
        numbers += self.slopes.tobytes() + self.slope_times.tobytes()
        return numbers + json.dumps(list(self.vectors["string"])).encode()

    @classmethod
    def from_bytes(cls, table: VariableTable, data: bytes) -> "Values":
        """The values in bytes made by `to_bytes` for the same table.

        Raises
        ------
        FmuValueError : if they are not, or a variable could not have been set to its value.
        """
        values = cls(table)
        least = sum(vector.nbytes for kind, vector in values.vectors.items() if kind != "string")
        least += values.slopes.nbytes + values.slope_times.nbytes
        if len(data) < least:
            raise FmuValueError(f"the values take {len(data)} bytes, at least {least} are needed")
        offset = 0
        for kind in NUMERIC:
            count = len(table.of_kind[kind])
            stored = DTYPES[kind] if kind != "boolean" else "u1"  # a byte that is neither 0 nor 1 is no boolean
            vector = np.frombuffer(data, stored, count, offset)
            if kind == "boolean" and vector.max(initial=0) > 1:
                raise FmuValueError(f"the booleans are {vector.tolist()}, not 0 or 1")
            values.vectors[kind] = vector.astype(DTYPES[kind])
            offset += vector.nbytes
        for part in (values.slopes, values.slope_times):
            part[...] = np.frombuffer(data, "<f8", part.size, offset).reshape(part.shape)
            offset += part.nbytes
        if not np.isfinite(values.slopes).all() or np.isnan(values.slope_times).any():
            raise FmuValueError("the derivatives of the inputs are not finite")
        values.sloped = bool(values.slopes.any())
        texts = json.loads(data[offset:])
        if not isinstance(texts, list) or len(texts) != len(table.of_kind["string"]):
            raise FmuValueError(f"{len(table.of_kind['string'])} strings are needed, not {texts!r}")
        values.vectors["string"][:] = texts
        values._check()
        return values

    def _check(self) -> None:
        """Refuse what no variable could have been set to, and constants of another value, with FmuValueError."""
        for variable in self.table.variables:
            value = self[variable]
            if variable.role in ("parameter", "input", "independent"):
                check_value(variable, value)
            elif variable.role == "constant" and value != variable.start:
                raise FmuValueError(f"the constant '{variable.name}' is {value!r}, not {variable.start!r}")


def check_value(variable: Variable, value: Any) -> Any:
    """`value` as the variable's Python type.

    Raises
    ------
    FmuValueError : for a wrong type, NaN, infinity, or a value outside the variable's range.
    """
    name = f"'{variable.name}' (value reference {variable.reference})"
    if variable.kind == "string":
        if not isinstance(value, str):
            raise FmuValueError(f"{name} needs a string, not {value!r}")
        return value
    if variable.kind == "boolean":
        if not isinstance(value, bool | np.bool_):
            raise FmuValueError(f"{name} needs True or False, not {value!r}")
        return bool(value)
    if isinstance(value, bool | np.bool_ | str) or not isinstance(value, int | float | np.number):
        raise FmuValueError(f"{name} needs a number, not {value!r}")
    if variable.kind == "integer":
        if int(value) != value or int(value) not in INT32:
            raise FmuValueError(f"{name} needs a whole number of 32 bits, not {value!r}")
        if variable.items and int(value) not in range(len(variable.items)):
            meanings = ", ".join(f"{i} {item}" for i, item in enumerate(variable.items))
            raise FmuValueError(f"{name} was set to {value!r}, which is none of its values: {meanings}")
        if not variable.items:
            _check_limits(variable, name, int(value))
        return int(value)
    number = float(value)
    if not math.isfinite(number):
        raise FmuValueError(f"{name} was set to {number!r}, which is not finite: check what feeds it")
    _check_limits(variable, name, number)
    if variable.block == "solver" and variable.name in ("solver.rtol", "solver.atol", "solver.step"):
        check_solver_value(variable.name.removeprefix("solver."), number)
    return number


def _check_limits(variable: Variable, name: str, number: float) -> None:
    low, high = variable.minimum, variable.maximum
    if (low is not None and number < low) or (high is not None and number > high):
        limits = f"[{'-inf' if low is None else low}, {'inf' if high is None else high}]"
        raise FmuValueError(f"{name} was set to {number!r}, which is outside its range {limits}")


def item_value(variable: Variable, name: str) -> int:
    """The value of an enumeration's item. Raises FmuValueError for a name that it has not."""
    if name not in variable.items:
        text = f"'{variable.name}' (value reference {variable.reference}) has no item '{name}'"
        raise FmuValueError(f"{text}; it has {list(variable.items)}")
    return variable.items.index(name)


def check_values(plan: Plan, values: Iterable[Any]) -> Any:
    """All values checked by `check_value`. Raises FmuValueError if the lengths differ."""
    variables = plan.variables
    if plan.unbounded and isinstance(values, np.ndarray) and values.dtype == np.float64:
        # what comes from C at every step
        numbers = values.tolist()
        if len(numbers) == len(variables) and all(map(math.isfinite, numbers)):
            return numbers
    given = values.tolist() if isinstance(values, np.ndarray) else list(values)
    if len(given) != len(variables):
        raise FmuValueError(f"{len(given)} values were given for {len(variables)} value references")
    return [check_value(variable, value) for variable, value in zip(variables, given, strict=True)]
