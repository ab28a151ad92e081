"""Friction laws. A new one is a file with its parameters and formula, and its name in FRICTION_LAWS.

LuGre friction has a state and therefore a signature and kernels of its own: `lugre.py`, `contacts/bristle2d.py`.
"""

from typing import TYPE_CHECKING, Annotated

from ...lazy_import import LateClasses, late_names
from ...model.open_union import OpenUnion
from .base import FRICTION_SIGNATURE, FrictionLaw, call_friction, friction_address
from .coulomb import CoulombFriction
from .lugre import LuGreFriction

if TYPE_CHECKING:
    from .ambrosio import AmbrosioFriction
    from .brown_mcphee import BrownMcPheeFriction
    from .step import StepFriction
    from .tanh import TanhFriction
    from .threlfall import ThrelfallFriction
    from .turning import TurningFriction

FRICTION_LAWS = LateClasses(
    __name__,
    "Coulomb=CoulombFriction Tanh=TanhFriction Threlfall=ThrelfallFriction Ambrosio=AmbrosioFriction "
    "Step=StepFriction BrownMcPhee=BrownMcPheeFriction LuGre=LuGreFriction",
)

Friction = Annotated[CoulombFriction | LuGreFriction | FrictionLaw, OpenUnion(FRICTION_LAWS, FrictionLaw)]

__all__ = [
    "FRICTION_LAWS",
    "FRICTION_SIGNATURE",
    "AmbrosioFriction",
    "BrownMcPheeFriction",
    "CoulombFriction",
    "Friction",
    "FrictionLaw",
    "LuGreFriction",
    "StepFriction",
    "TanhFriction",
    "ThrelfallFriction",
    "TurningFriction",
    "call_friction",
    "friction_address",
]

__getattr__, __dir__, _ = late_names(__name__)
