"""What the documentation shows works: Python and JSON blocks run, links lead somewhere, commands exist."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tlismni.core import Model, simulate
from tlismni.core.model.fields import records
from tlismni.fmu_wrapper.export import HERE, SHIM
from tlismni.models import load

ROOT = Path(__file__).parents[2]
PAGES = sorted([*(ROOT / "docs").glob("*.md"), *ROOT.glob("*.md")])


def blocks(page: str, language: str) -> list[str]:
    return re.findall(rf"```{language}\n(.*?)```", (ROOT / "docs" / page).read_text(), re.S)


def test_the_quickstart_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    first, second = blocks("quickstart.md", "python")
    names: dict[str, Any] = {}
    exec(first, names)
    assert names["result"].t[-1] == names["scenario"].t_end
    exec(second, names)
    assert names["result"].events[-1].kind == "rest"
    assert (tmp_path / "ball.json").is_file()


def test_the_page_of_many_runs_works() -> None:
    first, second = blocks("many-runs.md", "python")
    names: dict[str, Any] = {}
    exec(first, names)
    runs = names["runs"]
    assert len(runs) == 200 and not runs.failures
    assert runs["ball.y"][names["highest"]] == max(runs["ball.y"])
    exec(second, names)
    run = names["run"]
    # thrown up at 1 m/s, it is above the floor still
    assert run.values()[run.table.index["ball.y"]] == pytest.approx(1.5 - 0.125 * 9.81)


def test_the_readme_runs_and_its_figures_are_those_that_come_out(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    text = (ROOT / "README.md").read_text(encoding="utf-8")
    first, model, equations = re.findall(r"```python\n(.*?)```", text, re.S)
    names: dict[str, Any] = {}
    exec(first, names)
    printed = capsys.readouterr().out.splitlines()
    assert len(printed) == 6
    for line in printed[:3]:
        assert f"    {line}\n" in text
    for event in names["result"].events:
        assert f"{event.approach_speed:.6g}" in text and f"{event.energy_loss:.6g}" in text
    for level in ("position", "velocity", "acceleration"):
        assert names["result"][f"residual.{level}"].max() < 1e-10
    exec(model, names)
    last = names["simulate"](names["model"], 5.0).events
    assert sum(event.kind == "impact" for event in last) == 62
    assert last[-1].kind == "rest" and f"{last[-1].t:.4f}" in text
    exec(equations, names)


def test_the_fmu_page_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("lxml")
    if not (HERE / SHIM).is_file():
        pytest.skip("the FMU shim is not built")
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {"scenario": load("pendulum_stop"), "model": load("bouncing_ball").model}
    export, slave = blocks("fmu.md", "python")
    exec(slave, names)
    assert names["slave"].time == 0.01
    exec(export, names)
    assert (tmp_path / "ball.fmu").is_file()


def test_the_page_on_co_simulation_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    pytest.importorskip("fmpy")
    if not (HERE / SHIM).is_file():
        pytest.skip("the FMU shim is not built")
    monkeypatch.chdir(tmp_path)
    (tmp_path / "system.toml").write_text(blocks("co-simulation.md", "toml")[0])
    names: dict[str, Any] = {}
    exec(blocks("co-simulation.md", "python")[0], names)
    assert names["result"]["wall.blow.normal_force"].max() > 100.0
    assert (tmp_path / "system.ssp").is_file()


def test_the_page_of_results_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in ("matplotlib", "pandas", "xarray"):
        pytest.importorskip(module)
    monkeypatch.chdir(tmp_path)
    names: dict[str, Any] = {}
    for block in blocks("results.md", "python"):
        exec(block, names)
    result = names["result"]
    assert np.array_equal(names["again"]["stop.gap"], result["stop.gap"])
    assert names["rest"].q[-1] == pytest.approx(names["same"].q[-1], abs=1e-6)
    assert {path.name for path in tmp_path.iterdir()} == {"swing.png", "swing.html", "swing.npz", "swing.csv"}
    # what the page shows of `print(result)`, but for numbers
    shown = (ROOT / "docs" / "results.md").read_text(encoding="utf-8")
    for line in str(result).splitlines():
        assert re.sub(r"[\d.e+-]+", "#", f"    {line}") in re.sub(r"[\d.e+-]+", "#", shown)


def test_the_page_of_animations_runs(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for block in blocks("animations.md", "python"):
        exec(block, {})
    assert {path.name for path in tmp_path.iterdir()} == {"crank.html", "hub.html", "toy.html", "top.html", "top.glb"}


def test_the_page_of_exponents_runs() -> None:
    names: dict[str, Any] = {}
    for block in blocks("lyapunov.md", "python"):
        exec(block, names)
    assert abs(names["found"].sum_residual) < 1e-8
    assert names["orbit"].multipliers == pytest.approx([0.75307082, 0.74949563], abs=1e-7)


def test_the_page_of_flexible_bodies_runs() -> None:
    """Each block by itself; the rod strikes the wall, the cable and the beam hang and swing."""
    results = []
    for block in blocks("flexible.md", "python"):
        names: dict[str, Any] = {}
        exec(block, names)
        results.append(names["result"])
    assert [e.kind for e in results[0].events][:2] == ["impact", "close"]
    for result in results[1:]:
        assert not result.events and np.abs(result["energy.balance"]).max() < 1e-3


def test_the_model_file_is_one() -> None:
    (text,) = blocks("model-files.md", "json")
    model = Model.from_json(text)
    assert simulate(model, 1.0).events[0].kind == "impact"
    assert json.loads(text)["format"] == Model().format


def test_the_model_page_leads_to_the_fields_of_every_type() -> None:
    text = (ROOT / "docs" / "model-files.md").read_text(encoding="utf-8")
    linked = set(re.findall(r"\]\(model-fields\.md#(\w+)\)", text))
    in_words = {"Model", "Input", "Parameter", "Formula", "MarkerOutput2D", "MarkerOutput3D", "Marker2D"}
    assert linked == {name.lower() for name in records(Model)} - {name.lower() for name in in_words}
    assert all(f"`{name.lower()}s`" in text or f"`{name}`" in text for name in in_words - {"Model", "Marker2D"})


def test_the_page_of_contact_in_the_plane_runs() -> None:
    names: dict[str, Any] = {}
    (code,) = blocks("planar-contact.md", "python")
    exec(code, names)
    assert {event.contact for event in names["result"].events} > {"heap_ball_crate"}


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)
def test_links_lead_somewhere(page: Path) -> None:
    for target in re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", page.read_text()):
        if not target.startswith("http"):
            assert (page.parent / target).exists(), target


def test_the_page_of_analyses_runs() -> None:
    names: dict[str, Any] = {}
    code, fitting = blocks("analyses.md", "python")
    exec(code, names)
    exec(fitting, names)
    assert names["found"]["spring.damping"] == pytest.approx(0.08, abs=1e-4)
    # what lies on the ground is carried: the rest hangs from the pin
    assert "ground8" in names["rest"].closed and names["rest"]["ground8.normal_force"] > 0.0
    assert (names["modes"].frequencies[1] / names["modes"].frequencies[0]) == pytest.approx(
        (4.694 / 1.875) ** 2, rel=1e-3
    )


def test_the_page_of_sweeps_runs() -> None:
    pytest.importorskip("pyarrow")
    names: dict[str, Any] = {}
    (code,) = blocks("sweeps.md", "python")
    exec(code, names)
    assert len(names["found"]) == 10 and not names["found"].failures


def test_the_page_of_inputs_runs() -> None:
    names: dict[str, Any] = {}
    loads, motions = blocks("inputs.md", "python")
    exec(loads, names)
    assert names["result"]["cart.vx"][-1] == pytest.approx(1.0, abs=1e-6)
    exec(motions, names)
    assert names["result"]["cart.x"][-1] == pytest.approx(0.1 * np.sin(5.0), abs=1e-9)
