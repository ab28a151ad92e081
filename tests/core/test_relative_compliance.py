"""Relative compliances of rigid contacts and of joints: how those that repeat each other share their loads.

Of all forces that give the motion they have the least sum of c F^2. The references are weighted least-squares solutions
of the equilibrium of rigid bodies, linear force laws with the stiffness k/c, and a dense solver in 80-bit numbers.
"""

import itertools
import logging
from dataclasses import replace

import numpy as np
import pytest
from blocks_on_feet import DULL, HEIGHT, MASS, ON_AREA, ON_LINE, PLACES, G, area, least, line
from indeterminate_scenes import scene
from scene_checks import deviations, wrong
from tlismni.core import (
    AppliedForce2D,
    ContactGroup2D,
    ContactGroup3D,
    Disk2D,
    DiskOnHalfPlane2D,
    Distance2D,
    HalfPlane2D,
    HalfSpace3D,
    KelvinVoigt,
    Marker2D,
    Marker3D,
    Model,
    ModelError,
    NewtonImpact,
    Parameter,
    PoissonImpact,
    Polynomial,
    Revolute2D,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    Simulation,
    Sphere3D,
    compile_model,
    contacts_between,
    simulate,
)
from units import Units

METHODS = ["ebdf", "irk", "hht"]
SHARES = {"alike": (2.0, 2.0, 2.0, 2.0), "near": (1.0, 2.0, 3.0, 0.5), "far": (1.0, 100.0, 0.02, 3.0)}


@pytest.fixture(autouse=True)
def _quiet():
    """Models with redundant joints are told to be so."""
    logging.getLogger("tlismni").setLevel(logging.ERROR)
    yield
    logging.getLogger("tlismni").setLevel(logging.NOTSET)


def read(result, what="normal_force", count=3, row=-1):
    return np.array([result[f"f{i}.{what}"][row] for i in range(count)])


# ---- normal forces --------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("share", SHARES)
def test_feet_in_a_line_have_the_least_weighted_forces_in_any_order(share, method):
    compliance = SHARES[share][:3]
    wanted = least(ON_LINE, [MASS * G, 0.0], compliance)
    assert min(wanted) > 0.0
    for order in itertools.permutations(range(3)):
        result = simulate(line(compliance, order), 0.1, method)
        # at the start by the problem of friction cones, then by rows of compatibility
        for row in (0, -1):
            np.testing.assert_allclose(read(result, row=row), wanted, rtol=1e-8)
        assert result.stats["unshared_loads"] == 0


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("share", SHARES)
def test_feet_of_an_area_have_the_least_weighted_forces_in_any_order(share, method):
    wanted = least(ON_AREA, [MASS * G, 0.0, 0.0], SHARES[share])
    assert min(wanted) > 0.0
    for order in list(itertools.permutations(range(4)))[::7]:
        result = simulate(area(SHARES[share], order), 0.1, method)
        for row in (0, -1):
            np.testing.assert_allclose(read(result, count=4, row=row), wanted, rtol=1e-8)
        assert result.stats["unshared_loads"] == 0


def test_rigid_feet_are_the_limit_of_springs_of_their_compliance():
    """Of linear force laws with k/c, as k grows."""
    compliance = SHARES["near"][:3]
    rigid = read(simulate(line(compliance, mu=0.0), 0.1))
    apart = []
    for stiffness in (1e5, 1e6):
        body = line(compliance).bodies[0].model_copy(update={"position": (0.0, HEIGHT)})
        feet = [
            DiskOnHalfPlane2D(
                name=f"f{i}", plane=HalfPlane2D(), disk=Disk2D(marker=Marker2D(body="b", point=(x, -HEIGHT))),
                law=KelvinVoigt(stiffness=stiffness / c, damping=30.0 * (stiffness / 1e5) ** 0.5 / c),
            )
            for i, (x, c) in enumerate(zip(PLACES, compliance, strict=True))
        ]  # fmt: skip
        result = simulate(Model(gravity=(0.0, -G), bodies=[body], contacts=feet), 4.0, "irk", rtol=1e-10, atol=1e-12)
        apart.append(np.max(np.abs(read(result) - rigid)) / (MASS * G))
    assert apart[0] < 1e-4 and apart[1] < 0.2 * apart[0]


