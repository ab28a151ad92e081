"""Kernels that are made from formulas, for the library of machine code: of each record that has a `form_key`."""

from collections.abc import Iterator
from typing import Any

from pydantic import BaseModel, TypeAdapter, ValidationError

from ..contacts import CONTACTS
from ..contacts.contact2d import Disk2D
from ..contacts.element import ContactElement
from ..elements import FORCES, JOINTS
from ..elements.base import Form
from ..elements.formula2d import form_name
from ..errors import ModelError
from ..laws import KelvinVoigt, NewtonImpact
from ..laws.friction import CoulombFriction, LuGreFriction
from ..model.markers import Marker2D
from ..model.signals import Constant

A, B = Marker2D(), Marker2D(body="b")
CORNERS = ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
CANDIDATES = (1.0, Constant(value=0.0), CORNERS)
"""Values for fields that must be given, on which the code does not depend: the first that fits is taken."""
RUBBED = CoulombFriction(coefficient=0.5)
BRISTLED = LuGreFriction(coefficient=0.5, stribeck_speed=1.0, bristle_stiffness=1.0)
LAWS: tuple[dict[str, Any], ...] = (
    {"law": NewtonImpact(restitution=0.0)},
    {"law": NewtonImpact(restitution=0.0), "friction": RUBBED},
    {"law": KelvinVoigt(stiffness=1.0, damping=0.0), "friction": BRISTLED},
)


def _examples() -> Iterator[Any]:
    """Of each record with a kernel from formulas one for each kernel: by friction."""
    for record in (*JOINTS.values(), *FORCES.values(), *CONTACTS.values()):
        if not hasattr(record, "form_key"):
            continue
        for law in LAWS if issubclass(record, ContactElement) else ({},):
            if "friction" not in law or record.formula.slide is not None:
                yield _example(record, A, **law)


def _example(record: type[BaseModel], marker: Marker2D, **more: Any) -> Any:
    """A record with values for all fields that it needs. Raises ModelError for one of which none of CANDIDATES fits."""
    values = {"name": "example", "marker": marker, "a": marker, "b": B, **more}
    given = {name: value for name, value in values.items() if name in record.model_fields}
    for name, field in record.model_fields.items():
        if name in given or not field.is_required():
            continue
        kind: Any = field.annotation
        if isinstance(kind, type) and issubclass(kind, BaseModel):
            given[name] = _example(kind, B if kind is Disk2D else A)
            continue
        for value in CANDIDATES:
            try:
                given[name] = TypeAdapter(kind).validate_python(value)
                break
            except ValidationError:
                continue
        else:
            raise ModelError(
                f"nothing says what `{name}` of an example of {record.__name__} could be: add it to CANDIDATES"
            )
    return record(**given)


def forms() -> dict[str, Form]:
    """Kernels that are made from formulas, with their patterns, by their names in the library."""
    found = {}
    for example in _examples():
        kind, formulas = example.form_key()
        found[form_name(kind, formulas, example.arguments())] = example.form()
    return found
