"""What goes into the library: functions that Python calls, and functions that are called by their addresses.

Functions of one kind (kernels, steps, stages, laws) are found by their names and arguments, so that a new one needs no
entry. The others stand here with their signatures. `tests/core/test_aot.py` looks whether any is missing.
"""

import importlib
import inspect
import pkgutil
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

from numba import typeof
from numba.core.dispatcher import Dispatcher
from numba.types import Tuple

from .. import compiled as _compiled
from ..analysis import linearise, tangent_steps, variational_equation
from ..assembly import (
    building,
    condition_probe,
    evaluate,
    levels,
    matrix_state,
    partition_building,
    projection,
    redundant_reactions,
)
from ..compiled import types
from ..compiled.kernels import KERNEL_SIGNATURE
from ..compiled.signatures import signature_text
from ..contact_solvers import directions, lcp, planar_contacts
from ..contacts.support3d import SUPPORT_SIGNATURE, SmoothShape3D
from ..elements import (
    distance3d,
    dot1_3d,
    dot2_3d,
    interface_load3d,
    joint_coordinates3d,
    joint_load3d,
    point3d,
    rolling3d,
    twist3d,
)
from ..event_detection import crossings, dense_output
from ..events import instant
from ..laws.base import LAW_SIGNATURE, ForceLaw
from ..laws.friction.base import FRICTION_SIGNATURE, FrictionLaw
from ..linalg import dense, record, row_pivoting, small, sparse
from ..linalg.analyze import ANALYZE_SIGNATURE, analyze, analyze_sparse, follow, lay_out_now, use_pivots
from ..linalg.solve import _no_solution, _not_analysed, factor, solve
from ..methods import adams, frame_partition, history, order_selection, park
from ..model import angular_velocity, derived, marker_channels2d, marker_channels3d
from ..recovery import compiled_repartition, policy
from ..simulation import begin_now, exchange, normal_form, read_channels, slopes
from ..simulation.begin_record import BEGIN
from ..stage import accelerations, joints
from ..state import run_records as run_records
from ..state.method_records import METHOD_TYPE, STEP_SIGNATURE
from ..state.workspace_records import ENGAGE_SIGNATURE, EVALUATE_SIGNATURE, STAGE_SIGNATURE, WORKSPACE_TYPE
from ..time_loop import drive, sample, time_loop
from .formed import forms

_WS, _MS, _LC, _DR = WORKSPACE_TYPE, METHOD_TYPE, run_records.LOOP_TYPE, run_records.DRIVE_TYPE
_LU = record.LU_TYPE
_REAL, _WHOLE, _FLAG = types.float64, types.int64, types.boolean
_REALS, _WHOLES = (types.Array(kind, 1, "C") for kind in (_REAL, _WHOLE))
_MATRIX, _BLOCKS = types.Array(_REAL, 2, "C"), types.Array(_REAL, 3, "C")


@dataclass(frozen=True)
class Entry:
    """A function of the library."""

    name: str
    function: Any
    """numba's."""
    signature: Any
    """numba's, or the types of the arguments alone."""

    def key(self, result: Any) -> str:
        """What `compiled/library.py` finds it by, once the type of its result is known."""
        return f"{self.name} {signature_text(result, getattr(self.signature, 'args', self.signature))}"


