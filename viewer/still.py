"""A scene at one frame as a drawing: what films are made of."""

import math

import numpy as np

from .drawing import symbols
from .drawing.shapes import FLEX, INK, TOUCH, Circle, Drawing, Path, Point, turned
from .scene import Anchor, Band, Floats, Scene, Shape

ARROW = 0.125
"""Length of the usual arrow, in parts of the scene's size."""
LONGEST = 2.2
EDGE = "#123f30"
BLUE, GREY, RED = (33, 84, 194), (205, 212, 220), (196, 38, 32)
COLOURS = {"contact": TOUCH, "load": "#c96a00"}


def still(scene: Scene, frame: int) -> Drawing:
    """The scene at frame number `frame`, with contact forces and loads."""
    drawing = Drawing(scene.size)
    for layer in (0, 1, 2):
        _parts(drawing, scene, frame, layer)
        if layer == 0:
            for band in scene.bands:
                _band(drawing, band, frame)
        if layer == 1:
            for line in scene.lines:
                nodes = [_place(scene, node, frame) for node in line.nodes]
                width = max(100.0 * line.thickness / scene.size, 0.6)
                drawing.shapes.append(Path(nodes, TOUCH, width=width, closed=line.closed))
            for link in scene.links:
                a, b = _place(scene, link.a, frame), _place(scene, link.b, frame)
                if link.kind == "rod":
                    drawing.shapes.append(Path((a, b), INK, width=0.5))
                elif a != b:
                    symbols.spring(drawing, a, b, "damper" in link.kind, "spring" in link.kind)
    for arrow in scene.arrows:
        usual = _usual(scene, arrow.kind) if arrow.kind in COLOURS else 0.0
        x, y = arrow.vector[frame]
        size = math.hypot(x, y)
        if usual > 0.0 and size > 1e-3 * usual:
            length = min(size / usual, LONGEST) * ARROW * scene.size
            px, py = arrow.at[frame]
            tip = float(px + length * x / size), float(py + length * y / size)
            symbols.arrow(drawing, tip, (float(x / size), float(y / size)), COLOURS[arrow.kind], length)
    return drawing


def _usual(scene: Scene, kind: str) -> float:
    """The usual size of arrows of a kind: short blows do not make all else invisible."""
    sizes = [np.linalg.norm(arrow.vector, axis=1) for arrow in scene.arrows if arrow.kind == kind]
    every = np.concatenate(sizes)
    every = every[every > 0.0]
    return float(np.quantile(every, 0.95)) if len(every) else 0.0


def _pose(motion: Floats, frame: int) -> Floats:
    row: Floats = motion[min(frame, len(motion) - 1)]
    return row


def _there(pose: Floats, point: Point) -> Point:
    dx, dy = turned(point, float(pose[2]))
    return float(pose[0]) + dx, float(pose[1]) + dy


def _place(scene: Scene, anchor: Anchor, frame: int) -> Point:
    return _there(_pose(scene.frames[anchor.frame].motion, frame), (anchor.point[0], anchor.point[1]))


def _parts(drawing: Drawing, scene: Scene, frame: int, layer: int) -> None:
    for part in scene.parts:
        if part.layer == layer:
            pose = _pose(scene.frames[part.frame].motion, frame)
            drawing.shapes += [_moved(shape, pose) for shape in part.shapes]


def _moved(shape: Shape, pose: Floats) -> Shape:
    if isinstance(shape, Circle):
        return Circle(_there(pose, shape.centre), shape.radius, shape.stroke, shape.fill, shape.width)
    points = tuple(_there(pose, p) for p in shape.points)
    return Path(points, shape.stroke, shape.fill, shape.width, shape.closed, shape.dashed)


def _band(drawing: Drawing, band: Band, frame: int) -> None:
    """A strip of quadrilaterals, each in the colour of its piece."""
    points = band.points[frame]
    way = np.gradient(points, axis=0)
    size = np.linalg.norm(way, axis=1, keepdims=True)
    way = np.divide(way, size, out=np.zeros_like(way), where=size > 0.0)
    across = 0.005 * band.width * drawing.size * np.stack([-way[:, 1], way[:, 0]], axis=1)
    left, right = (points + across).tolist(), (points - across).tolist()
    outline = [(x, y) for x, y in [*left, *right[::-1]]]
    drawing.shapes.append(Path(outline, EDGE, FLEX, 0.4, closed=True))
    if not band.fields:
        return
    field = band.fields[0]
    values = field.values[frame] / field.limit
    for k in range(len(points) - 1):
        corners = [(x, y) for x, y in (left[k], left[k + 1], right[k + 1], right[k])]
        colour = band_colour(float(0.5 * (values[k] + values[k + 1])))
        drawing.shapes.append(Path(corners, None, colour, closed=True))


def band_colour(part: float) -> str:
    """Blue where negative, red where positive."""
    end, w = (BLUE if part < 0.0 else RED), min(abs(part), 1.0) ** 0.7
    return "#" + "".join(f"{round(g + w * (e - g)):02x}" for g, e in zip(GREY, end, strict=True))
