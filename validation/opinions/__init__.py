"""Third opinions on the scenarios of the catalogue."""

from . import blows, cranks, rods, smooth, stick_slip

__all__ = ["blows", "cranks", "rods", "smooth", "stick_slip"]
