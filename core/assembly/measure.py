"""What the scales of a model are measured from, compiled: `scales.py` says what for. The workspace is left changed."""

import math
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..rounding import NO_STIFFNESS
from .evaluate import evaluate_residuals, evaluate_tangent

PROBES = 4
"""Pseudo-random motions from which the sizes of rows are taken, beside those that move every two coordinates together
and against each other: by the digits of their numbers, or the gaps of some of a hundred pairs would hardly move."""

MEASURED_SQUARE, MEASURED_WORK, MEASURED_HEAVIEST, MEASURED_STIFFEST = range(4)
MEASURED = 4
"""Of `measure_motion`: the largest square of a rate (1/s^2) and the largest work (J), 0 where there is none; the
largest mass (kg m^2), and how stiff what holds the masses is (1/s^2)."""


@internal
def _more(largest: float, x: float) -> float:
    """The larger one; NaN if one of them is."""
    return largest if largest != largest or x <= largest else x


@internal
def _larger_number(largest: float, x: float) -> float:
    """The larger one, if x is a finite number."""
    return x if math.isfinite(x) and x > largest else largest


@internal
def measure_rows(workspace: Any, scale: Any, sizes: Any) -> None:
    """How far rows of Phi move when the coordinates move by their scales (n,), into `sizes` (m,).

    Phi' = Phi_q v + Phi_t for motions of all coordinates at once; the largest of several.
    """
    v, phid, m = vec(workspace.v, workspace.n_ext), vec(workspace.phid, workspace.m_ext), len(sizes)
    v[:] = 0.0
    evaluate_residuals(workspace)
    still = phid.copy()
    sizes[:] = 0.0
    digits = 1
    while 2**digits < workspace.n:
        digits += 1
    for k in range(PROBES + 1 + digits):
        for i in range(workspace.n):
            if k < PROBES:
                golden = 0.6180339887498949 * (i + 1.0) * (2 * k + 1)
                ahead = golden - math.floor(golden) < 0.5
            else:
                ahead = (i >> (k - PROBES)) % 2 == 0  # the last one moves all alike
            v[i] = scale[i] if ahead else -scale[i]
        evaluate_residuals(workspace)
        for row in range(m):
            size = abs(phid[row] - still[row])
            sizes[row] = max(sizes[row], size) if math.isfinite(size) else math.inf
    largest = 0.0
    for row in range(m):
        if not math.isfinite(sizes[row]):
            sizes[row] = 0.0
        largest = max(largest, sizes[row])
    # one that nothing moves now: as large as the largest of the others
    for row in range(m):
        if sizes[row] == 0.0:
            sizes[row] = largest if largest > 0.0 else 1.0


@internal
def _diagonals(workspace: Any, c_q: float, out: Any) -> None:
    """Magnitudes of the diagonal of M + c_q K (n,)."""
    evaluate_tangent(workspace, c_q, 0.0)
    slots, values = ivec(workspace.mass_slot, workspace.n_mass), vec(workspace.values, workspace.n_values)
    rows, cols = ivec(workspace.entry_row, workspace.n_values), ivec(workspace.entry_col, workspace.n_values)
    out[:] = 0.0
    for slot in slots:
        if rows[slot] == cols[slot]:
            out[rows[slot]] = abs(values[slot])


@internal
def measure_motion(workspace: Any, scale: Any, v: Any, later: Any, m_joints: int, mass: Any, found: Any) -> None:
    """Rates, works, masses and stiffness (MEASURED,) at the current point, now and `later` (s), at rest and with the
    velocities v (n,); coordinates with `scale` 0 tell nothing. `mass` (n,) is overwritten."""
    n, clock, reach = workspace.n, vec(workspace.t, 1), vec(workspace.level_scale, workspace.n)
    q_now, v_now, r = (
        vec(workspace.q, workspace.n_ext),
        vec(workspace.v, workspace.n_ext),
        vec(workspace.r, workspace.n_ext),
    )
    phid, phidd, sizes = (
        vec(workspace.phid, workspace.m_ext),
        vec(workspace.phidd, workspace.m_ext),
        vec(workspace.row_scale, workspace.m_ext),
    )
    t, q, stiffness = clock[0], q_now.copy(), mass.copy()
    largest = 0.0
    for i in range(n):
        largest = _more(largest, (v[i] / reach[i]) * (v[i] / reach[i]))
    square, work = _larger_number(0.0, largest), 0.0
    vec(workspace.a, workspace.n_ext)[:] = 0.0
    vec(workspace.lam, workspace.m_ext)[:] = 0.0
    for k in range(len(later)):
        clock[0] = t + later[k]
        q_now[:] = q
        for moving in range(2):
            for i in range(n):
                v_now[i] = v[i] if moving else 0.0
            evaluate_residuals(workspace)
            if k == 0 and moving == 0:
                _diagonals(workspace, 0.0, mass)
                evaluate_residuals(workspace)
            push, way, bend, slip = 0.0, 0.0, 0.0, 0.0
            for i in range(n):
                if mass[i] > 0.0 and scale[i] > 0.0:
                    push = _more(push, abs(r[i]) / (mass[i] * reach[i]))
                    way = _more(way, abs(r[i]) * scale[i])
            for row in range(m_joints):
                bend = _more(bend, abs(phidd[row]) / sizes[row])
                slip = _more(slip, (phid[row] / sizes[row]) * (phid[row] / sizes[row]))
            square, work = _larger_number(_larger_number(square, push), bend), _larger_number(work, way)
            if moving == 0:
                square = _larger_number(square, slip)
    clock[0] = t
    q_now[:] = q
    v_now[:] = 0.0
    evaluate_residuals(workspace)
    _diagonals(workspace, 1.0, stiffness)
    stiffest, heaviest, kinetic = 0.0, 0.0, 0.0
    for i in range(n):
        stiff = abs(stiffness[i] - mass[i])
        if mass[i] > 0.0 and scale[i] > 0.0 and stiff > NO_STIFFNESS * mass[i] and math.isfinite(stiff):
            stiffest = _more(stiffest, stiff / mass[i])
        heaviest = _more(heaviest, mass[i] * (scale[i] * scale[i]))
        # each mass with its own speed: a heavy one need not move as fast as the fastest
        kinetic = _more(kinetic, mass[i] * (v[i] * v[i]))
    found[MEASURED_SQUARE], found[MEASURED_WORK] = square, _larger_number(work, kinetic)
    found[MEASURED_HEAVIEST], found[MEASURED_STIFFEST] = heaviest, stiffest
