"""Joints in space as parts of a scene."""

from ..core.elements import Joint3D
from ..core.model.markers import GROUND
from .bodies import Stage
from .drawing import symbols
from .drawing.shapes import Drawing
from .fixtures import place


@place.register
def _(element: Joint3D, stage: Stage) -> None:
    """A pin on the first body, and a bearing where the joint is on the ground."""
    drawing, at = Drawing(stage.size), stage.motion.places.at(element.a)
    symbols.pin(drawing, at)
    if GROUND in (element.a.body, element.b.body):
        symbols.bearing(drawing, at)
    if element.a.body == GROUND:
        stage.add_part(GROUND, 0, drawing)
