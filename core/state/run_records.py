"""The loop record: clock, sample buffer and what the watch over contacts remembers."""

import numpy as np

from ..compiled import types
from ..compiled.jit import caller, record_view
from ..compiled.records import fields_of
from .method_records import METHOD_TYPE
from .workspace_records import WORKSPACE_TYPE

LOOP = np.dtype(
    [
        (name, np.int64)
        for name in (
            "step", "starter", "rows",          # addresses of the step functions, rows that `step` needs
            "fine_starter",                     # address of the one-step function of trial steps
            "find_events", "accelerations",     # addresses of the watch over contacts and of `solve_accelerations`
            "select",                           # address of the function that chooses the order; 0: none
            "clock",                            # (CLOCK_SIZE,) float64
            "leap",                             # (n,) float64: how far a step may move each coordinate
            "watch",                            # (n_contacts, WATCH) float64: what `remember` says of the newest row
            "near", "probes",                   # (n_contacts, NEAR_SIZE) int64, and a BATCH for each contact
            *(f"probe_{name}" for name in ("q", "v", "a", "r", "lam", "phi", "phid", "phidd", "monitor", "sleeping")),
            "probe_values", "probe_places", "probe_nowhere",  # and where the entries of a contact's tangent go
            "only_impulses",                    # 1: all steps of the run are steps of impulses
            "may_sleep",                        # 1: contacts may fall asleep (`contact_sleeping.py`)
            "margin",                           # (n_contacts,) float64: of those that do
            "travel",                           # (2, n_ext) float64: bounds of the coordinates' ways within a step
            "brackets",                         # (n_contacts, BRACKET) float64: where in a step events are
            # the broad phase (`broad_phase.py`): balls around shapes, where they were at the last sweep, and in which
            # order; by ball the others, the contacts between both, and whether it is their second; the last sweep that
            # has found each contact (-1: it is always looked at)
            "n_balls", "balls", "ball_coords", "ball_moves", "ball_polygons", "ball_reach", "ball_order",
            "pair_start", "pair_other", "pair_contact", "pair_turned", "pair_found", "broad",
            # contact pools (`contact_pool.py`): POOL_SHAPE and POOL_GROUP records, the contact of each slot and the
            # slot of each contact (-1: none), numbers of the pairs that have the slots and of those that tables hold,
            # numbers of pairs that never touch, of new ones, a hash table of slots; the shape of each ball (-1: none)
            "n_slots", "n_shapes", "n_groups", "shapes", "groups", "slot_contact", "contact_slot", "slot_pair",
            "bound_pair", "n_excluded", "excluded", "new_pairs", "n_hash", "slot_hash", "ball_shape",
            "samples", "capacity", "sample_length",  # buffer of recorded samples; capacity 0: record nothing
            "stride",                           # steps from one recorded sample to the next
            "cursor",                           # (1,) int64: samples in the buffer
            "log", "log_capacity",              # per-step records; capacity 0: none are wanted
            "log_cursor",                       # (1,) int64
        )
    ]
)  # fmt: skip

LOOP_TYPE = types.from_dtype(LOOP)
loop_at = record_view(LOOP_TYPE)
"""loop_at(address): the loop record there."""
FIND_EVENTS_SIGNATURE = types.boolean(WORKSPACE_TYPE, METHOD_TYPE, LOOP_TYPE, types.float64, types.boolean)
call_find_events = caller(FIND_EVENTS_SIGNATURE)
"""call_find_events(address, workspace, method, loop, h, all of them)."""

TRIAL_SIGNATURE = types.int64(WORKSPACE_TYPE, METHOD_TYPE, LOOP_TYPE, types.float64)
ACCEPT_SIGNATURE = types.void(WORKSPACE_TYPE, METHOD_TYPE, LOOP_TYPE)
RUN_SIGNATURE = types.int64(WORKSPACE_TYPE, METHOD_TYPE, LOOP_TYPE, types.int64)
SAMPLE_SIGNATURE = types.void(WORKSPACE_TYPE, types.Array(types.float64, 1, "C"))
call_trial, call_accept, call_run, call_sample = map(
    caller, (TRIAL_SIGNATURE, ACCEPT_SIGNATURE, RUN_SIGNATURE, SAMPLE_SIGNATURE)
)
ACCELERATIONS_SIGNATURE = types.int64(WORKSPACE_TYPE)
call_accelerations = caller(ACCELERATIONS_SIGNATURE)

