"""`tlismni sweep`."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tlismni.models import load

pytest.importorskip("pyarrow")

from tlismni.core.sweeps import load_sweep

Command = Callable[..., Any]
G = 9.81


def test_a_grid_with_a_figure_and_once_more(tlismni: Command, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    out = tmp_path / "s"
    asked = ("sweep", "bouncing_ball", "--vary", "restitution=0:1.1:12", "--out", out, "--t-end", 0.7)
    done = tlismni(*asked, "--channel", "ball.vy", "--plot", "ball.vy", "--json")
    assert done.code == 0 and done.json["runs"] == 12
    assert list(done.json["failed"]) == ["11"] and "outside" in done.json["failed"]["11"]
    found = load_sweep(out)
    fall = math.sqrt(2.0 * 1.0 / G)
    bounced = found["restitution"] >= 0.5
    height = load("bouncing_ball").model.bodies[0].position[1]
    fall = math.sqrt(2.0 * height / G)
    rates = found["restitution"][bounced] * G * fall - G * (0.7 - fall)
    assert found["ball.vy"][bounced][:-1] == pytest.approx(rates[:-1], abs=1e-4)
    assert (out / "ball.vy.png").read_bytes().startswith(b"\x89PNG")
    times = {path: path.stat().st_mtime_ns for path in (out / "parts").iterdir()}
    again = tlismni(*asked, "--channel", "ball.vy")
    assert again.code == 0 and "causes" in again.out
    shown = [line.split() for line in again.out.splitlines() if line.split()[:1] == ["0.5"]]
    assert [float(word) for (_, word) in shown] == pytest.approx(
        found["ball.vy"][found["restitution"] == 0.5], rel=1e-5
    )
    assert times == {path: path.stat().st_mtime_ns for path in (out / "parts").iterdir()}


def test_samples_of_a_model_file(tlismni: Command, tmp_path: Path) -> None:
    path = tmp_path / "ball.json"
    load("bouncing_ball").model.save(path)
    done = tlismni(
        "sweep", path, "--t-end", 0.2, "--vary", "ball.mass=1:2", "--vary", "start.ball.vy=-1:1", "--samples", 8,
        "--sampling", "sobol", "--every", 0.1, "--channel", "ball.y", "--out", tmp_path / "s", "--json",
    )  # fmt: skip
    assert done.code == 0 and done.json["runs"] == 8
    assert len(load_sweep(tmp_path / "s")["run"]) == 24


def test_wrong_usage(tlismni: Command, tmp_path: Path) -> None:
    for text in ("restitution=0:1", "restitution=a,b", "restitution=0:1:0"):
        done = tlismni("sweep", "bouncing_ball", "--vary", text, "--out", tmp_path / "s")
        assert done.code == 2 and "--vary" in done.err
    done = tlismni("sweep", "bouncing_ball", "--vary", "restitution=0:1:3", "--samples", 4, "--out", tmp_path / "s")
    assert done.code == 2 and "low:high" in done.err
    done = tlismni("sweep", "bouncing_ball", "--vary", "bounce=1,2", "--out", tmp_path / "s")
    assert done.code == 1 and "'bounce' is no parameter" in done.cause
