"""Groups of shapes among the data of a model."""

from collections.abc import Mapping
from typing import Any

from .group2d import ContactGroup2D
from .group3d import ContactGroup3D

ContactGroup = ContactGroup2D | ContactGroup3D


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


def _group(data: Mapping[str, Any]) -> ContactGroup:
    """A group in the plane, unless it says otherwise."""
    return ContactGroup3D(**data) if data.get("type") == "ContactGroup3D" else ContactGroup2D(**data)
