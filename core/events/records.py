"""The record of an instant: the contacts that touch, what is known of each, and room to work in.

All of it is scratch: an instant is settled from the state alone, and leaves behind nothing that the next one reads.
"""

from typing import Any

import numpy as np

from ..compiled import types
from ..compiled.jit import caller, internal, record_view
from ..compiled.views import ivec, mat, vec
from ..state.method_records import METHOD_TYPE
from ..state.run_records import DRIVE_TYPE
from ..state.workspace_records import WORKSPACE_TYPE

INSTANT = np.dtype(
    [
        (name, np.int64)
        for name in (
            "most",                      # touching contacts that there is room for
            # addresses of these functions
            "open_touching", "strike", "begin_rest", "find_forces", "keep", "use_modes", "settle_forces", "push_apart",
            "step_through",
            # record of `contact_solvers/planar_contacts.py`; addresses of functions
            "cones", "solve_cones", "independent", "farthest",
            "contacts",                  # (most,) int64: which touch
            "table",                     # (COLUMNS, most) float64: of each of them
            "reals", "wholes",           # (REALS,) float64, (WHOLES,) int64
            "a",                         # (2 most, 2 most) float64: inverse effective masses, normals first
            # (2 most, n) float64, in space (6 most, n): gradients, and the motions that unit impulses cause
            "directions", "responses",
            "some", "chosen", "order",   # (2 most,) int64, in space (3 most,)
            "kept_memory",               # (n_contacts, MEMORY_SIZE) float64
            "kept_rate", "kept_counters",  # (RATE_SIZE,) float64, (COUNTERS_SIZE,) int64
            "velocities", "bounced",     # (n_ext,) float64
            "noise", "sum", "terms",     # (n_ext,) float64
            "joint_rates",               # (m_ext,) float64
            "matrix",                    # (2 most, 2 most + 2) float64
            "work", "work_size",         # float64
            "row_wholes", "row_reals",   # int64 and float64: see `prepare.py`
            "rows_space",
            "slots_work",                # (entries of the block of the mass matrix, at most) float64
            "modes",                     # (n_contacts,) float64: before the instant
            "unsettled",                 # (n_contacts,) int64
            "massless_rates",            # (n_contacts,) float64
            # in space: inverse effective masses (3 most, 3 most), motion and forces (3 most,), room for their solution
            "space_a", "space_b", "space_p", "space_room", "pressing_a", "torques",
            "space_kept",                # the last problem that was solved, and its forces (`rates.py`)
            "sweeps", "columns",         # room for `impulse_step.py`: float64 and int64
            "block_wholes", "block_reals",  # and for `contact_solvers/contact_blocks.py`
        )
    ]
)  # fmt: skip
INSTANT_TYPE = types.from_dtype(INSTANT)
PART_SIGNATURE = types.int64(INSTANT_TYPE, DRIVE_TYPE, WORKSPACE_TYPE, METHOD_TYPE)
call_part = caller(PART_SIGNATURE)
"""call_part(address, ev, dr, ws, ms): the larger parts are called by address, so that each is compiled once and not
again inside each caller."""
instant_at = record_view(INSTANT_TYPE)

