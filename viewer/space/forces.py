"""Forces in space as arrows: along the normals of contacts, of joints, of applied loads."""

from collections.abc import Callable, Collection
from typing import Any

import numpy as np

from ...core.elements.base import ForceElement
from ...core.model.markers import Marker3D
from ..forces import signals_of
from ..registry import registering
from ..scene import Floats
from .rounds import lowest
from .stage import Stage3D

Values = Callable[[str], Floats | None]
"""A channel over the frames by name, None where there is none."""


def add_forces(stage: Stage3D, values: Values, struck: Collection[str]) -> None:
    """Arrows of what has a place; contacts that never touch have none, those that are `struck` have one although their
    blows are impulses. Friction has no direction among the channels: contacts show their normal force."""
    model = stage.motion.model
    for contact in model.contacts:
        force = values(f"{contact.name}.normal_force")
        if force is None or not (contact.name in struck or np.any(force != 0.0)):
            continue
        found = touch(contact, stage)
        if found is not None:
            stage.arrow(contact.name, "contact", found[0], force[:, None] * found[1])
    for element in (*model.joints, *model.forces):
        arrow = _arrow(element, stage, values)
        if arrow is not None:
            stage.arrow(element.name, "load" if isinstance(element, ForceElement) else "joint", *arrow)


def _arrow(element: Any, stage: Stage3D, values: Values) -> tuple[Floats, Floats] | None:
    """Place and force (F, 3) of the arrow that an element says it has (`Element.arrow`); of those of the plane none."""
    if not all(isinstance(marker, Marker3D) for marker in element.markers()):
        return None
    if element.arrow == "components":
        parts = [part for part in (values(f"{element.name}.force_{c}") for c in "xyz") if part is not None]
        if len(parts) < 3:
            return None
        return stage.at(element.b), np.einsum("fij,fj->fi", stage.axes(element.a), np.stack(parts, axis=1))
    if element.arrow == "tension":
        tension = values(f"{element.name}.tension")
        a, b = stage.at(element.a), stage.at(element.b)
        return None if tension is None else (b, tension[:, None] * _unit(a - b))
    if element.arrow == "signals":
        vector = signals_of(element, stage.motion.model, stage.motion.t, "xyz")
        if element.follower:
            vector = np.einsum("fij,fj->fi", stage.axes(element.marker), vector)
        return (stage.at(element.marker), vector) if np.any(vector != 0.0) else None
    return None


Touch = tuple[Floats, Floats]
"""Places (F, 3) of contact, and unit normals (F, 3) onto what the force acts on."""
Find = Callable[[Any, Stage3D], Touch]
TOUCHES: dict[str, Find] = {}
"""What finds where contacts in space touch, by what their classes say (`ContactElement.touch`)."""


touches = registering(TOUCHES)
"""Decorator: the function finds where contacts of this kind touch, by their fields."""


def touch(contact: Any, stage: Stage3D) -> Touch | None:
    """Where a contact touches, and along which normal; None of one without a place."""
    find = TOUCHES.get(contact.touch)
    return None if find is None else find(contact, stage)


@touches("half-space")
def _half_space(contact: Any, stage: Stage3D) -> Touch:
    normal = stage.axes(contact.plane.marker)[:, :, 2]
    return stage.at(contact.sphere.marker) - contact.sphere.radius * normal, normal


@touches("spheres")
def _spheres(contact: Any, stage: Stage3D) -> Touch:
    a, b = stage.at(contact.a.marker), stage.at(contact.b.marker)
    normal = _unit(b - a)
    return a + contact.a.radius * normal, normal


@touches("support")
def _support(contact: Any, stage: Stage3D) -> Touch:
    normal, marker = stage.axes(contact.plane.marker)[:, :, 2], contact.shape.marker
    return stage.at(marker) + lowest(contact.shape, stage.axes(marker), normal), normal


@touches("hollow")
def _hollow(contact: Any, stage: Stage3D) -> Touch:
    a, b = stage.at(contact.hollow.marker), stage.at(contact.sphere.marker)
    normal = _unit(a - b)
    return a - contact.hollow.radius * normal, normal


@touches("rope")
def _rope(contact: Any, stage: Stage3D) -> Touch:
    a, b = stage.at(contact.a), stage.at(contact.b)
    return b, _unit(a - b)


def _unit(x: Floats) -> Floats:
    """Unit vectors; zero of what has no direction."""
    size = np.linalg.norm(x, axis=1, keepdims=True)
    return np.divide(x, size, out=np.zeros_like(x), where=size > 0.0)
