"""Base of all model records: frozen, validated, no unknown fields, no NaN."""

import inspect
import threading
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, Annotated, Any, get_args, get_origin

import numpy as np
from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    GetJsonSchemaHandler,
    ValidationError,
    WithJsonSchema,
    model_validator,
)
from pydantic_core import CoreSchema

from ..errors import ModelError
from .explain import A_LIST, explain, problems_of, shown

if TYPE_CHECKING:
    from pydantic._internal._model_construction import ModelMetaclass
else:
    ModelMetaclass = type(BaseModel)


_BUILDING = threading.RLock()
_builds = threading.local()


def complete(record: type[BaseModel]) -> None:
    """Let pydantic make what reads and checks a record. That takes a millisecond each, and few kinds are used by one
    process, so it is left until a record is made; by one thread at a time, since pydantic does not see to that."""
    if not record.__pydantic_complete__:
        with _BUILDING:
            _builds.busy = True
            try:
                record.model_rebuild()
            finally:
                _builds.busy = False


class _DescribesItself(ModelMetaclass):
    """Class of the classes of records: their docstring, for `help()`, ends with their fields. It is made when it is
    asked for, since that reads their source."""

    if not TYPE_CHECKING:

        @property
        def __doc__(cls) -> str | None:
            from .fields import described

            own = vars(cls).get("__doc__")
            known = "__pydantic_fields__" in vars(cls) and not getattr(_builds, "busy", False)
            text = described(cls) if known else ""
            return f"{inspect.cleandoc(own or '')}\n\n{text}" if text else own


class Record(BaseModel, metaclass=_DescribesItself):
    """A validated, immutable piece of a model. JSON in and out; equality by value."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, ser_json_inf_nan="strings", defer_build=True
    )

    def __init__(self, /, *values: Any, **data: Any) -> None:
        kind = type(self)
        complete(kind)
        if values:
            fields = [name for name in kind.model_fields if name != "type"]
            raise ModelError(
                f"{kind.__name__} takes its fields by name, not by position (given: {', '.join(map(repr, values))}): "
                f"write {kind.__name__}({', '.join(f'{name}=...' for name in fields[: len(values)])}); its fields are "
                f"{fields}"
            )
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ModelError(explain(error, kind, data), problems_of(error, kind, data)) from None

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        from .fields import fields_of

        schema = handler(core_schema)
        own = handler.resolve_ref_schema(schema)
        if "description" in own:  # the class without its fields, which have their own
            own["description"] = inspect.cleandoc(vars(cls).get("__doc__") or "")
        properties = own.get("properties", {})
        for field in fields_of(cls):
            if field.name in properties:
                properties[field.name].setdefault("description", field.description)
                if field.unit:
                    properties[field.name]["unit"] = field.unit
        return schema

    @model_validator(mode="before")
    @classmethod
    def _refuse_slips(cls, data: Any) -> Any:
        """pydantic would read the text '3' as 3, True as 1 and a record as the list of its fields: slips of the pen."""
        if isinstance(data, Mapping):
            for name in _number_fields(cls) & data.keys():
                _refuse_no_number(name, data[name])
            for name in _list_fields(cls) & data.keys():
                if isinstance(data[name], BaseModel):
                    raise ValueError(f"{name}: {A_LIST} (given: {shown(data[name])})")
        return data


def _refuse_no_number(place: str, value: Any) -> None:
    """Raise ValueError for a text or a truth value, alone or among the entries of a sequence."""
    if isinstance(value, str | bytes):
        raise ValueError(f"{place}: a number is needed, not the text {value!r}: write it without quotes")
    if isinstance(value, bool | np.bool_):
        raise ValueError(f"{place}: a number is needed, not the truth value {value!r}")
    if isinstance(value, list | tuple):
        for k, entry in enumerate(value):
            _refuse_no_number(f"{place}.{k}", entry)


@cache
def _number_fields(record: type[BaseModel]) -> frozenset[str]:
    """Names of the fields that hold a number, a sequence of numbers, or None."""
    leaves = {name: _leaves(field.annotation) for name, field in record.model_fields.items()}
    return frozenset(name for name, found in leaves.items() if found & {int, float} and not found & {str, bool})


@cache
def _list_fields(record: type[BaseModel]) -> frozenset[str]:
    """Names of the fields that hold a sequence."""
    fields = {name: field.annotation for name, field in record.model_fields.items()}
    return frozenset(n for n, a in fields.items() if any(get_origin(part) is tuple for part in (a, *get_args(a))))


def _leaves(annotation: Any) -> set[type]:
    """The plain types that an annotation is made of."""
    if isinstance(annotation, type) and not get_args(annotation):
        return {annotation}
    return {leaf for part in get_args(annotation) for leaf in _leaves(part)}


Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=60)]
"""A name: letters, digits and underscores, not starting with a digit (it becomes part of channel names)."""

Vector2 = tuple[float, float]
Vector3 = tuple[float, float, float]


def in_space(vector: Sequence[float]) -> Vector3:
    """A vector of two or three components in space: copies of records are not validated and may hold two."""
    x, y, z = (*vector, 0.0)[:3]
    return x, y, z


Gravity = Annotated[
    tuple[float, ...],
    Field(min_length=3, max_length=3),
    BeforeValidator(lambda g: (*g, 0.0) if isinstance(g, list | tuple) and len(g) == 2 else g),
    WithJsonSchema({"type": "array", "items": {"type": "number"}, "minItems": 2, "maxItems": 3}),
]
"""A vector whose third component may be left out: models of the plane have no use for it."""
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Restitution = Annotated[float, Field(ge=0.0, le=1.0)]
