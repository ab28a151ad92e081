"""Impulses of contacts on patches: along the tangents, and against the spin, as one friction.

With the impulse zeta = M/r beside both of the tangents, and z = r w_n beside the sliding velocity, friction on a patch
(`laws/friction/turning.py`) is P = (P_T, zeta) = -mu P_N w/|w| at the end of the blow, w = (v_T, z). So w falls as if
it were braked in proportion, P = -L w, with the L at which |P| is mu P_N: one root for each contact, and as large as
can be where it sticks. Several contacts: sweeps of that over all of them, those that do not spin too.
"""

import math
from typing import Any

import numpy as np

from ..compiled.jit import internal

MOST_TURNS, MOST_TRIALS, ENOUGH, ROUGH = 5000, 100, 1e-14, 1e-8
"""Sweeps, trials for one contact; and in parts of the largest impulse how far these may be off, or at the end."""
SMALLER_AFTER, LEAST_STEP = 300, 0.125
STICKS = 1e-15
"""In parts of the inverse masses: what brakes a contact that sticks."""


@internal
def _braked(a: Any, b: Any, base: float, brake: float, p: Any) -> Any:
    """|P| of one contact with P = -brake w, and P_N; the impulses go to p (4,). (I + brake A_TT) w = b_T + a_TN P_N."""
    d_1, l_21, l_31 = 1.0 + brake * a[1, 1], brake * a[2, 1], brake * a[3, 1]
    l_21, l_31 = l_21 / d_1, l_31 / d_1
    d_2 = 1.0 + brake * a[2, 2] - l_21 * l_21 * d_1
    l_32 = (brake * a[3, 2] - l_31 * l_21 * d_1) / d_2
    d_3 = 1.0 + brake * a[3, 3] - l_31 * l_31 * d_1 - l_32 * l_32 * d_2
    free, pressed = (b[1], b[2], b[3]), (a[1, 0], a[2, 0], a[3, 0])
    w, more = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0)
    for turn in range(2):
        x, y, z = free if turn == 0 else pressed
        y -= l_21 * x
        z = (z - l_31 * x - l_32 * y) / d_3
        y = y / d_2 - l_32 * z
        x = x / d_1 - l_21 * y - l_31 * z
        w, more = ((x, y, z), more) if turn == 0 else (w, (x, y, z))
    grows = a[0, 0] - brake * (a[1, 0] * more[0] + a[2, 0] * more[1] + a[3, 0] * more[2])
    wanted = b[0] - brake * (a[1, 0] * w[0] + a[2, 0] * w[1] + a[3, 0] * w[2])
    p[0] = max(base, -wanted / grows) if grows > 0.0 else base
    total = 0.0
    for k in range(3):
        p[1 + k] = -brake * (w[k] + p[0] * more[k])
        total += p[1 + k] * p[1 + k]
    return math.sqrt(total), p[0]


@internal
def one_patch(a: Any, b: Any, mu: float, base: float, p: Any) -> None:
    """Impulses p (4,) of one contact: normal, both tangents, zeta; a (4, 4), b (4,): inverse masses, 1/kg, and the
    motion without them, m/s. None along what cannot move: a driven spin goes on, and is counted in w."""
    solve_ball(a, b, mu, base, STICKS, p)
    for k in range(1, 4):
        p[k] = p[k] if a[k, k] > 0.0 else 0.0


@internal
def solve_ball(a: Any, b: Any, mu: float, base: float, sticks: float, p: Any) -> bool:
    """The same, with what stands along all that cannot move; True if it sticks, where `sticks` is what brakes it in
    parts of the inverse masses."""
    p[0], p[1], p[2], p[3] = max(base, -b[0] / a[0, 0]), 0.0, 0.0, 0.0
    size = a[1, 1] + a[2, 2] + a[3, 3]
    if mu == 0.0 or size == 0.0 or (base == 0.0 and b[0] >= 0.0):
        return False
    friction, normal = _braked(a, b, base, 1.0 / (sticks * size), p)
    if friction <= mu * normal:
        return True
    # in parts of what is braked: 0 free, 1 sticks
    low, high, of_low, of_high, side = 0.0, 1.0, -mu * max(base, -b[0] / a[0, 0]), friction - mu * normal, 0
    for _ in range(MOST_TRIALS):
        x = low - of_low * (high - low) / (of_high - of_low)
        x = x if low < x < high else 0.5 * (low + high)
        friction, normal = _braked(a, b, base, x / ((1.0 - x) * size), p)
        off = friction - mu * normal
        if abs(off) <= ENOUGH * mu * normal or high - low <= ENOUGH * high:
            break
        # (Illinois: an end that stays counts for half)
        if off < 0.0:
            low, of_low, of_high = x, off, 0.5 * of_high if side < 0 else of_high
            side = -1
        else:
            high, of_high, of_low = x, off, 0.5 * of_low if side > 0 else of_low
            side = 1
    return False


@internal
def _visit(
    count: int, i: int, whole_a: Any, b: Any, p: Any, mu: float, base: float, a: Any, own: Any, one: Any
) -> None:
    """Impulses of contact i beside those of the others in p (4 count,), to one (4,)."""
    for k in range(4):
        row = k * count + i
        own[k] = b[row]
        for column in range(4 * count):
            own[k] += whole_a[row, column] * p[column]
        for l in range(4):
            a[k, l] = whole_a[row, l * count + i]
            own[k] -= a[k, l] * p[l * count + i]
    one_patch(a, own, mu, base, one)


@internal
def sweep_patches(count: int, whole_a: Any, b: Any, part: Any, mu: Any, base: Any, p: Any) -> bool:
    """Impulses p (4 count,) of the contacts `part`: normals, both tangents, zetas; False if sweeps do not find them.

    whole_a (4 count, 4 count), b (4 count,): inverse masses, 1/kg, and the motion without impulses, m/s; mu, base
    (count,): coefficients and least normal impulses.
    """
    a, own, one, step, largest, change = np.empty((4, 4)), np.empty(4), np.empty(4), 1.0, 0.0, 0.0
    for turn in range(MOST_TURNS):
        change, largest = 0.0, 0.0
        # sweeps that go round in circles come to rest with smaller steps
        step = max(0.5 * step, LEAST_STEP) if turn > 0 and turn % SMALLER_AFTER == 0 else step
        for i in range(count):
            if part[i] == 0.0:
                continue
            _visit(count, i, whole_a, b, p, mu[i], base[i], a, own, one)
            for k in range(4):
                more = one[k] - p[k * count + i]
                change = max(change, abs(more))
                p[k * count + i] += step * more
            largest = max(largest, p[i])
        if change <= 10.0 * ENOUGH * largest:
            return True
    return change <= ROUGH * largest
