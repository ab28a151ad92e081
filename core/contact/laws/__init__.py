"""Contact laws. A new one is a file with its parameters and formula, and its name in LAWS."""

from typing import Annotated

from pydantic import Field

from .base import LAW_SIGNATURE, ForceLaw, call_law, law_address
from .hertz import Hertz
from .hunt_crossley import Flores, Gonthier, HuntCrossley, LankaraniNikravesh
from .kelvin_voigt import KelvinVoigt
from .restitution import ImpactLaw, NewtonImpact, PoissonImpact

LAWS = (NewtonImpact, PoissonImpact, Hertz, KelvinVoigt, HuntCrossley, LankaraniNikravesh, Flores, Gonthier)

ContactLaw = Annotated[
    NewtonImpact | PoissonImpact | Hertz | KelvinVoigt | HuntCrossley | LankaraniNikravesh | Flores | Gonthier,
    Field(discriminator="type"),
]

__all__ = [
    "LAWS",
    "LAW_SIGNATURE",
    "ContactLaw",
    "Flores",
    "ForceLaw",
    "Gonthier",
    "Hertz",
    "HuntCrossley",
    "ImpactLaw",
    "KelvinVoigt",
    "LankaraniNikravesh",
    "NewtonImpact",
    "PoissonImpact",
    "call_law",
    "law_address",
]
