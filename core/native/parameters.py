"""Parameters of an image: what a run's memory takes from them, and for which values.

Nobody lists where a parameter goes. The model is built with other values of it, the run's memory takes the numbers of
each, and the words that change are those that follow from it (`forms.py`). A parameter is one of the image if all of
them do, and if a run with the other value starts with no other difference: then setting these words is all that there
is to do, and gives the run of the model with that value, bit for bit.
"""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..description import Model
from ..errors import TlismniError
from ..run.blueprint import take_numbers, what_differs
from .errors import NativeError
from .forms import Form, form_of
from .reach import begin_of, content, held_by, holds_reals, reached, without_parts
from .scratch import scratch_of

PARTS = (1.0, 1.0 + 2.0**-10, 0.9, 1.137, 0.7311, 1.5, 0.5, 2.0, 0.2, 5.0, 0.1, 10.0, 0.01, 100.0)
"""Of the present value: other values that are tried, near ones first; and ABOUT of one that is 0."""
ABOUT = (0.0, 1e-3, 0.1, 0.37, 1.0, 3.0)
MORE = 60
INSIDE = (0.25, 0.5, 0.618, 0.75, 0.875)
"""Parts of the way between two limits that are tried too."""


class Setting(NamedTuple):
    """A number of a model that shall be a parameter: its value, its limits, the model with another one."""

    name: str
    value: float
    least: float
    largest: float
    model: Callable[[float], Model]


class Word(NamedTuple):
    """A word that follows from a parameter: number of bytes behind the beginning of `array`."""

    array: NDArray[Any]
    offset: int
    form: Form


class Parameter(NamedTuple):
    """A parameter of an image; `least` and `largest` are within the limits and were tried."""

    name: str
    value: float
    least: float
    largest: float
    words: tuple[Word, ...]


def settings_of(model: Model, names: Iterable[str] | None = None) -> list[Setting]:
    """The parameters of a model; `names`: these, or places of numbers ("ball.mass"), see `Model.with_parameters`."""
    own = {p.name: p for p in model.parameters}

    def setting(name: str) -> Setting:
        p = own.get(name)
        least, largest = (None, None) if p is None else (p.minimum, p.maximum)
        value = float(model._value_at(name) if "." in name and p is None else model.parameter_value(name))
        return Setting(
            name, value, -math.inf if least is None else least, math.inf if largest is None else largest,
            lambda x: model.with_parameters({name: x}),
        )  # fmt: skip

    return [setting(name) for name in (own if names is None else names)]


def tried(setting: Setting) -> list[float]:
    """Values to try, the present one first, near ones before far ones."""
    values = [part * setting.value for part in PARTS] if setting.value else [s * x for x in ABOUT for s in (1.0, -1.0)]
    if math.isfinite(setting.least) and math.isfinite(setting.largest):
        values += [setting.least + part * (setting.largest - setting.least) for part in INSIDE]
    values += [x for x in (setting.least, setting.largest) if math.isfinite(x)]
    return [x for x in dict.fromkeys(values) if setting.least <= x <= setting.largest]


def variants(setting: Setting) -> list[tuple[float, Model]]:
    """The models that the values make, without those that are refused."""
    found = []
    for x in tried(setting):
        try:
            found.append((x, setting.model(x)))
        except TlismniError:
            continue
    return found


def take(sim: Any, model: Model) -> None:
    """Let a run take the numbers of another model. Raises NativeError if more than numbers differ."""
    assembly = model.assemble()
    if differs := what_differs(sim.assembly, assembly):
        raise NativeError(f"another value changes more than numbers ({differs})")
    take_numbers(sim, model, assembly)


