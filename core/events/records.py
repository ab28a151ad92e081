"""The record of an instant: the contacts that touch, what is known of each, and room to work in.

All of it is scratch: an instant is settled from the state alone, and leaves behind nothing that the next one reads.
"""

from typing import Any

import numpy as np

from ..compiled import types
from ..compiled.jit import caller, internal, record_view, records_view
from ..compiled.views import mat
from ..state.method_records import METHOD_TYPE
from ..state.run_records import DRIVE_TYPE
from ..state.workspace_records import WORKSPACE_TYPE

_PER_CONTACT = (
    # before the instant
    "mode_before", "slide_mode_before", "ratio_before",
    # its event: its force is zero; it reaches its limit, in this direction; it stops
    "opens", "slips", "stops",
    "gap", "sliding_distance",           # m
    "closing_acceleration",              # with which its gap closes before any impact, m/s^2
    "gradient_size",                     # of its gap
    "rate_rounding",                     # rates below it are none, m/s
    "least_sliding_speed",               # sliding below it counts as none, m/s
    "restitution", "kinetic_friction", "static_friction",  # coefficients
    # rates of gap, sliding distance and, in space, along the second tangent, m/s; r w_n on a patch, m/s
    "gap_rate", "sliding_rate", "sliding_rate2", "spin_rate",
    # the same before the present problem of an impact
    "gap_rate_before", "sliding_rate_before", "sliding_rate2_before", "spin_rate_before",
    "spin_share",                        # part of the torque against spin at rest
    # accelerations without contact forces, and with them, m/s^2
    "free_gap_acceleration", "free_sliding_acceleration", "free_sliding_acceleration2",
    "gap_acceleration", "sliding_acceleration", "sliding_acceleration2",
    "normal_force", "friction_force", "friction_force2",  # N
    # of the present problem of an impact, N s; M/r against spin of the present round, and of all rounds
    "normal_impulse", "friction_impulse", "friction_impulse2", "problem_spin_impulse", "spin_impulse",
    # results of the impact: N s, N s, J, m/s, m/s
    "impact_impulse", "impact_friction", "impact_loss", "approach_speed", "separation_speed",
    # and of the impact with all restitution
    "first_impulse", "first_friction", "first_loss", "first_approach", "first_separation",
    "comes_to_rest",                     # 1: this impact's restitution has been left out
    "negligible_bounce",                 # 1: it has bounced by next to nothing
    "stopping_impulse", "stopping_loss",  # N s and J of what stopped without a collision
    "stopping_loss_before",              # J: before the last that stopped
    "direction_cos", "direction_sin",    # direction of sliding, from the first tangent
    "tangent_axis",                      # that angles are counted from (`contacts/frame3d.py`)
    "new_slide_mode", "new_ratio",       # what was chosen
    "firmness",                          # one over the root of its relative compliance
    "companion",                         # how far on the contact stands that shares its friction (`three_tangents.py`)
    "new_implied",                       # which of its rows others imply: `implied_rows` of `state/modes.py`
)  # fmt: skip
TOUCHING = np.dtype([(name, np.float64) for name in _PER_CONTACT])
"""What is known of one touching contact."""

SOLVER_VECTORS = (
    "part", "pressing",                  # 1: takes part in the problem; and presses, as far as is known
    "mu", "base",                        # friction coefficient and earlier normal impulse of the friction limit
    "known_direction", "undirected",     # 1: slides in a known direction; zeros
    "slides",                            # 1: slides, `contact_forces.BEGINS`: begins to
    "at_rest", "loaded", "closes",       # 1: gap and rate are zero; presses; is closed from now on
    "included", "can_slide", "turns",    # 1: has rows of its own; could slide at its limit; its force has a torque
    "unsolved",                          # 1: of a part of the mechanism whose problem is still to be solved
    "pressed", "slow",                   # 1: has an impulse; hardly slides (`velocity_level_modes.py`)
    "jerks",                             # rates of the gaps' accelerations, m/s^3
)  # fmt: skip
"""Arrays (most,) float64 of INSTANT that solvers take: one number of each touching contact."""

