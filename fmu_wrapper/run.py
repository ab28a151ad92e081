"""The simulation under a slave: built from variable values, told its inputs, read into variable values."""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ..core.multibody_model import Model
from .derivatives import check_finite
from .effective import effective
from .errors import FmuError
from .origin import Origin
from .settings import Settings
from .values import Values
from .variables import EVENTS, Variable, VariableTable

SimulationFactory = Callable[..., Any]

MAX_STEPS = 1_000_000
"""Steps of the solver within one communication step, if the settings say nothing: a master is not kept for hours by an
input that is out of proportion, which it could not tell from a hang."""


def real_simulation(*args: Any, **kwargs: Any) -> Any:
    """`tlismni.core.Simulation`, imported when the first slave needs it."""
    from ..core import Simulation

    return Simulation(*args, **kwargs)


def build_simulation(factory: SimulationFactory | None, model: Model, settings: Settings, t0: float = 0.0) -> Any:
    """A simulation of `model` with `settings` that starts at `t0`, s."""
    return (factory or real_simulation)(
        model,
        method=settings.method,
        rtol=settings.rtol,
        atol=settings.tolerance,
        step=settings.step or None,
        t0=t0,
        **{"max_steps": MAX_STEPS, **settings.options},
    )


def as_slice(positions: list[int]) -> slice | npt.NDArray[np.intp]:
    """Positions that follow one another as a slice, which is faster; others as an array."""
    first, last = (positions[0], positions[-1] + 1) if positions else (0, 0)
    return slice(first, last) if positions == list(range(first, last)) else np.array(positions, dtype=np.intp)


class StepEnd(NamedTuple):
    """How a step ended: where (s), whether with an event that has not happened yet, whether before its time."""

    time: float
    event_due: bool = False
    early: bool = False


