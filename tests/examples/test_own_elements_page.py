"""The page of own elements: its code runs, and moves as it should."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tlismni.core import Constant, CoordinateLoad, Model, simulate

PAGE = (Path(__file__).parents[2] / "docs" / "own-elements.md").read_text()
BLOCKS = re.findall(r"```python\n(.*?)```", PAGE, re.S)


@pytest.fixture(scope="module")
def runs() -> list[dict[str, Any]]:
    """The names after each block."""
    names: dict[str, Any] = {}
    found = []
    for block in BLOCKS:
        exec(block, names)
        found.append(dict(names))
    return found


def test_the_bead_stays_on_its_wire(runs: list[dict[str, Any]]) -> None:
    result = runs[0]["result"]
    assert result["bead.y"] == pytest.approx(result["bead.x"] ** 2, abs=1e-8)
    assert np.abs(result["energy.balance"]).max() < 1e-4
    assert result["wire.wire_force"].max() < 0.0


def test_the_spring_keeps_its_energy(runs: list[dict[str, Any]]) -> None:
    result = runs[1]["result"]
    assert result["energy.strain"].max() > 0.1
    assert np.abs(result["energy.balance"]).max() < 1e-4


def test_the_egg_tumbles_over_the_floor_and_not_through_it(runs: list[dict[str, Any]]) -> None:
    result = runs[2]["result"]
    impacts = [event for event in result.events if event.kind == "impact"]
    assert len(impacts) >= 2 and result["floor.gap"].min() > -1e-9
    # the lowest point of an ellipse, straight from its equation
    angle, turns = result["egg.angle"], np.linspace(0.0, 2.0 * np.pi, 20001)
    for k in range(0, len(angle), 7):
        heights = 0.2 * np.cos(turns) * np.sin(angle[k]) + 0.1 * np.sin(turns) * np.cos(angle[k])
        assert result["floor.gap"][k] == pytest.approx(result["egg.y"][k] + heights.min(), abs=1e-7)
    assert abs(result["egg.angular_velocity"][-1]) > 0.1
    assert np.abs(result["energy.balance"]).max() < 1e-6


def test_the_shaft_is_turned_by_its_load(runs: list[dict[str, Any]]) -> None:
    shaft = runs[3]["Shaft"](name="shaft", inertia=0.5, speed=2.0)
    load = CoordinateLoad(name="motor", body="shaft", coordinate="angle", load=Constant(value=3.0))
    result = simulate(Model(bodies=[shaft], forces=[load]), 1.0)
    assert result["shaft.angle"] == pytest.approx(2.0 * result.t + 3.0 * result.t**2, rel=1e-6)
