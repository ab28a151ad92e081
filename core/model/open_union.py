"""Unions that a user can extend: the records that this library knows, and a user's own subclasses of their base."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from difflib import get_close_matches
from functools import cached_property, reduce
from inspect import get_annotations
from operator import or_
from types import MappingProxyType
from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Field, GetCoreSchemaHandler, GetJsonSchemaHandler, TypeAdapter, ValidationError
from pydantic.fields import FieldInfo
from pydantic_core import CoreSchema, core_schema

from .base import Record, complete


class OpenRecord(Record):
    """Base of records that are told apart by their field `type`, which is the class's name unless it says otherwise."""

    if TYPE_CHECKING:
        type: str

    @classmethod
    def __pydantic_init_subclass__(cls, **kwargs: Any) -> None:
        super().__pydantic_init_subclass__(**kwargs)
        if "type" not in get_annotations(cls):
            # as if the class had said: type: Literal["Name"] = "Name"
            cls.model_fields["type"] = FieldInfo(annotation=Literal[cls.__name__], default=cls.__name__)  # type: ignore[arg-type]
            if cls.__pydantic_complete__:
                cls.model_rebuild(force=True)


_meant: ContextVar[Mapping[str, type[OpenRecord]]] = ContextVar("meant", default=MappingProxyType({}))


@contextmanager
def meaning(classes: Mapping[str, type[OpenRecord]]) -> Iterator[None]:
    """While a model is read here, these names of types mean these classes, whatever else has been defined."""
    token = _meant.set({**_meant.get(), **classes})
    try:
        yield
    finally:
        _meant.reset(token)


def meant_now() -> Mapping[str, type[OpenRecord]]:
    """What `meaning` says here."""
    return _meant.get()


class OpenUnion:
    """Annotation of a field: one of the `known` records by their `type`, or an own subclass of `base`.

    Own records are found by the name of their class (the last definition of a name counts), so that a model with them
    can be read from JSON wherever their class is defined.
    """

    def __init__(self, known: Mapping[str, type[Record]], base: type[OpenRecord]) -> None:
        self.known, self.base = known, base

    def __get_pydantic_core_schema__(self, source: Any, handler: GetCoreSchemaHandler) -> CoreSchema:
        # not the schemas of all that is known: those are made when a record of their kind is first read
        return core_schema.no_info_plain_validator_function(
            self._read,
            # as the record that it is, not as the union: own fields are written too
            serialization=core_schema.simple_ser_schema("any"),
        )

    def __get_pydantic_json_schema__(self, schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        return handler(self._union.core_schema)

    @cached_property
    def _union(self) -> TypeAdapter[Any]:
        """The known records, told apart by pydantic, which knows how to say what is wrong with one of none."""
        union: Any = Annotated[reduce(or_, self.known.values()), Field(discriminator="type")]
        return TypeAdapter(union)

    def _read(self, value: Any) -> Any:
        kind = type(value)
        if isinstance(value, Record) and self.known.get(getattr(value, "type", "")) is kind:
            return value
        if isinstance(value, self.base):
            name = kind.model_fields["type"].default
            if name in self.known:
                raise ValueError(
                    f"type '{name}' is taken by a record of this library, which a model file would be read as: "
                    "give your class another name"
                )
            return value
        if isinstance(value, Mapping) and isinstance(value.get("type"), str):
            if value["type"] not in self.known:
                return self._from_data(value)
            record = self.known[value["type"]]
            complete(record)
            try:
                return record.__pydantic_validator__.validate_python(value)
            except ValidationError:
                pass  # said with the place where it is, below
        return self._union.validator.validate_python(value)

    def _from_data(self, value: Mapping[str, Any]) -> Any:
        name = value["type"]
        own = {record.model_fields["type"].default: record for record in subclasses(self.base)}
        own |= {key: record for key, record in _meant.get().items() if issubclass(record, self.base)}
        if name not in own:
            close = get_close_matches(name, self.known, 1)
            if close:
                raise ValueError(
                    f"there is no type '{name}'; did you mean '{close[0]}'? (An own class must have been imported)"
                )
            known = ", ".join(f"'{each}'" for each in self.known)
            raise ValueError(
                f"type '{name}' is none of {known}, and no class of this name has been defined: "
                f"import the module that defines it (a subclass of {self.base.__name__}) before the model is read"
            )
        return own[name](**value)


def subclasses(base: type[OpenRecord]) -> Iterator[type[OpenRecord]]:
    """All classes that inherit from `base`, in the order of their definition but for depth."""
    for record in base.__subclasses__():
        yield record
        yield from subclasses(record)
