"""Results as files: whole ones come back bit for bit, tables carry units."""

import csv
import json
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from tlismni.core import EquationSystem, Model, ModelError, PointMass2D, Result, load_result, simulate
from tlismni.models import load

PARTS = ("t", "q", "v", "a", "multipliers")


def run(name: str, t_end: float | None = None, **parameters: Any) -> Result:
    s = load(name, **parameters)
    return simulate(s.model, t_end or s.t_end, s.method, s.rtol, s.atol, **s.options)


@pytest.fixture(scope="module")
def swing() -> Result:
    s = load("pendulum_stop", law="hunt_crossley")
    return simulate(s.model, s.t_end, step_records=True)


def same(a: Result, b: Result) -> None:
    assert a.channels == b.channels and a.channel_records == b.channel_records
    for name in a.channels:
        assert a[name].tobytes() == b[name].tobytes(), name
    for part in PARTS:
        assert np.array_equal(getattr(a, part), getattr(b, part)), part
    assert a.events == b.events and a.stats == b.stats and a.redundant == b.redundant and a.fallbacks == b.fallbacks
    assert a.settings == b.settings and repr(a.settings["atol"]) == repr(b.settings["atol"])


def test_a_result_comes_back_bit_for_bit(swing: Result, tmp_path: Path) -> None:
    found = load_result(swing.save(tmp_path / "x.npz"))
    same(found, swing)
    assert found.system == swing.system and repr(found) == repr(swing)
    for name, values in swing.steps.items():
        assert np.array_equal(found.steps[name], values)
    # and once more, to the byte
    assert found.save(tmp_path / "y.npz").read_bytes() == (tmp_path / "x.npz").read_bytes()


@pytest.mark.parametrize("name, t_end", [("four_bar", 0.2), ("rocking_block", 0.3), ("hub_beam_stop", 0.02)])
def test_so_do_those_with_redundant_rows_friction_or_modes(name: str, t_end: float, tmp_path: Path) -> None:
    result = run(name, t_end)
    same(load_result(result.save(tmp_path / "x.npz")), result)


def test_equations_come_back_without_their_functions(tmp_path: Path) -> None:
    system = EquationSystem(mass=np.eye(1), force=lambda t, q, v: -q, q0=[1.0], v0=[0.0])
    result = simulate(system, 0.5)
    found = load_result(result.save(tmp_path / "x.npz"))
    same(found, result)
    assert found.system is None


def test_numpy_reads_it_too(swing: Result, tmp_path: Path) -> None:
    with np.load(swing.save(tmp_path / "x.npz")) as archive:
        assert np.array_equal(archive["pendulum.angle"], swing["pendulum.angle"])
        assert json.loads(str(archive["events"][()]))[0] == swing.events[0].to_dict()


def test_a_stored_result_can_be_animated_and_gone_on_from(swing: Result, tmp_path: Path) -> None:
    found = load_result(swing.save(tmp_path / "x.npz"))
    assert np.array_equal(found.animate().scene.frames[1].motion, swing.animate().scene.frames[1].motion)
    assert found.start_at() == swing.start_at()


class Heavy(PointMass2D):
    """A class of the user's own."""

    type: Literal["Heavy"] = "Heavy"  # type: ignore[assignment]


def test_own_classes_are_imported_only_if_that_is_allowed(tmp_path: Path, caplog: pytest.LogCaptureFixture) -> None:
    result = simulate(Model(bodies=[Heavy(name="ball", mass=2.0)]), 0.1)
    path = result.save(tmp_path / "x.npz")
    found = load_result(path)
    assert found.system is None and "allow_imports" in caplog.text
    same(found, result)
    assert load_result(path, allow_imports=True).system == result.system


def test_files_that_are_none_are_refused_with_their_name(swing: Result, tmp_path: Path) -> None:
    path = tmp_path / "x.npz"
    with pytest.raises(ModelError, match=r"x\.npz' cannot be read: No such file"):
        load_result(path)
    for content in (b"", b"no archive", swing.save(tmp_path / "whole.npz").read_bytes()[:5000]):
        path.write_bytes(content)
        with pytest.raises(ModelError, match=r"x\.npz"):
            load_result(path)
    np.savez(path, time=np.zeros(3))
    with pytest.raises(ModelError, match="no whole result"):
        load_result(path)
    with pytest.raises(ModelError, match=r"must end in \.npz"):
        swing.save(tmp_path / "x.dat")
    with pytest.raises(ModelError, match=r"must end in \.csv"):
        swing.export(tmp_path / "x.npz")


def test_csv_and_json(swing: Result, tmp_path: Path) -> None:
    with swing.export(tmp_path / "x.csv", ["pendulum.angle"]).open(newline="") as stream:
        names, *rows = list(csv.reader(stream))
    assert names == ["time", "pendulum.angle"]
    assert np.array_equal(np.array(rows, dtype=float)[:, 1], swing["pendulum.angle"])
    data = json.loads(swing.export(tmp_path / "x.json").read_text())
    assert data["units"]["stop.gap"] == "m" and data["columns"]["time"] == swing.t.tolist()
    with pytest.raises(KeyError, match="did you mean"):
        swing.export(tmp_path / "x.csv", ["pendulum.angel"])


def test_pandas_and_parquet(swing: Result, tmp_path: Path) -> None:
    pandas = pytest.importorskip("pandas")
    frame = swing.to_pandas(["pendulum.angle", "stop.gap"])
    assert frame.index.name == "time" and frame.attrs["units"] == {
        "time": "s", "pendulum.angle": "rad", "stop.gap": "m",
    }  # fmt: skip
    events = swing.events_to_pandas()
    assert list(events["kind"]) == [event.kind for event in swing.events]
    parquet = pytest.importorskip("pyarrow.parquet")
    table = parquet.read_table(swing.export(tmp_path / "x.parquet"))
    assert table.schema.field("stop.gap").metadata[b"unit"] == b"m"
    assert np.array_equal(table["stop.gap"].to_numpy(), swing["stop.gap"])
    assert len(pandas.read_parquet(tmp_path / "x.parquet")) == len(swing)


def test_xarray_netcdf_and_hdf5(swing: Result, tmp_path: Path) -> None:
    xarray = pytest.importorskip("xarray")
    data = swing.to_xarray()
    assert data["stop.normal_force"].attrs["units"] == "N" and data.attrs["model"] == "pendulum_stop"
    pytest.importorskip("h5netcdf")
    swing.export(tmp_path / "x.nc")
    with xarray.open_dataset(tmp_path / "x.nc", engine="h5netcdf", decode_times=False) as found:
        assert np.array_equal(found["stop.gap"].values, swing["stop.gap"])
        assert found["stop.gap"].attrs["units"] == "m" and found["time"].attrs["units"] == "s"
    h5py = pytest.importorskip("h5py")
    with h5py.File(swing.export(tmp_path / "x.h5")) as file:
        assert file["stop.gap"].attrs["units"] == "m" and np.array_equal(file["time"][:], swing.t)


def test_a_missing_library_is_named(swing: Result, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tlismni.core.extras.find_spec", lambda name: None)
    with pytest.raises(ImportError, match=r"needs pandas.*pip install 'tlismni\[data\]'"):
        swing.to_pandas()
    with pytest.raises(ImportError, match=r"needs matplotlib.*pip install 'tlismni\[plot\]'"):
        swing.plot("stop.gap")