@pytest.mark.parametrize("factor", [1e-4, 7.0, 1e5])
def test_what_all_compliances_have_in_common_counts_for_nothing(factor):
    for make, count in ((line, 3), (area, 4)):
        usual, other = (
            simulate(make([c * times for c in SHARES["near"]][:count]), 0.1) for times in (1.0, factor)
        )  # fmt: skip
        np.testing.assert_allclose(read(other, count=count), read(usual, count=count), rtol=1e-9)
        np.testing.assert_allclose(other.q[-1], usual.q[-1], atol=1e-12)


@pytest.mark.parametrize("units", [Units(length=1e3), Units(length=1e-3, mass=1e3), Units(time=1e3)])
def test_units_do_not_decide_who_carries(units):
    for model, count in ((line(SHARES["far"]), 3), (area(SHARES["far"]), 4)):
        usual = read(simulate(model, 0.05), count=count)
        other = read(simulate(units.model(model), 0.05 * units.time), count=count)
        np.testing.assert_allclose(other / units.factor((1, 1, -2)), usual, rtol=1e-8)


@pytest.mark.parametrize(("ratio", "parts"), [(1e6, (4 / 7, 0.0, 3 / 7)), (1e-6, (0.25, 0.75, 0.0))])
def test_a_foot_may_be_next_to_nothing_or_next_to_rigid(ratio, parts):
    """In the middle, giving way a million times as far as the others it carries nothing, giving way a millionth as far
    all that it can: the block would tilt about it."""
    for order in itertools.permutations(range(3)):
        result = simulate(line((1.0, ratio, 1.0), order), 0.05)
        for row in (0, -1):
            np.testing.assert_allclose(read(result, row=row), MASS * G * np.array(parts), atol=1e-6 * MASS * G)


# ---- friction -------------------------------------------------------------------------------------------------------


def test_static_friction_of_two_feet_is_in_the_inverse_measure_of_their_compliance():
    """c_0 T_0 = c_1 T_1 until the firmer foot reaches its limit; from there on the other takes what is left."""
    mu, grows, firm, soft = 0.4, 10.0, 1.0, 2.0
    push = AppliedForce2D(
        name="push", marker=Marker2D(body="b", point=(0.0, -HEIGHT)), force_x=Polynomial(coefficients=[0.0, grows])
    )
    whole = mu * MASS * G
    full, slips = 0.5 * whole * (1.0 + firm / soft), whole / grows
    times = np.linspace(0.0, 1.2 * slips, 61)[1:]
    for order in ((0, 1), (1, 0)):
        model = line((firm, soft), order, mu, places=(-0.3, 0.3), forces=[push])
        result = simulate(model, times[-1], t_eval=times, rtol=1e-9)
        force = grows * times
        own = np.where(force < full, force * soft / (firm + soft), 0.5 * whole)
        held = times < 0.999 * slips
        np.testing.assert_allclose(np.abs(result["f0.friction_force"])[held], own[held], atol=1e-6 * whole)
        np.testing.assert_allclose(np.abs(result["f1.friction_force"])[held], (force - own)[held], atol=1e-6 * whole)
        found = [event.t for event in result.events if event.kind == "slip"]
        np.testing.assert_allclose(found, slips, rtol=1e-6)
        # from there on m a = F - mu m g
        speed = grows * (times[-1] - slips) ** 2 / (2.0 * MASS)
        assert result["b.vx"][-1] == pytest.approx(speed, rel=1e-5)


