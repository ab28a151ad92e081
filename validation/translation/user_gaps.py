"""Gap and sliding speed of a contact as functions of exudyn's coordinates, with their gradients, for user functions.

Written from the geometry, not from the solver's kernels: a cross-check must not share what it checks.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from operator import mul
from typing import Any

import numpy as np

from ...core.contacts.contact2d import DiskOnDisk2D, DiskOnHalfPlane2D
from ...core.contacts.coordinate_contact import CoordinateContact, CoordinateTerm
from ...core.elements import Cable2D, MaterialPoint2D
from ...core.model.markers import GROUND, Marker2D
from ..errors import NotTranslatable
from .registry import Build

Numbers = Sequence[float]
Gap = Callable[[Numbers], tuple[float, list[float], list[float]]]
"""Coordinates (n,) -> (gap, its gradient (n,), gradient of the sliding speed with respect to the rates (n,)).

Plain lists: exudyn calls this several times a step, and for a handful of numbers arrays cost more than they save.
"""


@dataclass(frozen=True)
class UserGap:
    """The nodes that a contact depends on, what exudyn's coordinates there are displacements from, and its gap."""

    nodes: tuple[int, ...]
    reference: list[float]
    evaluate: Gap


class Nodes:
    """The nodes of some bodies, each once, and where their coordinates stand in exudyn's vector."""

    def __init__(self, build: Build, bodies: Sequence[str]) -> None:
        self.nodes: list[int] = []
        self.slices: dict[int, slice] = {}
        references: list[float] = []
        for name in dict.fromkeys(bodies):
            if name == GROUND:
                continue
            items = build.bodies[name]
            carrier = items if items.reference else build.bodies[_carrier(build, name)]
            parts = carrier.node_slices()
            for node in items.all_nodes:
                if node in self.slices:
                    continue
                own = carrier.reference[parts[node]]
                self.slices[node] = slice(len(references), len(references) + len(own))
                self.nodes.append(node)
                references += own
        self.reference = references

    def indices(self, nodes: Sequence[int]) -> list[int]:
        """Where the coordinates of these nodes stand."""
        return [k for n in nodes for k in range(self.slices[n].start, self.slices[n].stop)]

    def place(self, build: Build, body: str, coordinate: str) -> int:
        """Where a coordinate of a body stands. Raises NotTranslatable if the body has no such one of its own."""
        record = next(b for b in build.model.bodies if b.name == body)
        items = build.bodies[body]
        if coordinate not in record.coordinate_names or not items.reference:
            raise NotTranslatable(f"'{coordinate}' of '{body}' is no coordinate there")
        node, k, _ = items.place(record.coordinate_names.index(coordinate))
        return self.slices[node].start + k


def _carrier(build: Build, name: str) -> str:
    record = next(b for b in build.model.bodies if b.name == name)
    return record.body if isinstance(record, MaterialPoint2D) else name


Add = Callable[[list[float], float, float, float], None]
"""(gradient, c_x, c_y, c_angle): adds c_x grad x + c_y grad y + c_angle grad angle to it."""
Frame = Callable[[Numbers], tuple[float, float, float, Add]]
"""Coordinates -> (x, y, angle, how their gradients are added)."""


def frame_of(build: Build, body: str, nodes: Nodes) -> Frame:
    """Where the frame of a body is, as a function of the coordinates."""
    if body == GROUND:
        return lambda x: (0.0, 0.0, 0.0, lambda gradient, cx, cy, ca: None)
    record = next(b for b in build.model.bodies if b.name == body)
    items = build.bodies[body]
    at = nodes.indices(items.all_nodes)
    if items.reference:  # coordinates of its own, unlike a point of a cable
        return _rigid_frame([at[k] for k in items.order[:3]] or at)
    assert isinstance(record, MaterialPoint2D)
    carrier = next(b for b in build.model.bodies if b.name == record.body)
    if not isinstance(carrier, Cable2D):  # refused before, when the point itself was translated
        raise TypeError(f"'{record.body}' is a {type(carrier).__name__}, not a Cable2D")
    return _cable_frame(carrier, record.point[0], at, len(nodes.reference))


def _rigid_frame(at: list[int]) -> Frame:
    i, j = at[:2]
    if len(at) == 2:

        def push(gradient: list[float], cx: float, cy: float, ca: float) -> None:
            gradient[i] += cx
            gradient[j] += cy

        return lambda x: (x[i], x[j], 0.0, push)
    k = at[2]

    def add(gradient: list[float], cx: float, cy: float, ca: float) -> None:
        gradient[i] += cx
        gradient[j] += cy
        gradient[k] += ca

    return lambda x: (x[i], x[j], x[k], add)


def _cable_frame(cable: Cable2D, point: float, at: list[int], size: int) -> Frame:
    length = cable.length / cable.elements
    _, s = cable.find(point)
    place = (1 - 3 * s**2 + 2 * s**3, length * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3, length * (s**3 - s**2))
    slope = (6 * (s**2 - s) / length, 1 - 4 * s + 3 * s**2, 6 * (s - s**2) / length, 3 * s**2 - 2 * s)
    maps = np.zeros((4, size))
    for k, shape in enumerate((place, slope)):
        maps[2 * k, at[0::2]], maps[2 * k + 1, at[1::2]] = shape, shape

    def frame(x: Numbers) -> tuple[float, float, float, Add]:
        px, py, tx, ty = (float(value) for value in maps @ np.asarray(x))
        turn = (tx * maps[3] - ty * maps[2]) / (tx * tx + ty * ty)

        def add(gradient: list[float], cx: float, cy: float, ca: float) -> None:
            for k, value in enumerate(cx * maps[0] + cy * maps[1] + ca * turn):
                gradient[k] += float(value)

        return px, py, math.atan2(ty, tx), add

    return frame