def _called_by_address() -> Iterator[tuple[Any, Any]]:
    """Functions whose addresses stand in records."""
    yield evaluate.all_kernels, EVALUATE_SIGNATURE
    yield analyze, ANALYZE_SIGNATURE
    yield analyze_sparse, ANALYZE_SIGNATURE
    yield building.engage_wanted, ENGAGE_SIGNATURE
    yield drive.settle_pending, run_records.SETTLE_SIGNATURE
    yield drive.pass_breakpoint, run_records.SETTLE_SIGNATURE
    yield drive.push_step, run_records.SETTLE_SIGNATURE
    yield drive.locate_now, run_records.LOCATE_SIGNATURE
    yield policy.recover, run_records.RECOVER_SIGNATURE
    yield time_loop.run, run_records.RUN_SIGNATURE
    yield time_loop.trial_step, run_records.TRIAL_SIGNATURE
    yield time_loop.accept, run_records.ACCEPT_SIGNATURE
    yield sample.write_sample, run_records.SAMPLE_SIGNATURE
    yield accelerations.solve_accelerations, run_records.ACCELERATIONS_SIGNATURE
    yield crossings.find_events, run_records.FIND_EVENTS_SIGNATURE
    yield dense_output.query, exchange.QUERY_SIGNATURE
    yield dense_output.query_motion, exchange.QUERY_SIGNATURE
    for kernel in (
        marker_channels2d.marker_channels2d, marker_channels3d.marker_channels3d, angular_velocity.angular_velocity,
        joint_coordinates3d.joint_angle, joint_coordinates3d.joint_position, joint_load3d.joint_load,
        interface_load3d.interface_load, point3d.point_load, distance3d.separation_load, dot1_3d.dot1_load,
        dot2_3d.dot2_load, twist3d.twist_load, rolling3d.rolling_load,
    ):  # fmt: skip
        yield kernel, derived.DERIVE_SIGNATURE
    for part in instant.PARTS.values():
        yield part, instant.PART_SIGNATURE
    for _, function, signature in instant._OTHERS:
        yield function, signature
    for way in (planar_contacts.by_pivoting, planar_contacts.by_limit):
        yield way, planar_contacts.WAY_SIGNATURE
    yield lcp.find_complementary, lcp.FIND_SIGNATURE
    yield small.least_norm, small.LEAST_NORM_SIGNATURE
    for way in (_not_analysed, dense.dense_factor, sparse.program_factor, sparse.columns_factor):
        yield way, record.FACTOR_SIGNATURE
    for way in (_no_solution, dense.dense_solve, sparse.sparse_solve):
        yield way, record.SOLVE_SIGNATURE
    yield order_selection.select_k, STEP_SIGNATURE
    yield order_selection.select_stable_k, STEP_SIGNATURE


def _called_by_python() -> Iterator[tuple[Any, tuple[Any, ...]]]:
    """Functions that Python calls, with the types of their arguments."""
    yield drive.drive, (_DR, _FLAG)
    yield drive.locate_now, (_DR, _FLAG)
    for function in (
        drive.aim_now, drive.wake_now, drive.settle_pending, drive.pass_breakpoint,
        drive.unsettled_now, drive.without_impulse_now, drive.open_now,
        compiled_repartition.repair_now, compiled_repartition.go_by_impulses,
    ):  # fmt: skip
        yield function, (_DR,)
    for function in (exchange.exchange, exchange.tell, exchange.read):
        yield function, (types.from_dtype(exchange.EXCHANGE),)
    yield read_channels.want, (types.from_dtype(exchange.EXCHANGE), _WHOLE)
    for function in (begin_now.begin_now, begin_now.measure_now, begin_now.place_now, begin_now.start_now):
        yield function, (types.from_dtype(BEGIN),)
    yield normal_form.normalise_buffer, normal_form.OF_COPY
    yield normal_form.normalise, normal_form.AT_SHIFT
    yield slopes.along_inputs, slopes.ALONG_ARGUMENTS
    yield slopes.in_time, slopes.SLOPES_ARGUMENTS
    yield dense_output.interpolate, (_WS, _MS, _REAL)
    yield derived.derive_rows, (_MATRIX, types.Array(_WHOLE, 2, "C"), _WHOLES, _REALS, _MATRIX)
    yield history.recall, (_WS, _MS, _WHOLE)
    yield history.restart, (_WS, _MS)
    yield frame_partition.prefer_attitudes, (_WS, _MS, _REAL)
    yield crossings.remember, (_WS, _LC)
    yield crossings.friction_margin, (_WS, _WHOLE)
    yield time_loop.set_weights_at, (_WS, _MS)
    yield time_loop.violates_redundant, (_WS, _REAL)
    for function in (
        evaluate.evaluate_residuals, evaluate.evaluate_power, evaluate.evaluate_energy, levels.position_level,
        levels.rate_level, levels.acceleration_level, levels.force_level, joints.evaluate_joints,
        joints.factor_joints, joints.solve_joints,
    ):  # fmt: skip
        yield function, (_WS,)
    yield evaluate.evaluate_tangent, (_WS, _REAL, _REAL)
    yield evaluate.constraint_norm, (_WS, _WHOLE)
    yield projection.meet, (_WS, _FLAG)
    yield partition_building.partition_wanted, (_WS,)
    yield condition_probe.set_probe, (_WS,)
    yield redundant_reactions.share_load, (_WS,)
    yield matrix_state.matrix_words, (_WS,)
    yield matrix_state.save_matrices, matrix_state.SAVE_ARGUMENTS
    yield matrix_state.restore_matrices, matrix_state.RESTORE_ARGUMENTS
    yield factor, record.FACTOR_SIGNATURE.args
    yield solve, record.SOLVE_SIGNATURE.args
    yield use_pivots, (_LU,)
    yield lay_out_now, (_LU, *(_WHOLE,) * 5, _FLAG, _WHOLE, _WHOLE)
    yield follow, (_LU, _LU)
    yield planar_contacts.solve_cones, (planar_contacts.CONES_TYPE,)
    yield lcp._find, (_WHOLE, _WHOLE, _MATRIX, _REALS, _REALS, _REALS)
    yield directions.independent_directions, (_MATRIX, _MATRIX, _WHOLES, _WHOLE, _WHOLE, _REAL, _WHOLES, _REALS)
    yield directions.farthest_directions, (_MATRIX, _WHOLES, _WHOLES, _REALS)
    matrix = (_WHOLE, _WHOLE, _WHOLES, _WHOLES, _REALS, _REALS, _REAL)
    factors = (_REALS, _WHOLES, _WHOLES, _REALS, _WHOLES, _WHOLES, _REALS)
    yield row_pivoting.eliminate, (*matrix, *(_WHOLES,) * 5, *factors)
    yield adams.adams_coefficients, (_REALS, _WHOLE, _REALS, _REALS, _REALS)
    yield park.park_coefficients, (_REALS, _REALS, _REALS)
    yield (
        linearise.linearise,
        (_WS, _MS, _REALS, _WHOLES, _WHOLES, _WHOLES, _BLOCKS, _BLOCKS, _BLOCKS, _BLOCKS, _BLOCKS, _MATRIX),
    )
    yield linearise.all_rows, (_WS, _MATRIX, _MATRIX, _REALS)
    yield linearise.gap_hessian, (_WS, _WHOLE, _WHOLES, _MATRIX)
    yield linearise.matrix_at, (_WS, _WHOLES, _WHOLES, _MATRIX, _MATRIX, _REAL)
    yield linearise.tangent_rate, (_WS, _MS, _REALS, _WHOLES, _WHOLES, _BLOCKS)
    work = typeof(variational_equation.make_work(2, 1, 1))
    matrices, variations = (_BLOCKS,) * 6, (_MATRIX, _MATRIX)
    yield variational_equation.carry, (_REAL, *matrices, _REALS, *variations, _MATRIX, work)
    layout = Tuple((_WHOLES, _WHOLES, _WHOLES, _REALS))
    room = Tuple((_REALS, *(_BLOCKS,) * 5, _MATRIX, _BLOCKS, _MATRIX, *variations))
    yield tangent_steps.fly, (_WS, _MS, _LC, _WHOLE, layout, room, work, *variations, _REALS, _REALS)


