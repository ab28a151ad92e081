"""What a slave holds: the values of its variables, its simulation, its phase; all of it can be stored and restored."""

import logging
import math
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
import numpy.typing as npt

from ..core.compiled.notices import compile_notices, hear
from ..core.errors import ModelError
from .derivatives import driven_motions
from .effective import effective
from .errors import CallOrderError, SnapshotError
from .intermediate import Updates
from .log import Log, LogCallback
from .origin import Origin
from .phases import EVENT_PHASES, RUNNING, SOUND, WAYS, Phase
from .run import Run, SimulationFactory, as_slice, build_simulation
from .settings import Settings
from .snapshot import Snapshot, identity
from .values import Values, check_values
from .variable_list import build_table
from .variables import TIME, Plan, VariableTable


class SlaveState:
    """Base of `Slave`: everything but what moves it on. The parameters are those of `Slave`."""

    def __init__(
        self,
        source: Any,
        *,
        name: str = "slave",
        variables: VariableTable | None = None,
        origin: Origin | None = None,
        on_log: LogCallback | None = None,
        logging_on: bool = False,
        event_mode: bool = False,
        early_return: bool = False,
        updates: Updates | None = None,
        simulation_factory: SimulationFactory | None = None,
        **solver: Any,
    ) -> None:
        self.model, self.settings = Settings.of(source, **solver)
        self.origin = Origin.of(source, self.model) if origin is None else origin
        self.name = name
        self.log = Log(on_log, logging_on)
        self.event_mode, self.early_return, self.updates = event_mode, early_return, updates
        self._factory = simulation_factory
        if variables is None:
            channels = build_simulation(simulation_factory, self.model, self.settings).channels
            variables = build_table(self.model, self.settings, channels, self.origin)
        self.variables = variables
        self._input_rows = {v.reference: i for i, v in enumerate(variables.block("input"))}
        self._inputs = as_slice([variables.position[v.reference] for v in variables.block("input")])
        self._time_position = variables.position[variables.by_name[TIME].reference]
        self.drivers = driven_motions(self.model)
        self.identity = identity(self.model, self.settings, variables, self.origin)
        self._run: Run | None = None
        self._spare: Run | None = None
        self.reset()

    def prepare(self) -> None:
        """Compile now what the model needs, with the values that it has: not in initialization, or in the first step.

        What cannot be built with these values may be so with those that come before initialization, whose end says
        what is wrong.
        """
        try:
            self._spare = self._build(self._values, self._start_time)
        except Exception as error:
            logging.getLogger(__name__).debug("%s cannot be prepared: %s", self.name, error)

    @property
    def phase(self) -> Phase:
        """Where the slave is in its life."""
        return self._phase

    @property
    def time(self) -> float:
        """The slave's own time, s."""
        return self._time

    # what the shim sets and gets by itself (`shared_calls.py`)

    @property
    def reals(self) -> npt.NDArray[np.float64]:
        """Values of all real variables."""
        return self._values.vectors["real"]

    def expect_questions(self, asked: bool) -> None:
        """Whether somebody has looked at outputs after the last step, and so will after the next one."""
        self._asked = asked

    @property
    def fresh(self) -> bool:
        """Whether the outputs are those of the present time and inputs."""
        return not self._stale

    @property
    def steady(self) -> bool:
        """Whether inputs are numbers that can be set between steps, and nothing else has to be thought of."""
        return self._phase is Phase.STEP and not self._values.sloped and self.updates is None

    @property
    def horizon(self) -> float:
        """Time, s, up to which steps with the present inputs only move the clock; minus infinity for none."""
        if not self.steady or self._run is None or self._untold:
            return -math.inf
        return self._run.horizon if self._stop_time is None else min(self._run.horizon, self._stop_time)

    def look(self) -> None:
        """Make the outputs those of the present time and inputs. Raises what `get` raises."""
        self._need("get values", *RUNNING)
        self._asked = True
        if self._stale:
            self._need("get outputs that were not asked for before", *SOUND)
            self._refresh()

    def give_inputs(self, reals: npt.NDArray[np.float64]) -> None:
        """Put the inputs into `reals`, in the order of `self.reals`."""
        reals[self._inputs] = self._values.vectors["real"][self._inputs]

    def take_inputs(self, reals: npt.NDArray[np.float64]) -> None:
        """Set the inputs to those in `reals`, finite ones, while `steady`."""
        self._values.vectors["real"][self._inputs] = reals[self._inputs]
        self._stale = self._untold = True

    def reset(self) -> None:
        """Back to the state of a new slave: start values, no experiment, phase `instantiated`.

        Raises
        ------
        CallOrderError : in an intermediate update.
        """
        if self._run is not None:
            self._need("reset", *(p for p in Phase if p != Phase.INTERMEDIATE))
        self._phase = Phase.INSTANTIATED
        self._values = Values(self.variables)
        self._start_time = self._time = 0.0
        self._stop_time: float | None = None
        self._rtol_given = False
        self._run = None
        self._stale = self._untold = True
        self._asked = False

    # state

    def snapshot(self) -> Snapshot:
        """The whole state. Raises CallOrderError after a failed step, whose state is worthless."""
        self._need("get the state", *(p for p in Phase if p not in (Phase.FAILED, Phase.INTERMEDIATE)))
        values = self._values.copy()
        values.forget_outputs()
        return Snapshot(
            phase=self._phase,
            start_time=self._start_time,
            stop_time=self._stop_time,
            time=self._time,
            rtol_given=self._rtol_given,
            values=values,
            applied=[] if self._run is None else self._run.applied,
            simulation=None if self._run is None else self._run.state(),
            identity=self.identity,
        )

    def restore(self, snapshot: Snapshot) -> None:
        """Take over a state that `snapshot` gave, here or in another slave of the same model and settings.

        Raises
        ------
        SnapshotError : if it is no snapshot, or belongs to another model or other settings.
        """
        self._need("set a state", *(p for p in Phase if p != Phase.INTERMEDIATE))
        if not isinstance(snapshot, Snapshot):
            raise SnapshotError(
                f"a Snapshot is needed to restore, not {type(snapshot).__name__}; bytes go through snapshot_from_bytes"
            )
        if snapshot.identity != self.identity:
            raise SnapshotError("the stored state belongs to another model or other settings")
        if snapshot.phase in EVENT_PHASES and not self.event_mode:
            raise SnapshotError(
                f"the state was stored in phase '{snapshot.phase}', and this instance has no event mode: instantiate "
                "it with eventModeUsed = true"
            )
        values = snapshot.values.copy()
        run = None
        if snapshot.simulation is not None:
            run = self._run
            if run is None or run.key != Run.key_of(values, snapshot.start_time):
                run = self._build(values, snapshot.start_time)
            try:
                run.restore(snapshot.simulation, snapshot.applied)
            except ModelError as error:  # a state that the simulation refuses leaves it as it was
                raise SnapshotError(f"the stored state is refused: {error}") from error
            except BaseException:  # what is left may be half of each
                self._phase = Phase.FAILED
                raise
        self._run, self._values = run, values
        self._phase, self._rtol_given = snapshot.phase, snapshot.rtol_given
        self._start_time, self._stop_time, self._time = snapshot.start_time, snapshot.stop_time, snapshot.time
        self._stale = True
        self._untold = run is None or snapshot.applied != values.courses

    def snapshot_from_bytes(self, data: bytes) -> Snapshot:
        """The snapshot whose `.data` is `data`. Raises SnapshotError if it is none, or not of this slave's kind."""
        return Snapshot.from_data(data, self.variables, self.identity)

    # inside

    # `_stale`: the outputs are not those of the present time and inputs; `_untold`: the simulation does not know all
    # inputs yet; `_asked`: outputs have been asked for since the last step. Outputs are read when they are asked for,
    # since a step does not cost much more than asking; or with the step, if they were asked for after the one before.

    def _need(self, what: str, *phases: Phase) -> None:
        if self._phase not in phases:
            raise CallOrderError(f"cannot {what} in phase '{self._phase}': {WAYS[self._phase]}")

    def _build(self, values: Values, start_time: float) -> Run:
        spare, self._spare = self._spare, None
        if spare is not None and spare.key == Run.key_of(values, start_time):
            return spare
        with hear(self.log.tell), compile_notices(f"'{self.name}' (model {self.model.name})"):
            return Run(self._factory, self.model, self.settings, values, start_time, self.origin)

    def _engine(self) -> Run:
        if self._run is None:
            self._run = self._build(self._values, self._start_time)
        return self._run

    def _checked(self, plan: Plan, values: Iterable[Any]) -> Any:
        """`values` for the variables of `plan`. Raises FmuValueError if one of them cannot take its own."""
        checked = check_values(plan, values)
        if "parameter" in plan.roles and self.origin is not None:
            for variable, value in zip(plan.variables, checked, strict=True):
                if variable.block == "scenario":
                    self.origin.check(variable, value)
        return checked

    def _found(self, plan: Plan, found: npt.NDArray[Any]) -> npt.NDArray[Any]:
        """The values `found` of the variables of `plan`, with those of parameters that follow from others."""
        if self.origin is None or "parameter" not in plan.roles:
            return found
        if self._run is not None:
            following = self._run.following
        else:
            try:
                following = effective(self.model, self.settings, self._values, self.origin).following
            except ModelError:  # values that do not fit together, as long as others are to come
                return found
        for place, variable in enumerate(plan.variables):
            found[place] = following.get(variable.reference, found[place])
        return found

    def _refresh(self) -> None:
        """Make the outputs fit the parameters and inputs.

        What goes wrong leaves a simulation that may have taken an input and not restarted, and that would hold the
        input for applied: in initialization it is dropped and built anew when next needed, later the slave is `failed`.
        """
        try:
            run = self._engine()
            self._tell(run)
            run.read(self._values)
        except BaseException:
            if self._phase == Phase.INITIALIZATION:
                self._run, self._untold = None, True
            else:
                self._phase = Phase.FAILED
            raise
        self._stale = False

    def _tell(self, run: Run) -> None:
        """Tell the simulation the inputs, if any were set since it was told."""
        if self._untold:
            run.apply_inputs(self._values)
            self._untold = False

    def _set_time(self, t: float) -> None:
        self._time = t
        self._values.vectors["real"][self._time_position] = t

    @contextmanager
    def _failing(self) -> Iterator[None]:
        """What goes wrong in here leaves half a step, an interrupt from the keyboard too."""
        try:
            yield
        except BaseException:
            self._phase = Phase.FAILED
            raise
