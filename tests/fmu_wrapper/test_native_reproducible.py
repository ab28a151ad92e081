"""Exports of one model are the same bytes in every process, so that a state of one goes to the other."""

import os
import subprocess
import sys
import zipfile

import fmpy
import pytest
from native_pair import Side
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import export_fmu
from tlismni.models import load

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
EXPORT = """
import sys
from tlismni.fmu_wrapper import export_fmu
from tlismni.models import load
before = [load(name).model.assemble() for name in ("chain", "rod_rod")]  # other memory is taken before
export_fmu(load(sys.argv[1]), sys.argv[2], sys.argv[3], native=True)
"""


def exported_elsewhere(name, path, version):
    """The FMU, made by another process, whose memory is full of junk and whose texts have other hashes."""
    changed = {"MALLOC_PERTURB_": "165", "PYTHONHASHSEED": "7"}
    subprocess.run([sys.executable, "-c", EXPORT, name, path, version], check=True, env={**os.environ, **changed})


@pytest.mark.parametrize(
    ("name", "version"),
    [
        ("pendulum_stop", "2.0"),
        ("spinning_sphere", "3.0"),
        pytest.param("bouncing_ball", "2.0", marks=pytest.mark.full),
        pytest.param("slider_crank_stop", "3.0", marks=pytest.mark.full),
    ],
)
def test_two_processes_export_the_same_bytes(name, version, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1763800000")
    here, there = tmp_path / f"{name}.fmu", tmp_path / "there" / f"{name}.fmu"
    there.parent.mkdir()
    export_fmu(load(name), here, version, native=True)
    exported_elsewhere(name, there, version)
    with zipfile.ZipFile(here) as one, zipfile.ZipFile(there) as other:
        assert one.namelist() == other.namelist()
        assert [x for x in one.namelist() if one.read(x) != other.read(x)] == []
    assert here.read_bytes() == there.read_bytes()


def test_a_state_goes_to_the_fmu_of_another_export(tmp_path):
    """Of the same model, exported at another time."""
    here, there = tmp_path / "bouncing_ball.fmu", tmp_path / "there" / "bouncing_ball.fmu"
    there.parent.mkdir()
    export_fmu(load("bouncing_ball"), here, "3.0", native=True)
    exported_elsewhere("bouncing_ball", there, "3.0")
    sides = []
    for path in (here, there):
        unzipped = fmpy.extract(str(path), unzipdir=str(path.parent / "unzipped"))
        sides.append(Side("3.0", unzipped, fmpy.read_model_description(unzipped)))
    for side in sides:
        side.begin()
    for _ in range(40):  # past the first impacts
        sides[0].step(0.02)
    taken = sides[0].fmu.serializeFMUState(sides[0].fmu.getFMUState())
    sides[1].fmu.setFMUState(sides[1].fmu.deserializeFMUState(taken))
    sides[1].time = sides[0].time
    for _ in range(20):
        assert sides[0].step(0.02) == sides[1].step(0.02)
        assert sides[0].read() == sides[1].read()
