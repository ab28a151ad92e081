"""Friction laws. A new one is a file with its parameters and formula, and its name in FRICTION_LAWS.

LuGre friction has a state and therefore a signature and kernels of its own: `lugre.py`, `shapes/bristle2d.py`.
"""

from typing import Annotated

from ...model.open_union import OpenUnion
from .ambrosio import AmbrosioFriction
from .base import FRICTION_SIGNATURE, FrictionLaw, call_friction, friction_address
from .brown_mcphee import BrownMcPheeFriction
from .coulomb import CoulombFriction
from .lugre import LuGreFriction
from .step import StepFriction
from .tanh import TanhFriction
from .threlfall import ThrelfallFriction
from .turning import TurningFriction

FRICTION_LAWS = (
    CoulombFriction,
    TanhFriction,
    ThrelfallFriction,
    AmbrosioFriction,
    StepFriction,
    BrownMcPheeFriction,
    LuGreFriction,
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
