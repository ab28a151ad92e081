"""What the solver's tables are made of: a description knows the tables, and these know only the parts that it has."""

from collections.abc import Iterator, Sequence
from typing import Protocol

from ..contacts import Contact
from ..contacts.element import ContactElement
from ..elements.base import BodyElement, Element
from ..elements.joint_friction import JointFrictionForce
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
        others: list[Element] = []
        more: list[ContactElement] = []
        for element in parts.elements():
            if isinstance(element, JointFrictionForce) and element.is_contact:
                more += _contacts_of(element)
            elif not isinstance(element, ContactElement):
                others.append(element)
        self.contacts: tuple[ContactElement, ...] = (*parts.contacts, *more)
        self.all: tuple[Element, ...] = (*others, *self.contacts)


def _contacts_of(friction: JointFrictionForce) -> Sequence[ContactElement]:
    # few models have any, and kernels take time to import
    if friction.is_spherical:
        from ..contacts.spherical_friction3d import contacts_of

        return contacts_of(friction)
    from ..contacts.joint_friction_contact import contact_of

    return (contact_of(friction),)
