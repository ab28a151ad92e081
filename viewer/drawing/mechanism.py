"""A drawing of a model at its start."""

import math

import numpy as np

from ...core.elements import MovingFrame2D, SpatialFrame
from ...core.model.base import in_space
from ...core.multibody_model import Model
from . import symbols
from .bodies import draw_bodies
from .interactions import draw_interaction
from .places import Places
from .shapes import GROUND, Drawing, Label, Path, between
from .view import View


def draw(model: Model) -> Drawing:
    """The mechanism of `model` as it starts: bodies, joints, springs, loads, contacts, with the bodies' names."""
    places = Places(model)
    drawing = Drawing(places.size)
    for contact in model.contacts:
        draw_interaction(contact, drawing, places)
    under, drawing.shapes = drawing.shapes, []
    draw_bodies(drawing, places)
    bodies, drawing.shapes = drawing.shapes, []
    frames = [body for body in model.bodies if isinstance(body, MovingFrame2D)]
    for element in (*frames, *model.forces, *model.joints):
        draw_interaction(element, drawing, places)
    walls = [s for s in under if isinstance(s, Path)]
    drawing.shapes = [*walls, *bodies, *drawing.shapes, *(s for s in under if not isinstance(s, Path))]
    return drawing


def add_surroundings(drawing: Drawing, model: Model) -> None:
    """Gravity and a scale, beside the mechanism."""
    (x0, y0), (x1, y1) = drawing.box()
    spatial = any(isinstance(body, SpatialFrame) for body in model.bodies)
    x, y, z = in_space(model.gravity)
    gravity = View(model).point(np.array([x, y, z])) if spatial else (x, y)
    if any(gravity):
        direction, _ = between((0.0, 0.0), gravity)
        tip = x1 + 0.08 * drawing.size, 0.5 * (y0 + y1)
        start = symbols.arrow(drawing, tip, direction, GROUND, 0.1 * drawing.size)
        side = "above" if abs(direction[1]) > abs(direction[0]) else "left"
        drawing.shapes.append(Label(start, "g", GROUND, side))
    length = round_length(0.25 * drawing.size)
    y = y0 - 0.03 * drawing.size
    ends = (x0, y), (x0 + length, y)
    tick = 0.012 * drawing.size
    drawing.shapes.append(Path(ends, GROUND, width=0.35))
    drawing.shapes += [Path(((x, y - tick), (x, y + tick)), GROUND, width=0.35) for x, _ in ends]
    drawing.shapes.append(Label(ends[1], f"{length:g} m", GROUND))


def round_length(length: float) -> float:
    """The largest of 1, 2, 5 times a power of ten that is not above `length`."""
    power = 10.0 ** math.floor(math.log10(length))
    return next(n for n in (5.0, 2.0, 1.0) if n * power <= length * (1.0 + 1e-9)) * power
