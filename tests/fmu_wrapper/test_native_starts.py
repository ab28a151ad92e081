"""FMUs without Python that begin anew, with other parameters or at another time; and inputs with slopes."""

import numpy as np
import pytest
from fmpy.fmi1 import FMICallException
from native_pair import Pair, scenario_pair, step_alike
from tlismni.core.compiled.library import LIBRARY
from tlismni.core.elements import AngleDriver3D, AppliedForce2D, PointMass2D, Revolute3D, RigidBody3D, TorsionSpring3D
from tlismni.core.model.channels import Input
from tlismni.core.model.markers import Marker2D, Marker3D
from tlismni.core.model.signals import InputSignal, Polynomial, Step
from tlismni.core.multibody_model import Model

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")


@pytest.fixture(scope="module", params=["2.0", "3.0"])
def stop(request, tmp_path_factory):
    return scenario_pair("pendulum_stop", tmp_path_factory.mktemp("stop"), request.param)


def numbers(side):
    return np.array((side.fmu.getFloat64 if side.three else side.fmu.getReal)(side.reals))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("parameter, value", [("mass", 3.3), ("length", 0.37), ("gravity", 1.62), ("mass", 0.02)])
def test_one_parameter_gives_the_bits_of_the_fmu_with_python(stop, parameter, value):
    sides = stop.instances()
    for side in sides:
        side.begin(**{parameter: value})
    assert sides[0].read() == sides[1].read()
    step_alike(sides, 8, 0.21)


def test_several_parameters_are_the_same_to_rounding(stop):
    """Words that follow from two of them are rounded in another order."""
    sides = stop.instances()
    for side in sides:
        side.begin(mass=1.7, length=0.8, gravity=6.0, restitution=0.4)
    for _ in range(6):
        for side in sides:
            side.step(0.1)
        found, wanted = map(numbers, sides)
        np.testing.assert_allclose(found, wanted, rtol=1e-7, atol=1e-9 * np.max(np.abs(wanted)))


def test_an_angle_at_the_start(stop):
    """Sines and cosines of it: to rounding."""
    sides = stop.instances()
    for side in sides:
        side.begin(start_angle=-0.4)
    found, wanted = map(numbers, sides)
    np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-10)


def test_parameters_that_exclude_each_other(stop):
    side = stop.instances()[0]
    side.set(length=0.5)
    with pytest.raises(FMICallException):
        side.set(start_angle=0.3)
    plain = stop.instances()[1]
    for s in (side, plain):
        s.begin(length=0.5)
        s.step(0.3)
    assert side.read() == plain.read()


def test_a_reset_forgets_them(stop):
    side, fresh = stop.instances()[0], stop.instances()[0]
    side.begin(mass=2.0)
    side.step(0.4)
    side.fmu.reset()
    side.time = 0.0
    for s in (side, fresh):
        s.begin()
        s.step(0.4)
    assert side.read() == fresh.read()


def test_a_state_takes_them_along(stop):
    if stop.version == "3.0":
        save, restore = ("getFMUState", "setFMUState")
    else:
        save, restore = ("getFMUstate", "setFMUstate")
    side = stop.instances()[0]
    side.begin(mass=2.0, length=0.6)
    side.step(0.1)
    kept = getattr(side.fmu, save)()
    side.step(0.2)
    wanted, side.time = side.read(), 0.1
    getattr(side.fmu, restore)(kept)
    side.step(0.2)
    assert side.read() == wanted


def pushed(starts):
    """A mass under a force that is an input, and one that jumps at 0.5 s."""
    return Model(
        name="pushed",
        gravity=(0.0, 0.0),
        bodies=[PointMass2D(name="p", mass=2.0, velocity=(1.0, 0.0))],
        forces=[
            AppliedForce2D(name="drive", marker=Marker2D(body="p"), force_x=InputSignal(channel="push")),
            AppliedForce2D(name="jump", marker=Marker2D(body="p"), force_y=Step(time=0.5, before=0.0, after=starts)),
        ],
        inputs=[Input(name="push", unit="N")],
    )


