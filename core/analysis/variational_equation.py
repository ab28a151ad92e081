"""The variational equation between events, in independent coordinates, by Gauss collocation of order 6.

Variations that keep the constraints are dq = N y with Phi_q N = 0; N is the identity in the rows of the independent
coordinates and -Phi_qd^-1 Phi_qi in the others. Which are dependent is chosen anew for each step, so that Phi_qd stays
far from singular while bodies turn: of a body's Euler parameters a large one. Their rates are dv = N y' + N' y, with
Phi_q N' = -B N and B the rate of Phi_q along the motion. With the momenta p = N^T M dv the linearised equations of
motion lose the variations of the multipliers (N^T Phi_q^T = 0), and no derivative of B is needed:

    y' = G^-1 (p - N^T M N' y)                               G = N^T M N
    p' = N'^T M dv + N^T ((M' - D) dv - K dq)

(M' is the rate of M along the motion.) Volume in (y, p) is what the flow of a system without damping preserves; the
divergence of the field is tr(G^-1 N^T (M' - D) N). Lengths are those of the kinetic energy: |dq|^2 = y^T G y and
|dv|^2 = p^T G^-1 p, in which the same volume is one.
"""

from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import compiled_unlocked, internal
from ..methods.tableaus import TABLEAUS
from .elimination import add_product, choose, eliminate

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

_GAUSS = TABLEAUS["gauss3"]
GAUSS_NODES = np.array(_GAUSS.c)
GAUSS_STAGES = len(GAUSS_NODES)
_A = np.array(_GAUSS.a)
_B = np.array(_GAUSS.b)


class Work(NamedTuple):
    """Room for what `carry` computes (allocation in compiled code is slow to compile)."""

    basis: Floats  # N (n, f)
    turning: Floats  # N' (n, f)
    moved: Floats  # M N (n, f)
    by_y: Floats  # dv/dy (n, f)
    by_p: Floats  # dv/dp (n, f)
    pushed: Floats  # (n, f)
    fixed: Floats  # (m, m)
    lines: Floats  # (m, f)
    gram: Floats  # (f, f)
    inverse: Floats  # (f, f)
    y_y: Floats  # (f, f) blocks of a generator
    p_y: Floats
    p_p: Floats
    generators: Floats  # (stages, 2f, 2f)
    system: Floats  # (stages 2f, stages 2f)
    slopes: Floats  # (stages 2f, columns)
    z: Floats  # (2f, columns)
    pivoting: Floats  # (m, n)
    dependent: Ints  # (m,)
    independent: Ints  # (f,)


def make_work(n: int, m: int, columns: int) -> Work:
    """Room for n coordinates, m constraints and so many variations."""
    f = n - m
    size = GAUSS_STAGES * 2 * f
    shapes = (
        *[(n, f)] * 6, (m, m), (m, f), *[(f, f)] * 5, (GAUSS_STAGES, 2 * f, 2 * f), (size, size), (size, columns),
        (2 * f, columns),
    )  # fmt: skip
    places = np.zeros((m, n)), np.zeros(m, dtype=np.int64), np.zeros(f, dtype=np.int64)
    room: tuple[Any, ...] = (*(np.zeros(shape) for shape in shapes), *places)
    return Work(*room)


@internal
def null_space(phi_q: Any, work: Any) -> None:
    """work.basis = N, with Phi_q N = 0 and the identity in the independent rows."""
    dependent, independent = work.dependent, work.independent
    m, f = len(dependent), len(independent)
    work.basis[:, :] = 0.0
    for i in range(m):
        for j in range(m):
            work.fixed[i, j] = phi_q[i, dependent[j]]
        for j in range(f):
            work.lines[i, j] = -phi_q[i, independent[j]]
    eliminate(work.fixed, work.lines)
    for j in range(f):
        work.basis[independent[j], j] = 1.0
        for i in range(m):
            work.basis[dependent[i], j] = work.lines[i, j]


