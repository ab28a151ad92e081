"""What acts on a measure of two bodies with a time function or an input: an angle, a way, a distance of two markers.

The kernel is made of the measure's formula. Elements differ in what it does with that, in their signal and numbers.
"""

from collections.abc import Callable
from typing import Any, ClassVar

from .base import Form, PairElement2D
from .formula2d import Arguments, FormKey, derivatives, form_ahead
from .measures2d import MEASURES, Measure


class MeasuredElement2D(PairElement2D):
    """Base of elements between markers `a` and `b` that act on a `measure` of them."""

    form_kind: ClassVar[str]
    """Of its kernel in the library."""

    measure: Measure = "angle"
    """What it moves: the angle of a joint, the slide along a's first axis, or the distance of the markers."""

    def arguments(self) -> Arguments:
        """What its formula takes."""
        return Arguments.of(self, ("a", "b"))

    def form_key(self) -> FormKey:
        """Kind and formulas of its kernel, by which the library of machine code has it."""
        return self.form_kind, (MEASURES[self.measure],)

    def form_of(self, kernel: Callable[[str, Arguments], Any], rows: int = 0, by_rates: bool = False) -> Form:
        """Its form: from the library, else with `kernel` of measure and arguments.

        `rows` is the number of constraints. The tangent has the second derivatives of the measure, and with `by_rates`,
        where the force changes with the measure and its rate, products of its gradient with that of the rate.
        """
        formula, arguments = MEASURES[self.measure], self.arguments()
        ahead = form_ahead(*self.form_key(), arguments)
        if ahead is not None:
            return ahead
        found = derivatives(formula, arguments)
        pattern = {*found.second, *((j, i) for i, j in found.second)}
        if by_rates:
            bent = {k for pair in found.second for k in pair}
            pattern |= {(i, j) for i in found.first for j in {*found.first, *bent}}
        jacobian = tuple((row, j) for row in range(rows) for j in found.first)
        return Form(kernel(self.measure, arguments), rows, tuple(sorted(pattern)), jacobian)