SCALARS = np.dtype(
    [
        (name, np.int64)
        for name in (
            "count",                     # contacts that touch
            "struck",                    # 1: there has been an impact
            "failed_contact",            # that a failure is of; -1: none
            "accelerations_known",       # 1: accelerations without contact forces have been found
            "without_restitution",       # 1: impacts are without restitution where `negligible_bounce` says so
            "contact_torques",           # 1: forces of contacts have torques against turning with them
            "touched", "touched_in_space",  # contacts that touch, once the instant has been decided
            "in_rounds",                 # 1: contacts were struck one round after another (`impact_retries.py`)
            "unshared_contact",          # number, from 1 on, of one whose load was not shared (`rates.py`); 0: none
            "approaching_contact",       # the same where an approach has been left (`residual_approach.py`)
            "short_of",                  # what there is too little room of (`OF_CONTACTS` ...)
        )
    ]
    + [
        (name, np.float64)
        for name in (
            "no_acceleration",           # accelerations below it are none, m/s^2
            "approach_left",             # by the impact, in units of `rate_rounding`
            "constraint_residual",       # change of the joints' rates by the impact, m/s
            "acceleration_scale",        # largest acceleration before, m/s^2; 0 after an impact
            "rank_tolerance",            # part of a direction's inverse mass that others must leave of it
            "sweeps",                    # of the last step of impulses
            "projection_loss",           # energy that bringing the motion onto new constraints took, J: in no account
            "largest_rate",              # of a row before its impulse, m/s
        )
    ]
)  # fmt: skip
"""What is known of the instant as a whole."""

INSTANT = np.dtype(
    [
        (name, np.int64)
        for name in (
            "most",                      # touching contacts that there is room for
            "most_decided",              # and for the problem of an instant that is decided at once
            # addresses of these functions
            "open_touching", "strike", "begin_rest", "find_forces", "keep", "use_modes", "settle_forces", "push_apart",
            "step_through",
            # record of `contact_solvers/planar_contacts.py`; addresses of functions
            "cones", "solve_cones", "independent", "farthest",
            "contacts",                  # (most,) int64: which touch
            "table", "scalars",          # (most,) TOUCHING, (1,) SCALARS
            *SOLVER_VECTORS,
            # (2 most_decided, 2 most_decided) float64: inverse effective masses, normals first
            "a",
            # (4 most_decided, n) float64: gradients, and the motions that unit impulses cause
            "directions", "responses",
            "some", "chosen", "order",   # (2 most,) int64, in space (3 most,)
            "kept_memory",               # (n_contacts, MEMORY_SIZE) float64
            "kept_rate", "kept_counters",  # (RATE_SIZE,) float64, (COUNTERS_SIZE,) int64
            "velocities", "bounced",     # (n_ext,) float64
            "noise", "sum", "terms",     # (n_ext,) float64
            "joint_rates",               # (m_ext,) float64
            "matrix",                    # (2 most_decided, 2 most_decided + 2) float64
            "work", "work_size",         # float64
            "row_wholes", "row_reals",   # int64 and float64: see `prepare.py`
            "rows_space",
            "slots_work",                # (entries of the block of the mass matrix, at most) float64
            "modes",                     # (n_contacts,) float64: before the instant
            "unsettled",                 # (n_contacts,) int64
            "massless_rates",            # (n_contacts,) float64
            # in space: inverse effective masses, motion and forces of 3 most_decided rows, room for their solution
            "space_a", "space_b", "space_p", "space_room", "pressing_a", "torques",
            "space_kept",                # the last problem that was solved, and its forces (`rates.py`)
            "columns",                   # (n,) int64
            "sweeps",                    # room for `moreau_jean_step.py`
            "opening_wholes", "opening_reals",  # and for `row_blocks.py`
            # blocks of `contact_solvers/contact_blocks.py`, for this many coordinates of each contact
            "block_wholes", "block_reals", "block_coordinates",
        )
    ]
)  # fmt: skip
INSTANT_TYPE = types.from_dtype(INSTANT)
PART_SIGNATURE = types.int64(INSTANT_TYPE, DRIVE_TYPE, WORKSPACE_TYPE, METHOD_TYPE)
call_part = caller(PART_SIGNATURE)
"""call_part(address, instant, drive, workspace, method): the larger parts are called by address, so that each is
compiled once and not again inside each caller."""
instant_at = record_view(INSTANT_TYPE)
_touching_at, _scalars_at = records_view(types.from_dtype(TOUCHING)), record_view(types.from_dtype(SCALARS))

# what there is too little room of, where an instant wants some
OF_ELIMINATION, OF_CONTACTS, OF_DECIDED, OF_BLOCKS = range(4)

# what settling an instant returns
SETTLED = 0
DECLINED = 1  # nothing has happened: Python settles it
WANTS_ROOM = 2  # nothing has happened; Python gives more room for what touches, and it is settled anew
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
NO_SLOT = 22


@internal
def touching(instant: Any) -> Any:
    """The touching contacts, (most,) TOUCHING."""
    return _touching_at(instant.table, instant.most)


@internal
def scalars(instant: Any) -> Any:
    """SCALARS of the instant."""
    return _scalars_at(instant.scalars)


@internal
def delassus(instant: Any, count: int) -> Any:
    """Inverse effective masses (2 count, 2 count): normals first."""
    return mat(instant.a, 2 * count, 2 * count)


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
