"""Derivatives of outputs with respect to inputs: by hand, in open and in closed contact; asking leaves no trace."""

import zipfile
from xml.etree import ElementTree

import fmpy
import numpy as np
import pytest
from fmu_helpers import ball_model
from tlismni.core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from tlismni.core.elements import AppliedForce2D, CoordinateDriver, PointMass2D, RigidBody2D
from tlismni.core.errors import TlismniError
from tlismni.core.laws import KelvinVoigt, NewtonImpact
from tlismni.core.laws.friction import CoulombFriction, TanhFriction
from tlismni.core.model.channels import Input
from tlismni.core.model.markers import Marker2D
from tlismni.core.model.outputs import MarkerOutput2D
from tlismni.core.model.signals import InputSignal
from tlismni.core.multibody_model import Model
from tlismni.fmu_wrapper import CallOrderError, FmuValueError, Slave, export_fmu
from tlismni.models import load


def started(source, **parameters):
    slave = Slave(source)
    slave.set_by_name(parameters)
    slave.enter_initialization()
    slave.exit_initialization()
    return slave


def derivatives(slave, known, *unknowns, seed=1.0):
    def references(*names):
        return np.array([slave.variables.by_name[n].reference for n in names], dtype=np.uint32)

    return slave.directional_derivative(references(*unknowns), references(known), np.array([seed]))


def test_pendulum_in_the_air_and_on_the_stop():
    """In the air the torque accelerates the pendulum; on the stop it is held by the normal force and the bearing.

    The slopes follow from two values of the torque each, since everything is linear in it; and from each other: on
    the stop the moments of torque and normal force about the bearing are in balance.
    """
    scenario = load("pendulum_stop", restitution=0.0)
    slave = started(scenario)
    names = ("pendulum.angular_acceleration", "stop.normal_force", "pin.force_x", "pin.force_y")
    seen = set()
    for k in range(30):
        slope = derivatives(slave, "torque", *names)
        closed = slave["stop.mode"] == 1
        seen.add(closed)
        rows = []
        # both press it against the stop: the channel shows no force that pulls
        for torque in (-0.25, -0.05):
            slave.set_by_name({"torque": torque})
            rows.append([slave[n] for n in names])
        # a little pressure: hanging straight down on the stop without any, rounding would say whether it touches
        slave.set_by_name({"torque": -0.1})
        secant = (np.array(rows[1]) - rows[0]) / 0.2
        np.testing.assert_allclose(slope, secant, rtol=1e-7, atol=1e-9 * np.max(np.abs(secant)))
        if closed:
            assert abs(slope[0]) < 1e-12 and abs(slope[1]) > 0.1
        else:
            assert slope[0] > 0.1 and slope[1] == 0.0
        slave.do_step(k * 0.05, 0.05)
    assert seen == {True, False}


def test_a_ball_in_the_air_and_at_rest():
    """1/m in the air; on the floor no acceleration, and the floor carries what is not pushed up."""
    slave = started(ball_model("b", height=0.0), restitution=0.0)
    slave.do_step(0.0, 0.5)
    assert slave["floor.mode"] == 1
    found = derivatives(slave, "push", "ball.ay", "floor.normal_force", seed=2.0)
    np.testing.assert_allclose(found, [0.0, -2.0], rtol=1e-12, atol=1e-12)
    slave = started(ball_model("b", height=1.0))
    found = derivatives(slave, "push", "ball.ay", "floor.normal_force", "ball.vy", seed=2.0)
    np.testing.assert_allclose(found, [1.0, 0.0, 0.0], rtol=1e-12, atol=0.0)


def test_asking_leaves_no_trace():
    asked, other = (started(load("pendulum_stop", restitution=0.5)) for _ in range(2))
    for k in range(20):
        derivatives(asked, "torque", "pendulum.angular_acceleration", seed=1e6)
        for slave in (asked, other):
            slave.do_step(k * 0.05, 0.05)
        assert asked["pendulum.angle"] == other["pendulum.angle"]
        assert asked.snapshot().data == other.snapshot().data


def driven_model():
    """A point led along x by the input `lead` and pushed along y by the input `push`."""
    marker = Marker2D(body="p")
    return Model(
        name="led",
        gravity=(0.0, 0.0),
        bodies=[PointMass2D(name="p", mass=2.0)],
        joints=[CoordinateDriver(name="hand", body="p", coordinate="x", motion=InputSignal(channel="lead"))],
        forces=[AppliedForce2D(name="wind", marker=marker, force_y=InputSignal(channel="push"))],
        inputs=[Input(name="lead", unit="m"), Input(name="push", unit="N")],
    )


