"""Model files that declare numbers: parameters with a value, formulas, comments; and what is said of mistakes."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from tlismni.core import Model, ModelError, PointMass2D, RigidBody2D, simulate, simulate_many
from tlismni.core.model.arithmetic import evaluate, names_in
from tlismni.core.model.channels import Formula, Parameter
from tlismni.core.model.files import line_of

ROD = """\
# a rod on a pin; all else follows from two numbers
name: rod
parameters:
  - {name: mass, value: 2e0, unit: kg, description: mass of the rod, minimum: 0.1}
  - {name: length, value: 1.5, unit: m}
bodies:
  - type: RigidBody2D
    name: rod
    mass: = mass
    inertia: = mass * length**2 / 12
    position: [= length / 2, 0]    # it starts level
joints:
  - {type: Revolute2D, name: pin, a: {}, b: {body: rod, point: [= -length / 2, 0]}}
"""


def rod() -> Model:
    pytest.importorskip("ruamel.yaml")
    return Model.from_yaml(ROD)


def data() -> dict[str, Any]:
    pytest.importorskip("ruamel.yaml")
    from ruamel.yaml import YAML

    found: dict[str, Any] = YAML(typ="safe", pure=True).load(ROD)
    return found


def test_formulas_put_numbers_where_they_belong() -> None:
    (body,), (pin,) = rod().bodies, rod().joints
    assert (body.mass, body.inertia, body.position) == (2.0, 2.0 * 1.5**2 / 12.0, (0.75, 0.0))
    assert pin.b.point == (-0.75, 0.0)


def test_another_length_changes_all_that_follows_and_the_motion_with_it() -> None:
    """The period of small swings of a rod goes with the root of its length: t_end scaled so, the angle is the same."""
    short, long = rod(), rod().with_parameters({"length": 6.0})
    assert long.bodies[0].inertia == pytest.approx(16.0 * short.bodies[0].inertia)
    angles = [simulate(m, t, rtol=1e-9)["rod.angle"][-1] for m, t in ((short, 0.4), (long, 0.8))]
    assert angles[0] == pytest.approx(angles[1], abs=1e-7)


def test_a_mass_declared_in_a_file_is_a_column_of_many_runs() -> None:
    runs = simulate_many(rod(), {"length": np.array([1.5, 6.0])}, 0.4)
    assert not runs.failures
    single = simulate(rod().with_parameters({"length": 6.0}), 0.4)["rod.angle"][-1]
    assert runs["rod.angle"][1] == single


def test_json_and_yaml_are_the_same_model(tmp_path: Path) -> None:
    model = rod()
    assert Model.from_json(json.dumps(data())) == model
    for name in ("rod.yaml", "rod.yml", "rod.json"):
        model.save(tmp_path / name)
        again = Model.load(tmp_path / name)
        assert again == model and again.with_parameters({"mass": 3.0}).bodies[0].inertia == 3.0 * 1.5**2 / 12.0


def test_python_takes_formulas_too() -> None:
    model = Model(
        bodies=[RigidBody2D(name="rod", mass=1.0, inertia=1.0)],
        parameters=[Parameter(name="m", value=3.0, targets=("rod.mass", "gravity.1"))],
        formulas=[Formula(target="rod.inertia", formula="m / 6")],
    )
    assert (model.bodies[0].mass, model.bodies[0].inertia, model.gravity[1]) == (3.0, 0.5, 3.0)


def test_a_parameter_without_value_is_what_stands_at_its_target() -> None:
    ball = PointMass2D(name="ball", mass=2.0, position=(1.0, 4.0))
    model = Model(bodies=[ball], parameters=[Parameter(name="height", targets=("ball.position.1",))])
    assert model.parameter_value("height") == 4.0
    assert model.with_parameters({"height": 5.0, "ball.position.0": 7.0}).bodies[0].position == (7.0, 5.0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("mass: = mass", "mass: = mas"), "line 9: .*'mas', which is no parameter .did you mean 'mass'"),
        (("length**2", "length^2"), r"'\^' is no arithmetic here: write a power with '\*\*'"),
        (("= mass * length**2 / 12", "= open('x')"), "there is no function 'open'"),
        (("= mass * length**2 / 12", "= mass / 0"), "has no value: float division by zero"),
        (("inertia:", "inertai:"), "line 10: .*no such field; did you mean 'inertia'"),
        (("body: rod", "body: rodd"), "line 13: .*body 'rodd', which does not exist"),
        (("value: 2e0", "value: 0.01"), "line 4: .*parameter 'mass' = 0.01 is outside its range"),
        (("value: 1.5", "value: none"), "line 10: .*parameter 'length', which has no value: give it"),
        (("value: 1.5, ", ""), "parameter 'length', which has no value: give it"),
        (("    name: rod", "    name: rod\n    name: rod"), "not YAML: .*duplicate key"),
        (("mass: = mass", "mass: -1"), "line 9: RigidBody2D 'rod': mass: must be greater than 0"),
        (("[= length / 2, 0]", "[= length / 2, 0, 3, 4]"), "line 11: .*position: takes at most 2"),
    ],
)
def test_mistakes_are_named_with_line_and_remedy(change: tuple[str, str], said: str, tmp_path: Path) -> None:
    pytest.importorskip("ruamel.yaml")
    assert change[0] in ROD
    (tmp_path / "rod.yaml").write_text(ROD.replace(*change), encoding="utf-8")
    with pytest.raises(ModelError, match=said):
        Model.load(tmp_path / "rod.yaml")


def test_each_of_several_mistakes_has_its_line(tmp_path: Path) -> None:
    pytest.importorskip("ruamel.yaml")
    path = tmp_path / "rod.yaml"
    path.write_text(
        ROD.replace("mass: = mass", "mass: -1").replace("type: Revolute2D", "type: Revolut2D"), encoding="utf-8"
    )
    with pytest.raises(ModelError, match=r"line 9: .*; line 13: ") as caught:
        Model.load(path)
    assert len(caught.value.problems) == 2


def test_what_a_formula_sets_is_not_set_by_its_place() -> None:
    with pytest.raises(ModelError, match=r"'rod.inertia' follows from the formula 'mass \* length"):
        rod().with_parameters({"rod.inertia": 1.0})


def test_one_place_has_one_source() -> None:
    found = data()
    found["parameters"].append({"name": "other", "value": 1.0, "targets": ["rod.mass"]})
    with pytest.raises(ModelError, match=r"'rod.mass' is set twice"):
        Model.from_json(json.dumps(found))


def test_json_says_where_comments_may_stand(tmp_path: Path) -> None:
    (tmp_path / "m.json").write_text('{"name": "m" // a name\n}', encoding="utf-8")
    with pytest.raises(ModelError, match="comments are for YAML"):
        Model.load(tmp_path / "m.json")
    with pytest.raises(ModelError, match=r"\['name'\] stand twice"):
        Model.from_json('{"name": "m", "name": "n"}')


def test_yaml_that_repeats_itself_without_end_is_refused() -> None:
    pytest.importorskip("ruamel.yaml")
    rows = ["a0: &a0 [1, 1, 1, 1, 1, 1, 1, 1, 1, 1]"]
    rows += [f"a{k}: &a{k} [{', '.join([f'*a{k - 1}'] * 10)}]" for k in range(1, 9)]
    with pytest.raises(ModelError, match="repeats its parts"):
        Model.from_yaml("\n".join(rows))


@given(st.floats(-1e3, 1e3), st.floats(-1e3, 1e3))
def test_arithmetic_is_that_of_python(a: float, b: float) -> None:
    numbers = {"a": a, "b": b}
    for text in ("a + b*2", "-a - (b - 1)/4", "sqrt(abs(a)) * cos(b)", "hypot(a, b)", "min(a, b) + max(a, 2*pi)"):
        expected = eval(text, {**vars(__import__("math")), "abs": abs, "min": min, "max": max}, numbers)
        assert evaluate(text, numbers) == pytest.approx(expected, rel=1e-15, abs=1e-300)
    assert names_in("hypot(a, b) + pi*a") == ("a", "b")


@pytest.mark.parametrize(
    "text",
    ["__import__('os').system('x')", "a.b", "[1]", "lambda: 1", "a if a else b", "'x'", "True", "1e999", "a and b",
     "sqrt(-1)", "sqrt()", "(" * 300 + ")" * 300, "9**9**9**9", "f'{a}'", "a := 1", "sqrt(x=1)", "0x" + "f" * 400, ""],
)  # fmt: skip
def test_what_is_no_arithmetic_is_refused(text: str) -> None:
    with pytest.raises(ValueError, match="formula"):
        evaluate(text, {"a": 1.0, "b": 1.0})


def test_lines_are_found_in_json_too() -> None:
    pytest.importorskip("ruamel.yaml")
    assert line_of('{\n "bodies": [\n  {"name": "a"},\n  {"name": "b",\n   "mass": -1}]}', ("bodies", 1, "mass")) == 5
    assert line_of("not: [valid", ("not",)) is None
