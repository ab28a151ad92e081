"""Joints, forces and the shapes that contacts touch, as parts of a scene."""

import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from ..core.contacts.contact2d import Disk2D, HalfPlane2D
from ..core.contacts.ring2d import Ring2D
from ..core.elements import (
    AxialRod,
)
from ..core.model.markers import GROUND, Marker2D
from .bodies import Stage, has_place
from .coordinates import coordinate_place
from .drawing import symbols
from .drawing.contact_shapes import laid, shapes_of, show
from .drawing.interactions import draw_interaction
from .drawing.shapes import GROUND as GROUND_COLOUR
from .drawing.shapes import INK, STEEL, TOUCH, Circle, Drawing, Path, moved, turned
from .registry import registering
from .scene import Floats, Frame, Line, Link, Part

GRIP = 0.13
"""How far walls go beyond what touches them, in parts of the scene's size."""
CLOSE = 0.15
"""How near a disk must come to a half-plane for its line to be drawn there, in parts of the scene's size."""
SPOKES = 6
NEAR = 0.08
"""Markers of a bushing nearer than this, in parts of the scene's size, are one place."""


def add_fixtures(stage: Stage) -> None:
    """All joints, forces and shapes of contacts that have a symbol; the others stay out of the scene."""
    model = stage.motion.model
    for element in (*model.contacts, *model.joints, *model.forces):
        place(element, stage)
    _add_walls(stage)


Draw = Callable[[Any, Stage], None]
SYMBOLS: dict[str, Draw] = {}
"""What draws elements of the plane, by their `symbol`. It finds by their names the fields of the element that it needs:
markers a and b, a radius."""


symbol = registering(SYMBOLS)
"""Decorator: the function draws elements with this symbol."""


def place(element: Any, stage: Stage) -> None:
    """Put an element of the plane into the scene; what has no symbol there stays out."""
    draw = SYMBOLS.get(element.symbol)
    if draw is not None and all(isinstance(marker, Marker2D) for marker in element.markers()):
        draw(element, stage)


# joints and forces


@symbol("hinge")
def _hinge(element: Any, stage: Stage) -> None:
    _drawn(element, element.a.body if element.b.body == GROUND else element.b.body, stage, 2)
    if GROUND in (element.a.body, element.b.body):
        drawing = Drawing(stage.size)
        symbols.bearing(drawing, stage.motion.places.at(element.a))
        stage.add_part(GROUND, 0, drawing)


@symbol("clamp")
def _clamp(element: Any, stage: Stage) -> None:
    grounded = GROUND in (element.a.body, element.b.body)
    _drawn(element, GROUND if grounded else element.b.body, stage, 0 if grounded else 2)


@symbol("guide")
def _guide(element: Any, stage: Stage) -> None:
    """The line that b slides on, as long as its way, with the ground below it."""
    marker = element.a
    near, far = _reach(stage, marker, stage.motion.at(element.b), 0.16)
    drawing = Drawing(stage.size)
    drawing.behind.append(Path(((near, 0.0), (far, 0.0)), GROUND_COLOUR, width=0.4))
    if marker.body == GROUND:
        foot = -0.036 * stage.size
        symbols.wall(drawing, (near, foot), (far, foot))
    _on_marker(stage, marker, 0, drawing)


@symbol("rod")
def _rod(element: Any, stage: Stage) -> None:
    stage.scene.links.append(Link(element.name, "rod", _anchor(stage, element.a), _anchor(stage, element.b)))
    _drawn_ends(element, stage)


@symbol("link")
def _plain_link(element: Any, stage: Stage) -> None:
    """A rod between its first two markers, of one that has no symbol of its own."""
    markers = element.markers()
    if len(markers) > 1:
        stretched(stage, element.name, "rod", *markers[:2])


@symbol("spring")
def _spring(element: Any, stage: Stage) -> None:
    """Between its markers; of a spring that turns a joint the coil stands in `mechanical.py`."""
    if getattr(element, "measure", "distance") == "angle":
        SYMBOLS["coil"](element, stage)
    else:
        _link(element, stage)


@symbol("bushing")
def _bushing(element: Any, stage: Stage) -> None:
    a, b = (stage.motion.at(marker) for marker in (element.a, element.b))
    if float(np.max(np.linalg.norm(b - a, axis=1))) > NEAR * stage.size:
        _link(element, stage)
        return
    drawing = Drawing(stage.size)
    drawing.shapes.append(Circle(stage.motion.places.at(element.b), 0.022 * stage.size, symbols.SPRING, None, 0.6))
    stage.add_part(element.b.body, 2, drawing)


