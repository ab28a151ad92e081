"""`tlismni run --input`, `--channel`, and Ctrl-C."""

import csv
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tlismni.cli.completion import methods, sources
from tlismni.core import AppliedForce2D, CoordinateDriver, Input, InputSignal, Marker2D, Model, PointMass2D

Command = Callable[..., Any]


@pytest.fixture
def pushed(tmp_path: Path) -> Path:
    """A mass of 2 kg that an input pushes along x."""
    push = AppliedForce2D(name="push", marker=Marker2D(body="p"), force_x=InputSignal(channel="force"))
    model = Model(
        name="pushed", gravity=(0.0, 0.0), bodies=[PointMass2D(name="p", mass=2.0)], forces=[push],
        inputs=[Input(name="force", unit="N")],
    )  # fmt: skip
    model.save(tmp_path / "pushed.json")
    return tmp_path / "pushed.json"


def last(path: Path) -> dict[str, float]:
    rows = list(csv.DictReader(path.open()))
    return {name: float(x) for name, x in rows[-1].items()}


def test_a_file_of_inputs_and_chosen_channels(tlismni: Command, pushed: Path, tmp_path: Path) -> None:
    table, out = tmp_path / "force.csv", tmp_path / "out.csv"
    table.write_text("time,force\n0,0\n0.5,4\n1,0\n")
    asked = ("run", pushed, "--t-end", 1, "--rtol", 1e-9, "--input", table, "--output", out, "--every", 0.1)
    done = tlismni(*asked, "--channel", "p.x,p.vx", "--json")
    assert done.code == 0
    assert set(last(out)) == {"time", "p.x", "p.vx"} and last(out)["p.vx"] == pytest.approx(1.0, abs=1e-7)
    assert tlismni(*asked, "--hold").code == 0
    assert last(out)["p.vx"] == pytest.approx(1.0, abs=1e-7)


def test_a_file_of_positions_leads_a_motion(tlismni: Command, tmp_path: Path) -> None:
    """Straight lines, a spline (three points: the parabola 4 t (1 - t)), steps that are joined a time later."""
    hand = CoordinateDriver(name="hand", body="p", coordinate="x", motion=InputSignal(channel="x"))
    body = PointMass2D(name="p", mass=2.0)
    Model(gravity=(0.0, 0.0), bodies=[body], joints=[hand], inputs=[Input(name="x", unit="m")]).save(
        tmp_path / "m.json"
    )
    table, out = tmp_path / "x.csv", tmp_path / "out.csv"
    table.write_text("time,x\n0,0\n0.5,1\n1,0\n")
    asked = ("run", tmp_path / "m.json", "--t-end", 0.75, "--input", table, "--output", out, "--every", 0.25)
    for more, x, vx in (((), 0.5, -2.0), (("--spline",), 0.75, -2.0), (("--hold",), 0.6875, 3.0)):
        assert tlismni(*asked, *more).code == 0
        assert last(out)["p.x"] == pytest.approx(x, abs=1e-9) and last(out)["p.vx"] == pytest.approx(vx, abs=1e-7)
    assert tlismni(*asked, "--hold", "--spline").code == 2


def test_a_number(tlismni: Command, pushed: Path, tmp_path: Path) -> None:
    out = tmp_path / "out.csv"
    done = tlismni("run", pushed, "--t-end", 1, "--input", "force=3", "--output", out)
    assert done.code == 0 and last(out)["p.vx"] == pytest.approx(1.5, rel=1e-6)


def test_what_is_wrong_is_said(tlismni: Command, pushed: Path, tmp_path: Path) -> None:
    run = ("run", pushed, "--t-end", 1)
    as_parameter = tlismni(*run, "--set", "force=2").cause
    assert "'force' is an input, not a parameter" in as_parameter and "--input force=VALUE" in as_parameter
    assert "there is no input ['farce']" in tlismni(*run, "--input", "farce=2").cause
    assert tlismni(*run, "--input", "force=two").code == 2
    assert "cannot be read" in tlismni(*run, "--input", tmp_path / "none.csv").cause
    for text, said in (
        ("seconds,force\n0,1\n", "one column called 'time'"),
        ("time,force\n", "at least one of numbers"),
        ("time,force\n0,x\n", "row 2"),
        ("time,force\n0,1\n0,2\n", "grow strictly"),
        ("time,farce\n0,1\n", "there is no input"),
    ):
        (tmp_path / "bad.csv").write_text(text)
        assert said in tlismni(*run, "--input", tmp_path / "bad.csv").cause
    assert "there are no channels ['p.z']" in tlismni(*run, "--channel", "p.z").cause
    assert tlismni(*run, "--channel", "p.x", "--output", tmp_path / "r.npz").code == 2


def test_inputs_and_parameters_that_are_taken_for_each_other(tlismni: Command, pushed: Path) -> None:
    for source in (pushed, "pendulum_stop"):
        name = "force" if source == pushed else "torque"
        said = tlismni("run", source, "--t-end", 1, "--set", f"{name}=3").cause
        assert said == f"tlismni: '{name}' is an input, not a parameter: give it by --input {name}=VALUE, or in a file"
    said = tlismni("run", "pendulum_stop", "--input", "mass=3").cause
    assert said == "tlismni: 'mass' is a parameter, not an input: give it by --set mass=3; inputs are ['torque']"


def test_ctrl_c_before_the_run_is_said(tlismni: Command, pushed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    import tlismni.core as core

    def interrupted(*_: Any, **__: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(core, "simulate", interrupted)
    done = tlismni("run", pushed, "--t-end", 1)
    assert done.code == 130 and "stopped; there is nothing to keep yet" in done.err


def test_ctrl_c_keeps_what_was_reached(
    tlismni: Command, pushed: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    import tlismni.core as core

    real = core.simulate

    def interrupted(*arguments: Any, **settings: Any) -> Any:
        def stop(t: float) -> None:
            if t > 0.3:
                raise KeyboardInterrupt

        return real(*arguments, **{**settings, "progress": stop})

    monkeypatch.setattr(core, "simulate", interrupted)
    out = tmp_path / "out.csv"
    done = tlismni("run", pushed, "--t-end", 1, "--input", "force=2", "--every", 0.1, "--output", out)
    assert done.code == 130 and "what was reached is kept" in done.err
    assert 0.3 <= last(out)["time"] < 0.6 and last(out)["p.vx"] == pytest.approx(last(out)["time"], rel=1e-6)


def test_completion(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "my.json").write_text("{}")
    assert "pendulum_stop" in sources("pend") and "bouncing_ball" not in sources("pend")
    assert sources("my") == ["my.json"]
    assert methods("eb") == ["ebdf"]
