"""The slave: one simulation behind a step interface as FMI co-simulation wants it, for FMI 2.0 and 3.0 alike.

Phases: instantiated -> initialization -> step -> terminated; with event mode, initialization leads to `event`, a step
that ends at an event to `event due`, and from both the way to `step` leads through event mode. A failed step, or an
input for which outputs cannot be computed, leads to `failed`, from where a stored state or a reset leads back. The
methods raise; `calls.py` turns what they raise into FMI statuses.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from typing import Any

import numpy as np
import numpy.typing as npt

from . import log as logs
from .errors import CallOrderError, FmuValueError, Status
from .grid import check_step
from .intermediate import Updates
from .phases import EVENT_PHASES, INPUTS, RUNNING, SETTABLE, Phase
from .run import Run, StepEnd
from .slave_derivatives import SlaveDerivatives
from .values import item_value
from .variables import Kind, Variable

MOST_STEPS = 1e12
"""Steps of the solver, as long as its next one, beyond which a communication step is taken for a mistake: months."""


class Slave(SlaveDerivatives):
    """A model with its solver as a co-simulation slave.

    Parameters
    ----------
    source : Model, or Scenario with `.model` and its solver settings.
    name : name of the instance, for the log.
    variables : the variable table that an FMU was exported with; None builds it, which needs a simulation.
    origin : the scenario of the catalogue that an FMU was exported from; None if it is `source`, or none.
    on_log : called with status, category and message; None passes messages to `logging`.
    logging_on : True passes on all categories, False errors only.
    event_mode : contact events at the end of a step are left to `update_discrete_states`, in event mode.
    early_return : a step may end before its time, at a contact event.
    updates : intermediate updates, None for none.
    simulation_factory : makes the simulation; None is `tlismni.core.Simulation`.
    solver : `method`, `rtol`, `atol`, `step` and options of the method; they win over the scenario's.

    Examples
    --------
    >>> slave = Slave(scenario, rtol=1e-8)           # doctest: +SKIP
    >>> slave.enter_initialization(); slave.exit_initialization()   # doctest: +SKIP
    >>> slave.do_step(0.0, 0.01); slave["ball.y"]    # doctest: +SKIP
    """

    # life

    def setup(self, start_time: float = 0.0, stop_time: float | None = None, tolerance: float | None = None) -> None:
        """Fix the experiment: times in s; `tolerance` is taken as rtol unless `solver.rtol` is set by name.

        Raises
        ------
        CallOrderError : after initialization mode was entered.
        FmuValueError : for figures that are not finite, or a stop that is not after the start.
        """
        self._need("setup", Phase.INSTANTIATED)
        for name, value in (("start time", start_time), ("stop time", stop_time), ("tolerance", tolerance)):
            if value is not None and not math.isfinite(value):
                raise FmuValueError(f"the {name} is {value!r}: a finite number is needed")
        if stop_time is not None and stop_time < start_time:
            raise FmuValueError(f"the stop time {stop_time!r} s is before the start time {start_time!r} s")
        if tolerance is not None and tolerance <= 0.0:
            raise FmuValueError(f"the tolerance is {tolerance!r}: a number greater than 0 is needed")
        self._start_time, self._stop_time = float(start_time), stop_time
        self._set_time(self._start_time)
        if tolerance is not None and not self._rtol_given:
            self._values[self.variables.by_name["solver.rtol"]] = float(tolerance)

    def enter_initialization(self) -> None:
        """Go to initialization mode. Raises CallOrderError unless the slave is freshly instantiated or reset."""
        self._need("enter initialization mode", Phase.INSTANTIATED)
        self._phase = Phase.INITIALIZATION

    def exit_initialization(self) -> None:
        """Build the simulation at its start; go to step mode, or to event mode if there is one. On an error the slave
        stays in this mode.

        Raises
        ------
        CallOrderError, ModelError, ConsistencyError, FmuError
        """
        self._need("exit initialization mode", Phase.INITIALIZATION)
        self._refresh()
        self._engine().close_start()
        self._phase = Phase.EVENT if self.event_mode else Phase.STEP

    def enter_event_mode(self) -> None:
        """Go from step mode to event mode. Raises CallOrderError if this slave has none, or elsewhere."""
        if not self.event_mode:
            raise CallOrderError("this instance has no event mode: instantiate it with eventModeUsed = true")
        self._need("enter event mode", Phase.STEP, Phase.EVENT_DUE)
        self._phase = Phase.EVENT

    def update_discrete_states(self) -> bool:
        """Let the contact event at the present time happen, if one is due. True if it entails another at once.

        Raises
        ------
        CallOrderError : outside event mode.
        SimulationError, FmuError : the solver failed; the slave is in phase `failed`.
        """
        self._need("update discrete states", Phase.EVENT)
        run = self._engine()
        seen = len(run.events)
        self._stale = True
        with self._failing():
            self._tell(run)
            again = run.handle_event()
        self._log_events(run, seen)
        return again

    def enter_step_mode(self) -> None:
        """Go from event mode to step mode. Raises CallOrderError elsewhere."""
        self._need("enter step mode", Phase.EVENT)
        self._phase = Phase.STEP

    def terminate(self) -> None:
        """End the run; values can still be read."""
        self._need("terminate", Phase.STEP, *EVENT_PHASES, Phase.FAILED)
        self._phase = Phase.TERMINATED

    def do_step(self, t: float, h: float) -> StepEnd:
        """Advance from `t` by `h`, s, impacts included.

        `t` must be the slave's own time within rounding. The step ends at `t + h` in the master's rounding, so
        that a master that counts its steps does not drift away from the slave; or at a contact event before, if the
        slave was made with `early_return`. With `event_mode` an event at the end has not happened yet.

        Raises
        ------
        CallOrderError : outside step mode.
        FmuValueError : for a wrong `t`, an `h` that is not positive, a step past the stop time. Nothing happened.
        SimulationError, FmuError : the solver failed; the slave is in phase `failed`.
        """
        if self._phase is not Phase.STEP:
            self._need("do step", Phase.STEP)
        target = check_step(self._time, t, h, self._stop_time)
        run = self._engine()
        if h > MOST_STEPS * run.step_size:
            raise FmuValueError(
                f"a communication step of {h!r} s would never end: the solver steps by {run.step_size:.3g} s; ask for "
                "a shorter one"
            )
        seen = len(run.events)
        asked, self._asked, self._stale = self._asked, False, True
        try:  # not `_failing`: a context manager at every step is dear
            if self.updates is not None:
                end = self._advance_with_updates(run, target, self.updates)
            elif run.quick and not (self.event_mode or self.early_return or self._values.sloped):
                end = self._drive(run, target, asked)
            else:
                self._tell(run)
                end = run.advance(target, self.event_mode, self.early_return)
                self._arrive(run, end.time)
        except BaseException:
            self._phase = Phase.FAILED
            raise
        if end.event_due:
            self._phase = Phase.EVENT_DUE
        if len(run.events) != seen:
            self._log_events(run, seen)
        if asked and self._stale:
            self._foresee(run)
        return end

    def _drive(self, run: Run, t: float, read: bool) -> StepEnd:
        """Take the simulation to `t`, s, with the present inputs, and read the outputs if wanted and easily had."""
        self._stale = not run.drive(self._values, t, read)
        self._untold = False
        self._set_time(t)
        return StepEnd(t)

    def _foresee(self, run: Run) -> None:
        """After a step, make the outputs those of its end. If they cannot be computed, who asks will hear why."""
        with suppress(Exception):
            run.read(self._values)
            self._stale = False

    def catch_up(self, t: float, read: bool = False) -> None:
        """Move the clock to `t`, s, within the horizon, after steps that nobody told of; `read`: outputs come next."""
        run = self._engine()
        self._stale = True
        with self._failing():
            if read and run.quick and not (self.event_mode or self.early_return):
                self._drive(run, t, read)
            else:
                run.advance(t, self.event_mode, self.early_return)
                self._arrive(run, t)

    def _arrive(self, run: Run, t: float) -> None:
        """The simulation is at `t`, s, and so are the inputs that go on with derivatives."""
        if self._values.go_on(t - self._time):
            run.follow(self._values)
        self._set_time(t)
        self._stale = True

    def _advance_with_updates(self, run: Run, target: float, updates: Updates) -> StepEnd:
        """Advance to `target`, s, with an intermediate update where each step of the solver ends on the way."""
        goal = target
        while True:
            self._tell(run)
            end = run.advance(run.next_point(goal), self.event_mode, self.early_return, goal)
            self._arrive(run, end.time)
            if end.early or end.event_due or end.time >= goal:
                return StepEnd(end.time, end.event_due, end.time < target)
            self._phase = Phase.INTERMEDIATE
            wanted = updates.call(end.time, self.early_return)
            self._phase = Phase.STEP
            if self.early_return and wanted is not None:
                goal = min(goal, wanted)
                if goal <= end.time:
                    self._tell(run)
                    return StepEnd(end.time, early=True)

    def _log_events(self, run: Run, seen: int) -> None:
        if self.log.wants(logs.EVENTS):
            for event in run.events[seen:]:
                text = f"{event.kind} of contact '{event.contact}' at t = {event.t!r} s"
                unit = run.unit(f"{event.contact}.impulse", "N.s").replace(".", " ")
                self.log.write(Status.OK, logs.EVENTS, f"{text}, impulse {event.impulse:.6g} {unit}")

    # values

    def get(self, kind: Kind, references: npt.NDArray[np.uint32]) -> Any:
        """Values of the variables of `kind` behind `references`, as an array; not before initialization mode.

        Raises
        ------
        CallOrderError, FmuValueError : nothing happened.
        ModelError, ConsistencyError, SimulationError, FmuError : outputs cannot be computed for the parameters and
            inputs set; after initialization mode the slave is in phase `failed`.
        """
        self._need("get values", *RUNNING)
        plan = self.variables.plan(kind, references)
        if "output" in plan.roles:
            self.look()
        return self._found(plan, self._values.vectors[kind].take(plan.positions))

    def set(self, kind: Kind, references: npt.NDArray[np.uint32], values: Iterable[Any]) -> None:
        """Set the variables of `kind` behind `references`: all of them or, on an error, none.

        Inputs can be set in step mode too, parameters only before it.

        Raises
        ------
        CallOrderError, FmuValueError
        """
        plan = self.variables.plan(kind, references)
        if self._phase is not Phase.STEP or plan.roles != INPUTS:  # by far the most calls
            self._need("set values", *SETTABLE)
            if not plan.roles <= SETTABLE[self._phase]:
                self._refuse(plan.variables)
        if self._phase == Phase.INTERMEDIATE and self.updates is not None:
            self.updates.check(plan.variables)
        self._values.vectors[kind][plan.positions] = self._checked(plan, values)
        self._stale = self._untold = True
        if self._values.sloped and kind == "real" and "input" in plan.roles:
            self._values.end_slopes(plan.positions, self._time)
        if "parameter" in plan.roles:
            self._rtol_given |= any(v.name == "solver.rtol" for v in plan.variables)
            self._run = None

    def _refuse(self, variables: Sequence[Variable]) -> None:
        for v in variables:
            if v.role not in ("input", "parameter"):
                raise FmuValueError(f"'{v.name}' is of role {v.role} and cannot be set")
            if v.role not in SETTABLE[self._phase]:
                raise CallOrderError(f"parameter '{v.name}' is fixed after initialization: reset, then set it before")

    def set_by_name(self, values: Mapping[str, Any]) -> None:
        """`set` for Python users: values by variable name, those of enumerations by name too."""
        for name, value in values.items():
            variable = self._named(name)
            if variable.items and isinstance(value, str):
                value = item_value(variable, value)
            self.set(variable.kind, np.array([variable.reference], dtype=np.uint32), [value])

    def __getitem__(self, name: str) -> Any:
        """Value of the variable `name`; of a setting or law that is an enumeration, its item."""
        variable = self._named(name)
        value = self.get(variable.kind, np.array([variable.reference], dtype=np.uint32))[0]
        if variable.items and variable.role != "output":
            return variable.item(value)
        return value if variable.kind == "string" else value.item()

    def _named(self, name: str) -> Variable:
        try:
            return self.variables.by_name[name]
        except KeyError:
            raise FmuValueError(f"no variable '{name}'; there are {sorted(self.variables.by_name)}") from None
