"""Tableaus of fully implicit Runge-Kutta methods, and how their coupled stages are solved with one matrix.

Each tableau comes with a lower triangular matrix S with equal diagonal gamma that takes the place of A in the iteration
matrix ("triangular iteration": van der Houwen and de Swart 1997; equal diagonal, "single Newton": Gonzalez-Pinto,
Montijano and Randez 1995), so that every stage has the matrix M + h gamma D + (h gamma)^2 K. For the linear equation
a + d v + k q = 0 (d, k with h and h^2 in them) one sweep over the stages multiplies the error of the stage
accelerations by

  E(d, k) = I - (I + d S + k S^2)^-1 (I + d A + k A^2).

S was found by minimising the largest spectral radius of E over all d, k >= 0 (`benchmarks/irk_sweeps.py`); a
similarity transformation of A before would win little (0.33 for 0.39 with Radau IIA) and cost products with D and K.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..state.workspace_records import COUPLED_STAGES

Floats = NDArray[np.float64]

_R3, _R6, _R15 = np.sqrt(3.0), np.sqrt(6.0), np.sqrt(15.0)


@dataclass(frozen=True)
class Tableau:
    """A collocation method with s stages.

    Attributes
    ----------
    description : one line.
    c, a, b : nodes (s,), coefficients (s, s), weights (s,).
    sweep : S, (s, s) lower triangular with equal diagonal.
    order : classical order.
    order_of_estimate : order of the embedded formula, at most s: one of order s + 1 compares the method with its own
        collocation polynomial, of degree s, and sees no error at all of a linear equation.
    start_weight : weight of f_n in the embedded formula, which its order leaves free. With symmetric nodes the sign
        decides: -(-1)^s gamma would make the weights orthogonal to one power more, that is order s + 1.
    """

    description: str
    c: tuple[float, ...]
    a: tuple[tuple[float, ...], ...]
    b: tuple[float, ...]
    sweep: tuple[tuple[float, ...], ...]
    order: int
    order_of_estimate: int
    start_weight: float

    @property
    def gamma(self) -> float:
        """Diagonal of the sweep matrix, and the implicit weight of the embedded formula."""
        return self.sweep[0][0]

    @property
    def order_of_error(self) -> int:
        """p where the error estimate falls as h^(p + 1)."""
        return self.order_of_estimate + (0 if self.stiffly_accurate else 1)

    @property
    def stiffly_accurate(self) -> bool:
        """The last stage is the end of the step."""
        return self.c[-1] == 1.0

    def embedded(self) -> tuple[float, Floats]:
        """Weights (b0, bhat (s,)) of yhat = y_n + h (b0 f_n + sum_i bhat_i f_i + gamma f(t_n + h, yhat)).

        The implicit term, with the matrix of the stages, bounds the estimate for stiff components (de Swart and
        Soederlind 1997); the rest follows from the quadrature conditions up to `order_of_estimate`.
        """
        p, c = self.order_of_estimate, np.array(self.c)
        right = 1.0 / np.arange(1, p + 1) - self.gamma
        right[0] -= self.start_weight
        conditions = np.vander(c, p, increasing=True).T
        return self.start_weight, np.asarray(np.linalg.solve(conditions, right), dtype=np.float64)

    def lower_difference(self) -> Floats:
        """Weights (s,) of h f_i at the stages that give something of order h^s: their difference of order s - 1.

        The embedded formula of a Gauss method is s orders below it. Its distance from the method is therefore taken
        times the rate at which such differences fall from one order to the next, distance / lower difference
        (as in Hairer, Norsett and Wanner's DOP853). Zero for the other methods, whose estimate stays as it is.
        """
        if self.stiffly_accurate:
            return np.zeros(len(self.c))
        c = np.array(self.c)
        divided = np.array([1.0 / np.prod([x - y for y in c if y != x]) for x in c])
        return np.asarray(self.gamma * divided / divided[-1])

    def jump_difference(self) -> Floats:
        """Weights (s + 2,) of h f at the start, the stages and the end of the step: their difference of order s + 1.

        Where f jumps within the step the differences do not fall from one order to the next, and what
        `lower_difference` reduces is as large as the error. A jump in f shows in this difference with at least a
        quarter of its error, wherever it lies. A linear equation does not: its collocation polynomial has degree s.
        Zero for the stiffly accurate methods.
        """
        nodes = np.array((0.0, *self.c, 1.0))
        if self.stiffly_accurate:
            return np.zeros(len(nodes))
        divided = np.array([1.0 / np.prod([x - y for y in nodes if y != x]) for x in nodes])
        # a unit jump between two nodes is seen as the sum of the weights before it, and integrated as 1 from its place
        seen, integral = np.abs(np.cumsum(divided)[:-1]), np.cumsum((0.0, *self.b))
        missed = np.maximum(np.abs(nodes[:-1] - integral), np.abs(nodes[1:] - integral))
        return np.asarray(0.25 * divided * np.max(missed / seen))

    def sweep_error(self, d: Floats, k: Floats) -> Floats:
        """E(d, k) of the module's docstring for damping d >= 0 (N,) and stiffness k >= 0 (N,), as (N, s, s)."""
        scale = (1.0 + d + k)[:, None, None]
        d, k = d[:, None, None] / scale, k[:, None, None] / scale
        one = np.eye(len(self.b))
        a, sweep = np.array(self.a), np.array(self.sweep)
        return one - np.linalg.solve(one / scale + d * sweep + k * sweep @ sweep, one / scale + d * a + k * a @ a)

    def end_extrapolation(self) -> Floats:
        """Weights (s,) of the stages' accelerations that extrapolate them to the end of the step (Lagrange)."""
        c = np.array(self.c)
        return np.array([np.prod([(1.0 - y) / (x - y) for y in c if y != x]) for x in c])

    def data(self) -> tuple[tuple[float, ...], ...]:
        """All that a step needs, in the rows that `stages.py` names (the method record's `weights`)."""
        a, sweep, b = np.array(self.a), np.array(self.sweep), np.array(self.b)
        shift = np.tril(sweep, -1)
        shift2 = np.tril(sweep @ sweep, -1)
        start, embedded = self.embedded()

        def block(x: Floats) -> tuple[float, ...]:
            padded = np.zeros((COUPLED_STAGES, COUPLED_STAGES))
            padded[: x.shape[0], : x.shape[-1]] = x
            return tuple(padded.ravel())

        vectors = np.zeros((4, COUPLED_STAGES))
        vectors[:, : len(b)] = self.c, b, b @ a, self.end_extrapolation()
        tail = np.zeros(3 * COUPLED_STAGES + 4)
        tail[: len(b)] = embedded
        tail[COUPLED_STAGES : COUPLED_STAGES + 2] = start, self.gamma
        tail[COUPLED_STAGES + 2 : COUPLED_STAGES + 2 + len(b)] = self.lower_difference()
        tail[2 * COUPLED_STAGES + 2 : 2 * COUPLED_STAGES + 4 + len(b)] = self.jump_difference()
        return (
            block(a),
            block(a @ a),
            block(shift),
            block(shift2),
            tuple(vectors.ravel()),
            tuple(tail),
            block(np.linalg.inv(a)),
        )


MIDPOINT = Tableau(
    "implicit midpoint rule, order 2, symmetric",
    (0.5,),
    ((0.5,),),
    (1.0,),
    ((0.5,),),
    order=2,
    order_of_estimate=1,
    start_weight=0.5,
)
"""Gauss with one stage: the smooth part of steps of impulses."""

TABLEAUS = {
    "radau3": Tableau(  # Hairer and Wanner, Solving ODEs II, table IV.5.6
        "Radau IIA with 3 stages, order 5, L-stable",
        ((4.0 - _R6) / 10.0, (4.0 + _R6) / 10.0, 1.0),
        (
            ((88.0 - 7.0 * _R6) / 360.0, (296.0 - 169.0 * _R6) / 1800.0, (-2.0 + 3.0 * _R6) / 225.0),
            ((296.0 + 169.0 * _R6) / 1800.0, (88.0 + 7.0 * _R6) / 360.0, (-2.0 - 3.0 * _R6) / 225.0),
            ((16.0 - _R6) / 36.0, (16.0 + _R6) / 36.0, 1.0 / 9.0),
        ),
        ((16.0 - _R6) / 36.0, (16.0 + _R6) / 36.0, 1.0 / 9.0),
        ((0.26472, 0.0, 0.0), (0.44237, 0.26472, 0.0), (0.25941, 0.34042, 0.26472)),
        order=5,
        order_of_estimate=3,
        start_weight=0.26472,
    ),
    "gauss2": Tableau(  # Hammer and Hollingsworth 1955
        "Gauss with 2 stages, order 4, symmetric",
        (0.5 - _R3 / 6.0, 0.5 + _R3 / 6.0),
        ((0.25, 0.25 - _R3 / 6.0), (0.25 + _R3 / 6.0, 0.25)),
        (0.5, 0.5),
        ((0.27826, 0.0), (0.58668, 0.27826)),
        order=4,
        order_of_estimate=2,
        start_weight=0.27826,
    ),
    "gauss3": Tableau(  # Kuntzmann 1961, Butcher 1964
        "Gauss with 3 stages, order 6, symmetric",
        (0.5 - _R15 / 10.0, 0.5, 0.5 + _R15 / 10.0),
        (
            (5.0 / 36.0, 2.0 / 9.0 - _R15 / 15.0, 5.0 / 36.0 - _R15 / 30.0),
            (5.0 / 36.0 + _R15 / 24.0, 2.0 / 9.0, 5.0 / 36.0 - _R15 / 24.0),
            (5.0 / 36.0 + _R15 / 30.0, 2.0 / 9.0 + _R15 / 15.0, 5.0 / 36.0),
        ),
        (5.0 / 18.0, 4.0 / 9.0, 5.0 / 18.0),
        ((0.20222, 0.0, 0.0), (0.23620, 0.20222, 0.0), (0.05584, 0.49162, 0.20222)),
        order=6,
        order_of_estimate=3,
        start_weight=-0.20222,
    ),
}
