"""Every field of a model file says what it is and in which unit, in one place for help(), schema and docs."""

import pydoc
from pathlib import Path

import pytest
from tlismni.core import Model, RigidBody2D
from tlismni.core.model.fields import fields_of, records, unit_in

UNITS_DEPEND = {
    # on what they belong to: a coordinate, an input, a parameter, what a signal drives, or an entry of a matrix
    "Axes": {"x", "z"}, "Bushing3D": {"stiffness", "damping"}, "Cable2D": {"shape"},
    "Cable3D": {"shape"}, "Constant": {"value"},
    "CoordinateContact": {"offset"}, "CoordinateRelation": {"offset"}, "CoordinateTerm": {"factor"},
    "Input": {"start"}, "InputSignal": {"gain"},
    "EulerParameters": {"values"}, "FloatingBeam2D": {"amplitudes", "amplitude_rates", "damping_ratio"},
    "Gear3D": {"radius_a", "radius_b"}, "Parameter": {"value", "minimum", "maximum"}, "Polynomial": {"coefficients"},
    "Ramp": {"before", "after"}, "RelationTerm": {"factor"},
    "PIDController2D": {"gain", "integral_gain", "rate_gain", "largest"},
    "PIDController3D": {"gain", "integral_gain", "rate_gain", "largest"},
    "Servo2D": {"gain", "rate_gain", "largest"}, "Servo3D": {"gain", "rate_gain", "largest"},
    "TableSpring3D": {"lengths_table", "forces", "damping"},
    "Sine": {"amplitude", "offset"}, "Step": {"before", "after"}, "Table": {"values"},
}  # fmt: skip
MATRICES = {"Interface3D", "LinearSystem", "ReducedBody2D", "ReducedBody3D", "ReducedPoint"}


RECORDS = records(Model)


@pytest.mark.parametrize("name", RECORDS)
def test_every_field_has_words_and_every_number_a_unit(name: str) -> None:
    for field in fields_of(RECORDS[name]):
        assert field.description, f"{name}.{field.name}: write a docstring below it"
        number = "number" in field.kind and "whole" not in field.kind
        if number and name not in MATRICES and field.name not in UNITS_DEPEND.get(name, ()):
            assert field.unit, f"{name}.{field.name}: '{field.description}' names no unit"


@pytest.mark.parametrize(
    ("text", "unit"),
    [("Mass, kg.", "kg"), ("m.", "m"), ("EI, N m^2; 0 is a thread.", "N m^2"), ("mu, dimensionless.", "1"),
     ("K, N/m^(3/2).", "N/m^(3/2)"), ("Name of the body.", ""), ("m/s; a contact that closes.", "m/s")],
)  # fmt: skip
def test_units_are_read_from_words(text: str, unit: str) -> None:
    assert unit_in(text) == unit


def test_help_and_schema_say_the_same() -> None:
    shown = pydoc.render_doc(RigidBody2D, renderer=pydoc.plaintext)
    inertia = Model.model_json_schema()["$defs"]["RigidBody2D"]["properties"]["inertia"]
    assert inertia["description"] in shown and inertia["unit"] == "kg m^2"
    assert "Fields" not in Model.model_json_schema()["$defs"]["RigidBody2D"]["description"]


def test_the_page_of_fields_is_the_present_one() -> None:
    pytest.importorskip("typer")
    from tlismni.cli.fields_page import page

    written = (Path(__file__).parents[2] / "docs" / "model-fields.md").read_text(encoding="utf-8")
    assert written == page(RECORDS), "write it anew: tlismni fields --markdown > docs/model-fields.md"


def test_types_of_one_name_are_all_there() -> None:
    """A `Step` is a signal and a law of friction, an `Input` a channel and a signal."""
    schema = Model.model_json_schema()["$defs"]
    assert {record.__name__ for record in RECORDS.values()} == {"Model", *schema}
    assert RECORDS["Step"].__name__ == "Step" and "StepFriction" in RECORDS
    assert RECORDS["Input"].__name__ == "Input" and "InputSignal" in RECORDS
