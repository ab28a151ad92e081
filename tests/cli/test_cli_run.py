"""`tlismni run`: figures against closed forms, files, failures."""

import csv
import json
import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tlismni.cli.errors import Failure
from tlismni.cli.result_files import replace_whole
from tlismni.core import Result, simulate
from tlismni.models import load

Command = Callable[..., Any]

G = 9.81


@pytest.fixture(scope="module")
def ball() -> Result:
    s = load("bouncing_ball", restitution=0.5)
    return simulate(s.model, s.t_end, s.method, s.rtol, s.atol)


def test_step_records_as_a_file(tlismni: Command, tmp_path: Path) -> None:
    target = tmp_path / "steps.csv"
    done = tlismni("run", "chain", "--set", "links=2", "--t-end", "0.5", "--steps", str(target), "--json")
    with target.open() as stream:
        rows = list(csv.DictReader(stream))
    statistics = done.json["statistics"]
    assert len(rows) == statistics["steps"]
    assert sum(float(row["h"]) for row in rows) == pytest.approx(0.5, rel=1e-12)
    assert sum(float(row["outer"]) for row in rows) == statistics["outer_iterations"]
    assert tlismni("run", "chain", "--steps", "steps.txt").code == 2


def test_json_figures_of_a_bouncing_ball(tlismni: Command) -> None:
    done = tlismni("run", "bouncing_ball", "--set", "height=2", "--set", "restitution=0.5", "--json")
    assert done.code == 0
    figures = done.json
    first, second = figures["events"][:2]
    fall = math.sqrt(4.0 / G)
    assert first["kind"] == "impact" and first["contact"] == "floor"
    assert first["t"] == pytest.approx(fall, abs=1e-9)
    assert second["t"] == pytest.approx(2.0 * fall, abs=1e-9)
    assert first["approach_speed"] == pytest.approx(G * fall, rel=1e-9)
    assert first["separation_speed"] == pytest.approx(0.5 * G * fall, rel=1e-9)
    assert first["impulse"] == pytest.approx(1.5 * G * fall, rel=1e-9)
    assert first["energy_loss"] == pytest.approx(0.75 * 2.0 * G, rel=1e-9)
    assert figures["parameters"]["height"] == 2.0
    assert figures["energy"]["initial"] == pytest.approx(2.0 * G)
    assert figures["energy"]["impact_loss"] == pytest.approx(2.0 * G, rel=1e-6)
    assert abs(figures["energy"]["largest_balance"]) < 1e-7
    assert set(figures["residuals"]) == {"position", "velocity", "acceleration", "velocity_increment"}
    assert max(figures["residuals"].values()) < 1e-10
    assert figures["statistics"]["steps"] > 0
    assert done.err == ""


def test_summary_in_words(tlismni: Command) -> None:
    done = tlismni("run", "pendulum_stop")
    assert done.code == 0
    for text in ("3 events", "impact", "velocity increment", "largest balance", "outer iterations", "pendulum.angle"):
        assert text in done.out


def test_many_events_are_shortened(tlismni: Command) -> None:
    done = tlismni("run", "bouncing_ball")
    assert "more …" in done.out
    assert done.out.count("impact") < 40


def test_solver_settings_reach_the_run(tlismni: Command) -> None:
    done = tlismni(
        "run", "chain", "--set", "links=2", "--t-end", 0.1, "--method", "hht", "--option", "alpha=-0.1",
        "--step", "0.01", "--json",
    )  # fmt: skip
    assert done.json["solver"] == {
        "method": "hht", "rtol": 1e-6, "atol": 1e-9, "step": 0.01, "options": {"alpha": -0.1},
    }  # fmt: skip
    assert done.json["statistics"]["steps"] == 10


def test_tighter_tolerances_cost_more_steps(tlismni: Command) -> None:
    runs = [
        tlismni("run", "chain", "--set", "links=2", "--t-end", 0.3, "--rtol", rtol, "--json").json
        for rtol in (1e-4, 1e-9)
    ]
    loose, tight = (run["statistics"]["steps"] for run in runs)
    assert tight > loose


