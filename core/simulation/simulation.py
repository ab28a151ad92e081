"""Simulation: one run that can be stepped, asked, driven, stored and restored."""

import math
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ConsistencyError, ModelError, SimulationError
from ..events import Event
from ..state.workspace_records import COUNTERS_SIZE
from . import advance, exchange, inputs, motions, output_rates, restore, sensitivity
from .engine import Engine, user_errors
from .painleve import jam
from .state import State

_COUNTER_NAMES = (
    "steps", "rejected", "outer_iterations", "inner_iterations", "factorizations", "partitions",
    "residual_evaluations", "stages", "analyses", "krylov_iterations", "impulse_steps",
    "impacts_in_rounds", "unshared_loads", "left_approaches", "unfinished_sweeps",
)  # fmt: skip


def just_after(t: float) -> float:
    """A time after `t`, s, that no step ends before: a step is longer."""
    return t + 8.0 * math.ulp(t)


class Simulation(Engine):
    """One run of a system.

    Parameters
    ----------
    system : a Model or an EquationSystem.
    method : name of an integration method (`tlismni.core.methods.registry.METHODS`), or "auto": chosen from the model,
        its start and the tolerance; `settings.method_chosen` says what was taken and why.
    rtol, atol : tolerances of the error control. atol's default, `OfScales(1e-9)`, is a part of the model's own scales
        (`scales`); a plain number counts as it stands, in the units of q and v; it may be a mapping with any of
        "length" (m), "angle" (rad), "speed" (m/s), "angular_speed" (rad/s), the others are the default.
    step : fixed step in s; None: error-controlled steps.
    max_step, first_step : bounds of error-controlled steps, s.
    max_steps : most steps (and instants with events) between two times that are asked for, None for no limit: a
        SimulationError then, in place of a run that would not end in this life.
    t0 : start time, s.
    outer : "newton", "simple" or "jfnk", the outer loop of the stage solver (`tlismni.core.stage.OUTER_LOOPS`).
    acceleration : "none", "aitken" or "anderson", of outer = "simple"; depth : that of Anderson's, 1 to 5.
    fallback : let newton take over if the outer loop fails; `fallbacks` says when and why, and a warning is logged.
    controller : "elementary", "pi" or "h211b", how one-step methods choose their next step.
    newton_tolerance : where the outer loop stops; with `step` an absolute and relative tolerance on q and v
        (default 2e-10 of the scales), else a fraction of the error weights (default 0.01, irk 0.0005).
    start_tolerance : how far q0 and v0 may be moved to meet the constraints (relative).
    redundant : "drop": constraints that repeat others are left out of the equations but checked, and listed in the
        attribute of this name; "refuse": they are an error.
    record : keep a sample at every step; a number k: at every k-th step.
    step_records : keep size, error, order and iterations of every step (`step_logs`).
    method_options : see the method.

    Raises
    ------
    ModelError, ConsistencyError : before anything is computed.
    """

    reported_division: bool = False
    """That steps are divided has been said: once is enough."""
    reported_jumps: frozenset[int] = frozenset()
    """Rows of the motions whose large jumps have been said: once is enough."""
    stored_events: tuple[Event, ...] = ()
    """The events as the last state had them: states share them until one is added."""

    @cached_property
    def model_hash(self) -> str:
        """Hash of the model and the settings: a state fits only these."""
        return restore.model_hash(self)

    # ---- running --------------------------------------------------------------------------------------------------

    def advance(self, t: float) -> None:
        """Integrate to exactly `t` (s), events included.

        Raises
        ------
        ModelError : if t is not finite or before the present time.
        SimulationError : if the run fails; what was reached stays.
        """
        goal = self._goal(t)
        self._close_jumps(goal[0])
        newest = self.t_internal
        # most points of a fine grid lie within the newest step: there is nothing to do but to ask
        if newest < goal[0] or (newest == goal[0] and self.pending):
            self._advance_to(*goal)
        self.t = goal[0]

    def close_start(self) -> None:
        """From now on motions that inputs lead go on from where they are; until then (or the first step) the run
        starts where they are set."""
        self.start_open = False

    def _close_jumps(self, t: float) -> None:
        if self.assembly.motions:
            self.close_start()
            with self._failures():
                motions.close_jumps(self, t)

    def _goal(self, t: float) -> tuple[float, float]:
        """Where to go, and where a step must end because inputs are expected to change."""
        if not math.isfinite(t) or t < self.t:
            raise ModelError(f"cannot advance from t = {self.t!r} to {t!r}: the time must be finite and not earlier")
        return float(t), inputs.next_stop(self.input_times, self.t, float(t))

    def advance_to_event(self, t: float) -> bool:
        """Integrate to `t` (s) or to the first contact event before or at it; True if there is one.

        The present time is then the event's, and `values` are those before it: `handle_event` lets it happen, and so
        does going on. Events at the present time happen first. With `handle_event` after each, the run is the same as
        that of `advance`, bit for bit.

        Raises
        ------
        ModelError, SimulationError : as `advance`.
        """
        start, (target, stop) = self.t, self._goal(t)
        self._close_jumps(target)
        with self._failures():
            while True:
                while self.event_due:
                    self._handle_pending()
                advance.advance_to(self, target, stop, hold=True)
                if not self.pending or self.t_internal > target:
                    self.t = target
                    return False
                if self.t_internal > start:
                    self.t = self.t_internal
                    return True

    def next_point(self, t: float) -> float:
        """Where the solver's newest step ends, s, but at most `t`; a step is made if none goes beyond the present time.

        The present time stays: `advance` or `advance_to_event` go there.

        Raises
        ------
        ModelError, SimulationError : as `advance`.
        """
        target, stop = self._goal(t)
        self._close_jumps(target)
        with self._failures():
            while self.event_due:
                self._handle_pending()
            if self.t_internal <= self.t:
                advance.advance_to(self, just_after(self.t), stop, hold=True)
        return min(self.t_internal, target)

    @property
    def step_size(self) -> float:
        """Size of the solver's next step, s: the fixed one, or what error control proposes."""
        return float(self.clock.fixed_step or self.clock.step_size)

    @property
    def divided_steps(self) -> int:
        """Fixed steps that did not converge and were divided inside."""
        return int(self.clock.divided_steps)

    @property
    def horizon(self) -> float:
        """Time, s, up to which the run is computed with the present inputs and all events have happened."""
        newest = self.t_internal
        return math.nextafter(newest, -math.inf) if self.pending else newest

    @property
    def event_due(self) -> bool:
        """True if the present time is that of a contact event that has not happened yet."""
        return bool(self.pending) and self.t_internal == self.t

    def handle_event(self) -> bool:
        """Let a contact event at the present time happen, if one is due. True if it entails another at once.

        Raises
        ------
        SimulationError : if it cannot.
        """
        with self._failures():
            if self.event_due:
                self._handle_pending()
        return self.event_due

    def run_to(self, t_end: float, until: float | None = None) -> None:
        """Integrate to `until` (or `t_end`); no step goes beyond `t_end`. Motions whose inputs have jumped join these
        there."""
        target = float(t_end if until is None else until)
        self._close_jumps(target)
        self._advance_to(target, float(t_end))
        self.t = target

    def step(self, t_end: float) -> None:
        """Make one step, at most to `t_end`; where the newest step ended at events or a breakpoint: let those happen.

        Afterwards `t` is the time of the newest step. This is for analyses that look at every step of a run, and at
        the states before and after what happens between two of them (`tlismni.core.analysis`).

        Raises
        ------
        SimulationError : if the run fails; what was reached stays.
        """
        now = self.t_internal
        with self._failures():
            if self.pending:
                self._handle_pending()
            elif (due := advance.due_break(self)) is not None:
                advance.restart_at(self, due)
            elif now < t_end:
                advance.advance_to(self, just_after(now), float(t_end))
        self.t = self.t_internal

    @property
    def at_breakpoint(self) -> bool:
        """True if the newest step ended just before a time at which a force or a driver's rate jumps."""
        return advance.due_break(self) is not None

    def aim(self, t: float, stop: float) -> None:
        """Set the clock of the time loop for whoever makes steps of its own (`tlismni.core.analysis`): until `t` is
        reached, none beyond `stop` (both s) or a breakpoint."""
        self.drive.aim(t, stop)

    def _advance_to(self, target: float, stop: float) -> None:
        with self._failures():
            advance.advance_to(self, target, stop)

    @contextmanager
    def _failures(self) -> Iterator[None]:
        """What a run raises: a user function's own exception, or a SimulationError."""
        try:
            with user_errors(self.assembly):
                yield
        except (ConsistencyError, SimulationError) as error:
            t = self.t_internal
            jammed = None if getattr(error, "loop", "") in ("contact", "impact", "event") else jam(self)
            if jammed is not None:
                raise SimulationError(jammed, t=t, loop="contact") from error
            if isinstance(error, SimulationError):
                raise
            raise SimulationError(f"at t = {t:.9g} s: {error}", t=t, loop="event") from error

    # ---- channels, inputs, state ------------------------------------------------------------------------------------

    @property
    def channels(self) -> tuple[Any, ...]:
        """The output channels."""
        return self.table.channels

    def values(self) -> NDArray[np.float64]:
        """Values of all channels at the present time."""
        return self.table.values(self.sample())

    @property
    def stats(self) -> dict[str, int]:
        """Counters of the run so far."""
        counters = self.workspace.arrays["counters"]
        counts = {name: int(counters[k]) for k, name in enumerate(_COUNTER_NAMES[:COUNTERS_SIZE])}
        return {**counts, "fallbacks": len(self.fallbacks), "divided_steps": self.divided_steps}

    def set_inputs(self, values: Mapping[str, float], derivatives: Mapping[str, Sequence[float]] | None = None) -> None:
        """Set input channels from the present time on.

        They keep these values, or go on with the first and second time derivatives in `derivatives`, by the same names.
        Setting an input to what it is at this time anyway changes nothing, bit for bit.

        Raises
        ------
        ModelError : for an unknown name or a value that is not finite; nothing has happened.
        ConsistencyError, SimulationError : if there are no accelerations for these inputs; they are as before.
        """
        inputs.set_inputs(self, values, derivatives or {})

    def prepare_exchange(self) -> bool:
        """Compile now what `exchange` calls, not at its first call; False if that will do nothing of its own."""
        return self.crossing is not None

    @cached_property
    def crossing(self) -> exchange.Exchange | None:
        """What `exchange` works with; None where it does nothing of its own."""
        if not exchange.possible(self):
            return None
        self.outside.prepare()
        return self.outside

    @cached_property
    def outside(self) -> exchange.Exchange:
        """The record of what is asked from outside: inputs and channels."""
        return exchange.Exchange(self)

    def exchange(self, values: Sequence[float], t: float, read: bool = True) -> NDArray[np.float64] | None:
        """`set_inputs` of all inputs, in their order and without derivatives, then `advance(t)`, then the `values()`.

        The same bit for bit, and far quicker for most steps. The answer is None if the values were not wanted, or are
        not to be had in the quick way: they can be asked for.

        Raises
        ------
        ModelError, ConsistencyError, SimulationError : as those.
        """
        return exchange.exchange_values(self, values, t, read)

    def go_on(self, t: float, first: int, code: int) -> None:
        """Integrate to `t` (s), after the time loop has returned `code` on a way that began at step `first`."""
        with self._failures():
            advance.advance_to(self, t, inputs.next_stop(self.input_times, self.t, t), came=(first, code))

    def input_derivatives(self, direction: Mapping[str, float]) -> NDArray[np.float64]:
        """Derivatives (channels,) of all channels along `direction`, by input name, at the present time.

        Coordinates, velocities and contact modes are held; exact to rounding. The simulation stays as it is, bit for
        bit. Those with respect to a motion are zero: it is followed by the next steps (`tlismni.core.model.motion`).

        Raises
        ------
        SimulationError : if accelerations cannot be computed.
        """
        return sensitivity.input_derivatives(self, direction)

    def output_rates(self) -> NDArray[np.float64]:
        """Time derivatives (channels,) of all channels at the present time, NaN where they are not known exactly."""
        return output_rates.output_rates(self)

    def state(self) -> State:
        """The present state as a value."""
        return restore.get_state(self)

    def restore(self, state: State) -> None:
        """Go on from `state`, bit for bit. Raises ModelError if it belongs to another model or settings."""
        restore.set_state(self, state)
