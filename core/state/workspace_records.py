"""The workspace record: sizes and addresses of everything that the compiled loop works on."""

import numpy as np

from ..compiled import types
from ..compiled.jit import caller, record_view
from ..compiled.records import fields_of
from ..linalg.record import OK as OK
from ..linalg.record import WANT_ROOM as WANT_ROOM  # also what building a structure returns

WORKSPACE = np.dtype(
    [
        (name, np.int64)
        for name in (
            # sizes
            "n", "n_ext", "m_ext", "m_act", "m_held", "n_implied", "n_kernels", "n_values", "n_contacts", "n_work",
            "row_length",
            # the current point
            "t", "q", "v", "a", "aux", "lam", "r", "phi", "phid", "phidd",
            "values", "coef", "energy", "monitor", "memory", "inputs",
            # model
            "kernels", "batches", "evaluate_function", "stage_function", "analyze", "contact_rows", "contact_release",
            "contact_slide_rows", "contact_second_rows", "contact_sticking",
            "contact_companion",  # (contacts,) int64: how far on the one stands that shares its friction; 0: none
            # (contacts,) int64: 1 where a contact is not evaluated (`event_detection/contact_sleeping.py`)
            "sleeping",
            # (contacts,) codes of `structure_switch.py`; the present structure, and one not to be given up (0: none)
            "wanted", "structure", "kept",
            "wanted_dependent",  # (m_act,) int64: the partition that has been chosen
            # the BUILDING record of `assembly/building.py`, and the function that takes the wanted structure
            "building", "engage",
            # structure (changes with the set of engaged contacts)
            "active", "redundant", "n_redundant", "probe",
            "dependent", "free_row", "free_col", "free_slot", "n_free", "kkt", "lu_d", "lu_p", "kkt_query",
            # gradients of contacts that are no constraints now, by row of Phi; the block of the mass matrix
            "gradient_start", "gradient_col", "gradient_slot", "entry_row", "entry_col", "mass_slot", "n_mass",
            # stage solver
            "q_star", "v_star", "base_q", "base_v", "base_a", "stage_v", "stage_a", "stage_rows", "rhs",
            "weight_q", "weight_v", "control", "counters", "rate", "scale", "scratch", "atol_q", "atol_v",
            # sizes of rows of Phi, of work accounts, and of coordinates for levels: (m_ext,), (n_ext,), (n,)
            "row_scale", "work_scale", "level_scale",
            "query_kept",  # (2 n + 2 m_ext,) pivots that a query puts back (`event_detection/repivoting.py`)
            # vectors of an accelerated fixed point or of a Krylov method: (n_basis, n_ext)
            "basis", "n_basis",
            # 1: the constraints are so much cheaper to evaluate than the residuals that it is done without these
            "part_first",
            # (n_contacts + 1,) int64: how many contacts do not sleep deeply, and which
            # (`event_detection/broad_phase.py`)
            "looked",
            # the first of the Euler parameters of each body that may be in a turning frame (`stage/corotating.py`),
            # (n_attitudes,) int64; for the time of a step those which are, (n_spins,) int64, their frames,
            # (n_spins, SPIN_SIZE), and the history in these; and the function that solves their stages in space
            # ; kernel and element of the inertia that turns with them, (n_attitudes, 2) int64, -1 where there is more
            "n_attitudes", "attitudes", "attitude_bodies", "n_spins", "spinning", "spin", "turned", "plain_stage",
            # (n_slots,) int64: the pairs that have the slots of contact pools (`pool_records.py`)
            "n_slots", "slot_pair",
            # force that the stages of comparison methods subtract from r: (n_ext,)
            "offset",
        )
    ]
)  # fmt: skip
WORKSPACE_TYPE = types.from_dtype(WORKSPACE)

