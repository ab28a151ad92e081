"""Drives, one-sided joints, springs of joints as parts of a scene: what has a length is a link, what turns a mark."""

import math
from typing import Any

import numpy as np

from ..core.model.markers import Marker2D
from .bodies import Stage
from .drawing import symbols
from .drawing.shapes import INK, TOUCH, Circle, Drawing, Path, turned
from .fixtures import SPOKES, _on_marker, _reach, stretched, symbol

REACH = 0.14
"""Length of the marks of an end stop, in parts of the scene's size."""
TURNS, SPIRAL = 2.5, 0.035
"""Of the spiral of a torsion spring, and its outer radius in parts of the scene's size."""


@symbol("actuator")
def _actuator(element: Any, stage: Stage) -> None:
    """A cylinder between its ends; a ring about the joint that it turns."""
    if element.measure == "distance":
        stretched(stage, element.name, "damper", element.a, element.b)
    elif element.measure == "angle":
        drawing = Drawing(stage.size)
        drawing.shapes.append(Circle((0.0, 0.0), 0.03 * stage.size, symbols.SPRING, None, 0.7))
        _on_marker(stage, element.b, 2, drawing)


@symbol("rope")
def _rope(element: Any, stage: Stage) -> None:
    stretched(stage, element.name, "rod", element.a, element.b)


@symbol("coil")
def _coil(element: Any, stage: Stage) -> None:
    angles = np.linspace(0.0, 2.0 * math.pi * TURNS, 60)
    radii = SPIRAL * stage.size * (0.25 + 0.75 * angles / angles[-1])
    points = tuple((float(r * math.cos(a)), float(r * math.sin(a))) for r, a in zip(radii, angles, strict=True))
    drawing = Drawing(stage.size)
    drawing.shapes.append(Path(points, symbols.SPRING, width=0.5))
    _on_marker(stage, element.b, 2, drawing)


@symbol("angle-stop")
def _angle_stop(element: Any, stage: Stage) -> None:
    """Where the first axis of b comes to rest, with a hand for that axis."""
    drawing, far = Drawing(stage.size), REACH * stage.size
    end, back = turned((far, 0.0), element.limit), turned((0.2 * far, 0.0), element.limit)
    side = 1.0 if element.side == "upper" else -1.0
    symbols.wall(drawing, *((end, back) if side > 0.0 else (back, end)), TOUCH)
    _on_marker(stage, element.a, 1, drawing)
    hand = Drawing(stage.size)
    hand.shapes.append(Path(((0.0, 0.0), (far, 0.0)), TOUCH, width=0.4, dashed=True))
    _on_marker(stage, element.b, 1, hand)


@symbol("rack")
def _rack(element: Any, stage: Stage) -> None:
    """The wheel with spokes, and the line that it rolls on as far as it comes."""
    _wheel(stage, element.a, element.radius)
    near, far = _reach(stage, element.b, stage.motion.at(element.a), 0.1)
    drawing = Drawing(stage.size)
    drawing.shapes.append(Path(((near, 0.0), (far, 0.0)), INK, width=0.6))
    _on_marker(stage, element.b, 1, drawing)


@symbol("belts")
def _belts(element: Any, stage: Stage) -> None:
    _wheel(stage, element.a, element.radius_a)
    _wheel(stage, element.b, element.radius_b)
    (ax, ay), (bx, by) = stage.motion.places.at(element.a), stage.motion.places.at(element.b)
    angle = math.atan2(by - ay, bx - ax)
    # straight parts, from rim to rim; they are those of the start, in the frame of the first pulley's place
    for side in (1.0, -1.0):
        other = -side if element.crossed else side
        start = turned((0.0, side * abs(element.radius_a)), angle)
        end = turned((0.0, other * abs(element.radius_b)), angle)
        drawing = Drawing(stage.size)
        drawing.shapes.append(Path(((ax + start[0], ay + start[1]), (bx + end[0], by + end[1])), INK, width=0.5))
        _on_marker(stage, Marker2D(), 1, drawing)


def _wheel(stage: Stage, marker: Marker2D, radius: float) -> None:
    drawing, r = Drawing(stage.size), abs(radius)
    drawing.shapes.append(Circle((0.0, 0.0), r, INK, None, 0.4))
    for k in range(SPOKES):
        drawing.shapes.append(Path(((0.0, 0.0), turned((r, 0.0), 2.0 * math.pi * k / SPOKES)), INK, width=0.3))
    _on_marker(stage, marker, 0, drawing)
