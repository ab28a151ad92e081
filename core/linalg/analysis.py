"""Analyses of one pattern: what the refactorisation with certain pivots needs, made by Python and never changed."""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, twin
from .check_pattern import LARGEST_INDEX
from .record import ANALYSIS, MOST_ANALYSES, OF_ANALYSIS
from .solve import functions_of
from .symbolic import Operations, count_operations, fill_pattern, operation_list

Ints = NDArray[np.int64]

# The list of operations is written down while it is at most this many times the fill. Measured: 1.2-1.5 times
# faster than by columns for chains (1.1 operations an entry), 1.2-1.7 times slower for spring grids (10-30).
PROGRAM_LIMIT = 4


class Analysis:
    """The analysis of a pattern (rows, cols, slots) for pivots in the places perm_r (n,), perm_c (n,).

    Attributes
    ----------
    kind : of the refactorisation, "program" or "columns".
    size : numbers that are stored: L, U, inverse pivots, limits on the growth of L.
    arrays : by field of LU.
    """

    def __init__(self, n: int, rows: Ints, cols: Ints, slots: Ints, perm_r: Ints, perm_c: Ints) -> None:
        self.perm_r, self.perm_c = perm_r, perm_c
        row, col = perm_r[rows], perm_c[cols]
        l, u = fill_pattern(n, row, col)
        nl, nu = len(l.row), len(u.row)
        if nl + nu + 2 * n > LARGEST_INDEX:
            raise ValueError(f"{nl + nu + 2 * n} stored values are more than 32-bit indices can reach")
        if count_operations(l, u) <= PROGRAM_LIMIT * (nl + nu + n):
            self.kind, operations = "program", operation_list(n, l, u)
        else:
            self.kind, operations = "columns", Operations(*(np.zeros((k, 0), np.uint32) for k in (1, 3, 1, 2)))
        entry_to = nl + nu + row
        below, above = row > col, row < col
        entry_to[below] = l.find(n, row[below], col[below])
        entry_to[above] = nl + u.find(n, row[above], col[above])
        order = np.argsort(entry_to)  # written in ascending order
        indices = {
            "entry_to": entry_to[order],
            "entry_from": slots[order],
            "row_at": np.argsort(perm_r),
            "col_at": np.argsort(perm_c),
            "step_start": operations.step_start,
            "sum_start": operations.sum_start,
            **dict(zip(("step_to", "step_left", "step_right"), operations.steps, strict=True)),
            **dict(zip(("sum_left", "sum_right"), operations.sums, strict=True)),
            **{f"{name}_{field}": value for name, t in (("l", l), ("u", u)) for field, value in t._asdict().items()},
        }
        self.arrays = {name: np.ascontiguousarray(x, dtype=np.uint32) for name, x in indices.items()}
        self.size = nl + nu + 2 * n
        factor_function, solve_function = functions_of(self.kind)
        self._table = np.zeros(1, ANALYSIS)
        numbers = {
            "perm_r": perm_r.ctypes.data, "size": self.size, "nl": nl, "nu": nu,
            "n_steps": operations.steps.shape[1], "n_sums": operations.sums.shape[1],
            "factor_function": factor_function, "solve_function": solve_function,
        }  # fmt: skip
        for name in ("perm_r", "size", *OF_ANALYSIS):
            self._table[name] = numbers[name] if name in numbers else self.arrays[name].ctypes.data
        self.address = int(self._table.ctypes.data)


class Known:
    """The analyses of one pattern that a run knows, as compiled code sees them; factorisations that follow each other
    have one between them.

    Parameters
    ----------
    built : by pivots, those that all runs with this pattern share.
    """

    def __init__(self, built: dict[bytes, Analysis]) -> None:
        self.built = built
        self.addresses, self.count = np.zeros(MOST_ANALYSES, dtype=np.int64), np.zeros(1, dtype=np.int64)
        self._kept: dict[int, Analysis] = {}
        self._next = 0
        # what was given up may still be the present one of a factorisation
        self._given_up: deque[Analysis] = deque(maxlen=MOST_ANALYSES)

    def at(self, address: int) -> Analysis:
        """The analysis whose record is at `address`."""
        return self._kept.get(address) or next(x for x in self._given_up if x.address == address)

    @property
    def largest(self) -> int:
        """Most numbers that one of them stores."""
        return max((analysis.size for analysis in self._kept.values()), default=0)

    def get(self, n: int, rows: Ints, cols: Ints, slots: Ints, perm_r: Ints, perm_c: Ints) -> Analysis:
        """The analysis for these pivots: shared, or made."""
        key = perm_r.tobytes() + perm_c.tobytes()
        found = self.built.get(key)
        if found is None:
            found = Analysis(n, rows, cols, slots, perm_r, perm_c)
            if len(self.built) < MOST_ANALYSES:
                self.built[key] = found
        return found

    def add(self, analysis: Analysis) -> None:
        """Let compiled code know it."""
        if analysis.address in self._kept:
            return
        place, self._next = self._next, (self._next + 1) % MOST_ANALYSES
        if self.count[0] == MOST_ANALYSES:
            self._given_up.append(self._kept.pop(int(self.addresses[place])))
        self._kept[analysis.address] = analysis
        self.addresses[place] = analysis.address
        self.count[0] = len(self._kept)

    def fresh(self) -> "Known":
        """One that knows nothing yet, and shares what is built."""
        return Known(self.built)

    def moved(self, take: Take) -> "Known":
        """The same in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        new.addresses, new.count = take(self.addresses), take(self.count)
        new._kept, new._given_up = dict(self._kept), deque(self._given_up, maxlen=MOST_ANALYSES)
        return new
