"""Bodies as parts of a scene: frames with the shapes that drawings make up, flexible bodies as coloured bands."""

from collections.abc import Mapping, Sequence

import numpy as np

from ..core.elements import (
    AxialRod,
    BodyElement,
    FlexibleBody,
    LinearSystem,
    MaterialPoint2D,
    MovingFrame2D,
    PlanarFrame,
    ReducedBody2D,
)
from ..core.elements.flexible_body import along_axis
from ..core.model.markers import Marker2D
from ..core.model.outputs import MarkerOutput2D, MarkerOutput3D
from .drawing.bodies import draw_body, standing
from .drawing.shapes import INK, PORT, STEEL, Circle, Drawing, Label, Path, Point, turned
from .fields import CrossSection, fields_of
from .magnify import Magnified
from .motion import Motion
from .scene import Anchor, Band, Frame, Gauge, Part, Scene, Shape

MOST_POINTS = 120
"""Points of a flexible body's line."""
MOST_GAUGES = 4
ROOMY = 0.03
"""A disk of this radius, in parts of the scene's size, has room for its name."""
ROD, BEAM = 4.0, 1.4
"""Widths of flexible bodies, in hundredths of the scene's size."""


class Stage:
    """A scene that is being set up, and what its makers need to know."""

    def __init__(self, scene: Scene, motion: Motion) -> None:
        self.scene, self.motion = scene, motion
        self.size = scene.size
        self.magnified = Magnified(motion)
        self.walls: dict[tuple[bool, float, float], tuple[float, float]] = {}
        """Walls of coordinates: (along y, place, side) to where they begin and end."""
        self.planes: dict[Marker2D, tuple[float, float]] = {}
        """Half-planes that disks come near: from where to where along their lines."""
        self._numbers: dict[str, int] = {}

    def add_frame(self, frame: Frame) -> int:
        """Put a frame into the scene; gives its number."""
        self._numbers[frame.name] = len(self.scene.frames)
        self.scene.frames.append(frame)
        return self._numbers[frame.name]

    def number(self, body: str) -> int:
        """Number of a body's frame."""
        return self._numbers[body]

    def anchor(self, body: str, point: Point) -> Anchor:
        """A point of a body."""
        return Anchor(self.number(body), point)

    def add_part(self, body: str, layer: int, drawing: Drawing) -> None:
        """Put shapes that are drawn where the body starts onto its frame."""
        origin, angle = self.start(body)
        shapes = [in_frame(s, origin, angle) for s in (*drawing.behind, *drawing.shapes) if not isinstance(s, Label)]
        if shapes:
            self.scene.parts.append(Part(self.number(body), layer, tuple(shapes)))

    def start(self, body: str) -> tuple[Point, float]:
        """Where the frame of a body is in a drawing of the model's start."""
        found = self.motion.bodies.get(body)
        if isinstance(found, LinearSystem):
            x = standing(found)
            return ((x or 0.0), 0.0), 0.0
        return self.motion.places.frame(body)


def in_frame(shape: Shape, origin: Point, angle: float) -> Shape:
    """A shape of the inertial frame in a frame that stands at `origin` and `angle`."""

    def local(p: Point) -> Point:
        return turned((p[0] - origin[0], p[1] - origin[1]), -angle)

    if isinstance(shape, Circle):
        return Circle(local(shape.centre), shape.radius, shape.stroke, shape.fill, shape.width)
    points = tuple(local(p) for p in shape.points)
    return Path(points, shape.stroke, shape.fill, shape.width, shape.closed, shape.dashed)


def add_bodies(stage: Stage, outlines: Mapping[str, Sequence[Point]], sections: Mapping[str, CrossSection]) -> None:
    """Frames, shapes and bands of all bodies; `outlines` are polygons in the frames of bodies, in place of shapes that
    are made up, `sections` those of flexible bodies, for the stress."""
    for body in stage.motion.model.bodies:
        if isinstance(body, PlanarFrame):
            _planar(stage, body, outlines.get(body.name))
        if isinstance(body, FlexibleBody):
            _flexible(stage, body, sections.get(body.name))
        elif isinstance(body, LinearSystem):
            _generalised(stage, body)


