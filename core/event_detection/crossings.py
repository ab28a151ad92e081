"""The watch over contacts: has the step just computed crossed an event?"""

from typing import Any

from ..assembly.levels import force_level, position_level, position_level_at, rate_size
from ..assembly.sticking_force import friction_limit, held_friction, implied_margin, is_held
from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, mat, vec
from ..methods.history import history_row
from ..rounding import FORCE_ROUNDING, GAP_MOVES, GAP_ROUNDING, RATE_ROUNDING, SLIP_EXCESS
from ..state.modes import ACTIVE, AT_ZERO_FORCE, CLOSED, IDLE, OPEN, RELEASED, memories_at
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
def remember(workspace: Any, loop: Any) -> None:
    """Store gap, rate and acceleration of the current point as those of the newest row; with friction those of the
    sliding distance too."""
    watch = mat(loop.watch, max(workspace.n_contacts, 1), WATCH)
    rows, slides = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
    )
    looked = ivec(workspace.looked, workspace.n_contacts + 1)
    for p in range(looked[0]):
        k = looked[p + 1]
        if slides[k] >= 0:
            watch[k, 3] = vec(workspace.phid, workspace.m_ext)[slides[k]]
            watch[k, 4] = vec(workspace.phidd, workspace.m_ext)[slides[k]]
        watch[k, 0] = vec(workspace.phi, workspace.m_ext)[rows[k]]
        watch[k, 1] = vec(workspace.phid, workspace.m_ext)[rows[k]]
        watch[k, 2] = vec(workspace.phidd, workspace.m_ext)[rows[k]]


@compiled
def friction_margin(workspace: Any, k: int) -> float:
    """How far closed contact k with Coulomb friction is from its next change, negative beyond it: mu_s F_N - |F_T|
    while it sticks (N); its sliding velocity in the direction of sliding while it slides (m/s)."""
    memory = memories_at(workspace.memory, workspace.n_contacts)[k]
    row = ivec(workspace.contact_slide_rows, workspace.n_contacts)[k]
    if is_held(workspace, k):
        friction = held_friction(workspace, k, vec(workspace.lam, workspace.m_ext))
        return friction_limit(workspace, k, vec(workspace.monitor, workspace.n_contacts)[k]) - friction
    if memory.slide_mode == IDLE:
        return 0.0
    return memory.slide_mode * vec(workspace.phid, workspace.m_ext)[row]


@internal
def no_sliding(workspace: Any, k: int) -> float:
    """Rounding of the sliding velocity of contact k, m/s: what decides at events (`reading.py`) takes the same for
    none, or a contact that this sees turn, and that does not, has its event for ever."""
    return RATE_ROUNDING * rate_size(workspace, k)


@internal
def _ends_beyond(workspace: Any, loop: Any, k: int, none: float) -> bool:
    """True if the point at the end of a step shows that contact k has had an event; a force whose work along the
    scale of its row is below `none` (J) is none."""
    mode = memories_at(workspace.memory, workspace.n_contacts)[k].mode
    row = ivec(workspace.contact_rows, workspace.n_contacts)[k]
    g, rate = vec(workspace.phi, workspace.m_ext)[row], vec(workspace.phid, workspace.m_ext)[row]
    force = vec(workspace.monitor, workspace.n_contacts)[k]
    release = ivec(workspace.contact_release, workspace.n_contacts)[k]
    size = vec(workspace.row_scale, workspace.m_ext)[row]
    if mode == OPEN:
        if g >= 0.0:
            return False
        # shapes that touch and neither part nor press drift by rounding only; those that a method without position
        # constraints has let overlap before they opened may come apart
        if rate < -RATE_ROUNDING * rate_size(workspace, k):
            return True
        overlap, before = (
            GAP_ROUNDING * position_level(workspace) * size,
            mat(loop.watch, workspace.n_contacts, WATCH)[k, 0],
        )
        # a gap that others hold near this limit stays where it is, and the limit moves with the coordinates
        return g < -overlap <= before and before - g > GAP_MOVES * overlap
    if mode == CLOSED:
        no_force = none / size
        if force < -no_force:
            return True
        if vec(workspace.contact_sticking, workspace.n_contacts)[k] == 0.0:
            return False
        if is_held(workspace, k):
            limit = vec(workspace.contact_sticking, workspace.n_contacts)[k] * force
            return friction_margin(workspace, k) < -max(no_force, SLIP_EXCESS * limit)
        return friction_margin(workspace, k) < -no_sliding(workspace, k)
    if mode == ACTIVE:
        return g > 0.0 or (release >= AT_ZERO_FORCE and force < 0.0)
    if mode == RELEASED:
        return g > 0.0 or force > 0.0
    return False


