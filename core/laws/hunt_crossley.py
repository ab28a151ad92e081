"""The Hunt-Crossley family: F = K delta^n (1 + D delta'/v0); the laws differ in D(e) alone.

Each D approximates the root of the relation below for a requested e; how far what comes out (e_out) is from it stands
in docs/contact-laws.md. Sources: da Silva et al. 2022 (Mech. Mach. Theory) compare them all.

The rebound speed of a free blow depends on D alone: (1 + D)/(1 - D e_out) = exp(D (1 + e_out)); contact ends at
delta = 0 with F = 0 and F is not tensile, since D e_out < 1. Shapes that others draw apart faster than v0/D would be
held back by the formula: contact ends there, unless the release rule says otherwise.

v0 is the speed of a blow; 1/v0 has no limit for shapes that are laid on each other. Hunt and Crossley's own damping
constant 3 (1 - e)/(2 v0) belongs to the material (e = 1 - alpha v0) and stays finite. Laws for a given e need a speed:
it is that of the blow which goes as deep as the shapes overlap, m v^2/2 = K delta^(n + 1)/(n + 1), once that is larger
than v0. Then F = K delta^n + D sqrt((n + 1) m K/2) delta^((n - 1)/2) delta', for spheres Tsuji's form (1992).
"""

import math
from typing import Annotated, Any, ClassVar, Literal

from pydantic import Field

from ..compiled.jit import compiled
from ..model.base import Positive, Restitution
from .base import ForceLaw, LawParameters, Release


@compiled
def hunt_crossley_formula(d: float, dd: float, v0: float, k: float, n: float, factor: float, p3: float) -> Any:
    elastic = k * d**n
    damped = 1.0 + factor * dd / v0
    return (
        elastic * damped,
        n * k * d ** (n - 1.0) * damped,
        elastic * factor / v0,
        elastic,
        elastic * d / (n + 1.0),
    )


class HuntCrossleyFamily(ForceLaw):
    """Base of the laws F = K delta^n (1 + D delta'/v0). A new one is its type and its `damping_factor`."""

    formula: ClassVar[Any] = hunt_crossley_formula
    damps_by_approach: ClassVar[bool] = True
    shared_fields: ClassVar[tuple[str, ...]] = (*ForceLaw.shared_fields, "release_rule")
    stiffness: Positive
    """K, N/m^n."""
    restitution: Restitution
    """Requested coefficient of restitution e, dimensionless; what comes out differs from law to law."""
    exponent: Positive = 1.5
    """n, dimensionless."""
    release_rule: Release = "force"
    """What shapes do that are drawn apart faster than v0/D, where the formula is tensile: "force": contact ends, so it
    never pulls; "gap": the formula holds as published, and pulls until they come apart."""

    @property
    def never_pulls(self) -> bool:
        return self.release_rule == "force"

    def damping_factor(self) -> float:
        """D(e), dimensionless."""
        raise NotImplementedError(f"{type(self).__name__} must define its damping factor")

    def parameters(self) -> LawParameters:
        return self.stiffness, self.exponent, self.damping_factor(), 0.0


class HuntCrossley(HuntCrossleyFamily):
    """Hunt and Crossley (1975): D = 3 (1 - e) / 2."""

    type: Literal["HuntCrossley"] = "HuntCrossley"

    def damping_factor(self) -> float:
        return 1.5 * (1.0 - self.restitution)


class HerbertMcWhannell(HuntCrossleyFamily):
    """Herbert and McWhannell (1977): D = 6 (1 - e)/((2 e - 1)^2 + 3)."""

    type: Literal["HerbertMcWhannell"] = "HerbertMcWhannell"

    def damping_factor(self) -> float:
        e = self.restitution
        return 6.0 * (1.0 - e) / ((2.0 * e - 1.0) ** 2 + 3.0)


class LeeWang(HuntCrossleyFamily):
    """Lee and Wang (1983): D = 3 (1 - e) / 4, half of Hunt and Crossley's."""

    type: Literal["LeeWang"] = "LeeWang"

    def damping_factor(self) -> float:
        return 0.75 * (1.0 - self.restitution)


class LankaraniNikravesh(HuntCrossleyFamily):
    """Lankarani and Nikravesh (1990): D = 3 (1 - e^2) / 4."""

    type: Literal["LankaraniNikravesh"] = "LankaraniNikravesh"

    def damping_factor(self) -> float:
        return 0.75 * (1.0 - self.restitution**2)


class ZhiyingQishao(HuntCrossleyFamily):
    """Zhang Zhiying and Lu Qishao (2006): D = 3 (1 - e^2) exp(2 (1 - e)) / 4."""

    type: Literal["ZhiyingQishao"] = "ZhiyingQishao"

    def damping_factor(self) -> float:
        e = self.restitution
        return 0.75 * (1.0 - e * e) * math.exp(2.0 * (1.0 - e))


class DissipativeFamily(HuntCrossleyFamily):
    """Base of the laws whose D grows without bound as e goes to 0: they cover the whole range but e = 0."""

    restitution: Annotated[float, Field(gt=0.0, le=1.0)]
    """Requested coefficient of restitution e > 0, dimensionless; what comes out differs from law to law."""


class Flores(DissipativeFamily):
    """Flores et al. (2011): D = 8 (1 - e) / (5 e)."""

    type: Literal["Flores"] = "Flores"

    def damping_factor(self) -> float:
        return 1.6 * (1.0 - self.restitution) / self.restitution


class HuGuo(DissipativeFamily):
    """Hu and Guo (2015): D = 3 (1 - e) / (2 e)."""

    type: Literal["HuGuo"] = "HuGuo"

    def damping_factor(self) -> float:
        return 1.5 * (1.0 - self.restitution) / self.restitution


class CarvalhoMartins(DissipativeFamily):
    """Carvalho and Martins (2019): D = 3 (1 - e)(11 - e)/(2 (1 + 9 e)) for e > 1/3, Gonthier's (1 - e^2)/e below.

    The two meet at e = 1/3. This is impact model 2 of exudyn.
    """

    type: Literal["CarvalhoMartins"] = "CarvalhoMartins"

    def damping_factor(self) -> float:
        e = self.restitution
        if e > 1.0 / 3.0:
            return 1.5 * (1.0 - e) * (11.0 - e) / (1.0 + 9.0 * e)
        return (1.0 - e * e) / e


def exact_damping_factor(e: float) -> float:
    """D for which the rebound speed is e v0: root of (1 + D)/(1 - D e) = exp(D (1 + e)), 0 < e <= 1."""
    if e == 1.0:
        return 0.0
    # importing scipy costs more than most runs: only who needs a root pays
    from scipy.optimize import brentq

    def equation(d: float) -> float:
        return math.log1p(d) - math.log1p(-d * e) - d * (1.0 + e)

    return float(brentq(equation, 1e-3 * (1.0 - e), (1.0 - 1e-14) / e, xtol=1e-15, rtol=1e-15))


class Gonthier(DissipativeFamily):
    """Gonthier et al. (2004): D = (1 - e^2)/e, or the root that this approximates (Zhang and Sharf 2009).

    With the exact root, which is the default, the requested restitution is what comes out.
    """

    type: Literal["Gonthier"] = "Gonthier"
    variant: Literal["exact", "approximate"] = "exact"
    """D: "exact" root of the relation, or "approximate" closed form."""

    def damping_factor(self) -> float:
        if self.variant == "approximate":
            return (1.0 - self.restitution**2) / self.restitution
        return exact_damping_factor(self.restitution)
