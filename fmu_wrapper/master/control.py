"""The communication step: fixed, or controlled by an estimate of the coupling error, with rollback of rejected steps.

`doubling`: a step is done once with h and once with two halves. For order p the result of the halves is off by about
their difference / (2^p - 1) (Richardson); that must not exceed the tolerance. `iteration`: the difference between the
first pass, which is a step of order 1, and the converged one.
"""

from collections.abc import Iterator
from itertools import pairwise
from typing import Protocol

import numpy as np

from .coupled import Coupled, Vector
from .description import MasterSettings
from .errors import CouplingError, MasterError
from .iterated import Repeated

SAFETY, LARGEST_GROWTH, SMALLEST_GROWTH = 0.9, 2.0, 0.2
AFTER_FAILURE = 0.5


class Algorithm(Protocol):
    """A master algorithm."""

    order: int
    passes: int

    def step(self, coupled: Coupled, t: float, h: float) -> None:
        """Advance all instances from `t` by `h`, s."""


def fixed_steps(coupled: Coupled, algorithm: Algorithm, settings: MasterSettings) -> Iterator[float]:
    """Step to the end; gives the time after each step."""
    count = max(int(np.ceil(settings.t_end / settings.step * (1.0 - 1e-12))), 1)
    times = np.append(np.arange(count) * settings.step, settings.t_end).tolist()
    for t, end in pairwise(times):
        algorithm.step(coupled, t, end - t)
        yield end


class Controlled:
    """Steps that follow the estimated error."""

    def __init__(self, coupled: Coupled, algorithm: Algorithm, settings: MasterSettings) -> None:
        if settings.control is None:
            raise MasterError("a controlled step needs the settings [master.control]")
        for instance in coupled.instances:
            if not instance.abilities.variable_step:
                raise MasterError(f"instance '{instance.name}' takes fixed steps only: leave out [master.control]")
        self.coupled, self.algorithm, self.settings, self.control = coupled, algorithm, settings, settings.control
        self.rejected = 0

    def steps(self) -> Iterator[float]:
        """Step to the end; gives the time after each accepted step.

        Raises
        ------
        CouplingError : if the step falls below the smallest.
        """
        t, t_end = 0.0, self.settings.t_end
        largest = self.control.largest or 0.1 * t_end
        h = min(self.settings.step, largest)
        while t < t_end:
            # no sliver at the end
            left = t_end - t
            h = left if left <= h * (1.0 + 1e-9) else 0.5 * left if left < 2.0 * h else h
            moment = self.coupled.moment()
            try:
                growth = self._attempt(t, h)
                if growth is None:
                    self.coupled.back(moment)
            finally:
                self.coupled.free(moment)
            if growth is None:
                self.rejected += 1
                h *= self._shrink
                if h < self.control.smallest:
                    raise CouplingError(
                        f"the communication step falls below {self.control.smallest!r} s at t = {t!r} s "
                        f"({self._why}): allow a larger error (control.tolerance, control.absolute)"
                    )
                continue
            t = t_end if t + h >= t_end * (1.0 - 1e-14) else t + h
            yield t
            h = min(h * growth, largest)

    def _attempt(self, t: float, h: float) -> float | None:
        """Try a step; gives the growth of the next, or None for a step to be done anew with a `_shrink` part of it."""
        try:
            error = self._error(t, h)
        except MasterError as failure:  # an instance may fail on inputs far off
            self._shrink, self._why = AFTER_FAILURE, str(failure)
            return None
        exponent = 1.0 / (self._order() + 1.0)
        growth = LARGEST_GROWTH if error == 0.0 else SAFETY * error**-exponent
        if error > 1.0:
            self._shrink = max(min(growth, SAFETY), SMALLEST_GROWTH)
            self._why = f"the estimated error is {error:.3g} times what is allowed"
            return None
        return min(max(growth, SMALLEST_GROWTH), LARGEST_GROWTH)

    def _order(self) -> int:
        return 1 if self.control.estimate == "iteration" else self.algorithm.order

    def _error(self, t: float, h: float) -> float:
        """Do the step; gives its error in units of what is allowed."""
        coupled, algorithm = self.coupled, self.algorithm
        if self.control.estimate == "iteration" and isinstance(algorithm, Repeated):
            algorithm.step(coupled, t, h)
            return self._norm(algorithm.correction)
        moment = coupled.moment()
        try:
            algorithm.step(coupled, t, h)
            whole = coupled.values.copy()
            coupled.back(moment)
        finally:
            coupled.free(moment)
        middle = t + 0.5 * h
        algorithm.step(coupled, t, 0.5 * h)
        algorithm.step(coupled, middle, t + h - middle)
        return self._norm((coupled.values - whole) / (2.0**algorithm.order - 1.0))

    def _norm(self, error: Vector) -> float:
        allowed = self.coupled.weights(self.control.tolerance, self.control.absolute)
        return float(np.max(np.abs(error) / allowed, initial=0.0))
