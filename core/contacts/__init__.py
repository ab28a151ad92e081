"""Contacts: shapes and gaps, laws, friction, and what happens when they meet. Names: `core/__init__.py`."""

from typing import TYPE_CHECKING, Annotated

from ..lazy_import import RecordsOf, late_names
from ..model.open_union import OpenUnion
from .element import ContactElement

if TYPE_CHECKING:
    from .. import *  # noqa: F403

CONTACTS = RecordsOf(__name__, ContactElement)

Contact = Annotated[ContactElement, OpenUnion(CONTACTS, ContactElement)]
"""Contacts: two shapes, a law along the normal, and friction; a user's own subclasses of Contact2D too."""

__getattr__, __dir__, _ = late_names(__name__)
