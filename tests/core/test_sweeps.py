"""Sweeps: points, answers, going on, failures, on threads and on a cluster."""

import math
import sys
from pathlib import Path

import numpy as np
import pytest
from helpers import G
from tlismni.core import Model, ModelError, simulate
from tlismni.models import load
from tlismni.models.sweep import ScenarioProblem

pytest.importorskip("pyarrow")

from tlismni.core.sweeps import ModelProblem, grid, load_sweep, sampled, sweep

BENCHMARKS = Path(__file__).parents[2] / "benchmarks"
BALL = load("bouncing_ball").model


def test_a_grid_has_every_combination_once():
    points = grid({"a": [1.0, 2.0, 3.0], "b": [5.0, 7.0]})
    assert sorted(zip(points["a"], points["b"], strict=True)) == [(a, b) for a in (1.0, 2.0, 3.0) for b in (5.0, 7.0)]


def test_a_latin_hypercube_hits_each_part_of_each_range_once():
    points = sampled({"a": (2.0, 4.0), "b": (-1.0, 0.0)}, 50, "latin", seed=3)
    for name, low, width in (("a", 2.0, 2.0), ("b", -1.0, 1.0)):
        cells = np.floor((points[name] - low) / width * 50).astype(int)
        assert sorted(cells) == list(range(50))


@pytest.mark.parametrize("sampling", ["random", "latin", "sobol"])
def test_a_seed_gives_the_same_points(sampling):
    first, again, other = (sampled({"a": (0.0, 1.0)}, 16, sampling, seed)["a"] for seed in (1, 1, 2))
    assert np.array_equal(first, again) and not np.array_equal(first, other)
    assert np.all((first >= 0.0) & (first <= 1.0))


def test_answers_are_those_of_simulate():
    """Height of a ball after one bounce: closed form, and the same bits as a run of its own."""
    found = sweep(BALL, {"restitution": [0.5, 0.7, 0.9]}, 0.8, channels=["ball.y"], rtol=1e-10, atol=1e-12)
    height = BALL.bodies[0].position[1]
    fall = math.sqrt(2.0 * height / G)
    for e, y in zip(found["restitution"], found["ball.y"], strict=True):
        s = 0.8 - fall
        assert y == pytest.approx(e * G * fall * s - 0.5 * G * s**2, abs=1e-9)
        alone = simulate(BALL.with_parameters({"restitution": e}), 0.8, rtol=1e-10, atol=1e-12)
        assert y == alone["ball.y"][-1]


def test_places_start_values_and_times():
    """A row for each run and time; a thrown ball does not care for its mass."""
    found = sweep(
        BALL, {"ball.mass": [1.0, 4.0], "start.ball.vy": [0.0, 1.0]}, 0.2, t_eval=[0.1, 0.2], channels=["ball.y"]
    )
    assert len(found) == 4 and len(found["run"]) == 8
    height = BALL.bodies[0].position[1]
    expected = height + found["start.ball.vy"] * found["time"] - 0.5 * G * found["time"] ** 2
    assert found["ball.y"] == pytest.approx(expected, abs=1e-8)


def test_failures_are_rows_with_their_cause():
    found = sweep(BALL, {"restitution": [0.5, 1.5, 0.7]}, 0.6, channels=["ball.y"])
    assert list(found.failures) == [1] and "1.5" in found.failures[1]
    assert np.isnan(found["ball.y"][1]) and np.all(np.isfinite(found["ball.y"][[0, 2]]))


class Counting:
    """A problem that says what it was asked, and breaks off where it is told to."""

    def __init__(self, breaks=math.inf):
        self.inner, self.asked, self.breaks = ModelProblem.of(BALL, 0.5, channels=["ball.y"]), [], breaks

    def identity(self):
        return self.inner.identity()

    def check(self, names):
        self.inner.check(names)

    def run(self, points, threads):
        if len(self.asked) >= self.breaks:
            raise KeyboardInterrupt
        self.asked += points["restitution"].tolist()
        return self.inner.run(points, threads)


def test_a_sweep_goes_on_where_it_ended(tmp_path):
    """Broken off after two parts of five: the rest is asked for, and nothing twice."""
    values, first, second, third = np.linspace(0.1, 0.9, 10), Counting(4), Counting(), Counting()
    with pytest.raises(KeyboardInterrupt):
        sweep(first, {"restitution": values}, out=tmp_path / "s", part=2)
    half = load_sweep(tmp_path / "s")
    assert len(half) == 4 and not half.complete
    found = sweep(second, {"restitution": values}, out=tmp_path / "s", part=2)
    assert first.asked + second.asked == values.tolist() and found.complete
    assert np.array_equal(found["restitution"], values)
    sweep(third, {"restitution": values}, out=tmp_path / "s", part=2)
    assert third.asked == []
    whole = sweep(Counting(), {"restitution": values})
    assert np.array_equal(found["ball.y"], whole["ball.y"])