@pytest.mark.sampled(2)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
@pytest.mark.parametrize("start", [0.2, 1.5, -3.0])
def test_another_start_time(version, start, tmp_path):
    pair = Pair(pushed(3.0), tmp_path, version, t_end=1.0)
    sides = pair.instances()
    for side in sides:
        if side.three:
            side.fmu.enterInitializationMode(startTime=start)
        else:
            side.fmu.setupExperiment(startTime=start)
            side.fmu.enterInitializationMode()
        side.set(push=1.0)
        side.fmu.exitInitializationMode()
        side.time = start
    step_alike(sides, 9, 0.1)
    # v_y = F / m (t - 0.5 s) once the force has begun
    t, by_name = sides[0].time, sides[0].by_name
    (speed,) = (sides[0].fmu.getFloat64 if sides[0].three else sides[0].fmu.getReal)([by_name["p.vy"].valueReference])
    assert speed == pytest.approx(1.5 * max(0.0, t - max(0.5, start)), abs=1e-9)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("version", ["2.0", "3.0"])
def test_turns_of_a_driven_hinge_at_another_start_time(version, tmp_path):
    """The driver says how many whole turns there are at the start; the spring holds each of them."""
    turn, start = 2.0 * np.pi, 2.0
    ends = {"a": Marker3D(), "b": Marker3D(body="rotor")}
    model = Model(
        name="rotor",
        gravity=(0.0, 0.0, 0.0),
        bodies=[RigidBody3D(name="rotor", mass=1.0, inertia=(0.1, 0.1, 0.2), angular_velocity=(0.0, 0.0, turn))],
        joints=[
            Revolute3D(name="hinge", **ends),
            AngleDriver3D(name="driver", **ends, angle=Polynomial(coefficients=(0.0, turn))),
        ],
        forces=[TorsionSpring3D(name="spring", **ends, stiffness=0.02)],
    )
    sides = Pair(model, tmp_path, version, t_end=1.0).instances()
    for side in sides:
        side.begin(start)
    step_alike(sides, 4, 0.1)
    t, by_name = sides[0].time, sides[0].by_name
    read = sides[0].fmu.getFloat64 if sides[0].three else sides[0].fmu.getReal
    names = ("hinge.angle", "driver.torque_z")
    angle, torque = read([by_name[name].valueReference for name in names])
    assert angle == pytest.approx(turn * t, abs=1e-8)
    assert abs(torque) == pytest.approx(0.02 * turn * t, abs=1e-6)


def test_inputs_with_derivatives(tmp_path):
    """The bits of the FMU with Python, over uneven steps, with slopes that end when the input is set without."""
    sides = Pair(pushed(0.0), tmp_path, "2.0", t_end=1.0).instances()
    random, seen = np.random.default_rng(8), []
    for side in sides:
        side.begin(push=0.5)
    vr = [sides[0].by_name["push"].valueReference]
    for k in range(40):
        h, what = float(random.uniform(1e-3, 0.1)), int(random.integers(4))
        values = random.uniform(-2.0, 2.0, 3).tolist()
        for side in sides:
            if what == 0:
                side.set(push=values[0])
            if what == 1:
                side.fmu.setRealInputDerivatives(vr, [1], [values[1]])
            if what == 2:
                side.set(push=values[0])
                side.fmu.setRealInputDerivatives(vr * 2, [1, 2], values[1:])
            side.step(h)
        assert sides[0].fmu.getReal(vr) == sides[1].fmu.getReal(vr), k
        assert sides[0].read() == sides[1].read(), k
        seen.append(sides[0].fmu.getReal(vr)[0])
    assert len(set(seen)) > 20
    for wrong in (([3], [1.0]), ([1], [np.inf])):
        with pytest.raises(FMICallException):
            sides[0].fmu.setRealInputDerivatives(vr, *wrong)