GapMaker = Callable[[Any, Build, Nodes], Gap]
_MAKERS: dict[type, GapMaker] = {}


def gap_of(record: type) -> Callable[[GapMaker], GapMaker]:
    """Decorator: the function makes the gap of contacts of this type; it takes record, build and nodes."""

    def register(function: GapMaker) -> GapMaker:
        _MAKERS[record] = function
        return function

    return register


def user_gap(record: Any, build: Build) -> UserGap:
    """The gap of a contact between planar shapes, or of coordinates."""
    if isinstance(record, CoordinateContact):
        return _coordinate_gap(record, build)
    nodes = Nodes(build, [marker.body for marker in record.markers()])
    return UserGap(tuple(nodes.nodes), nodes.reference, _MAKERS[type(record)](record, build, nodes))


Point = Callable[[Numbers], tuple[float, float, float, float, float, Add]]


def point_of(build: Build, marker: Marker2D, nodes: Nodes) -> Point:
    """(x, y, angle of the frame, the point's arm in the directions of space, how the frame's gradients are added)."""
    frame, (u, w) = frame_of(build, marker.body, nodes), marker.point

    def point(x: Numbers) -> tuple[float, float, float, float, float, Add]:
        px, py, angle, add = frame(x)
        if u == 0.0 and w == 0.0:
            return px, py, angle, 0.0, 0.0, add
        c, s = math.cos(angle), math.sin(angle)
        ox, oy = c * u - s * w, s * u + c * w
        return px + ox, py + oy, angle, ox, oy, add

    return point


@gap_of(DiskOnHalfPlane2D)
def _half_plane_gap(record: DiskOnHalfPlane2D, build: Build, nodes: Nodes) -> Gap:
    """Height of the centre over the line; what slides past each other are the disk's rim and the point of the line's
    body that is there while they touch."""
    first, second = (point_of(build, shape.marker, nodes) for shape in (record.plane, record.disk))
    angle, radius, size = record.plane.marker.angle, record.disk.radius, len(nodes.reference)

    def gap(x: Numbers) -> tuple[float, list[float], list[float]]:
        ax, ay, turn, aox, aoy, add_a = first(x)
        bx, by, _, box, boy, add_b = second(x)
        tx, ty = math.cos(turn + angle), math.sin(turn + angle)
        nx, ny = -ty, tx
        dx, dy = bx - ax, by - ay
        height, along = nx * dx + ny * dy, tx * dx + ty * dy
        normal, slide = [0.0] * size, [0.0] * size
        add_b(normal, nx, ny, ny * box - nx * boy)
        add_a(normal, -nx, -ny, nx * aoy - ny * aox - along)
        add_b(slide, tx, ty, ty * box - tx * boy + radius)
        add_a(slide, -tx, -ty, tx * aoy - ty * aox + height - radius)
        return height - radius, normal, slide

    return gap


@gap_of(DiskOnDisk2D)
def _disk_gap(record: DiskOnDisk2D, build: Build, nodes: Nodes) -> Gap:
    """Distance of the centres; the rims slide past each other, along the normal turned by -90 degrees."""
    first, second = (point_of(build, disk.marker, nodes) for disk in (record.a, record.b))
    ra, rb, size = record.a.radius, record.b.radius, len(nodes.reference)

    def gap(x: Numbers) -> tuple[float, list[float], list[float]]:
        ax, ay, _, aox, aoy, add_a = first(x)
        bx, by, _, box, boy, add_b = second(x)
        dx, dy = bx - ax, by - ay
        distance = math.hypot(dx, dy)
        nx, ny = dx / distance, dy / distance
        # along t = (n_y, -n_x); the direction of the normal turns by -(t . d')/distance
        share = (ra + rb) / distance
        tx, ty = share * ny, -share * nx
        normal, slide = [0.0] * size, [0.0] * size
        add_b(normal, nx, ny, ny * box - nx * boy)
        add_a(normal, -nx, -ny, nx * aoy - ny * aox)
        add_b(slide, tx, ty, ty * box - tx * boy + rb)
        add_a(slide, -tx, -ty, tx * aoy - ty * aox + ra)
        return distance - ra - rb, normal, slide

    return gap


def _coordinate_gap(record: CoordinateContact, build: Build) -> UserGap:
    used: list[int] = []
    places: dict[tuple[str, str], tuple[int, int]] = {}
    references: dict[int, tuple[float, ...]] = {}
    for body, coordinate in record.moved_coordinates():
        items = build.bodies[body]
        names = next(b for b in build.model.bodies if b.name == body).coordinate_names
        node, k, _ = items.place(names.index(coordinate))
        places[body, coordinate] = (node, k)
        references[node] = items.reference[items.node_slices()[node]]
        if node not in used:
            used.append(node)
    starts: dict[int, int] = {}
    reference: list[float] = []
    for node in used:
        starts[node] = len(reference)
        reference += references[node]

    def factors(terms: Sequence[CoordinateTerm]) -> list[float]:
        row = [0.0] * len(reference)
        for term in terms:
            node, k = places[term.body, term.coordinate]
            row[starts[node] + k] += term.factor
        return row

    along, slide, offset = factors(record.terms), factors(record.slide), record.offset
    return UserGap(tuple(used), list(reference), lambda x: (offset + sum(map(mul, along, x)), along, slide))
