"""The pages as a site: tutorials do what they say, messages exist, the site builds without a warning."""

import math
import os
import re
import shlex
import subprocess
import sys
from importlib.util import find_spec
from pathlib import Path
from typing import Any

import pytest

ROOT = Path(__file__).parents[2]
DOCS = ROOT / "docs"
TUTORIALS = sorted(path.name for path in (DOCS / "tutorials").glob("*-*.md"))
BLOCK = re.compile(r'^```(\w+)(?: title="([^"]+)")?\n(.*?)^```', re.S | re.M)
ELSEWHERE = {"README.md"}


def blocks(page: Path) -> list[tuple[str, str, str]]:
    """(language, file name, text) of the blocks of a page."""
    return BLOCK.findall(page.read_text(encoding="utf-8"))


@pytest.mark.slow
@pytest.mark.parametrize("name", TUTORIALS)
def test_a_tutorial_does_what_it_says(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Files are written, commands are run, Python is executed, in the order of the page."""
    for module in ("ruamel.yaml", "fmpy", "lxml", "typer", "pyarrow"):
        pytest.importorskip(module)
    from tlismni.cli.app import app
    from tlismni.fmu_wrapper.export import HERE, SHIM
    from typer.testing import CliRunner

    if "co-simulation" in name and not (HERE / SHIM).is_file():
        pytest.skip("the FMU shim is not built")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for language, file, text in blocks(DOCS / "tutorials" / name):
        if file:
            (tmp_path / file).write_text(text, encoding="utf-8")
        elif language == "python":
            exec(compile(text, f"{name}", "exec"), names)
        else:
            assert language == "sh", f"nothing says how a block of {language} is run"
            for line in filter(None, text.splitlines()):
                words = shlex.split(line)
                assert words[0] == "tlismni"
                done = CliRunner().invoke(app, words[1:], prog_name="tlismni")
                assert done.exit_code == 0, done.output
    if name.startswith("mechanical"):
        assert {"gate.html", "start.html", "gate.csv"} <= {path.name for path in tmp_path.iterdir()}
    if name.startswith("method"):
        assert names["run"].stats["steps"] > 0 and abs(names["first"].t - 0.48) < 0.01


def test_every_page_with_code_is_run_by_a_test() -> None:
    """A page with Python is named in a test of this folder; the parametrised tests above take the tutorials."""
    tests = "".join(path.read_text(encoding="utf-8") for path in Path(__file__).parent.glob("*.py"))
    for page in sorted(DOCS.glob("*.md")):
        if any(language == "python" for language, _, _ in blocks(page)):
            assert page.name in tests, f"no test runs the code of docs/{page.name}"


def test_the_messages_of_the_page_on_trouble_are_those_of_the_library() -> None:
    page = (DOCS / "troubleshooting.md").read_text(encoding="utf-8")
    quoted = re.findall(r"^\*\*`([^`]+)`", page, re.M)
    folders = ("core", "models", "fmu_wrapper", "validation", "cli")
    # messages are written in pieces: quotes and line ends between them are no part of what is said
    joined = [
        re.sub(r'"\s*(f|rf|r)?"', "", path.read_text(encoding="utf-8"))
        for folder in folders
        for path in (ROOT / folder).rglob("*.py")
    ]
    assert len(quoted) > 15
    for message in quoted:
        assert any(message in text for text in joined), message


def test_the_page_on_embedding_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from tlismni.core.compiled.library import LIBRARY

    if LIBRARY is None:
        pytest.skip("needs the library of machine code (tlismni.core.aot)")
    monkeypatch.chdir(tmp_path)
    (code,) = [text for language, _, text in blocks(DOCS / "embedding.md") if language == "python"]
    exec(code, {"Path": Path})
    assert (tmp_path / "control.image").stat().st_size > 1000


def test_the_page_on_fmus_without_python_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from tlismni.core.compiled.library import LIBRARY

    if LIBRARY is None:
        pytest.skip("needs the library of machine code (tlismni.core.aot)")
    monkeypatch.chdir(tmp_path)
    from tlismni.fmu_wrapper import export_fmu
    from tlismni.models import load

    names: dict[str, Any] = {"export_fmu": export_fmu, "scenario": load("pendulum_stop")}
    for language, _, text in blocks(DOCS / "native-fmu.md"):
        if language == "python":
            exec(text, names)
    assert list(tmp_path.glob("*.fmu"))


def test_the_page_on_space_runs() -> None:
    """The energy of each of its runs is accounted for, but what fixed steps of `hht` damp in stiff modes."""
    names: dict[str, Any] = {}
    runs = 0
    for language, _, text in blocks(DOCS / "space.md"):
        if language == "python":
            exec(text, names)
            found = names.pop("result", None)
            if found is None:
                continue
            runs += 1
            part = 1e-4 if '"hht"' in text else 1e-5
            assert abs(found["energy.balance"]).max() < part * found["energy.kinetic"].max(), text
    assert runs >= 3


def test_the_page_on_contact_in_space_runs() -> None:
    """Its ball rolls after 2 v/(7 mu g) with 5/7 of its speed, to the run's rtol."""
    names: dict[str, Any] = {}
    for language, _, text in blocks(DOCS / "space-contact.md"):
        if language == "python":
            exec(text, names)
    result, speed = names["result"], math.hypot(1.0, 0.5)
    (rolls,) = [event for event in result.events if event.kind == "stick"]
    assert rolls.t == pytest.approx(2.0 * speed / (7.0 * 0.3 * 9.81), rel=1e-6)
    assert math.hypot(result["ball.vx"][-1], result["ball.vy"][-1]) == pytest.approx(5.0 / 7.0 * speed, rel=1e-6)


def test_the_page_on_the_cross_check_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Its pendulum, whose Hunt-Crossley blows are compared by step, meets the agreed tolerances."""
    for module in ("exudyn", "jinja2", "plotly", "matplotlib"):
        pytest.importorskip(module)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    (code,) = [text for language, _, text in blocks(DOCS / "cross-check.md") if language == "python"]
    exec(code, names)
    found = names["found"]
    assert found.ok and any((tmp_path / "out" / "check").iterdir())

    def row(part: str) -> Any:
        (match,) = [r for r in found.rows if part in r.quantity]
        return match

    assert row("start").difference <= found.comparison.steps[-1]
    assert row("peak force").relative <= 5e-3
    assert row("impulse").relative <= 1e-3
    assert row("pendulum.angle before the second impact").relative <= 1e-4
    assert row("pendulum.angular_velocity before the second impact").relative <= 1e-4


def test_the_rod_of_the_page_on_model_files_runs(tmp_path: Path) -> None:
    pytest.importorskip("ruamel.yaml")
    from tlismni.core import Model, simulate

    (text,) = [text for language, _, text in blocks(DOCS / "model-files.md") if language == "yaml"]
    model = Model.from_yaml(text)
    assert model.bodies[0].inertia == 2.0 * 1.5**2 / 12.0
    assert abs(simulate(model, 0.5, rtol=1e-9)["energy.balance"]).max() < 1e-6


@pytest.mark.slow
def test_the_site_builds_without_a_warning(tmp_path: Path) -> None:
    for module in ("mkdocs", "material", "mkdocstrings"):
        if find_spec(module) is None:
            pytest.skip(f"{module} is not installed (extra docs)")
    done = subprocess.run(
        [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(tmp_path / "site")],
        cwd=ROOT, capture_output=True, text=True, check=False, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"},
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    pages = list((tmp_path / "site").rglob("index.html"))
    assert len(pages) > 40 and (tmp_path / "site" / "gallery" / "slack_rope" / "index.html").is_file()
    api = (tmp_path / "site" / "api" / "running" / "index.html").read_text(encoding="utf-8")
    assert "simulate" in api and "Parameters" in api


@pytest.mark.slow
@pytest.mark.parametrize("name", sorted(path.name for path in (DOCS / "notebooks").glob("*.ipynb")))
def test_a_notebook_runs_from_top_to_bottom(name: str, tmp_path: Path) -> None:
    for module in ("nbclient", "nbformat", "ipykernel", "matplotlib"):
        pytest.importorskip(module)
    import nbformat
    from nbclient import NotebookClient

    notebook = nbformat.read(DOCS / "notebooks" / name, as_version=4)
    nbformat.validate(notebook)
    assert not any(cell.get("outputs") for cell in notebook.cells), "stored without results"
    done = NotebookClient(notebook, timeout=600, resources={"metadata": {"path": str(tmp_path)}}).execute()
    shown = [output for cell in done.cells for output in cell.get("outputs", ())]
    assert shown and not any(output.output_type == "error" for output in shown)
