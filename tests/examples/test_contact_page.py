"""The page on contact and friction: its code runs and gives what it says, its tables name what there is."""

import math
import re
from dataclasses import fields
from pathlib import Path
from typing import Any

import pytest
from tlismni.core import Event
from tlismni.core.laws import ImpactLaw, NewtonImpact, PoissonImpact

PAGE = (Path(__file__).parents[2] / "docs" / "contact.md").read_text()


def test_the_code_runs() -> None:
    names: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE, re.S):
        exec(block, names)
    (closed, rolls) = names["rolling"].events
    assert (closed.kind, rolls.kind) == ("close", "stick")
    assert rolls.t == pytest.approx(0.1699, abs=5e-5) and rolls.t == pytest.approx(1.5 / (0.9 * 9.81), abs=1e-9)
    assert names["rolling"]["ball.vx"][-1] == pytest.approx(1.0, rel=1e-9)
    assert names["at_once"] == pytest.approx([-1.0 / 3.0, 2.0 / 3.0, 2.0 / 3.0], rel=1e-12)
    assert names["poisson"] == pytest.approx(names["at_once"], rel=1e-12)
    assert names["in_turn"] == pytest.approx([0.0, 0.0, 1.0], abs=1e-12)
    assert names["stick"].t == pytest.approx(1.5 / (0.3 * 9.81), abs=1e-9)
    assert names["stopped"]["b.x"][-1] == pytest.approx(1.5**2 / (0.6 * 9.81), rel=1e-9)
    assert names["stopped"]["shoe.dissipation"][-1] == pytest.approx(1.5**2, rel=1e-9)
    assert names["reason"].startswith("contact 'shoe', t = 0 s: Painleve's paradox. Sliding with mu = 1.4, ")
    assert math.isclose(
        (1.0 + 3.0 * math.cos(names["a"]) ** 2) / (3.0 * math.sin(names["a"]) * math.cos(names["a"])), 4 / 3
    )


def test_the_page_on_load_sharing_runs() -> None:
    page = Path(__file__).parents[2] / "docs" / "load-sharing.md"
    names: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", page.read_text(), re.S):
        exec(block, names)
    result = names["result"]
    assert [result[f"foot{i}.normal_force"][-1] for i in range(4)] == pytest.approx([9.81 / 4] * 4, rel=1e-8)
    stops = 0.02 * 10.0 / (0.3 * 9.81 * 0.125)
    assert max(event.t for event in result.events if event.kind == "stick") == pytest.approx(stops, rel=1e-4)
    hung, weight = names["hung"], 20.0 * 9.81
    friction = [abs(names["held"][f"{name}.friction_force"][-1]) for name in ("steel", "rubber")]
    assert friction == pytest.approx([4.5, 1.5], rel=1e-8)
    shares = [names["hinged"][f"{name}.force_z"][-1] for name in ("low", "high")]
    assert shares == pytest.approx([0.75 * weight, 0.25 * weight], rel=1e-9)
    assert [hung[f"hinge{i}.force_z"][-1] for i in range(2)] == pytest.approx([0.5 * weight] * 2, rel=1e-9)
    moments = sum(hung[f"hinge{i}.torque_y"][-1] + (-0.7, 0.7)[i] * hung[f"hinge{i}.force_x"][-1] for i in range(2))
    assert abs(moments) == pytest.approx(0.4 * weight, rel=1e-9)


def test_the_page_on_the_friction_of_joints_runs() -> None:
    page = Path(__file__).parents[2] / "docs" / "joint-friction.md"
    names: dict[str, Any] = {}
    found = []
    for block in re.findall(r"```python\n(.*?)```", page.read_text(), re.S):
        exec(block, names)
        found.append(names["event"].t)
    assert found[0] == pytest.approx(4.8, abs=1e-9)
    assert found[-1] == pytest.approx(0.5 * math.hypot(0.3, 1.0, 2.0) / 2.0, rel=1e-6)
    held, fell = names["turned"]
    assert abs(held) < 1e-15 and fell < -1e-6


def test_the_page_on_surfaces_that_move_runs() -> None:
    page = Path(__file__).parents[2] / "docs" / "surface-speed.md"
    names: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", page.read_text(), re.S):
        exec(block, names)
    assert names["stick"].t == pytest.approx(0.9 / (0.3 * 9.81), abs=1e-9)
    assert names["carried"]["energy.input_work"][-1] == pytest.approx(2.0 * 0.9**2, rel=1e-8)
    assert names["slip"].t == pytest.approx(0.5 * 0.4 * 9.81, abs=1e-6)
    assert names["falls"]["case.angle"][-1] < -0.1


def test_every_kind_and_field_of_an_event_stands_in_the_table() -> None:
    table = PAGE.split("## Events")[1].split("##")[0]
    assert Event.__doc__ is not None
    for kind in re.findall(r'"(\w+)"', Event.__doc__.split("kind :")[1]):
        assert f"| `{kind}` |" in table
    for field in fields(Event):
        assert f"`{field.name}`" in table


def test_every_impact_law_stands_on_the_page() -> None:
    for law in (NewtonImpact, PoissonImpact):
        assert issubclass(law, ImpactLaw) and f"| `{law.__name__}`" in PAGE
