"""The moving surface of one body of a group: every contact with that body has it."""

from collections.abc import Sequence
from typing import cast

import numpy as np

from ..errors import ModelError
from ..model.base import Vector3
from ..model.markers import Marker3D
from ..model.signals import Signal
from .contact2d import Contact2D
from .contact3d import Contact3D


def with_surface(
    name: str, contacts: Sequence[Contact2D | Contact3D], speed: float | Signal | None, direction: Vector3 | None,
    body: str | None,
) -> tuple[Contact2D | Contact3D, ...]:  # fmt: skip
    """The contacts of group `name`, those with `body` on a surface that moves at `speed`; in space along `direction`,
    in the frame of the body.

    Raises
    ------
    ModelError : for a speed without a body, or a body without a speed or without contacts.
    """
    if speed is None and body is None and direction is None:
        return tuple(contacts)
    if speed is None or body is None:
        raise ModelError(
            f"group '{name}' has a surface that moves, with surface_speed {speed!r} and surface_body {body!r}: give "
            "both, how fast it moves and which body it belongs to"
        )
    made = [_on_surface(contact, speed, direction, body) for contact in contacts]
    if not any(contact.surface_speed is not None for contact in made):
        raise ModelError(
            f"group '{name}' has no contact of '{body}', whose surface is to move: mend the name in surface_body"
        )
    return tuple(made)


def _on_surface(
    contact: Contact2D | Contact3D, speed: float | Signal, direction: Vector3 | None, body: str
) -> Contact2D | Contact3D:
    bodies = [marker.body for marker in contact.markers()]
    if body not in bodies:
        return contact
    data = {name: getattr(contact, name) for name in type(contact).model_fields}
    data["surface_speed"] = speed
    if isinstance(contact, Contact3D):
        data["surface_body"] = body
        if direction is not None:
            axes = cast(Marker3D, contact.markers()[bodies.index(body)]).axes()
            data["surface_direction"] = tuple((axes.T @ np.array(direction, dtype=np.float64)).tolist())
    return type(contact)(**data)