STRUCTURE = np.dtype(
    [
        (name, np.int64)
        for name in (
            # what the workspace takes over, under the same names
            "n_values", "values", "m_act", "m_held", "n_implied", "active", "n_redundant", "redundant", "probe",
            "gradient_start", "gradient_col", "gradient_slot", "entry_row", "entry_col", "n_mass", "mass_slot",
            "kkt", "kkt_query",
            "codes",                                  # (contacts,) int64: which it is for (`structure_switch.py`)
            "dropped",                                # and for which set of rows that are left out (a number)
            "slots",                                  # (4 n_kernels,) int64: addresses of the batches' slot tables
            "nnz",                                    # entries of the matrix
            # Phi_q by rows, of the active ones
            "n_jacobian", "jacobian_start", "jacobian_row", "jacobian_col", "jacobian_slot",
            # rows of compatibility: where each begins, (n_implied + 1,); which are found by the same solution,
            # (n_implied,); places of the multipliers that they are of, slots, numbers, (n_sharing,)
            "n_sharing", "sharing_start", "sharing_color", "sharing", "sharing_slot", "compatibility",
            "sharing_kept",                           # those numbers while a point is asked for
            "partition",                              # address of its PARTITION record
            "built", "serial", "used",                # 1: it is one; a number that no other has; when it was taken last
            # memory for its integers and its numbers, and how many there is room for
            "words", "words_room", "reals", "reals_room",
        )
    ]
)  # fmt: skip
STRUCTURE_TYPE = types.from_dtype(STRUCTURE)

PARTITION = np.dtype(
    [
        (name, np.int64)
        for name in (
            "dependent", "n_free", "free_row", "free_col", "free_slot", "lu_d", "lu_p",
            "used_p",           # of lu_d and lu_p the one for positions
            "ready", "serial",  # 1: it is one; a number that no other has
            "words", "reals",   # memory that is enough for any
        )
    ]
)  # fmt: skip
PARTITION_TYPE = types.from_dtype(PARTITION)

BUILDING = np.dtype(
    [
        (name, np.int64)
        for name in (
            "n", "m", "m_joints", "m_ext", "n_contacts", "n_kernels",
            # by batch: the contact of each element (-1: none), the local places (i, j) of its entries in S and in
            # Phi_q, each with where those of a batch begin, and whether it is one of contacts (`patterns.py`)
            "element_contact", "element_start", "s_pattern", "s_start", "j_pattern", "j_start", "of_contacts",
            "listed",                                   # (contacts,) int64: 1: its rows' gradients are always listed
            "n_replaced", "replaced_row", "replaced_contact",  # rows that closed contacts take the place of
            "left_out", "dropped",                      # (m_ext,) int64: 1 for redundant rows; number of this set
            # (m_ext,): relative compliance of each row; number of the mechanism that the row of a joint is of
            "compliance", "mechanism",
            "loads_felt",                               # 1: forces depend on the loads of joints
            "contact_rows", "contact_slide_rows", "contact_second_rows",  # (contacts,) int64; -1: none
            "rate_rows", "two_partitions",              # (m_ext,) int64: 1 for velocity-level rows; 1: there are some
            "units",                                    # (n + m_ext,) what brings coordinates and rows to one unit
            "dense_limit",
            "scratch",                                  # as in LU
            "needs",                                    # (NEEDS,) int64: room that there must be
            "n_slots", "structures",                    # addresses (n_slots,) of STRUCTURE records
            "serial",                                   # the last number that was given
        )
    ]
)  # fmt: skip
BUILDING_TYPE = types.from_dtype(BUILDING)
OF_KKT, OF_D, WORDS, REALS = 0, 3, 6, 7
"""Entries of `needs`: three of the matrices of the equations and three of Phi_qd (`linalg/record.py`), and two of the
structures themselves."""
NEEDS = 8
ENGAGE_SIGNATURE = types.int64(WORKSPACE_TYPE)
call_engage = caller(ENGAGE_SIGNATURE)
building_at = record_view(BUILDING_TYPE)
structure_at, partition_at = record_view(STRUCTURE_TYPE), record_view(PARTITION_TYPE)

# Called by address, so that their code is compiled once and not again inside each caller.
EVALUATE_SIGNATURE = types.void(WORKSPACE_TYPE, types.int64)
STAGE_SIGNATURE = types.int64(WORKSPACE_TYPE, types.float64, types.float64, types.float64)
call_evaluate = caller(EVALUATE_SIGNATURE)
call_stage = caller(STAGE_SIGNATURE)

