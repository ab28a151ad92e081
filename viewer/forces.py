"""Forces as arrows: of contacts, joints and applied loads."""

import math
from collections.abc import Callable, Collection, Mapping, Sequence
from typing import Any

import numpy as np

from ..core.compiled.jit import interpreted
from ..core.contacts.contact2d import Disk2D
from ..core.contacts.scalar_contact2d import ScalarContact2D
from ..core.elements.base import ForceElement
from ..core.elements.formula2d import Frame2D, argument_names
from ..core.model.signals import INPUT_SIZE, Signal, evaluate_signal
from ..core.multibody_model import Model
from .bodies import Stage
from .coordinates import coordinate_place
from .registry import registering
from .scene import Arrow, Floats

Values = Callable[[str], Floats | None]
"""A channel over the frames by name, None where there is none."""
Touch = tuple[Floats, Floats]
"""Places (F, 2) of contact, and unit normals (F, 2) onto the disk (of two, disk b)."""
SMALL = 1e-6
"""Of the scene's size, and in rad: by which markers are moved for the gradients of gaps."""
CLOSE = 0.01
"""Of the scene's size: up to which gap the place of a contact is looked for."""
FEW = 20
"""Frames that tell which way a sliding distance grows."""


def add_forces(stage: Stage, values: Values, struck: Collection[str]) -> None:
    """Arrows of everything whose force has a place; contacts that never touch have none, those that are `struck` have
    one although their blows are impulses."""
    model = stage.motion.model
    for contact in model.contacts:
        force, found = values(f"{contact.name}.normal_force"), None
        if force is not None and (contact.name in struck or np.any(force != 0.0)):
            found = touch(contact, stage)
        if force is None or found is None:
            continue
        at, normal = found
        vector = force[:, None] * normal
        friction = values(f"{contact.name}.friction_force")
        if friction is not None and contact.touch != "coordinate":
            right = np.stack([normal[:, 1], -normal[:, 0]], axis=1)
            vector = vector + _slides_right(contact, stage, right) * friction[:, None] * right
        stage.scene.arrows.append(Arrow(contact.name, "contact", "N", at, vector))
    for element in (*model.joints, *model.forces):
        arrow = _arrow(element, stage, values)
        if arrow is not None:
            kind = "load" if isinstance(element, ForceElement) else "joint"
            stage.scene.arrows.append(Arrow(element.name, kind, "N", *arrow))


def _arrow(element: Any, stage: Stage, values: Values) -> tuple[Floats, Floats] | None:
    """Place and force (F, 2) of the arrow that an element says it has (`Element.arrow`)."""
    motion = stage.motion
    if element.arrow == "components":
        x, y = values(f"{element.name}.force_x"), values(f"{element.name}.force_y")
        return None if x is None or y is None else (motion.at(element.b), np.stack([x, y], axis=1))
    if element.arrow == "tension":
        tension = values(f"{element.name}.tension")
        a, b = motion.at(element.a), motion.at(element.b)
        return None if tension is None else (b, tension[:, None] * _unit(a - b))
    if element.arrow == "signals":
        vector = signals_of(element, motion.model, motion.t, "xy")
        if element.follower:
            vector = _turned(vector, motion.direction(element.marker))
        return (motion.at(element.marker), vector) if np.any(vector != 0.0) else None
    return None


def signals_of(element: Any, model: Model, t: Floats, axes: str) -> Floats:
    """The time functions force_x and so on of a load at times (F,); inputs keep their start values."""
    inputs = {channel.name: k for k, channel in enumerate(model.inputs)}
    start = np.array([x for channel in model.inputs for x in (channel.start, *[0.0] * (INPUT_SIZE - 1))])
    return np.stack([signal_values(getattr(element, f"force_{c}"), inputs, start, t) for c in axes], axis=1)


def signal_values(signal: Signal, inputs: dict[str, int], start: Floats, t: Floats) -> Floats:
    """A time function at times (F,); inputs keep their start values."""
    pool, evaluate = np.array(signal.pool(inputs), dtype=float), interpreted(evaluate_signal)
    return np.array([evaluate(pool, start, 0, float(x))[0] for x in t])


Find = Callable[[Any, Stage], Touch | None]
TOUCHES: dict[str, Find] = {}
"""What finds where contacts of the plane touch, by what their classes say (`ContactElement.touch`)."""


touches = registering(TOUCHES)
"""Decorator: the function finds where contacts of this kind touch, by their fields."""


def touch(contact: Any, stage: Stage) -> Touch | None:
    """Where a contact touches, and along which normal; None of one without a place in the plane."""
    find = TOUCHES.get(contact.touch)
    return None if find is None else find(contact, stage)


@touches("half-plane")
def _half_plane(contact: Any, stage: Stage) -> Touch:
    angle = stage.motion.direction(contact.plane.marker) + 0.5 * np.pi
    normal = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return stage.motion.at(contact.disk.marker) - contact.disk.radius * normal, normal


@touches("disks")
def _disks(contact: Any, stage: Stage) -> Touch:
    a, b = stage.motion.at(contact.a.marker), stage.motion.at(contact.b.marker)
    normal = _unit(b - a)
    return a + contact.a.radius * normal, normal


@touches("segment")
def _segment(contact: Any, stage: Stage) -> Touch:
    marker = contact.segment.marker
    start, angle = stage.motion.at(marker), stage.motion.direction(marker)
    end = start + contact.segment.length * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    return _nearest(stage, contact.disk, np.stack([start, end], axis=1))


@touches("line")
def _line(contact: Any, stage: Stage) -> Touch:
    return _nearest(stage, contact.disk, np.stack([stage.motion.at(node) for node in contact.line.nodes], axis=1))


