"""The page: one file that loads nothing, whatever names a model has."""

import json
import re
from pathlib import Path

import pytest
from browser import probe
from runs import run
from tlismni.core import Model, ModelError, PointMass2D, simulate
from tlismni.viewer import show


def test_the_page_loads_nothing_from_elsewhere(tmp_path: Path) -> None:
    text = run("pendulum_stop").animate(tmp_path / "x.html").html()
    assert (tmp_path / "x.html").read_text(encoding="utf-8") == text
    assert not re.search(r"https?://|//cdn|@import|\burl\(", text)
    assert not re.search(r'(?:src|href)\s*=\s*"(?!data:)', text)
    assert "default-src 'none'" in text
    for forbidden in ("fetch(", "XMLHttpRequest", "WebSocket", "import("):
        assert forbidden not in text


def test_names_cannot_break_out_of_the_page() -> None:
    evil = 'x</script><script>alert("1")</script><!--'
    model = Model(description=evil, bodies=[PointMass2D(name="ball", mass=1.0)])
    text = show(model, title=evil).html()
    assert evil not in text
    (data,) = re.findall(r'<script id="scene" type="application/json">(.*?)</script>', text, re.S)
    assert json.loads(data)["title"] == evil


def test_other_files_are_refused(tmp_path: Path) -> None:
    animation = run("pendulum_stop").animate()
    with pytest.raises(ModelError, match=r"\.html"):
        animation.save(tmp_path / "x.avi")
    with pytest.raises(ModelError, match="options of films"):
        animation.save(tmp_path / "x.html", fps=3)


def test_a_notebook_shows_it_in_a_frame() -> None:
    text = run("pendulum_stop").animate()._repr_html_()
    assert text.startswith("<iframe srcdoc=") and text.count("<") == 2


@pytest.mark.sampled(1)
@pytest.mark.parametrize("size", [(1280, 800), (390, 844)], ids=["desktop", "phone"])
def test_in_a_browser_it_plays_and_shows_what_the_result_says(tmp_path: Path, size: tuple[int, int]) -> None:
    result = run("pendulum_stop")
    result.animate(tmp_path / "x.html")
    row = 40
    found = probe(
        tmp_path / "x.html",
        """
    const t = window.tlismni;
    found.time = TIME;
    t.seek(found.time);
    t.paint(0);
    found.pose = t.pose(1, t.place(found.time));
    found.shown = t.state.time;
    found.readout = document.getElementById("clock").textContent;
    const view = document.getElementById("view");
    const pixels = view.getContext("2d").getImageData(0, 0, view.width, view.height).data;
    const colours = new Set();
    for (let i = 0; i < pixels.length; i += 4) colours.add((pixels[i] << 16) + (pixels[i + 1] << 8) + pixels[i + 2]);
    found.colours = colours.size;
    document.getElementById("after").click();
    found.next = t.state.time;
    document.getElementById("play").click();
    // a browser without a screen need not call for pictures: the clock is turned by hand
    t.state.since = undefined;
    t.paint(1000);
    t.paint(1050);
    document.getElementById("play").click();
    found.played = t.state.time - found.next;
    found.marks = document.getElementById("kinds").textContent;
    found.plots = document.querySelectorAll(".card").length;
    found.before = t.camera.scale;
    document.getElementById("closer").click();
    found.after = t.camera.scale;
    document.dispatchEvent(new KeyboardEvent("keydown", { key: "End" }));
    found.end = t.state.time;
    found.wide = document.documentElement.scrollWidth - window.innerWidth;
    """.replace("TIME", repr(float(result.t[row]))),
        size,
    )
    assert "error" not in found and found["failures"] == []
    expected = [result[f"pendulum.{name}"][row] for name in ("x", "y", "angle")]
    assert found["pose"] == pytest.approx(expected, abs=1e-6)
    assert found["shown"] == found["time"] and found["readout"].startswith(f"{found['time']:.3f}")
    assert found["colours"] > 20
    later = [event.t for event in result.events if event.t > found["time"]]
    assert found["next"] == later[0] and found["played"] == pytest.approx(0.05, abs=1e-9)
    assert "impact 3" in found["marks"] and found["plots"] >= 2
    assert found["after"] == pytest.approx(1.25 * found["before"])
    assert found["end"] == result.t[-1]
    assert found["wide"] <= 0


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["hub_beam_stop", "rod_wall", "woodpecker"])
def test_other_kinds_of_scenes_work_in_a_browser(tmp_path: Path, name: str) -> None:
    run(name).animate(tmp_path / "x.html")
    found = probe(
        tmp_path / "x.html",
        """
    const t = window.tlismni;
    t.seek(0.5 * t.scene.t.numbers[t.scene.t.numbers.length - 1]);
    for (const button of document.querySelectorAll("#shows button")) button.click();
    t.paint(0);
    found.drawn = t.state.time > 0;
    """,
    )
    assert found["drawn"] and found["failures"] == [] and "error" not in found


def test_a_start_has_no_controls_of_time(tmp_path: Path) -> None:
    result = simulate(Model(bodies=[PointMass2D(name="ball", mass=1.0)]), 0.0)
    show(result.system).save(tmp_path / "x.html")
    found = probe(tmp_path / "x.html", "found.hidden = document.getElementById('transport').offsetHeight === 0;")
    assert found["hidden"] and found["failures"] == []
