"""A new partition, new orderings and, if need be, other redundant rows at the newest row of the history."""

from typing import TYPE_CHECKING

from ..assembly.condition_probe import set_probe
from ..assembly.evaluate import evaluate_tangent
from ..assembly.partition import prepare
from ..assembly.redundancy import choose_rows
from ..errors import ConsistencyError, SimulationError
from ..linalg import SingularMatrixError
from ..methods.frame_partition import PREFERENCE, prefer_attitudes
from ..methods.history import recall
from ..state.workspace_records import convergence_of

if TYPE_CHECKING:
    from ..simulation.simulation import Simulation


def repair(sim: "Simulation") -> bool:
    """New partition and orderings at the newest row, which becomes the workspace's point; True if other redundant rows
    are left out than before.

    Raises
    ------
    SimulationError : if the constraints depend on one another there.
    """
    c_v = convergence_of(sim.workspace.arrays["rate"]).factor_cv
    recall(sim.workspace.record, sim._method.record, 0)
    rate = convergence_of(sim.workspace.arrays["rate"])
    condition = float(rate.condition)
    try:
        changed = choose_rows(sim.workspace)
        _prepare_for_frames(sim)
        if changed:
            _move_multipliers(sim)
        else:
            rate.choice_condition = condition
            # always, as `repair_now` does: whether memory was asked for on the way decides nothing
            _order_as_in_stages(sim, c_v)
    except (ConsistencyError, SingularMatrixError) as error:
        raise SimulationError(
            f"at t = {sim.t_internal:.9g} s the constraints cannot be partitioned: {error}",
            t=sim.t_internal,
            loop="inner",
        ) from error
    return changed


def _prepare_for_frames(sim: "Simulation") -> None:
    """A partition in which attitudes in turning frames are independent, if it can be."""
    workspace, method = sim.workspace, sim._method.record
    prefer_attitudes(workspace.record, method, PREFERENCE)
    try:
        prepare(workspace)
    finally:
        if prefer_attitudes(workspace.record, method, 1.0 / PREFERENCE):
            set_probe(workspace.record)


def _order_as_in_stages(sim: "Simulation", c_v: float) -> None:
    """Pivots of the stages' matrix as it is here with the factor c_v of the last one: where the stiffness outweighs the
    mass by many orders of magnitude, those of the mass matrix alone may be the wrong ones."""
    workspace = sim.workspace
    mass_alone = workspace.arrays["values"].copy()
    evaluate_tangent(workspace.record, c_v * c_v, c_v)
    try:
        workspace.structure.kkt.analyze(workspace.arrays["values"])
    except SingularMatrixError:
        workspace.structure.kkt.analyze(mass_alone)


def _move_multipliers(sim: "Simulation") -> None:
    """Other rows carry the forces now: those left out get the multiplier zero in the whole history, and the newest row
    the multipliers that belong to the new choice."""
    sim.note_redundant()
    sim.solve_accelerations()
    recorded = sim.workspace.arrays["lam"].copy()
    recall(sim.workspace.record, sim._method.record, 0)
    start = 4 * sim.assembly.n_extended
    history = sim.method_arrays["history"]
    history[:, [start + row for row in sorted(sim.workspace.dropped)]] = 0.0
    history[sim.method_arrays["ring"][0], start:] = recorded
    sim.workspace.arrays["lam"][:] = recorded
