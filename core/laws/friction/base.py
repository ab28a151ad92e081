"""What a regularised friction law is: parameters and one compiled formula.

A law is a numba function of FRICTION_SIGNATURE: (v_t, F_n, p0, p1, p2, p3, p4) -> (F_t, dF_t/dv_t, dF_t/dF_n).
v_t is the tangential speed in m/s, of either sign; F_n >= 0 the normal force in N (a caller whose normal force can
pull passes zero while it does); F_t in N acts against v_t: F_t = -mu(|v_t|) F_n sgn v_t. The speed enters as it is,
so F_t is odd in v_t and F_t v_t <= 0.
"""

from typing import Annotated, ClassVar

from pydantic import Field

from ...compiled import types
from ...compiled.jit import caller
from ..formula import FormulaRecord, formula_address

FRICTION_RESULT = types.UniTuple(types.float64, 3)
FRICTION_SIGNATURE = FRICTION_RESULT(*([types.float64] * 7))

FrictionParameters = tuple[float, float, float, float, float]

FrictionCoefficient = Annotated[float, Field(ge=0.0)]
"""mu, dimensionless."""


class FrictionLaw(FormulaRecord):
    """Base of the regularised friction laws, for contacts that act as forces (CCFM); a user's own too.

    A subclass says its parameters as fields and its `formula`, a numba function of FRICTION_SIGNATURE.
    """

    parameter_count: ClassVar[int] = 5

    def evaluate(self, speed: float, normal_force: float) -> tuple[float, float, float]:
        """(F_t, dF_t/dv_t, dF_t/dF_n) from Python: N, N s/m, dimensionless."""
        f, by_speed, by_normal = type(self).formula(float(speed), float(normal_force), *self.formula_parameters())
        return float(f), float(by_speed), float(by_normal)


call_friction = caller(FRICTION_SIGNATURE)
"""call_friction(address, v_t, F_n, p0, p1, p2, p3, p4)."""


def friction_address(law: FrictionLaw) -> int:
    """Machine address of a friction law's formula."""
    return formula_address(law, FRICTION_SIGNATURE)
