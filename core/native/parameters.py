"""Parameters of an image: what a run's memory takes from them, and for which values.

Nobody lists where a parameter goes. The model is built with other values of it, the run's memory takes the numbers of
each, and the words that change are those that follow from it (`forms.py`). Where a run with the other value starts with
no other difference, setting these words is all that there is to do. Where more follows (masses, lengths, what the start
is), the run begins anew from these words (`simulation/begin_now.py`). Either gives the run of the model with that
value, bit for bit if all words have a form that is exact.
"""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..errors import TlismniError
from ..multibody_model import Model
from .errors import NativeError
from .forms import Form
from .reach import begin_of
from .trials import Trials

BY_ONE, BY_PRODUCT, BY_SUM = range(3)
"""A word follows from one parameter; from several, as a product or as a sum of what each makes of it."""
PARTS = (1.0, 1.0 + 2.0**-10, 0.9, 1.137, 0.7311, 1.5, 0.5, 2.0, 0.2, 5.0, 0.1, 10.0, 0.01, 100.0)
"""Of the present value: other values that are tried, near ones first; and ABOUT of one that is 0."""
ABOUT = (0.0, 1e-3, 0.1, 0.37, 1.0, 3.0)
INSIDE = (0.25, 0.5, 0.618, 0.75, 0.875)
"""Parts of the way between two limits that are tried too."""


class Setting(NamedTuple):
    """A number of a model that shall be a parameter: its value, its limits, and the model with other values of it, and
    of others by name."""

    name: str
    value: float
    least: float
    largest: float
    with_values: Callable[[Mapping[str, float]], Model]

    def model(self, value: float) -> Model:
        """The model with another value."""
        return self.with_values({self.name: value})


class Word(NamedTuple):
    """A word that follows from a parameter: number of bytes behind the beginning of `array`. `mode`: how it follows
    from others too (`together.py`)."""

    array: NDArray[Any]
    offset: int
    form: Form
    mode: int = BY_ONE

    @property
    def place(self) -> tuple[int, int]:
        """What no other word has."""
        return begin_of(self.array), self.offset


class Parameter(NamedTuple):
    """A parameter of an image; `least` and `largest` are within the limits and were tried. `begins`: the start follows
    from it."""

    name: str
    value: float
    least: float
    largest: float
    words: tuple[Word, ...]
    begins: bool = False
    excludes: frozenset[str] = frozenset()
    """Parameters that have the value of the image where this one has another."""

    @property
    def exact(self) -> bool:
        """Whether a run with another value has the bits of the model with that value."""
        return all(word.form.exact for word in self.words)


class Tried(NamedTuple):
    """Values of a parameter with which runs start, with their models, and the channels at these starts if they follow
    from it."""

    values: list[tuple[float, Model]]
    starts: dict[float, NDArray[np.float64]] | None


def settings_of(model: Model, names: Iterable[str] | None = None) -> list[Setting]:
    """The parameters of a model; `names`: these, or places of numbers ("ball.mass"), see `Model.with_parameters`."""
    own = {p.name: p for p in model.parameters}

    def setting(name: str) -> Setting:
        p = own.get(name)
        least, largest = (None, None) if p is None else (p.minimum, p.maximum)
        value = float(model._value_at(name) if "." in name and p is None else model.parameter_value(name))
        return Setting(
            name, value, -math.inf if least is None else least, math.inf if largest is None else largest,
            lambda values: model.with_parameters(dict(values)),
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


def startable(trials: Trials, setting: Setting, begins: bool) -> Tried:
    """The values, with the models of them, that can be set: the present value and those around it.

    Parameters
    ----------
    begins : runs may begin anew.

    Raises
    ------
    NativeError : if there are none, with the reason.
    """
    models = variants(setting)
    begun: dict[float, Any] = {}
    plain, why = _around(trials, setting, models, begun, False)
    if len(plain) < len(models) and begins:
        wide, why = _around(trials, setting, models, begun, True)
        if len(wide) > len(plain):
            return Tried(wide, {x: begun[x].values() for x, _ in wide if x != setting.value})
    if len(plain) == 1:
        raise NativeError(why)
    return Tried(plain, None)


def _around(
    trials: Trials, setting: Setting, models: Sequence[tuple[float, Model]], begun: dict[float, Any], begins: bool
) -> tuple[list[tuple[float, Model]], str]:
    """Values around the present one with which runs start, and why not others: as the present one but for the words
    that follow from them, or, if it `begins` anew, in any way. `begun` has the runs that there are, and gets others."""
    good = [(setting.value, trials.model)]
    low, high, why = -math.inf, math.inf, "all other values that were tried are refused by the model"
    for x, variant in models:
        if x == setting.value or not low < x < high:
            continue
        try:
            if x not in begun:
                begun[x] = trials.begun(variant)
            fits = begins or trials.follows(begun[x])
            why = "the start follows from it, and runs of this model begin as it was exported only"
        except NativeError as error:
            fits, why = False, str(error)
        except TlismniError as error:
            fits, why = False, f"a run does not start with {x!r}: {error}"
        if fits:
            good.append((x, variant))
        elif x < setting.value:
            low = x
        else:
            high = x
        if len(good) == 1 and math.isfinite(low) and math.isfinite(high):
            break
    return sorted(good, key=lambda pair: pair[0]), why