def test_a_motion_that_is_an_input_is_met_by_the_next_step():
    """Outputs at the present time go on as they were: zero is what differences of the outputs give, too. Before the
    first step the start follows the motion, which is refused."""
    slave = Slave(driven_model())
    slave.enter_initialization()
    with pytest.raises(FmuValueError, match=r"input 'lead' is the motion of \['hand'\], which start where it says"):
        derivatives(slave, "lead", "p.x")
    slave.exit_initialization()
    slave.do_step(0.0, 0.1)
    names = [v.name for v in slave.variables.block("channel") if v.kind == "real"]
    before = [slave[n] for n in names]
    assert not derivatives(slave, "lead", *names).any()
    slave.set_by_name({"lead": 0.5})
    assert [slave[n] for n in names] == before
    np.testing.assert_allclose(derivatives(slave, "push", "p.ay", "p.ax"), [0.5, 0.0], rtol=1e-12, atol=1e-12)
    slave.do_step(0.1, 0.1)
    assert slave["p.x"] == pytest.approx(0.5, abs=1e-12)


@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_the_flags_promise_derivatives(tmp_path, version):
    for name, source in (("led", driven_model()), ("ball", ball_model())):
        path = export_fmu(source, tmp_path / f"{name}.fmu", t_end=1.0, fmi_version=version)
        with zipfile.ZipFile(path) as archive:
            flags = ElementTree.fromstring(archive.read("modelDescription.xml")).find("CoSimulation").attrib
        said = {key: value for key, value in flags.items() if "Derivatives" in f"{key}s" and key.startswith("provides")}
        assert len(said) == (1 if version == "2.0" else 2)
        assert set(said.values()) == {"true"}
        assert fmpy.read_model_description(str(path), validate=True).fmiVersion == version


def test_when_and_of_what():
    slave = Slave(load("pendulum_stop"))
    with pytest.raises(CallOrderError, match="cannot get derivatives in phase 'instantiated'"):
        derivatives(slave, "torque", "pendulum.angular_acceleration")
    slave.enter_initialization()
    assert derivatives(slave, "torque", "pendulum.angular_acceleration")[0] > 0.1
    for known, unknown in (("restitution", "stop.gap"), ("torque", "stop.mode"), ("torque", "time")):
        with pytest.raises(TlismniError):
            derivatives(slave, known, unknown)


def sled(law, friction, height=0.0, speed=0.0):
    """A block that inputs push along and onto the floor, with a marker on its corner."""
    body = Marker2D(body="sled", point=(0.1, 0.05))
    return Model(
        name="sled",
        bodies=[RigidBody2D(name="sled", mass=2.0, inertia=0.3, position=(0.0, 0.2 + height), velocity=(speed, 0.0))],
        forces=[
            AppliedForce2D(name="hand", marker=body, force_x=InputSignal(channel="fx"),
                           force_y=InputSignal(channel="fy"), follower=True),
        ],
        contacts=[
            DiskOnHalfPlane2D(name=name, plane=HalfPlane2D(), law=law, friction=friction,
                              disk=Disk2D(marker=Marker2D(body="sled", point=(x, -0.2))))
            for name, x in (("front", 0.4), ("back", -0.4))
        ],
        inputs=[Input(name="fx", unit="N"), Input(name="fy", unit="N")],
        outputs=[MarkerOutput2D(name="corner", marker=Marker2D(body="sled", point=(0.4, 0.2)))],
    )  # fmt: skip


RIGID, HARD = NewtonImpact(restitution=0.0), KelvinVoigt(stiffness=1e4, damping=30.0)
STATES = {
    "open": (sled(RIGID, None, height=1.0), {"open"}),
    "closed": (sled(RIGID, None, speed=1.0), {"closed"}),
    "sticks": (sled(RIGID, CoulombFriction(coefficient=0.5)), {"closed"}),
    "slides": (sled(RIGID, CoulombFriction(coefficient=0.3), speed=1.0), {"closed"}),
    "force law, released too": (sled(HARD, TanhFriction(coefficient=0.3, transition_speed=0.01), 0.05, 0.5),
                                {"open", "active", "released"}),
}  # fmt: skip


@pytest.mark.parametrize("name", STATES)
def test_against_extrapolated_differences_in_every_contact_state(name):
    """Differences of the slave's own outputs at four values of the input, extrapolated: relative 1e-7."""
    model, wanted_modes = STATES[name]
    slave = started(model)
    slave.set_by_name({"fx": 0.4, "fy": -1.0})
    outputs = [v.name for v in slave.variables.block("channel") if v.kind == "real"]
    residuals = [n.startswith("residual.") for n in outputs]
    modes, seen = dict(enumerate(("open", "closed", "active", "released"))), set()
    for k in range(60 if len(wanted_modes) > 1 else 4):
        slave.do_step(0.005 * k, 0.005)
        mode = modes[slave["front.mode"]]
        if mode in seen and k % 7:
            continue
        seen.add(mode)
        for channel in ("fx", "fy"):
            found = derivatives(slave, channel, *outputs)
            snapshot, u = slave.snapshot(), slave[channel]

            def at(value, channel=channel, snapshot=snapshot):
                slave.set_by_name({channel: value})
                row = np.array([slave[n] for n in outputs])
                slave.restore(snapshot)
                return row

            slopes = [(at(u + d) - at(u - d)) / (2.0 * d) for d in (0.05, 0.1)]
            expected = (4.0 * slopes[0] - slopes[1]) / 3.0
            expected[residuals] = 0.0
            np.testing.assert_allclose(found, expected, rtol=1e-7, atol=1e-7 * np.max(np.abs(expected)))
    assert seen == wanted_modes
