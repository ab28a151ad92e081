"""Nonnegative least squares from a Gram matrix, by the active set of Lawson and Hanson (1974, algorithm NNLS 23.10)."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..linalg.small import solve_square


def nonnegative_size(n: int) -> int:
    """Numbers (of 8 bytes) in the scratch of `nonnegative`."""
    return n * n + 2 * n


@internal
def _solve_passive(s: Any, r: Any, passive: Any, number: int, work: int) -> bool:
    """Solve s y = -r on the passive set, to the first `number` places of the scratch; False if s is singular there."""
    matrix, y = mat(work, number, number), vec(work + 8 * number * number, number)
    for j in range(number):
        y[j] = -r[passive[j]]
        for k in range(number):
            matrix[j, k] = s[passive[j], passive[k]]
    return solve_square(matrix, y) != 0


@internal
def nonnegative(s: Any, r: Any, fixed: int, tolerance: float, z: Any, w: Any, work: int) -> None:
    """z (n,) >= 0 that minimizes z.s z/2 + r.z, z[fixed] = 0, and the gradient w = s z + r.

    Parameters
    ----------
    s : positive semidefinite matrix, (n, n).
    tolerance : of sqrt(s[j, j] s[fixed, fixed]): gradients above minus that are zero.
    work : address of `nonnegative_size(n)` numbers.
    """
    n, number = len(z), 0
    passive = ivec(work + 8 * (n * n + n), n)
    for j in range(n):
        z[j], w[j] = 0.0, r[j]
    for _ in range(3 * n):
        enters, least = -1, 0.0
        for j in range(n):
            size = s[j, j] ** 0.5
            if j != fixed and size > 0.0 and w[j] < -tolerance * size * s[fixed, fixed] ** 0.5 and w[j] / size < least:
                enters, least = j, w[j] / size
        if enters < 0:
            return
        passive[number] = enters
        number += 1
        while number > 0:
            if not _solve_passive(s, r, passive, number, work):
                number -= 1
                break
            y, part, leaves = vec(work + 8 * number * number, number), 1.0, -1
            for j in range(number):
                at = z[passive[j]]
                if y[j] <= 0.0 and at / (at - y[j]) < part:
                    part, leaves = at / (at - y[j]), j
            for j in range(number):
                z[passive[j]] += part * (y[j] - z[passive[j]])
            if leaves < 0:
                break
            z[passive[leaves]] = 0.0
            for j in range(leaves, number - 1):
                passive[j] = passive[j + 1]
            number -= 1
        for j in range(n):
            w[j] = r[j]
            for k in range(n):
                w[j] += s[j, k] * z[k]
