"""A scene in space that is being set up. F frames."""

import numpy as np

from ...core.elements import PlanarFrame, SpatialFrame
from ...core.model.markers import GROUND, Marker, Marker2D, Marker3D
from ..drawing.shapes import STEEL
from ..motion import Motion
from ..scene import Anchor, Arrow, Floats, Frame, Link, Scene, Solid
from .meshes import Mesh
from .turning import STILL, matrices, nearest, towards

Vector = tuple[float, float, float]


class Stage3D:
    """A scene and what its makers need to know. `size`: of the mechanism, m."""

    def __init__(self, scene: Scene, motion: Motion) -> None:
        self.scene, self.motion, self.size = scene, motion, scene.size
        self._numbers: dict[str, int] = {}
        self.shaped: set[str] = set()
        """Bodies whose shape is known from their joints."""
        self.planes: list[Marker3D] = []
        """Surfaces on which bodies lie or roll."""

    def add_frame(self, frame: Frame) -> int:
        """Put a frame into the scene; gives its number."""
        self._numbers[frame.name] = len(self.scene.frames)
        self.scene.frames.append(frame)
        return self._numbers[frame.name]

    def number(self, body: str) -> int:
        """Number of a body's frame."""
        return self._numbers[body]

    def pose(self, body: str) -> Floats:
        """Place and Euler parameters of a body's frame, (F, 7) or (1, 7) of what stands still."""
        return pose_of(self.motion, body)

    def at(self, marker: Marker) -> Floats:
        """Places (F, 3) of a marker; one in the plane is at z = 0."""
        pose = self.pose(marker.body)
        found: Floats = pose[:, :3] + matrices(pose[:, 3:]) @ np.array(point_of(marker))
        return np.broadcast_to(found, (len(self.motion.t), 3)).copy()

    def axes(self, marker: Marker3D) -> Floats:
        """Axes of a marker as columns (F, 3, 3)."""
        found = matrices(self.pose(marker.body)[:, 3:]) @ marker.axes()
        return np.broadcast_to(found, (len(self.motion.t), 3, 3)).copy()

    def solid(self, marker: Marker3D, mesh: Mesh, size: Vector, colour: str = STEEL, **more: float | Vector) -> None:
        """A solid along a marker's axes; `shift` (m along them) moves it, `opacity` lets it shine through."""
        shift, opacity = more.get("shift", (0.0, 0.0, 0.0)), more.get("opacity", 1.0)
        assert isinstance(opacity, float)
        x, y, z = (np.array(marker.point) + marker.axes() @ np.array(shift)).tolist()
        turn = marker.attitude.parameters()
        self.scene.solids.append(Solid(self.number(marker.body), mesh, (x, y, z), turn, size, colour, opacity))

    def rod(self, body: str, a: Vector, b: Vector, radius: float, mesh: Mesh, colour: str = STEEL) -> None:
        """A bar between two points of a body."""
        start, way = np.array(a), np.array(b) - np.array(a)
        x, y, z = (start + 0.5 * way).tolist()
        e0, e1, e2, e3 = towards(way[None])[0].tolist()
        size = (radius, radius, float(np.linalg.norm(way)))
        self.scene.solids.append(Solid(self.number(body), mesh, (x, y, z), (e0, e1, e2, e3), size, colour))

    def link(self, name: str, kind: str, a: Marker, b: Marker) -> None:
        """What stretches between two markers."""
        ends = (Anchor(self.number(marker.body), point_of(marker)) for marker in (a, b))
        self.scene.links.append(Link(name, kind, *ends))

    def arrow(self, name: str, kind: str, at: Floats, vector: Floats) -> None:
        """A force, N."""
        self.scene.arrows.append(Arrow(name, kind, "N", at, vector))


def point_of(marker: Marker) -> Vector:
    """A marker's point in its body's frame, in space."""
    if isinstance(marker, Marker3D):
        return marker.point
    assert isinstance(marker, Marker2D)
    return (*marker.point, 0.0)


def pose_of(motion: Motion, body: str) -> Floats:
    """Place and Euler parameters of a body's frame in space: (F, 7); (1, 7) of the ground."""
    record = motion.bodies.get(body)
    if body == GROUND or record is None:
        return np.array([[0.0, 0.0, 0.0, *STILL]])
    q, _ = motion.table(body)
    found = np.zeros((len(q), 7))
    found[:, 3] = 1.0
    if isinstance(record, SpatialFrame):
        found[:, :3] = q[:, :3]
        if q.shape[1] >= 7:
            found[:, 3:] = nearest(q[:, 3:7])
    elif isinstance(record, PlanarFrame):
        plane = motion.frame(body)
        found[:, :2] = plane[:, :2]
        found[:, 3], found[:, 6] = np.cos(0.5 * plane[:, 2]), np.sin(0.5 * plane[:, 2])
    return found