class Run:
    """A simulation built for the parameter values in `values`. `following` are the values of parameters that follow
    from others, by reference.

    Raises
    ------
    ModelError, ConsistencyError : if it cannot be built.
    FmuError : if it lacks a channel of the variable table.
    """

    def __init__(
        self,
        factory: SimulationFactory | None,
        model: Model,
        settings: Settings,
        values: Values,
        t0: float,
        origin: Origin | None = None,
    ) -> None:
        self.key = self.key_of(values, t0)
        inputs = values.table.block("input")
        self._input_names = [v.name for v in inputs]
        self._applied: list[list[float]] = [[float(v.start or 0.0) for v in inputs]]
        self._events = values.table.position[values.table.by_name[EVENTS].reference]
        found = effective(model, settings, values, origin)
        self.following = found.following
        self._simulation = build_simulation(factory, found.model, found.settings, t0)
        self._set_columns(values.table)
        self._exchange = getattr(self._simulation, "exchange", None)
        if self._exchange is not None:
            self._simulation.prepare_exchange()

    @staticmethod
    def key_of(values: Values, t0: float) -> tuple[Any, ...]:
        """What a simulation is built from: equal keys can share a simulation."""
        table = values.table
        return (t0, *(values[v] for v in table.of_role("parameter")))

    def _set_columns(self, table: VariableTable) -> None:
        column = {channel.name: i for i, channel in enumerate(self._simulation.channels)}
        wanted = table.block("channel")
        missing = [v.name for v in wanted if v.name not in column]
        if missing:
            raise FmuError(
                f"the simulation has no channels {missing}, which this FMU was exported with: the installed "
                "version of tlismni names them differently; export the FMU anew"
            )
        self._names = [channel.name for channel in self._simulation.channels]
        self._units = {channel.name: channel.unit for channel in self._simulation.channels}
        self._columns = [
            (
                kind,
                as_slice([table.position[v.reference] for v in wanted if v.kind == kind]),
                np.array([column[v.name] for v in wanted if v.kind == kind], dtype=np.intp),
            )
            for kind in sorted({v.kind for v in wanted})
        ]

    @property
    def applied(self) -> list[list[float]]:
        """The courses of the inputs, as the simulation has been told."""
        return self._applied

    @property
    def events(self) -> Sequence[Any]:
        """Events so far."""
        return self._simulation.events

    def derivatives(self, outputs: Sequence[Variable], direction: Mapping[str, float]) -> npt.NDArray[np.float64]:
        """Derivatives of real outputs along `direction`, by input name, at the present time."""
        column = {name: i for i, name in enumerate(self._names)}
        found = self._simulation.input_derivatives(direction)[[column[v.name] for v in outputs]]
        check_finite(outputs, found)
        return found

    def close_start(self) -> None:
        """The start is over: motions that are set from now on go on from where they are."""
        self._simulation.close_start()

    def rates(self, outputs: Sequence[Variable]) -> npt.NDArray[np.float64]:
        """Time derivatives of real outputs at the present time, NaN where they are not known."""
        column = {name: i for i, name in enumerate(self._names)}
        return np.asarray(self._simulation.output_rates()[[column[v.name] for v in outputs]])

    def apply_inputs(self, values: Values) -> None:
        """Tell the simulation the inputs that changed."""
        wanted = values.courses
        if wanted == self._applied:
            return
        told = dict(zip(self._input_names, wanted[0], strict=True))
        if len(wanted) > 1:
            self._simulation.set_inputs(told, dict(zip(self._input_names, zip(*wanted[1:], strict=True), strict=True)))
        else:
            self._simulation.set_inputs(told)
        self._applied = wanted

    @property
    def quick(self) -> bool:
        """Whether there is `drive`."""
        return self._exchange is not None

    def drive(self, values: Values, t: float, read: bool) -> bool:
        """Tell the simulation the inputs, which have no derivatives, integrate to `t`, s, events included, and read if
        that is wanted. False if it was not, or the values have to be asked for."""
        inputs = values.vectors["real"].take(values.inputs).tolist()
        found = self._exchange(inputs, t, read)  # type: ignore[misc]
        self._applied = [inputs]
        if found is None:
            return False
        self._put(found, values)
        return True

    def follow(self, values: Values) -> None:
        """The inputs have gone on by their derivatives, as the simulation knows."""
        self._applied = values.courses

    def next_point(self, t: float) -> float:
        """Where the solver's newest step ends, s, at most `t`; a step is made if there is none beyond the present."""
        return float(self._simulation.next_point(t))

    def advance(
        self, t: float, event_mode: bool = False, early_return: bool = False, goal: float | None = None
    ) -> StepEnd:
        """Integrate to `t`, s, on the way to `goal` (None: `t`), or to a contact event before that if `early_return`.

        With `event_mode` a contact event at the goal is left to `handle_event`. All others happen in here.
        """
        simulation, last = self._simulation, t if goal is None else goal
        if not (event_mode or early_return):
            simulation.advance(t)
            return StepEnd(t)
        while simulation.advance_to_event(t):
            reached = float(simulation.t)
            early = early_return and reached < last
            if event_mode and (early or reached >= last):
                return StepEnd(reached, event_due=True, early=early)
            while simulation.handle_event():
                pass
            if early:
                return StepEnd(reached, early=True)
        return StepEnd(t)

    @property
    def step_size(self) -> float:
        """Size of the solver's next step, s."""
        return float(self._simulation.step_size)

    @property
    def horizon(self) -> float:
        """Time up to which the solver has gone without an event, s."""
        return float(self._simulation.horizon)

    def unit(self, channel: str, otherwise: str) -> str:
        """Unit of a channel; `otherwise` if the simulation does not show it."""
        return self._units.get(channel, otherwise)

    def handle_event(self) -> bool:
        """Let a contact event at the present time happen, if one is due. True if it entails another at once."""
        return bool(self._simulation.handle_event())

    def read(self, values: Values) -> None:
        """Put the channels and the number of events into `values`.

        Raises
        ------
        FmuError : if one is not finite.
        """
        found = np.asarray(self._simulation.values(), dtype=np.float64)
        # a sum that is finite has finite terms, and costs a third of looking at each
        if not math.isfinite(found.sum()) and not np.isfinite(found).all():
            bad = [f"{name} = {x}" for name, x in zip(self._names, found, strict=True) if not np.isfinite(x)]
            raise FmuError(
                f"at t = {self._simulation.t!r} s these values are not finite: {', '.join(bad)}; "
                "the model runs away or a parameter is wrong: check parameters and inputs, use smaller steps"
            )
        self._put(found, values)

    def _put(self, found: npt.NDArray[np.float64], values: Values) -> None:
        """Put finite channels and the number of events into `values`."""
        for kind, positions, columns in self._columns:
            values.vectors[kind][positions] = found.take(columns) if kind == "real" else np.rint(found.take(columns))
        values.vectors["integer"][self._events] = len(self._simulation.events)

    def state(self) -> Any:
        """The solver's state."""
        return self._simulation.state()

    def restore(self, state: Any, applied: list[list[float]]) -> None:
        """Take over a solver state (or its bytes) and the inputs that it has been told."""
        if isinstance(state, bytes):
            state = type(self._simulation.state()).from_bytes(state)
        self._simulation.restore(state)
        self._applied = applied
