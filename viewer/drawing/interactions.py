"""Joints, forces and contacts as shapes."""

import math
import re
from collections.abc import Callable, Sequence
from typing import Any

from ...core.contacts.contact2d import HalfPlane2D
from ...core.elements import (
    PlanarFrame,
)
from ...core.model.markers import GROUND, Marker3D
from ...core.model.signals import Constant, InputSignal
from ..registry import registering
from . import symbols
from .contact_shapes import laid, shapes_of, show
from .places import Places
from .shapes import GROUND as GROUND_COLOUR
from .shapes import INK, PORT, TOUCH, Circle, Drawing, Label, Path, Point, moved, turned

NEAR = 0.02
"""Markers nearer than this, in parts of the drawing's size, are one place."""
_PLACE = re.compile(r"([xy])\d*$")


Draw = Callable[[Any, Drawing, Places], None]
SYMBOLS: dict[str, Draw] = {}
"""What draws elements of the plane, by their `symbol`."""


symbol = registering(SYMBOLS)
"""Decorator: the function draws elements of the plane with this symbol."""


def draw_interaction(element: Any, drawing: Drawing, places: Places) -> None:
    """Draw a joint, force or contact; what has no symbol here stays out of the drawing."""
    known = IN_SPACE if any(isinstance(marker, Marker3D) for marker in element.markers()) else SYMBOLS
    draw = known.get(element.symbol)
    if draw is not None:
        draw(element, drawing, places)


# joints


@symbol("hinge")
def _hinge(element: Any, drawing: Drawing, places: Places) -> None:
    at = places.at(element.a)
    if GROUND in (element.a.body, element.b.body):
        symbols.bearing(drawing, at)
    symbols.pin(drawing, at)


def _joint_in_space(element: Any, drawing: Drawing, places: Places) -> None:
    a, b = places.at(element.a), places.at(element.b)
    if math.dist(a, b) > NEAR * drawing.size:
        drawing.behind.append(Path((a, b), INK, width=0.5))
    for marker, at in ((element.a, a), (element.b, b)):
        if marker.body == GROUND:
            symbols.bearing(drawing, at)
    symbols.pin(drawing, a)


