"""simulate: one call from a model to a result."""

import math
from collections.abc import Callable, Mapping
from dataclasses import asdict
from numbers import Integral, Real
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from .compiled.stopwatch import RunWatch
from .compiled_model import compile_model
from .errors import ModelError, SimulationError, TlismniError
from .input_schedule import CourseRun
from .input_signals import Courses, Given, courses
from .methods.default import DEFAULT_METHOD
from .results.result import Result
from .simulation.impulse_step_warnings import warn_of_energy, warn_of_overlap
from .simulation.simulation import Simulation
from .tolerances import DEFAULT_ATOL

MOST_STEPS = 1e12
"""Fixed steps beyond this number are a slip of the pen: they would take days."""


def simulate(
    system: Any,
    t_end: float,
    method: str = DEFAULT_METHOD,
    rtol: float = 1e-6,
    atol: float | Mapping[str, float] = DEFAULT_ATOL,
    *,
    step: float | None = None,
    t_eval: ArrayLike | None = None,
    t0: float = 0.0,
    record: bool | int = True,
    progress: Callable[[float], None] | None = None,
    start_values: Mapping[str, float] | None = None,
    inputs: Given | Courses | None = None,
    **options: Any,
) -> Result:
    """Integrate a `Model` or `EquationSystem` from t0 to t_end.

    Parameters
    ----------
    system : Model or EquationSystem.
    t_end : end time, s.
    method : one of `METHODS`, which describes them, or "auto": chosen from the model, its start and the tolerance;
        `Result.method_chosen` says what was taken and why. With fixed steps, an outer loop other than newton, or the
        option `k` or `angle`, "auto" is "ebdf".
    rtol, atol : tolerances of the error control, on coordinates and velocities. atol's default, `OfScales(1e-9)`,
        is a part of the model's own scales (`Simulation.scales`); a plain number counts as it stands, in the units of q
        and v, and so do those of a mapping by kind ("length", "angle", "speed", "angular_speed").
    step : fixed step in s instead of error control.
    t_eval : times to record (ascending, within [t0, t_end]); left out: every step, and twice at impacts.
    record : False records only start and end (for timing); a number k records every k-th step, what happens at
        contacts, and the end: for models so large that all steps would fill the memory.
    progress : called with the time reached, now and then.
    start_values : coordinates and rates at the start by the names of their channels ("ball.y", "ball.vy"), in place of
        those of the model; `Result.start_at` gives those of another run, to go on from there.
    inputs : for names of inputs the number that they keep, or (times, values) with straight lines between, or
        `Courses`; left out: their start values. Motions that they lead follow them exactly (docs/inputs.md).
    options : method options (alpha, order, k ...) and those of `Simulation`: `max_step` (error control sees a load
        only at the points of a step: own equations say by `times` when they jump), `first_step`,
        `outer`, `acceleration`, `depth`, `fallback`, `controller`, `newton_tolerance`, `start_tolerance`,
        `step_records`, `redundant` ("drop": constraints that repeat others are left out of the equations and checked;
        "refuse": they are an error).

    Returns
    -------
    Result. A failed run raises SimulationError, which carries the partial result as `.partial`; so does the
    KeyboardInterrupt of Ctrl-C.

    Raises
    ------
    ModelError : for bad arguments. ConsistencyError : for a start that does not meet the constraints.
    """
    check_end(t0, t_end)
    t0, t_end = float(t0), float(t_end)
    if isinstance(step, Real) and step > 0.0 and (t_end - t0) / step > MOST_STEPS:
        raise ModelError(
            f"step = {step!r} would take {(t_end - t0) / step:.3g} steps from t0 to t_end: use a larger one"
        )
    times = None if t_eval is None else check_times(t_eval, t0, t_end)
    settings = {"step": step, "t0": t0, "record": _check_stride(record) if times is None else 0, **options}
    if start_values is None:
        sim = Simulation(system, method, rtol, atol, **settings)
    else:
        sim = compile_model(system, method, rtol, atol, **settings).simulation(start=start_values)
    sim.progress = progress
    course = None if inputs is None else courses(inputs)
    watch = RunWatch()
    rows = []
    led: CourseRun | None = None

    def run_to(until: float) -> None:
        if led is None:
            sim.run_to(t_end, until=until)
        else:
            led.run_to(t_end, until)

    try:
        led = None if course is None else CourseRun(course, sim)
        if times is None:
            if not record:
                rows.append(sim.sample())
            run_to(t_end)
            if not record:
                rows.append(sim.sample())
            elif record > 1:
                sim.record_end()
        else:
            for t in times:
                run_to(float(t))
                rows.append(sim.sample())
                sim.report_progress(float(t))
            run_to(t_end)
    except TlismniError as error:
        if isinstance(error, SimulationError):
            error.partial = _result(sim, rows, watch.stop())
        raise
    except KeyboardInterrupt as stop:
        stop.partial = _result(sim, rows, watch.stop())  # type: ignore[attr-defined]
        raise
    finally:
        watch.stop()
    return _result(sim, rows, watch.stop())


def _result(sim: Simulation, rows: list[Any], wall_time: float) -> Result:
    sim.flush()
    blocks = sim.samples if sim.samples else [row[None, :] for row in rows]
    samples = np.concatenate(blocks) if blocks else np.zeros((0, sim.buffer.shape[1]))
    if sim.formula.impulses:
        warn_of_overlap(samples, sim.assembly, sim.table.layout)
        warn_of_energy(samples, len(sim.assembly.contacts), sim.table.layout)
    steps = np.concatenate(sim.step_logs) if sim.step_logs else None
    stats = {**sim.stats, "wall_time": wall_time}
    return Result(
        samples, sim.table, sim.events, stats, sim.fallbacks, steps, sim.redundant, sim.system, asdict(sim.settings)
    )


def _check_stride(record: bool | int) -> int:
    if not isinstance(record, Integral) or record < 0:
        raise ModelError(f"record = {record!r} must be True, False, or the number of steps between two samples")
    return int(record)


def check_end(t0: float, t_end: float) -> None:
    """Raise ModelError for times that are not finite, or an end before the start."""
    for name, value in (("t0", t0), ("t_end", t_end)):
        if isinstance(value, bool) or not isinstance(value, Real) or not math.isfinite(value):
            raise ModelError(f"{name} must be a finite number, not {value!r}")
    if t_end < t0:
        raise ModelError(f"t_end = {float(t_end)!r} lies before t0 = {float(t0)!r}")


def check_times(t_eval: ArrayLike, t0: float, t_end: float) -> np.ndarray:
    """`t_eval` as an array (times,). Raises ModelError unless it ascends within [t0, t_end]."""
    try:
        times = np.asarray(t_eval, dtype=float)
    except (TypeError, ValueError):
        raise ModelError(f"t_eval must be a list of times, not {t_eval!r}") from None
    if times.ndim != 1 or not np.all(np.isfinite(times)):
        raise ModelError(f"t_eval must be a list of finite times, not an array of shape {times.shape}")
    if len(times) and (times[0] < t0 or times[-1] > t_end or np.any(np.diff(times) < 0)):
        raise ModelError(
            f"t_eval must ascend within [t0, t_end] = [{t0:g}, {t_end:g}]; it goes from {times[0]:g} to {times[-1]:g}"
        )
    return times
