"""Friction laws. A new one is a file with its parameters and formula, and its name in FRICTION_LAWS.

LuGre friction has a state and therefore a signature of its own: `lugre.py`; it is not in `Friction`.
"""

from typing import Annotated

from ...model.open_union import OpenUnion
from .ambrosio import AmbrosioFriction
from .base import FRICTION_SIGNATURE, FrictionLaw, call_friction, friction_address
from .brown_mcphee import BrownMcPheeFriction
from .coulomb import CoulombFriction
from .step import StepFriction
from .tanh import TanhFriction
from .threlfall import ThrelfallFriction

FRICTION_LAWS = (
    CoulombFriction,
    TanhFriction,
    ThrelfallFriction,
    AmbrosioFriction,
    StepFriction,
    BrownMcPheeFriction,
)

Friction = Annotated[CoulombFriction | FrictionLaw, OpenUnion(FRICTION_LAWS, FrictionLaw)]

__all__ = [
    "FRICTION_LAWS",
    "FRICTION_SIGNATURE",
    "AmbrosioFriction",
    "BrownMcPheeFriction",
    "CoulombFriction",
    "Friction",
    "FrictionLaw",
    "StepFriction",
    "TanhFriction",
    "ThrelfallFriction",
    "call_friction",
    "friction_address",
]
