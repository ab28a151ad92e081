"""Master algorithms that step every instance once: inputs are held at the last known values.

Both have order 1: the held input is off by O(h) in the step, however exact the instances are.
"""

from collections.abc import Sequence
from typing import ClassVar

from .coupled import Coupled


class Jacobi:
    """All instances step with the inputs of the step's start."""

    order: ClassVar[int] = 1
    """Of the error of the coupling."""
    passes = 0
    """Passes over the instances so far."""

    def step(self, coupled: Coupled, t: float, h: float) -> None:
        """Advance all instances from `t` by `h`, s."""
        self.passes += 1
        for instance in coupled.instances:
            instance.step(t, h)
        finish(coupled, h)


class GaussSeidel:
    """One instance after the other; each takes the outputs at the end of the step of those before it."""

    order: ClassVar[int] = 1
    passes = 0

    def __init__(self, sequence: Sequence[int]) -> None:
        self.sequence = tuple(sequence)

    def step(self, coupled: Coupled, t: float, h: float) -> None:
        """Advance all instances from `t` by `h`, s."""
        self.passes += 1
        stepped: set[int] = set()
        values = coupled.values.copy()
        for i in self.sequence:
            links = [k for k in coupled.into[i] if coupled.links[k].source in stepped]
            if links:
                values[links] = coupled.read(links)
                coupled.write_ahead(links, values, h)
            coupled.instances[i].step(t, h)
            stepped.add(i)
        finish(coupled, h)


def finish(coupled: Coupled, h: float) -> None:
    """Pass the values at the end of a step of length `h`, s, along the links."""
    before = coupled.values.copy()
    coupled.settle()
    coupled.rate = (coupled.values - before) / h
