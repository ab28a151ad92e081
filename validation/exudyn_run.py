"""Run a model in exudyn and return its channels."""

import contextlib
import io
import logging
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np

from ..core.elements import Cable2D, FlexibleBody
from ..core.laws.hunt_crossley import HuntCrossleyFamily
from ..core.multibody_model import Model
from .errors import ExudynFailed
from .exudyn_model import build_exudyn_model
from .translation import Build
from .translation.coordinate_contacts import coordinate_channels
from .translation.kinematics import BodyStates, States, gap_motion

log = logging.getLogger(__name__)

Integrator = Literal["generalized_alpha", "trapezoidal"]
MOTION = ("x", "y", "angle", "vx", "vy", "angular_velocity")


PULL = 1e-3
"""Of a contact's largest force: less is what exudyn's steps leave at the end of a blow."""


@dataclass(frozen=True)
class ExudynSettings:
    """How exudyn runs. The defaults are those that its own pitfalls make advisable.

    Attributes
    ----------
    integrator : "generalized_alpha" (index 3) or "trapezoidal" (index 2, for smooth motion only: at contact
        its multipliers ring undamped).
    spectral_radius : 0.9; with 0.99 exudyn gains energy at contact.
    relative_tolerance, absolute_tolerance : of Newton's residual; the absolute one, N, should fit the forces.
    contact_tolerance : accepted force-like error of the contact's active set, N.
    linear_solver : "EXUdense", "EigenDense" or "EigenSparse".
    """

    integrator: Integrator = "generalized_alpha"
    spectral_radius: float = 0.9
    modified_newton: bool = False
    relative_tolerance: float = 1e-8
    absolute_tolerance: float = 1e-10
    contact_tolerance: float = 1e-3
    linear_solver: str = "EXUdense"


FINE_MESH = 16
"""Elements of a cable above which Newton's residual no longer gets below 1e-8 N. exudyn then cuts its steps (to a
sixtieth and less), and cut steps spoil its generalized-alpha: `hub_beam_stop` with 32 cables, 0.2 rad/s, was 2.4e-3 off
so; with 1e-6 N no step is cut and it is 1e-6 from our own elements."""


def settings_for(model: Model, **given: Any) -> ExudynSettings:
    """Settings that suit a model: with flexible bodies a kept Jacobian, and a tolerance above their rounding."""
    flexible = any(isinstance(b, FlexibleBody) for b in model.bodies)
    fine = any(isinstance(b, Cable2D) and b.elements > FINE_MESH for b in model.bodies)
    tolerance = 1e-6 if fine else 1e-8
    stiff = {"modified_newton": True, "absolute_tolerance": tolerance, "linear_solver": "EigenSparse"}
    return ExudynSettings(**{**(stiff if flexible else {}), **given})


@dataclass(frozen=True)
class ExudynResult:
    """Channels of a run in exudyn, named as the model's own.

    Attributes
    ----------
    t : times of the records, s: the start and every step.
    channels : arrays over `t`; a contact has gap, gap_rate, normal_force, impulse (integral of the force).
    step : step size, s.
    wall_time : seconds in exudyn's solver.
    notes : what a reader of a comparison should know about the translation.
    """

    t: np.ndarray
    channels: Mapping[str, np.ndarray]
    step: float
    wall_time: float
    newton_iterations: int
    version: str
    notes: tuple[str, ...] = field(default=())

    def __getitem__(self, channel: str) -> np.ndarray:
        return self.channels[channel]


def run_exudyn(
    model: Model,
    t_end: float,
    step: float,
    settings: ExudynSettings | None = None,
    clamped: frozenset[str] = frozenset(),
) -> ExudynResult:
    """Run `model` in exudyn with fixed steps of about `step` (s), a whole number of them, to `t_end` (s).

    Where exudyn's own contact has pulled and the law does not, it is run again with that contact as a user function;
    `clamped` names those that are one from the first.

    Raises
    ------
    ExudynUnavailable, NotTranslatable : see `build_exudyn_model`.
    ExudynFailed : if it stops before the end.
    ValueError : for a step or an end time that is not positive.
    """
    if not (step > 0.0 and t_end > 0.0):
        raise ValueError(f"step = {step} s and t_end = {t_end} s must be positive")
    build = build_exudyn_model(model, clamped=clamped)
    try:
        result, pulling = _recorded(build, t_end, step, settings or ExudynSettings())
    finally:
        build.release()  # where it fails too, while the error refers to it
    return run_exudyn(model, t_end, step, settings, clamped | pulling) if pulling else result


def _recorded(build: Build, t_end: float, step: float, settings: ExudynSettings) -> tuple[ExudynResult, frozenset[str]]:
    """Solve, and copy what the sensors have stored; and which contacts have pulled. Raises ExudynFailed."""
    model = build.model
    wall_time, steps = solve(build, t_end, step, settings)
    if not build.columns:
        raise ExudynFailed(f"model '{model.name}' has no bodies: there is nothing to record")
    sensors = {c.sensor for c in build.columns} | {c.sensor for c in build.contacts}
    sensors |= {c.sensor for c in build.user_contacts}
    data = {sensor: np.array(build.mbs.GetSensorStoredData(sensor)) for sensor in sensors}
    t = data[build.columns[0].sensor][:, 0].copy()
    if abs(t[-1] - t_end) < 1e-3 * t_end / steps:
        t[-1] = t_end  # exudyn adds its steps up: after 1e5 of them the rounding is 1e-12 of the run and more
    channels = {c.channel: c.offset + c.factor * data[c.sensor][:, 1 + c.component] for c in build.columns}
    channels |= {d.channel: d.function(channels) for d in build.derived}
    channels |= _contact_channels(build, channels, data, t)
    result = ExudynResult(
        t,
        channels,
        t_end / steps,
        wall_time,
        int(build.mbs.sys["dynamicSolver"].it.newtonStepsCount),
        build.exudyn.version,
        tuple(build.notes),
    )
    return result, _pulling(build, channels)


