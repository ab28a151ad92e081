"""Disks that fall into a box and come to rest on each other, with friction: many contacts, many instants."""

import numpy as np
import pytest
from tlismni.core import (
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    RigidBody2D,
    Simulation,
)

RADIUS, WIDTH, G = 0.05, 0.34, 9.81


def heap(count, restitution, friction, seed, rest_ratio=1e-6):
    """So many disks of 1 kg over a box of 0.34 m, three in a row."""
    rng = np.random.default_rng(seed)
    law = NewtonImpact(restitution=restitution, rest_ratio=rest_ratio)
    rough = CoulombFriction(coefficient=friction)
    bodies = [
        RigidBody2D(
            name=f"disk{k}", mass=1.0, inertia=0.5 * RADIUS**2,
            position=(WIDTH * (k % 3 + 0.5) / 3 + rng.uniform(-0.005, 0.005), 0.08 + 0.12 * (k // 3)),
        )
        for k in range(count)
    ]  # fmt: skip
    disks = [Disk2D(marker=Marker2D(body=body.name), radius=RADIUS) for body in bodies]
    walls = [
        HalfPlane2D(),
        HalfPlane2D(marker=Marker2D(point=(0.0, 0.0), angle=-np.pi / 2)),
        HalfPlane2D(marker=Marker2D(point=(WIDTH, 0.0), angle=np.pi / 2)),
    ]
    contacts = [
        DiskOnHalfPlane2D(name=f"wall{i}_{k}", plane=wall, disk=disk, law=law, friction=rough)
        for i, wall in enumerate(walls)
        for k, disk in enumerate(disks)
    ]
    contacts += [
        DiskOnDisk2D(name=f"pair{i}_{j}", a=disks[i], b=disks[j], law=law, friction=rough)
        for i in range(count)
        for j in range(i)
    ]
    return Model(gravity=(0.0, -G), bodies=bodies, contacts=contacts)


def check_rest(sim, count, end, ledger):
    """It comes to rest, without overlap, and the energy is accounted for."""
    least = 0.0
    for t in np.linspace(0.0, end, 31)[1:]:
        sim.advance(float(t))
        sim.sample()
        least = min(least, *(sim.gap(k) for k in range(len(sim.assembly.contacts))))
    values = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    dropped = values["energy.dissipation"] + values["energy.impact_loss"]
    assert least > -1e-9
    assert np.max(np.abs(sim.workspace.arrays["v"][: 3 * count])) < 1e-3
    assert abs(values["energy.balance"]) < ledger * dropped
    assert values["energy.kinetic"] < 1e-6 * dropped
    assert sum(event.kind == "impact" for event in sim.events) > count


@pytest.mark.parametrize("count", [12, 30, 47])
@pytest.mark.parametrize("seed", [0, 1])
def test_size_of_a_row_is_what_its_entries_make_of_the_coordinates(count, seed):
    """Also of the gap between two disks one above the other, which no motion of both in the same way changes."""
    sim = Simulation(heap(count, 0.3, 0.4, seed), "ebdf")
    arrays = sim.workspace.arrays
    scale, place = arrays["scale"], sim.assembly.q0[: 3 * count].reshape(-1, 3)
    for contact in sim.assembly.contacts[3 * count :]:
        i, j = (int(k) for k in contact.name[4:].split("_"))
        across = place[i, :2] - place[j, :2]
        n = np.abs(across) / np.linalg.norm(across)
        gap = 2.0 * n @ scale[:2]  # both disks, both ways
        turns = 2.0 * RADIUS * scale[2]
        assert 0.3 * gap < arrays["row_scale"][contact.row] < 1.01 * gap
        assert 0.3 * turns < arrays["row_scale"][contact.slide_row] < 1.01 * (turns + 2.0 * np.sum(scale[:2]))


# what the error control leaves in the energy: at its tolerance of 1e-6 a method of second order more than one of fifth
@pytest.mark.sampled(2)
@pytest.mark.parametrize("method, ledger", [("ebdf", 1e-8), ("hht", 1e-6)])
@pytest.mark.parametrize("restitution, friction, seed", [(0.3, 0.4, 0), (0.0, 0.2, 1)])
def test_a_small_heap_comes_to_rest(method, ledger, restitution, friction, seed):
    count = 5
    check_rest(Simulation(heap(count, restitution, friction, seed), method), count, 1.5, ledger)


@pytest.mark.full
@pytest.mark.parametrize("rest_ratio", [1e-6, 1e-3])
def test_ten_disks_that_stick_and_slip_in_ever_shorter_turns(rest_ratio):
    count = 10
    check_rest(Simulation(heap(count, 0.3, 0.4, 0, rest_ratio), "ebdf"), count, 1.5, 1e-7)


def test_disks_that_wedge_each_other():
    """At one instant no forces exist with the directions in which the contacts slide: impulses without a collision stop
    them, and the energy that this takes is accounted for."""
    sim = Simulation(heap(8, 0.3, 0.8, 67, 1e-3), "ebdf")
    sim.advance(0.4)
    struck: dict[float, list] = {}
    for event in sim.events:
        if event.kind == "impact":
            struck.setdefault(event.t, []).append(event)
    wedged = [events for events in struck.values() if max(event.approach_speed for event in events) == 0.0]
    assert wedged and all(sum(event.energy_loss for event in events) > 0.0 for events in wedged)
    values = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    assert abs(values["energy.balance"]) < 1e-7 * values["energy.impact_loss"]
    assert min(sim.gap(k) for k in range(len(sim.assembly.contacts))) > -1e-9


@pytest.mark.full
@pytest.mark.parametrize("seed, rest_ratio", [(0, 1e-2), (3, 1e-3), (4, 1e-3)])
def test_thirty_disks_that_hold_each_other_at_their_limits(seed, rest_ratio):
    """Contacts without force beside each other, that stick at their limits, whose sliding is none, that would jam alone
    and do not together; rounds of impacts that feed each other."""
    count = 30
    check_rest(Simulation(heap(count, 0.3, 0.4, seed, rest_ratio), "ebdf"), count, 2.0, 1e-7)


@pytest.mark.full
def test_thirty_disks_some_of_which_balance_their_friction_under_any_load():
    """Constant shares of the normal forces would leave the forces open there (the matrix is singular to rounding), and
    turn the sign of the determinant that tells a jam."""
    sim = Simulation(heap(30, 0.3, 0.4, 8, 1e-3), "ebdf")
    sim.advance(0.3)
    while sim.clock.push_step > 0.0:
        # between two steps of impulses velocities are interpolated, and energies with them
        sim.advance(sim.t + 1e-3)
    values = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    assert abs(values["energy.balance"]) < 1e-7 * (values["energy.dissipation"] + values["energy.impact_loss"])
    assert min(sim.gap(k) for k in range(len(sim.assembly.contacts))) > -1e-9
