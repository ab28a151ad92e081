"""Contact laws. A new one is a file with its parameters and formula, and its name in FORCE_LAWS.

A user's own law needs neither: a subclass of ForceLaw can stand in a contact as it is.
"""

from typing import TYPE_CHECKING, Annotated

from ..lazy_import import LateClasses, late_names
from ..model.open_union import OpenUnion
from .base import LAW_SIGNATURE, ForceLaw, call_law, law_address
from .restitution import ImpactLaw, NewtonImpact, PoissonImpact

if TYPE_CHECKING:
    from .hertz import Hertz
    from .hunt_crossley import (
        CarvalhoMartins,
        Flores,
        Gonthier,
        HerbertMcWhannell,
        HuGuo,
        HuntCrossley,
        LankaraniNikravesh,
        LeeWang,
        ZhiyingQishao,
    )
    from .kelvin_voigt import KelvinVoigt
    from .own import force_formula
    from .viscoelastic import KuwabaraKono, Tsuji

FORCE_LAWS = LateClasses(
    __name__,
    "Hertz KelvinVoigt Tsuji KuwabaraKono HuntCrossley HerbertMcWhannell LeeWang LankaraniNikravesh Gonthier "
    "ZhiyingQishao Flores HuGuo CarvalhoMartins",
)
LAWS = LateClasses(__name__, f"NewtonImpact PoissonImpact {' '.join(FORCE_LAWS)}")

ContactLaw = Annotated[ImpactLaw | ForceLaw, OpenUnion(LAWS, ForceLaw)]

__all__ = [
    "FORCE_LAWS",
    "LAWS",
    "LAW_SIGNATURE",
    "CarvalhoMartins",
    "ContactLaw",
    "Flores",
    "ForceLaw",
    "Gonthier",
    "HerbertMcWhannell",
    "Hertz",
    "HuGuo",
    "HuntCrossley",
    "ImpactLaw",
    "KelvinVoigt",
    "KuwabaraKono",
    "LankaraniNikravesh",
    "LeeWang",
    "NewtonImpact",
    "PoissonImpact",
    "Tsuji",
    "ZhiyingQishao",
    "call_law",
    "force_formula",
    "law_address",
]

__getattr__, __dir__, _ = late_names(__name__)
