"""Constraints that repeat others: found, left out of the equations, checked all the same."""

import logging
import math

import numpy as np
import pytest
from helpers import GROUND, G, floor_contact, on, pendulum_angles, residuals, rod_pendulum
from linkages import four_bar, slider_crank, stiffness, three_cranks
from tlismni.core import (
    ConsistencyError,
    CoordinateDriver,
    Disk2D,
    DiskOnHalfPlane2D,
    Distance2D,
    EquationSystem,
    HalfPlane2D,
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Polynomial,
    Prismatic2D,
    Revolute2D,
    RigidBody2D,
    Simulation,
    SimulationError,
    State,
    simulate,
)

TIGHT = {"rtol": 1e-9, "atol": 1e-11}


def test_the_same_joint_twice_moves_as_once_and_is_told():
    again = Revolute2D(name="again", a=GROUND, b=on("rod", -0.5))
    twice = simulate(rod_pendulum(0.3, joints=[again]), 2.0, **TIGHT)
    once = simulate(rod_pendulum(0.3), 2.0, **TIGHT)
    assert twice["rod.angle"][-1] == pytest.approx(once["rod.angle"][-1], abs=1e-7)
    assert [(r.constraint, r.row, r.repeats) for r in twice.redundant] == [
        ("again", 0, ("pin",)),
        ("again", 1, ("pin",)),
    ]
    # each carries half
    for force in ("force_x", "force_y"):
        assert twice[f"again.{force}"] == pytest.approx(twice[f"pin.{force}"], abs=1e-12)
    weight = 2.0 * twice["pin.force_y"] - twice["rod.ay"]
    assert weight == pytest.approx(G, abs=1e-8)
    assert once.redundant == ()


def test_one_warning_says_what_is_left_out_and_how_loads_are_shared(caplog):
    again = Revolute2D(name="again", a=GROUND, b=on("rod", -0.5))
    with caplog.at_level(logging.WARNING):
        simulate(rod_pendulum(joints=[again]), 0.1)
    (record,) = [r for r in caplog.records if r.levelno == logging.WARNING]
    text = record.getMessage()
    assert "row 0 of 'again' repeats what pin say" in text and "equally compliant" in text


def test_refusal_on_demand_and_unknown_choice():
    with pytest.raises(ConsistencyError, match="'b2' is redundant: it repeats what"):
        simulate(three_cranks(), 1.0, redundant="refuse")
    with pytest.raises(ModelError, match="redundant = 'ignore' is unknown"):
        simulate(three_cranks(), 1.0, redundant="ignore")


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf", "hht"])
def test_double_guide(method):
    """A slider on two parallel guides: the second repeats the first in both its rows."""
    model = slider_crank(gravity=G)
    second = Prismatic2D(name="second", a=Marker2D(), b=on("slider", 0.2), relative_angle=0.0)
    double = model.model_copy(update={"joints": (*model.joints, second)})
    tolerances = {"rtol": 1e-8, "atol": 1e-10}
    one, two = (simulate(m, 2.0, method, t_eval=[1.0, 2.0], **tolerances) for m in (model, double))
    exact = simulate(model, 2.0, "irk", t_eval=[1.0, 2.0], rtol=1e-12, atol=1e-13)
    assert {r.constraint for r in two.redundant} == {"second"} and len(two.redundant) == 2
    # the same steps: what the outer loop leaves is a thousandth of the error, or less
    assert two.stats["steps"] == one.stats["steps"]
    assert np.abs(two.q - one.q).max() <= max(1e-3 * np.abs(one.q - exact.q).max(), 1e-9)
    assert max(residuals(two)) < 1e-8


@pytest.mark.sampled(1)
@pytest.mark.parametrize("third", [(2.0, 0.0), (0.5, 0.7)])
@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_three_parallel_cranks_through_full_turns(third, method):
    """Against theta'' = -k cos(theta). With the pivots in a line, positions with all cranks in it are singular; with a
    third pivot beside it they are not, but there only some choices of the rows left out are good."""
    result = simulate(three_cranks(1.0, -6.0, third), 4.0, method, rtol=1e-9, atol=1e-11)
    expected = pendulum_angles([4.0], 1.0, -6.0, stiffness(3, 1))[0]
    assert result["v0.angle"][-1] < -4.0 * math.pi
    assert result["v0.angle"][-1] == pytest.approx(expected[0], abs=2e-6)
    for name in ("v1", "v2"):
        assert result[f"{name}.angle"] == pytest.approx(result["v0.angle"], abs=1e-9)
    assert np.abs(result["c.angle"]).max() < 1e-9
    assert np.abs(result["energy.balance"]).max() < 2e-5
    assert residuals(result)[0] < 1e-9


