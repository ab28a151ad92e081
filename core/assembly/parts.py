"""What the solver's tables are made of: a description knows the tables, and these know only the parts that it has."""

from collections.abc import Iterator, Sequence
from typing import Protocol

from ..contacts import Contact
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
