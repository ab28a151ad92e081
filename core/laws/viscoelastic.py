"""Spheres with viscous loss that does not refer to the approach speed: Tsuji, Kuwabara-Kono.

Their damping outlasts their spring at the end of contact: the force is tensile there, unless contact is released.
"""

import math
from typing import Annotated, Any, ClassVar, Literal, Self

from pydantic import Field, model_validator

from ..compiled.jit import compiled
from ..model.base import NonNegative, Positive
from .base import LawParameters, ReleasedLaw
from .damping_ratio import damping_ratio_without_pull


@compiled
def tsuji_formula(d: float, dd: float, v0: float, k: float, c: float, p2: float, p3: float) -> Any:
    root = math.sqrt(d)
    quarter = math.sqrt(root)
    elastic = k * d * root
    # the slope of d^(1/4) is infinite at first touch, where the force is zero all the same
    slope = 0.25 * c * quarter / d * dd if d > 0.0 else 0.0
    return elastic + c * quarter * dd, 1.5 * k * root + slope, c * quarter, elastic, 0.4 * elastic * d


class Tsuji(ReleasedLaw):
    """F = K delta^(3/2) + c delta^(1/4) delta' (Tsuji, Tanaka and Ishida 1992).

    c is given as `damping`, or follows from `mass` and `restitution`: c = zeta sqrt(5 m K), with the zeta for which e
    comes out by the release rule, whatever the speed (Antypov and Elliott 2011): -ln e/sqrt(pi^2 + ln^2 e), as
    published, for "gap", the root of `restitution_without_pull` for "force".

    Raises
    ------
    ModelError : unless there is either a damping, or both a mass and a restitution.
    """

    type: Literal["Tsuji"] = "Tsuji"
    formula: ClassVar[Any] = tsuji_formula
    stiffness: Positive
    """K, N/m^(3/2)."""
    damping: NonNegative | None = None
    """c, N s/m^(5/4)."""
    mass: Positive | None = None
    """Effective mass of the two bodies m1 m2/(m1 + m2), kg."""
    restitution: Annotated[float, Field(gt=0.0, le=1.0)] | None = None
    """Requested coefficient of restitution e, dimensionless."""

    @model_validator(mode="after")
    def _one_way_to_say_it(self) -> Self:
        from_mass = self.mass is not None and self.restitution is not None
        neither = self.mass is None and self.restitution is None
        if not (from_mass if self.damping is None else neither):
            raise ValueError(
                "give either damping, or both mass and restitution "
                f"(given: damping {self.damping}, mass {self.mass}, restitution {self.restitution})"
            )
        return self

    def damping_constant(self) -> float:
        """c, N s/m^(5/4)."""
        if self.mass is None or self.restitution is None:
            return self.damping or 0.0
        loss = -math.log(self.restitution)
        gap = self.release_rule == "gap"
        ratio = loss / math.hypot(math.pi, loss) if gap else damping_ratio_without_pull(self.restitution)
        return math.sqrt(5.0 * self.mass * self.stiffness) * ratio

    def parameters(self) -> LawParameters:
        return self.stiffness, self.damping_constant(), 0.0, 0.0


@compiled
def kuwabara_kono_formula(d: float, dd: float, v0: float, k: float, c: float, p2: float, p3: float) -> Any:
    root = math.sqrt(d)
    elastic = k * d * root
    slope = 0.5 * c / root * dd if d > 0.0 else 0.0
    return elastic + c * root * dd, 1.5 * k * root + slope, c * root, elastic, 0.4 * elastic * d


class KuwabaraKono(ReleasedLaw):
    """F = K (delta^(3/2) + 3/2 A sqrt(delta) delta') (Kuwabara and Kono 1987; Brilliantov et al. 1996).

    Viscoelastic spheres: restitution falls with the speed, 1 - e ~ v0^(1/5) for small loss.
    """

    type: Literal["KuwabaraKono"] = "KuwabaraKono"
    formula: ClassVar[Any] = kuwabara_kono_formula
    stiffness: Positive
    """K, N/m^(3/2)."""
    relaxation_time: NonNegative
    """A, s."""

    def parameters(self) -> LawParameters:
        return self.stiffness, 1.5 * self.relaxation_time * self.stiffness, 0.0, 0.0
