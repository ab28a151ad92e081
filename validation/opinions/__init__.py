"""Third opinions on the scenarios of the catalogue."""

from . import blows, cranks, rocking, rods, smooth, stick_slip, woodpecker

__all__ = ["blows", "cranks", "rocking", "rods", "smooth", "stick_slip", "woodpecker"]
