"""The body that an element names, where it must be one of a certain kind."""

from collections.abc import Mapping
from typing import TypeVar

from ..model.words import an
from .base import BodyElement

Body = TypeVar("Body", bound=BodyElement)


def body_named(user: str, place: str, name: str, kind: type[Body], bodies: Mapping[str, BodyElement]) -> Body:
    """The body `name` of this `kind`, which the element `user` is at a `place` of ("at a point").

    Raises ValueError if there is none.
    """
    body = bodies.get(name)
    if not isinstance(body, kind):
        found = sorted(other for other, b in bodies.items() if isinstance(b, kind))
        what = "does not exist" if body is None else f"is {an(type(body).__name__)}"
        raise ValueError(f"'{user}' is {place} of '{name}', which {what}: name a {kind.__name__} "
                         f"({found or 'there is none yet'}), or use a Marker3D on a rigid body")  # fmt: skip
    return body
