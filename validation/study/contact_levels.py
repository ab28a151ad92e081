"""C6: a contact as a constraint, level by level, and the dimension of the system while it is closed."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ...core import Simulation
from .cases import Setting
from .claims import Claim
from .contact_claim import TLISMNI
from .contact_failure import PROBLEMS, RTOL, ContactRow

PROBLEM = PROBLEMS[2]
"""Plastic impacts, after which the contact stays closed until its force vanishes."""
HOLDS = 1e-8
"""Residuals below this are rounding and the inner loop's tolerance, in SI units."""
CLAIM = (
    "Contact constraints must hold at position, velocity, acceleration and velocity-increment level; while a contact "
    "is closed the system is an index-3 problem of another dimension"
)


@dataclass(frozen=True)
class ContactLevels:
    """One run with the impact law."""

    residuals: tuple[float, float, float, float]
    """Largest at position (m), velocity (m/s), acceleration (m/s^2) and velocity-increment level (m/s)."""
    free: tuple[int, int]
    """Independent coordinates while the contact is open, and while it is closed."""
    jump: float
    """Largest jump of the contact's velocity, m/s."""


def contact_levels(setting: Setting = Setting("ebdf", {"k": 4})) -> ContactLevels:  # noqa: B008  (a frozen value)
    """Run `PROBLEM` step by step, and look at the constraints and at the partition."""
    sim = Simulation(PROBLEM.load().model, setting.method, RTOL, 0.01 * RTOL, record=True, **setting.options)
    t_end = PROBLEM.t_end or 0.0
    free: set[int] = set()
    while sim.t < t_end:
        sim.step(t_end)
        dependent = sim.workspace.structure.dependent
        free.add(sim.assembly.n - (0 if dependent is None else len(dependent)))
    sim.flush()
    samples = np.concatenate(sim.samples)
    worst = [float(sim.table.column(samples, f"residual.{x}").max()) for x in ("position", "velocity", "acceleration")]
    increments = [event.velocity_increment_residual for event in sim.events]
    jumps = [event.approach_speed + event.separation_speed for event in sim.events if event.kind == "impact"]
    return ContactLevels(
        (*worst, max(increments, default=0.0)),  # type: ignore[arg-type]
        (max(free), min(free)), max(jumps, default=0.0),
    )  # fmt: skip


def sixth_claim(rows: Sequence[ContactRow], levels: ContactLevels) -> Claim:
    """C6: all four levels with the impact law; without its velocity increment, what the methods make of the law."""
    asked = next((problem.parameters["restitution"] for problem in PROBLEMS if problem.scenario == "pendulum_stop"), 0)
    naive = [row for row in rows if not row.jump and row.problem.startswith("pendulum_stop") and row.found]
    found = {row.setting.label: row.found.restitution for row in naive if row.found}
    right = [row for row in rows if not row.jump and not row.faults]
    with_law = [row for row in rows if row.jump and row.setting.method in TLISMNI and not row.faults]
    all_with_law = [row for row in rows if row.jump and row.setting.method in TLISMNI]
    all_hold = max(levels.residuals) < HOLDS and levels.free[0] - levels.free[1] == 1
    verdict = "holds" if all_hold and not right and len(with_law) == len(all_with_law) else "holds in part"
    if not all_hold:
        verdict = "does not hold"
    known = [x for x in found.values() if np.isfinite(x)]
    return Claim(
        "C6",
        CLAIM,
        verdict,
        (
            "with the law, ebdf k=4: largest residuals "
            + ", ".join(
                f"{name} {x:.0e}"
                for name, x in zip(
                    ("position", "velocity", "acceleration", "velocity increment"), levels.residuals, strict=True
                )
            ),
            f"independent coordinates: {levels.free[0]} while open, {levels.free[1]} while closed",
            f"without the velocity increment the pendulum's restitution, {asked:g} by its law, is "
            f"{round(min(known), 3) + 0.0:.3f} ... {max(known):.4f}, and {len(right)} of "
            f"{sum(not row.jump for row in rows)} runs of all problems are reasonable; with it {len(with_law)} of "
            f"{len(all_with_law)} of TLISMNI",
        ),
        {"residuals": levels.residuals, "independent": levels.free, "restitutions": found, "jump": levels.jump},
    )
