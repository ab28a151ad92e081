"""Variations of a run: a basis of neighbouring motions, carried along step by step and event by event."""

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError, SimulationError
from ..laws import ImpactLaw
from ..linalg import SingularMatrixError
from ..rounding import NO_STEP
from ..simulation.engine import user_errors
from ..simulation.simulation import Simulation
from ..state.run_records import CHUNK, EVENT, REACHED
from .at_rest import null_basis
from .layout import Layout, Layouts, mass_rates
from .linearise import linearise
from .saltation import cross, look
from .tangent_steps import STEP_LEFT, SUBSTEP, fly
from .variational_equation import GAUSS_NODES, GAUSS_STAGES, Work, carry, make_work

Floats = NDArray[np.float64]

LOST = 1e-12
"""A variation that shrinks at an event by more than this, next to the longest one, has lost its direction."""
MOST_SUBSTEPS = 20_000
STEPS_AT_ONCE = 1000
MOST_AT_ONCE = 8
"""Substeps of one step without returning to Python, if LARGEST_ROOM numbers are room enough."""
LARGEST_ROOM = 5_000_000


class Variation:
    """Orthonormal variations along a run, and how they have grown.

    Parameters
    ----------
    sim : the run; `advance` steps it.
    columns : number of variations; None: as many as the state has dimensions.
    factors : keep `last`, and so go step by step; else many steps at once.

    Attributes
    ----------
    dq, dv : variations (n, columns), orthonormal in the kinetic energy; dv without its part normal to the constraints.
    exponents : which of the exponents each column stands for; lost ones are missing.
    growth : logarithms of the growth of the lengths (count,) since the start; -inf where the direction is lost.
    volume : what `growth` of all dimensions must add up to: integral of the divergence and 2 ln e of each impact.
    impacts : impacts so far.
    last : R: the variations at the end of the last advance before they were made orthonormal are those after times R.
        Only with `factors`.

    Raises
    ------
    ModelError : for a system whose contacts are forces, or a method that does not meet the constraints.
    """

    def __init__(self, sim: Simulation, columns: int | None = None, factors: bool = False) -> None:
        for contact in sim.assembly.contacts:
            if not isinstance(contact.law, ImpactLaw):
                raise ModelError(
                    f"contact '{contact.name}' has the law {type(contact.law).__name__}: variations know contacts as "
                    "constraints only, use NewtonImpact"
                )
            if contact.friction is not None:
                raise ModelError(f"contact '{contact.name}' has friction, which variations do not know: leave it out")
        if not sim.formula.exact:
            raise ModelError(
                f"method '{sim.settings.method}' does not meet the constraints at all levels, which variations need: "
                "use a TLISMNI method, irk or ebdf"
            )
        self.sim = sim
        self._layouts = Layouts(sim)
        self._rooms: dict[tuple[int, int], tuple[Work, tuple[Floats, ...]]] = {}
        self._frequency = 0.0
        self._step_by_step = factors
        size = 2 * self.freedom
        count = size if columns is None else columns
        if not 1 <= count <= size:
            raise ModelError(
                f"{count} exponents are asked for; the state has {size} dimensions at the start: 1 to {size}"
            )
        self.exponents = np.arange(count)
        self.growth = np.zeros(count)
        self.volume, self.impacts, self.complete = 0.0, 0, count == size
        self.last = np.eye(count)
        basis, low, _ = self._frame()
        # no direction of its own: columns that are eigenvectors would not find their order
        lengths = np.linalg.qr(np.random.default_rng(0).standard_normal((size, size)))[0][:, :count]
        self._from_lengths(basis, low, lengths)

    def _from_lengths(self, basis: Floats, low: Floats, lengths: Floats) -> None:
        f = len(low)
        self.dq = np.ascontiguousarray(basis @ np.linalg.solve(low.T, lengths[:f]))
        self.dv = np.ascontiguousarray(basis @ np.linalg.solve(low.T, lengths[f:]))

    @property
    def freedom(self) -> int:
        """Number of degrees of freedom f now."""
        return self._layouts.now().freedom

    def _frame(self) -> tuple[Floats, Floats, Floats]:
        """N (n, f), the Cholesky factor L (f, f) of N^T M N, and M (n, n) at the newest step's end."""
        layout = self._layouts.now()
        look(self.sim)
        mass, phi_q = layout.matrices(self.sim)
        basis, _ = null_basis(self.sim, phi_q)
        root: Floats = np.asarray(np.linalg.cholesky(basis.T @ mass @ basis), dtype=np.float64)
        return basis, root, mass

    def _room(self, layout: Layout) -> tuple[Work, tuple[Floats, ...]]:
        """Room for what `carry` and `fly` compute in the present structure."""
        n, m, columns = layout.n, len(layout.active), len(self.exponents)
        if (m, columns) not in self._rooms:
            points = GAUSS_STAGES * max(1, min(MOST_AT_ONCE, LARGEST_ROOM // (GAUSS_STAGES * n * (3 * n + 2 * m)))) + 2
            shapes = (
                (points,), *[(points, n, n)] * 3, *[(points, m, n)] * 2, (points, 2 * n), (1, n, n), (columns, columns),
                (n, columns), (n, columns),
            )  # fmt: skip
            self._rooms[m, columns] = make_work(n, m, columns), tuple(np.zeros(shape) for shape in shapes)
        return self._rooms[m, columns]

    def advance(self, t_end: float, until: float | None = None) -> None:
        """Some steps of the run, at most to t_end and none once `until` is reached; or what happens at the newest end.

        Raises
        ------
        SimulationError : if the run fails, or at an event at which variations have no limit.
        """
        sim = self.sim
        with user_errors(sim.assembly):
            if sim.pending or sim.at_breakpoint:
                self._event()
                return
            code = EVENT
            if not self._step_by_step and len(self.exponents):
                code = self._fly(t_end, t_end if until is None else until)
            if code not in (CHUNK, REACHED, STEP_LEFT):
                sim.step(t_end)
            if code not in (CHUNK, REACHED):
                self._step()

    def run_to(self, t_end: float, until: float, progress: Callable[[float], None] | None = None) -> None:
        """`advance` to the end of the first step at `until` or later; `progress` is called with the time at times."""
        sim, count = self.sim, 0
        while until - sim.t_internal > NO_STEP * abs(until):
            self.advance(t_end, until)
            count += 1
            if progress is not None and count % 100 == 0:
                progress(sim.t_internal)

    def _fly(self, t_end: float, until: float) -> int:
        sim, layout = self.sim, self._layouts.now()
        sim.aim(until, t_end)
        work, room = self._room(layout)
        growth, totals = np.zeros(len(self.exponents)), np.array([self._frequency, 0.0])
        places = layout.rows, layout.cols, layout.colours, layout.scale
        code = fly(
            sim.workspace.record, sim._method.record, sim._loop.record, STEPS_AT_ONCE, places, room, work, self.dq,
            self.dv, growth, totals,
        )  # fmt: skip
        sim.t = sim.t_internal
        self._frequency = float(totals[0])
        self.growth[self.exponents] += growth
        self.volume += float(totals[1])
        return int(code)

    def _step(self) -> None:
        """Carry the variations over the newest step."""
        sim, layout = self.sim, self._layouts.now()
        times, ring = sim.method_arrays["times"], sim.method_arrays["ring"]
        if ring[1] < 2 or layout.freedom == 0 or len(self.exponents) == 0:
            return
        t0, t1 = float(times[(ring[0] - 1) % len(times)]), float(times[ring[0]])
        h = t1 - t0
        while True:
            substeps = max(1, math.ceil(h * self._frequency / SUBSTEP))
            if substeps > MOST_SUBSTEPS:
                raise SimulationError(
                    f"the step of {h:.3g} s at t = {t0:.9g} s would take {substeps} substeps of the variational "
                    f"equation: the system's highest frequency is {self._frequency:.3g} rad/s; set a smaller max_step",
                    t=t0,
                    loop="variation",
                )
            inner = t0 + h / substeps * (np.arange(substeps)[:, None] + GAUSS_NODES).ravel()
            nodes = np.concatenate([[t0], inner, [t1]])
            mass, k, d, phi_q, rate, points = self._linearise(layout, nodes)
            dq, dv = self.dq.copy(), self.dv.copy()
            rates = mass_rates(sim, layout, nodes, points, mass)
            last, work = np.zeros((len(self.exponents),) * 2), self._room(layout)[0]
            frequency, divergence = carry(h, mass, k, d, rates, phi_q, rate, layout.scale, dq, dv, last, work)
            fine = h * frequency <= 1.5 * SUBSTEP * substeps
            self._frequency = float(frequency)
            if fine:
                break
        self.dq, self.dv, self.last = dq, dv, last
        self.growth[self.exponents] += np.log(np.abs(np.diag(last)))
        self.volume += float(divergence)

    def _event(self) -> None:
        """Let the pending events happen, and map the variations."""
        crossing = cross(self.sim, self._layouts, self.dq, self.dv)
        basis, low, mass = self._frame()
        y, p = np.linalg.lstsq(basis, crossing.dq, rcond=None)[0], basis.T @ (mass @ crossing.dv)
        q, r = np.linalg.qr(np.vstack([low.T @ y, np.linalg.solve(low, p)]))
        lengths = np.abs(np.diag(r))
        kept = np.flatnonzero(lengths > LOST * np.max(lengths, initial=0.0))
        self.last = r[kept]
        growth = np.full(len(self.exponents), -np.inf)
        growth[kept] = np.log(lengths[kept])
        self.growth[self.exponents] += growth
        self.exponents = self.exponents[kept]
        self._from_lengths(basis, low, q[:, kept])
        self.volume += crossing.log_determinant if len(kept) == 2 * len(low) else -np.inf
        self.impacts += crossing.impacts
        self._frequency = 0.0

    def _linearise(self, layout: Layout, times: Floats) -> tuple[Floats, ...]:
        """M, K, D (N, n, n), Phi_q, B (N, m_act, n) and points (N, 2n) at `times` (N,) of the newest step."""
        sim, n, m, count = self.sim, layout.n, len(layout.active), len(times)
        shapes = ((count, n, n),) * 3 + ((count, m, n),) * 2 + ((count, 2 * n),)
        found = tuple(np.zeros(shape) for shape in shapes)
        workspace, method = sim.workspace.record, sim._method.record
        for attempt in range(2):
            failed = linearise(workspace, method, times, layout.rows, layout.cols, layout.colours, *found)
            if failed == 0:
                return found
            if attempt == 0:
                try:
                    sim.workspace.structure.kkt_query.analyze(sim.workspace.arrays["values"])
                except SingularMatrixError:
                    break
        t = float(times[failed - 1])
        raise SimulationError(
            f"the state at t = {t:.9g} s between two steps cannot be projected onto the constraints; reduce max_step",
            t=t,
            loop="variation",
        )
