"""Starts without Python, held against those with it."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import SimulationError, TlismniError
from ..multibody_model import Model
from .errors import NativeError
from .in_process import NativeModel, NativeRun
from .parameters import Parameter, Setting
from .together import compatible, values_at_once

SHARES = 0.1, 0.02, 0.003
"""Of the values: so far from the present ones all are tried at once, the first of these with which runs begin."""
ALIKE = 1e-7, 1e-9
"""Of a channel, and of the largest: where words are exact to rounding only, the accelerations at the start differ
by less."""


def prove_beginning(sim: Any, native: NativeModel) -> None:
    """A run that begins anew at the time of the image starts with the bits of `sim`. Raises NativeError if not."""
    run = NativeRun(native)
    try:
        run.start_at(sim.t)
        found = run.look()
    except SimulationError as error:
        raise NativeError(f"a run without Python does not begin: {error}") from error
    if found.tobytes() != sim.values().tobytes():
        raise NativeError("a run that begins without Python starts otherwise than with it: please report this model")


def as_far_as_it_begins(
    native: NativeModel, number: int, p: Parameter, starts: Mapping[float, NDArray[np.float64]]
) -> Parameter:
    """The parameter between the values with which a run begins as in Python, of those in `starts`, which has
    Python's channels. Raises NativeError if there are none."""
    least = largest = p.value
    why = "no other value was tried"
    for side in (1.0, -1.0):
        for x in sorted((x for x in starts if side * (x - p.value) > 0.0), key=lambda x: side * x):
            if not p.least <= x <= p.largest:
                break
            why = _differs(native, number, p, x, starts[x])
            if why:
                break
            least, largest = min(least, x), max(largest, x)
    # series reach less far than the values that were tried
    if least == largest:
        raise NativeError(f"a run does not begin without Python with another value: {why}")
    return p._replace(least=least, largest=largest)


def prove_together(
    native: NativeModel, found: Sequence[Parameter], settings: Mapping[str, Setting], begun: Callable[[Model], Any]
) -> None:
    """Runs with other values of all parameters at once that may have them begin as in Python. Raises NativeError."""
    several = compatible(found)
    if len(several) < 2:
        return
    numbers = {p.name: k for k, p in enumerate(found)}
    for share in SHARES:
        values = values_at_once(several, share)
        try:
            wanted = begun(settings[several[0].name].with_values(values)).values()
        except TlismniError:
            continue
        run = NativeRun(native)
        try:
            for name, value in values.items():
                run.set_parameter(numbers[name], value)
            found_values = run.look()
        except SimulationError as error:
            raise NativeError(f"a run without Python does not begin with {values}: {error}") from error
        if not alike(found_values, wanted):
            raise NativeError(f"the start with {values} is another one than in Python: please report this model")
        return


def alike(found: NDArray[np.float64], wanted: NDArray[np.float64]) -> bool:
    """Whether channels are the same but for what rounding makes."""
    share, most = ALIKE
    size = np.max(np.abs(wanted), initial=0.0)
    return bool(np.all(np.abs(found - wanted) <= share * np.abs(wanted) + most * size))


def _differs(native: NativeModel, number: int, p: Parameter, x: float, wanted: NDArray[np.float64]) -> str:
    """Why a run with the value `x` is not one that begins as in Python; empty if it is."""
    run = NativeRun(native)
    try:
        run.set_parameter(number, x)
        found = run.look()
    except SimulationError as error:
        return str(error)
    if p.exact:
        return "" if found.tobytes() == wanted.tobytes() else f"the start with {x!r} has other bits than in Python"
    return "" if alike(found, wanted) else f"the start with {x!r} is another one than in Python"
