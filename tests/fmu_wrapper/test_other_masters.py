"""Other masters drive our FMUs: ecos (a native program, FMI 2.0 and 3.0), libcosim (2.0), fmpy's SSP runner (2.0)."""

import importlib.metadata
import importlib.util
import os
import shutil
import stat
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

pytest.importorskip("fmpy")

from fmpy.ssp.simulation import simulate_ssp
from split_oscillators import START, Oscillators
from tlismni.fmu_wrapper import Slave, export_fmu
from tlismni.fmu_wrapper.export import HERE, SHIM
from tlismni.fmu_wrapper.master import Connection, MasterError, SystemDescription, write_ssp
from tlismni.models import load

pytestmark = pytest.mark.skipif(not (HERE / SHIM).is_file(), reason="the FMU shim is not built")

STEP, STEPS = 0.02, 40
SOLVER = {"method": "ebdf", "rtol": 1e-9, "atol": 1e-12}
HALVES = Oscillators(springs=(3.0, 2.0), coupling=1.0, solver=SOLVER)
"""Coupled by 1 N/m: a displacement is a force, and masters without factors on connections can couple them."""


@pytest.fixture(scope="session")
def ecos(tmp_path_factory):
    """Runs the ecos program, or skips the test with what is missing."""
    found = importlib.util.find_spec("ecospy")
    if found is None:
        pytest.skip('ecospy is not installed: pip install "tlismni[masters]" (Linux x86-64)')
    if sys.platform != "linux":
        pytest.skip("ecospy's program needs Linux here: its wheel has no program for this platform that runs unchanged")
    # the wheel's program lacks the permission to run, and its tbb comes in a wheel of its own
    folder = tmp_path_factory.mktemp("ecos")
    shutil.copytree(Path(found.submodule_search_locations[0]) / "binaries", folder, dirs_exist_ok=True)
    for name in ("ecos", "proxyfmu"):
        (folder / name).chmod((folder / name).stat().st_mode | stat.S_IXUSR)
    try:
        libraries = [f for f in importlib.metadata.files("tbb") or () if f.name.startswith("libtbb.so")]
    except importlib.metadata.PackageNotFoundError:
        libraries = []
    if not libraries:
        pytest.skip('ecos needs libtbb.so.12: pip install "tlismni[masters]"')
    places = [str(Path(libraries[0].locate()).resolve().parent), os.environ.get("LD_LIBRARY_PATH", "")]
    environment = {**os.environ, "LD_LIBRARY_PATH": os.pathsep.join(filter(None, places))}

    def run(path, step, stop, where):
        command = [
            str(folder / "ecos"),
            "simulate",
            "--path",
            str(path),
            "--stepSize",
            repr(step),
            "--stopTime",
            repr(stop),
        ]
        done = subprocess.run(command, capture_output=True, text=True, env=environment, cwd=where, timeout=1200)
        assert done.returncode == 0, done.stdout + done.stderr
        table = np.genfromtxt(path.with_suffix(".csv"), delimiter=",", names=True, deletechars="", autostrip=True)
        return {name.partition("[")[0]: table[name] for name in table.dtype.names}

    return run


@pytest.mark.sampled(1)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_ecos_through_an_impact(ecos, tmp_path, version):
    scenario = load("pendulum_stop")
    fmu = export_fmu(scenario, tmp_path / "p.fmu", version)
    found = ecos(fmu, 0.01, 0.6, tmp_path)
    slave = Slave(scenario)
    slave.enter_initialization()
    slave.exit_initialization()
    expected = {name: [slave[name]] for name in ("pendulum.angle", "solver.events", "stop.gap")}
    for k in range(len(found["time"]) - 1):
        slave.do_step(k * 0.01, 0.01)
        for name, values in expected.items():
            values.append(slave[name])
    assert len(found["time"]) >= 60 and expected["solver.events"][-1] >= 1
    for name, values in expected.items():
        # ecos writes six digits
        np.testing.assert_allclose(found[f"instance::{name}"], values, rtol=2e-6, atol=1e-6)


def libcosim():
    return pytest.importorskip(
        "libcosimpy", reason='libcosimpy is not installed: pip install "tlismni[masters]" (Linux and Windows x86-64)'
    )


