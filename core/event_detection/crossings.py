"""The watch over contacts: has the step just computed crossed an event?"""

from typing import Any

from ..assembly.levels import force_level, position_level, position_level_at, rate_size
from ..assembly.sticking_force import friction_limit, held_friction, implied_margin, is_held
from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_row
from ..rounding import FORCE_ROUNDING, GAP_MOVES, GAP_ROUNDING, RATE_ROUNDING, SLIP_EXCESS
from ..state.modes import ACTIVE, AT_ZERO_FORCE, CLOSED, IDLE, MEMORY_SIZE, MODE, OPEN, RELEASED, SLIDE
from ..state.run_records import WATCH
from .broad_phase import keep_watch
from .contact_evaluation import BRACKET, HAPPENS, set_travel
from .contact_sleeping import sleeps_on
from .force_crossings import forces_may_vanish, forces_vanish, sliding_turns
from .root_bounds import first_root, way_of_gap

PRESSES_IN = 1e-5
"""Of a gap's size: how far shapes that have just opened may press into each other at first, by methods that do not meet
the constraints at all levels."""


@compiled
def remember(ws: Any, lc: Any) -> None:
    """Store gap, rate and acceleration of the current point as those of the newest row; with friction those of the
    sliding distance too."""
    watch = mat(lc.watch, max(ws.n_contacts, 1), WATCH)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    looked = ivec(ws.looked, ws.n_contacts + 1)
    for p in range(looked[0]):
        k = looked[p + 1]
        if slides[k] >= 0:
            watch[k, 3] = vec(ws.phid, ws.m_ext)[slides[k]]
            watch[k, 4] = vec(ws.phidd, ws.m_ext)[slides[k]]
        watch[k, 0] = vec(ws.phi, ws.m_ext)[rows[k]]
        watch[k, 1] = vec(ws.phid, ws.m_ext)[rows[k]]
        watch[k, 2] = vec(ws.phidd, ws.m_ext)[rows[k]]


@compiled
def friction_margin(ws: Any, k: int) -> float:
    """How far closed contact k with Coulomb friction is from its next change, negative beyond it: mu_s F_N - |F_T|
    while it sticks (N); its sliding velocity in the direction of sliding while it slides (m/s)."""
    memory = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k]
    row = ivec(ws.contact_slide_rows, ws.n_contacts)[k]
    if is_held(ws, k):
        friction = held_friction(ws, k, vec(ws.lam, ws.m_ext))
        return friction_limit(ws, k, vec(ws.monitor, ws.n_contacts)[k]) - friction
    if memory[SLIDE] == IDLE:
        return 0.0
    return memory[SLIDE] * vec(ws.phid, ws.m_ext)[row]


@internal
def no_sliding(ws: Any, k: int) -> float:
    """Rounding of the sliding velocity of contact k, m/s: what decides at events (`reading.py`) takes the same for
    none, or a contact that this sees turn, and that does not, has its event for ever."""
    return RATE_ROUNDING * rate_size(ws, k)


@internal
def _ends_beyond(ws: Any, lc: Any, k: int, none: float) -> bool:
    """True if the point at the end of a step shows that contact k has had an event; a force whose work along the
    scale of its row is below `none` (J) is none."""
    mode = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, MODE]
    row = ivec(ws.contact_rows, ws.n_contacts)[k]
    g, rate = vec(ws.phi, ws.m_ext)[row], vec(ws.phid, ws.m_ext)[row]
    force = vec(ws.monitor, ws.n_contacts)[k]
    release = ivec(ws.contact_release, ws.n_contacts)[k]
    size = vec(ws.row_scale, ws.m_ext)[row]
    if mode == OPEN:
        if g >= 0.0:
            return False
        # shapes that touch and neither part nor press drift by rounding only; those that a method without position
        # constraints has let overlap before they opened may come apart
        if rate < -RATE_ROUNDING * rate_size(ws, k):
            return True
        overlap, before = GAP_ROUNDING * position_level(ws) * size, mat(lc.watch, ws.n_contacts, WATCH)[k, 0]
        # a gap that others hold near this limit stays where it is, and the limit moves with the coordinates
        return g < -overlap <= before and before - g > GAP_MOVES * overlap
    if mode == CLOSED:
        no_force = none / size
        if force < -no_force:
            return True
        if vec(ws.contact_sticking, ws.n_contacts)[k] == 0.0:
            return False
        if is_held(ws, k):
            limit = vec(ws.contact_sticking, ws.n_contacts)[k] * force
            return friction_margin(ws, k) < -max(no_force, SLIP_EXCESS * limit)
        return friction_margin(ws, k) < -no_sliding(ws, k)
    if mode == ACTIVE:
        return g > 0.0 or (release >= AT_ZERO_FORCE and force < 0.0)
    if mode == RELEASED:
        return g > 0.0 or force > 0.0
    return False