def _planar(stage: Stage, body: PlanarFrame, outline: Sequence[Point] | None) -> None:
    motion = stage.motion
    solid = not isinstance(body, MaterialPoint2D | MovingFrame2D | FlexibleBody)
    velocity = motion.velocity(body.name) if solid and motion.moves else None
    drawing, name = Drawing(stage.size), None
    if solid:
        label = draw_body(drawing, motion.places, body)
        origin, angle = motion.places.frame(body.name)
        name = turned((label.at[0] - origin[0], label.at[1] - origin[1]), -angle)
        if any(isinstance(s, Circle) and s.centre == origin and s.radius > ROOMY * stage.size for s in drawing.shapes):
            name = (0.0, 0.0)
    stage.add_frame(Frame(body.name, motion.frame(body.name), velocity, name))
    if outline is not None:
        stage.scene.parts.append(Part(stage.number(body.name), 1, (outline_shape(outline),)))
    elif solid:
        stage.add_part(body.name, 1, drawing)


def outline_shape(points: Sequence[Point]) -> Path:
    """A polygon in the colours of bodies."""
    return Path(tuple((float(x), float(y)) for x, y in points), INK, STEEL, 0.5, closed=True)


def _flexible(stage: Stage, body: FlexibleBody, section: CrossSection | None) -> None:
    motion = stage.motion
    points = _points_along(body)
    if len(points) < 2:
        return
    s = np.array([x for x, _ in points])
    places = motion.points(body, points)
    if isinstance(body, AxialRod):
        places[:, :, 0] = stage.magnified.rod(body.name, places[:, :, 0])
    stage.scene.bands.append(
        Band(body.name, places, ROD if isinstance(body, AxialRod) else BEAM, tuple(fields_of(motion, body, s, section)))
    )


def _points_along(body: FlexibleBody) -> list[Point]:
    """Material points that show a body bent: more than a drawing at rest needs."""
    drawn = list(body.drawn_points())
    if isinstance(body, ReducedBody2D) or len(drawn) < 2:
        return drawn
    elements = getattr(body, "elements", None) or 1
    pieces = min(elements if isinstance(body, AxialRod) else max(40, 4 * elements), MOST_POINTS)
    return along_axis(drawn[-1][0], pieces)


def _generalised(stage: Stage, body: LinearSystem) -> None:
    """A coordinate along x moves a block; what has no place in the plane is shown by gauges."""
    motion, x = stage.motion, standing(body)
    if x is None:
        names = body.coordinates[:MOST_GAUGES]
        units = {record.name: record.unit for record in body.coordinate_records()}
        stage.scene.gauges += [Gauge(f"{body.name}.{n}", units[n], motion.coordinate(body.name, n)) for n in names]
        return
    values = stage.magnified.beside(body.name)
    if values is None:
        values = motion.coordinate(body.name, body.coordinates[0])
    path = np.stack([values, 0.0 * values, 0.0 * values], axis=1)
    rates = motion.table(body.name)[1]
    drawing = Drawing(stage.size)
    label = draw_body(drawing, motion.places, body)
    velocity = np.hstack([rates, 0.0 * rates]) if motion.moves else None
    stage.add_frame(Frame(body.name, path, velocity, (label.at[0] - x, label.at[1])))
    stage.add_part(body.name, 1, drawing)


def add_output(stage: Stage, output: MarkerOutput2D | MarkerOutput3D) -> None:
    """A dot where a marker is, with its name, its velocity and its trail."""
    motion, marker = stage.motion, output.marker
    assert isinstance(marker, Marker2D)
    path = np.hstack([motion.at(marker), motion.direction(marker)[:, None]])
    velocity = motion.velocity_at(marker) if motion.moves else None
    add_dot(stage, Frame(output.name, path, velocity, (0.012 * stage.size, 0.0)))


def add_dot(stage: Stage, frame: Frame) -> None:
    """A frame that is seen as a dot."""
    dot = Circle((0.0, 0.0), 0.006 * stage.size, PORT, PORT, 0.2)
    stage.scene.parts.append(Part(stage.add_frame(frame), 2, (dot,)))


def has_place(body: BodyElement) -> bool:
    """True of bodies that have a frame in the scene."""
    return isinstance(body, PlanarFrame) or (isinstance(body, LinearSystem) and standing(body) is not None)
