"""Engine: the arrays, records and structure of one run, its start, and what Python does at its events."""

import logging
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.evaluate import evaluate_residuals
from ..assembly.redundancy import RedundantRow, choose_rows
from ..assembly.scales import Scales
from ..assembly.workspace import Workspace
from ..compiled.jit import address_of
from ..compiled.notices import compile_notices
from ..errors import CallbackError, ModelError, SimulationError
from ..event_detection.crossings import remember
from ..event_detection.dense_output import query
from ..events import Event, Fallback
from ..events.progress import Progress
from ..events.records import DECLINED, SETTLED, WANT_MEMORY
from ..methods.automatic import AUTO
from ..methods.default import DEFAULT_METHOD
from ..methods.history import recall, restart
from ..methods.registry import FINE_STARTER, Formula, get_formula
from ..multibody_model import Model
from ..recovery.near_singular import smooth_query, strained
from ..stage import OUTER_LOOPS
from ..stage.corotating import solve_spinning_stage
from ..state.method_records import step_address
from ..state.run_records import clock_of
from ..state.workspace_records import OK, REANALYZE, STAGE_SIGNATURE, control_of, convergence_of
from ..time_loop.sample import write_sample
from ..tolerances import DEFAULT_ATOL
from .beginning import Beginning
from .contact_side import ContactSide
from .drive_record import Drive
from .failures import failure_of
from .output import ChannelTable
from .ready import make_ready
from .settings import START_TOLERANCE, Settings, set_control
from .setup import build_loop, build_method, state_fields
from .start import begin
from .start_figures import decided, decided_by_start
from .surface_jumps import refuse_surface_jumps
from .unbounded import warn_of_unbounded

logger = logging.getLogger(__name__)


@contextmanager
def user_errors(assembly: Assembly) -> Iterator[None]:
    """Raise a user function's own exception where compiled code could only say that there was one."""
    try:
        yield
    except CallbackError:
        raise _own_error(assembly) from None


def _own_error(assembly: Assembly) -> BaseException:
    error = assembly.user_error.pop()
    assembly.user_error.clear()
    return error


def _is_equations(system: Any) -> bool:
    from ..equations.system import EquationSystem  # fourteen modules that a Model has no use for

    return isinstance(system, EquationSystem)