def _pulling(build: Build, channels: Mapping[str, np.ndarray]) -> frozenset[str]:
    """Contacts of the Hunt-Crossley family, exudyn's own, that have pulled though their law does not."""
    own, found = {columns.name for columns in build.contacts}, set()
    for contact in build.model.contacts:
        law = contact.law
        if contact.name in own and isinstance(law, HuntCrossleyFamily) and law.release_rule == "force":
            force = channels[f"{contact.name}.normal_force"]
            if np.min(force) < -PULL * np.max(np.abs(force)):
                found.add(contact.name)
    return frozenset(found)


def solve(build: Build, t_end: float, step: float, settings: ExudynSettings) -> tuple[float, int]:
    """Solve a built system; returns (wall time in s, number of steps). Raises ExudynFailed."""
    exu, mbs = build.exudyn.core, build.mbs
    steps = max(1, round(t_end / step))
    s = exu.SimulationSettings()
    ti = s.timeIntegration
    ti.endTime, ti.numberOfSteps, ti.verboseMode = t_end, steps, 0
    ti.generalizedAlpha.spectralRadius = settings.spectral_radius
    ti.generalizedAlpha.computeInitialAccelerations = True
    ti.newton.useModifiedNewton = settings.modified_newton
    ti.newton.relativeTolerance = settings.relative_tolerance
    ti.newton.absoluteTolerance = settings.absolute_tolerance
    ti.discontinuous.iterationTolerance = settings.contact_tolerance
    # a step cut at a contact switch stops the solver for exponents other than 1
    ti.discontinuous.useRecommendedStepSize = False
    s.solution.file.write = False
    s.solution.sensors.writePeriod = 1e-14
    s.linearSolver.solverType = getattr(exu.LinearSolverType, settings.linear_solver)
    kinds = exu.DynamicSolverType
    kind = kinds.GeneralizedAlpha if settings.integrator == "generalized_alpha" else kinds.TrapezoidalIndex2
    start = time.perf_counter()
    silent, exu.config.suppressWarnings = exu.config.suppressWarnings, True
    said = io.StringIO()  # some warnings come all the same, and on stdout, which is ours to write on
    try:
        with contextlib.redirect_stdout(said):
            success = mbs.SolveDynamic(s, solverType=kind, storeSolver=True)
    except RuntimeError as error:
        # exudyn's own error types derive from RuntimeError or ValueError, and its text carries the cause
        raise ExudynFailed(_failure(build, t_end, step, str(error))) from error
    finally:
        exu.config.suppressWarnings = silent
        if said.getvalue().strip():
            log.debug("exudyn: %s: %s", build.model.name, said.getvalue().strip())
    wall_time = time.perf_counter() - start
    if success is False:
        raise ExudynFailed(_failure(build, t_end, step, "SolveDynamic reports failure"))
    log.debug("exudyn: %s, %d steps in %.3g s", build.model.name, steps, wall_time)
    return wall_time, steps


def _failure(build: Build, t_end: float, step: float, cause: str) -> str:
    reached = build.mbs.systemData.GetTime()
    return (
        f"exudyn stopped at t = {reached:.6g} s of {t_end:g} s with step {step:g} s: {cause.strip()[:300]}. "
        "A smaller step usually helps"
    )


def _contact_channels(
    build: Build, channels: Mapping[str, np.ndarray], data: Mapping[int, np.ndarray], t: np.ndarray
) -> dict[str, np.ndarray]:
    zero = np.zeros(len(t))
    states = States(
        len(t),
        {n: BodyStates(*(channels.get(f"{n}.{m}", zero) for m in MOTION)) for n in build.bodies},
    )
    found: dict[str, Any] = {}
    for contact in build.contacts:
        motion = gap_motion(contact.shapes, states)
        nx, ny = motion.normal
        vector = data[contact.sensor]
        force = contact.sign * (nx * vector[:, 1] + ny * vector[:, 2])
        found |= _force_channels(contact.name, t, motion.gap, motion.rate, force)
    rates = {f"{b.name}.{c.name}": f"{b.name}.{c.rate}" for b in build.model.bodies for c in b.coordinate_records()}
    for columns in build.coordinate_contacts:
        found |= _force_channels(columns.record.name, t, *coordinate_channels(columns, dict(channels), rates))
    for user in build.user_contacts:
        recorded = data[user.sensor]
        found |= _force_channels(user.name, t, recorded[:, 1], recorded[:, 2], recorded[:, 3])
        if user.friction:
            found[f"{user.name}.friction_force"] = recorded[:, 4]
    return found


def _force_channels(
    name: str, t: np.ndarray, gap: np.ndarray, rate: np.ndarray, force: np.ndarray
) -> dict[str, np.ndarray]:
    impulse = np.concatenate(([0.0], np.cumsum(0.5 * (force[1:] + force[:-1]) * np.diff(t))))
    return {
        f"{name}.gap": gap, f"{name}.gap_rate": rate, f"{name}.normal_force": force, f"{name}.impulse": impulse,
    }  # fmt: skip
