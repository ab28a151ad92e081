"""What an event does to variations: the saltation matrix.

A contact strikes at h(q, t) = 0, h its gap. Neighbouring motions strike at other times, dt = -(h_q dq)/h' before the
event, so that with x = (q, v), x' = f and x+ = R(x-, t) (Mueller, Chaos, Solitons & Fractals 5 (1995) 1671)

    dx+ = R_x (dx- + f- dt) + R_t dt - f+ dt.

R is the impact: M w + A^T Lambda = 0 with w = v+ - v-, A the rows of the joints, of the closed contacts and of the one
that strikes; phid = A v + A_0 stays zero in all rows but that of the contact, where phid+ = -e phid-. Its derivative
along (dq, dv, dt) has the same matrix:

    M dw + A^T dLambda = -[(M w)_q + (A^T Lambda)_q] dq - [M_t w + A_t^T Lambda] dt
    A dv+ + B(v+) dq + C(v+) dt = 0;  in the contact's row: -e (A dv- + B(v-) dq + C(v-) dt)

with B(v) = phid_q and C(v) = phid_t. Where a contact opens, the force that ends is zero and f is continuous: the matrix
is the identity. So it is where a force jumps at a given time. Where the rate of a driver jumps, dt = 0.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..assembly.levels import rate_level
from ..errors import SimulationError
from ..event_detection.dense_output import query
from ..events import Event
from ..laws import ImpactLaw
from ..rounding import CONTINUOUS
from ..simulation.simulation import Simulation
from ..stage.accelerations import solve_accelerations
from ..state.modes import CLOSED
from ..state.workspace_records import OK
from .layout import Layout, Layouts, mass_by_time
from .linearise import all_rows, gap_hessian

Floats = NDArray[np.float64]

MISMATCH = 1e-7
"""Largest difference of the velocities after an impact from those of the law assumed here, relative."""


@dataclass(frozen=True)
class Crossing:
    """What one instant did."""

    dq: Floats
    """Variations after it, (n, columns)."""
    dv: Floats
    impacts: int
    log_determinant: float
    """2 ln e of an impact, the logarithm of its factor of phase volume; -inf for e = 0."""


class Rows:
    """All rows of the constraints, those of open contacts too, at the newest step with velocities v (n,).

    jacobian A (m, n), rate B = phid_q (m, n), remainder C = phid_t (m,), phid (m,).
    """

    def __init__(self, sim: Simulation, v: Floats) -> None:
        n, m, arrays = sim.assembly.n, sim.assembly.m, sim.workspace.arrays
        self.jacobian, self.rate, self.remainder = np.zeros((m, n)), np.zeros((m, n)), np.zeros(m)
        look(sim)
        arrays["v"][:n] = v
        all_rows(sim.workspace.record, self.jacobian, self.rate, self.remainder)
        self.phid = arrays["phid"][:m].copy()

    def vary(self, dq: Floats, dv: Floats, dt: Floats) -> Floats:
        """Variation of phid, (m, columns)."""
        return self.jacobian @ dv + self.rate @ dq + np.outer(self.remainder, dt)


def look(sim: Simulation) -> None:
    """The newest step's end becomes the workspace's point."""
    query(sim.workspace.record, sim._method.record, sim.t_internal)


def cross(sim: Simulation, layouts: Layouts, dq: Floats, dv: Floats) -> Crossing:
    """Let happen what is due at the newest step's end, and map the variations.

    Parameters
    ----------
    sim : a run whose newest step ended at events or at a breakpoint. layouts : its.
    dq, dv : variations before, (n, columns) each; dv may lack what dq asks for normal to the constraints.

    Raises
    ------
    SimulationError : where variations have no limit (contacts that strike at one instant, a touch without approach),
        and for an impact that was not Newton's without friction.
    """
    n, arrays = sim.assembly.n, sim.workspace.arrays
    striking = next((k for k in sim.pending if sim.memory.mode[k] != CLOSED), None)
    look(sim)
    if solve_accelerations(sim.workspace.record) != OK:
        t = sim.t_internal
        raise SimulationError(f"no accelerations before the event at t = {t:.9g} s", t=t, loop="event")
    v, a = arrays["v"][:n].copy(), arrays["a"][:n].copy()
    rows = Rows(sim, v)
    dv = dv + _normal_part(sim, layouts.now(), rows, dq, dv)
    dt = np.zeros(dq.shape[1])
    if striking is not None:
        row = sim.assembly.contacts[striking].row
        if abs(rows.phid[row]) > float(sim.rate_rounding([striking])[0]):
            dt = -(rows.jacobian[row] @ dq) / rows.phid[row]
    dq, dv = dq + np.outer(v, dt), dv + np.outer(a, dt)
    impacts, log_determinant = 0, 0.0
    while True:
        seen = len(sim.events)
        closed = {c.name for c, mode in zip(sim.assembly.contacts, sim.memory.mode, strict=False) if mode == CLOSED}
        sim.step(sim.t_internal)
        new = sim.events[seen:]
        # closed contacts that carry their share of the blow are constraints, like joints
        blows = [event for event in new if event.kind == "impact" and event.contact not in closed]
        impacts += len(blows)
        _refuse(sim, blows, impacts, new)
        look(sim)
        after = arrays["v"][:n].copy()
        change = np.max(np.abs(after - v) / sim.assembly.coordinate_scale, initial=0.0)
        if blows or change > CONTINUOUS * rate_level(sim.workspace.record):
            dv, restitution = _jump(sim, layouts.now(), blows[0] if blows else None, v, after, dq, dv, dt)
            log_determinant += 2.0 * np.log(restitution) if restitution > 0.0 else -np.inf
        v = after
        if not sim.pending:
            break
    look(sim)
    return Crossing(dq - np.outer(v, dt), dv - np.outer(arrays["a"][:n], dt), impacts, log_determinant)


def _normal_part(sim: Simulation, layout: Layout, rows: Rows, dq: Floats, dv: Floats) -> Floats:
    """What has to be added to dv so that A dv = -B dq in the active rows, of least M-norm."""
    look(sim)
    mass, _ = layout.matrices(sim)
    missing = rows.vary(dq, dv, np.zeros(dq.shape[1]))[layout.active]
    return _solve(mass, rows.jacobian[layout.active], np.zeros_like(dq), -missing)[0]


def _solve(mass: Floats, jacobian: Floats, upper: Floats, lower: Floats) -> tuple[Floats, Floats]:
    """Solution of [M A^T; A 0] (x, Lambda) = (upper, lower)."""
    n, m = len(mass), len(jacobian)
    saddle = np.zeros((n + m, n + m))
    saddle[:n, :n], saddle[:n, n:], saddle[n:, :n] = mass, jacobian.T, jacobian
    found = np.linalg.solve(saddle, np.concatenate([upper, lower]))
    return found[:n], found[n:]


def _jump(
    sim: Simulation, layout: Layout, event: Event | None, v: Floats, after: Floats, dq: Floats, dv: Floats, dt: Floats
) -> tuple[Floats, float]:
    """Variations of the velocities after a jump from `v` to `after` (n,), at the varied time of the event, and e (1 if
    a driver jumped)."""
    n, arrays = sim.assembly.n, sim.workspace.arrays
    late, early, still = Rows(sim, after), Rows(sim, v), Rows(sim, np.zeros(n))
    active, row, restitution = layout.active, -1, 1.0
    target = np.zeros(sim.assembly.m)
    varied = np.zeros((sim.assembly.m, dq.shape[1]))
    if event is not None:
        contact = next(contact for contact in sim.assembly.contacts if contact.name == event.contact)
        row, restitution = contact.row, _restitution(sim, contact.law, event)
        active = active if row in active else np.append(active, row)
        target[row] = -restitution * early.phid[row]
        varied[row] = -restitution * early.vary(dq, dv, dt)[row]
    jacobian = late.jacobian[active]
    look(sim)
    mass, _ = layout.matrices(sim)
    w, multipliers = _solve(mass, jacobian, np.zeros(n), (target - early.phid)[active])
    scale = sim.assembly.coordinate_scale
    if np.max(np.abs(v + w - after) / scale) > MISMATCH * max(sim.scales.rate, np.max(np.abs(v) / scale)):
        t = sim.t_internal
        raise SimulationError(
            f"the velocities after the impact at t = {t:.9g} s are not those of Newton's law at one contact "
            f"(difference {np.max(np.abs(v + w - after)):.3g}): variations know only that law",
            t=t,
            loop="event",
        )
    turned = _turned(sim, layout, w, dict(zip(active.tolist(), multipliers, strict=True)))
    if row >= 0 and row not in layout.active:
        hessian = np.zeros((n, n))
        gap_hessian(sim.workspace.record, row, _support(sim, row), hessian)
        turned = turned + multipliers[-1] * hessian
    by_time = mass_by_time(sim, sim.t_internal, arrays["q"][:n]) @ w + still.rate[active].T @ multipliers
    dw, _ = _solve(
        mass,
        jacobian,
        -turned @ dq - np.outer(by_time, dt),
        (varied - late.vary(dq, dv, dt))[active],
    )
    return dv + dw, restitution


def _restitution(sim: Simulation, law: object, event: Event) -> float:
    # what was struck without rebound separates at rounding
    if event.separation_speed <= MISMATCH * event.approach_speed or not isinstance(law, ImpactLaw):
        return 0.0
    return float(law.restitution)


def _turned(sim: Simulation, layout: Layout, w: Floats, multipliers: dict[int, float]) -> Floats:
    """(M w)_q + (A^T Lambda)_q (n, n) over the active rows: K is affine in accelerations and multipliers."""
    n, arrays = layout.n, sim.workspace.arrays
    look(sim)
    arrays["a"][:n], arrays["lam"][:] = 0.0, 0.0
    without, _ = layout.matrices(sim, 1.0)
    arrays["a"][:n] = w
    for row in layout.active:
        arrays["lam"][row] = multipliers[int(row)]
    return layout.matrices(sim, 1.0)[0] - without


def _support(sim: Simulation, row: int) -> NDArray[np.int64]:
    """Coordinates that the gap in `row` depends on."""
    n = sim.assembly.n
    found = {int(i) for batch in sim.assembly.batches for e in range(len(batch.coord))
             if row in batch.row[e] for i in batch.coord[e] if i < n}  # fmt: skip
    return np.array(sorted(found), dtype=np.int64)


def _refuse(sim: Simulation, blows: list[Event], impacts: int, new: list[Event]) -> None:
    """Raise SimulationError where variations have no limit."""
    t = sim.t_internal
    if impacts > 1:
        names = [event.contact for event in blows]
        raise SimulationError(
            f"contacts {names} strike at one instant, t = {t:.9g} s: neighbouring motions strike one after the other, "
            "in either order, and the exponents are not defined there. Change the start or a length a little.",
            t=t,
            loop="event",
        )
    closed = [event.contact for event in new if event.kind in ("close", "rest")]
    if closed and impacts == 0:
        raise SimulationError(
            f"contact '{closed[0]}' touches at t = {t:.9g} s without approaching: some neighbouring motions strike it, "
            "others miss it, and the exponents are not defined there. Change a parameter or the start.",
            t=t,
            loop="event",
        )
