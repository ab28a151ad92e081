"""Base of all model records: frozen, validated, no unknown fields, no NaN."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field


class Record(BaseModel):
    """A validated, immutable piece of a model. JSON in and out; equality by value."""

    model_config = ConfigDict(
        frozen=True, extra="forbid", allow_inf_nan=False, use_attribute_docstrings=True, ser_json_inf_nan="strings"
    )


Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]*$", max_length=60)]
"""A name: letters, digits and underscores, not starting with a digit (it becomes part of channel names)."""

Vector2 = tuple[float, float]
Positive = Annotated[float, Field(gt=0.0)]
NonNegative = Annotated[float, Field(ge=0.0)]
Restitution = Annotated[float, Field(ge=0.0, le=1.0)]