@internal
def metric(mass: Any, work: Any) -> None:
    """work.moved = M N and work.inverse = (N^T M N)^-1."""
    work.moved[:, :], work.gram[:, :], work.inverse[:, :] = 0.0, 0.0, 0.0
    add_product(work.moved, mass, work.basis, 1.0)
    add_product(work.gram, work.basis.T, work.moved, 1.0)
    for i in range(len(work.gram)):
        work.inverse[i, i] = 1.0
    eliminate(work.gram, work.inverse)


@internal
def generator(mass: Any, k: Any, d: Any, mass_rate: Any, phi_q: Any, rate: Any, work: Any, out: Any) -> float:
    """Matrix (2f, 2f) of (y, p)' = out (y, p); returns a bound of the frequencies, rad/s, from tr((G^-1 K)^2) and
    tr((G^-1 D)^2), which no choice of coordinates changes."""
    dependent = work.dependent
    m, f = len(dependent), len(work.independent)
    null_space(phi_q, work)
    metric(mass, work)
    work.lines[:, :], work.turning[:, :] = 0.0, 0.0
    add_product(work.lines, rate, work.basis, -1.0)
    for i in range(m):
        for j in range(m):
            work.fixed[i, j] = phi_q[i, dependent[j]]
    eliminate(work.fixed, work.lines)
    for i in range(m):
        for j in range(f):
            work.turning[dependent[i], j] = work.lines[i, j]
    work.y_y[:, :], work.p_y[:, :], work.p_p[:, :] = 0.0, 0.0, 0.0
    # dv = by_y y + by_p p
    work.gram[:, :], work.by_p[:, :] = 0.0, 0.0
    add_product(work.gram, work.moved.T, work.turning, 1.0)
    add_product(work.y_y, work.inverse, work.gram, -1.0)
    for i in range(len(work.by_y)):
        for j in range(f):
            work.by_y[i, j] = work.turning[i, j]
    add_product(work.by_y, work.basis, work.y_y, 1.0)
    add_product(work.by_p, work.basis, work.inverse, 1.0)
    work.pushed[:, :] = 0.0
    add_product(work.pushed, mass_rate, work.by_y, 1.0)
    add_product(work.pushed, d, work.by_y, -1.0)
    add_product(work.pushed, k, work.basis, -1.0)
    add_product(work.p_y, work.basis.T, work.pushed, 1.0)
    work.pushed[:, :] = 0.0
    add_product(work.pushed, mass, work.by_y, 1.0)
    add_product(work.p_y, work.turning.T, work.pushed, 1.0)
    work.pushed[:, :] = 0.0
    add_product(work.pushed, mass_rate, work.by_p, 1.0)
    add_product(work.pushed, d, work.by_p, -1.0)
    add_product(work.p_p, work.basis.T, work.pushed, 1.0)
    work.pushed[:, :] = 0.0
    add_product(work.pushed, mass, work.by_p, 1.0)
    add_product(work.p_p, work.turning.T, work.pushed, 1.0)
    work.gram[:, :] = 0.0
    add_product(work.gram, work.inverse, work.p_y, 1.0)
    stiff, damped = 0.0, 0.0
    for i in range(f):
        for j in range(f):
            out[i, j], out[i, f + j] = work.y_y[i, j], work.inverse[i, j]
            out[f + i, j], out[f + i, f + j] = work.p_y[i, j], work.p_p[i, j]
            stiff += work.gram[i, j] * work.gram[j, i]
            damped += work.p_p[i, j] * work.p_p[j, i]
    return max(abs(stiff) ** 0.25, abs(damped) ** 0.5)


