"""What a continuous contact force law is: parameters and one compiled formula.

A law is a numba function of LAW_SIGNATURE: (delta, delta_dot, v0, p0, p1, p2, p3) -> (F, dF/d delta,
dF/d delta_dot, elastic part of F, elastic energy). delta >= 0 is the penetration in m, delta_dot its rate, v0 the
approach speed at first contact in m/s; F > 0 pushes the bodies apart, N.
"""

from typing import ClassVar, Literal

from ..compiled import types
from ..compiled.jit import caller
from ..rounding import LEAST_APPROACH
from .formula import FormulaRecord, formula_address

LAW_RESULT = types.UniTuple(types.float64, 5)
LAW_SIGNATURE = LAW_RESULT(*([types.float64] * 7))

Release = Literal["force", "gap"]
LawParameters = tuple[float, float, float, float]


class ForceLaw(FormulaRecord):
    """Base of the continuous contact force laws (CCFM), a user's own too.

    A subclass says its parameters as fields and its `formula`, a numba function of LAW_SIGNATURE (or made by
    `force_formula` from the force alone); it can stand in any contact at once, without being registered.
    """

    parameter_count: ClassVar[int] = 4
    damps_by_approach: ClassVar[bool] = False
    """Whether the damping part of the force goes with 1/v0. Where shapes meet without an approach it is then that of
    the blow which goes as deep."""
    shared_fields: ClassVar[tuple[str, ...]] = ("minimum_approach_speed",)

    minimum_approach_speed: float | None = None
    """m/s; a contact that closes more slowly than this is given this approach speed (laws divide by it). Left out: a
    millionth of the model's speeds."""

    def least_approach_speed(self, speed: float = 1.0) -> float:
        """The `minimum_approach_speed` in a model whose speeds are of the size `speed`, m/s."""
        given = self.minimum_approach_speed
        return LEAST_APPROACH * speed if given is None else given

    @property
    def release(self) -> Release:
        """When contact ends: "gap" (at zero penetration) or "force" (when the force would become tensile)."""
        return "gap"

    @property
    def never_pulls(self) -> bool:
        """Whether the force is never tensile, however fast the shapes are drawn apart."""
        return self.release == "force"

    def evaluate(self, penetration: float, rate: float, approach_speed: float) -> tuple[float, ...]:
        """(F, dF/d delta, dF/d delta_dot, elastic part, elastic energy) from Python."""
        result = type(self).formula(float(penetration), float(rate), float(approach_speed), *self.formula_parameters())
        return tuple(float(x) for x in result)

    def elastic_energy(self, penetration: float) -> float:
        """Energy that the law's spring holds at a penetration (m), J."""
        return self.evaluate(penetration, 0.0, 1.0)[4]


class ReleasedLaw(ForceLaw):
    """Base of the laws whose force becomes tensile before the penetration is zero."""

    shared_fields: ClassVar[tuple[str, ...]] = (*ForceLaw.shared_fields, "release_rule")

    release_rule: Release = "force"
    """When contact ends: when the force would become tensile ("force", so that it never pulls), or at zero penetration
    ("gap"), the force pulling before."""

    @property
    def release(self) -> Release:
        return self.release_rule


call_law = caller(LAW_SIGNATURE)
"""call_law(address, delta, delta_dot, v0, p0, p1, p2, p3)."""


def law_address(law: ForceLaw) -> int:
    """Machine address of a law's formula."""
    return formula_address(law, LAW_SIGNATURE)
