"""Friction laws. A new one is a file with its parameters and formula, and its name in FRICTION_LAWS."""

from typing import Annotated

from pydantic import Field

from .base import FRICTION_SIGNATURE, FrictionLaw, call_friction, friction_address
from .coulomb import CoulombFriction
from .tanh import TanhFriction

FRICTION_LAWS = (CoulombFriction, TanhFriction)

Friction = Annotated[CoulombFriction | TanhFriction, Field(discriminator="type")]

__all__ = [
    "FRICTION_LAWS",
    "FRICTION_SIGNATURE",
    "CoulombFriction",
    "Friction",
    "FrictionLaw",
    "TanhFriction",
    "call_friction",
    "friction_address",
]