def _modules() -> Iterator[Any]:
    package = __package__.rsplit(".", 1)[0]
    root = importlib.import_module(package)
    for found in pkgutil.walk_packages(root.__path__, f"{package}."):
        if not found.name.startswith((__package__, f"{_compiled.__name__}.")):
            yield importlib.import_module(found.name)


def _of_one_kind() -> Iterator[tuple[Any, Any]]:
    """Kernels, steps and stages of all modules, laws and smooth shapes of all records."""
    for module in _modules():
        for name, value in vars(module).items():
            if not isinstance(value, Dispatcher) or value.py_func.__module__ != module.__name__:
                continue
            arguments = tuple(inspect.signature(value.py_func).parameters)
            if arguments == ("job", "t", "b"):
                yield value, KERNEL_SIGNATURE
            elif name.endswith("_step") and name[0] != "_" and arguments == ("workspace", "method", "h"):
                yield value, STEP_SIGNATURE
            elif name.startswith("solve_") and name.endswith("_stage"):
                yield value, STAGE_SIGNATURE
    laws: tuple[tuple[type, Any], ...] = (
        (ForceLaw, LAW_SIGNATURE), (FrictionLaw, FRICTION_SIGNATURE), (SmoothShape3D, SUPPORT_SIGNATURE),
    )  # fmt: skip
    for base, signature in laws:
        for kind in _kinds(base):
            formula = vars(kind).get("formula")
            if isinstance(formula, Dispatcher):
                yield formula, signature


def _kinds(base: type) -> Iterator[type]:
    kind: type
    for kind in base.__subclasses__():
        yield kind
        yield from _kinds(kind)


def entries() -> list[Entry]:
    """All of them, each once."""
    found: dict[Any, Entry] = {name: Entry(name, form.kernel, KERNEL_SIGNATURE) for name, form in forms().items()}
    for function, signature in (*_of_one_kind(), *_called_by_address(), *_called_by_python()):
        source = function.py_func
        arguments = tuple(getattr(signature, "args", signature))
        entry = Entry(f"{source.__module__}.{source.__qualname__}", function, signature)
        found.setdefault((source, arguments), entry)
    return list(found.values())
