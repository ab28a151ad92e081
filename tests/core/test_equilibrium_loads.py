"""Static equilibrium on more contacts than independent rows hold: loads of least sum of c F^2 that press."""

import itertools

import numpy as np
import pytest
from blocks_on_feet import AREA, DULL, HEIGHT, MASS, ON_AREA, ON_LINE, G, area, least, line
from scipy.optimize import minimize
from tlismni.core import (
    AppliedForce2D,
    Axes,
    Bushing2D,
    Bushing3D,
    Constant,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    RigidBody2D,
    RigidBody3D,
    Sphere3D,
    SphereOnHalfSpace3D,
    simulate,
)
from tlismni.core.analysis import eigenmodes, static_equilibrium
from tlismni.core.analysis.least_contact_forces import independent_contacts, least_contact_forces


def forces(rest, count):
    return np.array([rest[f"f{i}.normal_force"] for i in range(count)])


@pytest.mark.parametrize("above", [0.0, 0.05])
@pytest.mark.parametrize("compliance", [(1.0, 1.0, 1.0), (1.0, 2.0, 5.0)])
def test_feet_in_a_line_share_the_weight_in_any_order(compliance, above):
    wanted = least(ON_LINE, np.array([MASS * G, 0.0]), compliance)
    for order in itertools.permutations(range(3)):
        rest = static_equilibrium(line(compliance, order, above=above))
        assert forces(rest, 3) == pytest.approx(wanted, rel=1e-9)
        assert set(rest.closed) == {"f0", "f1", "f2"}


@pytest.mark.parametrize("mu", [0.0, 0.4])
@pytest.mark.parametrize("compliance", [(1.0, 1.0, 1.0, 1.0), (1.0, 2.0, 3.0, 0.5)])
def test_feet_in_an_area_share_the_weight_in_any_order(compliance, mu):
    """Friction holds nothing at rest, in space too, where a contact sticks by rows of velocities."""
    wanted = least(ON_AREA, np.array([MASS * G, 0.0, 0.0]), compliance)
    for order in itertools.islice(itertools.permutations(range(4)), 0, 24, 5):
        assert forces(static_equilibrium(area(compliance, order, mu=mu)), 4) == pytest.approx(wanted, rel=1e-9)


def test_a_ball_with_friction_rests_where_one_without_does():
    """On an incline, held by a spring along it: friction has no part in the place of rest."""
    rests = []
    for friction in (None, CoulombFriction(coefficient=0.3)):
        ball = RigidBody3D(name="ball", mass=1.0, inertia=(0.1, 0.1, 0.1), position=(0.0, 0.0, 0.5))
        floor = SphereOnHalfSpace3D(
            name="floor", sphere=Sphere3D(marker=Marker3D(body="ball"), radius=0.5),
            plane=HalfSpace3D(marker=Marker3D(body="ground")), law=NewtonImpact(restitution=0.0), friction=friction,
        )  # fmt: skip
        spring = Bushing3D(
            name="spring", a=Marker3D(body="ground", point=(0.0, 0.0, 0.5)),
            b=Marker3D(body="ball"), stiffness=(200.0, 200.0, 0.0, 3.0, 3.0, 3.0),
        )  # fmt: skip
        model = Model(bodies=[ball], forces=[spring], contacts=[floor], gravity=(1.0, 0.0, -G))
        rests.append(static_equilibrium(model))
    plain, rubbing = rests
    assert rubbing["ball.x"] == pytest.approx(1.0 / 200.0, rel=1e-9)
    assert rubbing.q == pytest.approx(plain.q, abs=1e-12)
    frequencies = [eigenmodes(rest).frequencies for rest in rests]
    assert frequencies[1] == pytest.approx(frequencies[0], rel=1e-9)


def test_a_belt_with_friction_is_refused():
    """It pulls what rests on it: there is no rest."""
    model = area((1.0, 1.0, 1.0, 1.0), mu=0.4)
    belt = model.contacts[0].model_copy(
        update={"surface_speed": 0.5, "surface_direction": (1.0, 0.0, 0.0), "surface_body": "ground"}
    )
    with pytest.raises(ModelError, match=belt.name):
        static_equilibrium(model.model_copy(update={"contacts": (belt, *model.contacts[1:])}))


@pytest.mark.parametrize("unit", [1e-6, 1e3])
def test_units_do_not_matter(unit):
    wanted = unit * least(ON_LINE, np.array([MASS * G, 0.0]), (1.0, 2.0, 5.0))
    rest = static_equilibrium(line((1.0, 2.0, 5.0), unit=unit))
    assert forces(rest, 3) == pytest.approx(wanted, rel=1e-8)


def test_a_run_from_rest_carries_the_same_loads():
    """The instant of a run decides with another solver."""
    rest = static_equilibrium(line((1.0, 2.0, 5.0)))
    run = simulate(rest.model, t_end=0.01)
    assert [run[f"f{i}.normal_force"][-1] for i in range(3)] == pytest.approx(forces(rest, 3), rel=1e-8)