@touches("cable")
def _cable(contact: Any, stage: Stage) -> Touch | None:
    bands = [band for band in stage.scene.bands if band.name == contact.cable]
    return _nearest(stage, contact.disk, bands[0].points) if bands else None


@touches("coordinate")
def _coordinate(contact: Any, stage: Stage) -> Touch | None:
    """Of the last coordinate with a place; the force on it goes its way if its factor is positive."""
    for term in reversed(contact.terms):
        at = coordinate_place(stage, term.body, term.coordinate)
        if at is not None and term.factor:
            axis = (0.0, np.sign(term.factor)) if term.coordinate.startswith("y") else (np.sign(term.factor), 0.0)
            return at, np.tile(axis, (len(at), 1))
    return None


@touches("gap")
def _gap(contact: Any, stage: Stage) -> Touch | None:
    """On the line of action that the gradient of the gap gives: of a disk on its rim, else where that line is nearest
    to the marker that the gap names last; None of one without a direction, such as an angle."""
    last, disk = _last_marker(contact)
    place, gap = stage.motion.at(getattr(contact, last)), contact.formula.gap
    rows = np.flatnonzero(_values(contact, gap, stage, range(len(place))) <= CLOSE * stage.size)
    gradient = np.zeros((len(place), 3))
    gradient[rows] = _gradient(contact, gap, last, stage, rows.tolist())
    square = np.sum(gradient[:, :2] ** 2, axis=1)
    if not np.any(square > 0.0):
        return None
    lever = np.divide(gradient[:, 2], square, out=np.zeros_like(square), where=square > 0.0)
    foot = place + lever[:, None] * np.stack([gradient[:, 1], -gradient[:, 0]], axis=1)
    normal = _unit(gradient[:, :2])
    return foot - (0.0 if disk is None else disk.radius) * normal, normal


def _slides_right(contact: Any, stage: Stage, right: Floats) -> float:
    """-1 where the sliding distance of a contact grows against `right` (F, 2), its normals turned by -90 degrees."""
    if contact.touch != "gap" or contact.formula.slide is None:
        return 1.0
    rows = np.flatnonzero(np.any(right != 0.0, axis=1))
    rows = rows[:: max(1, len(rows) // FEW)]
    along = _gradient(contact, contact.formula.slide, _last_marker(contact)[0], stage, rows.tolist())[:, :2]
    # but for where an angle goes round
    return float(np.sign(np.median(np.sum(along * right[rows], axis=1))))


def _last_marker(contact: ScalarContact2D) -> tuple[str, Disk2D | None]:
    """The marker of a contact's disk by its name in the formulas, else the last one; and the disk."""
    names, disk = contact.arguments().markers, next(iter(contact.disks()), None)
    at = next((name for name in names if disk is not None and getattr(contact, name) == disk.marker), None)
    return (names[-1], None) if at is None else (at, disk)


def _gradient(
    contact: ScalarContact2D, formula: Callable[..., Any], last: str, stage: Stage, rows: Sequence[int]
) -> Floats:
    """Derivatives (N, 3) of a formula by the place and the angle of one of its markers in some frames, by central
    differences."""
    small = (SMALL * stage.size, SMALL * stage.size, SMALL)
    moves = [[x if k == i else 0.0 for i in range(3)] for k, x in enumerate(small)]
    ends = [
        [_values(contact, formula, stage, rows, {last: [way * x for x in move]}) for way in (1.0, -1.0)]
        for move in moves
    ]
    return np.stack([(up - down) / (2.0 * x) for (up, down), x in zip(ends, small, strict=True)], axis=1)


def _values(
    contact: ScalarContact2D, formula: Callable[..., Any], stage: Stage, rows: Sequence[int],
    moves: Mapping[str, Sequence[float]] | None = None,
) -> Floats:  # fmt: skip
    """A formula of a contact in some frames (N,), markers moved by so much (x, y, angle)."""
    names, frames = argument_names(formula), {}
    for name in contact.arguments().markers:
        marker = getattr(contact, name)
        place = np.column_stack([stage.motion.at(marker), stage.motion.direction(marker)])[rows]
        moved = place + (moves or {}).get(name, (0.0, 0.0, 0.0))
        frames[name] = [Frame2D(x, y, w, math.cos(w), math.sin(w)) for x, y, w in moved.tolist()]
    fixed = {name: [float(getattr(contact, name))] * len(rows) for name in names if name not in frames}
    given = {**fixed, **frames}
    return np.array([formula(*row) for row in zip(*(given[name] for name in names), strict=True)], dtype=float)


def _nearest(stage: Stage, disk: Disk2D, line: Floats) -> Touch:
    """Of a disk on a line through points (F, P, 2), as it is drawn."""
    centre = stage.motion.at(disk.marker)
    a, d = line[:, :-1], np.diff(line, axis=1)
    square = np.sum(d * d, axis=2)
    along = np.sum((centre[:, None] - a) * d, axis=2)
    part = np.clip(np.divide(along, square, out=np.zeros_like(along), where=square > 0.0), 0.0, 1.0)
    places = a + part[..., None] * d
    best = np.argmin(np.sum((places - centre[:, None]) ** 2, axis=2), axis=1)
    rows = np.arange(len(centre))
    foot = places[rows, best]
    normal = _unit(centre - foot)
    return centre - disk.radius * normal, normal


def _unit(x: Floats) -> Floats:
    """Unit vectors; zero of what has no direction."""
    size = np.linalg.norm(x, axis=1, keepdims=True)
    return np.divide(x, size, out=np.zeros_like(x), where=size > 0.0)


def _turned(vector: Floats, angle: Floats) -> Floats:
    c, s = np.cos(angle), np.sin(angle)
    return np.stack([c * vector[:, 0] - s * vector[:, 1], s * vector[:, 0] + c * vector[:, 1]], axis=1)
