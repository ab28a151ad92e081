"""How fast a system moves, as it stands at the start of a run: periods of vibrations, durations of contacts.

A vibration matters as far as it gives way to what acts from outside: its share in the compliance at an input is
(phi . b)^2 / omega^2, with phi its shape of unit modal mass and b the direction of the input's load.
"""

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.evaluate import evaluate_residuals, evaluate_tangent
from ..errors import TlismniError
from ..laws import ForceLaw

COMPLIANCE = 0.95
"""Part of the compliance at each input that the vibrations looked at must have together."""
MOST_COORDINATES = 400
"""Larger systems are not looked at: their matrices are dense here."""
NO_STIFFNESS = 1e-9
"""Square of a frequency, relative to the largest, that is a free motion's."""
DEEPEST = 200
"""Halvings in the search for the deepest penetration."""


def vibration_period(sim: Any) -> float:
    """Shortest period, s, of the vibrations that make up 95 % of the compliance at the inputs; without loads as inputs
    the longest of all. inf if nothing vibrates, or for more than 400 coordinates.

    Undamped, about the present point of the run, with its joints and closed contacts.
    """
    n = sim.assembly.n
    if not 0 < n <= MOST_COORDINATES:
        return math.inf
    mass, stiffness, jacobian, loads = _matrices(sim)
    free = _null_space(jacobian)
    try:
        half = np.linalg.cholesky(free.T @ mass @ free)
    except np.linalg.LinAlgError:  # a coordinate without mass
        return math.inf
    reduced = np.linalg.solve(half, np.linalg.solve(half, free.T @ (0.5 * (stiffness + stiffness.T)) @ free).T)
    squares, shapes = np.linalg.eigh(0.5 * (reduced + reduced.T))
    vibrates = squares > NO_STIFFNESS * np.max(np.abs(squares), initial=0.0)
    squares, shapes = squares[vibrates], shapes[:, vibrates]
    if not len(squares):
        return math.inf
    shares = (shapes.T @ np.linalg.solve(half, free.T @ loads)) ** 2 / squares[:, None]
    fastest = [_needed(squares, share) for share in shares.T if np.any(share > 0.0)]
    return 2.0 * math.pi / math.sqrt(max(fastest, default=float(squares[0])))


def _needed(squares: NDArray[np.float64], share: NDArray[np.float64]) -> float:
    """Largest square of a frequency among the vibrations with the largest shares, COMPLIANCE of it together."""
    order = np.argsort(-share, kind="stable")
    count = int(np.searchsorted(np.cumsum(share[order]), COMPLIANCE * np.sum(share))) + 1
    return float(np.max(squares[order[:count]]))


def _matrices(sim: Any) -> tuple[NDArray[np.float64], ...]:
    """M, K, Phi_q and the loads of unit inputs (n, inputs) at the present point; the run stays as it is."""
    before, arrays, n = sim.state(), sim.workspace.arrays, sim.assembly.n
    try:
        sim.sample()
        structure, record = sim.workspace.structure, sim.workspace.record
        rows, cols, nnz = structure.rows, structure.cols, structure.nnz
        size, held = n + len(structure.multiplier_rows), n + structure.m_act
        full = []
        for c_q in (0.0, 1.0):
            evaluate_tangent(record, c_q, 0.0)
            matrix = np.zeros((size, size))
            np.add.at(matrix, (rows, cols), arrays["values"][:nnz])
            full.append(matrix)
        count = len(sim.assembly.input_names)
        loads, inputs = np.zeros((n, count)), arrays["inputs"]
        inputs[:count, :3] = 0.0
        evaluate_residuals(record)
        at_rest = arrays["r"][:n].copy()
        for k in range(count):
            inputs[k, 0] = 1.0
            evaluate_residuals(record)
            loads[:, k] = at_rest - arrays["r"][:n]
            inputs[k, 0] = 0.0
        return full[0][:n, :n], full[1][:n, :n] - full[0][:n, :n], full[0][n:held, :n], loads
    finally:
        sim.restore(before)


def _null_space(jacobian: NDArray[np.float64]) -> NDArray[np.float64]:
    """An orthonormal basis (n, free) of the motions that the rows (m, n) allow."""
    n = jacobian.shape[1]
    if not len(jacobian):
        return np.eye(n)
    _, values, right = np.linalg.svd(jacobian)
    rank = int(np.sum(values > 1e-10 * max(values[0], 1e-300)))
    return np.ascontiguousarray(right[rank:].T)


@dataclass(frozen=True)
class Blow:
    """What a blow is like: its duration (s), largest force (N), energy (J) and depth (m), approach speed (m/s)."""

    duration: float
    force: float
    energy: float
    depth: float
    speed: float


def contact_blows(sim: Any, speed: float) -> dict[str, Blow]:
    """About what a blow is like in each contact with a force law, by its name, at the present effective mass m.

    The depth d is that at which the law's elastic energy is m v^2/2, the duration pi d / v: exact for a linear spring,
    7 % above for Hertz's exponent 3/2; the force m v^2 / d is exact for the spring, and 4/5 of Hertz's. v is the
    present approach speed, or `speed` (m/s) where the shapes do not approach.
    """
    found = {}
    before = sim.state()
    for k, contact in enumerate(sim.assembly.contacts):
        if not isinstance(contact.law, ForceLaw):
            continue
        try:
            sim.sample()
            approach = -sim.gap_rate(k)
            v = approach if approach > 1e-3 * speed else speed
            energy = 0.5 * sim.effective_mass(k) * v * v
            depth = _deepest(contact.law, energy)
            found[contact.name] = Blow(math.pi * depth / v, 2.0 * energy / depth, energy, depth, v)
        except (TlismniError, ArithmeticError, ValueError):  # a contact that cannot be struck as things are now
            continue
        finally:
            sim.restore(before)
    return found


def contact_durations(sim: Any, speed: float) -> dict[str, float]:
    """About how long a blow takes in each contact with a force law, s, by its name: see `contact_blows`."""
    return {name: blow.duration for name, blow in contact_blows(sim, speed).items()}


def _deepest(law: ForceLaw, energy: float) -> float:
    """Penetration, m, at which the law holds `energy`, J."""
    low, high = 0.0, 1.0
    while law.elastic_energy(high) < energy:
        low, high = high, 2.0 * high
    for _ in range(DEEPEST):
        middle = 0.5 * (low + high)
        if not low < middle < high:
            break
        low, high = (middle, high) if law.elastic_energy(middle) < energy else (low, middle)
    return high
