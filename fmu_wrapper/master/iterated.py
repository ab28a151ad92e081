"""Master algorithms that repeat a step, with rollback, until the inputs at its end are what the outputs make them.

The unknowns are the inputs u at the end of the step. During the step an instance holds (1 - w) u_0 + w u, where u_0 are
the inputs at its start and w is 0 (`start`), 1/2 (`mean`) or 1 (`end`); then it gets u, and shows its outputs. The mean
is off by O(h) inside the step, but its mean error is O(h^2): order 2; so is a straight line from one end to the other
(`linear`), for instances that take derivatives of inputs. A position with a velocity beside it (`meet`) is
set to what comes to the position and velocity of the end with constant velocity.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from .coupled import Coupled, Moment, Vector
from .description import MasterSettings
from .errors import CouplingError
from .explicit import finish

WEIGHTS = {"start": 0.0, "mean": 0.5, "end": 1.0, "meet": 1.0, "linear": 0.0}
AITKEN_BOUND = 4.0
"""Largest magnitude of Aitken's factor."""


class Repeated:
    """Base of the iterated algorithms: one pass over the instances, convergence, the first guess."""

    def __init__(self, settings: MasterSettings, coupled: Coupled, sequence: Sequence[int]) -> None:
        self.settings = settings
        self.sequence = tuple(sequence)
        self.weight = np.array([WEIGHTS[link.hold] for link in coupled.links])
        met = [k for link in coupled.links if link.rate is not None for k in (coupled.links.index(link), link.rate)]
        self.linear = np.array([link.hold == "linear" for link in coupled.links], dtype=bool)
        self.weight[[k for k in met if not self.linear[k]]] = WEIGHTS["meet"]
        coupled.need_courses(np.flatnonzero(self.linear))
        self.order = 2 if np.all(np.delete((self.weight == 0.5) | self.linear, met)) and len(self.weight) else 1
        control = settings.control
        # the estimate by iteration wants a first pass of order 1
        self.predicts = settings.predictor == "linear" and (control is None or control.estimate != "iteration")
        self.passes = 0
        self.correction: Vector = np.zeros(len(coupled.links))
        """By how much the last step's result differs from that of its first pass."""

    def step(self, coupled: Coupled, t: float, h: float) -> None:
        """Advance all instances from `t` by `h`, s.

        Raises
        ------
        CouplingError : if the iteration does not converge.
        """
        moment = coupled.moment()
        try:
            self._iterate(coupled, moment, t, h)
        finally:
            coupled.free(moment)

    def _iterate(self, coupled: Coupled, moment: Moment, t: float, h: float) -> None:
        start = coupled.values.copy()
        u = start.copy()
        if self.predicts and coupled.rate is not None:
            u += h * coupled.rate
        self._begin(coupled)
        first: Vector | None = None
        history: list[float] = []
        for count in range(self.settings.iterations):
            if count:
                coupled.back(moment)
            used, found = self._pass(coupled, t, h, start, u)
            first = found if first is None else first
            if not np.isfinite(found).all():
                break
            scale = np.maximum(coupled.scale, np.abs(found))
            weights = self.settings.absolute + self.settings.tolerance * scale
            history.append(float(np.max(np.abs(found - used) / weights, initial=0.0)))
            if history[-1] <= 1.0:
                self.correction = found - first
                coupled.values = start
                finish(coupled, h)
                return
            u = self._next(coupled, moment, t, h, start, u, found)
        worst = coupled.links[int(np.argmax(np.abs(found - used) / weights))].label if history else "all inputs"
        trend = " (it diverges)" if len(history) > 1 and history[-1] > history[0] else ""
        raise CouplingError(
            f"the step from t = {t!r} s by {h!r} s does not converge in {len(history)} passes{trend}, '{worst}' least: "
            "use a smaller step or a controlled one, aitken = true, algorithm = 'newton', or more iterations"
        )

    def _pass(self, coupled: Coupled, t: float, h: float, start: Vector, guess: Vector) -> tuple[Vector, Vector]:
        """Step all instances with the guess; gives the inputs that were used, and what the outputs make them."""
        self.passes += 1
        sweep = self._sweeps()
        used = guess.copy()
        done: set[int] = set()
        for i in self.sequence:
            links = coupled.into[i]
            known = [k for k in links if coupled.links[k].source in done] if sweep else []
            if known:
                used[known] = coupled.read(known)
            if links:
                self.write_held(coupled, links, start, used, h)
            coupled.instances[i].step(t, h)
            if links:
                coupled.write(links, used[links])
            done.add(i)
        return used, coupled.read(range(len(coupled.links)))

    def write_held(self, coupled: Coupled, links: Sequence[int], start: Vector, end: Vector, h: float) -> None:
        """Set inputs for a step of length `h`, s, from the inputs at its ends."""
        slopes = np.where(self.linear, (end - start) / h, np.nan) if self.linear.any() else None
        coupled.write_ahead(links, (1.0 - self.weight) * start + self.weight * end, h, slopes, end)

    def _sweeps(self) -> bool:
        return False

    def _begin(self, coupled: Coupled) -> None:
        """Before the passes of a step."""

    def _next(
        self, coupled: Coupled, moment: Moment, t: float, h: float, start: Vector, u: Vector, found: Vector
    ) -> Vector:
        """The inputs to try next, after a pass with `u` that made them `found`."""
        raise NotImplementedError


class Iterated(Repeated):
    """Fixed point of passes in the manner of Jacobi or Gauss-Seidel, with relaxation by a fixed factor or Aitken's."""

    def _sweeps(self) -> bool:
        return self.settings.sweep == "gauss-seidel"

    def _begin(self, coupled: Coupled) -> None:
        self._factor = 1.0
        self._last: Any = None

    def _next(
        self, coupled: Coupled, moment: Moment, t: float, h: float, start: Vector, u: Vector, found: Vector
    ) -> Vector:
        residual = found - u
        if not self.settings.aitken:
            return np.asarray(u + self.settings.relaxation * residual)
        # scaled: forces and displacements stand in one vector
        scaled = residual / np.where(coupled.scale > 0.0, coupled.scale, 1.0)
        if self._last is not None:
            change = scaled - self._last
            square = float(change @ change)
            if square > 0.0:
                factor = -self._factor * float(self._last @ change) / square
                self._factor = float(np.clip(factor, -AITKEN_BOUND, AITKEN_BOUND))
        self._last = scaled
        return np.asarray(u + self._factor * residual)
