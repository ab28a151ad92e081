"""Partitions into dependent and independent coordinates for bodies whose attitudes are in turning frames."""

from typing import Any

import numpy as np

from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, mat, vec
from ..linalg import lu_at, solve
from ..stage.corotating import POINT
from ..state.method_records import ESTIMATE
from ..state.workspace_records import SPIN_SIZE
from .frame_choice import choose_frames
from .history import history_time
from .multistep import rows_available

LEAST_PART = 0.25
"""Of a unit quaternion, that a component which a partition relies on has, over the next two steps: with less, what the
iterations leave is large in the dependent parameters, and a turning frame makes it an error of all of them."""
PREFERENCE = 2.0**-6
"""Factor of the scale of Euler parameters where a partition is chosen for bodies in frames: they depend only where no
position of theirs can. The position of a hinged rotor with its centre of mass off the axis would be integrated in space
else, by several times the steps and with errors of one sign. A power of two, so that it leaves no rounding."""
FOLLOWS = 2.0 * PREFERENCE
"""By how much Euler parameters move, at least, for a scale of the position, to be worth another partition: with less
than PREFERENCE they would depend in that as well."""


@internal
def _follows_from_position(workspace: Any, i: int) -> bool:
    """Whether the Euler parameters from i on, which depend, move with an independent position of their body."""
    rhs, dependent = vec(workspace.rhs, workspace.m_act), ivec(workspace.dependent, workspace.m_act)
    values, scale = vec(workspace.values, workspace.n_values), vec(workspace.scale, workspace.n)
    free_row, free_col = ivec(workspace.free_row, workspace.n_free), ivec(workspace.free_col, workspace.n_free)
    for d in range(workspace.m_act):
        rhs[d] = 0.0
    own = False
    for e in range(workspace.n_free):
        l = free_col[e]
        if i - 3 <= l < i:
            own = True
            # in no simple ratio, so that they do not cancel
            weight = scale[l] * (1.0 - 0.2360679774997897 * (i - 1 - l))
            rhs[free_row[e]] += weight * values[ivec(workspace.free_slot, workspace.n_free)[e]]
    if not own:
        return False
    solve(lu_at(workspace.lu_d), workspace.rhs)
    moved = 0.0
    for d in range(workspace.m_act):
        if 0 <= dependent[d] - i < 4:
            moved = max(moved, abs(rhs[d]))
    return moved > FOLLOWS


@compiled
def prefer_attitudes(workspace: Any, method: Any, factor: float) -> bool:
    """Multiply the scales of Euler parameters in turning frames by `factor`; whether there are some. Who chooses a
    partition for the newest row of the history does so with PREFERENCE before, and with its inverse after."""
    if workspace.n_attitudes == 0 or vec(method.parameters, 8)[ESTIMATE] == 0.0 or rows_available(method) < 2:
        return False
    count, scale = choose_frames(workspace, method, history_time(method, 0)), vec(workspace.scale, workspace.n_ext)
    for k in range(count):
        i = ivec(workspace.spinning, count)[k]
        for j in range(4):
            scale[i + j] *= factor
    return count > 0


@internal
def partition_ends(workspace: Any, h: float) -> bool:
    """Whether the Euler parameter that follows from the norm, or the one that the others follow from (as with a hinge),
    passes zero within two steps of size h, while another one does not; or whether all four follow from the body's
    position, and the other way round would do."""
    dependent = ivec(workspace.dependent, workspace.m_act)
    for k in range(workspace.n_spins):
        i, spin = ivec(workspace.spinning, workspace.n_spins)[k], mat(workspace.spin, workspace.n_spins, SPIN_SIZE)[k]
        count, which = 0, 0
        for d in range(workspace.m_act):
            if 0 <= dependent[d] - i < 4:
                count += 1
                which += dependent[d] - i
        if count == 4 and _follows_from_position(workspace, i):
            return True
        p, rate = spin[POINT : POINT + 4], spin[POINT + 4 : POINT + 8]
        speed = np.sqrt(rate[0] * rate[0] + rate[1] * rate[1] + rate[2] * rate[2] + rate[3] * rate[3])
        if speed == 0.0 or (count != 1 and count != 3):
            continue
        across, along = np.cos(2.0 * h * speed), np.sin(2.0 * h * speed)
        relied, best = 0.0, 0.0
        for j in range(4):
            now, soon = p[j], across * p[j] + along * rate[j] / speed
            if count == 3:
                now, soon = rate[j] / speed, across * rate[j] / speed - along * p[j]
            least = min(abs(now), abs(soon)) if now * soon > 0.0 else 0.0
            best = max(best, least)
            if j == (which if count == 1 else 6 - which):
                relied = least
        if relied < LEAST_PART and 2.0 * relied < best:
            return True
    return False