@pytest.mark.parametrize("method", METHODS)
def test_friction_of_feet_that_slide_follows_their_loads(method):
    """The moment of friction is in the equilibrium; the null vector is that of the gaps."""
    mu, compliance, speed = np.array([0.1, 0.3, 0.2]), (1.0, 4.0, 0.5), 1.0
    null = np.linalg.svd(ON_LINE)[2][-1]
    # about the centre of mass: sum of N x less the moment of friction against the motion, at the arm HEIGHT
    matrix = np.array([np.ones(3), np.array(PLACES) - mu * HEIGHT, null * compliance])
    loads = np.linalg.solve(matrix, [MASS * G, 0.0, 0.0])
    assert min(loads) > 0.0
    braking, times = float(mu @ loads) / MASS, np.linspace(0.0, 0.3, 4)
    for order in itertools.permutations(range(3)):
        model = line(compliance, order, mu, velocity=(speed, 0.0))
        result = simulate(model, 0.3, method, t_eval=times, rtol=1e-8)
        np.testing.assert_allclose(read(result), loads, rtol=1e-7)
        np.testing.assert_allclose(result["b.x"], speed * times - 0.5 * braking * times**2, atol=1e-8)
    stops = simulate(line(compliance, mu=mu, velocity=(speed, 0.0)), 1.2 * speed / braking, method, rtol=1e-9)
    last = max(event.t for event in stops.events if event.kind == "stick")
    assert last == pytest.approx(speed / braking, rel=1e-6)


@pytest.mark.parametrize("seed", [3, 2010, 2013, 2022])
def test_random_planar_scene_has_the_forces_of_the_dense_reference(seed):
    _examine(seed, 2)


@pytest.mark.parametrize("seed", [3002, 3006, 3011])
def test_random_spatial_scene_has_the_forces_of_the_dense_reference(seed):
    _examine(seed, 3)


def _examine(seed, dimension):
    """Compliances drawn between 0.1 and 10; in another order of the lists and in other units too."""
    drawn, rng = scene(seed, dimension), np.random.default_rng(seed)
    contacts = [c.model_copy(update={"compliance": float(10.0 ** rng.uniform(-1, 1))}) for c in drawn.model.contacts]
    found, tight = deviations(replace(drawn, model=drawn.model.model_copy(update={"contacts": tuple(contacts)})), 1)
    assert not wrong(found, tight), f"{drawn.kind} by {drawn.method}: {found}; {tight}"


# ---- impulses -------------------------------------------------------------------------------------------------------


@pytest.mark.parametrize("law", [DULL, NewtonImpact(restitution=0.6), PoissonImpact(restitution=0.6)])
def test_impulses_of_redundant_feet_are_shared_like_forces(law):
    compliance, speed = SHARES["near"], 0.7
    size = MASS * speed * (1.0 + law.restitution)
    for order in itertools.permutations(range(3)):
        result = simulate(line(compliance, order, 0.0, law=law, velocity=(0.0, -speed)), 1e-4)
        found = [sum(e.impulse for e in result.events if e.contact == f"f{i}") for i in range(3)]
        np.testing.assert_allclose(found, least(ON_LINE, [size, 0.0], compliance[:3]), rtol=1e-6)
    result = simulate(area(compliance, law=law, velocity=(0.0, 0.0, -speed)), 1e-4)
    found = [sum(e.impulse for e in result.events if e.contact == f"f{i}") for i in range(4)]
    np.testing.assert_allclose(found, least(ON_AREA, [size, 0.0, 0.0], compliance), rtol=1e-6)


# ---- joints ---------------------------------------------------------------------------------------------------------

DOOR, WIDTH, HINGES = 20.0, 0.8, (-0.7, 0.7)


