"""Interface-Jacobian: Newton's iteration on the inputs u at the end of a step, r(u) = g(u) - u = 0.

g(u) is what the outputs make the inputs after a step with u. Its Jacobian needs no step:

    dg/du = factor (dy/du + w h dy'/du + w h^2/2 dy''/du)

where the derivatives on the right are directional derivatives at held state at the end of the step, y' and y'' the
outputs that are the derivatives of y in time (of a position: its velocity and acceleration), and w the part of u in the
input that is held. For a force that moves a body the first two vanish, and what is left is h^2/2 times the inverse of
the mass that the force feels: right to leading order in h; Broyden's update brings the rest from pass to pass. Where
that does not converge, steps done again with one input moved give the Jacobian.
After Sicklinger et al., "Interface Jacobian-based co-simulation", Int. J. Numer. Meth. Engng 98 (2014) 418.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from .coupled import Coupled, Moment, Vector
from .description import MasterSettings
from .errors import CouplingError, MasterError
from .instance import Instance
from .iterated import Repeated
from .rates import time_derivatives
from .variable import Variable

SLOW = 0.3
"""A pass that leaves more than this part of the residual asks for a new Jacobian."""
MOVE = 1e-6
"""Part of an input's largest value by which it is moved to form a difference."""


class Newton(Repeated):
    """Newton's iteration with the interface Jacobian, renewed when it does not converge."""

    def __init__(self, settings: MasterSettings, coupled: Coupled, sequence: Sequence[int]) -> None:
        super().__init__(settings, coupled, sequence)
        self._rates = [time_derivatives(coupled.instances[link.source], link.output) for link in coupled.links]
        self._refused: set[tuple[int, str]] = set()
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
            # leading order in h may be too little for a long step
            exact = self.settings.jacobian == "steps" or self._renewals > 0
            self._renewals += 1
            by = self._by_steps if exact else self._by_derivatives
            self._matrix = by(coupled, moment, t, h, start, u, found) - np.eye(len(u))
        self._last = (u, residual)
        try:
            return np.asarray(u - np.linalg.solve(self._matrix, residual))
        except np.linalg.LinAlgError:
            raise CouplingError(
                f"the interface Jacobian of the step from t = {t!r} s by {h!r} s is singular: use a smaller step"
            ) from None

    def _by_derivatives(
        self, coupled: Coupled, moment: Moment, t: float, h: float, start: Vector, u: Vector, found: Vector
    ) -> NDArray[np.float64]:
        """dg/du from derivatives at the end of the step, where the instances are."""
        matrix = np.zeros((len(u), len(u)))
        for a, into in enumerate(coupled.links):
            outs = [b for b, link in enumerate(coupled.links) if link.source == into.target]
            if not outs:
                continue
            unknowns = [variable for b in outs for variable in (coupled.links[b].output, *self._rates[b])]
            move = MOVE * (coupled.scale[a] or 1.0)
            derivatives = iter(
                self._derivatives(coupled.instances[into.target], into.target, unknowns, into.input, move)
            )
            for b in outs:
                matrix[b, a] = next(derivatives)
                part = self.weight[a]
                for k, _ in enumerate(self._rates[b]):
                    part *= h / (k + 1.0)
                    matrix[b, a] += part * next(derivatives)
                matrix[b, a] *= coupled.links[b].factor
        return matrix

    def _derivatives(
        self, instance: Instance, number: int, unknowns: Sequence[Variable], known: Variable, move: float
    ) -> Vector:
        """Derivatives at held state: the instance's own, or else differences."""
        references = [variable.reference for variable in unknowns]
        if instance.abilities.derivatives and (number, known.name) not in self._refused:
            try:
                return instance.derivative(references, known.reference)
            except MasterError:
                self._refused.add((number, known.name))
        state = instance.state()
        try:
            old = instance.get([known.reference])
            before = instance.get(references)
            instance.set([known.reference], old + move)
            return np.asarray((instance.get(references) - before) / move)
        finally:
            instance.restore(state)
            instance.free(state)

    def _by_steps(
        self, coupled: Coupled, moment: Moment, t: float, h: float, start: Vector, u: Vector, found: Vector
    ) -> NDArray[np.float64]:
        """dg/du from steps done again, each with one input moved."""
        matrix = np.zeros((len(u), len(u)))
        for a, into in enumerate(coupled.links):
            outs = [b for b, link in enumerate(coupled.links) if link.source == into.target]
            if not outs:
                continue
            move = MOVE * (coupled.scale[a] or 1.0)
            moved = u.copy()
            moved[a] += move
            instance, links = coupled.instances[into.target], coupled.into[into.target]
            instance.restore(moment.states[into.target])
            w = self.weight[links]
            coupled.write(links, (1.0 - w) * start[links] + w * moved[links])
            instance.step(t, h)
            coupled.write(links, moved[links])
            matrix[outs, a] = (coupled.read(outs) - found[outs]) / move
        return matrix
