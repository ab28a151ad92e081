"""Joints, forces and planes in space as solids and links."""

from collections.abc import Callable
from typing import Any

import numpy as np

from ...core.contacts.contact3d import HalfSpace3D
from ...core.model.markers import GROUND, Marker3D
from ..fixtures import kind_of_spring
from ..registry import registering
from ..scene import Floats
from . import meshes
from .colours import BASE, FLOOR, JOINT, WIRE
from .stage import Stage3D

PIN, KNUCKLE, BAR, BLOCK = 0.018, 0.022, 0.009, 0.03
"""Radii of hinges, balls and guides, and half the edge of blocks, in parts of the scene's size."""
MARGIN = 0.12
"""By which planes and guides go beyond what moves on them."""
FIELDS = 12
"""Of a plane, along its longer edge, about."""


Draw = Callable[[Any, Stage3D], None]
SYMBOLS: dict[str, Draw] = {}
"""What draws elements in space, by their `symbol`. It finds by their names the fields of the element that it needs:
markers a and b, a radius."""


symbol = registering(SYMBOLS)
"""Decorator: the function draws elements in space with this symbol."""


def place(element: Any, stage: Stage3D) -> None:
    """Put an element in space into the scene; what has no symbol there stays out, as what is of the plane does."""
    draw = SYMBOLS.get(element.symbol)
    if draw is not None and all(isinstance(marker, Marker3D) for marker in element.markers()):
        draw(element, stage)


@symbol("ball")
def _ball(element: Any, stage: Stage3D) -> None:
    stage.solid(element.b, meshes.ball(), (KNUCKLE * stage.size,) * 3, JOINT)
    _support(element, stage)


@symbol("pin")
def _pin(element: Any, stage: Stage3D) -> None:
    u = stage.size
    stage.solid(element.b, meshes.cylinder(), (PIN * u, PIN * u, 0.08 * u), JOINT)
    _support(element, stage)


@symbol("cross")
def _cross(element: Any, stage: Stage3D) -> None:
    """The x axis of a, the y axis of b."""
    u = 0.6 * PIN * stage.size
    for marker, along in ((element.a, (1.0, 0.0, 0.0)), (element.b, (0.0, 1.0, 0.0))):
        way = 0.045 * stage.size * (marker.axes() @ np.array(along))
        ends = [np.array(marker.point) + sign * way for sign in (-1.0, 1.0)]
        (xa, ya, za), (xb, yb, zb) = (end.tolist() for end in ends)
        stage.rod(marker.body, (xa, ya, za), (xb, yb, zb), u, meshes.cylinder(), JOINT)
    _support(element, stage)


@symbol("block")
def _block(element: Any, stage: Stage3D) -> None:
    stage.solid(element.b, meshes.box(), (1.2 * BLOCK * stage.size,) * 3, JOINT)
    _support(element, stage)


def _bar(element: Any, stage: Stage3D) -> None:
    """Along the z axis of a, as long as its way."""
    u = stage.size
    along = np.sum((stage.at(element.b) - stage.at(element.a)) * stage.axes(element.a)[:, :, 2], axis=1)
    low, high = min(0.0, float(along.min())) - MARGIN * u, max(0.0, float(along.max())) + MARGIN * u
    radius = BAR * u
    stage.solid(element.a, meshes.cylinder(), (radius, radius, high - low), BASE, shift=(0.0, 0.0, 0.5 * (low + high)))


@symbol("sleeve")
def _sleeve(element: Any, stage: Stage3D) -> None:
    _bar(element, stage)
    stage.solid(element.b, meshes.cylinder(), (BLOCK * stage.size, BLOCK * stage.size, 3.0 * BLOCK * stage.size), JOINT)


@symbol("slider")
def _slider(element: Any, stage: Stage3D) -> None:
    _bar(element, stage)
    u = BLOCK * stage.size
    stage.solid(element.b, meshes.box(), (2.0 * u, 2.0 * u, 3.0 * u), JOINT)


@symbol("bead")
def _bead(element: Any, stage: Stage3D) -> None:
    _bar(element, stage)
    stage.solid(element.b, meshes.ball(), (KNUCKLE * stage.size,) * 3, JOINT)


@symbol("pane")
def _on_pane(element: Any, stage: Stage3D) -> None:
    """A pane that shines through, where b moves on it."""
    away = stage.at(element.b) - stage.at(element.a)
    local = np.einsum("fi,fij->fj", away, stage.axes(element.a))[:, :2]
    low, high = np.minimum(local.min(axis=0), 0.0), np.maximum(local.max(axis=0), 0.0)
    _pane(stage, element.a, low, high, 0.35)
    stage.solid(element.b, meshes.ball(), (KNUCKLE * stage.size,) * 3, JOINT)


@symbol("rod")
def _rod(element: Any, stage: Stage3D) -> None:
    stage.link(element.name, "rod", element.a, element.b)
    for marker in (element.a, element.b):
        stage.solid(marker, meshes.ball(), (0.7 * KNUCKLE * stage.size,) * 3, JOINT)
    _support(element, stage)


