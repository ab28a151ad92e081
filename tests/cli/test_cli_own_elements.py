"""Model files with own elements on the command line: their modules are imported with leave alone."""

import importlib
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

MODULE = """
from tlismni.core import Marker2D, ScalarJoint2D, scalar_constraint


def height(b, slope):
    return b.y - slope * b.x


class OnSlope(ScalarJoint2D):
    formula = scalar_constraint(height)
    multiplier = ("wire_force", "N", "force across the wire")
    b: Marker2D
    slope: float
"""


@pytest.fixture
def model_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A model file with a joint from a module that is not imported."""
    from tlismni.core import Marker2D, Model, PointMass2D

    (tmp_path / "slope_parts.py").write_text(MODULE)
    monkeypatch.syspath_prepend(str(tmp_path))
    monkeypatch.delenv("TLISMNI_ALLOW_IMPORTS", raising=False)
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    parts = importlib.import_module("slope_parts")
    wire = parts.OnSlope(name="wire", b=Marker2D(body="bead"), slope=0.5)
    path = tmp_path / "model.json"
    Model(bodies=[PointMass2D(name="bead", mass=1.0, position=(0.2, 0.1))], joints=[wire]).save(path)
    monkeypatch.delitem(sys.modules, "slope_parts")
    return path


def test_own_elements_are_imported_with_leave_alone(process: Callable[..., Any], model_file: Path) -> None:
    refused = process("run", model_file, "--t-end", "0.1")
    assert refused.code == 1 and "slope_parts" in refused.err and "--allow-imports" in refused.err
    other = process("--allow-imports", "another", "run", model_file, "--t-end", "0.1")
    assert other.code == 1
    done = process(
        "--allow-imports", "another", "--allow-imports", "slope_parts", "run", model_file, "--t-end", "0.1", "--json"
    )
    assert done.code == 0, done.err