@symbol("gears")
def _gears(element: Any, stage: Stage) -> None:
    """Two wheels with spokes, so that they are seen to turn."""
    for marker, radius in ((element.a, element.radius_a), (element.b, element.radius_b)):
        drawing = Drawing(stage.size)
        r = abs(radius)
        drawing.shapes.append(Circle((0.0, 0.0), r, INK, STEEL if radius > 0.0 else None, 0.4))
        ends = [turned((r, 0.0), 2.0 * math.pi * k / SPOKES) for k in range(SPOKES)]
        drawing.shapes += [Path(((0.0, 0.0), end), INK, width=0.3) for end in ends]
        _on_marker(stage, marker, 0, drawing)


def _link(element: Any, stage: Stage) -> None:
    stretched(stage, element.name, kind_of_spring(element), *element.markers()[:2])


def kind_of_spring(element: Any) -> str:
    """Of a link, by the element's `stiffness` and `damping`; of one that does not say them, a spring."""
    damped, stiff = getattr(element, "damping", 0.0) > 0.0, getattr(element, "stiffness", 1.0) > 0.0
    return "spring-damper" if damped and stiff else "damper" if damped else "spring"


def stretched(stage: Stage, name: str, kind: str, a: Marker2D, b: Marker2D) -> None:
    """A link between two markers, with a wall where it is held by the ground."""
    stage.scene.links.append(Link(name, kind, _anchor(stage, a), _anchor(stage, b)))
    for marker, other in ((a, b), (b, a)):
        if marker.body == GROUND:
            at, far = stage.motion.places.at(marker), stage.motion.places.at(other)
            across = turned((0.0, 1.0), math.atan2(far[1] - at[1], far[0] - at[0]))
            drawing, reach = Drawing(stage.size), 0.05 * stage.size
            symbols.wall(drawing, moved(at, across, -reach), moved(at, across, reach))
            stage.add_part(GROUND, 0, drawing)


def _drawn(element: Any, body: str, stage: Stage, layer: int) -> None:
    """What a drawing shows of an element, on a body."""
    drawing = Drawing(stage.size)
    if element.symbol == "hinge":
        symbols.pin(drawing, stage.motion.places.at(element.b if body == element.b.body else element.a))
    else:
        draw_interaction(element, drawing, stage.motion.places)
    stage.add_part(body, layer, drawing)


def _drawn_ends(element: Any, stage: Stage) -> None:
    for marker in (element.a, element.b):
        if marker.body == GROUND:
            at, drawing = stage.motion.places.at(marker), Drawing(stage.size)
            reach = 0.03 * stage.size
            symbols.wall(drawing, moved(at, (1.0, 0.0), reach), moved(at, (1.0, 0.0), -reach))
            symbols.pin(drawing, at)
            stage.add_part(GROUND, 0, drawing)


# shapes of contacts


@symbol("shapes")
def _shapes(element: Any, stage: Stage) -> None:
    shapes = shapes_of(element)
    for shape in shapes:
        if isinstance(shape, HalfPlane2D):
            near, far = _touched(stage, shape.marker, [other for other in shapes if other is not shape])
            known = stage.planes.get(shape.marker, (near, far))
            stage.planes[shape.marker] = min(near, known[0]), max(far, known[1])
        else:
            _shape(shape, stage, 2 if isinstance(shape, Disk2D) else 0 if isinstance(shape, Ring2D) else 1)


@symbol("line")
def _line(element: Any, stage: Stage) -> None:
    line = element.line
    nodes = tuple(_anchor(stage, node) for node in line.corners)
    found = Line(element.name, nodes, 2.0 * line.radius, line.rounding, line.closed)
    if all(found.nodes != other.nodes for other in stage.scene.lines):
        stage.scene.lines.append(found)
    _shape(element.disk, stage, 2)


