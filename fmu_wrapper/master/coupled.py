"""The coupled instances: their time, the values on their links, and what can be done with them all at once."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .errors import CouplingError, MasterError
from .graph import Graph
from .instance import Instance

Vector = NDArray[np.float64]
LOOP_PASSES = 20
LOOP_TOLERANCE = 1e-12
"""Of the solution of an algebraic loop, relative to its largest value so far."""
PROBE = 1e-3
"""Size of the move by which derivatives at held states are formed, relative to the value (and 1): what passes an input
through at once is affine or nearly so."""


@dataclass(frozen=True)
class Moment:
    """States of all instances, and the values on the links."""

    states: tuple[Any, ...]
    values: Vector
    rate: Vector | None
    scale: Vector


class Coupled:
    """Instances with their graph. `values` are the inputs at the present time, one for each link."""

    def __init__(self, instances: Sequence[Instance], graph: Graph) -> None:
        self.instances = tuple(instances)
        self.graph = graph
        self.links = graph.links
        self.values: Vector = np.zeros(len(self.links))
        self.scale: Vector = np.zeros(len(self.links))
        """Largest magnitude so far of each value."""
        self.rate: Vector | None = None
        """How fast the values changed in the last step, 1/s; None before there was one."""
        self.factors = np.array([link.factor for link in self.links])
        self.into = [[k for k, link in enumerate(self.links) if link.target == i] for i in range(len(instances))]
        """By instance, the links that feed it."""
        self.rollbacks = 0

    def read(self, links: Iterable[int]) -> Vector:
        """What the outputs at the other ends of `links` make their inputs. Raises CouplingError for one that is not
        finite."""
        links = list(links)
        found = np.empty(len(links))
        for i in dict.fromkeys(self.links[k].source for k in links):
            places = [p for p, k in enumerate(links) if self.links[k].source == i]
            found[places] = self.instances[i].get([self.links[links[p]].output.reference for p in places])
        if not np.isfinite(found).all():
            self._refuse(links, found)
        return np.asarray(found * self.factors[links])

    def _refuse(self, links: Sequence[int], found: Vector) -> None:
        k, x = next((k, x) for k, x in zip(links, found.tolist(), strict=True) if not np.isfinite(x))
        raise CouplingError(
            f"output '{self.links[k].output.name}' of instance '{self.instances[self.links[k].source].name}' is {x!r}: "
            "the instance runs away or is out of its range; check its parameters and inputs, use a smaller step or a "
            "controlled one"
        )

    def write(self, links: Iterable[int], values: Vector) -> None:
        """Set inputs."""
        links = list(links)
        for i in dict.fromkeys(self.links[k].target for k in links):
            places = [p for p, k in enumerate(links) if self.links[k].target == i]
            self.instances[i].set([self.links[links[p]].input.reference for p in places], values[places])

    def write_ahead(
        self, links: Sequence[int], values: Vector, h: float, slopes: Vector | None = None, end: Vector | None = None
    ) -> None:
        """Set inputs for a step of length `h`, s.

        Parameters
        ----------
        values : for each link, what it holds.
        slopes : for each link, with which derivative it goes on (NaN: none).
        end : for each link the value at the step's end, for positions that shall meet it; None for `values`.
        """
        end = values if end is None else end
        held = values.copy()
        for k in links:
            rate = self.links[k].rate
            if rate is not None:
                carried = values[rate] if slopes is None or np.isnan(slopes[rate]) else 0.5 * (values[rate] + end[rate])
                held[k] = end[k] - h * carried
        self.write(links, held[links])
        if slopes is not None:
            self.write_slopes(links, slopes)

    def write_slopes(self, links: Iterable[int], slopes: Vector) -> None:
        """Let inputs that have just been set go on with derivatives (one for each link; NaN: none)."""
        going = [k for k in links if not np.isnan(slopes[k])]
        for i in dict.fromkeys(self.links[k].target for k in going):
            of_one = [k for k in going if self.links[k].target == i]
            self.instances[i].set_slopes([self.links[k].input.reference for k in of_one], slopes[of_one])

    def need_courses(self, links: Iterable[int]) -> None:
        """Raise MasterError if an instance that these links feed takes no derivatives of inputs."""
        for k in links:
            instance = self.instances[self.links[k].target]
            if not instance.abilities.courses:
                raise MasterError(
                    f"instance '{instance.name}' takes no derivatives of inputs, which '{self.links[k].label}' needs "
                    "to go on linearly: use FMI 2.0 and an FMU with canInterpolateInputs, or hold = 'mean'"
                )

    def settle(self) -> None:
        """Pass values along all links, in order, so that every input is what its output makes it.

        Raises
        ------
        CouplingError : if an algebraic loop has no solution that Newton's iteration finds, or an output is not finite.
        """
        for stage in self.graph.stages:
            links = list(stage.links)
            if stage.loop:
                self._solve_loop(links)
            else:
                found = self.read(links)
                self.write(links, found)
                self.values[links] = found
        self.scale = np.maximum(self.scale, np.abs(self.values))

    def _solve_loop(self, links: list[int]) -> None:
        """Newton's iteration on u = C y(u) at held states, its matrix from differences."""
        u = self.values[links].copy()
        largest = 0.0
        for _ in range(LOOP_PASSES):
            self.write(links, u)
            g = self.read(links)
            residual = g - u
            largest = max(largest, float(np.max(np.abs(np.concatenate([g, u])))))
            if not np.isfinite(residual).all():
                break
            if float(np.max(np.abs(residual))) <= LOOP_TOLERANCE * largest:
                self.values[links] = u
                return
            matrix = np.eye(len(links))
            for column in range(len(links)):
                moved = u.copy()
                moved[column] += PROBE * (1.0 + abs(u[column]))
                self.write(links, moved)
                matrix[:, column] -= (self.read(links) - g) / (moved[column] - u[column])
            try:
                u = u + np.linalg.solve(matrix, residual)
            except np.linalg.LinAlgError:
                break
        names = " -> ".join(self.links[k].label for k in links)
        raise CouplingError(
            f"the algebraic loop {names} has no solution near {u.tolist()}: connect an output that does not depend on "
            "its input at once (a position or velocity for a force), or join the instances in one model"
        )

    # states

    def moment(self) -> Moment:
        """The present, to go back to. Raises MasterError for an instance that cannot."""
        for instance in self.instances:
            if not instance.abilities.state:
                raise MasterError(
                    f"instance '{instance.name}' cannot get and set its state: iterated algorithms and a controlled "
                    "step need that; use 'jacobi' or 'gauss-seidel' with a fixed step"
                )
        return Moment(tuple(instance.state() for instance in self.instances), self.values.copy(), self.rate, self.scale)

    def back(self, moment: Moment) -> None:
        """Go back."""
        self.rollbacks += 1
        for instance, state in zip(self.instances, moment.states, strict=True):
            instance.restore(state)
        # a pass that went astray must not count in what is large
        self.values, self.rate, self.scale = moment.values.copy(), moment.rate, moment.scale

    def free(self, moment: Moment) -> None:
        """Free the states of a moment."""
        for instance, state in zip(self.instances, moment.states, strict=True):
            instance.free(state)

    def weights(self, relative: float, absolute: float) -> Vector:
        """What counts as small of each value."""
        return np.asarray(absolute + relative * self.scale)


def probe_feedthrough(coupled: Coupled, pairs: Iterable[tuple[int, int]]) -> list[tuple[int, int]]:
    """Those of `pairs` (link in, link out) in which the output moves with the input; in initialization mode."""
    pairs = list(pairs)
    found: list[tuple[int, int]] = []
    for a in dict.fromkeys(a for a, _ in pairs):
        link, outs = coupled.links[a], [b for first, b in pairs if first == a]
        instance, reference = coupled.instances[link.target], [link.input.reference]
        old = instance.get(reference)
        before = coupled.read(outs)
        instance.set(reference, old + PROBE * (1.0 + np.abs(old)))
        after = coupled.read(outs)
        instance.set(reference, old)
        found += [(a, b) for b, moved in zip(outs, after != before, strict=True) if moved]
    return found
