"""A model's mechanism at its start as a drawing: for the documentation inside an FMU, and its icon."""

from .mechanism import add_surroundings, draw
from .png import to_png
from .svg import to_svg

__all__ = ["add_surroundings", "draw", "to_png", "to_svg"]
