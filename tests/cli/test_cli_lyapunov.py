"""`tlismni lyapunov`."""

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from tlismni.core import Marker2D, Model, PointMass2D, SpringDamper2D

Command = Callable[..., Any]


def test_json_and_figure_of_the_chaotic_oscillator(tlismni: Command, tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    target = tmp_path / "exponents.png"
    done = tlismni("lyapunov", "impact_oscillator", "--periods", 40, "--transient", 10, "--plot", target, "--json")
    assert done.code == 0
    figures = done.json
    period = 2.0 * math.pi / 2.8
    assert figures["period"] == pytest.approx(period)
    assert (figures["start"], figures["end"]) == pytest.approx((10.0, 40.0 * period))
    first, second = figures["exponents"]
    lost = -0.1 + 2.0 * math.log(0.8) * figures["impacts"] / (40.0 * period - 10.0)
    assert first + second == pytest.approx(lost, abs=1e-6)
    assert first > 0.0 > second
    assert figures["solver"]["method"] == "irk"
    assert target.read_bytes().startswith(b"\x89PNG")


def test_tables(tlismni: Command) -> None:
    done = tlismni("lyapunov", "impact_oscillator", "--t-end", 20, "--rtol", "1e-6", "--count", 1)
    assert done.code == 0
    for text in ("Lyapunov exponents", "standard error", "impacts a period", "Kaplan-Yorke"):
        assert text in done.out


def test_a_model_file(tlismni: Command, tmp_path: Path) -> None:
    """A point between two dampers: the sum of its exponents is -c/m for each direction that they act in."""
    ends = {"a": (-1.0, 0.0), "b": (1.0, 0.0)}
    springs = [
        SpringDamper2D(
            name=name, a=Marker2D(point=point), b=Marker2D(body="p"), stiffness=5.0, damping=0.2, natural_length=1.0
        )
        for name, point in ends.items()
    ]
    path = tmp_path / "point.json"
    Model(name="point", gravity=(0.0, 0.0), bodies=[PointMass2D(name="p", mass=2.0)], forces=springs).save(path)
    done = tlismni("lyapunov", path, "--t-end", 5, "--json")
    assert done.json["volume_rate"] == pytest.approx(-0.4 / 2.0, abs=1e-9)
    assert abs(done.json["sum_residual"]) < 1e-8
    assert done.json["period"] is None and done.json["impacts"] == 0


def test_wrong_usage(tlismni: Command, tmp_path: Path) -> None:
    assert tlismni("lyapunov", "impact_oscillator", "--periods", 3, "--t-end", 2).code == 2
    assert tlismni("lyapunov", "impact_oscillator", "--plot", "figure.txt").code == 2
    done = tlismni("lyapunov", "chain", "--periods", 3)
    assert done.code == 2 and "has no Sine" in done.err
    done = tlismni("lyapunov", "impact_oscillator", "--set", "law=gonthier")
    assert done.code == 1 and "'stop' has the law Gonthier" in done.cause
    done = tlismni("lyapunov", "impact_oscillator", "--t-end", 5, "--transient", 7)
    assert done.code == 1 and "the transient must" in done.cause
