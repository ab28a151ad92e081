"""Forces in space as arrows: along the normals of contacts, of joints, of applied loads."""

from collections.abc import Callable, Collection

import numpy as np

from ...core.contacts.contact3d import SphereOnHalfSpace3D, SphereOnSphere3D
from ...core.contacts.round3d import SmoothOnHalfSpace3D, SphereInSphere3D
from ...core.contacts.stop3d import Rope3D
from ...core.elements import AppliedForce3D, Distance3D, Joint3D
from ...core.model.signals import INPUT_SIZE
from ..forces import signal_values
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
    for joint in model.joints:
        parts = [values(f"{joint.name}.force_{c}") for c in "xyz"]
        if isinstance(joint, Joint3D) and all(part is not None for part in parts):
            own = np.stack([part for part in parts if part is not None], axis=1)
            vector = np.einsum("fij,fj->fi", stage.axes(joint.a), own)
            stage.arrow(joint.name, "joint", stage.at(joint.b), vector)
        elif isinstance(joint, Distance3D):
            tension = values(f"{joint.name}.tension")
            if tension is not None:
                pull = _unit(stage.at(joint.a) - stage.at(joint.b))
                stage.arrow(joint.name, "joint", stage.at(joint.b), tension[:, None] * pull)
    inputs = {channel.name: k for k, channel in enumerate(model.inputs)}
    start = np.array([x for channel in model.inputs for x in (channel.start, *[0.0] * (INPUT_SIZE - 1))])
    for load in model.forces:
        if isinstance(load, AppliedForce3D):
            signals = (load.force_x, load.force_y, load.force_z)
            vector = np.stack([signal_values(s, inputs, start, stage.motion.t) for s in signals], axis=1)
            if load.follower:
                vector = np.einsum("fij,fj->fi", stage.axes(load.marker), vector)
            if np.any(vector != 0.0):
                stage.arrow(load.name, "load", stage.at(load.marker), vector)


def touch(contact: object, stage: Stage3D) -> tuple[Floats, Floats] | None:
    """Where a contact touches (F, 3), and the unit normal onto what the force acts on; None of one without a place."""
    if isinstance(contact, SphereOnHalfSpace3D):
        normal = stage.axes(contact.plane.marker)[:, :, 2]
        return stage.at(contact.sphere.marker) - contact.sphere.radius * normal, normal
    if isinstance(contact, SphereOnSphere3D):
        a, b = stage.at(contact.a.marker), stage.at(contact.b.marker)
        normal = _unit(b - a)
        return a + contact.a.radius * normal, normal
    if isinstance(contact, SmoothOnHalfSpace3D):
        normal, marker = stage.axes(contact.plane.marker)[:, :, 2], contact.shape.marker
        return stage.at(marker) + lowest(contact.shape, stage.axes(marker), normal), normal
    if isinstance(contact, SphereInSphere3D):
        a, b = stage.at(contact.hollow.marker), stage.at(contact.sphere.marker)
        normal = _unit(a - b)
        return a - contact.hollow.radius * normal, normal
    if isinstance(contact, Rope3D):
        a, b = stage.at(contact.a), stage.at(contact.b)
        return b, _unit(a - b)
    return None


def _unit(x: Floats) -> Floats:
    """Unit vectors; zero of what has no direction."""
    size = np.linalg.norm(x, axis=1, keepdims=True)
    return np.divide(x, size, out=np.zeros_like(x), where=size > 0.0)