class Engine(ContactSide):
    """Set-up of a run and the operations that event handling is made of. `Simulation` is the public face."""

    @compile_notices("this model")
    def __init__(
        self,
        system: Any,
        method: str = DEFAULT_METHOD,
        rtol: float = 1e-6,
        atol: float | Mapping[str, float] = DEFAULT_ATOL,
        *,
        step: float | None = None,
        max_step: float | None = None,
        first_step: float | None = None,
        max_steps: int | None = None,
        t0: float = 0.0,
        outer: str = "newton",
        acceleration: str = "none",
        depth: int = 3,
        fallback: bool = False,
        controller: str = "elementary",
        newton_tolerance: float | None = None,
        start_tolerance: float = START_TOLERANCE,
        redundant: str = "drop",
        record: bool | int = False,
        step_records: bool = False,
        **method_options: Any,
    ) -> None:
        settings = Settings(
            method=method, rtol=rtol, atol=atol, step=step, max_step=max_step, first_step=first_step, t0=t0,
            outer=outer, acceleration=acceleration, depth=depth, fallback=fallback, controller=controller,
            newton_tolerance=newton_tolerance, start_tolerance=start_tolerance, redundant=redundant,
            max_steps=max_steps, method_options=dict(method_options),
        )  # fmt: skip
        settings = decided(settings)
        if settings.method != AUTO.name:
            get_formula(settings.method, settings.method_options)
        if not isinstance(system, Model) and not _is_equations(system):
            raise ModelError(f"a Model or an EquationSystem is needed to simulate, not {type(system).__name__}")
        self.assembly: Assembly = system.assemble(t0=t0) if isinstance(system, Model) else system.assemble()
        self.workspace = Workspace(self.assembly, state_fields(self.assembly))
        settings = decided_by_start(settings, self.assembly, self.workspace)
        self.formula: Formula = get_formula(settings.method, settings.method_options)
        self.rtol = self.formula.working_tolerance(rtol) if step is None else rtol
        """What the errors of steps are held to, relatively."""
        self.settings, self.system = settings, system
        refuse_surface_jumps(system, self.formula, settings.method)
        warn_of_unbounded(self.assembly)
        self.table = ChannelTable(system, self.assembly)
        self.events: list[Event] = []
        self.progress: Callable[[float], None] | None = None
        self.pending: list[int] = []
        self.t = float(t0)
        self.redundant: tuple[RedundantRow, ...] = ()
        self.input_times = (float(t0), math.inf)
        self.start_open = True
        self.fallbacks: list[Fallback] = []
        self.use_outer_loop(outer)
        self._method = build_method(self.formula, self.settings, self.assembly, self.workspace.state)
        self._loop = build_loop(self.workspace, self.formula, self.settings, record, step_records)
        self.name_arrays()
        self.fine_starter = step_address(FINE_STARTER)
        self.guard = Progress(float(t0), self.workspace.state["guard"][0])
        self.drive = Drive(self, self.guard)
        if self.formula.impulses and self.assembly.contacts and (contact := self.drive.without_impulse()):
            raise ModelError(
                f"method '{settings.method}' knows contacts as impulses, and contact '{contact}' has none: its shapes "
                "have no mass, its friction has three tangents, or its gap cannot be looked at alone; take 'ebdf', "
                "which locates events"
            )
        self.beginning = Beginning(self)
        set_control(self.settings, self.formula, self.assembly, control_of(self.workspace.arrays["control"]))
        self.step_logs: list[NDArray[np.float64]] = []
        self.samples: list[NDArray[np.float64]] = []
        self.scales: Scales
        if self._begins:
            self.begin()
        make_ready(self)

    _begins = True
    """Whether a run begins as soon as it is built."""

    def begin(self) -> None:
        """Measure the model's scales and make a consistent start."""
        with user_errors(self.assembly):
            begin(self)

    def name_arrays(self) -> None:
        """Names for arrays of the records."""
        loop = self._loop.arrays
        self.method_arrays = self._method.arrays
        self.clock, self.watch, self.brackets = clock_of(loop["clock"]), loop["watch"], loop["brackets"]
        self.buffer, self.cursor = loop["samples"], loop["cursor"]
        self.log_buffer, self.log_cursor = loop["log"], loop["log_cursor"]

    # ---- set-up -------------------------------------------------------------------------------------------------

    def use_outer_loop(self, name: str) -> None:
        """Solve stages with the outer loop `name` from now on.

        Raises
        ------
        ModelError : if the method has a stage solver of its own and knows no other outer loop than newton.
        """
        known = self.formula.outer_loops if self.formula.stage is None else ("newton",)
        if name not in known or (self.settings.acceleration != "none" and "jfnk" not in known):
            raise ModelError(
                f"method '{self.settings.method}' with these options solves its stages in its own way and knows only "
                f"outer = {' or '.join(repr(loop) for loop in known)}, without acceleration"
            )
        loop = OUTER_LOOPS[name]
        self.outer = name
        self.workspace.make_basis(loop.basis_rows)
        corotating = address_of(solve_spinning_stage, STAGE_SIGNATURE) if self.formula.stage is None else 0
        self.workspace.use_stage(address_of(self.formula.stage or loop.stage, STAGE_SIGNATURE), corotating)
        control = control_of(self.workspace.arrays["control"])
        control.max_outer, control.outer_loop = loop.most_iterations, {"newton": 0.0, "simple": 1.0}.get(name, 2.0)
        convergence_of(self.workspace.arrays["rate"]).factor_age = -1.0

    # ---- at event rate ----------------------------------------

    def _handle_pending(self) -> None:
        """Let the pending events happen at the newest row; then the history starts anew."""
        if not self.pending:
            self._new_history()
            return
        pending, self.pending = self.pending, []
        if not self.compiled_events:
            self._handle_otherwise(pending)
            return
        self.flush()
        self.take_events()
        if self.workspace.dropped:
            self.look_at_redundant_rows()
        self.settle(lambda: self.drive.settle(pending))

    def _note_instant(self, pending: list[int]) -> None:
        """One more instant with events, which Python handles."""
        t = self.t_internal
        count = self.events_here + 1 if t == self.drive.goals.handled_at else 1
        self.drive.goals.handled_at, self.drive.counts.here = t, count
        self.drive.counts.handled += 1
        self.guard.note(t, count, [self.assembly.contacts[k].name for k in pending])

    def _handle_otherwise(self, pending: list[int]) -> None:
        """Let studies of other treatments of contacts act."""
        self._note_instant(pending)
        # samples may have been asked for since the step that ended here
        recall(self.workspace.record, self._method.record, 0)
        self._new_history()
        self.handle_contacts(pending)
        self._new_history()
        self.pending = self.unsettled()
        self._sample_now()

    def settle(self, act: Callable[[], int]) -> None:
        """Let compiled code settle what happens at the newest row, and build what it wants for that."""
        while (status := act()) != SETTLED:
            self.workspace.sync()
            if status == DECLINED:
                self._note_instant(self.drive.take_pending())
                raise RuntimeError("compiled code declines only what the guard against endless events stops")
            elif status > WANT_MEMORY:
                raise failure_of(self, status)
            else:
                self.build_wanted(status)
        self.workspace.sync()
        self.pending = self.drive.take_pending()
        self.take_events()

    def look_at_redundant_rows(self) -> None:
        """Choose anew which of them are left out, if others would be much better at the newest row."""
        recall(self.workspace.record, self._method.record, 0)
        if choose_rows(self.workspace):
            self.note_redundant()
            self.use_modes()
            self._new_history()

    @property
    def compiled_events(self) -> bool:
        """True if events may be settled without Python."""
        return type(self).handle_contacts is Engine.handle_contacts

    def take_events(self) -> None:
        """Record the events of compiled code."""
        for event in self.drive.take_events():
            self.add_event(event)

    def handle_contacts(self, pending: list[int]) -> None:
        """What studies of other treatments do at events of contacts, instead of what the laws say."""
        raise NotImplementedError

    def _new_history(self) -> None:
        evaluate_residuals(self.workspace.record)
        restart(self.workspace.record, self._method.record)
        remember(self.workspace.record, self._loop.record)

    def _sample_now(self) -> None:
        """Record the workspace's point."""
        if not self._loop.table["capacity"][0]:
            return
        row = np.zeros(self.buffer.shape[1])
        evaluate_residuals(self.workspace.record)
        write_sample(self.workspace.record, row)
        self.flush()
        self.samples.append(row[None, :])

    def flush(self) -> None:
        """Move the recorded samples out of the compiled buffer."""
        count = int(self.cursor[0])
        if count:
            self.samples.append(self.buffer[:count].copy())
            self.cursor[0] = 0
        logged = int(self.log_cursor[0])
        if logged:
            self.step_logs.append(self.log_buffer[:logged].copy())
            self.log_cursor[0] = 0

    def record_end(self) -> None:
        """Record the present time, unless the newest sample is of it."""
        self.flush()
        if not self.samples or self.samples[-1][-1, 0] < self.t:
            self.samples.append(self.sample()[None, :])

    def report_progress(self, t: float) -> None:
        """Tell whoever listens how far the run has come."""
        if self.progress is not None:
            self.progress(t)

    def sample(self) -> NDArray[np.float64]:
        """All numbers at the present time `t`, as one row (see `sample.py`)."""
        workspace = self.workspace.record
        row = np.zeros(self.buffer.shape[1])
        try:  # not `user_errors`: a context manager costs as much as the query, and samples are taken at every point
            status = self.query()
            if strained(self):
                status = smooth_query(self, status)
            if status == OK:
                write_sample(workspace, row)
        except CallbackError:
            raise _own_error(self.assembly) from None
        if status != OK:
            raise SimulationError(
                f"the state at t = {self.t:.9g} s between two steps cannot be projected onto the constraints "
                f"(status {status}); reduce max_step",
                t=self.t,
                loop="inner",
            )
        return row

    def query(self) -> int:
        """Let the present time `t`, which is no later than the newest row, be that of the workspace's point."""
        workspace, method = self.workspace.record, self._method.record
        while (status := int(query(workspace, method, self.t))) == REANALYZE:
            self.workspace.give_room()
        return status