@internal
def collocate(generators: Any, h: float, z: Any, system: Any, slopes: Any) -> None:
    """One Gauss step of z' = generator z with its matrices at the nodes, (stages, 2f, 2f); changes z (2f, columns)."""
    size, columns = z.shape
    slopes[:, :] = 0.0
    for i in range(GAUSS_STAGES):
        for j in range(GAUSS_STAGES):
            for r in range(size):
                for c in range(size):
                    system[size * i + r, size * j + c] = -h * _A[i, j] * generators[i, r, c]
        add_product(slopes[size * i : size * (i + 1)], generators[i], z, 1.0)
    for i in range(size * GAUSS_STAGES):
        system[i, i] += 1.0
    eliminate(system, slopes)
    for i in range(GAUSS_STAGES):
        for r in range(size):
            for c in range(columns):
                z[r, c] += h * _B[i] * slopes[size * i + r, c]


@internal
def orthonormal(mass: Any, dq: Any, dv: Any, r: Any) -> None:
    """The columns of (dq, dv) made orthonormal in dq^T M dq + dv^T M dv, by the modified Gram-Schmidt process; r gets
    the upper triangular factor."""
    n, columns = dq.shape
    r[:, :] = 0.0
    for c in range(columns):
        for other in range(c + 1):
            # the last is the column itself: its length
            total = 0.0
            for i in range(n):
                x, y = 0.0, 0.0
                for j in range(n):
                    x += mass[i, j] * dq[j, c]
                    y += mass[i, j] * dv[j, c]
                total += dq[i, other] * x + dv[i, other] * y
            if other < c:
                r[other, c] = total
                for i in range(n):
                    dq[i, c] -= total * dq[i, other]
                    dv[i, c] -= total * dv[i, other]
            else:
                r[c, c] = np.sqrt(total)
                for i in range(n):
                    dq[i, c] /= r[c, c]
                    dv[i, c] /= r[c, c]


@compiled_unlocked
def carry(
    h: float, mass: Any, k: Any, d: Any, mass_rate: Any, phi_q: Any, rate: Any, scale: Any, dq: Any, dv: Any, r: Any,
    work: Any,
) -> Any:  # fmt: skip
    """Carry variations over a step of size h, and make them orthonormal.

    The matrices are those at its start, at the Gauss nodes of its substeps of equal size, and at its end, 3 s + 2 in
    all; mass_rate may be a single one. scale (n,) are the coordinates' scales. dq and dv (n, columns) are changed; dv
    is the part tangent to the constraints.
    r (columns, columns) gets the upper triangular matrix with which the new ones give what they were before they were
    made orthonormal.

    Returns
    -------
    frequency : the highest met, rad/s. divergence : its integral over the step.
    """
    steps = (len(mass) - 2) // GAUSS_STAGES
    # the choice that is best in the middle serves both ends
    choose(phi_q[len(mass) // 2], scale, work.pivoting, work.dependent, work.independent)
    independent = work.independent
    f, columns = len(independent), dq.shape[1]
    n, z = dq.shape[0], work.z
    null_space(phi_q[0], work)
    metric(mass[0], work)
    z[:, :] = 0.0
    for i in range(f):
        for c in range(columns):
            z[i, c] = dq[independent[i], c]
    add_product(z[f:], work.moved.T, dv, 1.0)
    frequency, divergence = 0.0, 0.0
    for s in range(steps):
        for i in range(GAUSS_STAGES):
            at = 1 + GAUSS_STAGES * s + i
            found = generator(
                mass[at], k[at], d[at], mass_rate[at if len(mass_rate) > 1 else 0], phi_q[at], rate[at], work,
                work.generators[i],
            )  # fmt: skip
            frequency = max(frequency, found)
            for j in range(2 * f):
                divergence += h / steps * _B[i] * work.generators[i, j, j]
        collocate(work.generators, h / steps, z, work.system, work.slopes)
    null_space(phi_q[-1], work)
    metric(mass[-1], work)
    work.by_p[:, :] = 0.0
    add_product(work.by_p, work.basis, work.inverse, 1.0)
    for i in range(n):
        for c in range(columns):
            dq[i, c], dv[i, c] = 0.0, 0.0
    add_product(dq, work.basis, z[:f], 1.0)
    add_product(dv, work.by_p, z[f:], 1.0)
    orthonormal(mass[-1], dq, dv, r)
    return frequency, divergence