def test_csv_reads_back_bit_for_bit(tlismni: Command, ball: Result, tmp_path: Path) -> None:
    path = tmp_path / "new" / "ball.csv"
    done = tlismni("run", "bouncing_ball", "--set", "restitution=0.5", "-o", path, "--json")
    assert done.json["files"] == [str(path)]
    with path.open(newline="") as stream:
        names, *rows = list(csv.reader(stream))
    assert names == ["time", *ball.channels]
    table = np.array(rows, dtype=float)
    assert np.array_equal(table[:, 0], ball.t)
    assert np.array_equal(table[:, names.index("ball.y")], ball["ball.y"])
    assert list(path.parent.iterdir()) == [path]


def test_npz_and_json_files(tlismni: Command, ball: Result, tmp_path: Path) -> None:
    for suffix in (".npz", ".json"):
        assert tlismni("run", "bouncing_ball", "--set", "restitution=0.5", "-o", tmp_path / f"ball{suffix}").code == 0
    with np.load(tmp_path / "ball.npz") as archive:
        assert np.array_equal(archive["ball.vy"], ball["ball.vy"])
        assert json.loads(archive["events"][()])[0] == ball.events[0].to_dict()
    data = json.loads((tmp_path / "ball.json").read_text())
    assert data["units"]["ball.vy"] == "m/s"
    assert data["columns"]["time"] == ball.t.tolist()


def test_recording_at_intervals(tlismni: Command, tmp_path: Path) -> None:
    done = tlismni("run", "bouncing_ball", "--t-end", 0.35, "--every", 0.1, "-o", tmp_path / "b.npz", "--json")
    assert done.json["samples"] == 5
    with np.load(tmp_path / "b.npz") as archive:
        assert archive["time"] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.35])
        assert archive["ball.y"] == pytest.approx(1.0 - 0.5 * G * archive["time"] ** 2, abs=1e-9)


def test_plot(tlismni: Command, tmp_path: Path) -> None:
    assert tlismni("run", "pendulum_stop", "--plot", tmp_path / "p.png").code == 0
    assert (tmp_path / "p.png").read_bytes().startswith(b"\x89PNG")


def test_model_file(tlismni: Command, tmp_path: Path) -> None:
    path = tmp_path / "ball.json"
    load("bouncing_ball").model.save(path)
    done = tlismni("run", path, "--t-end", 1.0, "--set", "restitution=0.25", "--json")
    (impact, *_) = done.json["events"]
    assert impact["separation_speed"] == pytest.approx(0.25 * impact["approach_speed"])
    assert done.json["parameters"] == {"restitution": 0.25}


def test_model_file_needs_an_end_time(tlismni: Command, tmp_path: Path) -> None:
    path = tmp_path / "ball.json"
    load("bouncing_ball").model.save(path)
    done = tlismni("run", path)
    assert done.code == 2 and "--t-end" in done.err


@pytest.mark.parametrize(
    "arguments, text",
    [
        (("no_such_scenario",), "there is no scenario 'no_such_scenario'"),
        (("chain", "--set", "link=2"), "did you mean 'links'?"),
        (("chain", "--set", "links=many"), "'many' is not a number"),
        (("chain", "--set", "links=0"), "outside [1, 20000]"),
        (("pendulum_stop", "--set", "law=rubber"), "'rubber' is not one of"),
        (("chain", "--method", "euler"), "unknown method 'euler'"),
        (("chain", "--option", "order=2"), "method 'auto' has no option ['order']"),
        (("chain", "--option", "k=9"), "must be a whole number from 1 to 8"),
        (("chain", "--option", "k=two"), "not 'two'"),
        (("chain", "--option", "record=false"), "no option ['record']"),
        (("no_such_file.json", "--t-end", "1"), "No such file"),
        (("chain", "--step", "1.0", "--option", "outer=simple"), "or a smaller step"),
    ],
)
def test_failures_are_one_line_and_exit_code_1(tlismni: Command, arguments: tuple[str, ...], text: str) -> None:
    done = tlismni("run", *arguments)
    assert done.code == 1
    assert done.out == ""
    assert done.cause.startswith("tlismni: ") and text in done.cause