@symbol("wall")
def _wall(element: Any, stage: Stage) -> None:
    """A wall, if the gap is that of one place along x or y; what moves with other coordinates is a line that moves."""
    term = next(
        (t for t in element.terms if t.factor and coordinate_place(stage, t.body, t.coordinate) is not None), None
    )
    if term is None:
        return
    others = [t for t in element.terms if t is not term]
    if any(has_place(stage.motion.bodies[t.body]) or isinstance(stage.motion.bodies[t.body], AxialRod) for t in others):
        return
    face = np.full(len(stage.motion.t), -element.offset / term.factor)
    for t in others:
        face = face - t.factor / term.factor * stage.motion.coordinate(t.body, t.coordinate)
    touched = stage.magnified.touched(element)
    if touched is not None:
        face = touched[1]
    node = coordinate_place(stage, term.body, term.coordinate)
    along_y, half = term.coordinate.startswith("y"), 0.08 * stage.size
    across = np.zeros(1) if node is None else node[:, 0 if along_y else 1]
    low, high = float(across.min()) - half, float(across.max()) + half
    side = math.copysign(1.0, term.factor)
    if others:
        _moving_face(stage, element.name, face, (low, high), along_y)
        return
    key = (along_y, float(face[0]), side)
    known = stage.walls.get(key, (low, high))
    stage.walls[key] = min(low, known[0]), max(high, known[1])


def _moving_face(stage: Stage, name: str, face: Floats, span: tuple[float, float], along_y: bool) -> None:
    """A line that moves along an axis: the surface of something that is not drawn."""
    zero = np.zeros(len(face))
    motion = np.stack([zero, face, zero] if along_y else [face, zero, zero], axis=1)
    number = stage.add_frame(Frame(f"surface of {name}", motion))
    ends = ((span[0], 0.0), (span[1], 0.0)) if along_y else ((0.0, span[0]), (0.0, span[1]))
    stage.scene.parts.append(Part(number, 1, (Path(ends, TOUCH, width=0.8),)))


def _add_walls(stage: Stage) -> None:
    """Half-planes and walls at places of coordinates; what many disks or nodes touch is one."""
    for marker, (near, far) in stage.planes.items():
        drawing = Drawing(stage.size)
        symbols.wall(drawing, (near, 0.0), (far, 0.0), TOUCH)
        _on_marker(stage, marker, 0, drawing)
    for (along_y, at, side), (low, high) in stage.walls.items():
        drawing = Drawing(stage.size)
        if along_y:
            ends = ((low, at), (high, at)) if side > 0.0 else ((high, at), (low, at))
        else:
            ends = ((at, high), (at, low)) if side > 0.0 else ((at, low), (at, high))
        symbols.wall(drawing, *ends, TOUCH)
        shapes = tuple(x for x in (*drawing.behind, *drawing.shapes) if isinstance(x, Path | Circle))
        stage.scene.parts.append(Part(stage.number(GROUND), 0, shapes))


def _shape(shape: Any, stage: Stage, layer: int) -> None:
    """A shape, unless another contact has shown it."""
    drawing = Drawing(stage.size)
    show(shape, drawing)
    _on_marker(stage, shape.marker, layer, drawing)


def _on_marker(stage: Stage, marker: Marker2D, layer: int, drawing: Drawing) -> None:
    """Shapes in a marker's frame, put on its body; the same ones only once."""
    shapes = laid((*drawing.behind, *drawing.shapes), marker.point, marker.angle)
    part = Part(stage.number(marker.body), layer, tuple(shapes))
    if part not in stage.scene.parts:
        stage.scene.parts.append(part)


def _reach(stage: Stage, marker: Marker2D, places: Floats, margin: float) -> tuple[float, float]:
    """From where to where places (F, 2) go along a marker's first axis, its origin included, with a margin; m."""
    angle, away = stage.motion.direction(marker), places - stage.motion.at(marker)
    along = away[:, 0] * np.cos(angle) + away[:, 1] * np.sin(angle)
    return min(0.0, float(along.min())) - margin * stage.size, max(0.0, float(along.max())) + margin * stage.size


def _touched(stage: Stage, marker: Marker2D, shapes: Sequence[Any]) -> tuple[float, float]:
    """The part of a half-plane's line where shapes come near it, with a margin; m along the line."""
    margin, angle = GRIP * stage.size, stage.motion.direction(marker)
    ends = [0.0, 0.0] if not shapes else []
    for shape in shapes:
        away = stage.motion.at(shape.marker) - stage.motion.at(marker)
        height = away[:, 1] * np.cos(angle) - away[:, 0] * np.sin(angle) - getattr(shape, "radius", 0.0)
        near = height <= max(float(height.min()), 0.0) + CLOSE * stage.size
        along = (away[:, 0] * np.cos(angle) + away[:, 1] * np.sin(angle))[near]
        ends += [float(along.min()), float(along.max())]
    return min(ends) - margin, max(ends) + margin


def _anchor(stage: Stage, marker: Marker2D) -> Any:
    return stage.anchor(marker.body, marker.point)