def test_libcosim_couples_two_fmus_as_jacobi_does(tmp_path):
    libcosim()
    from libcosimpy.CosimEnums import CosimVariableCausality
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    execution = CosimExecution.from_step_size(step_size=int(STEP * 1e9))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    place, inputs, outputs = {}, {}, {}
    for k, name in enumerate("ab"):
        fmu = export_fmu(HALVES.model(k), tmp_path / f"{name}.fmu", **SOLVER)
        place[name] = execution.add_local_slave(CosimLocalSlave(fmu_path=str(fmu), instance_name=name))
        variables = execution.slave_variables(place[name])
        inputs[name] = [v.reference for v in variables if v.causality == CosimVariableCausality.INPUT.value]
        outputs[name] = {v.name.decode(): v.reference for v in variables}
    for source, target in ("ab", "ba"):
        execution.connect_real_variables(place[source], outputs[source]["mass.x"], place[target], inputs[target][0])
    assert execution.simulate_until(int(STEP * STEPS * 1e9))
    names = ("mass.x", "mass.d_x")
    found = [x for i in "ab" for x in observer.last_real_values(place[i], [outputs[i][name] for name in names])]
    expected = np.linalg.matrix_power(HALVES.map("jacobi", STEP), STEPS) @ START
    np.testing.assert_allclose(found, expected, atol=1e-7)


def system(folder, version):
    for k, name in enumerate("ab"):
        export_fmu(HALVES.model(k), folder / f"{name}.fmu", version, **SOLVER)
    return SystemDescription(
        name="halves",
        instances={name: {"fmu": f"{name}.fmu"} for name in "ab"},
        connections=[{"from": f"{a}.mass.x", "to": f"{b}.force", "unit": "N/m"} for a, b in ("ab", "ba")],
        master={"step": STEP, "t_end": STEP * STEPS, "algorithm": "jacobi"},
    )


def first_step_without_coupling():
    """What a master does that sets inputs to zero before its first step: z after k + 1 steps."""
    uncoupled = Oscillators(springs=HALVES.springs, coupling=1.0, solver=SOLVER).own(STEP)
    return lambda k: np.linalg.matrix_power(HALVES.map("jacobi", STEP), k) @ uncoupled @ START


def test_an_ssp_that_we_write_runs_in_fmpy(tmp_path):
    path = write_ssp(system(tmp_path, "2.0"), tmp_path / "halves.ssp", tmp_path)
    found = simulate_ssp(str(path), stop_time=STEP * STEPS, step_size=STEP)
    exact = first_step_without_coupling()
    # a row has the time at the start of its step and the values at its end
    for k in (0, 1, STEPS - 1):
        for place, name in ((0, "a.mass.x"), (2, "b.mass.x")):
            assert found[name][k] == pytest.approx(exact(k)[place], abs=1e-7)
    np.testing.assert_array_equal(found["b.force"], found["a.mass.x"])


@pytest.mark.sampled(1)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_an_ssp_that_we_write_runs_in_ecos(ecos, tmp_path, version):
    path = write_ssp(system(tmp_path, version), tmp_path / "halves.ssp", tmp_path)
    found = ecos(path, STEP, STEP * STEPS, tmp_path)
    z, jacobi = START, HALVES.map("jacobi", STEP)
    first_free = first_step_without_coupling()
    ways = [np.array([np.linalg.matrix_power(jacobi, k) @ z for k in range(STEPS)]),
            np.array([z, *(first_free(k) for k in range(STEPS - 1))])]  # fmt: skip
    x = np.array([found["a::mass.x"][:STEPS], found["b::mass.x"][:STEPS]]).T
    assert min(float(np.max(np.abs(x - way[:, [0, 2]]))) for way in ways) < 2e-6


def test_an_ssp_of_models_has_their_fmus_and_factors_and_starts(tmp_path):
    import zipfile

    from lxml import etree

    for k, name in enumerate("ab"):
        (tmp_path / f"{name}.json").write_text(HALVES.model(k).to_json())
    described = SystemDescription(
        name="halves",
        instances={"a": {"model": "a.json", "fmi": "2.0", "start": {"solver.rtol": 1e-5}}, "b": {"model": "b.json"}},
        connections=[Connection(source="a.mass.x", target="b.force", factor=-3.0, unit="N/m")],
        master={"step": STEP, "t_end": 1.0},
    )
    path = write_ssp(described, tmp_path / "halves.ssp", tmp_path)
    with zipfile.ZipFile(path) as archive:
        assert {"SystemStructure.ssd", "resources/a.fmu", "resources/b.fmu"} == set(archive.namelist())
        root = etree.fromstring(archive.read("SystemStructure.ssd"))
    factor = root.find(".//{*}LinearTransformation")
    assert float(factor.get("factor")) == -3.0
    start = root.find(".//{*}Parameter")
    assert start.get("name") == "solver.rtol" and float(start[0].get("value")) == 1e-5
    assert float(root.find(".//{*}DefaultExperiment").get("stopTime")) == 1.0


def test_an_ssp_of_what_does_not_fit_is_refused(tmp_path):
    described = system(tmp_path, "2.0")
    wrong = described.model_copy(update={"connections": (Connection(source="a.mass.y", target="b.force"),)})
    with pytest.raises(MasterError, match="no such variable"):
        write_ssp(wrong, tmp_path / "x.ssp", tmp_path)
    assert not (tmp_path / "x.ssp").exists()
