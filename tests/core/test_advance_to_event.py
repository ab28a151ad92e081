"""Going from event to event is the same run as going through them, and shows both sides of each."""

import math

import numpy as np
import pytest
from tlismni.core import (
    AppliedForce2D,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Input,
    InputSignal,
    Model,
    NewtonImpact,
    PointMass2D,
    Simulation,
)
from tlismni.core.errors import ModelError
from tlismni.core.model.markers import Marker2D
from tlismni.models import load

T_END = {"pendulum_stop": 1.0, "bouncing_ball": 1.0, "stick_slip": 2.0, "newtons_cradle": 0.5}


def simulation(name, **parameters):
    scenario = load(name, **parameters)
    return Simulation(scenario.model, scenario.method, scenario.rtol, scenario.atol, **scenario.options)


def steps_between(sim, points):
    """Go over `points` with a stop at every event. Gives the stops' times and the channels at the points."""
    stops, rows = [], []
    for t in points:
        while sim.advance_to_event(t):
            assert sim.event_due and sim.t <= t
            stops.append(sim.t)
            while sim.handle_event():
                pass
            assert not sim.event_due
        assert sim.t == t
        rows.append(sim.values())
    return stops, rows


@pytest.mark.parametrize("name", list(T_END))
def test_the_run_is_the_same_bit_for_bit(name):
    points = np.linspace(0.0, T_END[name], 14)[1:]
    through, over = simulation(name), simulation(name)
    stops, rows = steps_between(through, points)
    expected = []
    for t in points:
        over.advance(t)
        expected.append(over.values())
    assert np.array_equal(rows, expected)
    assert through.events == over.events
    # stops and events are the same instants; what happened at the start happened before the first stop
    assert sorted(set(stops)) == sorted({e.t for e in over.events if e.t > 0.0})


def test_both_sides_of_an_impact():
    sim = simulation("bouncing_ball", restitution=0.8)
    assert sim.advance_to_event(10.0)
    names = [c.name for c in sim.channels]
    speed, gap = names.index("ball.vy"), next(i for i, n in enumerate(names) if n.endswith(".gap"))
    before, count = sim.values(), len(sim.events)
    sim.handle_event()
    after, event = sim.values(), sim.events[-1]
    assert len(sim.events) == count + 1 and event.kind == "impact" and event.t == sim.t
    assert before[speed] == pytest.approx(-event.approach_speed, rel=1e-12)
    assert after[speed] == pytest.approx(-0.8 * before[speed], rel=1e-12)
    assert abs(before[gap]) < 1e-12 and before[gap] == after[gap]


def test_asking_and_storing_at_an_event_leave_no_trace():
    first, second = simulation("pendulum_stop"), simulation("pendulum_stop")
    assert first.advance_to_event(1.0) and second.advance_to_event(1.0)
    state = first.state()
    first.values()
    third = simulation("pendulum_stop")
    third.restore(type(state).from_bytes(state.to_bytes()))
    assert third.event_due and third.t == second.t
    for sim in (first, second, third):
        sim.advance(1.0)
    assert first.values().tobytes() == second.values().tobytes() == third.values().tobytes()
    assert first.events == third.events


def test_a_time_before_the_present_is_refused():
    sim = simulation("bouncing_ball")
    sim.advance(0.1)
    with pytest.raises(ModelError, match=r"cannot advance from t = 0.1 to 0.05"):
        sim.advance_to_event(0.05)


def test_an_event_within_rounding_of_a_communication_point():
    """The event may lie before one by less than any step."""

    def stopped(target):
        sim = simulation("pendulum_stop")
        sim.advance(0.48)
        sim.advance(target)
        return sim

    event = 0.49
    for margin in (0.0, 1e-6, 1e-9, 1e-12):  # where the step ends moves the event by its error
        event = stopped(event * (1.0 + margin)).events[0].t
    angle = [c.name for c in stopped(0.48).channels].index("pendulum.angle")
    near = 0
    for ulps in range(-8, 9):
        target = event + ulps * np.spacing(event)
        sim = stopped(target)
        near += bool(sim.events) and 0.0 < target - sim.events[0].t < 4e-16 * target
        assert sim.values()[angle] == pytest.approx(-np.pi / 2.0, rel=1e-11)
        sim.set_inputs({sim.assembly.input_names[0]: 1e-9 * ulps})
        sim.advance(0.5)
        assert len(sim.events) == 1
    assert near  # the case was met


def test_an_event_due_at_a_point_just_after_a_row_happens_there():
    """A force lifts a ball off the floor one unit of rounding after the newest row, where no step can end."""
    marker = Marker2D(body="ball")
    model = Model(
        bodies=[PointMass2D(name="ball", mass=2.0)],
        forces=[AppliedForce2D(name="lift", marker=marker, force_y=InputSignal(channel="push"))],
        contacts=[
            DiskOnHalfPlane2D(
                name="floor", plane=HalfPlane2D(), disk=Disk2D(marker=marker, radius=0.0),
                law=NewtonImpact(restitution=0.5),
            )
        ],
        inputs=[Input(name="push", unit="N")],
    )  # fmt: skip
    sim = Simulation(model)
    sim.advance(1.0)
    sim.set_inputs({"push": 1.0})  # from here there is one row and no step
    assert not sim.advance_to_event(math.nextafter(1.0, 2.0))
    sim.set_inputs({"push": 30.0})
    assert sim.event_due
    assert not sim.advance_to_event(1.5)
    acceleration = 30.0 / 2.0 - 9.81
    height = dict(zip([c.name for c in sim.channels], sim.values(), strict=True))["ball.y"]
    assert height == pytest.approx(0.5 * acceleration * 0.5**2, rel=1e-9)
