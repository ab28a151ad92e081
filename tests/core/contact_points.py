"""A contact at given states: rows, residuals, tangents, for tests of gaps, sliding distances and their derivatives."""

import numpy as np
from test_tangents import Point, check_levels, check_matrix
from tlismni.core.state.modes import ACTIVE, CLOSED, STICKS


class ContactPoint(Point):
    """A model with one contact in a given mode (and `slide`, if it has friction) at any point of its state space."""

    def __init__(self, model, mode, slide=0.0, stuck_at=0.0):
        super().__init__(model)
        self.remember(("mode", "approach_speed", "slide_mode", "slide_start"), (mode, 0.9, slide, stuck_at))
        one, none = frozenset({0}), frozenset()
        sticks = mode == CLOSED and slide == 0.0 and self.m > 1
        self.workspace.engage(one if mode == CLOSED else none, one, one if sticks else none)

    def gap(self, q, v=None):
        """Gap and its rate."""
        rows = self.at(0.0, q, np.zeros(self.n) if v is None else v, np.zeros(self.n), np.zeros(self.m))
        return rows[1][0], rows[2][0]

    def slide(self, q, v=None):
        """Sliding distance and its rate."""
        rows = self.at(0.0, q, np.zeros(self.n) if v is None else v, np.zeros(self.n), np.zeros(self.m))
        return rows[1][1], rows[2][1]


def state_at(point, q, seed):
    """A state (t, q, v, a, lam) with random rates and multipliers."""
    random = np.random.default_rng(seed)
    internal = np.zeros(point.n - len(q))
    return [
        0.0, np.array([*q, *internal], dtype=float), *(random.uniform(-1.0, 1.0, point.n) for _ in range(2)),
        random.uniform(-2.0, -0.5, point.m),
    ]  # fmt: skip


def check_tangent(point, state, h=1e-3, tolerance=1e-7):
    """The part of the matrix that belongs to the motion is the derivative of the residuals; gives the matrix."""
    c_q, c_v, n, no_lam = 0.6, 0.8, point.n, np.zeros(point.m)
    point.at(*state)
    matrix = point.tangent(c_q, c_v)
    s = np.array([point.derivative(0, (0.0, c_q * e, c_v * e, e, no_lam), state, h) for e in np.eye(n)]).T
    assert np.abs(matrix[:n, :n] - s).max() < tolerance * max(1.0, np.abs(s).max())
    return matrix


def check_derivatives(point, state, h=1e-3, tolerance=1e-7, distances=slice(None)):
    """The matrix is the derivative of the residuals, and the levels are those of each other, by central differences of
    span h. The shapes must stay in the same region of their contour. `distances`: rows whose position level is one."""
    n, active = point.n, point.workspace.structure.active
    nothing, no_lam, unit = np.zeros(point.n), np.zeros(point.m), np.eye(n)
    matrix = check_tangent(point, state, h, tolerance)
    jacobian = np.array([point.derivative(1, (0.0, e, nothing, nothing, no_lam), state, h) for e in unit]).T[active]
    assert np.abs(matrix[n:, :n] - jacobian).max(initial=0.0) < tolerance
    for k, row in enumerate(active):
        force = point.derivative(0, (0.0, nothing, nothing, nothing, np.eye(point.m)[row]), state, h)
        assert np.abs(matrix[:n, n + k] - force).max() < tolerance
    _, _, v, a, _ = state
    first = point.derivative(1, (0.0, v, nothing, nothing, no_lam), state, h)
    second = point.derivative(2, (0.0, v, a, nothing, no_lam), state, h)
    _, _, phid, phidd = point.at(*state)
    assert np.abs(phid - first)[distances].max() < tolerance
    assert np.abs(phidd - second).max() < tolerance


def check_in_space(closed, rubbing, sticking, states):
    """Matrix, levels and tangents of models of one contact in space: a constraint, a force with friction, and one that
    sticks. `states` gives those of a point."""
    point = Point(closed, CLOSED)
    rubbing, sticking = Point(rubbing, ACTIVE), Point(sticking)
    sticking.workspace.engage(frozenset({0}), frozenset(), frozenset({0, 1}))
    sticking.remember(("mode", "slide_mode", "tangent_angle", "tangent_axis"), (CLOSED, STICKS, 0.7, 2))
    for state in states(point):
        check_matrix(point, state, h=1e-3)
        check_levels(point, state, 1e-3)
    for each in (rubbing, sticking):
        for state in states(each):
            check_tangent(each, state)
