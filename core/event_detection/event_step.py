"""The step that ends at the event of one contact: a gap that closes or opens, a force that ends, friction at its limit.

The dense output says between which places in the step it lies; here the motion itself decides.
"""

from typing import Any

from ..assembly.levels import position_level_at
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_row
from ..rounding import GAP_ROUNDING, PRESSING, RESOLVED_TIME, UNRESOLVED
from ..state.modes import ACTIVE, AT_ZERO_FORCE, AT_ZERO_GAP_OR_FORCE, CLOSED, OPEN, memories_at
from ..state.run_records import WATCH
from ..state.workspace_records import OK
from .roots import find_root, go_back, root_by_rate
from .trial_steps import CLOSING_ROOT, FORCE_ROOT, GAP_ROOT, OVERLAP_ROOT, trial_value

END_OF_STEP = 1e-6
"""Of a step. Methods that do not meet the constraints at all levels do not give the newest row's force (or gap rate)
in the limit of small steps: an event located this near to it lies at the row itself, and no step is made to it."""


@internal
def _by_force(
    drive: Any, workspace: Any, method: Any, loop: Any, k: int, sign: float, low: float, high: float, h: float
) -> Any:
    """(status, size, whether it happens) of an event at which a force or what friction can still hold ends."""
    if high < h:
        status, f = trial_value(drive, workspace, method, loop, k, FORCE_ROOT, sign, 0.0, high, h)
        if status != OK:
            return status, high, False
        if f > 0.0:
            return OK, high if high > END_OF_STEP * h else h, False
    status, low, high = go_back(drive, workspace, method, loop, k, FORCE_ROOT, sign, low, high, h)
    if status != OK:
        return status, low, False
    return find_root(drive, workspace, method, loop, k, FORCE_ROOT, sign, 0.0, low, high, 0.0, h)


@internal
def _begins_to_close(drive: Any, workspace: Any, method: Any, loop: Any, k: int, h: float, overlap: float) -> Any:
    """(status, size, whether it happens) of the step at which shapes that touch without force begin to close: their
    gap, zero by rounding, says so late, its acceleration says it at once, and where that jumps (a corner is passed)
    just behind."""
    status, end = trial_value(drive, workspace, method, loop, k, OVERLAP_ROOT, 1.0, overlap, h, h)
    if status != OK:
        return status, h, True
    none, a, scale = 0.0, vec(workspace.a, workspace.n), vec(workspace.scale, workspace.n)
    for i in range(workspace.n):
        none = max(none, abs(a[i]) / scale[i])
    row = ivec(workspace.contact_rows, workspace.n_contacts)[k]
    none *= PRESSING * vec(workspace.row_scale, workspace.m_ext)[row]
    before = mat(loop.watch, workspace.n_contacts, WATCH)[k, 2]
    if before > -none and vec(workspace.phidd, workspace.m_ext)[row] < -none:
        return find_root(drive, workspace, method, loop, k, CLOSING_ROOT, 1.0, none, 0.0, h, 0.0, h)
    if end <= 0.0:
        return find_root(drive, workspace, method, loop, k, OVERLAP_ROOT, 1.0, overlap, 0.0, h, 0.0, h)
    return OK, h, True


@internal
def event_step(drive: Any, workspace: Any, method: Any, loop: Any, k: int, h: float, places: Any) -> Any:
    """(status, size, True) of the step at which contact k has its event; or (status, size, False): up to that size the
    motion has none. `places`: the gap at the end of the step of size h; sizes before a root of the gap's dense output,
    beyond it, where that is deepest, and that root itself."""
    mode = memories_at(workspace.memory, workspace.n_contacts)[k].mode
    end, low, high, deepest, guess = places[0], places[1], places[2], places[3], places[4]
    if mode == CLOSED or (mode != OPEN and end <= 0.0 and high == h):
        return _by_force(
            drive, workspace, method, loop, k, 1.0 if mode == CLOSED or mode == ACTIVE else -1.0, low, high, h
        )
    sign = 1.0 if mode == OPEN else -1.0
    row = ivec(workspace.contact_rows, workspace.n_contacts)[k]
    size = (
        position_level_at(workspace, history_row(workspace, method, 0)) * vec(workspace.row_scale, workspace.m_ext)[row]
    )
    overlap = GAP_ROUNDING * size
    release = ivec(workspace.contact_release, workspace.n_contacts)[k]
    pulls = mode == ACTIVE and release >= AT_ZERO_FORCE
    start = mat(loop.watch, workspace.n_contacts, WATCH)[k]
    comes_from_afar = abs(start[0]) > overlap or sign * start[1] * guess > overlap
    if (not pulls or release == AT_ZERO_GAP_OR_FORCE) and low < guess < high and comes_from_afar:
        status, found, good = root_by_rate(
            drive, workspace, method, loop, k, sign, low, high, guess, RESOLVED_TIME * size, h
        )
        if status == OK and good and pulls and vec(workspace.monitor, workspace.n_contacts)[k] < 0.0:
            return find_root(drive, workspace, method, loop, k, FORCE_ROOT, 1.0, 0.0, 0.0, found, 0.0, h)
        if status != OK or good:
            return status, found, good
    if high < h:
        status, g = trial_value(drive, workspace, method, loop, k, GAP_ROOT, sign, 0.0, high, h)
        if status != OK:
            return status, high, False
        if g > 0.0:
            # the motion is behind its dense output: look where that goes deepest
            low, beyond = high, False
            if low < deepest < h:
                status, g = trial_value(drive, workspace, method, loop, k, GAP_ROOT, sign, 0.0, deepest, h)
                if status != OK:
                    return status, deepest, False
                beyond = g <= 0.0
            if beyond:
                high = deepest
            elif sign * end <= 0.0:
                high = h
            else:
                # what the dense output has shown is its own error; the very start of the step is no place to stop at
                return OK, max(low, deepest) if low > END_OF_STEP * h else h, False
    status, low, high = go_back(drive, workspace, method, loop, k, GAP_ROOT, sign, low, high, h)
    if status != OK:
        return status, low, False
    # one that drifts by rounding may have gone a little beyond what is rounding of the gap
    if mode == OPEN and -UNRESOLVED * size <= start[0] <= overlap:
        status, g = OK, mat(loop.watch, workspace.n_contacts, WATCH)[k, 0]
        if low > 0.0:
            status, g = trial_value(drive, workspace, method, loop, k, GAP_ROOT, sign, 0.0, low, h)
        if status != OK:
            return status, low, False
        if g <= overlap:
            return _begins_to_close(drive, workspace, method, loop, k, h, max(overlap, 0.5 * overlap - start[0]))
    status, opened, happens = find_root(
        drive, workspace, method, loop, k, GAP_ROOT, sign, 0.0, low, high, RESOLVED_TIME * size, h
    )
    if status == OK and happens and pulls and vec(workspace.monitor, workspace.n_contacts)[k] < 0.0:
        # the gap opens within this step, but the force has become tensile before
        return find_root(drive, workspace, method, loop, k, FORCE_ROOT, 1.0, 0.0, 0.0, opened, 0.0, h)
    return status, opened, happens