WATCH = 5
"""Columns of `watch`: gap, rate and acceleration of a contact; rate and acceleration of its sliding distance."""

CLOCK = np.dtype(
    [
        (name, np.float64)
        for name in (
            "step_size",                        # proposed next step
            "stop_time", "max_step",
            "fixed_step",                       # 0: error controlled
            "trial_step",                       # step of the last trial (an event or a failure)
            "target_time",                      # `run` returns once it is reached; a step may go beyond it
            "break_time",                       # next time at which a force or a driver's rate jumps
            "largest_growth",                   # largest factor by which a step may grow
            "hold",                             # equal steps that a multistep formula takes between two growths
            "equal_steps",                      # equal steps taken since the last change
            "eager",                            # 1: `run` returns when an outer loop fails, so that another takes over
            # of one-step formulas: error norm of the last accepted step, 0: there is none; by how much it changed then
            "previous_norm", "previous_ratio",
            "b1", "b2", "a2",                   # coefficients of the step-size controller
            "rejected_here",                    # trials that failed since the last accepted step
            "window_start", "window_count",     # since when instants with events are counted, how many there were
            "crowded",                          # 1: the last of these windows was next to no time (`events/zeno.py`)
            # while instants crowd (`events/zeno.py`): the size of the steps of impulses, 0: none; those that are left
            # and how many there were to be at first, since when no contact has come or gone; where the last began, and
            # where the last of a row of them ended
            "push_step", "pushes_left", "pushes", "calm", "pushed_from", "pushed_until",
            "repaired_at",                      # s: newest row at which a failed step had a new partition; -inf: none
            # of the division of a fixed step (`recovery/step_division.py`): how often it has been halved, 0: it is
            # whole; steps in it that have failed; where it ends, and where its present parts grow again, s; how many
            # steps have been divided so far
            "halvings", "failures", "divided_until", "parts_until", "divided_steps",
        )
    ]
)  # fmt: skip
"""Step sizes, and what the time loop remembers: the array `clock`, a part of the state."""
CLOCK_SIZE = CLOCK.itemsize // 8
clock_at, clock_of = record_view(types.from_dtype(CLOCK)), fields_of(CLOCK)

# columns of a per-step record
LOG_COLUMNS = ("t", "h", "error", "k", "rejected", "outer", "inner", "factorizations", "evaluations", "krylov")

# what `run` and `drive` return besides the status of a failed step; `recovery/policy.py` says what follows
REACHED = 100
EVENT = 101
EVENTS_FULL = 102
CHUNK = 103
STEP_TOO_SMALL = 104
REPARTITION = 105
NEAR_SINGULAR = 106
VIOLATED = 107
UNLOCATED = 108  # events have been found that could not be located
DUE = 109  # a breakpoint is due
SETTLE = 110  # pending events are for Python to settle
JAM = 111  # the newest step went over a place where sliding contacts jam
WANTED = 112  # something has to be built before pending events can be settled
FAILED = 113  # pending events cannot be settled
DIVIDES = 114  # a fixed step is divided from here on: whoever wants to may say so, and go on
GOES_BY_IMPULSES = 115  # the same of steps of impulses, `cause` says why
LAST_RESORT = 116  # as NEAR_SINGULAR, once all else has failed
FALL_BACK = 117  # another outer loop is to take over
UNREPAIRED = 118  # the constraints cannot be partitioned: `status`

