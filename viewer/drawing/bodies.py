"""Bodies as shapes. A model knows where bodies are joined and touched, not their outlines: these are made up."""

import math

from ...core.elements import (
    AxialRod,
    BodyElement,
    FlexibleBody,
    LinearSystem,
    MaterialPoint2D,
    MovingFrame2D,
    PointMass2D,
    Prismatic2D,
    RigidBody2D,
    SpatialFrame,
)
from . import symbols
from .places import Places
from .shapes import FLEX, INK, STEEL, Circle, Drawing, Label, Path, Point, between, hull, moved, turned

MOST_NAMES = 8
FLAT = 1e-4
"""Width of a hull over its length below which it is a line."""
LINK = 2.6  # width of a link, in hundredths of the drawing's size


def draw_bodies(drawing: Drawing, places: Places) -> None:
    """All bodies with their names; of many bodies of a kind, the first one's and the last one's."""
    shown = [b for b in places.model.bodies if not isinstance(b, MaterialPoint2D | MovingFrame2D)]
    named = {b.name for b in (shown if len(shown) <= MOST_NAMES else (shown[0], shown[-1]))}
    boxes, labels = 0, []
    for body in shown:
        if isinstance(body, LinearSystem) and standing(body) is None:
            _coordinates(drawing, places, body, boxes)
            boxes += 1
            continue
        label = draw_body(drawing, places, body)
        if body.name in named:
            labels.append(label)
    drawing.shapes += labels


def draw_body(drawing: Drawing, places: Places, body: BodyElement) -> Label:
    """Draw a body; gives its name."""
    u = 0.01 * drawing.size
    if isinstance(body, RigidBody2D):
        return _rigid(drawing, places, body)
    if isinstance(body, PointMass2D):
        centre = places.frame(body.name)[0]
        # its disk as it is, unless that would hardly be seen
        radius = _disk_radius(places, body.name)
        radius = radius if radius > 0.6 * u else 2.0 * u
        drawing.shapes.append(Circle(centre, radius, INK, STEEL, 0.5))
        return Label(moved(centre, (1.0, 0.0), radius + u), body.name)
    if isinstance(body, LinearSystem):
        centre = (standing(body) or 0.0) - 4.0 * u, 0.0
        _block(drawing, centre, 0.0, 4.0 * u, 3.0 * u)
        return Label((centre[0], centre[1] + 5.0 * u), body.name)
    if isinstance(body, FlexibleBody):
        return _flexible(drawing, places, body)
    if isinstance(body, SpatialFrame):
        line, centre = places.star(body), places.frame(body.name)[0]
        balls = [sphere for sphere in places.spheres() if sphere.marker.body == body.name]
        drawing.shapes += [Circle(places.at(ball.marker), ball.radius, INK, STEEL, 0.5) for ball in balls]
        if len(line) > 1:
            drawing.shapes += [Path(line, INK, width=LINK + 0.9), Path(line, STEEL, width=LINK)]
        elif not balls:
            drawing.shapes.append(Circle(centre, 2.0 * u, INK, STEEL, 0.5))
        symbols.centre_of_mass(drawing, centre)
        return Label((centre[0] + 2.5 * u, centre[1] + 3.5 * u), body.name)
    return Label(places.frame(body.name)[0], body.name)


