"""Which words of a run's memory follow from a parameter, and how."""

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import TlismniError
from ..multibody_model import Model
from .errors import NativeError
from .forms import Form, form_of, is_sure, near_form, nodes_of, series_form
from .parameters import ABOUT, Parameter, Setting, Tried, Word
from .reach import held_by, holds_reals, reached, without_parts
from .trials import Trials, take

MORE, FEWER, AT_ONCE = 60, 8, 6
"""Values that are tried besides: at most, where one operation seems to be all, until its constant is sure, so many at
once; and elsewhere, as what a series is held against."""
SPANS = (4.0, 2.0, 1.2)
"""Times the present value: how far series reach."""


def parameter_of(memory: "Memory", setting: Setting, tried: Tried) -> Parameter:
    """Where the run's memory takes the parameter. Raises NativeError for words that follow in no known way."""
    p, changed, forms = _forms(memory, setting, tried)
    if not changed:
        raise NativeError("nothing in the run follows from it")
    words: list[Word] = []
    left: list[tuple[int, int]] = []
    for (k, offset), values in changed.items():
        form = forms[values.tobytes()]
        if form is None:
            left.append((k, offset))
        else:
            words.append(Word(memory.arrays[k], offset, form))
    least, largest = float(p.min()), float(p.max())
    if left:
        least, largest, others = _series(memory, setting, p, {place: changed[place] for place in left})
        words += others
    return Parameter(setting.name, setting.value, least, largest, tuple(words), tried.starts is not None)


def _forms(
    memory: "Memory", setting: Setting, tried: Tried
) -> tuple[NDArray[Any], dict[tuple[int, int], NDArray[Any]], dict[bytes, Form | None]]:
    """The values that were tried, the words that change, with what they are at each; and the forms of these, by their
    bytes (words of many elements alike are the same): None where there is none but a series."""
    p = np.array([x for x, _ in tried.values])
    copies = memory.copies(model for _, model in tried.values)
    random, left = np.random.default_rng(0), MORE
    while True:
        changed = memory.words(copies)
        rows = {values.tobytes(): values for values in changed.values()}
        exact = {key: form_of(p, values) for key, values in rows.items()}
        simple = all(form is not None for form in exact.values())
        sure = simple and all(is_sure(p, rows[key], form) for key, form in exact.items() if form is not None)
        if sure or left <= 0:
            return p, changed, {key: form or near_form(p, rows[key]) for key, form in exact.items()}
        more = _between(setting, tried.values, AT_ONCE if simple else FEWER, random)
        left = left - AT_ONCE if simple else 0
        copies += memory.copies(model for _, model in more)
        p = np.array([*p, *(x for x, _ in more)])


class Memory:
    """All arrays of numbers that a run reaches, and what they are with other models."""

    def __init__(self, sim: Any, trials: Trials) -> None:
        self.sim, self.trials, first = sim, trials, (sim.crossing._record.table, sim.beginning.record.table)
        self.arrays = reached(first, without_parts(list(held_by(sim)))).arrays
        self.before = [x.tobytes() for x in self.arrays]

    def copies(self, models: Iterable[Model]) -> list[dict[int, bytes]]:
        """Of each model the arrays that it changes, by number. Raises NativeError if numbers that were taken back are
        not what they were."""
        model, before = self.sim.system, self.before
        found: list[dict[int, bytes]] = []
        try:
            for variant in models:
                take(self.sim, variant, self.trials.assembly(variant))
                now = ((k, x.tobytes()) for k, x in enumerate(self.arrays))
                found.append({k: content for k, content in now if content != before[k]})
        finally:
            take(self.sim, model, self.trials.assembly(model))
        if [x.tobytes() for x in self.arrays] != before:
            raise NativeError("numbers of the model that were taken back are not what they were")
        return found

    def words(self, copies: Sequence[dict[int, bytes]]) -> dict[tuple[int, int], NDArray[Any]]:
        """The words that models change: number of the array and byte in it, with what they are with each of them.
        Raises NativeError if more than real numbers change."""
        before = self.before
        changed: dict[tuple[int, int], NDArray[Any]] = {}
        for k in sorted({k for copy in copies for k in copy}):
            if self.arrays[k].dtype.itemsize % 8 or not holds_reals(self.arrays[k]):
                raise NativeError("another value changes more than real numbers")
            rows = np.array([np.frombuffer(copy.get(k, before[k]), dtype=np.int64) for copy in copies])
            for at in np.flatnonzero((rows != rows[0]).any(axis=0)).tolist():
                changed[k, 8 * at] = rows[:, at].copy().view(np.float64)
        return changed


def _series(
    memory: Memory, setting: Setting, p: NDArray[Any], places: dict[tuple[int, int], NDArray[Any]]
) -> tuple[float, float, list[Word]]:
    """Series for the words at these places, and the values between which they hold: as many as may be."""
    why = "the model cannot be built with values near it"
    for factor in SPANS:
        least, largest = span_of(setting, float(p.min()), float(p.max()), factor)
        at = nodes_of(least, largest)
        try:
            models = [setting.model(float(x)) for x in at]
        except TlismniError as error:
            why = str(error)
            continue
        changed = memory.words(memory.copies(models))
        inside = (p >= least) & (p <= largest)
        words = []
        known: dict[bytes, Form | None] = {}
        for place, values in places.items():
            rows = changed.get(place, np.full(len(at), values[p == setting.value][0]))
            key = rows.tobytes() + values.tobytes()
            if key not in known:
                known[key] = series_form(rows, least, largest, p[inside], values[inside])
            form = known[key]
            if form is None:
                break
            words.append(Word(memory.arrays[place[0]], place[1], form))
        if len(words) == len(places):
            return least, largest, words
        why = "a number of the run follows from it by more than one operation, and not smoothly"
    raise NativeError(why)


def span_of(setting: Setting, least: float, largest: float, factor: float) -> tuple[float, float]:
    """Values around the present one: up to `factor` times as large or small, of a value of 0 to that part of 1."""
    x = setting.value
    low, high = sorted((x / factor, x * factor)) if x else (-ABOUT[-1] / 10.0 * factor, ABOUT[-1] / 10.0 * factor)
    return max(least, low), min(largest, high)


def _between(
    setting: Setting, good: Sequence[tuple[float, Model]], count: int, random: np.random.Generator
) -> list[tuple[float, Model]]:
    """More values between those: neighbouring constants of a form give other bits for some of many only. Half of them
    near the present value."""
    found = []
    least, largest = good[0][0], good[-1][0]
    near = span_of(setting, least, largest, 2.0)
    for x in (*random.uniform(least, largest, count // 2), *random.uniform(*near, count // 2)):
        try:
            found.append((float(x), setting.model(float(x))))
        except TlismniError:
            continue
    return found
