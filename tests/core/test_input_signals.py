"""Inputs over time in `simulate`: against closed forms, and what stops a run."""

import numpy as np
import pytest
from helpers import on
from tlismni.core import AppliedForce2D, Courses, Input, InputSignal, Model, ModelError, PointMass2D, simulate

TIGHT = {"rtol": 1e-10, "atol": 1e-12}


def pushed():
    """A mass of 2 kg that an input pushes along x."""
    push = AppliedForce2D(name="push", marker=on("p"), force_x=InputSignal(channel="force"))
    mass = PointMass2D(name="p", mass=2.0)
    return Model(gravity=(0.0, 0.0), bodies=[mass], forces=[push], inputs=[Input(name="force", unit="N")])


def test_a_number_is_kept():
    result = simulate(pushed(), 1.0, inputs={"force": 3.0}, **TIGHT)
    assert result["p.x"] == pytest.approx(0.75 * result.t**2, abs=1e-10)


def test_straight_lines_between_times():
    """A triangle of 1 s, 4 N high: its impulse is 2 N s, the way at the end that of two cubics."""
    course = {"force": ([0.0, 0.5, 1.0], [0.0, 4.0, 0.0])}
    result = simulate(pushed(), 2.0, inputs=course, t_eval=[0.25, 0.5, 0.8, 1.0, 2.0], **TIGHT)
    t = np.minimum(result.t, 1.0)
    first = np.minimum(t, 0.5)
    late = t - first
    speed = (4.0 * first**2 + 4.0 * late - 4.0 * late**2) / 2.0
    assert result["p.vx"] == pytest.approx(speed, abs=1e-10)
    assert result["p.x"][-1] == pytest.approx(1.5, abs=1e-9)


def test_held_values_are_steps():
    course = Courses([0.0, 0.3, 0.7], {"force": [2.0, -2.0, 0.0]}, "hold")
    result = simulate(pushed(), 1.0, inputs=course, **TIGHT)
    assert result["p.vx"][-1] == pytest.approx(0.3 - 0.4, abs=1e-10)


def test_before_and_after_its_times_an_input_is_constant():
    result = simulate(pushed(), 1.0, inputs={"force": ([0.4, 0.5], [1.0, 3.0])}, **TIGHT)
    assert result["p.vx"][-1] == pytest.approx((0.4 + 0.2 + 1.5) / 2.0, abs=1e-10)


def test_a_run_that_is_stopped_keeps_what_it_reached():
    """Ctrl-C arrives in Python: here out of `progress`."""

    def stop(t):
        if t > 0.3:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt) as caught:
        simulate(pushed(), 1.0, inputs={"force": 2.0}, t_eval=np.linspace(0.0, 1.0, 11), progress=stop, **TIGHT)
    partial = caught.value.partial
    assert 0.3 <= partial.t[-1] < 0.6
    assert partial["p.x"] == pytest.approx(0.5 * partial.t**2, abs=1e-10)


def test_refusals():
    model = pushed()
    for inputs, said in (
        ({"farce": 1.0}, "there is no input"),
        ({"force": ([0.0, 0.0], [1.0, 2.0])}, "grow strictly"),
        ({"force": ([0.0, 1.0], [1.0])}, "as many values"),
        ({"force": ([0.0, 1.0], [1.0, np.nan])}, "finite"),
        (3.0, "must be a mapping"),
    ):
        with pytest.raises(ModelError, match=said):
            simulate(model, 1.0, inputs=inputs)
    with pytest.raises(ModelError, match="'force' is an input of model 'model', not a parameter"):
        model.with_parameters({"force": 2.0})
