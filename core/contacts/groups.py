"""Groups of shapes among the data of a model."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from ..lazy_import import RecordsOf
from ..model.base import Name
from ..model.open_union import OpenRecord, OpenUnion
from .element import ContactElement
from .shape import Shape


class ContactGroup(OpenRecord):
    """Base of the groups."""

    name: Name
    """Names of its contacts begin with it."""

    def all_shapes(self) -> Sequence[Shape]:
        """The shapes of all of its fields that hold some, in their order."""
        values = (getattr(self, name) for name in type(self).model_fields)
        return [shape for value in values if isinstance(value, tuple) for shape in value if isinstance(shape, Shape)]

    def contacts(self) -> Sequence[ContactElement]:
        """Its contacts."""
        raise NotImplementedError(f"{type(self).__name__} must make its contacts")


GROUPS = RecordsOf(str(__package__), ContactGroup)
Group = Annotated[ContactGroup, OpenUnion(GROUPS, ContactGroup)]


def with_groups(data: Mapping[str, Any]) -> Mapping[str, Any]:
    """The data of a model with the contacts of its `groups` among its `contacts`, made anew where they are there.

    Raises
    ------
    ModelError : for a group that is none.
    """
    given = data.get("groups")
    if not given or not isinstance(given, list | tuple):
        return data
    groups = [g if isinstance(g, ContactGroup) else _group(g) for g in given]
    made = [contact for group in groups for contact in group.contacts()]
    names = {contact.name for contact in made}
    others = [c for c in data.get("contacts", ()) if _name(c) not in names]
    return {**data, "groups": groups, "contacts": [*others, *made]}


def _name(contact: Any) -> Any:
    return contact.get("name") if isinstance(contact, Mapping) else getattr(contact, "name", None)


def _group(data: Mapping[str, Any]) -> Any:
    """A group in the plane, unless it says otherwise."""
    return GROUPS["ContactGroup3D" if data.get("type") == "ContactGroup3D" else "ContactGroup2D"](**data)
