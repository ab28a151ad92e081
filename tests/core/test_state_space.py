"""Linearised models: closed forms, reciprocity, and the nonlinear run, which they must meet to second order."""

import math

import numpy as np
import pytest
from helpers import G, on, order, rod_pendulum
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    HuntCrossley,
    Input,
    InputSignal,
    Marker2D,
    MarkerOutput2D,
    Model,
    ModelError,
    Simulation,
    compile_model,
)
from tlismni.core.analysis import eigenmodes, state_space
from tlismni.core.elements import CoordinateDriver
from tlismni.models import load


def driven_pendulum():
    """A rod on a pin with a torque and a force at its end as inputs, and its end as output."""
    model = rod_pendulum(-0.5 * math.pi)
    return Model(
        bodies=model.bodies,
        joints=model.joints,
        forces=[
            AppliedTorque2D(name="motor", body="rod", torque=InputSignal(channel="torque")),
            AppliedForce2D(name="push", marker=on("rod", 0.5), force_x=InputSignal(channel="force")),
        ],
        inputs=[Input(name="torque", unit="N.m"), Input(name="force", unit="N")],
        outputs=[MarkerOutput2D(name="end", marker=on("rod", 0.5))],
    )


def test_a_driven_pendulum():
    """theta'' = -(3 g/2) theta + 3 T + 3 F; the end moves by theta, and the pin feels the force."""
    linear = state_space(driven_pendulum(), outputs=["end.x", "end.y", "end.vx", "rod.angular_acceleration"])
    assert len(linear.A) == 2
    change = linear.C[[0]]  # the state as it is seen at the end: x and x'
    seen = np.vstack([change, change @ linear.A])
    a = seen @ linear.A @ np.linalg.inv(seen)
    assert a == pytest.approx(np.array([[0.0, 1.0], [-1.5 * G, 0.0]]), abs=1e-9)
    assert seen @ linear.B == pytest.approx(np.array([[0.0, 0.0], [3.0, 3.0]]), abs=1e-10)
    assert linear.C[1] == pytest.approx([0.0, 0.0], abs=1e-9)
    assert linear.C[2] == pytest.approx((change @ linear.A)[0], abs=1e-9)
    assert linear.D[3] == pytest.approx([3.0, 3.0], abs=1e-10)


def test_transfer_function_of_the_pendulum():
    linear = state_space(driven_pendulum(), inputs=["force"], outputs=["end.x"])
    f = np.array([0.1, 0.5, 2.0])
    exact = 3.0 / (1.5 * G - (2.0 * math.pi * f) ** 2)
    assert linear.transfer(f)[:, 0, 0] == pytest.approx(exact, rel=1e-8)


def test_d_is_what_the_run_says_of_inputs():
    """Two ways to one derivative: channels by inputs at one instant."""
    model = driven_pendulum()
    linear = state_space(model)
    sim = Simulation(model)
    for k, name in enumerate(linear.inputs):
        exact = dict(zip((c.name for c in sim.channels), sim.input_derivatives({name: 1.0}), strict=True))
        rows = [i for i, channel in enumerate(linear.outputs) if not channel.startswith(("residual.", "energy."))]
        assert linear.D[rows, k] == pytest.approx([exact[linear.outputs[i]] for i in rows], abs=1e-9)


def test_reciprocity():
    """Forces at two points of a chain and the displacements there: what one does at the other is the same both ways."""
    scenario = load("chain", links=4)
    base = scenario.model
    ends = [body.name for body in base.bodies if body.name != "ground"]
    model = Model(
        bodies=base.bodies, joints=base.joints,
        forces=[AppliedForce2D(name=f"f{i}", marker=Marker2D(body=ends[i]), force_x=InputSignal(channel=f"u{i}"))
                for i in (0, 3)],
        inputs=[Input(name="u0", unit="N"), Input(name="u3", unit="N")],
    )  # fmt: skip
    linear = state_space(model, outputs=[f"{ends[0]}.x", f"{ends[3]}.x"])
    transfer = linear.transfer([0.2, 0.9, 3.0])
    assert transfer[:, 0, 1] == pytest.approx(transfer[:, 1, 0], rel=1e-8)
    # a conservative system's poles are those of its modes
    frequencies = np.sort(np.abs(linear.poles.imag))[::2] / (2.0 * math.pi)
    assert frequencies == pytest.approx(eigenmodes(model).frequencies, rel=1e-6)


@pytest.mark.parametrize("channel", ["end.x", "end.y", "pin.force_x", "rod.angle", "energy.kinetic"])
def test_the_nonlinear_run_is_met_to_second_order(channel):
    """Response to a step of the torque after 0.4 s: the error of the linear model falls with the square of the step."""
    from scipy.linalg import expm

    model = driven_pendulum()
    linear = state_space(model, inputs=["torque"], outputs=[channel])
    s, t = len(linear.A), 0.4
    block = np.zeros((s + 1, s + 1))
    block[:s, :s], block[:s, s:] = linear.A, linear.B
    response = expm(t * block)[:s, s]
    compiled = compile_model(model, "irk", rtol=1e-11, atol=1e-13)
    errors = []
    for size in (0.02, 0.01):
        sim = compiled.simulation(inputs={"torque": size})
        sim.advance(t)
        k = compiled.channels.index(channel)
        predicted = linear.equilibrium[channel] + size * (linear.C[0] @ response + linear.D[0, 0])
        errors.append(abs(sim.values()[k] - predicted))
    assert errors[0] < 1e-2
    assert order(errors) > 1.9 or errors[0] < 1e-9


def test_channels_of_a_contact_that_gives_way():
    """A ball on Hertz's law: the force answers to the height by -1.5 F/depth."""
    from helpers import ball_over_floor

    linear = state_space(
        ball_over_floor(HuntCrossley(stiffness=1e6, restitution=1.0)), outputs=["floor.normal_force", "floor.gap"]
    )
    rest = linear.equilibrium
    y = linear.states.index("ball.y")
    assert linear.C[1, y] == pytest.approx(1.0, rel=1e-9)
    assert linear.C[0, y] == pytest.approx(1.5 * G / rest["ball.y"], rel=1e-7)


def test_scipy_takes_it():
    from scipy.signal import step

    linear = state_space(driven_pendulum(), inputs=["torque"], outputs=["rod.angle"])
    t, y = step(linear.to_scipy(), T=np.linspace(0.0, 2.0, 50))
    omega = math.sqrt(1.5 * G)
    assert y == pytest.approx((1.0 - np.cos(omega * t)) / (0.5 * G), abs=1e-8)


def test_refusals():
    model = driven_pendulum()
    with pytest.raises(ModelError, match="no input"):
        state_space(model, inputs=["torqe"])
    with pytest.raises(ModelError, match="no channel"):
        state_space(model, outputs=["rod.ange"])
    led = CoordinateDriver(name="hold", body="rod", coordinate="angle", motion=InputSignal(channel="torque"))
    moved = Model(bodies=model.bodies, joints=[led], inputs=[Input(name="torque")], gravity=(0.0, 0.0))
    with pytest.raises(ModelError, match="sets a motion"):
        state_space(moved)
