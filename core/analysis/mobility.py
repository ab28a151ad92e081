"""Mobility: how many ways a mechanism can move, which of its constraints repeat others, and what is stuck."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.projection import bring_to_rest
from ..assembly.redundancy import RedundantRow
from ..assembly.singular_values import singular_directions
from ..simulation.simulation import Simulation
from .at_rest import Matrices, matrices, place, run_of

STUCK = 1e-8
"""Motion of a coordinate, in parts of its scale, that counts as none."""
MOVE = 1e-2
"""A small motion of the independent coordinates, in parts of their scales: what stands still at first order only moves
by its square."""


@dataclass(frozen=True)
class Mobility:
    """What a count of coordinates and constraints says about a mechanism at its start.

    Attributes
    ----------
    coordinates : n. rows : constraint equations of joints. rank : of these, independent ones.
    closed : contacts that are closed at the start; each takes one more degree of freedom away.
    freedom : degrees of freedom left.
    redundant : equations that repeat others.
    independent : names of coordinates that say where all the others are.
    stuck : names of coordinates that cannot move.
    least_singular_value : of the scaled Phi_q: near 0 a singular position is near.
    joints : of each joint, the number of its equations.
    """

    coordinates: int
    rows: int
    rank: int
    closed: tuple[str, ...]
    freedom: int
    redundant: tuple[RedundantRow, ...]
    independent: tuple[str, ...]
    stuck: tuple[str, ...]
    least_singular_value: float
    singular_values: tuple[float, ...]
    joints: dict[str, int]

    @property
    def counted(self) -> int:
        """Coordinates less equations: Gruebler's count, which takes repeated equations for new ones."""
        return self.coordinates - self.rows - len(self.closed)


def mobility(system: Any) -> Mobility:
    """The mobility of `system` at its start; with velocity-level rows that of its velocities.

    Raises
    ------
    ConsistencyError : for constraints that contradict each other, a start that they do not allow, or a singular
        position: names the joints.
    """
    sim = run_of(system, rate_rows=True)
    assembly, arrays, active = sim.assembly, sim.workspace.arrays, sim.workspace.structure.active
    place(sim, arrays["q"][: assembly.n].copy(), np.zeros(len(active)))
    found: Matrices = matrices(sim)
    values, _ = singular_directions(sim.workspace)
    stuck = _stuck(sim, found)
    internal = assembly.is_internal
    joints: dict[str, int] = {}
    for name in assembly.row_names[: assembly.m_joints]:
        joints[name] = joints.get(name, 0) + 1
    closed = tuple(c.name for c in assembly.contacts if c.row in active)
    names = assembly.coordinate_names
    return Mobility(
        coordinates=assembly.n - int(np.sum(internal)),
        rows=assembly.m_joints,
        rank=assembly.m_joints - len(sim.redundant),
        closed=closed,
        freedom=int(np.sum(~internal[found.independent])),
        redundant=sim.redundant,
        independent=tuple(names[k] for k in found.independent if not internal[k]),
        stuck=tuple(names[k] for k in stuck if not internal[k]),
        least_singular_value=float(values[-1]) if len(values) else 1.0,
        singular_values=tuple(float(x) for x in values),
        joints=joints,
    )


def _stuck(sim: Simulation, found: Matrices) -> NDArray[np.int64]:
    """Coordinates that a small finite motion does not move."""
    scale, arrays, n = sim.assembly.coordinate_scale, sim.workspace.arrays, sim.assembly.n
    here, moved = arrays["q"][:n].copy(), np.zeros(n)
    for sign in (1.0, -1.0):
        # weights in no simple order, so that no two motions cancel
        weights = sign * (0.5 + np.modf(0.618 * np.arange(1.0, 1.0 + len(found.independent)))[0])
        motion = found.basis @ (weights * scale[found.independent])
        size = float(np.max(np.abs(motion) / scale, initial=0.0))
        if size == 0.0:
            break
        place(sim, here + MOVE / size * motion, np.zeros(len(sim.workspace.structure.active)))
        if bring_to_rest(sim.workspace, "phi", "q"):
            moved = np.maximum(moved, np.abs(arrays["q"][:n] - here) / scale)
        else:
            moved = np.maximum(moved, np.abs(motion) / (size * scale))
    place(sim, here, np.zeros(len(sim.workspace.structure.active)))
    return np.flatnonzero(moved <= STUCK)
