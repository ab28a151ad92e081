"""Contact laws. A new one is a file with its parameters and formula, and its name in FORCE_LAWS.

A user's own law needs neither: a subclass of ForceLaw can stand in a contact as it is.
"""

from typing import Annotated

from ...model.open_union import OpenUnion
from .base import LAW_SIGNATURE, ForceLaw, call_law, law_address
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
<<<<<<< HEAD
from .restitution import ImpactLaw, NewtonImpact, PoissonImpact

LAWS = (NewtonImpact, PoissonImpact, Hertz, KelvinVoigt, HuntCrossley, LankaraniNikravesh, Flores, Gonthier)

ContactLaw = Annotated[
    NewtonImpact | PoissonImpact | Hertz | KelvinVoigt | HuntCrossley | LankaraniNikravesh | Flores | Gonthier,
    Field(discriminator="type"),
]
=======
from .own import force_formula
from .restitution import NewtonImpact
from .viscoelastic import KuwabaraKono, Tsuji

FORCE_LAWS = (
    Hertz,
    KelvinVoigt,
    Tsuji,
    KuwabaraKono,
    HuntCrossley,
    HerbertMcWhannell,
    LeeWang,
    LankaraniNikravesh,
    Gonthier,
    ZhiyingQishao,
    Flores,
    HuGuo,
    CarvalhoMartins,
)
LAWS = (NewtonImpact, *FORCE_LAWS)

ContactLaw = Annotated[NewtonImpact | ForceLaw, OpenUnion(LAWS, ForceLaw)]
>>>>>>> laws

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
<<<<<<< HEAD
    "PoissonImpact",
=======
    "Tsuji",
    "ZhiyingQishao",
>>>>>>> laws
    "call_law",
    "force_formula",
    "law_address",
]
