"""The report's pages: whole HTML, scripts that close, figures, motion and what they were made with."""

import importlib
import json
from html.parser import HTMLParser
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tlismni.core import simulate
from tlismni.models import load
from tlismni.validation import crosscheck
from tlismni.validation.comparisons.common import Curve, Panel
from tlismni.validation.drawing import drawing
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.interactive import figures
from tlismni.validation.report import render

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
VOID = ("meta", "input", "img", "link", "br")


class Tree(HTMLParser):
    """Checks that elements close in order, and collects what a page refers to."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.outside: list[str] = []
        self.ids: list[str] = []

    def handle_starttag(self, tag: str, attrs: Any) -> None:
        if tag not in VOID:
            self.open.append(tag)
        found = dict(attrs)
        self.ids += [found["id"]] if "id" in found else []
        self.outside += [v for k, v in found.items() if k in ("src", "href") and not str(v).startswith("data:")]

    def handle_endtag(self, tag: str) -> None:
        assert self.open and self.open.pop() == tag, tag


@pytest.mark.sampled(1)
@needs_exudyn
@pytest.mark.parametrize("plotly", [True, False])
def test_a_page_is_whole_and_needs_nothing_else(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, plotly: bool) -> None:
    pytest.importorskip("jinja2")
    pytest.importorskip("matplotlib")
    if plotly:
        pytest.importorskip("plotly")
    else:
        monkeypatch.setattr("tlismni.validation.report.plotly_library", lambda: None)
    found = crosscheck("pendulum", tmp_path, t_end=0.3)
    text = render(found)
    tree = Tree()
    tree.feed(text)
    assert tree.open == [] and tree.outside == []
    assert "mechanism" in tree.ids and ("plot0" in tree.ids) == plotly
    assert 'name="viewport"' in text and "seeds: none" in text
    # the verdicts come before everything that moves
    assert text.index("<h2>Quantities") < text.index("<h2>Motion")
    numbers = json.loads((tmp_path / "pendulum_crosscheck.json").read_text(encoding="utf-8"))
    assert numbers["machine"]["versions"]["numpy"] == np.__version__ and numbers["settings"]["t_end"] == 0.3


@pytest.mark.parametrize(
    "name, t_end, kinds",
    [
        ("pendulum_stop", 0.1, {"body", "wall"}), ("newtons_cradle", 0.05, {"mass", "disk"}),
        ("cable_pendulum", 0.02, {"flexible"}), ("rod_wall", 2e-4, {"flexible", "wall"}),
        ("mass_on_rod", 2e-4, {"flexible", "mass"}),
    ],
)  # fmt: skip
def test_a_drawing_follows_the_result(name: str, t_end: float, kinds: set[str]) -> None:
    scenario = load(name)
    result = simulate(scenario.model, t_end, scenario.method, **dict(scenario.options))
    found = drawing(scenario.model, result)
    assert found is not None and {line["kind"] for line in found["lines"]} == kinds
    frames = len(found["t"])
    for line in found["lines"]:
        assert len(line["x"]) == len(line["y"]) == frames
        assert {len(x) for x in line["x"]} == {len(line["x"][0])}
        if line["kind"] == "body":
            # a rigid body keeps its length
            ends = np.array([[x[0], x[-1]] for x in line["x"]]), np.array([[y[0], y[-1]] for y in line["y"]])
            lengths = np.hypot(*(np.diff(e, axis=1)[:, 0] for e in ends))
            assert np.ptp(lengths) < 1e-4


def test_rods_touch_in_the_picture_when_they_touch() -> None:
    scenario = load("rod_rod", elements=10)
    result = simulate(scenario.model, scenario.t_end, scenario.method, **dict(scenario.options))
    found = drawing(scenario.model, result)
    assert found is not None and "times as large" in found["note"]
    left, right = (np.array(line["x"]) for line in found["lines"])
    apart = right.min(axis=1) - left.max(axis=1)
    close = next(e.t for e in result.events if e.kind in ("impact", "close"))
    before = np.array(found["t"]) < close - 1e-6
    assert np.all(apart > -1e-3) and apart[0] > 0.02 and np.all(np.diff(apart[before]) < 1e-9)
    assert np.abs(apart[~before][:20]).max() < 2e-3


def test_without_exudyn_all_else_works(monkeypatch: pytest.MonkeyPatch) -> None:
    """The command says what is missing; solving, the study and the package itself do not need it."""
    pytest.importorskip("typer")
    from tlismni.cli.app import app
    from typer.testing import CliRunner

    others = importlib.import_module

    def refuse(name: str, package: str | None = None) -> Any:
        if name.startswith("exudyn"):
            raise ImportError("libGL.so.1: cannot open shared object file")
        return others(name, package)

    monkeypatch.setattr("tlismni.validation.exudyn_import.importlib.import_module", refuse)
    for arguments in (["crosscheck", "pendulum"], ["crosscheck", "--all"]):
        outcome = CliRunner().invoke(app, arguments)
        assert outcome.exit_code != 0
        assert "libgl1" in outcome.output.replace("\n", " ")
    assert CliRunner().invoke(app, ["run", "pendulum", "--t-end", "0.05"]).exit_code == 0
    assert CliRunner().invoke(app, ["crosscheck"]).exit_code != 0


def test_a_panel_with_a_window_is_as_high_as_what_it_shows() -> None:
    """A gap of millimetres at a contact is not to be seen on the scale of the whole flight."""
    t = np.linspace(0.0, 2.0, 2001)
    gap = Curve("gap", t, 1e-3 * np.cos(40.0 * (t - 1.0)) + 5.0 * (np.abs(t - 1.0) > 0.1), ours=True)
    shown = json.loads(figures((Panel("gap", "m", (gap,), window=(0.95, 1.05)),))[0])["layout"]
    low, high = shown["yaxis"]["range"]
    assert shown["xaxis"]["range"] == [0.95, 1.05]
    assert -2e-3 < low < -4e-4 and 1e-3 < high < 2e-3
    flat = Curve("none", t, np.zeros_like(t), ours=False)
    low, high = json.loads(figures((Panel("none", "N", (flat,), window=(0.0, 1.0)),))[0])["layout"]["yaxis"]["range"]
    assert low < 0.0 < high
