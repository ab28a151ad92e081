"""Inputs that go on with derivatives over a communication step (FMI 2.0), by the slave and through fmpy."""

import fmpy
import numpy as np
import pytest
from fmpy.fmi2 import FMU2Slave
from fmu_helpers import ball_model
from tlismni.core import Simulation
from tlismni.core.elements import AppliedForce2D, PointMass2D
from tlismni.core.model.channels import Input
from tlismni.core.model.markers import Marker2D
from tlismni.core.model.signals import InputSignal
from tlismni.core.multibody_model import Model
from tlismni.fmu_wrapper import Slave, export_fmu
from tlismni.fmu_wrapper.in_process import InProcess

MASS = 2.0


def mass_model():
    """A free mass under a horizontal force."""
    drive = AppliedForce2D(name="drive", marker=Marker2D(body="p"), force_x=InputSignal(channel="push"))
    return Model(
        gravity=(0.0, 0.0),
        bodies=[PointMass2D(name="p", mass=MASS)],
        forces=[drive],
        inputs=[Input(name="push", unit="N")],
    )


def started(model=None, **solver):
    slave = Slave(model or mass_model(), **solver)
    slave.enter_initialization()
    slave.exit_initialization()
    return slave


def slope(slave, name, *derivatives):
    reference = np.array([slave.variables.by_name[name].reference] * len(derivatives), dtype=np.uint32)
    slave.set_input_derivatives(reference, [1 + k for k in range(len(derivatives))], derivatives)


@pytest.mark.parametrize("method", ["ebdf", "irk", "newmark"])
@pytest.mark.parametrize("order", [1, 2], ids=["slope", "curvature"])
def test_a_mass_under_a_polynomial_force(method, order):
    """x = integral of F/m twice, in closed form, over steps of uneven size; the input's value moves along."""
    c0, c1, c2 = 1.0, -3.0, 4.0 if order == 2 else 0.0
    slave = started(method=method, rtol=1e-10, atol=1e-12)
    slave.set_by_name({"push": c0})
    slope(slave, "push", *((c1, 2.0 * c2)[:order]))
    t = 0.0
    for h in (0.1, 0.03, 0.2, 1e-4, 0.4):
        slave.do_step(t, h)
        t = slave.time
        assert slave["push"] == pytest.approx(c0 + c1 * t + c2 * t * t, rel=1e-12)
        assert slave["p.ax"] * MASS == pytest.approx(slave["push"], rel=1e-9)
        expected = (c0 * t**2 / 2.0 + c1 * t**3 / 6.0 + c2 * t**4 / 12.0) / MASS
        assert slave["p.x"] == pytest.approx(expected, rel=1e-6 if method == "newmark" else 1e-9, abs=1e-10)


@pytest.mark.parametrize("first", ["value", "slope"])
def test_value_and_slope_of_one_point_belong_together_in_either_order(first):
    slave = started()
    calls = [lambda: slave.set_by_name({"push": 2.0}), lambda: slope(slave, "push", 5.0)]
    for call in calls if first == "value" else reversed(calls):
        call()
    slave.do_step(0.0, 0.1)
    assert slave["push"] == pytest.approx(2.5)


def test_a_value_without_slope_ends_the_old_one():
    slave = started()
    slope(slave, "push", 5.0)
    slave.do_step(0.0, 0.1)
    slave.set_by_name({"push": 2.0})
    slave.do_step(slave.time, 0.1)
    assert slave["push"] == 2.0 and slave["p.ax"] == pytest.approx(1.0)


def test_a_slope_alone_starts_from_where_the_input_is():
    slave = started()
    slope(slave, "push", 5.0)
    slave.do_step(0.0, 0.1)
    slope(slave, "push", -5.0)
    slave.do_step(slave.time, 0.1)
    assert slave["push"] == pytest.approx(0.0, abs=1e-15)


