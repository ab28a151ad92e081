"""Whole turns at the start of runs without Python that begin at other times, where a driver says them."""

import math

import numpy as np
import pytest
from tlismni.core import (
    AngleDriver3D,
    AngleStop3D,
    HuntCrossley,
    Marker3D,
    Model,
    PIDController3D,
    Polynomial,
    Revolute3D,
    RigidBody3D,
    RotationVector,
    Servo3D,
    Simulation,
    Sine,
    TorsionSpring3D,
)
from tlismni.core.compiled.library import LIBRARY
from tlismni.core.events.records import DECLINED, SETTLED, SINGULAR_JOINTS
from tlismni.core.native import image_of
from tlismni.core.native.beginning import let_begin
from tlismni.core.simulation.begin_now import begin_now

TURN = 2.0 * math.pi
ANGLE = 0.5
"""At the start, but for whole turns."""
TIMES = (0.0, 2.0, -1.0, 5.0)
DRIVERS = {
    "steady": (Polynomial(coefficients=(ANGLE, TURN)), TURN),
    "back": (Polynomial(coefficients=(ANGLE - TURN, -2.0 * TURN)), -2.0 * TURN),
    "faster": (Polynomial(coefficients=(ANGLE, 0.0, TURN)), 0.0),
    "to and fro": (Sine(amplitude=0.3, angular_frequency=TURN, offset=ANGLE + 3.0 * TURN), 0.3 * TURN),
}
FAR = {"start_tolerance": 100.0}
"""What is driven faster and faster has another speed at each start."""


def rotor(signal, rate, flipped=False, **hinge):
    """A rotor that a driver turns, with all that counts turns; `flipped`: the driver has its markers the other way
    round, a quarter of a turn on."""
    ends = {"a": Marker3D(), "b": Marker3D(body="rotor", attitude=RotationVector(vector=(0.0, 0.0, 0.2)))}
    way = ends
    if flipped:
        way = {"a": ends["b"], "b": Marker3D(attitude=RotationVector(vector=(0.0, 0.0, 0.5 * math.pi)))}
    target = Sine(amplitude=0.4, angular_frequency=3.0)
    return Model(
        gravity=(0.0, 0.0, 0.0),
        bodies=[
            RigidBody3D(
                name="rotor", mass=1.0, inertia=(0.1, 0.1, 0.2), angular_velocity=(0.0, 0.0, rate),
                attitude=RotationVector(vector=(0.0, 0.0, ANGLE - 0.2)),
            )
        ],
        joints=[Revolute3D(name="hinge", **ends, **hinge), AngleDriver3D(name="driver", **way, angle=signal)],
        forces=[
            TorsionSpring3D(name="spring", **ends, stiffness=0.02),
            Servo3D(name="servo", **ends, target=target, gain=0.1),
            PIDController3D(name="pid", **ends, target=target, gain=0.3, integral_gain=0.2),
        ],
        contacts=[
            AngleStop3D(name="stop", **ends, limit=90.5 * TURN, law=HuntCrossley(stiffness=0.3, restitution=0.5))
        ],
    )  # fmt: skip


def at(model, t):
    return Simulation(model, t0=t, **FAR)


@pytest.mark.parametrize("driver", DRIVERS)
def test_a_run_that_begins_anew_is_one_that_begins_there(driver):
    model = rotor(*DRIVERS[driver])
    here = Simulation(model, **FAR)
    let_begin(here, FAR)
    for t in TIMES:
        here.beginning.numbers[0] = t
        while DECLINED < (code := int(begin_now(here.beginning.record.record))) < SINGULAR_JOINTS:
            here.workspace.sync()
            here.build_wanted(code)  # which runs without Python have before
        here.workspace.sync()
        assert code == SETTLED
        there = at(model, t)
        for field in here.workspace.state.dtype.names:
            assert here.workspace.state[field].tobytes() == there.workspace.state[field].tobytes(), (t, field)
        signal = DRIVERS[driver][0]
        said = ANGLE + 3.0 * TURN if driver == "to and fro" else np.polyval(signal.coefficients[::-1], t)
        values = dict(zip((c.name for c in there.channels), there.values(), strict=True))
        assert values["hinge.angle"] == pytest.approx(said, abs=1e-9)


@pytest.mark.sampled(2)
@pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
@pytest.mark.parametrize("case", [*DRIVERS, "flipped", "said by the hinge", "faster than in the image"])
def test_the_same_bits_from_other_times(case):
    from tlismni.core.native.in_process import NativeModel, NativeRun

    signal, rate = DRIVERS.get(case, DRIVERS["steady"])
    more = {"start_angle": ANGLE + TURN} if case == "said by the hinge" else {}
    if case == "flipped":
        signal = Polynomial(coefficients=(0.5 * math.pi - ANGLE, -TURN))
    model, setting = rotor(signal, rate, case == "flipped", **more), []
    if case == "faster than in the image":
        model = rotor(DRIVERS["faster"][0], 0.0)
        setting = ["driver.angle.coefficients.2"]
    native = NativeModel(image_of(model, 0.3, parameters=setting, **FAR), LIBRARY)
    if setting:
        model = model.with_parameters({setting[0]: 0.5 * TURN})
    for t in TIMES:
        run, sim = NativeRun(native), at(model, t)
        if setting:
            run.set_parameter(0, 0.5 * TURN)
        run.start_at(t)
        assert run.look().tobytes() == sim.values().tobytes(), t
        for step in (0.1, 0.31, 0.7):
            sim.advance(t + step)
            assert run.step(t + step).tobytes() == sim.values().tobytes(), (t, step)
        assert (run.events, run.steps) == (len(sim.events), sim.stats["steps"])