@symbol("clamp")
def _clamp(element: Any, drawing: Drawing, places: Places) -> None:
    at, u = places.at(element.a), 0.05 * drawing.size
    if GROUND in (element.a.body, element.b.body):
        across = turned((0.0, u), places.direction(element.b if element.a.body == GROUND else element.a))
        ends = (at[0] + across[0], at[1] + across[1]), (at[0] - across[0], at[1] - across[1])
        symbols.wall(drawing, *ends)
    else:
        u *= 0.25
        corners = [(at[0] + sx * u, at[1] + sy * u) for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
        drawing.shapes.append(Path(corners, INK, INK, 0.3, closed=True))


@symbol("guide")
def _guide(element: Any, drawing: Drawing, places: Places) -> None:
    at, along = places.at(element.b), turned((1.0, 0.0), places.direction(element.a))
    reach = 0.16 * drawing.size
    drawing.behind.append(Path((moved(at, along, -reach), moved(at, along, reach)), GROUND_COLOUR, width=0.4))
    if element.a.body == GROUND:
        foot = moved(at, turned(along, -0.5 * math.pi), 0.036 * drawing.size)
        symbols.wall(drawing, moved(foot, along, -reach), moved(foot, along, reach))


@symbol("rod")
def _rod(element: Any, drawing: Drawing, places: Places) -> None:
    a, b = places.at(element.a), places.at(element.b)
    drawing.behind.append(Path((a, b), INK, width=0.5))
    for marker, at in ((element.a, a), (element.b, b)):
        if marker.body == GROUND:
            symbols.wall(
                drawing, moved(at, (1.0, 0.0), 0.03 * drawing.size), moved(at, (-1.0, 0.0), 0.03 * drawing.size)
            )
            symbols.pin(drawing, at)


@symbol("gears")
def _gears(element: Any, drawing: Drawing, places: Places) -> None:
    for marker, radius in ((element.a, element.radius_a), (element.b, element.radius_b)):
        drawing.behind.append(Circle(places.at(marker), abs(radius), INK, width=0.4))


@symbol("driver")
def _driver(element: Any, drawing: Drawing, places: Places) -> None:
    _coordinate(element.body, element.coordinate, _name(element.motion, element.name), drawing, places)


@symbol("frame")
def _frame(element: Any, drawing: Drawing, places: Places) -> None:
    """A frame is seen by what is put on it, and by its motion."""
    for coordinate, motion in zip(("x", "y", "angle"), element.motions(), strict=True):
        if not isinstance(motion, Constant):
            _coordinate(element.name, coordinate, _name(motion, element.name), drawing, places)


# forces


@symbol("spring")
def _spring(element: Any, drawing: Drawing, places: Places) -> None:
    _spring_in_space(element, drawing, places)
    _anchors(element, drawing, places)


def _spring_in_space(element: Any, drawing: Drawing, places: Places) -> None:
    """Between its markers, unless it turns a joint."""
    if getattr(element, "measure", "distance") != "angle":
        a, b = (places.at(marker) for marker in element.markers()[:2])
        symbols.spring(drawing, a, b, getattr(element, "damping", 0.0) > 0.0, getattr(element, "stiffness", 1.0) > 0.0)


@symbol("bushing")
def _bushing(element: Any, drawing: Drawing, places: Places) -> None:
    a, b = places.at(element.a), places.at(element.b)
    if math.dist(a, b) > 0.08 * drawing.size:
        symbols.spring(drawing, a, b, element.damping > 0.0, element.stiffness > 0.0)
        _anchors(element, drawing, places)
    else:
        drawing.shapes.append(Circle(b, 0.022 * drawing.size, symbols.SPRING, None, 0.6))


def _anchors(element: Any, drawing: Drawing, places: Places) -> None:
    a, b = element.markers()[:2]
    for marker, other in ((a, b), (b, a)):
        if marker.body == GROUND:
            at, far = places.at(marker), places.at(other)
            across = turned((0.0, 1.0), math.atan2(far[1] - at[1], far[0] - at[0]))
            reach = 0.05 * drawing.size
            symbols.wall(drawing, moved(at, across, -reach), moved(at, across, reach))


@symbol("force")
def _force(element: Any, drawing: Drawing, places: Places) -> None:
    at = places.at(element.marker)
    angle = places.direction(element.marker) if element.follower else 0.0
    for signal, axis in ((element.force_x, (1.0, 0.0)), (element.force_y, (0.0, 1.0))):
        if not _is_zero(signal):
            sign = math.copysign(1.0, signal.value) if isinstance(signal, Constant) else 1.0
            start = symbols.arrow(drawing, at, turned((sign * axis[0], sign * axis[1]), angle))
            drawing.shapes.append(Label(start, _name(signal, element.name), PORT, _side(sign, axis)))


@symbol("torque")
def _torque(element: Any, drawing: Drawing, places: Places) -> None:
    hinges: list[Any] = [joint for joint in places.model.joints if joint.symbol == "hinge"]
    pinned = [places.at(hinge.a) for hinge in hinges if _joins(hinge, element.body)]
    at = symbols.round_arrow(drawing, pinned[0] if pinned else places.frame(element.body)[0])
    drawing.shapes.append(Label(at, _name(element.torque, element.name), PORT))


@symbol("load")
def _load(element: Any, drawing: Drawing, places: Places) -> None:
    _coordinate(element.body, element.coordinate, _name(element.load, element.name), drawing, places)


def _joins(joint: Any, body: str) -> bool:
    return {joint.a.body, joint.b.body} == {GROUND, body}


def _coordinate(body: str, coordinate: str, name: str, drawing: Drawing, places: Places) -> None:
    """An arrow along a coordinate that is driven or loaded."""
    at = _node(body, coordinate, places)
    if at is None:
        return
    if coordinate == "angle":
        drawing.shapes.append(Label(symbols.round_arrow(drawing, at), name, PORT))
        return
    axis = (0.0, 1.0) if coordinate.startswith("y") else (1.0, 0.0)
    start = symbols.arrow(drawing, moved(at, axis, 0.14 * drawing.size), axis)
    tip = moved(start, axis, 0.15 * drawing.size)
    drawing.shapes.append(Label(tip, name, PORT, "right" if axis[0] else "above"))


def _node(body: str, coordinate: str, places: Places) -> Point | None:
    """Where a coordinate stands in the plane, or None if it has no place there."""
    if isinstance(places.bodies[body], PlanarFrame):
        return places.frame(body)[0]
    start = places.start(body)
    if not _PLACE.match(coordinate):
        return (start[coordinate], 0.0) if len(start) == 1 else None
    number = coordinate[1:]
    return start.get(f"x{number}", 0.0), start.get(f"y{number}", 0.0)


def _is_zero(signal: Any) -> bool:
    return isinstance(signal, Constant) and signal.value == 0.0


def _name(signal: Any, otherwise: str) -> str:
    return signal.channel if isinstance(signal, InputSignal) else otherwise


def _side(sign: float, axis: Point) -> str:
    if axis[0]:
        return "left" if sign > 0.0 else "right"
    return "below" if sign > 0.0 else "above"


# contacts


@symbol("shapes")
def _shapes(element: Any, drawing: Drawing, places: Places) -> None:
    shapes = shapes_of(element)
    for shape in shapes:
        if isinstance(shape, HalfPlane2D):
            _plane(shape, [places.at(other.marker) for other in shapes if other is not shape], drawing, places)
        else:
            _shape(shape, drawing, places)


def _plane(plane: HalfPlane2D, others: Sequence[Point], drawing: Drawing, places: Places) -> None:
    """Its line, as far as what touches it."""
    foot, along = places.at(plane.marker), turned((1.0, 0.0), places.direction(plane.marker))
    ends = [0.0, *((x - foot[0]) * along[0] + (y - foot[1]) * along[1] for x, y in others)]
    half = 0.13 * drawing.size
    # behind the line, on the right-hand side of its direction: the half-plane's normal is to the left
    symbols.wall(drawing, moved(foot, along, min(ends) - half), moved(foot, along, max(ends) + half), TOUCH)


@symbol("line")
def _line(element: Any, drawing: Drawing, places: Places) -> None:
    nodes = [places.at(node) for node in element.line.nodes]
    drawing.shapes.append(Path(nodes, TOUCH, width=max(0.6, 200.0 * element.line.radius / drawing.size)))
    _shape(element.disk, drawing, places)


@symbol("wall")
def _wall(element: Any, drawing: Drawing, places: Places) -> None:
    """A wall, if the gap is that of one place along x or y."""
    if len(element.terms) != 1 or not element.terms[0].factor:
        return
    term = element.terms[0]
    at = _node(term.body, term.coordinate, places)
    if at is None:
        return
    limit, half = -element.offset / term.factor, 0.08 * drawing.size
    # hatched on the side where the gap is negative
    s = math.copysign(half, term.factor)
    if term.coordinate.startswith("y"):
        symbols.wall(drawing, (at[0] - s, limit), (at[0] + s, limit), TOUCH)
    else:
        symbols.wall(drawing, (limit, s), (limit, -s), TOUCH)


def _shape(shape: Any, drawing: Drawing, places: Places) -> None:
    own = Drawing(drawing.size)
    show(shape, own)
    drawing.shapes += laid(own.shapes, places.at(shape.marker), places.direction(shape.marker))


JOINTS_IN_SPACE = ("ball", "pin", "cross", "block", "sleeve", "slider", "bead", "pane", "rod", "rolling-sphere",
                   "rolling-disk")  # fmt: skip
IN_SPACE: dict[str, Draw] = {**dict.fromkeys(JOINTS_IN_SPACE, _joint_in_space), "spring": _spring_in_space}
"""The same of those in space."""
