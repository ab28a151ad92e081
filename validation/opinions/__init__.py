"""Third opinions on the scenarios of the catalogue."""

from . import (
    arm,
    blows,
    cranks,
    rocking,
    rods,
    rolling,
    smooth,
    space_cradle,
    space_cranks,
    spheres,
    stick_slip,
    tops,
    woodpecker,
)

__all__ = [
    "arm",
    "blows",
    "cranks",
    "rocking",
    "rods",
    "rolling",
    "smooth",
    "space_cradle",
    "space_cranks",
    "spheres",
    "stick_slip",
    "tops",
    "woodpecker",
]
