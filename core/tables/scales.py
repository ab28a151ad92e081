"""The model's own scales: how large its lengths, times and energies are, whatever the units.

Lengths stand in the model (`Assembly.coordinate_scale`, 1 for angles). What a row of Phi or a gap measures follows from
them: how far it moves when the coordinates move by their scales. The time is that in which the start's velocities,
accelerations and driven motions cross those lengths, those of angles less (`ANGLES`): what spins fast makes nothing
else fast. The energy is that of the masses at their speeds and the work of the forces along those lengths, where there
are none that of the masses at the model's speeds.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..state.workspace_records import ENERGY_SCALE, RATE_SCALE, STIFFNESS_SCALE
from .evaluate import evaluate_residuals
from .measure import MEASURED, measure_motion, measure_rows
from .workspace import Workspace

WORK = 0.1
"""Of the model's energy: work accounts below this are held to what it is worth, others relatively."""
MOST_TIMES = 40
"""Later times at which it is looked what forces and drivers do."""


@dataclass(frozen=True)
class Scales:
    """What the tolerances of a run are parts of.

    Attributes
    ----------
    length : size of the mechanism, m.
    rate : inverse of its time, 1/s.
    energy : of its motion and its forces, J.
    """

    length: float
    rate: float
    energy: float

    @property
    def time(self) -> float:
        """s."""
        return 1.0 / self.rate

    @property
    def speed(self) -> float:
        """m/s."""
        return self.length * self.rate


def measure_scales(workspace: Workspace) -> Scales:
    """Scales of the model at the workspace's point, which may not meet the constraints yet; its rows' sizes, its rate
    and its energy go into the workspace, which is left as it was but for the residuals."""
    arrays, assembly = workspace.arrays, workspace.assembly
    kept = {name: arrays[name].copy() for name in ("q", "v", "a", "lam", "t", "counters")}
    try:
        arrays["row_scale"][: assembly.m] = _row_scale(workspace)
        rate, energy, inertia, stiffness = _rate_and_energy(workspace)
    finally:
        for name, value in kept.items():
            arrays[name][:] = value
        evaluate_residuals(workspace.record)
        arrays["counters"][:] = kept["counters"]
    control = arrays["control"]
    control[RATE_SCALE], control[ENERGY_SCALE], control[STIFFNESS_SCALE] = rate, energy, stiffness
    work = arrays["work_scale"]
    work[:] = WORK * energy
    for contact in assembly.contacts:
        work[contact.impulse_account] = WORK * energy / (rate * arrays["row_scale"][contact.row])
    for name, size in assembly.work_sizes.items():
        work[assembly.work_index(name)] = size
    # M and Phi_q become numbers of about 1
    root = np.sqrt(inertia)
    workspace.use_units(np.concatenate([assembly.coordinate_scale / root, root / arrays["row_scale"]]))
    return Scales(assembly.length, rate, energy)


def _row_scale(workspace: Workspace) -> NDArray[np.float64]:
    """How far rows of Phi move when the coordinates move by their scales, (m,)."""
    assembly = workspace.assembly
    if assembly.row_scale is None:
        sizes = np.empty(assembly.m)
        measure_rows(workspace.record, assembly.coordinate_scale, sizes)
        return sizes
    sizes = assembly.row_scale.copy()
    sizes[~np.isfinite(sizes)] = 0.0
    sizes[sizes == 0.0] = np.max(sizes, initial=0.0) or 1.0
    return sizes


def _rate_and_energy(workspace: Workspace) -> tuple[float, float, float, float]:
    """Inverse of the model's time (1/s), the energy of its masses (J), the largest of these (kg m^2), and how stiff
    what holds them is (1/s^2)."""
    assembly, found = workspace.assembly, np.zeros(MEASURED)
    later = np.array([0.0, *_later_times(workspace, float(workspace.arrays["t"][0]))])
    mass = np.zeros(assembly.n)
    # the rate of an internal state is no acceleration, its unit mass no mass
    scale, v0 = np.where(assembly.is_internal, 0.0, assembly.coordinate_scale), assembly.v0
    measure_motion(workspace.record, scale, v0, later, assembly.m_joints, mass, found)
    square, work, heaviest, stiffest = found.tolist()
    # all at rest without loads: what vibrates gives the time
    rate = math.sqrt(square or stiffest) or 1.0
    heaviest = heaviest or 1.0
    return rate, work or heaviest * (rate * rate), heaviest, stiffest


def _later_times(workspace: Workspace, t: float) -> list[float]:
    """Times after t at which forces and drivers that rest at first have begun, s."""
    assembly = workspace.assembly
    ahead = [b - t for b in assembly.breakpoints if b > t]
    step = max(1, -(-len(ahead) // MOST_TIMES))
    times = ahead[::step]
    if np.isfinite(assembly.longest_step):
        times += [0.5 * assembly.longest_step, assembly.longest_step]
    return times