def door(compliance, order=(0, 1), metre=1.0):
    """A door on two hinges along z."""
    inertia = tuple(x * metre**2 for x in (1.8, 1.8, 1.3))
    body = RigidBody3D(name="door", mass=DOOR, inertia=inertia, position=(0.5 * WIDTH * metre, 0.0, 0.0))
    hinges = [
        Revolute3D(
            name=f"h{i}", compliance=compliance[i], a=Marker3D(point=(0.0, 0.0, HINGES[i] * metre)),
            b=Marker3D(body="door", point=(-0.5 * WIDTH * metre, 0.0, HINGES[i] * metre)),
        )
        for i in order
    ]  # fmt: skip
    return Model(gravity=(0.0, 0.0, -G * metre), bodies=[body], joints=hinges)


def hinge_loads(result):
    parts = ("force_x", "force_y", "force_z", "torque_x", "torque_y")
    return np.array([[result[f"h{i}.{part}"][-1] for part in parts] for i in range(2)])


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("factor", [1.0, 1e-4, 30.0])
def test_hinges_of_a_door_share_in_the_inverse_measure_of_their_compliance(factor, method):
    compliance = (factor, 3.0 * factor)
    length = Simulation(door(compliance)).assembly.length
    # (x, y, z, moments about x and y) from (F_x, F_y, F_z, M_x/L, M_y/L) of each hinge
    columns = [
        np.vstack([np.eye(3, 5), [[0.0, -z, 0.0, length, 0.0], [z, 0.0, 0.0, 0.0, length]]]) for z in HINGES
    ]  # fmt: skip
    weights = np.repeat(compliance, 5)
    wanted = least(np.hstack(columns), [0.0, 0.0, DOOR * G, 0.0, -0.5 * WIDTH * DOOR * G], weights).reshape(2, 5)
    wanted[:, 3:] *= length
    for order in ((0, 1), (1, 0)):
        found = hinge_loads(simulate(door(compliance, order), 0.05, method))
        np.testing.assert_allclose(found, wanted, atol=1e-8 * DOOR * G)
        np.testing.assert_allclose(found[:, 2], [0.75 * DOOR * G, 0.25 * DOOR * G], rtol=1e-9)


@pytest.mark.parametrize("metre", [1e-3, 1e3])
def test_units_do_not_decide_which_hinge_carries(metre):
    usual, other = (hinge_loads(simulate(door((1.0, 3.0), metre=x), 0.01)) for x in (1.0, metre))
    np.testing.assert_allclose(other / (metre * np.array([1.0] * 3 + [metre] * 2)), usual, atol=1e-9 * DOOR * G)


@pytest.mark.parametrize("method", METHODS)
def test_supports_of_a_beam_have_the_least_weighted_forces(method):
    beam = RigidBody2D(name="beam", mass=2.0, inertia=0.1)
    compliance = (1.0, 5.0, 0.2)
    joints = [
        Revolute2D(
            name="left", a=Marker2D(point=(-1.0, 0.0)), b=Marker2D(body="beam", point=(-1.0, 0.0)),
            compliance=compliance[0],
        ),
        *(
            Distance2D(
                name=name, a=Marker2D(point=(x, -1.0)), b=Marker2D(body="beam", point=(x, 0.0)), length=1.0,
                compliance=c,
            )
            for name, x, c in (("middle", 0.5, compliance[1]), ("right", 1.0, compliance[2]))
        ),
    ]  # fmt: skip
    wanted = least(np.array([np.ones(3), [-1.0, 0.5, 1.0]]), [2.0 * G, 0.0], compliance)
    for order in itertools.permutations(joints):
        result = simulate(Model(bodies=[beam], joints=order), 0.1, method)
        found = [result["left.force_y"][-1], -result["middle.tension"][-1], -result["right.tension"][-1]]
        np.testing.assert_allclose(np.abs(found), np.abs(wanted), rtol=1e-9)


# ---- states, parameters, records ------------------------------------------------------------------------------------


def test_states_go_on_with_the_same_bits():
    for model in (line((1.0, 4.0, 0.5), velocity=(1.0, 0.0)), area(SHARES["far"]), door((1.0, 3.0))):
        one, other = Simulation(model), Simulation(model)
        one.advance(0.05)
        other.restore(type(one.state()).from_bytes(one.state().to_bytes()))
        for t in (0.08, 0.5):
            one.advance(t)
            other.advance(t)
            assert one.state() == other.state()
            assert one.values().tobytes() == other.values().tobytes()


