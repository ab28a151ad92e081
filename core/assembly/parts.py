"""What the solver's tables are made of: a description knows the tables, and these know only the parts that it has."""

from collections.abc import Iterator, Sequence
from typing import Protocol

from ..contacts import Contact
from ..contacts.element import ContactElement
from ..elements.base import BodyElement, Element
from ..model.channels import Input
from ..model.outputs import MarkerOutput


class Parts(Protocol):
    """The parts of a `Model`."""

    @property
    def name(self) -> str: ...

    @property
    def gravity(self) -> tuple[float, ...]: ...

    @property
    def bodies(self) -> Sequence[BodyElement]: ...

    @property
    def contacts(self) -> Sequence[Contact]: ...

    @property
    def inputs(self) -> Sequence[Input]: ...

    @property
    def outputs(self) -> Sequence[MarkerOutput]: ...

    def elements(self) -> Iterator[Element]:
        """All elements in the order bodies, joints, forces, contacts."""
        ...


class TabulatedElements:
    """The elements of a model as they stand in the tables: those that are contacts behind all others.

    Parameters
    ----------
    parts : the model. A force with a set-valued law is in the tables as a contact, behind the model's own.
    """

    def __init__(self, parts: Parts) -> None:
        own = {contact.name for contact in parts.contacts}
        others: list[Element] = []
        more: list[ContactElement] = []
        for element in parts.elements():
            contact = element.as_contact()
            if contact is None:
                others.append(element)
            elif element.name not in own:
                more.append(contact)
        self.contacts: tuple[ContactElement, ...] = (*parts.contacts, *more)
        self.all: tuple[Element, ...] = (*others, *self.contacts)
