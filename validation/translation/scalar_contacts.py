"""Contacts whose gap is one number of two markers: stops, ropes, disks in rings, on boxes and on polygons.

exudyn has none of them: each is a user function (`user_contacts.py`) with a gap written here from the geometry.
"""

import math
from collections.abc import Sequence

from ...core.contacts.angle_stop2d import AngleStop2D
from ...core.contacts.contact2d import Contact2D
from ...core.contacts.disk_on_box2d import DiskOnBox2D
from ...core.contacts.polygon2d import DiskOnPolygon2D
from ...core.contacts.ring2d import DiskInRing2D
from ...core.contacts.rope2d import Rope2D
from .contact_laws import contact_parameters
from .measures import Measure, angle, direction, distance, place_of, scalar
from .registry import Build, translates
from .user_contacts import add_user_contact
from .user_gaps import Gap, Nodes, Numbers, gap_of


@translates(AngleStop2D, Rope2D, DiskInRing2D, DiskOnBox2D, DiskOnPolygon2D)
def scalar_contact(record: Contact2D, build: Build) -> None:
    """A user function."""
    contact_parameters(record.law, record.name)
    add_user_contact(record, build)


def _one_sided(record: AngleStop2D | Rope2D, build: Build, nodes: Nodes, measure: Measure, limit: float,
               sign: float) -> Gap:  # fmt: skip
    """sign (limit - measure); nothing slides."""
    value, still = scalar(build, record.a, record.b, measure, nodes), [0.0] * len(nodes.reference)

    def gap(x: Numbers) -> tuple[float, list[float], list[float]]:
        found, gradient = value(x)
        return sign * (limit - found), [-sign * g for g in gradient], still

    return gap


@gap_of(AngleStop2D)
def _stop_gap(record: AngleStop2D, build: Build, nodes: Nodes) -> Gap:
    return _one_sided(record, build, nodes, angle, record.limit, 1.0 if record.side == "upper" else -1.0)


@gap_of(Rope2D)
def _rope_gap(record: Rope2D, build: Build, nodes: Nodes) -> Gap:
    return _one_sided(record, build, nodes, distance, record.length, 1.0)


@gap_of(DiskInRing2D)
def _ring_gap(record: DiskInRing2D, build: Build, nodes: Nodes) -> Gap:
    """Difference of the radii less the distance of the centres; the arcs on ring and disk slide past each other."""
    ring, disk = (place_of(build, shape.marker, nodes) for shape in (record.shape, record.disk))
    outer, inner = record.shape.radius, record.disk.radius

    def gap(x: Numbers) -> tuple[float, list[float], list[float]]:
        a, b = ring(x), disk(x)
        normal, sliding = [0.0] * len(x), [0.0] * len(x)
        apart = distance(a, b, normal)
        if apart > 0.0:
            direction(a, b, sliding, outer - inner)
        a.push(sliding, 0.0, 0.0, -outer)
        b.push(sliding, 0.0, 0.0, inner)
        return outer - inner - apart, [-g for g in normal], sliding

    return gap


@gap_of(DiskOnBox2D)
def _box_gap(record: DiskOnBox2D, build: Build, nodes: Nodes) -> Gap:
    u, w = 0.5 * record.shape.width, 0.5 * record.shape.height
    return _outline_gap(record, build, nodes, ((u, w), (-u, w), (-u, -w), (u, -w)))


@gap_of(DiskOnPolygon2D)
def _polygon_gap(record: DiskOnPolygon2D, build: Build, nodes: Nodes) -> Gap:
    return _outline_gap(record, build, nodes, record.shape.vertices)


def _outline_gap(record: DiskOnBox2D | DiskOnPolygon2D, build: Build, nodes: Nodes,
                 corners: Sequence[tuple[float, float]]) -> Gap:  # fmt: skip
    """Distance of the disk's centre from the nearest point of a convex outline, whose corners go counter-clockwise.

    What slides are the outline, counter-clockwise, and the rim of the disk. About a corner the centre goes on a circle,
    and its way counts on one of the disk's radius.
    """
    body, disk = (place_of(build, shape.marker, nodes) for shape in (record.shape, record.disk))
    radius, sides = record.disk.radius, list(zip(corners, (*corners[1:], corners[0]), strict=True))

    def gap(x: Numbers) -> tuple[float, list[float], list[float]]:
        a, b = body(x), disk(x)
        c, s = math.cos(a.angle), math.sin(a.angle)
        dx, dy = b.x - a.x, b.y - a.y
        height, (nx, ny), share = _nearest(c * dx + s * dy, c * dy - s * dx, sides, radius)
        nx, ny = c * nx - s * ny, s * nx + c * ny
        tx, ty = -ny, nx
        normal, sliding = [0.0] * len(x), [0.0] * len(x)
        b.push(normal, nx, ny)
        a.push(normal, -nx, -ny, nx * dy - ny * dx)
        b.push(sliding, share * tx, share * ty, -radius)
        a.push(sliding, -share * tx, -share * ty, share * (tx * dy - ty * dx) + radius)
        return height - radius, normal, sliding

    return gap


def _nearest(x: float, y: float, sides: Sequence[tuple[tuple[float, float], tuple[float, float]]],
             radius: float) -> tuple[float, tuple[float, float], float]:  # fmt: skip
    """(distance from the outline, below zero inside; normal away from it; share of the centre's way that slides)."""
    inside: tuple[float, tuple[float, float]] = (-math.inf, (0.0, 0.0))
    outside: tuple[float, tuple[float, float], float] | None = None
    for (x0, y0), (x1, y1) in sides:
        length = math.hypot(x1 - x0, y1 - y0)
        ex, ey = (x1 - x0) / length, (y1 - y0) / length
        height, along = ey * (x - x0) - ex * (y - y0), ex * (x - x0) + ey * (y - y0)
        if height > inside[0]:
            inside = height, (ey, -ex)
        if height <= 0.0:
            continue
        if 0.0 <= along <= length:
            found = height, (ey, -ex), 1.0
        else:
            px, py = (x0, y0) if along < 0.0 else (x1, y1)
            reach = math.hypot(x - px, y - py)
            found = reach, ((x - px) / reach, (y - py) / reach), radius / reach
        if outside is None or found[0] < outside[0]:
            outside = found
    return outside if outside is not None else (*inside, 1.0)
