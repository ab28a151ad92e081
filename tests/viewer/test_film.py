"""Films: GIF and MP4 of a run."""

import importlib.util
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from runs import run
from tlismni.core import ModelError
from tlismni.viewer import show
from tlismni.viewer.still import still

image = pytest.importorskip("PIL.Image")


def test_a_gif_has_the_pictures_that_were_asked_for(tmp_path: Path) -> None:
    run("pendulum_stop").animate(tmp_path / "x.gif", fps=10, seconds=2.0, width=200)
    with image.open(tmp_path / "x.gif") as film:
        assert film.n_frames == 20 and film.info["duration"] == 100
        assert max(film.size) == pytest.approx(200, abs=2) and all(n % 2 == 0 for n in film.size)
        first = np.asarray(film.convert("RGB"), dtype=int)
        film.seek(5)
        assert np.abs(np.asarray(film.convert("RGB"), dtype=int) - first).max() > 100


def test_an_mp4_can_be_read_again(tmp_path: Path) -> None:
    ffmpeg = pytest.importorskip("imageio_ffmpeg")
    run("rod_wall").animate(tmp_path / "x.mp4", fps=10, seconds=1.0, width=160)
    frames, seconds = ffmpeg.count_frames_and_secs(str(tmp_path / "x.mp4"))
    assert frames == 10 and seconds == pytest.approx(1.0, abs=0.11)


def test_a_still_shows_the_body_where_the_scene_has_it() -> None:
    scene = run("pendulum_stop").animate().scene
    k = len(scene.t) // 3
    x, y, angle = scene.frames[1].motion[k]
    tip = x + 0.5 * np.cos(angle), y + 0.5 * np.sin(angle)
    points = [p for shape in still(scene, k).shapes for p in getattr(shape, "points", [])]
    assert min(np.hypot(px - tip[0], py - tip[1]) for px, py in points) < 1e-9


def test_what_makes_no_film_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ModelError, match="a film needs a run"):
        show(run("pendulum_stop").system).save(tmp_path / "x.gif")
    with pytest.raises(ModelError, match="pictures"):
        run("pendulum_stop").animate(tmp_path / "x.gif", fps=0)


def test_a_missing_library_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    real = importlib.util.find_spec

    def without(name: str, *rest: Any) -> Any:
        return None if name == "imageio_ffmpeg" else real(name, *rest)

    monkeypatch.setattr("tlismni.core.extras.find_spec", without)
    with pytest.raises(ImportError, match=r"imageio-ffmpeg.*pip install 'tlismni\[film\]'"):
        run("pendulum_stop").animate(tmp_path / "x.mp4")
