"""Everything that can be drawn, in one scene."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from browser import probe
from kinds import kinds
from tlismni.core import Result, simulate
from tlismni.viewer import Animation, animate
from tlismni.viewer.drawing.shapes import Circle


@cache
def swing() -> tuple[Result, Animation]:
    result = simulate(kinds(), 1.0, rtol=1e-5)
    return result, animate(result)


def motion(name: str) -> np.ndarray:
    return next(f.motion for f in swing()[1].scene.frames if f.name == name)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("contact, body, radius", [
    ("ledge", "ball", 0.12), ("profile", "rider", 0.1), ("catch", "drop", 0.08),
])  # fmt: skip
def test_forces_act_on_the_rim_of_the_disk_towards_its_centre(contact: str, body: str, radius: float) -> None:
    scene = swing()[1].scene
    found = next(a for a in scene.arrows if a.name == contact)
    away = motion(body)[:, :2] - found.at
    assert np.hypot(*away.T) == pytest.approx(np.full(len(away), radius))
    vector = found.vector
    pressing = np.hypot(*vector.T) > 0.0
    assert contact == "ledge" or pressing.any()
    along = np.sum(vector * away, axis=1)[pressing]
    assert along == pytest.approx(np.hypot(*vector[pressing].T) * radius)  # without friction


def test_a_watched_marker_is_a_dot_that_moves_as_its_channels_say() -> None:
    result, animation = swing()
    tip = next(f for f in animation.scene.frames if f.name == "tip")
    # frames that are at a sample: others lie between samples, and not every sample has one
    times = np.intersect1d(animation.scene.t, result.t)
    assert len(times) > 100
    rows = np.searchsorted(animation.scene.t, times, side="right") - 1
    index = np.searchsorted(result.t, times, side="right") - 1
    for k, name in enumerate(("tip.x", "tip.y", "tip.angle")):
        assert tip.motion[rows, k] == pytest.approx(result[name][index], abs=1e-12)
    for k, name in enumerate(("tip.vx", "tip.vy")):
        assert tip.velocity is not None and tip.velocity[rows, k] == pytest.approx(result[name][index], abs=1e-9)


def test_wheels_links_lines_and_disks_are_there_once() -> None:
    scene = swing()[1].scene
    circles = [s.radius for part in scene.parts for s in part.shapes if isinstance(s, Circle)]
    assert 0.6 in circles and 0.3 in circles
    assert {link.name: link.kind for link in scene.links} == {"spring": "spring-damper", "dashpot": "damper"}
    (line,) = scene.lines
    assert line.closed and len(line.nodes) == 8 and line.thickness == pytest.approx(0.04)
    assert circles.count(0.12) == 2  # the ball, and the mark of what touches; of two contacts the same
    assert not scene.gauges and scene.bands[0].name == "rope"


def test_all_of_it_can_be_drawn_in_a_browser_and_as_a_picture(tmp_path: Path) -> None:
    animation = swing()[1]
    animation.save(tmp_path / "x.html")
    script = "window.tlismni.seek(0.6); window.tlismni.paint(0); found.frames = window.tlismni.scene.frames.length;"
    found = probe(tmp_path / "x.html", script)
    assert found["failures"] == [] and "error" not in found and found["frames"] == len(animation.scene.frames)
    pytest.importorskip("PIL")
    animation.save(tmp_path / "x.gif", fps=5, seconds=1.0, width=160)
    assert (tmp_path / "x.gif").read_bytes().startswith(b"GIF89a")
