"""Gap and sliding speed of a contact as functions of exudyn's coordinates, with their gradients, for user functions.

Written from the geometry, not from the solver's kernels: a cross-check must not share what it checks.
"""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from ...core.contact.contact2d import DiskOnDisk2D, DiskOnHalfPlane2D
from ...core.contact.coordinate_contact import CoordinateContact, CoordinateTerm
from ...core.elements import Cable2D, MaterialPoint2D
from ...core.model.markers import GROUND, Marker2D
from .registry import Build

Array = np.ndarray
Gap = Callable[[Array], tuple[float, Array, Array]]
"""Coordinates (n,) -> (gap, its gradient (n,), gradient of the sliding speed with respect to the rates (n,))."""


@dataclass(frozen=True)
class UserGap:
    """The nodes that a contact depends on, what exudyn's coordinates there are displacements from, and its gap."""

    nodes: tuple[int, ...]
    reference: Array
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
            carrier = build.bodies[_carrier(build, name)]
            each = carrier.coordinates_each or len(carrier.reference)
            for node in items.all_nodes:
                if node in self.slices:
                    continue
                first = carrier.all_nodes.index(node) * each
                self.slices[node] = slice(len(references), len(references) + each)
                self.nodes.append(node)
                references += carrier.reference[first : first + each]
        self.reference = np.array(references)

    def indices(self, nodes: Sequence[int]) -> Array:
        """Where the coordinates of these nodes stand."""
        return np.concatenate([np.arange(self.slices[n].start, self.slices[n].stop) for n in nodes])


def _carrier(build: Build, name: str) -> str:
    record = next(b for b in build.model.bodies if b.name == name)
    return record.body if isinstance(record, MaterialPoint2D) else name


Frame = Callable[[Array], tuple[float, float, float, Array]]
"""Coordinates -> (x, y, angle, their gradients (3, n))."""


def frame_of(build: Build, body: str, nodes: Nodes) -> Frame:
    """Where the frame of a body is, as a function of the coordinates."""
    size = len(nodes.reference)
    if body == GROUND:
        still = np.zeros((3, size))
        return lambda x: (0.0, 0.0, 0.0, still)
    record = next(b for b in build.model.bodies if b.name == body)
    at = nodes.indices(build.bodies[body].all_nodes)
    if not isinstance(record, MaterialPoint2D):
        gradient = np.zeros((3, size))
        gradient[np.arange(len(at)), at] = 1.0
        if len(at) == 2:
            return lambda x: (x[at[0]], x[at[1]], 0.0, gradient)
        return lambda x: (x[at[0]], x[at[1]], x[at[2]], gradient)
    carrier = next(b for b in build.model.bodies if b.name == record.body)
    if not isinstance(carrier, Cable2D):  # refused before, when the point itself was translated
        raise TypeError(f"'{record.body}' is a {type(carrier).__name__}, not a Cable2D")
    length = carrier.length / carrier.elements
    _, s = carrier.find(record.point[0])
    place = np.array([1 - 3 * s**2 + 2 * s**3, length * (s - 2 * s**2 + s**3), 3 * s**2 - 2 * s**3,
                      length * (s**3 - s**2)])  # fmt: skip
    slope = np.array([6 * (s**2 - s) / length, 1 - 4 * s + 3 * s**2, 6 * (s - s**2) / length, 3 * s**2 - 2 * s])
    maps = np.zeros((4, size))
    for k, shape in enumerate((place, slope)):
        maps[2 * k, at[0::2]], maps[2 * k + 1, at[1::2]] = shape, shape

    def frame(x: Array) -> tuple[float, float, float, Array]:
        px, py, tx, ty = maps @ x
        turn = (tx * maps[3] - ty * maps[2]) / (tx * tx + ty * ty)
        return px, py, math.atan2(ty, tx), np.vstack([maps[:2], turn])

    return frame


def user_gap(record: Any, build: Build) -> UserGap:
    """The gap of a contact between planar shapes, or of coordinates."""
    if isinstance(record, CoordinateContact):
        return _coordinate_gap(record, build)
    a, b = record.markers()
    nodes = Nodes(build, (a.body, b.body))
    first, second = (_point(build, marker, nodes) for marker in (a, b))
    shape = _half_plane_gap if isinstance(record, DiskOnHalfPlane2D) else _disk_gap
    return UserGap(tuple(nodes.nodes), nodes.reference, shape(record, first, second))


