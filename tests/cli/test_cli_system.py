"""`tlismni cosim SYSTEM.toml`."""

import json
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("fmpy")

from tlismni.fmu_wrapper.export import HERE, SHIM

needs_shim = pytest.mark.skipif(not (HERE / SHIM).is_file(), reason="the FMU shim is not built")
Command = Callable[..., Any]

SYSTEM = """
name = "pendulums"
connections = [{ from = "a.pendulum.angle", to = "b.torque", factor = 0.5, unit = "N.m/rad" }]
plot = ["a.pendulum.angle", "b.pendulum.angle"]

[instances.a]
scenario = "pendulum_stop"

[instances.b]
scenario = "pendulum_stop"

[master]
algorithm = "gauss-seidel"
step = 0.05
t_end = 0.5
"""


@pytest.fixture
def system(tmp_path: Path) -> Path:
    path = tmp_path / "system.toml"
    path.write_text(SYSTEM)
    return path


@pytest.mark.sampled(1)
@pytest.mark.parametrize("suffix", [".csv", ".json", ".npz"])
def test_results_in_all_formats(tlismni: Command, system: Path, suffix: str) -> None:
    out = system.with_suffix(suffix)
    done = tlismni("cosim", system, "-o", out, "--plot", system.with_suffix(".png"), "--json")
    assert done.code == 0
    figures = done.json
    assert figures["algorithm"] == "gauss-seidel" and figures["statistics"]["communication_steps"] == 10
    assert figures["unconnected"] == ["a.torque"] and figures["loops"] == []
    assert figures["files"] == [str(out), str(system.with_suffix(".png"))]
    if suffix == ".csv":
        table = np.genfromtxt(out, delimiter=",", names=True, deletechars="")
        angle, torque = table["a.pendulum.angle"], table["b.torque"]
    elif suffix == ".npz":
        archive = np.load(out)
        angle, torque = archive["a.pendulum.angle"], archive["b.torque"]
    else:
        data = json.loads(out.read_text())
        assert data["units"]["b.torque"] == "N.m"
        angle, torque = (np.array(data["columns"][name]) for name in ("a.pendulum.angle", "b.torque"))
    np.testing.assert_allclose(torque, 0.5 * angle, rtol=1e-14)
    assert figures["final"]["a.pendulum.angle"] == pytest.approx(float(angle[-1]))


def test_settings_of_the_command_line_win(tlismni: Command, system: Path, tmp_path: Path) -> None:
    done = tlismni(
        "cosim", system, "--algorithm", "newton", "-c", 0.1, "--t-end", 0.3, "-o", tmp_path / "out", "--json"
    )
    assert done.code == 0
    assert done.json["algorithm"] == "newton" and done.json["t_end"] == 0.3
    assert done.json["statistics"]["communication_steps"] == 3 and done.json["statistics"]["rollbacks"] >= 3
    assert sorted(path.name for path in (tmp_path / "out").iterdir()) == ["system.csv", "system.png"]


def test_what_is_printed(tlismni: Command, system: Path) -> None:
    done = tlismni("cosim", system)
    assert done.code == 0
    assert all(text in done.out for text in ("0.5 N.m/rad × a.pendulum.angle", "inputs that nothing feeds", "a.torque"))


def test_refusals(tlismni: Command, system: Path, tmp_path: Path) -> None:
    assert tlismni("cosim", system, "--set", "restitution=0.5").code == 2
    assert tlismni("cosim", system, "-o", tmp_path / "x.txt").code == 2
    assert tlismni("cosim", "pendulum_stop", "--algorithm", "newton").code == 2
    wrong = tlismni("cosim", system, "--algorithm", "neuton")
    assert wrong.code == 1 and "newton" in wrong.cause
    system.write_text(SYSTEM.replace("a.pendulum.angle", "a.pendulum.angel", 1))
    wrong = tlismni("cosim", system)
    assert wrong.code == 1 and "'pendulum.angle'" in wrong.cause
    assert "cannot be read" in tlismni("cosim", tmp_path / "absent.toml").cause


@needs_shim
def test_a_system_as_an_ssp_archive(tlismni: Command, system: Path) -> None:
    out = system.with_suffix(".ssp")
    done = tlismni("export", system, "-o", out, "--json")
    assert done.code == 0 and done.json["instances"] == ["a", "b"] and done.json["bytes"] == out.stat().st_size
    with zipfile.ZipFile(out) as archive:
        assert "SystemStructure.ssd" in archive.namelist()
    assert tlismni("export", system, "-o", system.with_suffix(".fmu")).code == 2
    assert tlismni("export", system, "-o", out, "--rtol", 1e-3).code == 2