@internal
def _event_inside(workspace: Any, method: Any, loop: Any, k: int, h: float, none: float) -> bool:
    """True if contact k has an event within the step of size h that ends at the current point; then its line of
    `brackets` says where (`certain.first_root`)."""
    ended = _ends_beyond(workspace, loop, k, none)
    bracket, start = (
        mat(loop.brackets, workspace.n_contacts, BRACKET)[k],
        mat(loop.watch, workspace.n_contacts, WATCH)[k],
    )
    bracket[0], bracket[1], bracket[2] = 0.0, 1.0, 1.0
    mode = memories_at(workspace.memory, workspace.n_contacts)[k].mode
    row = ivec(workspace.contact_rows, workspace.n_contacts)[k]
    g = vec(workspace.phi, workspace.m_ext)[row]
    if mode == CLOSED and not ended and method.exact != 0 and implied_margin(workspace, k, start[2]) <= 0.0:
        return True
    if mode == CLOSED and not ended and vec(workspace.contact_sticking, workspace.n_contacts)[k] > 0.0:
        return sliding_turns(workspace, method, loop, k, h, no_sliding(workspace, k))
    if mode != OPEN and mode != ACTIVE:
        return ended
    sign = 1.0 if mode == OPEN else -1.0
    # what is there already when the step begins, and what ends by its force, has its event at the end
    if ended and sign * g >= 0.0:
        return True
    if not ended and (sign * g < 0.0 or sign * (start[0] + g) > way_of_gap(workspace, loop, k, 0)):
        return False
    # where the step began: shapes that fly far past each other would make what was touching then out of a clear gap
    level = position_level_at(workspace, history_row(workspace, method, 0))
    overlap = GAP_ROUNDING * level * vec(workspace.row_scale, workspace.m_ext)[row]
    if sign * start[0] < -overlap:
        return ended
    slack = (1.0 + GAP_MOVES) * overlap if sign * start[0] <= overlap else 0.0
    if slack > 0.0 and method.exact == 0 and not ended:
        # forces of methods that do not meet the constraints at all levels are not those that the next row begins with:
        # what has opened by them may first press a little
        slack = PRESSES_IN * level * vec(workspace.row_scale, workspace.m_ext)[row]
    return first_root(workspace, method, loop, k, h, sign, start, ended, slack, bracket)


@compiled
def find_events(workspace: Any, method: Any, loop: Any, h: float, everyone: bool) -> bool:
    """True if any contact has an event within the step of size h that ends at the current point.

    everyone : look on after the first, so that the lines of `brackets` say which contacts have one, and where.
    """
    if workspace.n_contacts == 0:
        return False
    set_travel(workspace, method, loop, h)
    keep_watch(workspace, method, loop)
    looked = ivec(workspace.looked, workspace.n_contacts + 1)
    brackets, found, none = (
        mat(loop.brackets, workspace.n_contacts, BRACKET),
        False,
        FORCE_ROUNDING * force_level(workspace),
    )
    for p in range(looked[0]):
        k = looked[p + 1]
        inside = not sleeps_on(workspace, method, loop, k) and _event_inside(workspace, method, loop, k, h, none)
        if inside and not everyone:
            return True
        brackets[k, HAPPENS] = 1.0 if inside else 0.0
        found = found or inside
    # where all multipliers are those of the motion: of other methods, only those of the rows are known
    if (everyone or not found) and method.exact != 0 and forces_may_vanish(workspace, method, loop, h):
        found = forces_vanish(workspace, method, loop, h, none) or found
    return found
