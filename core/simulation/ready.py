"""What a run may call later is compiled, or loaded, before it starts: no step and no impact waits for numba.

Kernels, formulas and methods are there once the run is built, since tables hold their addresses. What is left is
called from Python, at steps and at events; a test looks whether any of it is missing here (`test_compiled_before.py`).
"""

from functools import cache
from typing import TYPE_CHECKING, Any

from ..assembly.condition_probe import set_probe
from ..assembly.evaluate import constraint_norm, evaluate_energy, evaluate_power, evaluate_residuals, evaluate_tangent
from ..assembly.levels import force_level, position_level, rate_level
from ..assembly.partition_building import partition_wanted
from ..assembly.projection import meet
from ..compiled import types
from ..compiled.jit import address_of
from ..contact_solvers.directions import farthest_directions, independent_directions
from ..contact_solvers.planar_contacts import CONES_TYPE, Cones, solve_cones
from ..event_detection.crossings import find_events, friction_margin, remember
from ..event_detection.dense_output import interpolate, query, query_motion
from ..linalg.analyze import follow
from ..linalg.record import FACTOR_SIGNATURE, LU_TYPE, SOLVE_SIGNATURE
from ..linalg.row_pivoting import FEW_ENTRIES, make_elimination_ready
from ..linalg.solve import factor, solve
from ..methods.frame_partition import prefer_attitudes
from ..methods.history import recall, restart
from ..stage import OUTER_LOOPS
from ..stage.accelerations import solve_accelerations
from ..stage.joints import evaluate_joints, factor_joints, solve_joints
from ..state.method_records import METHOD_TYPE
from ..state.run_records import DRIVE_TYPE, FIND_EVENTS_SIGNATURE, LOOP_TYPE
from ..state.workspace_records import STAGE_SIGNATURE, WORKSPACE_TYPE
from ..time_loop.drive import aim_now, drive, settle_pending
from ..time_loop.sample import write_sample
from ..time_loop.time_loop import accept, set_weights_at, trial_step, violates_redundant
from .begin_now import measure_now, place_now, start_now
from .begin_record import BEGIN
from .normal_form import OF_COPY, normalise_buffer
from .slopes import ALONG_ARGUMENTS, SLOPES_ARGUMENTS, along_inputs, in_time

if TYPE_CHECKING:
    from .engine import Engine

_WORKSPACE, _METHOD, _LOOP, _BEGIN = WORKSPACE_TYPE, METHOD_TYPE, LOOP_TYPE, types.from_dtype(BEGIN)
_REAL, _WHOLE = types.float64, types.int64
_VECTOR, _MATRIX, _NUMBERS = types.Array(_REAL, 1, "C"), types.Array(_REAL, 2, "C"), types.Array(_WHOLE, 1, "C")

_CALLED: tuple[tuple[Any, tuple[Any, ...]], ...] = (
    (drive, (DRIVE_TYPE, types.boolean)),
    (aim_now, (DRIVE_TYPE,)),
    (query, (_WORKSPACE, _METHOD, _REAL)),
    (query_motion, (_WORKSPACE, _METHOD, _REAL)),
    (interpolate, (_WORKSPACE, _METHOD, _REAL)),
    (write_sample, (_WORKSPACE, _VECTOR)),
    (recall, (_WORKSPACE, _METHOD, _WHOLE)),
    (restart, (_WORKSPACE, _METHOD)),
    (prefer_attitudes, (_WORKSPACE, _METHOD, _REAL)),
    (remember, (_WORKSPACE, _LOOP)),
    (set_weights_at, (_WORKSPACE, _METHOD)),
    (trial_step, (_WORKSPACE, _METHOD, _LOOP, _REAL)),
    (accept, (_WORKSPACE, _METHOD, _LOOP)),
    (find_events, FIND_EVENTS_SIGNATURE.args),
    (violates_redundant, (_WORKSPACE, _REAL)),
    (solve_accelerations, (_WORKSPACE,)),
    (evaluate_residuals, (_WORKSPACE,)),
    (evaluate_tangent, (_WORKSPACE, _REAL, _REAL)),
    (evaluate_power, (_WORKSPACE,)),
    (evaluate_energy, (_WORKSPACE,)),
    (constraint_norm, (_WORKSPACE, _WHOLE)),
    (measure_now, (_BEGIN,)),
    (place_now, (_BEGIN,)),
    (start_now, (_BEGIN,)),
    (position_level, (_WORKSPACE,)),
    (rate_level, (_WORKSPACE,)),
    (force_level, (_WORKSPACE,)),
    (meet, (_WORKSPACE, types.boolean)),
    (evaluate_joints, (_WORKSPACE,)),
    (factor_joints, (_WORKSPACE,)),
    (solve_joints, (_WORKSPACE,)),
    (partition_wanted, (_WORKSPACE,)),
    (set_probe, (_WORKSPACE,)),
    (follow, (LU_TYPE, LU_TYPE)),
    (factor, FACTOR_SIGNATURE.args),
    (solve, SOLVE_SIGNATURE.args),
    (along_inputs, ALONG_ARGUMENTS),
    (in_time, SLOPES_ARGUMENTS),
    (normalise_buffer, OF_COPY),
)
"""Called by every run, with the types of their arguments."""


@cache
def _compile_called() -> None:
    for function, arguments in _CALLED:
        function.compile(arguments)


@cache
def _compile_for_contacts(many_entries: bool) -> None:
    friction_margin.compile((_WORKSPACE, _WHOLE))
    settle_pending.compile((DRIVE_TYPE,))
    # its record holds the addresses of all that it calls
    Cones(1)
    solve_cones.compile((CONES_TYPE,))
    independent_directions.compile((_MATRIX, _MATRIX, _NUMBERS, _WHOLE, _WHOLE, _REAL, _NUMBERS, _VECTOR))
    farthest_directions.compile((_MATRIX, _NUMBERS, _NUMBERS, _VECTOR))
    if many_entries:
        make_elimination_ready()


def make_ready(sim: "Engine") -> None:
    """Compile what the run of `sim` may call from now on, so far as it is not there yet."""
    _compile_called()
    if sim.settings.fallback:
        address_of(OUTER_LOOPS["newton"].stage, STAGE_SIGNATURE)
    assembly = sim.assembly
    if not assembly.contacts:
        return
    _compile_for_contacts(
        sum(len(b.coord) * len(b.jacobian_pattern) for b in assembly.batches) > FEW_ENTRIES,
    )