def test_a_foot_that_would_pull_carries_nothing():
    """Five feet, the load near one end: of the least forces without signs some are negative."""
    places, compliance = (-0.3, -0.1, 0.0, 0.2, 0.4), (1.0, 1.0, 0.2, 2.0, 1.0)
    push = AppliedForce2D(name="push", marker=Marker2D(body="b", point=(0.35, 0.0)), force_y=Constant(value=-400.0))
    matrix, wanted = np.array([np.ones(5), places]), np.array([MASS * G + 400.0, 400.0 * 0.35])
    assert np.min(least(matrix, wanted, compliance)) < -1.0
    found = minimize(
        lambda f: np.dot(compliance, f**2) / 1e5, np.full(5, 80.0), bounds=[(0.0, None)] * 5, tol=1e-14,
        constraints={"type": "eq", "fun": lambda f: matrix @ f - wanted}, options={"maxiter": 1000},
    ).x  # fmt: skip
    for order in [range(5), (4, 2, 0, 3, 1), (1, 0, 3, 2, 4)]:
        rest = static_equilibrium(line(compliance, order, places=places, forces=[push]))
        assert forces(rest, 5) == pytest.approx(found, abs=1e-3)
        assert matrix @ forces(rest, 5) == pytest.approx(wanted, rel=1e-10)
        loaded = forces(rest, 5) > 1e-6
        # of those that press, the least
        assert forces(rest, 5)[loaded] == pytest.approx(
            least(matrix[:, loaded], wanted, np.array(compliance)[loaded]), rel=1e-8
        )


def test_vibrations_do_not_depend_on_the_number_of_feet():
    """A block on feet on a carriage with springs: the feet are one rigid connection, two of them or five."""

    def carriage(places):
        bodies = [
            RigidBody2D(name="c", mass=5.0, inertia=0.4, position=(0.0, 0.0)),
            RigidBody2D(name="b", mass=MASS, inertia=0.1, position=(0.0, HEIGHT)),
        ]
        springs = [
            Bushing2D(
                name=f"s{i}", a=Marker2D(point=(x, 0.0)), b=Marker2D(body="c", point=(x, 0.0)), stiffness=1e4 * (1 + i),
                rotational_stiffness=10.0,
            )
            for i, x in enumerate((-0.5, 0.4))
        ]  # fmt: skip
        springs.append(
            Bushing2D(name="s2", a=Marker2D(body="c"), b=Marker2D(body="b", point=(0.0, -HEIGHT)), stiffness=1e3)
        )
        feet = [
            DiskOnHalfPlane2D(
                name=f"f{i}", plane=HalfPlane2D(marker=Marker2D(body="c")),
                disk=Disk2D(marker=Marker2D(body="b", point=(x, -HEIGHT))), law=DULL,
            )
            for i, x in enumerate(places)
        ]  # fmt: skip
        return Model(gravity=(0.0, -G), bodies=bodies, forces=springs, contacts=feet)

    two, five = (eigenmodes(carriage(places)) for places in [(-0.3, 0.4), (-0.3, -0.1, 0.0, 0.2, 0.4)])
    assert five.frequencies == pytest.approx(two.frequencies, rel=1e-8, abs=1e-6)


def test_a_box_between_two_fixed_floors_of_contacts_keeps_its_weight_below():
    """Contacts above touch without a load: they carry nothing, since each pair of opposite forces adds to the sum."""
    body = RigidBody3D(name="b", mass=MASS, inertia=(0.1, 0.1, 0.1), position=(0.0, 0.0, 0.0))
    contacts = [
        SphereOnHalfSpace3D(
            name=f"{side}{i}", law=DULL,
            sphere=Sphere3D(marker=Marker3D(body="b", point=(*AREA[i], sign * 0.1)), radius=0.05),
            plane=HalfSpace3D(marker=Marker3D(point=(0.0, 0.0, sign * 0.15), attitude=Axes(z=(0.0, 0.0, -sign)))),
        )
        for side, sign in (("f", -1.0), ("above", 1.0))
        for i in range(4)
    ]  # fmt: skip
    rest = static_equilibrium(Model(gravity=(0.0, 0.0, -G), bodies=[body], contacts=contacts))
    assert forces(rest, 4) == pytest.approx(least(ON_AREA, np.array([MASS * G, 0.0, 0.0]), np.ones(4)), rel=1e-9)
    assert [rest[f"above{i}.normal_force"] for i in range(4)] == pytest.approx([0.0] * 4, abs=1e-9)


def test_forces_of_least_size_at_random():
    """The conditions of Karush, Kuhn and Tucker: F presses, balances, and c F = A^T y + z, z >= 0, z F = 0."""
    random = np.random.default_rng(3)
    for _ in range(100):
        n, m, k = 7, 2, 9
        joints, contacts = random.normal(size=(m, n)), random.normal(size=(k, n))
        compliance = 10.0 ** random.uniform(-1.0, 1.0, k)
        true = np.maximum(random.normal(size=k), 0.0)
        load = -contacts.T @ true - joints.T @ random.normal(size=m)
        found = least_contact_forces(joints, contacts, load, compliance)
        assert np.all(found >= 0.0)
        balance = np.vstack([joints, contacts]).T
        rest = contacts.T @ found + load
        assert np.linalg.lstsq(joints.T, rest, rcond=None)[0] @ joints == pytest.approx(rest, abs=1e-8)
        loaded = found > 1e-9 * np.max(found)
        equal = np.vstack([balance[:, :m].T, contacts[loaded]])
        y = np.linalg.lstsq(equal, np.concatenate([np.zeros(m), (compliance * found)[loaded]]), rcond=None)[0]
        assert equal @ y == pytest.approx(np.concatenate([np.zeros(m), (compliance * found)[loaded]]), abs=1e-7)


def test_loads_that_cannot_be_balanced_are_told():
    assert np.all(
        np.isnan(least_contact_forces(np.zeros((0, 1)), np.array([[1.0], [1.0]]), np.array([1.0]), np.ones(2)))
    )


def test_contacts_that_joints_hold_are_not_independent():
    joints, contacts = np.array([[1.0, 0.0, 0.0]]), np.array([[2.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, -2.0, 0.0]])
    assert independent_contacts(joints, contacts) in ([1], [2])