def test_a_damaged_model_file_is_one_line(tlismni: Command, tmp_path: Path) -> None:
    path = tmp_path / "bad.json"
    path.write_text('{"name": "bad", "bodies": [{"type": "PointMass2D", "name": "p", "mass": -1}, {"type": "x"}]}')
    done = tlismni("run", path, "--t-end", 1)
    assert done.code == 1 and "greater than 0" in done.cause


@pytest.mark.parametrize("option, name", [("-o", "x.csv"), ("--plot", "x.png")])
def test_a_target_that_cannot_be_written_is_refused_before_the_run(
    tlismni: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path, option: str, name: str
) -> None:
    def never(*args: object, **kwargs: object) -> None:
        raise AssertionError("the run was started")

    monkeypatch.setattr("tlismni.core.simulate", never)
    (tmp_path / "file").write_text("")
    (tmp_path / name).mkdir()
    for target in (tmp_path / "file" / name, tmp_path / "file" / "deeper" / name, tmp_path / name):
        done = tlismni("run", "chain", "--t-end", 0.01, option, target)
        assert done.code == 1 and f"'{target}' cannot be written" in done.cause
    assert sorted(path.name for path in tmp_path.iterdir()) == ["file", name]


def test_a_file_that_fails_while_it_is_written_is_named(tmp_path: Path) -> None:
    def full(name: str) -> None:
        raise OSError(28, "No space left on device", name)

    target = tmp_path / "x.csv"
    with pytest.raises(Failure) as caught:
        replace_whole(target, full)
    assert str(caught.value) == f"'{target}' cannot be written: No space left on device"
    assert list(tmp_path.iterdir()) == []


def test_more_samples_than_fit_are_refused(tlismni: Command) -> None:
    done = tlismni("run", "chain", "--t-end", 2, "--every", 1e-12)
    text = " ".join(done.err.replace("│", " ").split())
    assert done.code == 2 and "--every" in text
    assert "1e-12 s would give 2e+12 points up to t_end = 2 s" in text and "at least 2e-07 s" in text


@pytest.mark.parametrize(
    "arguments",
    [
        ("chain", "--set", "links"),
        ("chain", "--set", "links=2", "--set", "links=3"),
        ("chain", "--rtol", "0"),
        ("chain", "--rtol", "nan"),
        ("chain", "--t-end", "soon"),
        ("chain", "-o", "result.xlsx"),
        ("chain", "--plot", "figure.csv"),
        ("chain", "--no-such-option"),
        (),
    ],
)
def test_wrong_usage_is_exit_code_2(tlismni: Command, arguments: tuple[str, ...]) -> None:
    done = tlismni("run", *arguments)
    assert done.code == 2
    assert done.out == ""
    assert "Traceback" not in done.err


def test_a_surprise_is_one_line_too(tlismni: Command, monkeypatch: pytest.MonkeyPatch) -> None:
    def broken(*args: object, **kwargs: object) -> None:
        raise ZeroDivisionError("a fault\nof two lines")

    monkeypatch.setattr("tlismni.core.simulate", broken)
    done = tlismni("run", "chain")
    assert done.code == 1
    assert done.cause == "tlismni: ZeroDivisionError: a fault of two lines (run again with --debug to see where)"


def test_a_missing_extra_is_named(tlismni: Command, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setitem(__import__("sys").modules, "matplotlib.figure", None)
    done = tlismni("run", "chain", "--t-end", 0.01, "--plot", tmp_path / "p.png")
    assert done.code == 1
    assert 'pip install "tlismni[plot]"' in done.cause


def test_auto_says_what_it_took(tlismni: Command) -> None:
    done = tlismni("run", "chain", "--method", "auto", "--t-end", "0.05")
    assert "auto took adams (order=6): nothing is stiff or damped" in done.out
    assert tlismni("run", "chain", "--method", "auto", "--t-end", "0.05", "--json").json["solver"]["chosen"]
    assert tlismni("run", "chain", "--t-end", "0.05").out.startswith("chain: 0 to 0.05 s with auto")
    assert "auto took ebdf (k=3)" in tlismni("run", "chain", "--t-end", "0.05", "--option", "k=3").out
    assert "has no option ['order']" in tlismni("run", "chain", "--method", "auto", "--option", "order=3").err