Point = Callable[[Array], tuple[float, float, float, Array]]


def _point(build: Build, marker: Marker2D, nodes: Nodes) -> Point:
    """(x, y, angle, gradients (3, n)) of a marker's point."""
    frame, (u, w) = frame_of(build, marker.body, nodes), marker.point

    def point(x: Array) -> tuple[float, float, float, Array]:
        px, py, angle, gradient = frame(x)
        if u == 0.0 and w == 0.0:
            return px, py, angle, gradient
        c, s = math.cos(angle), math.sin(angle)
        ax, ay = c * u - s * w, s * u + c * w
        moved = gradient.copy()
        moved[0] -= ay * gradient[2]
        moved[1] += ax * gradient[2]
        return px + ax, py + ay, angle, moved

    return point


def _half_plane_gap(record: DiskOnHalfPlane2D, first: Point, second: Point) -> Gap:
    """Height of the centre over the line; the bodies' material points at the foot of the normal slide past each other.

    Sliding is measured for the line's body at the centre of the disk (on the line's normal) and the disk's rim: with
    the disk in touch that is the place of contact.
    """
    angle, radius = record.plane.marker.angle, record.disk.radius

    def gap(x: Array) -> tuple[float, Array, Array]:
        ax, ay, turn, ga = first(x)
        bx, by, _, gb = second(x)
        tx, ty = math.cos(turn + angle), math.sin(turn + angle)
        nx, ny = -ty, tx
        dx, dy = bx - ax, by - ay
        height, along = nx * dx + ny * dy, tx * dx + ty * dy
        moved = gb - ga
        g_gap = nx * moved[0] + ny * moved[1] - along * ga[2]
        g_slide = tx * moved[0] + ty * moved[1] + (height - radius) * ga[2] + radius * gb[2]
        return height - radius, g_gap, g_slide

    return gap


def _disk_gap(record: DiskOnDisk2D, first: Point, second: Point) -> Gap:
    """Distance of the centres; the rims slide past each other, along the normal turned by -90 degrees."""
    ra, rb = record.a.radius, record.b.radius

    def gap(x: Array) -> tuple[float, Array, Array]:
        ax, ay, _, ga = first(x)
        bx, by, _, gb = second(x)
        dx, dy = bx - ax, by - ay
        distance = math.hypot(dx, dy)
        nx, ny = dx / distance, dy / distance
        moved = gb - ga
        tx, ty = ny, -nx
        # phi' = -(t . d')/distance
        turn = (tx * moved[0] + ty * moved[1]) / distance
        return distance - ra - rb, nx * moved[0] + ny * moved[1], (ra + rb) * turn + ra * ga[2] + rb * gb[2]

    return gap


def _coordinate_gap(record: CoordinateContact, build: Build) -> UserGap:
    used: list[int] = []
    places: dict[tuple[str, str], tuple[int, int]] = {}
    references: dict[int, tuple[float, ...]] = {}
    for body, coordinate in record.moved_coordinates():
        items = build.bodies[body]
        names = next(b for b in build.model.bodies if b.name == body).coordinate_names
        k, each = names.index(coordinate), items.coordinates_each or len(items.reference)
        node = items.all_nodes[k // each]
        places[body, coordinate] = (node, k % each)
        references[node] = items.reference[k - k % each : k - k % each + each]
        if node not in used:
            used.append(node)
    starts, reference = {}, []
    for node in used:
        starts[node] = len(reference)
        reference += references[node]

    def factors(terms: Sequence[CoordinateTerm]) -> Array:
        row = np.zeros(len(reference))
        for term in terms:
            node, k = places[term.body, term.coordinate]
            row[starts[node] + k] += term.factor
        return row

    along, slide, offset = factors(record.terms), factors(record.slide), record.offset
    return UserGap(tuple(used), np.array(reference), lambda x: (offset + float(along @ x), along, slide))
