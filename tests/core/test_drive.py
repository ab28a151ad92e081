"""Runs in one go against runs that stop at every event, and what compiled code may and may not remember."""

import math

import numpy as np
import pytest
from helpers import G, ball_over_floor
from tlismni.core import (
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    PoissonImpact,
    RigidBody2D,
    Simulation,
    SimulationError,
)
from tlismni.core.assembly import workspace
from tlismni.core.events.records import SETTLED, WANT_MEMORY
from tlismni.core.state.workspace_records import convergence_of
from tlismni.models import load

SCRATCH = ("found", "last_trial")


def in_pieces(sim, t_end):
    """Go to `t_end`, with a stop at every event."""
    while sim.advance_to_event(t_end):
        sim.handle_event()


def tumbling(friction):
    """A turning disk that bounces between a floor and a slope, and a second one that it meets."""
    rng = np.random.default_rng(5)
    law, rough = NewtonImpact(restitution=0.9), CoulombFriction(coefficient=friction) if friction else None
    bodies = [
        RigidBody2D(
            name=f"b{k}", mass=1.0 + k, inertia=0.01, position=(0.6 * k, 0.8 + 0.1 * k),
            velocity=tuple(rng.uniform(-1.0, 1.0, 2)), angular_velocity=float(rng.uniform(-9.0, 9.0)),
        )
        for k in range(2)
    ]  # fmt: skip
    disks = [Disk2D(marker=Marker2D(body=f"b{k}"), radius=0.1 + 0.05 * k) for k in range(2)]
    walls = [
        HalfPlane2D(),
        *(HalfPlane2D(marker=Marker2D(point=(x, 0.0), angle=a)) for x, a in ((-1.0, -1.2), (2.0, 1.2))),
    ]
    contacts = [
        DiskOnHalfPlane2D(name=f"c{i}{k}", plane=plane, disk=disk, law=law, friction=rough)
        for i, plane in enumerate(walls)
        for k, disk in enumerate(disks)
    ]
    contacts.append(DiskOnDisk2D(name="meet", a=disks[0], b=disks[1], law=law, friction=rough))
    return Model(gravity=(0.0, -G), bodies=bodies, contacts=contacts)


CASES = {
    "ball": (lambda: load("bouncing_ball").model, 4.5),
    "Poisson": (lambda: ball_over_floor(PoissonImpact(restitution=0.7)), 2.0),
    "pendulum": (lambda: load("pendulum_stop").model, 1.0),
    "slider-crank": (lambda: load("slider_crank_stop").model, 0.4),
    "woodpecker": (lambda: load("woodpecker").model, 0.3),
    "smooth": (lambda: tumbling(0.0), 1.2),
    "rough": (lambda: tumbling(0.2), 1.2),
}


@pytest.mark.parametrize("method", ["ebdf", "irk", "hht"])
@pytest.mark.parametrize("case", CASES)
def test_events_are_those_of_a_run_that_stops_at_each(case, method):
    build, t_end = CASES[case]
    runs = [Simulation(build(), method) for _ in range(2)]
    runs[0].advance(t_end)
    in_pieces(runs[1], t_end)
    ours, theirs = (run.events for run in runs)
    assert [(e.kind, e.contact) for e in ours] == [(e.kind, e.contact) for e in theirs]
    assert ours
    # a rounding in one impact grows with each that follows
    grown = 1e-12 * 3.0 ** np.minimum(np.arange(len(ours)), 14)
    assert np.all(np.abs([a.t - b.t for a, b in zip(ours, theirs, strict=True)]) <= grown)
    for name in ("impulse", "friction_impulse", "energy_loss", "approach_speed", "separation_speed"):
        x, y = (np.array([getattr(e, name) for e in events]) for events in (ours, theirs))
        assert np.all(np.abs(x - y) <= grown * 100.0 * max(1.0, np.max(np.abs(y))))
    assert runs[0].stats["steps"] == pytest.approx(runs[1].stats["steps"], rel=0.05, abs=3)


def test_what_only_works_is_not_remembered():
    """NaN in all that is not state changes no bit of what follows."""
    clean, dirty = (Simulation(tumbling(0.3)) for _ in range(2))
    for k in range(1, 60):
        clean.advance(0.02 * k)
        arrays = dirty.drive._record.arrays
        for name in SCRATCH:
            arrays[name][...] = np.nan
        for scratch in dirty.drive.instant.scratch():
            scratch[:] = np.nan
        dirty.advance(0.02 * k)
    assert len(clean.events) > 3
    assert dirty.values().tobytes() == clean.values().tobytes()
    assert dirty.events == clean.events


def test_memory_that_has_to_be_given_first_leaves_the_state_untouched(monkeypatch):
    """A ball that comes to rest: for the structure of the closed contact there is no room yet."""
    monkeypatch.setattr(workspace, "FEW_CONTACTS", 0)
    sim = Simulation(ball_over_floor(NewtonImpact(restitution=0.5, rest_ratio=0.3)))
    assert sim.advance_to_event(1.0)
    assert sim.drive.settle(sim.pending) == SETTLED
    sim.pending = []
    sim.drive.take_pending()
    sim.take_events()
    assert sim.advance_to_event(3.0)
    before, pending, asked = sim.state(), list(sim.pending), []
    while (status := sim.drive.settle(pending)) != SETTLED:
        sim.workspace.sync()
        after = sim.state()
        assert after.facts == before.facts and after.events == before.events
        for name, array in before.arrays.items():
            if name == "rate":  # factors are made anew after every instant
                convergence_of(after.arrays[name]).factor_age = convergence_of(array).factor_age
                assert np.array_equal(after.arrays[name], array)
            elif not name.startswith(("kkt", "lu_d")):
                assert after.arrays[name].tobytes() == array.tobytes(), name
        asked.append(status)
        sim.build_wanted(status)
    assert asked and set(asked) == {WANT_MEMORY}
    sim.workspace.sync()
    sim.take_events()
    assert sim.events[-1].kind == "rest"


def test_a_state_between_impacts_goes_on_bit_for_bit():
    model = tumbling(0.2)
    sim = Simulation(model)
    sim.advance(0.5)
    state = sim.state()
    sim.advance(1.2)
    other = Simulation(model)
    other.restore(type(state).from_bytes(state.to_bytes()))
    other.advance(1.2)
    assert other.state() == sim.state()


def test_bounces_count_as_steps():
    sim = Simulation(load("bouncing_ball", restitution=1.0).model, max_steps=100)
    with pytest.raises(SimulationError, match="max_steps = 100"):
        sim.advance(1e4)
    assert 10 < len(sim.events) < 100


def test_the_room_for_events_is_emptied():
    """More bounces in one call than the buffer holds, each at its time."""
    sim = Simulation(load("bouncing_ball", restitution=1.0).model, "irk", rtol=1e-8)
    fall = math.sqrt(2.0 / G)
    sim.advance(2501.0 * 2.0 * fall)
    assert len(sim.events) == 2501
    times = np.array([e.t for e in sim.events])
    n = np.arange(1, len(times) + 1)
    assert np.all(np.abs(times / fall - (2.0 * n - 1.0)) < 5e-15 * n**1.5)
