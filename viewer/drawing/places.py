"""Where a model's bodies and markers are at its start."""

import math
from collections.abc import Iterator

from ...core.contacts.contact3d import Contact3D, Sphere3D
from ...core.elements import BodyElement, FlexibleBody, Gear2D, PlanarFrame, PointMass2D, SpatialFrame
from ...core.elements.spatial_body import start_of_marker
from ...core.model.markers import Marker, Marker2D, Marker3D
from ...core.multibody_model import Model
from .shapes import Point, bounds, turned
from .view import View, star


class Places:
    """Positions (m) and angles (rad) at the start of `model`, as its bodies give them."""

    def __init__(self, model: Model) -> None:
        self.model = model
        self.bodies: dict[str, BodyElement] = {body.name: body for body in model.bodies}
        inputs = {channel.name: channel.start for channel in model.inputs}
        self._starts = {name: body.start_in(self.bodies, inputs)[0] for name, body in self.bodies.items()}
        self.view = View(model)
        self.size = self._size()

    def start(self, body: str) -> dict[str, float]:
        """The coordinates of a body by name."""
        return dict(zip(self.bodies[body].coordinate_names, self._starts[body], strict=True))

    def frame(self, body: str) -> tuple[Point, float]:
        """Origin and angle of a body's frame; those of the ground are zero."""
        found = self.bodies.get(body)
        if isinstance(found, SpatialFrame):
            return self.at(Marker3D(body=body)), 0.0
        if not isinstance(found, PlanarFrame):
            return (0.0, 0.0), 0.0
        x, y, *angle = self._starts[body]
        # a point mass keeps the directions of the ground
        return (x, y), 0.0 if isinstance(self.bodies[body], PointMass2D) else angle[0]

    def at(self, marker: Marker) -> Point:
        """Position of a marker, of one in space on paper."""
        if isinstance(marker, Marker3D):
            return self.view.point(start_of_marker(marker, self.bodies)[0])
        assert isinstance(marker, Marker2D)
        (x, y), angle = self.frame(marker.body)
        dx, dy = turned(marker.point, angle)
        return x + dx, y + dy

    def direction(self, marker: Marker2D) -> float:
        """Angle of a marker's first axis."""
        return self.frame(marker.body)[1] + marker.angle

    def points_on(self, body: str) -> list[Point]:
        """Where other elements are attached to a body, without repetitions."""
        found = [self.at(m) for element in self.model.elements() for m in element.markers() if m.body == body]
        return list(dict.fromkeys(found))

    def star(self, body: SpatialFrame) -> list[Point]:
        """The line that shows a body in space, on paper."""
        ends = [Marker3D(body=body.name, point=(x, y, z)) for x, y, z in star(self.model, body).tolist()]
        return [self.at(marker) for marker in ends]

    def spheres(self) -> list[Sphere3D]:
        """The balls that bodies in space have for their contacts, each once."""
        found: list[Sphere3D] = []
        for contact in self.model.contacts:
            if isinstance(contact, Contact3D):
                found += contact.spheres()
        return [ball for k, ball in enumerate(found) if ball.radius > 0.0 and ball not in found[:k]]

    def axis(self, body: FlexibleBody) -> list[Point]:
        """Where the points start that a flexible body is drawn by."""
        return [self._point(body, point) for point in body.drawn_points()]

    def _point(self, body: FlexibleBody, point: Point) -> Point:
        """Where a material point starts."""
        shape, q = body.material_point(point), self.start(body.name)
        place = shape.place([q[name] for name in shape.frame or ()] or [0.0] * 3, [q[name] for name in shape.local])
        return place[0], place[1]

    def _size(self) -> float:
        """Diagonal of the box around all bodies, joints and disks, m; 1 for a model that is one point."""
        (x0, y0), (x1, y1) = bounds(self._all_points())
        return math.hypot(x1 - x0, y1 - y0) or 1.0

    def _all_points(self) -> Iterator[Point]:
        for body in self.bodies.values():
            if isinstance(body, PlanarFrame | SpatialFrame):
                yield self.frame(body.name)[0]
            if isinstance(body, FlexibleBody):
                yield from self.axis(body)
            elif isinstance(body, PlanarFrame):
                yield from self.points_on(body.name)
            elif isinstance(body, SpatialFrame):
                yield from self.star(body)
        for element in (*self.model.joints, *self.model.forces, *self.model.contacts):
            for marker in element.markers():
                yield self.at(marker)
        circles: list[tuple[Marker, float]] = [(ball.marker, ball.radius) for ball in self.spheres()]
        circles += [(disk.marker, disk.radius) for contact in self.model.contacts for disk in contact.disks()]
        for joint in self.model.joints:
            if isinstance(joint, Gear2D):
                circles += [(joint.a, joint.radius_a), (joint.b, joint.radius_b)]
        for marker, r in circles:
            x, y = self.at(marker)
            yield from ((x - abs(r), y - abs(r)), (x + abs(r), y + abs(r)))
