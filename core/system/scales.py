"""The model's own scales: how large its lengths, times and energies are, whatever the units.

Lengths stand in the model (`Assembly.coordinate_scale`, 1 for angles). What a row of Phi or a gap measures follows from
them: how far it moves when the coordinates move by their scales. The time is that in which the start's velocities,
accelerations and driven motions cross those lengths, those of angles less (`ANGLES`): what spins fast makes nothing
else fast. The energy is that of the masses at their speeds and the work of the forces along those lengths, where there
are none that of the masses at the model's speeds.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from .evaluate import evaluate_residuals, evaluate_tangent
from .records import ENERGY_SCALE, RATE_SCALE, STIFFNESS_SCALE
from .workspace import Workspace

PROBES = 4
"""Pseudo-random motions from which the sizes of rows are taken."""
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
    # M and Phi_q become numbers of about 1
    root = np.sqrt(inertia)
    workspace.use_units(np.concatenate([assembly.coordinate_scale / root, root / arrays["row_scale"]]))
    return Scales(assembly.length, rate, energy)


def _row_scale(workspace: Workspace) -> NDArray[np.float64]:
    """How far rows of Phi move when the coordinates move by their scales, (m,)."""
    arrays, assembly = workspace.arrays, workspace.assembly
    n, m = assembly.n, assembly.m
    if assembly.row_scale is not None:
        sizes = assembly.row_scale.copy()
    else:
        # Phi' = Phi_q v + Phi_t for motions of all coordinates at once, with signs in no simple order
        index = np.arange(n)
        arrays["v"][:] = 0.0
        evaluate_residuals(workspace.record)
        still, sizes = arrays["phid"][:m].copy(), np.zeros(m)
        for k in range(PROBES):
            golden = np.modf(0.6180339887498949 * (index + 1.0) * (2 * k + 1))[0]
            arrays["v"][:n] = np.where(golden < 0.5, 1.0, -1.0) * assembly.coordinate_scale
            evaluate_residuals(workspace.record)
            np.maximum(sizes, np.abs(arrays["phid"][:m] - still), out=sizes)
    sizes[~np.isfinite(sizes)] = 0.0
    # one that nothing moves now: as large as the largest of the others
    sizes[sizes == 0.0] = np.max(sizes, initial=0.0) or 1.0
    return sizes


def _rate_and_energy(workspace: Workspace) -> tuple[float, float, float, float]:
    """Inverse of the model's time (1/s), the energy of its masses (J), the largest of these (kg m^2), and how stiff
    what holds them is (1/s^2)."""
    arrays, assembly = workspace.arrays, workspace.assembly
    n, m, scale = assembly.n, assembly.m, assembly.coordinate_scale
    q, v, t = arrays["q"].copy(), assembly.v0, float(arrays["t"][0])
    structure = workspace.structure
    diagonal = np.flatnonzero((structure.rows == structure.cols) & (structure.rows < n))

    def diagonals(c_q: float) -> NDArray[np.float64]:
        evaluate_tangent(workspace.record, c_q, 0.0)
        found = np.zeros(n)
        found[structure.rows[diagonal]] = np.abs(arrays["values"][diagonal])
        return found

    reach = arrays["level_scale"]
    squares = [np.max((v / reach) ** 2, initial=0.0)]
    arrays["a"][:], arrays["lam"][:] = 0.0, 0.0
    mass, works = np.zeros(n), []
    for later in (0.0, *_later_times(workspace, t)):
        arrays["t"][0] = t + later
        arrays["q"][:] = q
        for moving in (False, True):
            arrays["v"][:n] = v if moving else 0.0
            evaluate_residuals(workspace.record)
            if not later and not moving:
                mass = diagonals(0.0)
                evaluate_residuals(workspace.record)
            has_mass = mass > 0.0
            force = np.abs(arrays["r"][:n][has_mass])
            squares.append(np.max(force / (mass[has_mass] * reach[has_mass]), initial=0.0))
            works.append(np.max(force * scale[has_mass], initial=0.0))
            joints = slice(0, assembly.m_joints)
            sizes = arrays["row_scale"][:m][joints]
            squares.append(np.max(np.abs(arrays["phidd"][joints]) / sizes, initial=0.0))
            if not moving:
                squares.append(np.max((arrays["phid"][joints] / sizes) ** 2, initial=0.0))
    squares = [float(x) for x in squares if np.isfinite(x) and x > 0.0]
    arrays["t"][0], arrays["q"][:], arrays["v"][:] = t, q, 0.0
    evaluate_residuals(workspace.record)
    stiffness = np.abs(diagonals(1.0) - mass)
    here = (mass > 0.0) & (stiffness > 1e-12 * mass) & np.isfinite(stiffness)
    stiffest = float(np.max(stiffness[here] / mass[here], initial=0.0))
    # all at rest without loads: what vibrates gives the time
    squares = squares or [stiffest]
    rate = float(np.sqrt(max(squares))) or 1.0
    heaviest = float(np.max(mass * scale**2, initial=0.0)) or 1.0
    # each mass with its own speed: a heavy one need not move as fast as the fastest
    works = [float(x) for x in (*works, np.max(mass * v**2, initial=0.0)) if np.isfinite(x) and x > 0.0]
    return rate, max(works, default=heaviest * rate**2), heaviest, stiffest


def _later_times(workspace: Workspace, t: float) -> list[float]:
    """Times after t at which forces and drivers that rest at first have begun, s."""
    assembly = workspace.assembly
    ahead = [b - t for b in assembly.breakpoints if b > t]
    step = max(1, -(-len(ahead) // MOST_TIMES))
    times = ahead[::step]
    if np.isfinite(assembly.longest_step):
        times += [0.5 * assembly.longest_step, assembly.longest_step]
    return times
