"""Base of all model records: frozen, validated, no unknown fields, no NaN."""

from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from ..errors import ModelError


class Record(BaseModel):
    """A validated, immutable piece of a model. JSON in and out; equality by value."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True, ser_json_inf_nan="strings"
    )

    def __init__(self, **data: Any) -> None:
        try:
            super().__init__(**data)
        except ValidationError as error:
            raise ModelError(explain(error)) from None


def explain(error: ValidationError) -> str:
    """One clause a problem: where, what was needed, what was given."""
    clauses = []
    for problem in error.errors():
        place = ".".join(str(part) for part in problem["loc"])
        given = problem.get("input")
        plain = problem["type"] != "value_error" and isinstance(given, str | int | float | bool | None)
        message = problem["msg"].removeprefix("Value error, ")
        clauses.append((f"{place}: " if place else "") + message + (f" (given: {given!r})" if plain else ""))
    return "; ".join(clauses)


Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=60)]
"""A name: letters, digits and underscores, not starting with a digit (it becomes part of channel names)."""

Vector2 = tuple[float, float]
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Restitution = Annotated[float, Field(ge=0.0, le=1.0)]
