"""Memory that Python gives to factorisations: scratch that all of a run share, and machine addresses."""

from functools import cache
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, twin
from ..compiled.jit import address_of
from .analyze import ANALYZE_SIGNATURE, analyze_sparse
from .record import ANALYZE_SPARSE, FUNCTION_COUNT, MATRIX_KINDS
from .solve import functions_of

FIRST = 64
"""Numbers of scratch at the beginning."""


@cache
def addresses(sparse: bool) -> NDArray[np.int64]:
    """What the field `functions` of LU points to: without those of sparse matrices nothing of these is compiled."""
    found = np.zeros(FUNCTION_COUNT, dtype=np.int64)
    for k, kind in enumerate(MATRIX_KINDS if sparse else MATRIX_KINDS[:2]):
        found[2 * k : 2 * k + 2] = functions_of(kind)
    if sparse:
        found[ANALYZE_SPARSE] = address_of(analyze_sparse, ANALYZE_SIGNATURE)
    return found


class Scratch:
    """Scratch for all factorisations of a run.

    Attributes
    ----------
    cell : (2,) int64: address and numbers; the field `scratch` of LU points to it.
    """

    def __init__(self) -> None:
        self.cell = np.zeros(2, dtype=np.int64)
        self.numbers = np.zeros(0)
        self.give(FIRST)

    def give(self, size: int) -> None:
        """Have room for at least `size` numbers."""
        if len(self.numbers) < size:
            self.numbers = np.zeros(size)
            self.cell[:] = self.numbers.ctypes.data, size

    def moved(self, take: Take) -> "Scratch":
        """The same in a copy of its memory (`compiled/image.py`)."""
        new: Any = twin(self)
        new.cell, new.numbers = take(self.cell), take(self.numbers)
        return new
