"""Interface-Jacobian: Newton's iteration on the inputs u at the end of a step, r(u) = g(u) - u = 0.

g(u) is what the outputs make the inputs after a step with u. Its Jacobian needs no step:

    dg/du = factor (dy/du + w h dy'/du + w h^2/2 dy''/du)

where the derivatives on the right are directional derivatives at held state at the end of the step, y' and y'' the
outputs that are the derivatives of y in time (of a position: its velocity and acceleration), and w the part of u in the
input that is held. For a force that moves a body the first two vanish, and what is left is h^2/2 times the inverse of
the mass that the force feels: right to leading order in h; Broyden's update brings the rest from pass to pass. Where
that does not converge, and along inputs that nothing feels at once (motions that are met at the end of a step), the
step done again with the input moved gives the Jacobian.
After Sicklinger et al., "Interface Jacobian-based co-simulation", Int. J. Numer. Meth. Engng 98 (2014) 418.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .coupled import Coupled, Moment, Vector
from .description import MasterSettings
from .errors import CouplingError, MasterError
from .iterated import Repeated
from .rates import time_derivatives

SLOW = 0.3
"""A pass that leaves more than this part of the residual asks for a new Jacobian."""
MOVE = 1e-4
"""Part of an input's largest value by which it is moved to form a difference."""


class Newton(Repeated):
    """Newton's iteration with the interface Jacobian, renewed when it does not converge."""

    def __init__(self, settings: MasterSettings, coupled: Coupled, sequence: Sequence[int]) -> None:
        super().__init__(settings, coupled, sequence)
        self._rates = [time_derivatives(coupled.instances[link.source], link.output) for link in coupled.links]
        self._refused: set[int] = set()
        """Links into instances that give no derivatives along them."""
        self.jacobians = 0

        self._matrix: NDArray[np.float64] | None = None
        """dr/du; kept from step to step while it serves."""

    def _begin(self, coupled: Coupled) -> None:
        self._last: tuple[Vector, Vector] | None = None
        self._renewals = 0

    def _next(
        self, coupled: Coupled, moment: Moment, t: float, h: float, start: Vector, u: Vector, found: Vector
    ) -> Vector:
        residual = found - u
        scale = np.where(coupled.scale > 0.0, coupled.scale, 1.0)
        if self._last is not None and self._matrix is not None:
            du, dr = (u - self._last[0]) / scale, (residual - self._last[1]) / scale
            reduction = float(np.linalg.norm(residual / scale) / np.linalg.norm(self._last[1] / scale))
            if reduction > (1.0 if self._renewals else SLOW):
                self._matrix = None
            elif float(du @ du) > 0.0:
                # in scaled variables
                scaled = self._matrix * scale[None, :] / scale[:, None]
                scaled += np.outer(dr - scaled @ du, du) / float(du @ du)
                self._matrix = scaled * scale[:, None] / scale[None, :]
        if self._matrix is None:
            self.jacobians += 1
            self._matrix = self._jacobian(coupled, moment, t, h, start, u, found) - np.eye(len(u))
            self._renewals += 1
        self._last = (u, residual)
        try:
            return np.asarray(u - np.linalg.solve(self._matrix, residual))
        except np.linalg.LinAlgError:
            raise CouplingError(
                f"the interface Jacobian of the step from t = {t!r} s by {h!r} s is singular: use a smaller step"
            ) from None

    def _jacobian(
        self, coupled: Coupled, moment: Moment, t: float, h: float, start: Vector, u: Vector, found: Vector
    ) -> NDArray[np.float64]:
        """dg/du, column by column: from derivatives at the end of the step, where the instances are, or from the step
        done again, if an instance gives no derivatives, or they did not lead to convergence."""
        exact = self.settings.jacobian == "steps" or self._renewals > 0
        matrix = np.zeros((len(u), len(u)))
        again: list[tuple[int, list[int]]] = []
        for a, into in enumerate(coupled.links):
            outs = [b for b, link in enumerate(coupled.links) if link.source == into.target]
            column = None if exact or not outs else self._by_derivatives(coupled, a, outs, h)
            if column is not None:
                matrix[outs, a] = column
            elif outs:
                again.append((a, outs))
        for a, outs in again:
            matrix[outs, a] = self._by_step(coupled, moment, a, outs, t, h, start, u, found)
        return matrix

    def _by_derivatives(self, coupled: Coupled, a: int, outs: Sequence[int], h: float) -> Vector | None:
        """Derivatives of g on the links `outs` along the link `a`; None if they say nothing."""
        into = coupled.links[a]
        instance = coupled.instances[into.target]
        if not instance.abilities.derivatives or a in self._refused:
            return None
        unknowns = [variable.reference for b in outs for variable in (coupled.links[b].output, *self._rates[b])]
        try:
            found = instance.derivative(unknowns, into.input.reference)
        except MasterError:
            self._refused.add(a)
            return None
        if not found.any():  # nothing feels the input at once, as a motion that is met at the end of the next step
            return None
        derivatives = iter(found)
        column = np.empty(len(outs))
        for place, b in enumerate(outs):
            column[place] = next(derivatives)
            for k in range(len(self._rates[b])):
                # a held input acts from the start; one that rises linearly is integrated once more
                part = h ** (k + 1) / math.factorial(k + 1)
                part *= 1.0 / (k + 2.0) if self.linear[a] else self.weight[a]
                column[place] += part * next(derivatives)
            column[place] *= coupled.links[b].factor
        return column

    def _by_step(
        self, coupled: Coupled, moment: Moment, a: int, outs: Sequence[int], t: float, h: float,
        start: Vector, u: Vector, found: Vector,
    ) -> Vector:  # fmt: skip
        """The same from the step done again with the input moved."""
        move = MOVE * (coupled.scale[a] or 1.0)
        moved = u.copy()
        moved[a] += move
        number = coupled.links[a].target
        instance, links = coupled.instances[number], coupled.into[number]
        instance.restore(moment.states[number])
        self.write_held(coupled, links, start, moved, h)
        instance.step(t, h)
        coupled.write(links, moved[links])
        return np.asarray((coupled.read(outs) - found[outs]) / move)
