"""How a word of a run's memory follows from a parameter: as one operation on it, found by trying.

A number of a table is a parameter itself, or what the model makes of it: its square, a multiple, what is left of one.
The operations are those of C, each rounded once, so one that gives all words that were tried bit for bit is the one
that was used, or does the same. What takes more operations is one of these to rounding (`near_form`), or a smooth
function that a series of Chebyshev polynomials gives to rounding (`series_form`).
"""

import math
from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Form(NamedTuple):
    """`code` = 8 UNARY + BINARY."""

    code: int
    constant: float
    series: tuple[float, ...] = ()
    """Two limits, and coefficients of Chebyshev polynomials between them."""
    exact: bool = True
    """Gives all words that were tried bit for bit, not only to rounding."""


UNARY: tuple[Callable[[Floats], Floats], ...] = (
    lambda p: p, lambda p: -p, lambda p: p * p, np.sqrt, lambda p: 1.0 - p, lambda p: 1.0 + p, lambda p: 1.0 - p * p,
    lambda p: p * p * p,
)  # fmt: skip
"""As `parameters.c` has them."""
BINARY: tuple[Callable[[Floats, float], Floats], ...] = (
    lambda u, c: u, lambda u, c: u * c, lambda u, c: u / c, lambda u, c: c / u, lambda u, c: u + c, lambda u, c: c - u,
)  # fmt: skip
_INVERSE: tuple[Callable[[Floats, Floats], Floats], ...] = (
    lambda u, w: w, lambda u, w: w / u, lambda u, w: u / w, lambda u, w: w * u, lambda u, w: w - u, lambda u, w: w + u,
)  # fmt: skip
"""What the constant of each is about."""
SUMS, SUM = 4, 4
"""The first unary operation that is a sum already, and the first binary one: two sums are hard to tell from one."""
NEIGHBOURS = 2
"""Numbers on either side of a quotient that the constant may be."""
SERIES = 64
"""Code of a series, as in `parameters.c`."""
NODES = 24
"""Of a series, at most."""
PERHAPS = 1e-9
"""Relative: constants that differ by more are not one, whatever rounding does."""
NEAR = 1e-15
"""Relative: what a few roundings leave."""
ROUNDING = 4e-15
"""Of the largest word: what a series may leave."""
NOTHING = 2e-17
"""Of the largest word: a coefficient that adds nothing."""
ENOUGH = 4
"""Different values of the parameter that a form has to fit."""


def _constants(k: int, u: Floats, w: Floats) -> Iterator[float]:
    """Candidates, the shortest in print first."""
    about = {float(x) for x in _INVERSE[k](u, w)}
    found = set()
    for x in about:
        low = high = x
        found.add(x)
        for _ in range(NEIGHBOURS):
            low, high = float(np.nextafter(low, -np.inf)), float(np.nextafter(high, np.inf))
            found |= {low, high}
    yield from sorted((c for c in found if np.isfinite(c) and c), key=lambda c: (len(repr(c)), c))


def _alike(constants: Floats, others: float) -> bool:
    """Whether they may be one constant, but for rounding of numbers of the size of `others` too."""
    known = constants[np.isfinite(constants)]  # zeros tell nothing of a factor
    if not len(known):
        return False
    size = max(float(np.max(np.abs(known))), float(others))
    return math.isfinite(size) and float(np.ptp(known)) <= PERHAPS * size


def form_of(p: Floats, w: Floats) -> Form | None:
    """The form that makes `w` (k,) of `p` (k,) bit for bit; None if there is none, or too few values for being sure."""
    if len(set(p.tolist())) < ENOUGH:
        return None
    wanted = w.tobytes()
    with np.errstate(all="ignore"):
        for i, unary in enumerate(UNARY):
            u = unary(p)
            if not np.isfinite(u).all():
                continue
            if u.tobytes() == wanted:
                return Form(8 * i, 0.0)
            for k in range(1, len(BINARY) if i < SUMS else SUM):
                if not _alike(_INVERSE[k](u, w), np.max(np.abs(u)) if k >= SUM else 0.0):
                    continue
                for constant in _constants(k, u, w):
                    if BINARY[k](u, constant).tobytes() == wanted:
                        return Form(8 * i + k, constant)
    return None


def is_sure(p: Floats, w: Floats, form: Form) -> bool:
    """Whether no neighbour of the form's constant makes the words `w` (k,) of `p` (k,) too."""
    binary = form.code % 8
    if binary == 0:
        return True
    with np.errstate(all="ignore"):
        u, wanted = UNARY[form.code // 8](p), w.tobytes()
        for toward in (-np.inf, np.inf):
            constant = form.constant
            for _ in range(2 * NEIGHBOURS):
                constant = float(np.nextafter(constant, toward))
                if BINARY[binary](u, constant).tobytes() == wanted:
                    return False
    return True


def near_form(p: Floats, w: Floats) -> Form | None:
    """The form that makes `w` (k,) of `p` (k,) to rounding: a multiple or a quotient of a power; None without one."""
    if not (np.isfinite(w).all() and w.all()):
        return None
    with np.errstate(all="ignore"):
        for i in (0, 2, 3, UNARY.index(UNARY[-1])):
            u = UNARY[i](p)
            for k in (1, 2, 3):
                constants = _INVERSE[k](u, w)
                if not np.isfinite(constants).all():
                    continue
                constant = float(np.median(constants))
                if np.all(np.abs(BINARY[k](u, constant) - w) <= NEAR * np.abs(w)):
                    return Form(8 * i + k, constant, exact=False)
    return None


def nodes_of(least: float, largest: float) -> Floats:
    """Where a series between two limits wants the words, (NODES,)."""
    x = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)
    return np.asarray(0.5 * (least + largest) + 0.5 * (largest - least) * x)


def series_form(words: Floats, least: float, largest: float, p: Floats, w: Floats) -> Form | None:
    """The series through the `words` (NODES,) at `nodes_of` the limits; None if it does not give `w` (k,) at the values
    `p` (k,) between them to rounding."""
    if not np.isfinite(words).all():
        return None
    k = np.arange(NODES)
    basis = np.cos(np.pi * np.outer(k, k + 0.5) / NODES)
    coefficients = 2.0 / NODES * (basis @ words)
    coefficients[0] *= 0.5
    size = float(np.max(np.abs(words)))
    used = np.flatnonzero(np.abs(coefficients) > NOTHING * size)
    series = coefficients[: int(used[-1]) + 1 if len(used) else 1]
    found = np.polynomial.chebyshev.chebval((2.0 * p - (least + largest)) / (largest - least), series)
    if not np.all(np.abs(found - w) <= ROUNDING * size):
        return None
    return Form(SERIES, 0.0, (least, largest, *series.tolist()), exact=False)
