"""Where a singular position lies: looked for along the motion from the newest row."""

from typing import TYPE_CHECKING

import numpy as np

from ..assembly.singular_values import least_singular_value
from ..methods.history import recall

if TYPE_CHECKING:
    from ..simulation.simulation import Simulation

FARTHEST = 0.6
"""How far away a singular position is looked for: the motion of the fastest coordinate, relative to its scale."""
STEPS_AWAY = 60.0
"""A failure that many steps from a singular position has other reasons."""
LOOKS = 24
"""Places where it is looked for, ahead and behind."""
DIP = 0.1
"""A singular position lies where the least singular value falls below this part of its values around."""
RECENT = 7
"""Steps of late that tell the usual one."""


def near_singular(sim: "Simulation") -> float | None:
    """Time of a singular position some steps from the newest row, s; None if there is none."""
    if sim.workspace.structure.active.size == 0:
        return None
    natural = natural_step(sim)
    found = find_singular(sim, natural)
    return None if found is None or abs(found[0]) > STEPS_AWAY * natural else sim.t_internal + found[0]


def natural_step(sim: "Simulation") -> float:
    """The step that the smooth motion allows: that of the trial, or the usual one of late if trials have shrunk."""
    ring, times = sim.method_arrays["ring"], sim.method_arrays["times"]
    rows = [int(ring[0] - back) % len(times) for back in range(min(int(ring[1]), RECENT))]
    gaps = -np.diff(times[rows])
    # a fixed step may have been divided
    step = max(float(sim.clock.trial_step), sim.settings.step or 0.0)
    return max(step, float(np.median(gaps)) if len(gaps) else 0.0)


def find_singular(sim: "Simulation", natural: float) -> tuple[float, float] | None:
    """Seconds to the first singular position ahead on the parabola through the newest row, or to the last one behind
    (negative), and how fast the least singular value of the scaled Phi_q grows away from it, 1/s; None if none is in
    reach: where that value would be zero if it went on as it does here."""
    workspace, n, arrays = sim.workspace, sim.assembly.n, sim.workspace.arrays
    recall(workspace.record, sim._method.record, 0)
    q, v, a, t = arrays["q"][:n].copy(), arrays["v"][:n].copy(), arrays["a"][:n].copy(), sim.t_internal
    speed = float(np.max(np.abs(v) / sim.assembly.coordinate_scale, initial=0.0))
    if speed == 0.0:
        return None

    def distance(s: float) -> float:
        arrays["q"][:n], arrays["v"][:n] = q + s * (v + 0.5 * s * a), v + s * a
        arrays["t"][0] = t + s
        return least_singular_value(workspace)

    little = 0.01 / speed
    apart = max(min(natural, little), 1e-3 * little)
    here, next_one = distance(0.0), distance(apart)
    far = apart * here / max(abs(here - next_one), 1e-300)
    ahead, behind = (max(3.0 * natural, 1.5 * far * side) for side in (next_one < here, next_one > here))
    ahead, behind = min(ahead, FARTHEST / speed), min(behind, FARTHEST / speed)
    times = np.concatenate([np.linspace(-behind, 0.0, LOOKS)[:-1], np.linspace(0.0, ahead, LOOKS)])
    values = np.array([distance(s) if s != 0.0 else here for s in times])
    nearest: tuple[float, float] | None = None
    for k in range(1, len(times) - 1):
        if not values[k - 1] >= values[k] <= values[k + 1]:
            continue
        low, high = float(times[k - 1]), float(times[k + 1])
        for _ in range(14):
            third = (high - low) / 3.0
            if distance(low + third) < distance(high - third):
                high -= third
            else:
                low += third
        found = 0.5 * (low + high)
        around = min(float(np.max(values[:k])), float(np.max(values[k + 1 :])))
        if distance(found) < DIP * around:
            nearest = found, max(distance(found - little), distance(found + little)) / little
            if found > 0.0:
                break
    return nearest