@internal
def _event_inside(ws: Any, ms: Any, lc: Any, k: int, h: float, none: float) -> bool:
    """True if contact k has an event within the step of size h that ends at the current point; then its line of
    `brackets` says where (`certain.first_root`)."""
    ended = _ends_beyond(ws, lc, k, none)
    bracket, start = mat(lc.brackets, ws.n_contacts, BRACKET)[k], mat(lc.watch, ws.n_contacts, WATCH)[k]
    bracket[0], bracket[1], bracket[2] = 0.0, 1.0, 1.0
    mode = mat(ws.memory, ws.n_contacts, MEMORY_SIZE)[k, MODE]
    row = ivec(ws.contact_rows, ws.n_contacts)[k]
    g = vec(ws.phi, ws.m_ext)[row]
    if mode == CLOSED and not ended and ms.exact != 0 and implied_margin(ws, k, start[2]) <= 0.0:
        return True
    if mode == CLOSED and not ended and vec(ws.contact_sticking, ws.n_contacts)[k] > 0.0:
        return sliding_turns(ws, ms, lc, k, h, no_sliding(ws, k))
    if mode != OPEN and mode != ACTIVE:
        return ended
    sign = 1.0 if mode == OPEN else -1.0
    # what is there already when the step begins, and what ends by its force, has its event at the end
    if ended and sign * g >= 0.0:
        return True
    if not ended and (sign * g < 0.0 or sign * (start[0] + g) > way_of_gap(ws, lc, k, 0)):
        return False
    # where the step began: shapes that fly far past each other would make what was touching then out of a clear gap
    level = position_level_at(ws, history_row(ws, ms, 0))
    overlap = GAP_ROUNDING * level * vec(ws.row_scale, ws.m_ext)[row]
    if sign * start[0] < -overlap:
        return ended
    slack = (1.0 + GAP_MOVES) * overlap if sign * start[0] <= overlap else 0.0
    if slack > 0.0 and ms.exact == 0 and not ended:
        # forces of methods that do not meet the constraints at all levels are not those that the next row begins with:
        # what has opened by them may first press a little
        slack = PRESSES_IN * level * vec(ws.row_scale, ws.m_ext)[row]
    return first_root(ws, ms, lc, k, h, sign, start, ended, slack, bracket)


@compiled
def find_events(ws: Any, ms: Any, lc: Any, h: float, everyone: bool) -> bool:
    """True if any contact has an event within the step of size h that ends at the current point.

    everyone : look on after the first, so that the lines of `brackets` say which contacts have one, and where.
    """
    if ws.n_contacts == 0:
        return False
    set_travel(ws, ms, lc, h)
    keep_watch(ws, ms, lc)
    looked = ivec(ws.looked, ws.n_contacts + 1)
    brackets, found, none = mat(lc.brackets, ws.n_contacts, BRACKET), False, FORCE_ROUNDING * force_level(ws)
    for p in range(looked[0]):
        k = looked[p + 1]
        inside = not sleeps_on(ws, ms, lc, k) and _event_inside(ws, ms, lc, k, h, none)
        if inside and not everyone:
            return True
        brackets[k, HAPPENS] = 1.0 if inside else 0.0
        found = found or inside
    # where all multipliers are those of the motion: of other methods, only those of the rows are known
    if (everyone or not found) and ms.exact != 0 and forces_may_vanish(ws, ms, lc, h):
        found = forces_vanish(ws, ms, lc, h, none) or found
    return found