DRIVE = np.dtype(
    [
        (name, np.int64)
        for name in (
            "workspace", "method", "loop", "instant",  # addresses of the records
            "run", "trial", "accept", "write_sample", "accelerations", "settle", "locate",
            "push_step", "recover", "repair", "go_by_impulses",  # addresses of functions
            "goals",                                  # (GOALS_SIZE,) float64: where to go
            "counts",                                 # (COUNTS_SIZE,) int64
            "guard",                                  # (GUARD_SIZE,) float64: of `Progress`
            "breakpoints", "n_breakpoints", "pass_breakpoint",  # the last: address of a function
            "joint_rows",                             # rows of Phi that are no contacts'
            "most_sweeps",                            # over the contacts, in a step of impulses
            "input_account",                          # index in v of the work of driven constraints; -1: there is none
            # of each contact
            "law",                                    # (n_contacts,) int64: how an impact is solved
            "restitution", "rest_ratio", "friction",  # (n_contacts,) float64
            # of those that act as forces: address of the law, (FORCE_NUMBERS,) its parameters, least approach speed
            # (m/s; < 0: a part of the model's), 1 if the force may end before the gap opens, 1 if its damping goes
            # with 1/v0
            "force_law", "force_numbers", "least_approach", "ends_early", "by_approach",
            "impulse_account", "dissipation_account",  # places in v
            "bristles", "bristle_stiffness",          # (n_contacts, 2): first place in v, how many; N/m
            "pending",                                # (n_contacts,) int64: 1 where an event has to be handled
            "found",                                  # (n_contacts, FOUND_SIZE) float64: of the location of events
            "events", "event_rows",                   # (event_rows, EVENT_SIZE) float64: a buffer that Python empties
            "last_trial",                             # (1,) float64: size of the step that ends at the current point
            "nearest",                                # (NEAREST,) float64: the last event searched for (`roots.py`)
        )
    ]
)  # fmt: skip
DRIVE_TYPE = types.from_dtype(DRIVE)
SETTLE_SIGNATURE = types.int64(DRIVE_TYPE)
call_settle = caller(SETTLE_SIGNATURE)
LOCATE_SIGNATURE = types.int64(DRIVE_TYPE, types.boolean)
call_locate = caller(LOCATE_SIGNATURE)
RECOVER_SIGNATURE = types.int64(DRIVE_TYPE, types.int64)
call_recover = caller(RECOVER_SIGNATURE)

GOALS = np.dtype([(name, np.float64) for name in ("goal", "last_stop", "handled_at", "passed")])
"""Where to go, s; the last: the breakpoint that is due."""

COUNTS = np.dtype(
    [
        (name, np.int64)
        for name in (
            "budget",                           # steps and instants with events that `drive` may take
            "handled",                          # instants with events so far
            "here",                             # of these at the time `handled_at`
            "events",                           # events in the ring
            "status",                           # of the settling, or repair, that has ended a run: `events/records.py`
            # of `recovery/policy.py`, while it waits for what it has asked for, each 0 else: what has failed, what is
            # being tried, how often, and the answer
            "cause", "remedy", "attempts", "answer",
        )
    ]
)  # fmt: skip
GOALS_SIZE, COUNTS_SIZE = GOALS.itemsize // 8, COUNTS.itemsize // 8
goals_at, counts_at = (record_view(types.from_dtype(x)) for x in (GOALS, COUNTS))
goals_of, counts_of = fields_of(GOALS), fields_of(COUNTS)
UNANSWERED, NOT_DONE, DONE, OTHER_ROWS = range(4)
"""Of `answer`; the last: it is done, and other redundant rows are left out now."""

FOUND_SIZE = 7
FORCE_NUMBERS = 4
"""Parameters of a force law."""
# columns of an event
EVENT_ROWS = 1024
EVENT_SIZE = 10
EVENT_PAIR = 9
"""Time, kind, contact, the numbers of `Event` in their order, and the pair that has the contact, where that is a slot
of a pool (`pool_records.py`)."""
IMPACT, GRAZE, REST, CLOSE, OPENS, SLIP, STICK, GAINS, JUMPS, ROUNDS, UNSHARED_LOAD, LEFT_APPROACH = range(12)
EVENT_KINDS = ("impact", "graze", "rest", "close", "open", "slip", "stick")
"""Those of `Event`. GAINS is none: an impact of several contacts, each of which has such a line, has raised the
energy; nor is JUMPS: the rate of a driver, with its row of Phi in place of a contact, has jumped; nor ROUNDS: a contact
of an impact in rounds (`events/impact_retries.py`); nor the last two, what an instant has not found
(`events/report.py`)."""
