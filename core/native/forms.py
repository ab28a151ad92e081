"""How a word of a run's memory follows from a parameter: as one operation on it, found by trying.

A number of a table is a parameter itself, or what the model makes of it: its square, a multiple, what is left of one.
The operations are those of C, each rounded once, so one that gives all words that were tried bit for bit is the one
that was used, or does the same.
"""

from collections.abc import Callable, Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]


class Form(NamedTuple):
    """`code` = 8 UNARY + BINARY."""

    code: int
    constant: float


UNARY: tuple[Callable[[Floats], Floats], ...] = (
    lambda p: p, lambda p: -p, lambda p: p * p, np.sqrt, lambda p: 1.0 - p, lambda p: 1.0 + p, lambda p: 1.0 - p * p,
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
                for constant in _constants(k, u, w):
                    if BINARY[k](u, constant).tobytes() == wanted:
                        return Form(8 * i + k, constant)
    return None
