"""The recommended communication step: periods and durations of systems that are known in closed form."""

import math

import fmpy
import numpy as np
import pytest
from tlismni.core import (
    AppliedForce2D,
    AxialRod,
    Bushing2D,
    CoordinateDriver,
    CoordinateLoad,
    LinearSystem,
    Model,
    PointMass2D,
    Polynomial,
    Prismatic2D,
    RigidBody2D,
    Simulation,
    simulate,
)
from tlismni.core.analysis.time_scales import contact_durations, vibration_period
from tlismni.core.model.channels import Input
from tlismni.core.model.markers import Marker2D
from tlismni.core.model.signals import InputSignal
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.recommended_step import POINTS, recommended_step, round_down
from tlismni.models import load


def test_a_mass_on_a_spring():
    """2 pi sqrt(m/k), on its guide; the inertia that the guide holds plays no part."""
    m, k = 2.0, 300.0
    mass = Marker2D(body="mass")
    model = Model(
        gravity=(0.0, 0.0),
        bodies=[RigidBody2D(name="mass", mass=m, inertia=1e-6)],
        joints=[Prismatic2D(name="guide", a=Marker2D(), b=mass)],
        forces=[Bushing2D(name="spring", a=Marker2D(), b=mass, stiffness=k)],
    )
    assert vibration_period(Simulation(model)) == pytest.approx(2.0 * math.pi * math.sqrt(m / k), rel=1e-9)
    ball = Model(bodies=[PointMass2D(name="ball", mass=1.0)])
    assert vibration_period(Simulation(ball)) == math.inf


@pytest.mark.parametrize("loaded, period", [("slow", 2.0 * math.pi), ("quick", 0.02 * math.pi)])
def test_the_vibration_that_the_input_moves_counts(loaded, period):
    """Two oscillators of 1 and 100 rad/s side by side."""
    pair = LinearSystem(
        name="pair", coordinates=("slow", "quick"), mass=((1.0, 0.0), (0.0, 1.0)), stiffness=((1.0, 0.0), (0.0, 1e4))
    )
    load_on = CoordinateLoad(name="push", body="pair", coordinate=loaded, load=InputSignal(channel="force"))
    model = Model(bodies=[pair], forces=[load_on], inputs=[Input(name="force", unit="N")])
    sim = Simulation(model)
    state = sim.state()
    assert vibration_period(sim) == pytest.approx(period, rel=1e-9)
    assert sim.state() == state


def test_a_rod_pulled_at_its_end_needs_its_first_vibrations():
    """Fixed at one end, the compliance at the other is 8/pi^2 sum 1/(2k-1)^2 of L/EA: 95 % take 4 vibrations."""
    length, stiffness, line = 2.0, 50.0, 3.0
    rod = AxialRod(name="rod", elements=60, length=length, axial_stiffness=stiffness, mass_per_length=line)
    pull = CoordinateLoad(name="pull", body="rod", coordinate="x60", load=InputSignal(channel="force"))
    hold = CoordinateDriver(name="hold", body="rod", coordinate="x0", motion=Polynomial(coefficients=(0.0,)))
    model = Model(bodies=[rod], joints=[hold], forces=[pull], inputs=[Input(name="force", unit="N")])
    orders = 2.0 * np.arange(1, 200) - 1.0
    shares = np.cumsum(8.0 / math.pi**2 / orders**2)
    last = orders[int(np.searchsorted(shares, 0.95))]
    wave = math.sqrt(stiffness / line)
    assert vibration_period(Simulation(model)) == pytest.approx(4.0 * length / (last * wave), rel=0.01)


def test_a_blow_takes_as_long_as_in_a_run():
    """A linear spring exactly, Hertz's law 7 % less."""
    scenario = load("split_whole", law="hertz", gap=0.001, stiffness=1e7)
    (duration,) = contact_durations(Simulation(scenario.model), 1.0).values()
    result = simulate(scenario.model, 0.05, rtol=1e-8, atol=1e-10)
    first = [event.t for event in result.events if event.kind in ("close", "open")][:2]
    # the springs of hammer and anvil are soft beside the contact
    assert duration == pytest.approx(math.pi / 2.9432751843 * (first[1] - first[0]), rel=0.01)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_the_fmu_recommends_it(tmp_path, version):
    scenario = load("split_wall")
    sim = Simulation(scenario.model)
    duration = contact_durations(sim, 1.0)["blow"]
    wanted = recommended_step(sim, scenario.model, scenario.t_end)
    assert wanted == round_down(duration / POINTS)
    description = fmpy.read_model_description(str(export_fmu(scenario, tmp_path / "w.fmu", version)), validate=True)
    assert float(description.defaultExperiment.stepSize) == wanted
    given = export_fmu(scenario, tmp_path / "g.fmu", version, communication_step=0.0123)
    assert float(fmpy.read_model_description(str(given)).defaultExperiment.stepSize) == 0.0123


def test_round_numbers():
    assert [round_down(x) for x in (1.0, 1.9, 2.0, 4.99, 5.0, 9.9, 0.0011, 1e-5, 0.3)] == [
        1.0, 1.0, 2.0, 2.0, 5.0, 5.0, 0.001, 1e-5, 0.2
    ]  # fmt: skip


def test_a_body_that_only_falls_has_the_time_of_its_fall():
    push = AppliedForce2D(name="push", marker=Marker2D(body="ball"), force_y=InputSignal(channel="force"))
    ball = PointMass2D(name="ball", mass=1.0, position=(0.0, 5.0))
    model = Model(bodies=[ball], forces=[push], inputs=[Input(name="force", unit="N")])
    step = recommended_step(Simulation(model), model, None)
    assert step is not None and 0.01 <= step <= math.sqrt(5.0 / 9.81) / POINTS * 1.001