COUPLED_STAGES = 3
"""Rows of `stage_rows`: the most stages that are solved together."""

SPIN_SIZE = 120
"""Numbers of a turning frame."""
SERIES, SCRATCH_SIZE = 64, 414
"""Where in `scratch` the series of a free rotation begins (`stage/free_rotation.py`), and how many numbers it has."""

# The records below are parts of the workspace's arrays; all of their fields are numbers of 8 bytes.

CONTROL = np.dtype(
    [
        (name, np.float64)
        for name in (
            "newton_tolerance", "position_tolerance", "velocity_tolerance", "acceleration_tolerance",
            "max_outer", "max_inner",
            "acceleration",                # of the simple iteration: 0 none, 1 Aitken, m + 1 Anderson of depth m
            "rtol", "atol",                # the latter of the work accounts, relative to their scales
            "stage_alpha", "stage_beta",   # parameters of the stage functions of comparison methods
            "outer_loop",                  # 0: Newton, 1: the fixed point, 2: another
            # growth of the condition of the constraints beyond which a position counts as nearly singular
            "most_condition",
            # at most 1: how much more exactly than they must the constraints are solved, if rounding allows it
            "exactness",
            "is_linear",                   # 1: linear equations: one iteration with their own matrices solves them
            "rate_scale",                  # inverse of the model's own time, 1/s
            "energy_scale",                # work of its forces along its lengths, J
            "stiffness_scale",             # square of the rate of its fastest vibration, 1/s^2
            "most_slack",                  # how many times looser the inner loop may be while the outer one moves
        )
    ]
)  # fmt: skip
"""Tolerances, limits and scales of the solver, which a run does not change: the array `control`."""

CONVERGENCE = np.dtype(
    [
        (name, np.float64)
        for name in (
            "outer_rate",
            "factor_age",                  # stages since the last factorisation; < 0: there is none
            "factor_cv",                   # its c_v, for formulas that solve coupled stages themselves
            "last_outer", "last_inner", "failed_norm",
            "sensitivity",                 # |dq_d/dq_i| at the last factorisation, scaled
            "first_sensitivity",           # the same when the partition was chosen; < 0: not known yet
            "correction",                  # |h M^-1 Phi_q^T mu| of the last stage of the stabilised index-2 form
            # of the constraints at the last factorisation: size of the motion that a unit violation asks for; the least
            # of them in this structure, 0: none yet; the largest of them in the present step; that when the redundant
            # rows were last chosen, or the least since, 0: not known yet; and up to which one a singular position has
            # been looked for in vain
            "condition", "least_condition", "worst_condition", "choice_condition", "looked_condition",
        )
    ]
)  # fmt: skip
"""What the convergence tests remember, a part of the state: the array `rate`."""

COUNTERS = np.dtype(
    [
        (name, np.int64)
        for name in (
            "steps", "rejected", "outer", "inner", "factorizations", "partitions", "evaluations", "stages", "analyses",
            "krylov",
            "of_impulses",                 # steps of impulses, which are among the steps
            "impacts_in_rounds",           # see `events/impact_retries.py`
            # instants at which contacts that repeat each other have got other than the least forces
            "unshared_loads",
            "left_approaches",             # instants that have left an approach (`events/residual_approach.py`)
            "unfinished_sweeps",           # steps of impulses whose sweeps have ended at their limit
        )
    ]
)  # fmt: skip
"""What a run has counted, which decides nothing: the array `counters`."""

CONTROL_SIZE, RATE_SIZE, COUNTERS_SIZE = (x.itemsize // 8 for x in (CONTROL, CONVERGENCE, COUNTERS))
control_at, convergence_at, counters_at = (record_view(types.from_dtype(x)) for x in (CONTROL, CONVERGENCE, COUNTERS))
control_of, convergence_of, counters_of = map(fields_of, (CONTROL, CONVERGENCE, COUNTERS))
"""control_of(array): the same for Python."""

# status of stages, steps and of the loop
OUTER_DIVERGED = 1
INNER_DIVERGED = 2
SINGULAR = 3
REANALYZE = 4
NOT_FINITE = 5
OUTER_SLOW = 6
