"""`tlismni show`, `play` and `run --animate`."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tlismni.core import load_result
from tlismni.models import load

Command = Callable[..., Any]


def test_a_run_writes_its_motion_and_its_result_and_the_result_plays(tlismni: Command, tmp_path: Path) -> None:
    page, stored = tmp_path / "new" / "x.html", tmp_path / "x.npz"
    done = tlismni("run", "pendulum_stop", "--animate", page, "-o", stored, "--json")
    assert done.code == 0 and done.json["files"] == [str(stored), str(page)]
    assert "pendulum.angular_velocity" in page.read_text(encoding="utf-8")
    result = load_result(stored)
    assert result.system == load("pendulum_stop").model and len(result.events) == 3
    again = tmp_path / "again.html"
    assert tlismni("play", stored, "--channel", "stop.gap", "-o", again).code == 0
    assert '"plots":["stop.gap"]' in again.read_text(encoding="utf-8")


def test_an_unknown_channel_is_answered_in_one_line(tlismni: Command, tmp_path: Path) -> None:
    stored = tmp_path / "x.npz"
    tlismni("run", "pendulum_stop", "--t-end", 0.1, "-o", stored)
    done = tlismni("play", stored, "--channel", "pendulum.angel", "-o", tmp_path / "x.html")
    assert done.code == 1 and "did you mean ['pendulum.angle'" in done.cause
    assert not (tmp_path / "x.html").exists()


def test_a_film_from_the_command_line(tlismni: Command, tmp_path: Path) -> None:
    pytest.importorskip("PIL")
    path = tmp_path / "x.gif"
    # 50 pictures: a shorter run is drawn slower, in 150
    assert tlismni("run", "bouncing_ball", "--t-end", 2.0, "--animate", path).code == 0
    assert path.read_bytes().startswith(b"GIF89a")


def test_show_draws_scenarios_and_model_files(tlismni: Command, tmp_path: Path) -> None:
    model = tmp_path / "m.json"
    load("bouncing_ball").model.save(model)
    for source in ("slider_crank_stop", model):
        page = tmp_path / "show.html"
        done = tlismni("show", source, "-o", page)
        assert done.code == 0 and "as it starts" in page.read_text(encoding="utf-8")


def test_without_an_output_the_browser_opens(tlismni: Command, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    opened: list[str] = []
    monkeypatch.setattr("webbrowser.open", lambda url: opened.append(url) or True)
    monkeypatch.setattr("tempfile.mkdtemp", lambda prefix: str(tmp_path))
    assert tlismni("show", "pendulum_stop").code == 0
    assert opened == [(tmp_path / "pendulum_stop.html").as_uri()] and (tmp_path / "pendulum_stop.html").is_file()
    monkeypatch.setattr("webbrowser.open", lambda url: False)
    done = tlismni("show", "pendulum_stop")
    assert done.code == 1 and "no browser could be opened" in done.err and "--output" in done.err


def test_bad_files_are_refused_before_any_work(tlismni: Command, tmp_path: Path) -> None:
    assert tlismni("run", "pendulum_stop", "--animate", "x.avi").code == 2
    assert tlismni("show", "pendulum_stop", "-o", "x.gif").code == 2
    broken = tmp_path / "x.npz"
    broken.write_bytes(b"nothing")
    done = tlismni("play", broken, "-o", tmp_path / "x.html")
    assert done.code == 1 and "cannot be read" in done.err


@pytest.mark.sampled(1)
@pytest.mark.parametrize("suffix", [".parquet", ".nc", ".h5"])
def test_tables_for_others(tlismni: Command, tmp_path: Path, suffix: str) -> None:
    for module in ("pyarrow", "xarray", "h5netcdf", "h5py"):
        pytest.importorskip(module)
    path = tmp_path / f"x{suffix}"
    assert tlismni("run", "bouncing_ball", "--t-end", 0.5, "-o", path).code == 0
    if suffix == ".h5":
        import h5py

        with h5py.File(path) as file:
            assert file["ball.vy"].attrs["units"] == "m/s" and np.isfinite(file["ball.vy"][:]).all()
    assert path.stat().st_size > 1000
