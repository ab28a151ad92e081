"""Engine: the arrays, records and structure of one run, and what the contact state machine may do with them."""

import logging
import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import address_of
from ..contact import machine
from ..contact.laws import ForceLaw
from ..contact.modes import ACTIVE, CLOSED, LOSS_JUMP, MODE, RATE_ROUNDING, SLIDE, SLIDE_START, STICKS
from ..contact.touching import Touching
from ..description import Model
from ..equations.system import EquationSystem
from ..errors import CallbackError, ConsistencyError, ModelError, SimulationError
from ..events import Event, Fallback
from ..linalg import SingularMatrixError
from ..methods.history import recall, restart
from ..methods.records import step_address
from ..methods.registry import FINE_STARTER, Formula, get_formula
from ..stage import OUTER_LOOPS
from ..stage.accelerations import solve_accelerations
from ..system.assembly import Assembly
from ..system.consistent import START_TOLERANCE, make_consistent
from ..system.evaluate import evaluate_energy, evaluate_power, evaluate_residuals, evaluate_tangent
from ..system.partition import prepare
from ..system.projection import bring_to_rest
from ..system.records import FACTOR_AGE, MAX_OUTER, OK, OUTER_LOOP, REANALYZE, SINGULAR, STAGE_SIGNATURE
from ..system.redundancy import RedundantRow, choose_rows, describe
from ..system.workspace import Workspace
from .dense_output import query
from .near_singular import smooth_query, strained
from .output import ChannelTable
from .records import MAX_STEP, STEP_SIZE
from .sample import write_sample
from .settings import Settings, set_control
from .setup import build_loop, build_method
from .watch import FORCE_ROUNDING, GAP_ROUNDING, remember

logger = logging.getLogger(__name__)

FIRST_TOUCH = 1e-8
COORDINATE_NOISE = 1e-14
"""Rounding of a coordinate after many steps, relative."""


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


