"""End stops of joints in space, and ropes: user functions, as the contacts of spheres (`space_contacts.py`)."""

import math

from ...core.contacts.stop3d import AngleStop3D, DistanceStop3D, Rope3D, SlideStop3D
from ..errors import NotTranslatable
from .contact_laws import is_native
from .registry import Build, translates
from .space_contacts import Arc, End, SpaceForce, Touch, Vector, check_bodies, dot, plus, vector
from .springs3d import keeps_axes
from .user_contacts import Force, Numbers, add_user_contact
from .user_gaps import Nodes, UserGap


@translates(SlideStop3D, Rope3D, DistanceStop3D)
def slide_stop(record: SlideStop3D | Rope3D | DistanceStop3D, build: Build) -> None:
    """A user function. Raises NotTranslatable for constraint contact."""
    is_native(record, on_flexible=False)
    check_bodies(record, build)
    nodes = Nodes(build, (record.a.body, record.b.body))
    ends = End(build, record.a, nodes), End(build, record.b, nodes)
    if isinstance(record, SlideStop3D):
        touch = _along(*ends, vector(record.a.axes()[:, 2]), record.limit, record.sign)
    else:
        touch = _apart(*ends, record.bound, record.sign)
    gap = UserGap(tuple(nodes.nodes), nodes.reference, lambda x: (touch(x)[0], [], []))
    add_user_contact(record, build, SpaceForce(record, gap, touch, *ends))


@translates(AngleStop3D)
def angle_stop(record: AngleStop3D, build: Build) -> None:
    """A user function; the angle is that within half a turn of the limit.

    Raises NotTranslatable for constraint contact, and unless a hinge keeps the z axes of both markers together.
    """
    is_native(record, on_flexible=False)
    check_bodies(record, build)
    if not any(keeps_axes(joint, record.a, record.b) for joint in build.model.joints):
        raise NotTranslatable(
            f"the axes of '{record.name}' are not held together by a Revolute3D or a Cylindrical3D about them: this "
            "stop is written for a hinge"
        )
    nodes = Nodes(build, (record.a.body, record.b.body))
    a, b = End(build, record.a, nodes), End(build, record.b, nodes)
    (x_a, y_a, z_a), x_b = (vector(axis) for axis in record.a.axes().T), vector(record.b.axes()[:, 0])
    limit, sign = record.limit, record.sign

    def evaluate(x: Numbers) -> tuple[float, list[float], list[float]]:
        way, axis = b.turned(x, x_b), a.turned(x, z_a)
        angle = math.atan2(dot(way, a.turned(x, y_a)), dot(way, a.turned(x, x_a)))
        row = [0.0] * len(x)
        b.add_turn(row, x, axis, -sign)
        a.add_turn(row, x, axis, sign)
        return sign * math.remainder(limit - angle, 2.0 * math.pi), row, [0.0] * len(x)

    add_user_contact(record, build, Force(record, UserGap(tuple(nodes.nodes), nodes.reference, evaluate)))


def _along(a: End, b: End, axis: Vector, limit: float, sign: float) -> Touch:
    """sign (limit - z_a.(x_b - x_a)); matter of a at the place of b says how the axis turns."""

    def touch(x: Numbers) -> tuple[float, Vector, tuple[Arc, ...]]:
        z, place = a.turned(x, axis), b.place(x)
        reach = dot(z, plus(place, a.place(x), -1.0))
        return sign * (limit - reach), (-sign * z[0], -sign * z[1], -sign * z[2]), ((place, place, 1.0),)

    return touch


def _apart(a: End, b: End, limit: float, sign: float) -> Touch:
    """sign (limit - |x_b - x_a|)."""

    def touch(x: Numbers) -> tuple[float, Vector, tuple[Arc, ...]]:
        first, second = a.place(x), b.place(x)
        way = plus(second, first, -1.0)
        distance = math.hypot(*way)
        normal = -sign * way[0] / distance, -sign * way[1] / distance, -sign * way[2] / distance
        return sign * (limit - distance), normal, ((first, second, 1.0),)

    return touch
