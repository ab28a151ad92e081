"""State is a value: store, go on, restore, go on again, and get the same bits."""

import numpy as np
import pytest
from helpers import ball_over_floor, point_pendulum, rod_pendulum
from tlismni.core import (
    METHODS,
    AppliedTorque2D,
    Flores,
    Input,
    InputSignal,
    KelvinVoigt,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody3D,
    Simulation,
    State,
    TlismniError,
)
from tlismni.models import load


def pendulum_stop(driven=False):
    return load("pendulum_stop", restitution=0.7, driven=driven).model


CASES = {
    "pendulum": (lambda: point_pendulum(0.3, 2.0), 0.4, 1.5),
    "across impacts": (pendulum_stop, 0.5, 2.0),
    "after impacts": (pendulum_stop, 1.3, 2.2),
    "across accumulation": (lambda: ball_over_floor(NewtonImpact(restitution=0.5)), 0.9, 2.0),
    "at rest": (lambda: ball_over_floor(NewtonImpact(restitution=0.5)), 1.9, 2.2),
    "in force contact": (lambda: ball_over_floor(Flores(stiffness=1e3, restitution=0.6)), 0.5, 1.4),
    "in released contact": (lambda: ball_over_floor(KelvinVoigt(stiffness=200.0, damping=30.0)), 0.58, 1.4),
}


def trajectory(sim, times):
    """All that can be seen: samples and channel values at each time, and the events."""
    rows = []
    for t in times:
        sim.advance(float(t))
        rows += [sim.sample(), sim.values()]
    return b"".join(row.tobytes() for row in rows), [event.to_dict() for event in sim.events], sim.stats


def started(model, t, method="ebdf", **options):
    sim = Simulation(model, method, rtol=1e-7, atol=1e-10, **options)
    sim.advance(t)
    return sim


@pytest.mark.sampled(8)
@pytest.mark.parametrize("case", CASES)
@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
def test_restored_run_repeats_itself_bit_for_bit(case, method):
    build, stored_at, end = CASES[case]
    times = np.linspace(stored_at, end, 7)[1:]
    sim = started(build(), stored_at, method)
    state = sim.state()
    first = trajectory(sim, times)
    sim.restore(state)
    assert sim.t == stored_at
    assert sim.state() == state and sim.state().to_bytes() == state.to_bytes()
    assert trajectory(sim, times) == first


EVERY_METHOD = [
    *((name, {}) for name in METHODS),
    *(("irk", {"tableau": name}) for name in ("gauss2", "gauss3", "sdirk4")),
    ("ebdf", {"k": "auto"}),
    ("mebdf", {"k": "auto"}),
    ("bdf", {"order": "auto"}),
    ("ebdf", {"outer": "jfnk"}),
    ("ebdf", {"outer": "simple", "acceleration": "anderson"}),
    ("hht", {"controller": "h211b"}),
    ("generalized_alpha", {"form": "index3"}),
    ("baumgarte", {"scheme": "sdirk4"}),
]


@pytest.mark.parametrize("method, options", EVERY_METHOD)
def test_every_method_repeats_itself_and_goes_on_from_a_stored_state_bit_for_bit(method, options):
    """Two runs, and a run restarted from bytes in a new simulation, across impacts."""
    times = np.linspace(0.5, 1.6, 6)[1:]
    runs = []
    for _ in range(2):
        sim = Simulation(pendulum_stop(), method, rtol=1e-5, atol=1e-7, **options)
        sim.advance(0.5)
        stored = sim.state().to_bytes()
        runs.append(trajectory(sim, times))
    assert runs[0] == runs[1]
    assert any(event["kind"] == "impact" and event["t"] > 0.5 for event in runs[0][1])
    other = Simulation(pendulum_stop(), method, rtol=1e-5, atol=1e-7, **options)
    other.restore(State.from_bytes(stored))
    assert trajectory(other, times) == runs[0]


def free_spin():
    inertia, spin = (0.01, 0.012, 0.014), (3.0, 10.0, -4.0)
    return Model(
        gravity=(0.0, 0.0, 0.0), bodies=[RigidBody3D(name="b", mass=1.0, inertia=inertia, angular_velocity=spin)]
    )


@pytest.mark.sampled(16)
@pytest.mark.parametrize("build", [free_spin, lambda: load("spatial_slider_crank").model], ids=["body", "slider-crank"])
@pytest.mark.parametrize("method, options", EVERY_METHOD)
def test_smooth_motion_in_space_goes_on_bit_for_bit(method, options, build):
    """Many rows behind one another, whose number and places a state must have as far back as any step looks."""
    for rtol in (1e-3, 1e-6):
        sim, other = (Simulation(build(), method, rtol=rtol, **options) for _ in range(2))
        sim.advance(0.3)
        state = sim.state()
        other.restore(state)
        for t in (0.35, 0.5):
            for run in (sim, other):
                run.advance(t)
            assert sim.state() == other.state()
            assert np.array_equal(sim.values(), other.values())