# rows of `table`, each (most,)
(
    WAS, SLID, OLD_RATIO,              # mode, SLIDE and RATIO before
    LEAVES, SLIPS, STOPS,              # its event: its force is zero; it reaches its limit, in this direction; it stops
    FALLS,                             # acceleration with which its gap closes before any impact, m/s^2
    GAP, SLIDE_VALUE,                  # m
    ROUNDING,                          # rates below it are none, m/s
    RESTITUTION, KINETIC, STATIC,      # coefficients
    RATE, SLIDE_RATE,                  # of gap and sliding distance, m/s
    KNOWN, AT_REST, TAKES, DIRECTION,
    B_N, B_T, SIZE,                    # accelerations without contact forces, m/s^2; size of the gap's gradient
    F_N, F_T, W_N, W_T,                # forces and the accelerations with them
    CLOSES, NEW_SLIDE, NEW_RATIO,      # what was chosen
    IMPULSE, FRICTION, LOSS, APPROACH, SEPARATION,  # of the impact
    P_N, P_T, PART, MU, BASE, RESTS, LOW,
    FIRST_IMPULSE, FIRST_FRICTION, FIRST_LOSS, FIRST_APPROACH, FIRST_SEPARATION,  # of the impact with all restitution
    RATE_BEFORE, SLIDE_BEFORE,
    FLAG, OTHER_FLAG, SPARE, LOADED,
    SLOW,                              # sliding below it counts as none, m/s
    STOP_IMPULSE, STOP_LOSS,           # N s and J of what stopped without a collision
    FIRST,                             # the higher, the earlier its tangent is kept where some repeat others
    # in space, along the second tangent: rate, free acceleration, force and acceleration with it, impulse, rate before
    SWAY_RATE, B_S, F_S, W_S, P_S, SWAY_BEFORE,
    COS_WAY, SIN_WAY,                  # direction of sliding, from the first tangent
    AXIS_NOW,                          # that angles are counted from (`contacts/frame3d.py`)
    LOST_BEFORE,                       # J: of STOP_LOSS, before the last that stopped
    SPIN, HELD_SPIN,                   # r w_n on a patch, m/s; part of the torque against it at rest
    ZETA, P_SPIN, SPIN_BEFORE,         # impulse M/r against it, N s: of one problem, of a blow; the spin before, m/s
    NEW_IMPLIED,                       # which of its rows others imply: IMPLIED of `state/modes.py`
    LEFT_OVER,                         # 1: of a part of the mechanism whose problem is still to be solved
    FIRMNESS,                          # one over the root of its relative compliance
    COMPANION,                         # how far on the contact stands that shares its friction (`three_tangents.py`)
) = range(75)  # fmt: skip
COLUMNS = 75

# entries of `reals`
NONE, LEFT, RESIDUAL, ACCELERATIONS, RANK = range(5)
SWEPT = 5  # sweeps of the last step of impulses
MET_LOSS = 6  # energy that bringing the motion onto new constraints has taken, J: in no account
LARGEST = 7  # rate of a row before its impulse, m/s
REALS = 8
# entries of `wholes`
COUNT = 0  # contacts that touch
STRUCK = 1
WHO = 2  # the contact that a failure is of
READY = 3  # accelerations have been looked at
WITHOUT = 4  # 1: impacts are without restitution where `LOW` says so
TURNS = 5  # 1: forces of contacts have torques against turning with them
TOUCHED = 6  # contacts that touch, once the instant has been decided
ALONE = 7  # 1: of the inverse masses of what is opened the diagonal alone is wanted
TOUCHED_IN_SPACE = 8  # of TOUCHED, those with two tangents
IN_ROUNDS = 9  # 1: the impact's contacts were struck one round after another (`impact_rounds.py`)
UNSHARED = 10  # number, from 1 on, of a contact whose load has not been shared (`rates.py`); 0: none
STILL_APPROACHES = 11  # the same where an approach has been left (`residual_approach.py`)
WHOLES = 12

# what settling an instant returns
SETTLED = 0
DECLINED = 1  # nothing has happened: Python settles it
WANT_ROOM = 2  # nothing has happened; Python gives more room for what touches, and it is settled anew
WANT_MEMORY = 3  # the same, for structures and the factors of their matrices
SINGULAR_JOINTS = 10
IMMOVABLE_CONTACT = 11
NO_IMPACT = 12
ENDLESS_ROUNDS = 13
ENDLESS_BLOWS = 14
NO_FORCES = 15
JAMS = 16
NOT_MET = 17
NO_ACCELERATIONS = 18
REPEATED_ROWS = 19
SINGULAR_MATRIX = 20
NO_FREE_ACCELERATIONS = 21


@internal
def col(ev: Any, k: int) -> Any:
    """Row k of the table."""
    return vec(ev.table + 8 * k * ev.most, ev.most)


@internal
def whole(ev: Any) -> Any:
    """The integers."""
    return ivec(ev.wholes, WHOLES)


@internal
def real(ev: Any) -> Any:
    """The numbers."""
    return vec(ev.reals, REALS)


@internal
def delassus(ev: Any, count: int) -> Any:
    """Inverse effective masses (2 count, 2 count): normals first."""
    return mat(ev.a, 2 * count, 2 * count)


@internal
def copy(to: Any, given: Any, n: int) -> None:
    """The first n numbers of `given` to `to`. (Slices take numba ten times as long to compile.)"""
    for i in range(n):
        to[i] = given[i]


@internal
def clear(x: Any, n: int) -> None:
    """Zeros to the first n numbers."""
    for i in range(n):
        x[i] = 0
