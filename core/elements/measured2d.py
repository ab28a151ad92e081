"""What acts on a measure of two bodies with a time function or an input: an angle, a way, a distance of two markers.

The kernel is made of the measure's formula. Elements differ in what it does with that, in their signal and numbers.
"""

from collections.abc import Callable
from typing import Any

from .base import Form, PairElement2D
from .formula2d import Arguments, derivatives, form_ahead
from .measures2d import MEASURES, Measure


class MeasuredElement2D(PairElement2D):
    """Base of elements between markers `a` and `b` that act on a `measure` of them."""

    measure: Measure = "angle"
    """What it moves: the angle of a joint, the slide along a's first axis, or the distance of the markers."""

    def arguments(self) -> Arguments:
        """What its formula takes."""
        return Arguments.of(self, ("a", "b"))

    def form_of(
        self, kind: str, kernel: Callable[[str, Arguments], Any], rows: int = 0, by_rates: bool = False
    ) -> Form:
        """Its form: from the library under the name `kind`, else with `kernel` of measure and arguments.

        `rows` is the number of constraints. The tangent has the second derivatives of the measure, and with `by_rates`,
        where the force changes with the measure and its rate, products of its gradient with that of the rate.
        """
        formula, arguments = MEASURES[self.measure], self.arguments()
        ahead = form_ahead(kind, (formula,), arguments)
        if ahead is not None:
            return ahead
        found = derivatives(formula, arguments)
        pattern = {*found.second, *((j, i) for i, j in found.second)}
        if by_rates:
            bent = {k for pair in found.second for k in pair}
            pattern |= {(i, j) for i in found.first for j in {*found.first, *bent}}
        jacobian = tuple((row, j) for row in range(rows) for j in found.first)
        return Form(kernel(self.measure, arguments), rows, tuple(sorted(pattern)), jacobian)
