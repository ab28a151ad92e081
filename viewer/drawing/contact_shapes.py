"""The shapes with which planar contacts touch, along the axes of their markers. A shape that says its `outline()`, a
user's own too, is shown by it."""

from collections.abc import Iterable, Sequence
from functools import singledispatch
from typing import Any

from ...core.contacts.contact2d import Contact2D, Disk2D
from ...core.contacts.ring2d import Ring2D
from ...core.contacts.segment2d import Segment2D
from .shapes import TOUCH, Circle, Drawing, Label, Path, Point, turned


@singledispatch
def show(shape: Any, drawing: Drawing) -> None:
    """Draw a shape along the axes of its marker; what says no outline stays out."""
    if hasattr(shape, "outline"):
        drawing.shapes.append(Path(tuple(shape.outline()), TOUCH, width=0.5, closed=True))


@show.register
def _(shape: Disk2D, drawing: Drawing) -> None:
    if shape.radius > 0.004 * drawing.size:
        drawing.shapes.append(Circle((0.0, 0.0), shape.radius, TOUCH, None, 0.5))
    else:
        drawing.shapes.append(Circle((0.0, 0.0), 0.008 * drawing.size, TOUCH, TOUCH, 0.2))


@show.register
def _(shape: Ring2D, drawing: Drawing) -> None:
    drawing.shapes.append(Circle((0.0, 0.0), shape.radius, TOUCH, None, 0.9))


@show.register
def _(shape: Segment2D, drawing: Drawing) -> None:
    width = max(0.8, 200.0 * shape.radius / drawing.size)
    drawing.shapes.append(Path(((0.0, 0.0), (shape.length, 0.0)), TOUCH, width=width))


def shapes_of(contact: Contact2D) -> Sequence[Any]:
    """The shapes of a contact, disks last; points on an outline are the corners of another, and not shown."""
    shapes = sorted(contact.shapes(), key=lambda shape: isinstance(shape, Disk2D))
    outlined = any(hasattr(shape, "outline") for shape in shapes)
    return [shape for shape in shapes if not (outlined and isinstance(shape, Disk2D) and shape.radius == 0.0)]


def laid(shapes: Iterable[Path | Circle | Label], at: Point, angle: float) -> list[Path | Circle]:
    """Shapes of a frame in the frame in which it stands at a point and an angle; labels stay out."""

    def there(p: Point) -> Point:
        dx, dy = turned(p, angle)
        return at[0] + dx, at[1] + dy

    found: list[Path | Circle] = []
    for s in shapes:
        if isinstance(s, Circle):
            found.append(Circle(there(s.centre), s.radius, s.stroke, s.fill, s.width))
        elif isinstance(s, Path):
            points = tuple(there(p) for p in s.points)
            found.append(Path(points, s.stroke, s.fill, s.width, s.closed, s.dashed))
    return found
