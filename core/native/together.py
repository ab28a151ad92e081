"""Several parameters of one image: what follows from more than one of them.

A word that two parameters lead is a product or a sum of what each makes of it, to rounding: a mass and a length make
an inertia, two lengths a distance. That is found by trying both at once. Where it is neither, one of the two may have
another value than that of the image, not both.
"""

import logging
from collections.abc import Iterable, Mapping, Sequence
from itertools import combinations

import numpy as np

from ..errors import TlismniError
from .errors import NativeError
from .parameter_dependence import Memory
from .parameters import BY_ONE, BY_PRODUCT, BY_SUM, Parameter, Setting
from .reach import begin_of

logger = logging.getLogger(__name__)

Place = tuple[int, int]
FACTORS = (1.09375, 0.921875, 1.015625, 0.984375)
"""Of the values: both are tried so much away from them, the first ones that the model can be built with."""
SMALL = 1e-3
"""Of the largest: a word that is smaller tells nothing of a product."""
LIKE = 1e-13
"""Relative: what roundings leave of a product or a sum."""


def together(memory: Memory, found: Sequence[Parameter], settings: Mapping[str, Setting]) -> list[Parameter]:
    """The parameters with the modes of the words that they share, and with those that exclude each other."""
    copies = _Copies(memory, settings)
    excluded: set[tuple[int, int]] = set()
    fits: dict[tuple[int, int], dict[Place, tuple[int, ...]]] = {}
    places = [{word.place for word in p.words} for p in found]
    apart = _each_its_own(copies, found)
    copies.prepare(
        {p.name: _near(p, FACTORS[0]), q.name: _near(q, FACTORS[-1])}
        for (i, p), (j, q) in combinations(enumerate(found), 2)
        if not apart or places[i] & places[j]
    )
    for pair in combinations(range(len(found)), 2):
        if apart and not places[pair[0]] & places[pair[1]]:
            fits[pair] = {}
            continue
        modes_of = _modes(copies, found[pair[0]], found[pair[1]])
        if modes_of is None:
            excluded.add(pair)
        else:
            fits[pair] = modes_of
    users: dict[Place, list[int]] = {}
    for k, p in enumerate(found):
        for word in p.words:
            users.setdefault(word.place, []).append(k)
    modes: dict[Place, int] = {}
    for place, who in users.items():
        pairs = [pair for pair in combinations(who, 2) if pair in fits]
        if pairs:
            wrong = {mode: {pair for pair in pairs if mode not in fits[pair][place]} for mode in (BY_PRODUCT, BY_SUM)}
            modes[place] = min(wrong, key=lambda mode: len(wrong[mode]))
            excluded |= wrong[modes[place]]
    names = [p.name for p in found]

    def with_modes(k: int, p: Parameter) -> Parameter:
        words = tuple(word._replace(mode=modes.get(word.place, BY_ONE)) for word in p.words)
        others = frozenset(names[j] for pair in excluded if k in pair for j in pair if j != k)
        return p._replace(words=words, excludes=others)

    return [with_modes(k, p) for k, p in enumerate(found)]


def _each_its_own(copies: "_Copies", found: Sequence[Parameter]) -> bool:
    """Whether with other values of all parameters at once each word is what those make of it together that lead it,
    and one that none leads stays: then two that lead no word both do together what each does alone. (A length that
    rates of zero are multiplied with leads no velocity.)"""
    memory = copies.memory
    for first in range(len(FACTORS) if len(found) > 1 else 0):
        near = {p.name: _near(p, FACTORS[(first + k) % len(FACTORS)]) for k, p in enumerate(found)}
        if any(near[p.name] == p.value for p in found):
            continue
        copies.prepare([near])
        alone = [copies.of(**{name: x}) for name, x in near.items()]
        all_at_once = copies.of(**near)
        if all_at_once is None or None in alone:
            continue
        rows = memory.words([{}, *(copy for copy in alone if copy is not None), all_at_once])
        led: dict[tuple[int, ...], list[Place]] = {}
        for place, values in rows.items():
            bits = values.view(np.int64)
            led.setdefault(tuple(int(k) for k in np.flatnonzero(bits[1:-1] != bits[0])), []).append(place)
        return all(_only_these(copies, found, near, leaders, places) for leaders, places in led.items())
    return False