@pytest.mark.parametrize("first", ["value", "slope"])
def test_a_slope_ends_the_curvature_of_an_earlier_point_in_either_order(first):
    slave = started()
    slope(slave, "push", 5.0, 3.0)
    slave.do_step(0.0, 0.1)
    calls = [lambda: slave.set_by_name({"push": 2.0}), lambda: slope(slave, "push", 1.0)]
    for call in calls if first == "value" else reversed(calls):
        call()
    slave.do_step(slave.time, 0.1)
    assert slave["push"] == pytest.approx(2.1, rel=1e-14)


def test_slopes_are_part_of_the_state():
    slave = started()
    slope(slave, "push", 5.0, 3.0)
    slave.do_step(0.0, 0.1)
    stored = slave.snapshot()
    slave.do_step(slave.time, 0.2)
    expected = slave["p.x"], slave["push"]
    other = started()
    other.restore(other.snapshot_from_bytes(stored.data))
    assert other.snapshot().data == stored.data
    other.do_step(other.time, 0.2)
    assert (other["p.x"], other["push"]) == expected
    slave.reset()
    slave.enter_initialization()
    slave.exit_initialization()
    slave.do_step(0.0, 0.1)
    assert slave["push"] == slave["p.x"] == 0.0


def test_steps_go_past_points_while_an_input_follows_its_slope():
    slave = started(ball_model(), rtol=1e-8)
    plain = Simulation(ball_model(), rtol=1e-8)
    plain.set_inputs({"push": 1.0}, {"push": (2.0,)})
    slope(slave, "push", 2.0)
    for _ in range(200):
        slave.do_step(slave.time, 0.005)
        slave.set_by_name({"push": 1.0 + 2.0 * slave.time})
        slope(slave, "push", 2.0)
        plain.advance(slave.time)
    assert slave._run._simulation.stats["steps"] <= plain.stats["steps"] + 2
    column = [c.name for c in plain.channels].index("ball.y")
    assert slave["ball.y"] == pytest.approx(plain.values()[column], abs=1e-6)


@pytest.mark.parametrize("host", ["binary", "in process"])
def test_fmpy_gives_slopes_of_a_table(host, tmp_path):
    """A piecewise linear force, followed exactly: coarse communication steps give the closed form.

    Not by `simulate_fmu(set_input_derivatives=True)`, whose buffer (fmpy 0.3.32) holds nine inputs, no more, no less.
    """
    path = export_fmu(mass_model(), tmp_path / "mass.fmu", t_end=1.0, rtol=1e-9, atol=1e-12)
    unzipped = fmpy.extract(str(path), unzipdir=str(tmp_path / "unzipped"))
    description = fmpy.read_model_description(unzipped)
    assert description.coSimulation.canInterpolateInputs
    vr = {v.name: v.valueReference for v in description.modelVariables}
    if host == "in process":
        fmu = InProcess.of(unzipped)
    else:
        identifier = description.coSimulation.modelIdentifier
        fmu = FMU2Slave(guid=description.guid, unzipDirectory=unzipped, modelIdentifier=identifier)
    fmu.instantiate()
    fmu.setupExperiment()
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    for t, force, rate in ((0.0, 0.0, 8.0), (0.25, 2.0, 8.0), (0.5, 4.0, -16.0), (0.75, 0.0, -16.0)):
        fmu.setReal([vr["push"]], [force])
        fmu.setRealInputDerivatives([vr["push"]], [1], [rate])
        fmu.doStep(t, 0.25)
        end, s = t + 0.25, t - 0.25
        rising, falling = 8.0 * end**3 / 6.0, 1.0 / 6.0 + s + 2.0 * s**2 - 16.0 * s**3 / 6.0
        (x,) = fmu.getReal([vr["p.x"]])
        assert x == pytest.approx((rising if end <= 0.5 else falling) / MASS, abs=1e-8)
    fmu.terminate()
    fmu.freeInstance()
