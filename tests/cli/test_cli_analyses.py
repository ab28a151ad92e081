"""`tlismni check`, `equilibrium`, `modes`, `linearise`, `sensitivities`."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from tlismni.core import AppliedTorque2D, Input, InputSignal, Marker2D, Model, Revolute2D, RigidBody2D

Command = Callable[..., Any]
G = 9.81


@pytest.fixture
def pendulum(tmp_path: Path) -> Path:
    """A slender rod of 1 m and 1 kg on a pin, with a torque as input, lifted by 30 degrees."""
    angle = -math.pi / 3.0
    rod = RigidBody2D(
        name="rod", mass=1.0, inertia=1.0 / 12.0, position=(0.5 * math.cos(angle), 0.5 * math.sin(angle)), angle=angle
    )
    pin = Revolute2D(name="pin", a=Marker2D(), b=Marker2D(body="rod", point=(-0.5, 0.0)))
    motor = AppliedTorque2D(name="motor", body="rod", torque=InputSignal(channel="torque"))
    model = Model(
        name="pendulum", bodies=[rod], joints=[pin], forces=[motor], inputs=[Input(name="torque", unit="N.m")]
    )
    path = tmp_path / "pendulum.json"
    model.save(path)
    return path


def png(path: Path) -> bool:
    return path.read_bytes().startswith(b"\x89PNG")


def test_check(tlismni: Command, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    done = tlismni("check", "four_bar", "--json", "--plot", tmp_path / "values.png")
    assert done.json["degrees_of_freedom"] == 1 and png(tmp_path / "values.png")
    assert done.json["stuck"] == ["coupler1.angle", "coupler2.angle"]
    assert "cannot move: coupler1.angle" in tlismni("check", "four_bar").out


def test_check_says_what_is_wrong_with_a_file(tlismni: Command, pendulum: Path) -> None:
    pendulum.write_text(pendulum.read_text().replace('"mass": 1.0', '"mass": -1.0'))
    done = tlismni("check", pendulum)
    assert done.code == 1 and "'rod'" in done.cause and "mass" in done.cause


def test_equilibrium(tlismni: Command, pendulum: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    target = tmp_path / "rest.json"
    done = tlismni("equilibrium", pendulum, "--json", "--output", target, "--plot", tmp_path / "rest.png")
    assert done.json["stable"] and done.json["channels"]["rod.y"] == pytest.approx(-0.5)
    assert Model.load(target).bodies[0].position[1] == pytest.approx(-0.5)
    assert png(tmp_path / "rest.png")
    assert "at rest, stable" in tlismni("equilibrium", pendulum).out


def test_modes(tlismni: Command, pendulum: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    done = tlismni("modes", pendulum, "--json", "--plot", tmp_path / "modes.png")
    (mode,) = done.json["modes"]
    assert mode["frequency"] == pytest.approx(math.sqrt(1.5 * G) / (2.0 * math.pi))
    assert png(tmp_path / "modes.png")
    assert "frequency Hz" in tlismni("modes", pendulum).out
    assert "no place of rest" in tlismni("modes", pendulum, "--start").cause


def test_linearise(tlismni: Command, pendulum: Path, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    target = tmp_path / "linear.npz"
    done = tlismni(
        "linearise", pendulum, "--to", "rod.angle", "--json", "--output", target, "--plot", tmp_path / "bode.png"
    )
    gain = -np.array(done.json["C"]) @ np.linalg.solve(done.json["A"], done.json["B"])
    assert gain[0, 0] == pytest.approx(1.0 / (0.5 * G))
    with np.load(target) as kept:
        assert kept["A"].tolist() == done.json["A"] and kept["outputs"].tolist() == ["rod.angle"]
    assert png(tmp_path / "bode.png")
    assert "poles" in tlismni("linearise", pendulum).out
    assert "there is no input" in tlismni("linearise", pendulum, "--from", "force").cause


def test_sensitivities(tlismni: Command, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    asked = ["sensitivities", "bouncing_ball", "--parameter", "floor.law.restitution", "--channel", "ball.y"]
    done = tlismni(*asked, "--t-end", 0.8, "--json", "--plot", tmp_path / "bars.png")
    v, t1 = math.sqrt(2.0 * G), math.sqrt(2.0 / G)
    assert done.json["derivatives"][0][0][0] == pytest.approx(v * (0.8 - t1), rel=1e-5)
    assert tlismni(*asked, "--t-end", 0.8, "--every", 0.1, "--plot", tmp_path / "curves.png").code == 0
    assert png(tmp_path / "bars.png") and png(tmp_path / "curves.png")