def _only_these(
    copies: "_Copies", found: Sequence[Parameter], near: Mapping[str, float], leaders: Sequence[int],
    places: Sequence[Place],
) -> bool:  # fmt: skip
    """Whether these words have the same bits with other values of their leaders as with other values of all."""
    few = {found[k].name: near[found[k].name] for k in leaders}
    some, everything = copies.of(**few) if few else {}, copies.of(**near)
    if some is None or everything is None:
        return False
    return not set(places) & set(copies.memory.words([some, everything]))


def _near(p: Parameter, factor: float) -> float:
    x = p.value * factor if p.value else factor - 1.0
    return min(max(x, p.least), p.largest)


class _Copies:
    """What models with other values change, each looked at once."""

    def __init__(self, memory: Memory, settings: Mapping[str, Setting]) -> None:
        self.memory, self._settings = memory, settings
        self._known: dict[tuple[tuple[str, float], ...], dict[int, bytes] | None] = {}

    def prepare(self, several: Iterable[Mapping[str, float]]) -> None:
        """Look at models with these values, and with each of them alone: what is asked for later is there then."""
        keys: list[tuple[tuple[str, float], ...]] = []
        models = []
        for values in several:
            for key in (*((item,) for item in values.items()), tuple(values.items())):
                if key not in self._known and key not in keys:
                    try:
                        models.append(self._settings[key[0][0]].with_values(dict(key)))
                        keys.append(key)
                    except TlismniError:
                        self._known[key] = None
        try:
            self._known.update(zip(keys, self.memory.copies(models), strict=True))
        except (TlismniError, NativeError):
            pass  # one of them has more than other numbers: `of` finds which

    def of(self, **values: float) -> dict[int, bytes] | None:
        """Of the model with these values; None if there is none."""
        key = tuple(values.items())
        if key not in self._known:
            try:
                model = self._settings[next(iter(values))].with_values(values)
                (self._known[key],) = self.memory.copies([model])
            except (TlismniError, NativeError):
                self._known[key] = None
        return self._known[key]


def _modes(copies: _Copies, p: Parameter, q: Parameter) -> dict[Place, tuple[int, ...]] | None:
    """In which modes the two lead each of the words that both lead; None if they lead any that one alone does not, or
    no model can be built with other values of both."""
    memory = copies.memory
    both = {word.place for word in p.words} & {word.place for word in q.words}
    for i, f in enumerate(FACTORS):
        x, y = _near(p, f), _near(q, FACTORS[i - 1])
        if x == p.value or y == q.value:
            continue
        found = copies.of(**{p.name: x}), copies.of(**{q.name: y}), copies.of(**{p.name: x, q.name: y})
        if None in found:
            continue
        changed = memory.words([{}, *(copy for copy in found if copy is not None)])
        result: dict[Place, tuple[int, ...]] = dict.fromkeys(both, (BY_PRODUCT, BY_SUM))
        for (k, offset), values in changed.items():
            place, four = (begin_of(memory.arrays[k]), offset), values.tolist()
            if place in both:
                result[place] = _modes_of(*four)
            elif four[3] not in four[1:3] or (four[1] != four[0] != four[2]):
                return None
        return result
    return None


def _modes_of(here: float, first: float, second: float, joint: float) -> tuple[int, ...]:
    found = []
    size = max(map(abs, (here, first, second, joint)))
    if abs(here) > SMALL * size and abs(joint * here - first * second) <= LIKE * abs(joint * here):
        found.append(BY_PRODUCT)
    if abs(joint - (first + second - here)) <= LIKE * size:
        found.append(BY_SUM)
    return tuple(found)


def compatible(found: Sequence[Parameter]) -> list[Parameter]:
    """As many of the parameters as may have other values at once, the first ones first."""
    kept: list[Parameter] = []
    for p in found:
        if p.begins and not any(q.name in p.excludes for q in kept):
            kept.append(p)
    return kept


def values_at_once(found: Sequence[Parameter], share: float) -> dict[str, float]:
    """Values of all of them, up to that share away from the present ones, in no simple order."""
    random = np.random.default_rng(3)
    return {p.name: _near(p, 1.0 + share * float(random.uniform(-1.0, 1.0))) for p in found}