def _flexible(drawing: Drawing, places: Places, body: FlexibleBody) -> Label:
    axis = places.axis(body)
    if isinstance(body, AxialRod):
        (x0, y), (x1, _) = axis
        _block(drawing, (0.5 * (x0 + x1), y), 0.0, 0.5 * (x1 - x0), 0.02 * drawing.size, FLEX, "#cfe9df")
    elif len(axis) > 1:
        drawing.shapes.append(Path(axis, FLEX, width=1.3))
        if len(axis) <= 21:
            drawing.shapes += [Circle(p, 0.007 * drawing.size, FLEX, "white", 0.3) for p in axis]
    middle = axis[len(axis) // 2] if axis else places.frame(body.name)[0]
    if len(axis) == 2:
        middle = 0.5 * (axis[0][0] + axis[1][0]), 0.5 * (axis[0][1] + axis[1][1])
    return Label((middle[0], middle[1] + 0.035 * drawing.size), body.name, FLEX)


def _rigid(drawing: Drawing, places: Places, body: RigidBody2D) -> Label:
    centre = places.frame(body.name)[0]
    u = 0.01 * drawing.size
    corners = _outline(places.points_on(body.name), centre)
    guide = next((j for j in places.model.joints if isinstance(j, Prismatic2D) and j.b.body == body.name), None)
    if guide is not None:
        along = turned((1.0, 0.0), -places.direction(guide.a))
        reach = [p[0] * along[0] - p[1] * along[1] for p in corners]
        middle = centre[0] * along[0] - centre[1] * along[1]
        half = max(5.0 * u, *(abs(r - middle) for r in reach))
        _block(drawing, centre, places.direction(guide.a), half, 3.2 * u)
    elif len(corners) == 1:
        radius = _disk_radius(places, body.name) or min(math.sqrt(body.inertia / body.mass), 0.2 * drawing.size)
        drawing.shapes.append(Circle(centre, radius, INK, STEEL, 0.5))
    elif len(corners) == 2:
        drawing.shapes += [Path(corners, INK, width=LINK + 0.9), Path(corners, STEEL, width=LINK)]
    elif any(m.body == body.name for contact in places.model.contacts for m in contact.markers()):
        drawing.shapes.append(Path(corners, INK, STEEL, 0.5, closed=True))  # what touches ends where it touches
    else:
        drawing.shapes += [
            Path(corners, INK, INK, LINK + 0.9, closed=True),
            Path(corners, STEEL, STEEL, LINK, closed=True),
        ]
    symbols.centre_of_mass(drawing, centre)
    if guide is not None or len(corners) != 2:
        return Label((centre[0] + 2.5 * u, centre[1] + 5.5 * u), body.name)
    (x0, y0), (x1, y1) = corners
    normal, _ = between((y1, x0), (y0, x1))
    if normal[1] < -0.1 or (normal[1] < 0.1 and normal[0] < 0.0):
        normal = -normal[0], -normal[1]
    return Label(moved(centre, normal, 4.0 * u), body.name, INK, "left" if normal[0] < -0.3 else "right")


def _outline(points: list[Point], centre: Point) -> list[Point]:
    """Hull of what is known of a body: of its points, and where its centre of mass would be a corner of these, of their
    mirror images too, as a centre of mass lies within."""
    corners = hull((*points, centre))
    if centre in corners and len(corners) > 1:
        (cx, cy), known = centre, list(corners)
        corners = hull((*known, *((2.0 * cx - x, 2.0 * cy - y) for x, y in known)))
    return _without_width(corners)


def _without_width(corners: list[Point]) -> list[Point]:
    """The two ends of a hull that is a line but for rounding; another one as it is."""
    pairs = [(a, b) for k, a in enumerate(corners) for b in corners[k + 1 :]]
    if len(corners) < 3:
        return corners
    a, b = max(pairs, key=lambda pair: math.dist(*pair))
    (ux, uy), length = between(a, b)
    flat = all(abs((p[0] - a[0]) * uy - (p[1] - a[1]) * ux) <= FLAT * length for p in corners)
    return [a, b] if flat else corners


def _block(
    drawing: Drawing, centre: Point, angle: float, half: float, height: float, stroke: str = INK, fill: str = STEEL
) -> None:
    corners = [turned(p, angle) for p in ((-half, -height), (half, -height), (half, height), (-half, height))]
    outline = [(centre[0] + dx, centre[1] + dy) for dx, dy in corners]
    drawing.shapes.append(Path(outline, stroke, fill, 0.5, closed=True))


def _disk_radius(places: Places, body: str) -> float:
    """Largest disk about a body's own origin."""
    disks = (disk for contact in places.model.contacts for disk in contact.disks())
    radii = [d.radius for d in disks if d.marker.body == body and d.marker.point == (0.0, 0.0)]
    return max(radii, default=0.0)


def standing(body: LinearSystem) -> float | None:
    """Where a single coordinate in m stands along x; None for generalised coordinates that have no place."""
    if len(body.coordinates) == 1 and body.coordinate_records()[0].unit == "m":
        return body.position[0] if body.position else 0.0
    return None


def _coordinates(drawing: Drawing, places: Places, body: LinearSystem, row: int) -> None:
    """A box for what has coordinates but no place, below everything."""
    (x0, y0), (x1, _) = drawing.box()
    u = 0.01 * drawing.size
    middle, y, half = 0.5 * (x0 + x1), y0 - 5.0 * u, 22.0 * u
    _block(drawing, (middle, y), 0.0, half, 4.0 * u, FLEX, "#cfe9df")
    names = body.coordinates if len(body.coordinates) <= 3 else (body.coordinates[0], "…", body.coordinates[-1])
    drawing.shapes.append(Label((middle, y), f"{body.name}: {', '.join(names)}", INK, "centre"))