def startable(sim: Any, setting: Setting, begun: Callable[[Model], Any]) -> list[tuple[float, Model]]:
    """The values, with the models of them, with which a run starts as `sim` does but for the words that follow from
    them: the present value and those around it.

    Parameters
    ----------
    sim : a run that has just begun. begun : a run of a model at its start.

    Raises
    ------
    NativeError : if there are none, with the reason.
    """
    model, good = sim.system, [(setting.value, sim.system)]
    low, high, why = -math.inf, math.inf, "all other values that were tried are refused by the model"
    for x, variant in variants(setting):
        if x == setting.value or not low < x < high:
            continue
        try:
            other = begun(variant)
            take(sim, variant)
            fits = _content(other) == _content(sim)
            why = "the start follows from it: accelerations, scales and tolerances are those of the export"
        except NativeError as error:
            fits, why = False, str(error)
        except TlismniError as error:
            fits, why = False, f"a run does not start with {x!r}: {error}"
        finally:
            take(sim, model)
        if fits:
            good.append((x, variant))
        elif x < setting.value:
            low = x
        else:
            high = x
        if len(good) == 1 and math.isfinite(low) and math.isfinite(high):
            break
    if len(good) == 1:
        raise NativeError(why)
    return sorted(good, key=lambda pair: pair[0])


def parameter_of(sim: Any, setting: Setting, good: Sequence[tuple[float, Model]]) -> Parameter:
    """Where the run's memory takes the parameter. Raises NativeError for words that follow in no known way."""
    model, arrays, good = sim.system, _memory(sim), [*good, *_between(setting, good)]
    before = [x.tobytes() for x in arrays]
    changed: dict[tuple[int, int], list[float]] = {}
    copies = []
    for _, variant in good:
        take(sim, variant)
        copies.append([x.tobytes() for x in arrays])
    take(sim, model)
    if [x.tobytes() for x in arrays] != before:
        raise NativeError("numbers of the model that were taken back are not what they were")
    for k, old in enumerate(before):
        if any(copy[k] != old for copy in copies):
            if arrays[k].dtype.itemsize % 8 or not holds_reals(arrays[k]):
                raise NativeError("another value changes more than real numbers")
            rows = np.array([np.frombuffer(copy[k], dtype=np.int64) for copy in copies])
            for at in np.flatnonzero((rows != rows[0]).any(axis=0)).tolist():
                changed[k, 8 * at] = rows[:, at].view(np.float64).tolist()
    if not changed:
        raise NativeError("nothing in the run follows from it")
    p = np.array([x for x, _ in good])
    words: list[Word] = []
    for (k, offset), values in changed.items():
        form = form_of(p, np.array(values))
        if form is None:
            raise NativeError("a number of the run follows from it by more than one operation")
        words.append(Word(arrays[k], offset, form))
    return Parameter(setting.name, setting.value, float(p.min()), float(p.max()), tuple(words))


def _between(setting: Setting, good: Sequence[tuple[float, Model]]) -> list[tuple[float, Model]]:
    """More values between those: neighbouring constants of a form give other bits for some of many only."""
    drawn = np.random.default_rng(0).uniform(good[0][0], good[-1][0], MORE)
    return [(float(x), setting.model(float(x))) for x in drawn]


def _content(sim: Any) -> list[bytes]:
    """All that decides a run, wherever it is in memory."""
    first = sim.crossing._record.table  # made when it is first asked for
    arrays = list(held_by(sim))
    empty = frozenset(begin_of(x) for x in arrays if not x.nbytes)
    start = [np.array([sim.t, sim.table.initial_energy]).tobytes()]
    return start + content(first, without_parts(arrays), without_parts(scratch_of(sim)), empty)


def _memory(sim: Any) -> list[NDArray[Any]]:
    """All arrays of numbers that a run reaches."""
    first = sim.crossing._record.table
    return reached(first, without_parts(list(held_by(sim)))).arrays


def apart(found: Iterable[Parameter]) -> tuple[list[Parameter], dict[str, str]]:
    """The parameters that share no word with one before; why the others do not count, by name."""
    kept: list[Parameter] = []
    owner: dict[tuple[int, int], str] = {}
    refused = {}
    for p in found:
        places = [(begin_of(word.array), word.offset) for word in p.words]
        shared = {owner[place] for place in places if place in owner}
        if shared:
            refused[p.name] = f"a number of the run follows from '{sorted(shared)[0]}' too"
        else:
            kept.append(p)
            owner |= dict.fromkeys(places, p.name)
    return kept, refused