def test_rows_left_out_are_chosen_anew_where_those_kept_would_be_singular():
    result = simulate(three_cranks(0.3, -4.0, (0.5, 0.7)), 2.0, rtol=1e-8, atol=1e-10)
    assert len(result.redundant) > 1
    # no multiplier grows as the kept rows come to their own singular position
    assert np.abs(result.multipliers).max() < 1e3


def test_residuals_are_those_of_all_rows():
    """A second joint a little off (within what counts as consistent) shows in the recorded residual."""
    off = 3e-9
    again = Revolute2D(name="again", a=Marker2D(point=(off, 0.0)), b=on("rod", -0.5))
    result = simulate(rod_pendulum(0.3, joints=[again]), 0.5)
    assert result["residual.position"] == pytest.approx(off, rel=1e-2)


def test_start_that_is_a_little_off_is_moved_onto_the_redundant_constraints():
    model = three_cranks()
    moved = model.bodies[0].model_copy(
        update={"position": (model.bodies[0].position[0] + 1e-5, model.bodies[0].position[1])}
    )
    result = simulate(model.model_copy(update={"bodies": (moved, *model.bodies[1:])}), 0.2)
    assert len(result.redundant) == 1
    assert residuals(result)[0] < 1e-11


def test_contradictory_constraints_stay_refused():
    longer = Distance2D(name="longer", a=GROUND, b=on("rod", 0.3), length=0.9)
    parallel = Distance2D(name="parallel", a=GROUND, b=on("rod", 0.3), length=0.8)
    assert len(simulate(rod_pendulum(joints=[parallel]), 0.1).redundant) == 1
    with pytest.raises(ConsistencyError, match="'longer' contradicts pin"):
        simulate(rod_pendulum(joints=[longer]), 0.1)


def test_drivers_that_agree_now_but_not_in_rate_are_refused():
    drivers = [
        CoordinateDriver(name="one", body="p", coordinate="x", motion=Polynomial(coefficients=(0.0, 1.0))),
        CoordinateDriver(name="two", body="p", coordinate="x", motion=Polynomial(coefficients=(0.0, 2.0))),
    ]
    body = PointMass2D(name="p", mass=1.0, velocity=(1.0, 0.0))
    with pytest.raises(ConsistencyError, match="'two' contradicts one at velocity level"):
        simulate(Model(bodies=[body], joints=drivers), 1.0)


def test_row_that_turns_out_violated_stops_the_run_and_is_named():
    """Two drivers that agree up to their second derivatives and then part."""
    body = PointMass2D(name="p", mass=1.0, velocity=(1.0, 0.0))
    drivers = [
        CoordinateDriver(name="one", body="p", coordinate="x", motion=Polynomial(coefficients=(0.0, 1.0))),
        CoordinateDriver(name="two", body="p", coordinate="x", motion=Polynomial(coefficients=(0.0, 1.0, 0.0, 1e-3))),
    ]
    with pytest.raises(
        SimulationError, match=r"constraint 'two' \(row 0\) repeated others at the start.*violates"
    ) as caught:
        simulate(Model(bodies=[body], joints=drivers), 1.0)
    assert 0.0 <= caught.value.t < 0.1
    assert caught.value.partial is not None and len(caught.value.partial.redundant) == 1


def test_own_equations():
    def system(rows):
        def constraint(t, q):
            phi = q[0] ** 2 + q[1] ** 2 - 1.0
            return np.array([phi, 3.0 * phi, phi + phi**2][:rows])

        return EquationSystem(
            mass=np.eye(2), force=np.array([0.0, -G]), constraint=constraint, q0=[1.0, 0.0], v0=[0.0, 0.5]
        )

    one, three = (simulate(system(rows), 2.0, t_eval=[2.0], **TIGHT) for rows in (1, 3))
    assert three.q == pytest.approx(one.q, abs=1e-9)
    assert [(r.constraint, r.repeats) for r in three.redundant] == [
        ("constraint[1]", ("constraint[0]",)),
        ("constraint[2]", ("constraint[0]",)),
    ]
    # sizes s of the rows, whose gradients are those of phi times g: least (s lambda)^2 with a given sum of g lambda
    gradients, sizes = np.array([1.0, 3.0, 1.0]), Simulation(system(3)).assembly.row_scale
    weights = gradients / sizes**2
    shares = one.multipliers[-1, 0] * weights / (gradients @ weights)
    assert three.multipliers[-1] == pytest.approx(shares, rel=1e-7)


