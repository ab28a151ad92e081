"""Small dense matrices of variations: elimination, products, and the choice of dependent coordinates."""

from typing import Any

from ..compiled.jit import internal


@internal
def eliminate(a: Any, b: Any) -> None:
    """b = a^-1 b by Gauss with partial pivoting (LAPACK costs more than these small systems); a (n, n) is lost."""
    n, columns = len(a), b.shape[1]
    for i in range(n):
        at = i
        for j in range(i + 1, n):
            if abs(a[j, i]) > abs(a[at, i]):
                at = j
        if at != i:
            for j in range(i, n):
                a[i, j], a[at, j] = a[at, j], a[i, j]
            for j in range(columns):
                b[i, j], b[at, j] = b[at, j], b[i, j]
        for j in range(i + 1, n):
            x = a[j, i] / a[i, i]
            if x != 0.0:
                for l in range(i + 1, n):
                    a[j, l] -= x * a[i, l]
                for l in range(columns):
                    b[j, l] -= x * b[i, l]
    for i in range(n - 1, -1, -1):
        for l in range(columns):
            x = b[i, l]
            for j in range(i + 1, n):
                x -= a[i, j] * b[j, l]
            b[i, l] = x / a[i, i]


@internal
def add_product(out: Any, a: Any, b: Any, factor: float) -> None:
    """out += factor a b."""
    for i in range(a.shape[0]):
        for l in range(a.shape[1]):
            x = factor * a[i, l]
            if x != 0.0:
                for j in range(b.shape[1]):
                    out[i, j] += x * b[l, j]


@internal
def choose(phi_q: Any, scale: Any, a: Any, dependent: Any, independent: Any) -> None:
    """Dependent (m,) and independent coordinates (n - m,) at Phi_q (m, n), by elimination with complete pivoting; a
    (m, n) is scratch.

    Columns are in parts of the coordinates' scales (n,) and rows of their largest entry, so that units do not choose.
    """
    m, n = phi_q.shape
    for i in range(m):
        largest = 0.0
        for j in range(n):
            a[i, j] = phi_q[i, j] * scale[j]
            largest = max(largest, abs(a[i, j]))
        if largest > 0.0:
            for j in range(n):
                a[i, j] /= largest
    for step in range(m):
        row, column, largest = step, -1, -1.0
        for i in range(step, m):
            for j in range(n):
                if abs(a[i, j]) > largest:
                    row, column, largest = i, j, abs(a[i, j])
        for j in range(n):
            a[step, j], a[row, j] = a[row, j], a[step, j]
        dependent[step] = column
        for i in range(step + 1, m):
            x = a[i, column] / a[step, column]
            if x != 0.0:
                for j in range(n):
                    a[i, j] -= x * a[step, j]
        # no later step takes this column again
        for i in range(step + 1, m):
            a[i, column] = 0.0
    count = 0
    for j in range(n):
        free = True
        for i in range(m):
            free = free and dependent[i] != j
        if free:
            independent[count] = j
            count += 1
