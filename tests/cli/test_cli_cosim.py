"""`tlismni export` and `tlismni cosim`."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

pytest.importorskip("fmpy")

from tlismni.cli import cosimulation
from tlismni.cli.cosimulation import Columns, communication_points
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper.export import HERE, SHIM
from tlismni.models import load

pytestmark = pytest.mark.skipif(not (HERE / SHIM).is_file(), reason="the FMU shim is not built")

Command = Callable[..., Any]


@pytest.mark.parametrize("irregular", [False, True])
def test_communication_points_cover_the_run(irregular: bool) -> None:
    times = communication_points(1.0, 0.03, irregular)
    steps = np.diff(times)
    assert times[0] == 0.0 and times[-1] == 1.0
    assert np.all(steps > 0.0) and np.all(steps < 0.03 * 1.8 + 1e-9)
    assert np.array_equal(times, communication_points(1.0, 0.03, irregular))
    assert (np.ptp(steps[:-1]) > 1e-3) == irregular


def test_regular_points_that_divide_the_run_evenly() -> None:
    assert len(communication_points(2.5, 0.01, False)) == 251
    assert len(communication_points(0.3, 0.1, False)) == 4
    assert list(communication_points(0.005, 0.01, False)) == [0.0, 0.005]


def test_export(tlismni: Command, tmp_path: Path) -> None:
    import fmpy

    path = tmp_path / "new" / "pendulum.fmu"
    done = tlismni("export", "pendulum_stop", "-o", path, "--set", "restitution=0.25", "--method", "irk", "--json")
    assert done.code == 0
    assert done.json["file"] == str(path) and done.json["bytes"] == path.stat().st_size
    assert done.json["inputs"] == ["torque"]
    starts = {v.name: v.start for v in fmpy.read_model_description(str(path)).modelVariables}
    assert float(starts["restitution"]) == 0.25
    method = next(v for v in fmpy.read_model_description(str(path)).modelVariables if v.name == "solver.method")
    assert {item.name: item.value for item in method.declaredType.items}["irk"] == starts["solver.method"]


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("given", "version"), [("2", "2.0"), ("3", "3.0"), ("3.0", "3.0")])
def test_export_of_a_version(tlismni: Command, tmp_path: Path, given: str, version: str) -> None:
    import fmpy

    done = tlismni("export", "pendulum_stop", "-o", tmp_path / "p.fmu", "--fmi", given, "--json")
    assert done.code == 0 and done.json["fmi"] == version
    assert fmpy.read_model_description(str(tmp_path / "p.fmu")).fmiVersion == version


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_info(tlismni: Command, tmp_path: Path, version: str) -> None:
    path = tmp_path / "p.fmu"
    tlismni("export", "pendulum_stop", "-o", path, "--fmi", version, "--method", "irk", "--rtol", 1e-5)
    found = tlismni("info", path, "--json").json
    assert (
        found["fmi"] == version and found["model"] == "pendulum_stop" and found["t_end"] == load("pendulum_stop").t_end
    )
    assert found["solver"]["method"] == "irk" and found["tolerance"] == 1e-5
    assert len(found["binaries"]) == 1 and found["python"]["version"].startswith("3.")
    assert ("event mode" in found["capabilities"]) == (version == "3.0")
    assert {"state", "serialised state", "directional derivatives"} <= set(found["capabilities"])
    torque = next(v for v in found["variables"] if v["name"] == "torque")
    assert (torque["causality"], torque["unit"]) == ("input", "N.m")
    assert [v["reference"] for v in found["variables"]] == list(range(1, len(found["variables"]) + 1))
    shown = tlismni("info", path)
    assert shown.code == 0 and all(name in shown.out for name in ("FMI " + version, "stop.normal_force", "torque"))


def test_a_bundled_fmu_says_so(tlismni: Command, tmp_path: Path) -> None:
    path = tmp_path / "p.fmu"
    assert tlismni("export", "pendulum_stop", "-o", path, "--fmi", "3", "--bundle", "--json").json["bundle"] is True
    found = tlismni("info", path, "--json").json
    assert found["bundle"] and found["icon"] and found["documentation"]
    assert {need.split(">=")[0] for need in found["requires"]} == {"numpy", "scipy", "numba", "pydantic"}
    (drive,) = found["terminals"]
    assert drive["name"] == "drive" and drive["members"]["torque"] == "torque"
    variables = {v["name"]: v for v in found["variables"]}
    assert variables["solver.method"]["start"] == "auto" and "irk" in variables["solver.method"]["choices"]
    assert (variables["restitution"]["min"], variables["restitution"]["max"]) == (0.0, 1.0)
    assert variables["stop.law"]["start"] == "NewtonImpact"
    shown = tlismni("info", path).out
    assert "inside" in shown and "numba>=" in shown and "terminals" in shown and "constants" in shown


@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
def test_an_fmu_without_python_says_so(tlismni: Command, tmp_path: Path) -> None:
    path = tmp_path / "p.fmu"
    assert tlismni("export", "pendulum_stop", "-o", path, "--native", "--json").json["native"] is True
    found = tlismni("info", path, "--json").json
    assert found["native"] and not found["python"] and "state" in found["capabilities"]
    assert "it needs no Python" in tlismni("info", path).out
    warmed = tlismni("warm", path)
    assert warmed.code == 1 and "has nothing to compile" in warmed.cause
    refused = tlismni("export", "four_bar", "-o", tmp_path / "f.fmu", "--native")
    assert refused.code == 1 and "'four_bar' cannot be an FMU without Python" in refused.cause


def test_export_for_an_unknown_platform(tlismni: Command, tmp_path: Path) -> None:
    done = tlismni("export", "pendulum_stop", "-o", tmp_path / "p.fmu", "--platform", "amiga")
    assert done.code == 1 and "platform 'amiga' is unknown: choose from" in done.cause
    assert list(tmp_path.iterdir()) == []


def test_info_of_what_is_no_fmu(tlismni: Command, tmp_path: Path) -> None:
    (tmp_path / "x.fmu").write_text("no archive")
    done = tlismni("info", tmp_path / "x.fmu")
    assert done.code == 1 and "x.fmu' is no FMU" in done.cause
    assert tlismni("info", tmp_path / "absent.fmu").code == 2


def test_export_refuses_other_suffixes_and_versions(tlismni: Command, tmp_path: Path) -> None:
    assert tlismni("export", "chain", "-o", tmp_path / "chain.zip").code == 2
    done = tlismni("export", "chain", "-o", tmp_path / "chain.fmu", "--fmi", "4.0")
    assert done.code == 1 and "4.0" in done.cause
    assert list(tmp_path.iterdir()) == []


def test_fmu_and_slave_are_the_same_through_an_impact(tlismni: Command, tmp_path: Path) -> None:
    done = tlismni("cosim", "pendulum_stop", "--t-end", 0.6, "-c", 0.02, "--irregular", "-o", tmp_path, "--json")
    assert done.code == 0
    figures = done.json
    assert figures["identical"] is True and figures["different"] == []
    assert figures["events"] == 1
    assert figures["values"] == (figures["communication_steps"] + 1) * figures["outputs"]
    for pair in figures["uninterrupted"].values():
        assert pair["largest_difference"] <= 1e-4 * max(pair["largest_value"], 1.0)
    assert sorted(path.name for path in tmp_path.iterdir()) == [
        "pendulum_stop.fmu", "pendulum_stop_cosim.png", "pendulum_stop_fmu.csv", "pendulum_stop_slave.csv",
    ]  # fmt: skip
    assert (tmp_path / "pendulum_stop_fmu.csv").read_bytes() == (tmp_path / "pendulum_stop_slave.csv").read_bytes()


def test_the_fmu_of_version_3_and_the_slave_are_the_same(tlismni: Command) -> None:
    done = tlismni("cosim", "pendulum_stop", "--fmi", "3", "--t-end", 0.6, "-c", 0.02, "--json")
    assert done.code == 0
    assert done.json["identical"] is True and done.json["events"] == 1 and done.json["outputs"] > 20


def test_one_bit_is_a_difference(tlismni: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    true_drive = cosimulation.drive_slave

    def with_a_wrong_bit(*arguments: object) -> Columns:
        columns = true_drive(*arguments)  # type: ignore[arg-type]
        columns["pendulum.angle"][3] = np.nextafter(columns["pendulum.angle"][3], 1.0)
        return columns

    monkeypatch.setattr(cosimulation, "drive_slave", with_a_wrong_bit)
    done = tlismni("cosim", "pendulum_stop", "--t-end", 0.1, "-c", 0.02, "--json")
    assert done.code == 1
    assert done.json["identical"] is False and done.json["different"] == ["pendulum.angle"]
    last = done.err.splitlines()[-1]
    assert last.startswith("tlismni: FMU and slave differ in 1 of") and "'pendulum.angle' at t = 0.06 s" in last


def test_a_failing_fmu_says_why(tmp_path: Path) -> None:
    from tlismni.cli.errors import Failure
    from tlismni.fmu_wrapper import export_fmu

    fmu = export_fmu(load("pendulum_stop"), tmp_path / "p.fmu", max_steps=20)
    with pytest.raises(Failure, match=r"p\.fmu.*max_steps = 20"):
        cosimulation.drive_fmu(fmu, tmp_path / "unzipped", np.array([0.0, 2.0]))


def test_a_folder_that_cannot_be_written_is_refused_before_the_work(
    tlismni: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def never(*args: object, **kwargs: object) -> None:
        raise AssertionError("the work was begun")

    monkeypatch.setattr("tlismni.fmu_wrapper.export_fmu", never)
    file = tmp_path / "file"
    file.write_text("")
    for arguments in (("cosim", "chain", "-o", file / "out"), ("export", "chain", "-o", file / "chain.fmu")):
        done = tlismni(*arguments)
        assert done.code == 1 and f"'{arguments[-1]}' cannot be written" in done.cause


def test_more_communication_points_than_fit_are_refused(tlismni: Command) -> None:
    done = tlismni("cosim", "chain", "-c", 1e-12)
    text = " ".join(done.err.replace("│", " ").split())
    assert done.code == 2 and "--communication-step" in text and "2e+12 points up to t_end = 2 s" in text