@pytest.mark.parametrize("case", CASES)
def test_state_goes_on_in_another_simulation_after_a_journey_as_bytes(case):
    build, stored_at, end = CASES[case]
    times = np.linspace(stored_at, end, 5)[1:]
    sim = started(build(), stored_at)
    data = sim.state().to_bytes()
    first = trajectory(sim, times)
    other = Simulation(build(), "ebdf", rtol=1e-7, atol=1e-10)
    other.restore(State.from_bytes(data))
    assert other.state().to_bytes() == data
    assert trajectory(other, times) == first


def test_taking_a_state_and_sampling_change_nothing():
    times = np.linspace(0.1, 2.0, 20)
    plain = started(pendulum_stop(), 0.0)
    for t in times:
        plain.advance(t)
    watched = started(pendulum_stop(), 0.0)
    for t in times:
        watched.advance(t)
        watched.state()
        watched.values()
    ahead = np.linspace(2.1, 3.0, 5)
    assert trajectory(plain, ahead)[:2] == trajectory(watched, ahead)[:2]


def test_state_with_an_event_still_to_come():
    """Sampled in the step that ends at an impact: the impact is found, but has not happened yet."""
    found = []
    for t in np.linspace(0.2, 0.45, 200):
        sim = started(ball_over_floor(NewtonImpact(restitution=0.5)), t)
        if sim.pending and not sim.events:
            found.append(sim)
    assert found
    for sim in found[:: max(1, len(found) // 5)]:
        state = State.from_bytes(sim.state().to_bytes())
        first = trajectory(sim, [0.5, 1.0])
        assert sim.events
        sim.restore(state)
        assert sim.pending and not sim.events
        assert trajectory(sim, [0.5, 1.0]) == first


def test_restoring_back_and_forth_in_time():
    """As a co-simulation master does it: try a step, go back, make it in halves, go back to the very start."""
    sim = Simulation(pendulum_stop(), rtol=1e-8, atol=1e-11)
    origin = sim.state()
    sim.advance(0.6)
    middle, at_middle = sim.state(), sim.sample()
    sim.advance(1.4)
    at_end = sim.sample()
    sim.restore(origin)
    sim.advance(0.3)
    sim.restore(middle)
    assert sim.sample().tobytes() == at_middle.tobytes()
    sim.advance(1.4)
    assert sim.sample().tobytes() == at_end.tobytes()
    sim.restore(origin)
    sim.advance(0.6)
    sim.advance(1.4)
    assert sim.sample().tobytes() == at_end.tobytes()


def test_inputs_belong_to_the_state():
    sim = Simulation(pendulum_stop(driven=True), rtol=1e-8, atol=1e-11)
    sim.set_inputs({"torque": 2.0})
    sim.advance(0.3)
    state = sim.state()
    sim.advance(0.6)
    expected = sim.sample()
    sim.restore(state)
    sim.set_inputs({"torque": -5.0})
    sim.advance(0.6)
    assert sim.sample().tobytes() != expected.tobytes()
    sim.restore(state)
    sim.advance(0.6)
    assert sim.sample().tobytes() == expected.tobytes()


def test_two_simulations_do_not_disturb_each_other():
    model, times = pendulum_stop(), np.linspace(0.1, 1.5, 15)
    alone = trajectory(started(model, 0.0), times)
    a, b, c = started(model, 0.0), started(point_pendulum(0.1), 0.0), started(model, 0.0)
    rows = []
    for t in times:
        a.advance(float(t))
        rows += [a.sample(), a.values()]
        b.advance(float(t))
        c.advance(0.5 * float(t))
        c.values()
    assert b"".join(row.tobytes() for row in rows) == alone[0]


@pytest.mark.parametrize("damage", ["cut", "flip", "empty", "tail", "noise"])
def test_damaged_bytes_are_refused(damage):
    data = started(pendulum_stop(), 0.3).state().to_bytes()
    flipped = bytearray(data)
    flipped[len(data) // 2] ^= 1
    bad = {
        "cut": data[: len(data) // 2],
        "flip": bytes(flipped),
        "empty": b"",
        "tail": data + b"\0",
        "noise": bytes(range(256)) * 8,
    }[damage]
    with pytest.raises(ModelError, match="state"):
        State.from_bytes(bad)


def test_state_of_another_model_method_or_tolerance_is_refused():
    state = started(point_pendulum(0.3), 0.2).state()
    for other in (
        Simulation(point_pendulum(0.3, length=1.1), rtol=1e-7, atol=1e-10),
        Simulation(point_pendulum(0.3), "irk", rtol=1e-7, atol=1e-10),
        Simulation(point_pendulum(0.3), rtol=1e-6, atol=1e-10),
        Simulation(point_pendulum(0.3), rtol=1e-7, atol=1e-10, k=3),
    ):
        before = other.state()
        with pytest.raises(ModelError, match="another model"):
            other.restore(state)
        assert other.state() == before


def test_states_compare_by_value():
    sim = started(pendulum_stop(), 0.3)
    a, b = sim.state(), sim.state()
    assert a == b and hash(a) == hash(b) and a != 3
    sim.advance(0.31)
    assert sim.state() != a


@pytest.mark.parametrize("case", ["pendulum", "across impacts", "across accumulation", "in force contact"])
@pytest.mark.parametrize("method", ["ebdf", "bdf", "irk", "hht"])
def test_communication_grid_does_not_change_the_values(case, method):
    """Without inputs, samples are read from steps that do not know of them: equal bits on any grid."""
    build, _, end = CASES[case]
    coarse, fine = np.linspace(0.0, end, 5), np.linspace(0.0, end, 33)
    rows = []
    for grid in (coarse, fine):
        sim = Simulation(build(), method, rtol=1e-7, atol=1e-10)
        samples = {}
        for t in grid:
            sim.advance(float(t))
            samples[float(t)] = sim.sample().tobytes()
        rows.append(samples)
    common = set(rows[0]) & set(rows[1])
    assert len(common) == 5
    assert all(rows[0][t] == rows[1][t] for t in common)


def test_held_input_gives_the_same_motion_as_a_constant_load():
    from tlismni.core import Constant

    def torque(signal, **parts):
        return rod_pendulum(0.2, forces=[AppliedTorque2D(name="m", body="rod", torque=signal)], **parts)

    driven = Simulation(torque(InputSignal(channel="u"), inputs=[Input(name="u", start=1.5)]), rtol=1e-9, atol=1e-12)
    for t in np.linspace(0.1, 1.0, 10):
        driven.set_inputs({"u": 1.5})
        driven.advance(t)
    constant = Simulation(torque(Constant(value=1.5)), rtol=1e-9, atol=1e-12)
    constant.advance(1.0)
    assert driven.table.column(driven.sample()[None], "rod.angle") == pytest.approx(
        constant.table.column(constant.sample()[None], "rod.angle"), abs=1e-7
    )


def test_restore_into_a_running_simulation_that_failed_meanwhile():
    """A refused call leaves the simulation usable."""
    sim = started(pendulum_stop(), 0.3)
    before = sim.state()
    for wrong in (lambda: sim.advance(0.1), lambda: sim.advance(float("nan")), lambda: sim.set_inputs({"no": 1.0})):
        with pytest.raises(TlismniError):
            wrong()
    assert sim.state() == before


def test_states_share_their_events_and_keep_them():
    sim = started(ball_over_floor(NewtonImpact(restitution=0.5)), 0.6)
    first = sim.state()
    assert isinstance(first.events, tuple) and len(first.events) == 1
    assert sim.state().events is first.events
    sim.advance(1.0)
    later = sim.state()
    assert len(later.events) > 1 and len(first.events) == 1
    assert later.events[0] is first.events[0]
    sim.restore(first)
    assert sim.events == list(first.events) and sim.state().events is first.events
    sim.advance(1.0)
    assert sim.state() == later
    assert State.from_bytes(later.to_bytes()) == later


def test_taking_a_state_serialises_nothing(monkeypatch):
    """States are taken at every communication point: only those that travel as bytes pay for it."""
    sim = started(pendulum_stop(), 1.0)
    before = sim.state()

    def forbidden(*arguments, **options):
        raise AssertionError("serialised")

    monkeypatch.setattr("json.dumps", forbidden)
    monkeypatch.setattr(type(sim.events[0]), "to_dict", forbidden)
    monkeypatch.setattr(type(sim.system), "identity", forbidden)
    state = sim.state()
    sim.restore(state)
    monkeypatch.undo()
    assert state == before


def test_values_of_one_sample_are_the_columns_of_many_bit_for_bit():
    """Contact as a constraint, as a force, and a driven damper: every kind of channel."""
    law = Flores(stiffness=1e3, restitution=0.6)
    for model in (pendulum_stop(driven=True), ball_over_floor(law), ball_over_floor(NewtonImpact(restitution=0.5))):
        sim = Simulation(model, rtol=1e-7, atol=1e-10)
        samples, rows = [], []
        for t in np.linspace(0.0, 1.5, 31):
            sim.advance(float(t))
            samples.append(sim.sample())
            rows.append(sim.values())
        columns = [sim.table.column(np.array(samples), channel.name) for channel in sim.channels]
        assert np.array(rows).tobytes() == np.ascontiguousarray(np.transpose(columns)).tobytes()


@pytest.mark.parametrize("given", ["x", 3, None])
def test_what_are_no_bytes_is_refused(given):
    with pytest.raises(ModelError, match="bytes of a solver state are needed"):
        State.from_bytes(given)


def test_a_state_before_impacts_that_revisit_sets_of_contacts_goes_on_bit_for_bit():
    """Pivots that were chosen at an earlier visit are no part of a state: they must not be used again."""
    model = load("hub_beam_stop", modes=8).model
    sim = Simulation(model)
    sim.advance(0.0125)
    state = sim.state()
    sim.advance(0.065)
    assert len({e.t for e in sim.events if e.t > 0.0125}) >= 3
    end, events = sim.values().copy(), list(sim.events)
    for other in (sim, Simulation(model)):
        other.restore(state)
        other.advance(0.065)
        assert np.array_equal(other.values(), end) and other.events == events
