"""Inputs of a run: polynomials in time from the moment they are set, and when their next change is to be expected."""

import math
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import TYPE_CHECKING

from ..errors import ModelError
from ..model.signals import MOST_DERIVATIVES
from ..rounding import PUNCTUAL, SAME_INPUT
from . import motions
from .restore import go_to_present, restart_here
from .start import start_again

if TYPE_CHECKING:
    from .simulation import Simulation


def set_inputs(sim: "Simulation", values: Mapping[str, float], derivatives: Mapping[str, Sequence[float]]) -> None:
    """Let inputs take `values` at `sim.t` and go on with `derivatives`; on an error nothing has happened.

    Where that is what an input does already, the run keeps its steps; else it starts anew at `sim.t`, and steps made
    beyond it are dropped.
    """
    wanted = _check(sim.assembly.input_names, values, derivatives)
    rows, t = sim.workspace.arrays["inputs"], sim.t
    changed = {k: new for k, new in wanted.items() if not _goes_on(rows[k].tolist(), new, t)}
    if not changed:
        return
    before, pending, moved = rows.copy(), sim.pending, motions.led_by(sim, changed)
    start = bool(moved) and motions.at_start(sim)
    if not start:
        # the motion up to now is that of the inputs up to now
        go_to_present(sim)
    for k, new in changed.items():
        rows[k] = (*new, t if any(new[1:]) else 0.0)  # since when does not matter to what stays as it is
    motions.lead(sim, moved)
    try:
        if start:
            start_again(sim)
        else:
            restart_here(sim, is_present=True)
    except BaseException:
        rows[:], sim.pending = before, pending
        if start:
            start_again(sim)
        raise
    last, _ = sim.input_times
    if t > last:
        sim.input_times = (t, t - last)


def next_stop(times: tuple[float, float], now: float, target: float) -> float:
    """Where the next step must end on the way from `now` to `target` (s): at the time at which the inputs are expected
    to change, given `times`, the last change and the interval before it. A step that went beyond would be dropped. If
    they did not change as expected, nowhere."""
    expected = times[0] + times[1]
    if not now < expected < math.inf:
        return math.inf
    # they can change at targets only
    return target if expected <= target + PUNCTUAL * times[1] else expected


def _check(
    names: Sequence[str], values: Mapping[str, float], derivatives: Mapping[str, Sequence[float]]
) -> dict[int, tuple[float, ...]]:
    """Value, first and second derivative of each input that is set, by its number."""
    wanted = {}
    for name, value in values.items():
        if name not in names:
            raise ModelError(f"there is no input '{name}'; inputs are {names}")
        given = tuple(derivatives.get(name, ()))
        if len(given) > MOST_DERIVATIVES:
            raise ModelError(f"input '{name}' was given {len(given)} derivatives: at most {MOST_DERIVATIVES} are taken")
        for what, x in (("input", value), *(("derivative of input", d) for d in given)):
            if isinstance(x, bool) or not isinstance(x, Real) or not math.isfinite(x):
                raise ModelError(f"{what} '{name}' = {x!r}: a finite number is needed")
        wanted[names.index(name)] = (float(value), *map(float, given), *(0.0,) * (MOST_DERIVATIVES - len(given)))
    if alone := sorted(set(derivatives) - set(values)):
        raise ModelError(f"derivatives of {alone} were given without values: set both")
    return wanted


def _goes_on(row: Sequence[float], new: tuple[float, ...], t: float) -> bool:
    """True if an input that is the polynomial `row` has the value and the derivatives `new` at time `t`."""
    value, rate, curvature, since = row
    if rate == curvature == 0.0:
        return new == (value, 0.0, 0.0)
    x = t - since
    terms = (
        (value, x * rate, 0.5 * x * x * curvature, rate * t, 0.5 * curvature * t * t),
        (rate, x * curvature, curvature * t),
        (curvature,),
    )
    present = (value + x * (rate + 0.5 * x * curvature), rate + x * curvature, curvature)
    return all(abs(a - b) <= SAME_INPUT * sum(map(abs, parts)) for a, b, parts in zip(new, present, terms, strict=True))
