"""What a continuous contact force law is: parameters and one compiled formula.

A law is a numba function of LAW_SIGNATURE: (delta, delta_dot, v0, p0, p1, p2, p3) -> (F, dF/d delta,
dF/d delta_dot, elastic part of F, elastic energy). delta > 0 is the penetration in m, delta_dot its rate, v0 the
approach speed at first contact in m/s; F > 0 pushes the bodies apart, N.
"""

from typing import Any, ClassVar

from numba import types

from ...compiled.jit import address_of, caller
from ...model.base import Record

LAW_RESULT = types.UniTuple(types.float64, 5)
LAW_SIGNATURE = LAW_RESULT(*([types.float64] * 7))


class ForceLaw(Record):
    """Base of the continuous contact force laws (CCFM).

    Class attributes: `formula` (numba function of LAW_SIGNATURE); `release` says when contact ends: "gap" (at
    zero penetration) or "force" (when the force would become tensile).
    """

    formula: ClassVar[Any]
    release: ClassVar[str] = "gap"

    minimum_approach_speed: float = 1e-6
    """m/s; a contact that closes more slowly than this is given this approach speed (laws divide by it)."""

    def parameters(self) -> tuple[float, float, float, float]:
        """The four numbers that the formula is called with."""
        raise NotImplementedError(f"{type(self).__name__} must name its formula's parameters")

    def evaluate(self, penetration: float, rate: float, approach_speed: float) -> tuple[float, ...]:
        """(F, dF/d delta, dF/d delta_dot, elastic part, elastic energy) from Python."""
        result = type(self).formula(penetration, rate, approach_speed, *self.parameters())
        return tuple(float(x) for x in result)

    def elastic_energy(self, penetration: float) -> float:
        """Energy that the law's spring holds at a penetration (m), J."""
        return self.evaluate(penetration, 0.0, 1.0)[4]


call_law = caller(LAW_SIGNATURE)
"""call_law(address, delta, delta_dot, v0, p0, p1, p2, p3)."""


def law_address(law: ForceLaw) -> int:
    """Machine address of a law's formula."""
    return address_of(type(law).formula, LAW_SIGNATURE)