class Engine:
    """Set-up of a run and the operations that event handling is made of. `Simulation` is the public face."""

    def __init__(
        self,
        system: Any,
        method: str = "ebdf",
        rtol: float = 1e-6,
        atol: float | Mapping[str, float] = 1e-9,
        *,
        step: float | None = None,
        max_step: float | None = None,
        first_step: float | None = None,
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
        self.settings = Settings(
            method=method, rtol=rtol, atol=atol, step=step, max_step=max_step, first_step=first_step, t0=t0,
            outer=outer, acceleration=acceleration, depth=depth, fallback=fallback, controller=controller,
            newton_tolerance=newton_tolerance, start_tolerance=start_tolerance, redundant=redundant,
            method_options=dict(method_options),
        )  # fmt: skip
        self.formula: Formula = get_formula(method, method_options)
        if not isinstance(system, Model | EquationSystem):
            raise ModelError(f"a Model or an EquationSystem is needed to simulate, not {type(system).__name__}")
        self.system = system
        self.assembly: Assembly = system.assemble()
        self.workspace = Workspace(self.assembly)
        self.table = ChannelTable(system, self.assembly)
        self.events: list[Event] = []
        self.progress: Callable[[float], None] | None = None
        self.open_accounts: dict[int, tuple[float, float]] = {}
        self.pending: list[int] = []
        self.t = float(t0)
        self.redundant: tuple[RedundantRow, ...] = ()
        self._times_handled = (math.nan, 0)
        self.fallbacks: list[Fallback] = []
        self.use_outer_loop(outer)
        self._method = build_method(self.formula, self.settings, self.workspace.row_length)
        self.method_arrays: dict[str, NDArray[Any]] = self._method.arrays
        self._loop = build_loop(self.assembly, self.formula, self.settings, record, step_records)
        self.clock, self.watch = self._loop.arrays["clock"], self._loop.arrays["watch"]
        self.buffer, self.cursor = self._loop.arrays["samples"], self._loop.arrays["cursor"]
        self.log_buffer, self.log_cursor = self._loop.arrays["log"], self._loop.arrays["log_cursor"]
        self.fine_starter = step_address(FINE_STARTER)
        set_control(self.settings, self.formula.newton_tolerance, self.assembly, self.workspace.arrays)
        self.step_logs: list[NDArray[np.float64]] = []
        self.samples: list[NDArray[np.float64]] = []
        with user_errors(self.assembly):
            self._start()

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
        self.workspace.use_stage(address_of(self.formula.stage or loop.stage, STAGE_SIGNATURE))
        control = self.workspace.arrays["control"]
        control[MAX_OUTER], control[OUTER_LOOP] = loop.most_iterations, float(name == "simple")
        self.workspace.arrays["rate"][FACTOR_AGE] = -1.0

    def _start(self) -> None:
        arrays, a = self.workspace.arrays, self.assembly
        arrays["q"][: a.n] = a.q0
        arrays["v"][: a.n] = a.v0
        arrays["t"][0] = self.settings.t0
        refuse = self.settings.redundant == "refuse"
        self.redundant = make_consistent(self.workspace, self.settings.start_tolerance, refuse)
        gap_tolerance = 1e-9 * float(np.max(a.coordinate_scale, initial=1.0))
        touching = []
        for k, contact in enumerate(a.contacts):
            gap = self.gap(k)
            if gap < -gap_tolerance and not isinstance(contact.law, ForceLaw):
                raise ConsistencyError(
                    f"contact '{contact.name}' starts with the shapes overlapping by {-gap:.3g} m; "
                    "a constraint contact needs a gap >= 0 at the start"
                )
            if gap > gap_tolerance:
                continue
            rate = self.gap_rate(k)
            if isinstance(contact.law, ForceLaw):
                touches = gap < -gap_tolerance or rate < -RATE_ROUNDING or (rate <= RATE_ROUNDING and self.presses(k))
            else:
                touches = rate <= self.rate_rounding()
            if touches:
                touching.append(k)
        self.use_modes()
        self.clock[STEP_SIZE] = self.settings.first_step or self._first_step()
        self._new_history()
        # a force law that acts from the start holds energy from the start
        for k in touching:
            if isinstance(a.contacts[k].law, ForceLaw):
                machine.handle(self, [k])
        self._new_history()
        self.table.initial_energy = self.table.total_energy(self.sample())
        self._sample_now()
        self.pending = [k for k in touching if not isinstance(a.contacts[k].law, ForceLaw)]
        self._handle_pending()

    def _first_step(self) -> float:
        """A step in which nothing moves by more than a hundredth of its scale; error control takes it from there."""
        arrays, n, scale = self.workspace.arrays, self.assembly.n, self.assembly.coordinate_scale
        speed = float(np.max(np.abs(arrays["v"][:n]) / scale, initial=0.0))
        acceleration = float(np.max(np.abs(arrays["a"][:n]) / scale, initial=0.0))
        guess = 0.1
        if speed > 0.0:
            guess = min(guess, 0.01 / speed)
        if acceleration > 0.0:
            guess = min(guess, 0.1 / math.sqrt(acceleration))
        return min(guess, float(self.clock[MAX_STEP]))

    # ---- what the contact state machine asks ---------------------------------------------------------------------

    @property
    def memory(self) -> NDArray[np.float64]:
        """Contact memories, one row a contact."""
        return self.workspace.arrays["memory"]

    @property
    def t_internal(self) -> float:
        """Time of the newest accepted step, which may be beyond `t`."""
        return float(self.method_arrays["times"][self.method_arrays["ring"][0]])

    def gap(self, k: int) -> float:
        """Gap of contact k at the workspace's point, m."""
        return float(self.workspace.arrays["phi"][self.assembly.contacts[k].row])

    def gap_rate(self, k: int) -> float:
        """Its rate, m/s."""
        return float(self.workspace.arrays["phid"][self.assembly.contacts[k].row])

    def kinetic_energy(self) -> float:
        """Kinetic energy at the workspace's point, J."""
        evaluate_energy(self.workspace.record)
        return float(self.workspace.arrays["energy"][0])

    def add_input_work(self, work: float) -> None:
        """Work that driven constraints did during an impact, to its account."""
        if "input" in self.assembly.work_names:
            self.workspace.arrays["v"][self.assembly.work_index("input")] += work

    def contact_accounts(self, k: int) -> tuple[float, float]:
        """Impulse (N s) and dissipation (J) of contact k so far."""
        contact, v = self.assembly.contacts[k], self.workspace.arrays["v"]
        return (
            float(v[contact.impulse_account]),
            float(v[contact.dissipation_account] + self.memory[k, LOSS_JUMP]),
        )

    def elastic_energy(self, k: int, contact: Any) -> float:
        """Elastic energy that the force law of contact k holds, J."""
        return float(contact.law.elastic_energy(max(-self.gap(k), 0.0)))

    def effective_mass(self, k: int) -> float:
        """Mass that contact k feels: normal impulse for a unit change of the gap's rate, joints included, kg."""
        before = self.memory[k].copy()
        closed = np.flatnonzero(self.memory[: len(self.assembly.contacts), MODE] == CLOSED)
        try:
            return 1.0 / float(Touching(self, [k], frozenset(int(j) for j in closed)).a.nn[0, 0])
        finally:
            self.memory[k] = before
            self.use_modes()

    def start_small(self, speed: float) -> None:
        """Begin a contact with a step in which it closes by FIRST_TOUCH of the mechanism's size, so that the error
        control sees the force grow: a step over the whole contact would find no force at its stages."""
        size = float(np.max(self.assembly.coordinate_scale, initial=1.0))
        self.clock[STEP_SIZE] = min(self.clock[STEP_SIZE], FIRST_TOUCH * size / speed)

    def add_event(self, event: Event) -> None:
        """Record an event."""
        logger.debug("%s", event)
        self.events.append(event)

    def use_modes(self, accelerations: bool = True) -> None:
        """Take the structure of the present modes; solve for (a, lam) unless told not to."""
        modes = self.memory[: len(self.assembly.contacts), MODE]
        closed = frozenset(int(k) for k in np.flatnonzero(modes == CLOSED))
        engaged = closed | {int(k) for k in np.flatnonzero(modes == ACTIVE)}
        sticking = frozenset(
            k for k in closed if self.assembly.contacts[k].coulomb is not None and self.memory[k, SLIDE] == STICKS
        )
        if self.workspace.key != (closed, engaged, sticking):
            self.workspace.engage(closed, engaged, sticking)
        if choose_rows(self.workspace):
            self.note_redundant()
        prepare(self.workspace)
        if accelerations:
            self.solve_accelerations()

    def note_redundant(self) -> None:
        """Other rows are left out than before: add them to what the result tells."""
        found = describe(self.workspace)
        logger.info("at t = %.9g s other redundant rows are left out of the equations: %s", self.t_internal, found)
        self.redundant += tuple(row for row in found if row not in self.redundant)

    def solve_accelerations(self) -> None:
        """Accelerations, multipliers and the rates of the work accounts at the workspace's point."""
        arrays = self.workspace.arrays
        if solve_accelerations(self.workspace.record) != OK:
            raise ConsistencyError(
                f"no accelerations and multipliers at t = {arrays['t'][0]:.9g} s: the augmented system "
                "[M Phi_q^T; Phi_q 0] is singular or a force is not finite there"
            )
        evaluate_power(self.workspace.record)
        # with the rates of the work accounts: Newmark's formula integrates them from here
        arrays["aux"][:] = arrays["a"]

    # ---- constraint contacts ------------------------------------------------------------------------------------

    def touching(self, pending: list[int]) -> list[int]:
        """Constraint contacts without a gap at the workspace's point: closed ones, `pending`, and others that touch.
        Those at massless ends are left out: they take no impulse."""
        level = GAP_ROUNDING * max(1.0, float(np.max(np.abs(self.workspace.arrays["q"][: self.assembly.n]))))
        return [
            k
            for k, contact in enumerate(self.assembly.contacts)
            if not isinstance(contact.law, ForceLaw)
            and k not in self.assembly.massless_contacts
            and (k in pending or self.memory[k, MODE] == CLOSED or abs(self.gap(k)) <= level)
        ]

    def held(self) -> frozenset[int]:
        """Closed contacts at massless ends: to impacts of others they are joints."""
        return frozenset(k for k in self.assembly.massless_contacts if self.memory[k, MODE] == CLOSED)

    def slide_values(self, contacts: list[int]) -> dict[int, float]:
        """Sliding distances of those contacts that have friction, m."""
        found = {}
        for k in contacts:
            row, memory = self.assembly.contacts[k].slide_row, self.memory[k]
            if row >= 0:
                sticks = memory[MODE] == CLOSED and memory[SLIDE] == STICKS
                found[k] = float(self.workspace.arrays["phi"][row] + (memory[SLIDE_START] if sticks else 0.0))
        return found

    def rate_rounding(self) -> float:
        """Rate of a gap or a sliding distance below which it is none, m/s."""
        return RATE_ROUNDING * max(1.0, float(np.max(np.abs(self.workspace.arrays["v"][: self.assembly.n]))))

    @property
    def started(self) -> bool:
        """True once a step has been made."""
        return self.t_internal > self.settings.t0

    @property
    def events_here(self) -> int:
        """How often events have been handled at the present instant, without progress in time."""
        return self._times_handled[1]

    def meet_constraints(self) -> None:
        """Bring positions and velocities onto the constraints of the present structure, by rounding's worth."""
        for residual, x in (("phi", "q"), ("phid", "v")):
            evaluate_residuals(self.workspace.record)
            if not bring_to_rest(self.workspace, residual, x):
                raise SimulationError(
                    f"at t = {self.t_internal:.9g} s the closed contacts cannot be met together with the joints",
                    t=self.t_internal,
                    loop="contact",
                )
        evaluate_residuals(self.workspace.record)

    def unsettled(self) -> list[int]:
        """Constraint contacts whose mode does not fit the forces at the workspace's point: closed ones that pull or are
        held beyond their friction, and touching ones that would overlap."""
        arrays, tolerance = self.workspace.arrays, self.no_force()
        found = []
        for k, contact in enumerate(self.assembly.contacts):
            if self.memory[k, MODE] != CLOSED or k in self.assembly.massless_contacts:
                continue
            force = -arrays["lam"][contact.row]
            if force < -tolerance and force < -self._contact_noise(contact.row):
                found.append(k)
            elif contact.coulomb is not None and self.memory[k, SLIDE] == STICKS:
                limit = contact.coulomb.sticking_coefficient * force
                if abs(arrays["lam"][contact.slide_row]) > limit * (1.0 + 1e-9) + tolerance:
                    found.append(k)
        return found

    def _contact_noise(self, row: int) -> float:
        """What rounding of the coordinates leaves in the force of the closed contact with this row, N."""
        noise = self.force_noise()
        rows, cols, values = self.workspace.jacobian()
        here = np.flatnonzero((self.workspace.structure.active[rows] == row) & (values != 0.0))
        if not np.any(
            noise[cols[here]]
        ):  # on frames without stiffness of their own, which hand on the forces of others
            return float(np.max(noise, initial=0.0) / np.max(np.abs(values[here]), initial=1.0))
        return float(np.max(noise[cols[here]] / np.abs(values[here]), initial=0.0))

    def no_force(self) -> float:
        """Rounding of the multipliers: a force below this is none, N."""
        return FORCE_ROUNDING * max(1.0, float(np.max(np.abs(self.workspace.arrays["lam"]), initial=0.0)))

    def tangent_product(self, c_q: float, c_v: float, x: NDArray[np.float64], of_sizes: bool = False) -> Any:
        """(c_v D + c_q K) x (n,), without the mass matrix; `of_sizes`: the same of the magnitudes of all terms."""
        workspace, n = self.workspace, self.assembly.n
        rows, cols = workspace.structure.rows, workspace.structure.cols
        evaluate_tangent(workspace.record, c_q, c_v)
        values = workspace.arrays["values"].copy()
        evaluate_tangent(workspace.record, 0.0, 0.0)
        here = np.flatnonzero((rows < n) & (cols < n))
        terms = (values[here] - workspace.arrays["values"][here]) * x[cols[here]]
        return np.bincount(rows[here], np.abs(terms) if of_sizes else terms, n)

    def force_noise(self) -> NDArray[np.float64]:
        """What rounding of the coordinates leaves in the forces (n,), N: in stiff bodies, coordinates that are nearly
        equal make large forces that cancel each other. That of the largest travels to all of them as waves."""
        largest = float(np.max(np.abs(self.workspace.arrays["q"][: self.assembly.n]), initial=0.0))
        noise = np.full(self.assembly.n, COORDINATE_NOISE * largest)
        return np.asarray(self.tangent_product(1.0, 0.0, noise, True))

    def presses(self, k: int) -> bool:
        """True if the gap of contact k, with a force law, would close from rest (not just by rounding)."""
        self.solve_accelerations()
        return bool(self.workspace.arrays["phidd"][self.assembly.contacts[k].row] < 0.0)

    # ---- at event rate ----------------------------------------

    def _handle_pending(self) -> None:
        """Let the state machine act on the pending events at the newest row; then the history starts anew."""
        if not self.pending:
            self._new_history()
            return
        pending, self.pending = self.pending, []
        t = self.t_internal if self.method_arrays["ring"][1] else self.settings.t0
        last, count = self._times_handled
        count = count + 1 if t == last else 1
        self._times_handled = (t, count)
        if count > machine.MOST_EVENTS_AT_ONCE:
            names = [self.assembly.contacts[k].name for k in pending]
            raise SimulationError(
                f"{count} events of contacts {names} at t = {t:.9g} s without progress in time: the contact chatters. "
                "Use a larger rest_ratio, a force law, or smaller tolerances.",
                t=t,
                loop="event",
            )
        if self.method_arrays["ring"][1]:
            # samples may have been asked for since the step that ended here
            recall(self.workspace.record, self._method.record, 0)
        self._new_history()
        self.handle_contacts(pending)
        self._new_history()
        self.pending = self.unsettled()
        self._sample_now()

    def handle_contacts(self, pending: list[int]) -> None:
        """Let the state machine act on contacts with events. Studies of other treatments override this."""
        machine.handle(self, pending)

    def _new_history(self) -> None:
        evaluate_residuals(self.workspace.record)
        restart(self.workspace.record, self._method.record)
        remember(self.workspace.record, self._loop.record)

    def _sample_now(self) -> None:
        """Record the workspace's point."""
        if self._loop.table["capacity"][0] == 0:
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
        ws = self.workspace.record
        row = np.zeros(self.buffer.shape[1])
        try:  # not `user_errors`: a context manager costs as much as the query, and samples are taken at every point
            status = query(ws, self._method.record, self.t)
            if status == REANALYZE:
                status = self._query_with_other_pivots()
            if strained(self):
                status = smooth_query(self, status)
            if status == OK:
                write_sample(ws, row)
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

    def _query_with_other_pivots(self) -> int:
        """The query with pivots for this very point; the usual ones are put back, so that asking leaves no trace."""
        kkt, values = self.workspace.structure.kkt_query, self.workspace.arrays["values"]
        permutations = kkt.analysis()
        try:
            kkt.analyze(values)
            return int(query(self.workspace.record, self._method.record, self.t))
        except SingularMatrixError:
            return SINGULAR
        finally:
            kkt.analyze_with(*permutations)
