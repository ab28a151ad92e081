"""Master algorithms that step every instance once: inputs are held at the last known values, or go on as they changed
last.

Held values have order 1: they are off by O(h) in the step, however exact the instances are. Inputs that go on linearly
are off by O(h^2): order 2, if all do.
"""

from collections.abc import Sequence

import numpy as np

from .coupled import Coupled, Vector


class Jacobi:
    """All instances step with the inputs of the step's start; `linear`: which go on with their last change."""

    def __init__(self, coupled: Coupled, linear: bool = False) -> None:
        self.order = 2 if linear else 1
        """Of the error of the coupling."""
        self.passes = 0
        """Passes over the instances so far."""
        self.linear = linear
        if linear:
            coupled.need_courses(_going(coupled))

    def step(self, coupled: Coupled, t: float, h: float) -> None:
        """Advance all instances from `t` by `h`, s."""
        self.passes += 1
        if self.linear and coupled.rate is not None:
            coupled.write_slopes(range(len(coupled.links)), _slopes(coupled, coupled.rate))
        for instance in coupled.instances:
            instance.step(t, h)
        finish(coupled, h)


class GaussSeidel:
    """One instance after the other; each takes the outputs at the end of the step of those before it."""

    def __init__(self, coupled: Coupled, sequence: Sequence[int], linear: bool = False) -> None:
        self.sequence = tuple(sequence)
        self.order = 2 if linear else 1
        self.passes = 0
        self.linear = linear
        if linear:
            coupled.need_courses(_going(coupled))

    def step(self, coupled: Coupled, t: float, h: float) -> None:
        """Advance all instances from `t` by `h`, s."""
        self.passes += 1
        stepped: set[int] = set()
        end = coupled.values.copy()
        if self.linear and coupled.rate is not None:
            coupled.write_slopes(range(len(coupled.links)), _slopes(coupled, coupled.rate))
        for i in self.sequence:
            links = [k for k in coupled.into[i] if coupled.links[k].source in stepped]
            if links:
                end[links] = coupled.read(links)
                if self.linear:
                    slopes = _slopes(coupled, (end - coupled.values) / h)
                    coupled.write_ahead(links, coupled.values, h, slopes, end)
                else:
                    coupled.write_ahead(links, end, h)
            coupled.instances[i].step(t, h)
            stepped.add(i)
        finish(coupled, h)


def _going(coupled: Coupled) -> list[int]:
    """Links whose inputs need a derivative to go on: all but positions whose velocity comes along."""
    return [k for k, link in enumerate(coupled.links) if link.rate is None]


def _slopes(coupled: Coupled, rates: Vector) -> Vector:
    """Derivatives of the inputs that need one to go on, NaN for the others."""
    slopes = np.full(len(rates), np.nan)
    going = _going(coupled)
    slopes[going] = rates[going]
    return slopes


def finish(coupled: Coupled, h: float) -> None:
    """Pass the values at the end of a step of length `h`, s, along the links."""
    before = coupled.values.copy()
    coupled.settle()
    coupled.rate = (coupled.values - before) / h