def with_parameter(model, *targets):
    return model.model_copy(
        update={"parameters": (Parameter(name="give", minimum=1e-3, maximum=1e3, targets=targets),)}
    )


@pytest.mark.parametrize(
    ("model", "place"),
    [(line((1.0, 1.0, 1.0), velocity=(1.0, 0.0)), "f1"), (area((1.0,) * 4), "f2"), (door((1.0, 1.0)), "h0")],
    ids=["line", "area", "door"],
)  # fmt: skip
def test_a_compliance_is_a_parameter_of_a_compiled_model(model, place):
    """With the bits of a run that is built for itself."""
    model = with_parameter(model, f"{place}.compliance")
    for value in (5.0, 0.2):
        runs = [compile_model(model).simulation({"give": value}), Simulation(model.with_parameters({"give": value}))]
        for run in runs:
            run.advance(0.05)
        assert runs[0].values().tobytes() == runs[1].values().tobytes()
        assert runs[0].state().to_bytes() == runs[1].state().to_bytes()
        usual = Simulation(model)
        usual.advance(0.05)
        assert usual.values().tobytes() != runs[0].values().tobytes()


def test_a_contact_of_a_group_has_the_compliance_of_the_group():
    """Two groups of feet under one block."""
    compliance = (2.0, 0.5)
    body = RigidBody2D(name="b", mass=MASS, inertia=0.1, position=(0.0, HEIGHT))
    feet = [[Disk2D(marker=Marker2D(body="b", point=(x, -HEIGHT))) for x in places] for places in ((-0.3, 0.3), (0.0,))]
    groups = [
        ContactGroup2D(name=f"g{k}", disks=disks, half_planes=[HalfPlane2D()], law=DULL, compliance=c)
        for k, (disks, c) in enumerate(zip(feet, compliance, strict=True))
    ]
    model = Model(gravity=(0.0, -G), bodies=[body], groups=groups)
    wanted = least(np.array([np.ones(3), [-0.3, 0.3, 0.0]]), [MASS * G, 0.0], (2.0, 2.0, 0.5))
    result = simulate(Model.from_json(model.to_json()), 0.05)
    np.testing.assert_allclose([result[f"{c.name}.normal_force"][-1] for c in model.contacts], wanted, rtol=1e-8)
    ball = [Sphere3D(marker=Marker3D(body="c"), radius=0.1), HalfSpace3D()]
    (made,) = contacts_between("g", ball, law=DULL, compliance=3.0)
    (grouped,) = ContactGroup3D(name="g", spheres=ball[:1], half_spaces=ball[1:], law=DULL, compliance=3.0).contacts()
    assert made == grouped and made.compliance == 3.0


@pytest.mark.parametrize("wrong", [0.0, -2.0, float("inf"), float("nan"), "2", True])
def test_what_is_no_compliance_is_refused(wrong):
    for make in (line((1.0,) * 3).contacts[0], area((1.0,) * 4).contacts[0], door((1.0, 1.0)).joints[0]):
        with pytest.raises(ModelError, match=f"{make.name}.*compliance.*{str(wrong)[:3]}"):
            type(make)(**{**{name: getattr(make, name) for name in type(make).model_fields}, "compliance": wrong})


def test_a_force_law_has_a_stiffness_and_no_compliance():
    law = KelvinVoigt(stiffness=1e4, damping=1.0)
    with pytest.raises(ModelError, match=r"'f0' has a compliance of 2, .* with KelvinVoigt its own stiffness does"):
        line((2.0, 1.0, 1.0), mu=0.0, law=law)
    assert line((1.0, 1.0, 1.0), mu=0.0, law=law).contacts[0].compliance == 1.0