def test_a_folder_belongs_to_one_sweep(tmp_path):
    sweep(BALL, {"restitution": [0.5]}, 0.1, out=tmp_path / "s")
    heavier = BALL.with_parameters({"ball.mass": 7.0})
    for model, t_end in ((BALL, 0.2), (heavier, 0.1)):
        with pytest.raises(ModelError, match="holds another sweep"):
            sweep(model, {"restitution": [0.5]}, t_end, out=tmp_path / "s")
    (tmp_path / "other").mkdir()
    (tmp_path / "other" / "file").write_text("mine")
    with pytest.raises(ModelError, match="not empty and no sweep"):
        sweep(BALL, {"restitution": [0.5]}, 0.1, out=tmp_path / "other")


def test_parameters_of_a_scenario():
    """A number that the builder takes, beside a start value; its own end time follows."""
    problem = ScenarioProblem.of("impact_oscillator", {"restitution": 0.5}, channels=["mass.x"])
    found = sweep(problem, {"frequency": [2.0, 4.0], "start.mass.vx": [0.0, 0.5]})
    assert found["time"] == pytest.approx(12.0 * math.pi / found["frequency"])
    scenario = load("impact_oscillator", restitution=0.5, frequency=4.0, start_velocity=0.5)
    result = simulate(scenario.model, scenario.t_end, scenario.method, scenario.rtol, scenario.atol)
    assert found["mass.x"][3] == pytest.approx(result["mass.x"][-1], abs=1e-9)


def test_wrong_names_and_values():
    for name, said in (("mas", "is no parameter"), ("ball.vy", r"write 'start\.ball\.vy'"), ("ball.mas", "no field")):
        with pytest.raises(ModelError, match=said):
            sweep(BALL, {name: [1.0]}, 0.1)
    with pytest.raises(ModelError, match="low < high"):
        sweep(BALL, {"restitution": (0.9, 0.5)}, 0.1, samples=4)
    with pytest.raises(ModelError, match="give t_end"):
        sweep(BALL, {"restitution": [0.5]})
    with pytest.raises(ModelError, match="no sampling 'lattin'"):
        sampled({"a": (0.0, 1.0)}, 4, "lattin")
    with pytest.raises(ModelError, match="no folder of a sweep"):
        load_sweep("/nowhere")
    with pytest.raises(ModelError, match="is needed to sweep"):
        sweep("bouncing_ball", {"restitution": [0.5]}, 1.0)


def test_plots(tmp_path):
    pytest.importorskip("matplotlib")
    found = sweep(BALL, {"restitution": [0.5, 0.7], "start.ball.vy": [0.0, 1.0, 2.0]}, 0.6, channels=["ball.y"])
    for colour, name in ((None, "points"), ("ball.y", "map")):
        found.plot("start.ball.vy" if colour else "ball.y", colour=colour, path=tmp_path / f"{name}.png")
        assert (tmp_path / f"{name}.png").read_bytes().startswith(b"\x89PNG")
    with pytest.raises(KeyError, match=r"no column 'ball\.z'"):
        found.plot("ball.z")


def test_a_cluster_that_does_not_answer(monkeypatch):
    pytest.importorskip("distributed")
    monkeypatch.setattr("tlismni.core.sweeps.cluster.CONNECT", 0.5)
    with pytest.raises(ModelError, match=r"no Dask scheduler answers at 'tcp://127\.0\.0\.1:1'"):
        sweep(BALL, {"restitution": [0.5]}, 0.1, cluster="tcp://127.0.0.1:1")


@pytest.mark.slow
def test_killed_workers_and_a_killed_sweep_lose_and_repeat_nothing(tmp_path, monkeypatch):
    """The benchmark of 10 000 runs, with 144: one of two workers is killed, then the sweep and its cluster."""
    pytest.importorskip("distributed")
    monkeypatch.syspath_prepend(str(BENCHMARKS))
    import sweep_survival

    try:
        figures = sweep_survival.survive(tmp_path / "s", 144, 6)
    finally:
        sys.modules.pop("sweep_survival", None)
    assert figures["runs"] == figures["rows"] == 144
    assert figures["every_run_once"] and figures["same_bits_as_alone"]
    assert figures["parts_before_restart"] >= 12 and figures["parts_computed_again"] == 0
    assert figures["failed"] == 0


def test_models_that_are_files_and_models_in_memory_are_one_problem(tmp_path):
    BALL.save(tmp_path / "ball.json")
    again = Model.load(tmp_path / "ball.json")
    assert ModelProblem.of(again, 1.0).identity() == ModelProblem.of(BALL, 1.0).identity()


def test_units_stand_in_the_table_in_the_folder_and_at_the_axes(tmp_path):
    found = sweep(
        BALL, {"restitution": [0.5, 0.6], "start.ball.vy": [0.0, 1.0]}, 0.1, out=tmp_path, channels=["ball.y"]
    )
    told = {"ball.y": "m", "start.ball.vy": "m/s", "time": "s", "restitution": "1"}
    table = pytest.importorskip("pyarrow.parquet").read_table(tmp_path / "table.parquet")
    assert table.schema.field("ball.y").metadata == {b"unit": b"m"} and table.schema.field("run").metadata is None
    for units in (found.units, load_sweep(tmp_path).units):
        assert {name: units[name] for name in told} == told
    pytest.importorskip("matplotlib")
    (axis,) = found.plot("ball.y", "start.ball.vy").axes
    assert (axis.get_xlabel(), axis.get_ylabel()) == ("start.ball.vy (m/s)", "ball.y (m)")