@symbol("clamp")
def _clamp(element: Any, stage: Stage3D) -> None:
    colour = BASE if element.marker.body == GROUND else JOINT
    stage.solid(element.marker, meshes.box(), (BLOCK * stage.size,) * 3, colour)


@symbol("rolling-sphere")
def _rolling_sphere(element: Any, stage: Stage3D) -> None:
    stage.solid(element.b, meshes.ball(), (element.radius,) * 3)
    add_plane(stage, element.a)


@symbol("rolling-disk")
def _rolling_disk(element: Any, stage: Stage3D) -> None:
    r = element.radius
    stage.solid(element.b, meshes.cylinder(marked=True), (r, r, max(2.0 * element.rim_radius, 0.06 * r)))
    add_plane(stage, element.a)


@symbol("gears")
def _gears(element: Any, stage: Stage3D) -> None:
    for marker, radius in ((element.wheel_a, element.radius_a), (element.wheel_b, element.radius_b)):
        r, thick = abs(radius), 0.04 * stage.size
        stage.solid(marker, meshes.cylinder(marked=True), (r, r, thick), opacity=1.0 if radius > 0.0 else 0.3)


@symbol("rack")
def _rack(element: Any, stage: Stage3D) -> None:
    r, u = abs(element.radius), stage.size
    stage.solid(element.wheel, meshes.cylinder(marked=True), (r, r, 0.04 * u))
    stage.solid(element.rack, meshes.box(), (BLOCK * u, BLOCK * u, 6.0 * r), JOINT)


@symbol("spring")
def _spring(element: Any, stage: Stage3D) -> None:
    """Between its markers; about the axis that it turns."""
    if getattr(element, "measure", "distance") == "angle":
        _coil(element.a, stage)
        return
    stage.link(element.name, kind_of_spring(element), *element.markers()[:2])
    _support(element, stage)


@symbol("actuator")
def _actuator(element: Any, stage: Stage3D) -> None:
    """A cylinder between its ends; a drum about the axis that it turns."""
    if element.measure == "angle":
        u = 1.6 * PIN * stage.size
        stage.solid(element.b, meshes.cylinder(), (u, u, 0.05 * stage.size), WIRE)
    else:
        stage.link(element.name, "damper", element.a, element.b)
        _support(element, stage)


@symbol("coil")
def _turning_spring(element: Any, stage: Stage3D) -> None:
    _coil(element.a, stage)


def _coil(marker: Marker3D, stage: Stage3D) -> None:
    u = 0.032 * stage.size
    stage.solid(marker, meshes.coil(), (u, u, 0.05 * stage.size), WIRE, shift=(0.0, 0.0, -0.025 * stage.size))


@symbol("bushing")
def _bushing(element: Any, stage: Stage3D) -> None:
    stage.solid(element.b, meshes.ball(), (0.035 * stage.size,) * 3, WIRE, opacity=0.55)
    _support(element, stage)


@symbol("rope")
def _rope(element: Any, stage: Stage3D) -> None:
    stage.link(element.name, "rope", element.a, element.b)
    _support(element, stage)


@symbol("shapes")
def _shapes(element: Any, stage: Stage3D) -> None:
    """The planes: what touches them is drawn with its body (`shapes.py`)."""
    for shape in element.shapes():
        if isinstance(shape, HalfSpace3D):
            add_plane(stage, shape.marker)


def _support(element: Any, stage: Stage3D) -> None:
    """A block where something is held by the ground."""
    for marker in element.markers()[:2]:
        if marker.body == GROUND:
            edge = 1.5 * BLOCK * stage.size
            stage.solid(Marker3D(point=marker.point), meshes.box(), (edge, edge, edge), BASE)


def add_plane(stage: Stage3D, marker: Marker3D) -> None:
    """A plane, once; it is drawn when all else is there."""
    if marker not in stage.planes:
        stage.planes.append(marker)


def add_planes(stage: Stage3D, places: Floats) -> None:
    """The planes, as far as anything of the scene (places (N, 3)) comes."""
    for marker in stage.planes:
        origin, axes = stage.at(marker)[0], stage.axes(marker)[0]
        local = np.concatenate([(places - origin) @ axes, np.zeros((1, 3))])[:, :2]
        _pane(stage, marker, local.min(axis=0), local.max(axis=0), 1.0)


def _pane(stage: Stage3D, marker: Marker3D, low: Any, high: Any, opacity: float) -> None:
    low, high = low - MARGIN * stage.size, high + MARGIN * stage.size
    wide, deep = (high - low).tolist()
    field = max(wide, deep) / FIELDS
    cells = max(1, round(wide / field)), max(1, round(deep / field))
    x, y = (0.5 * (low + high)).tolist()
    stage.solid(marker, meshes.checkered(*cells), (wide, deep, 1.0), FLOOR, shift=(x, y, 0.0), opacity=opacity)