def with_floor(model, body, height):
    disk = Disk2D(marker=on(body), radius=0.1)
    floor = HalfPlane2D(marker=Marker2D(point=(0.0, height)))
    contact = DiskOnHalfPlane2D(name="floor", plane=floor, disk=disk, law=NewtonImpact(restitution=0.4))
    return model.model_copy(update={"contacts": (contact,)})


@pytest.mark.parametrize("third", [(2.0, 0.0), (0.5, 0.7)])
def test_contacts_close_and_open_while_rows_are_left_out(third):
    model = with_floor(three_cranks(2.0, 0.0, third), "c", 0.4)
    result = simulate(model, 4.0, rtol=1e-8, atol=1e-10)
    kinds = {event.kind for event in result.events}
    assert "impact" in kinds and "rest" in kinds
    assert residuals(result)[0] < 1e-9
    assert result["floor.gap"].min() > -1e-9
    assert np.abs(result["energy.balance"]).max() < 1e-5


@pytest.mark.parametrize("stored_at", [0.4, 1.1])
def test_state_goes_on_bit_for_bit_in_a_fresh_simulation(stored_at):
    """The choice of rows left out has changed on the way: it is part of the state."""

    def build():
        return Simulation(three_cranks(0.3, -4.0, (0.5, 0.7)), rtol=1e-8, atol=1e-10)

    sim = build()
    start = sim.workspace.dropped
    sim.advance(stored_at)
    data = sim.state().to_bytes()
    assert stored_at < 1.0 or sim.workspace.dropped != start
    sim.advance(2.0)
    other = build()
    other.restore(State.from_bytes(data))
    assert other.state().to_bytes() == data
    other.advance(2.0)
    assert other.sample().tobytes() == sim.sample().tobytes()


def test_units_do_not_decide_what_is_redundant():
    for length in (1e-2, 1.0, 1e3):
        model = four_bar(2, 1.2, 0.0, length)
        bar = Distance2D(name="bar", a=Marker2D(point=(0.5 * length, 0.0)), b=on("h0"), length=length)
        result = simulate(model.model_copy(update={"joints": (*model.joints, bar)}), 0.05, start_tolerance=1e-6)
        assert len(result.redundant) == 1


def test_statically_indeterminate_structure_at_rest():
    """A beam on three supports, no freedom left at all."""
    beam = RigidBody2D(name="beam", mass=2.0, inertia=0.1)
    joints = [Revolute2D(name="left", a=Marker2D(point=(-1.0, 0.0)), b=on("beam", -1.0))]
    joints += [
        Distance2D(name=name, a=Marker2D(point=(x, -1.0)), b=on("beam", x), length=1.0)
        for name, x in (("middle", 0.5), ("right", 1.0))
    ]
    result = simulate(Model(bodies=[beam], joints=joints), 0.5)
    assert len(result.redundant) == 1
    assert np.abs(result.q).max() < 1e-12
    total = result["left.force_y"][-1] - result["middle.tension"][-1] - result["right.tension"][-1]
    assert total == pytest.approx(2.0 * G, rel=1e-9)


def test_contact_that_closes_on_what_joints_hold_already_is_refused_clearly():
    """Its row repeats a driver's: that is left to the error that names it."""
    ball = PointMass2D(name="ball", mass=1.0, position=(0.0, 1.0), velocity=(0.0, -1.0))
    driver = CoordinateDriver(name="lower", body="ball", coordinate="y", motion=Polynomial(coefficients=(1.0, -1.0)))
    model = Model(bodies=[ball], joints=[driver], contacts=[floor_contact(NewtonImpact(restitution=0.0))])
    with pytest.raises(SimulationError, match=r"floor"):
        simulate(model, 2.0)
