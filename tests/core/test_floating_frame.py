"""Bodies in a floating frame: exact tangents, rigid motion, momenta, energy, what is refused."""

import math

import numpy as np
import pytest
from helpers import GROUND, on
from random_seeds import at_seeds
from test_tangents import Point, check_levels, check_matrix, draw
from tlismni.core import (
    AppliedForce2D,
    Attachment,
    Constant,
    Disk2D,
    DiskOnHalfPlane2D,
    FloatingBeam2D,
    HalfPlane2D,
    Model,
    ModelError,
    NewtonImpact,
    PointMass2D,
    Prismatic2D,
    ReducedBody2D,
    ReducedPoint,
    Revolute2D,
    RigidBody2D,
    SpringDamper2D,
    simulate,
)

TIGHT = {"rtol": 1e-10, "atol": 1e-12}


def particles(seed=3, n=2, count=5, stiffening=True, **changes):
    """A reduced body of point masses at random places that move along random directions, with (masses, u0, S, g)."""
    random = np.random.default_rng(seed)
    masses, u0 = random.uniform(0.2, 1.0, count), random.uniform(-1.0, 1.0, (count, 2))
    s, g = random.uniform(-1.0, 1.0, (count, 2, n)), 0.3 * random.uniform(-1.0, 1.0, (count, 2, n, n))
    g = (g + np.swapaxes(g, 2, 3)) * (0.5 if stiffening else 0.0)
    root = random.uniform(-1.0, 1.0, (n, n))
    dm = masses[:, None]
    cross = np.einsum("i,ik,il->kl", masses, s[:, 0], s[:, 1])
    fields = {
        "mass": masses.sum(), "inertia": (dm * u0**2).sum(), "first_moment": tuple((dm * u0).sum(axis=0)),
        "modal_mass": np.einsum("i,icl,ick->lk", masses, s, s).tolist(),
        "stiffness": (root @ root.T + 3.0 * np.eye(n)).tolist(),
        "damping": (0.1 * root @ root.T).tolist(),
        "modal_first_moment": np.einsum("i,ick->ck", masses, s).tolist(),
        "modal_inertia": np.einsum("i,ic,ick->k", masses, u0, s).tolist(),
        "modal_coupling": (masses * u0[:, 0]) @ s[:, 1] - (masses * u0[:, 1]) @ s[:, 0],
        "gyroscopic": (cross - cross.T).tolist(),
        "geometric_first_moment": np.einsum("i,ickl->ckl", masses, g).tolist(),
        "geometric_inertia": np.einsum("i,ic,ickl->kl", masses, u0, g).tolist(),
        "geometric_coupling": (
            np.einsum("i,ikl->kl", masses * u0[:, 0], g[:, 1]) - np.einsum("i,ikl->kl", masses * u0[:, 1], g[:, 0])
        ).tolist(),
        **changes,
    }  # fmt: skip
    fields["modal_coupling"] = tuple(fields["modal_coupling"])
    return ReducedBody2D(name="s", **fields), (masses, u0, s, g)


def beam(name="s", **changes):
    fields = {
        "mass": 0.8, "length": 1.2, "bending_stiffness": 2.0, "axial_stiffness": 40.0, "rotary_inertia": 0.03,
        "modes": 2, "axial_modes": 1, "damping_ratio": 0.02, "geometric_stiffening": True,
    }  # fmt: skip
    return FloatingBeam2D(name=name, **{**fields, **changes})


CASES = {
    "reduced body": ([particles()[0]], {}),
    "reduced body of one mode": ([particles(n=1)[0]], {}),
    "beam with everything": ([beam(attachments=(Attachment(position=0.7),))], {}),
    "free beam beside a cantilever": ([beam("t", boundary_conditions="free"), beam(angle=0.4)], {}),
    "joint and spring on the frame": (
        [beam(), RigidBody2D(name="a", mass=1.0, inertia=0.3)],
        {
            "joints": [Revolute2D(name="j", a=on("a", 0.3, -0.2), b=on("s", 0.1, 0.2))],
            "forces": [SpringDamper2D(name="f", a=on("s", 0.2, 1.0), b=GROUND, stiffness=3.0, natural_length=0.5)],
        },
    ),
}  # fmt: skip


@pytest.mark.parametrize("case", CASES)
def test_tangent_is_the_derivative_of_the_residual(case):
    bodies, parts = CASES[case]
    bodies = [PointMass2D(name="before", mass=1.0), *bodies, RigidBody2D(name="after", mass=1.0, inertia=1.0)]
    point = Point(Model(gravity=(0.3, -9.0), bodies=bodies, **parts))

    @at_seeds
    def check(seed):
        check_matrix(point, draw(point, seed))
        check_levels(point, draw(point, seed))

    check()


# ---- the equations are those of the particles ------------------------------------------------------------------------


def particle_motion(body, parts, q, v):
    """Positions and velocities of the particles of a reduced body, each (count, 2)."""
    _, u0, s, g = parts
    p, dp, w = q[3:], v[3:], v[2]
    u = u0 + s @ p + 0.5 * np.einsum("ickl,k,l->ic", g, p, p)
    du = s @ dp + np.einsum("ickl,k,l->ic", g, p, dp)
    c, sn = math.cos(q[2]), math.sin(q[2])
    turn = np.array([[c, -sn], [sn, c]])
    whirl = np.column_stack([-u[:, 1], u[:, 0]]) * w
    return q[:2] + u @ turn.T, v[:2] + (whirl + du) @ turn.T


def test_energy_and_momentum_are_those_of_the_particles():
    """Without second-order displacements the invariants hold everything: energy to rounding, at a large deflection."""
    body, parts = particles(
        stiffening=False, position=(0.3, -0.4), velocity=(1.0, 0.5), angle=0.7, angular_velocity=3.0,
        amplitudes=(0.4, -0.3), amplitude_rates=(1.0, 2.0),
    )  # fmt: skip
    result = simulate(Model(bodies=[body]), 2.0, **TIGHT)
    masses = parts[0]
    for q, v, kinetic in zip(result.q[::10], result.v[::10], result["energy.kinetic"][::10], strict=True):
        _, dr = particle_motion(body, parts, q, v)
        assert kinetic == pytest.approx(0.5 * (masses[:, None] * dr**2).sum(), rel=1e-12)
    assert np.abs(result["energy.balance"]).max() < 1e-7
    assert np.ptp(result["energy.strain"]) > 0.1 and result["energy.dissipation"][-1] > 0.01


@pytest.mark.parametrize("stiffening", [False, True])
def test_momenta_are_kept_in_free_flight_with_vibration(stiffening):
    """Momentum dT/dR' and moment of momentum dT/dtheta' + R x P, with and without terms of second order."""
    body, parts = particles(
        stiffening=stiffening, velocity=(1.0, 0.5), angular_velocity=3.0, amplitudes=(0.3, -0.2),
        amplitude_rates=(1.0, 2.0), damping=None,
    )  # fmt: skip
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body]), 3.0, **TIGHT)
    momenta = []
    i = body.invariants()
    for q, v in zip(result.q, result.v, strict=True):
        p, dp, w = q[3:], v[3:], v[2]
        c, sn = math.cos(q[2]), math.sin(q[2])
        turn = np.array([[c, -sn], [sn, c]])
        h = i.first_moment + i.H @ p + 0.5 * np.einsum("ckl,k,l->c", i.G, p, p)
        dh = (i.H + i.G @ p) @ dp
        momentum = body.mass * v[:2] + turn @ (w * np.array([-h[1], h[0]]) + dh)
        spin = w * (i.inertia + 2.0 * i.a @ p + p @ i.N @ p) + (i.b + p @ i.Gamma) @ dp
        arm = turn @ h
        momenta.append([*momentum, spin + arm[0] * v[1] - arm[1] * v[0] + q[0] * momentum[1] - q[1] * momentum[0]])
    assert np.ptp(np.array(momenta), axis=0).max() < 1e-7
    assert np.ptp(result.v[:, 2]) > 0.5
    assert np.abs(result["energy.balance"]).max() < 1e-7
    if not stiffening:  # then these are the momenta of the particles too
        masses = parts[0][:, None]
        r, dr = particle_motion(body, parts, result.q[-1], result.v[-1])
        whole = [*(masses * dr).sum(axis=0), (masses[:, 0] * (r[:, 0] * dr[:, 1] - r[:, 1] * dr[:, 0])).sum()]
        assert momenta[-1] == pytest.approx(whole, abs=1e-10)


@pytest.mark.parametrize("boundary", ["cantilever", "simply_supported", "free"])
def test_a_beam_that_only_translates_falls_without_strain(boundary):
    start = {"position": (0.2, 0.1), "velocity": (1.0, 2.0), "angle": 0.6}
    s = beam(boundary_conditions=boundary, **start)
    result = simulate(Model(bodies=[s]), 1.0, t_eval=np.linspace(0.0, 1.0, 11), **TIGHT)
    t = result.t
    assert np.abs(result["s.x"] - 0.2 - t).max() < 1e-8
    assert np.abs(result["s.y"] - 0.1 - 2.0 * t + 4.905 * t**2).max() < 1e-8
    assert np.abs(result.q[:, 3:]).max() < 1e-10 and np.abs(result["s.angle"] - 0.6).max() < 1e-9


def test_a_stiff_beam_moves_as_the_rigid_body():
    """Thrown and turning, with a force at its frame: in the limit of stiffness, errors O(1/EI)."""
    t_eval = np.linspace(0.0, 1.0, 21)
    force = AppliedForce2D(name="f", marker=on("s", 0.1, 0.2), force_x=Constant(value=0.7), force_y=Constant(value=2.0))
    rigid = RigidBody2D(
        name="s", mass=0.8, inertia=0.8 * 1.2**2 / 12.0 + 0.03 * 1.2, velocity=(1.0, 2.0), angular_velocity=2.0
    )
    expected = simulate(Model(bodies=[rigid], forces=[force]), 1.0, t_eval=t_eval, **TIGHT)
    errors = []
    for stiffness in (200.0, 2000.0):
        s = beam(
            boundary_conditions="free", bending_stiffness=stiffness, axial_stiffness=20.0 * stiffness,
            velocity=(1.0, 2.0), angular_velocity=2.0,
        )  # fmt: skip
        result = simulate(Model(bodies=[s], forces=[force]), 1.0, t_eval=t_eval, rtol=1e-8, atol=1e-11)
        errors.append(np.abs(result.q[:, :3] - expected.q).max())
    assert errors[1] < 2e-5 and errors[1] < 0.2 * errors[0]


def test_joints_and_contacts_take_the_frame_as_a_body():
    """A cantilever held at its root by a prismatic joint falls like a rigid body; its frame rests on a floor."""
    s = beam(geometric_stiffening=False)
    guide = Prismatic2D(name="guide", a=on("ground", angle=0.5 * math.pi), b=on("s"))
    floor = DiskOnHalfPlane2D(
        name="floor", plane=HalfPlane2D(marker=on("ground", 0.0, -0.5)), disk=Disk2D(marker=on("s")),
        law=NewtonImpact(restitution=0.0),
    )  # fmt: skip
    result = simulate(Model(bodies=[s], joints=[guide], contacts=[floor]), 0.6)
    first = result.events[0]
    assert first.kind == "impact" and first.t == pytest.approx(math.sqrt(2.0 * 0.5 / 9.81), abs=1e-7)
    assert np.abs(result["energy.balance"]).max() < 1e-5


def test_gyroscopic_damping_does_no_work_and_is_accepted():
    body, _ = particles(damping=((0.0, 5.0), (-5.0, 0.0)), amplitude_rates=(0.3, -0.2))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[body]), 0.2)
    assert abs(result["energy.dissipation"][-1]) < 1e-15 and np.abs(result["energy.balance"]).max() < 1e-6


# ---- what is refused ------------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"stiffness": ((1.0,),)}, r"stiffness of 's' has \(1, 1\), but modal_mass has n = 2 rows: \(2, 2\)"),
        ({"stiffness": ((1.0, 2.0), (3.0,))}, "rows of different length"),
        ({"stiffness": ((1.0, 2.0), (1.0, 3.0))}, r"stiffness of 's' must be symmetric; entries \(0, 1\) and \(1, 0\)"),
        ({"stiffness": ((1.0, 2.0), (2.0, 1.0))}, "stiffness of 's' has.* the negative eigenvalue -1:"),
        ({"damping": ((1.0, 5.0), (-5.0, -0.1))}, "damping of 's' has.* the negative eigenvalue -0.1:"),
        ({"gyroscopic": ((1.0, 2.0), (2.0, 3.0))}, "gyroscopic of 's' must be skew"),
        ({"modal_inertia": (1.0,)}, r"modal_inertia of 's' has \(1,\).*\(2,\) is needed"),
        ({"amplitudes": (1.0,)}, "amplitudes of 's'"),
        ({"inertia": 1e-3}, "positive definite"),
        ({"points": (ReducedPoint(point=(0.0, 0.0), shape=((1.0,), (0.0,))),)}, r"shape of the point \(0.0, 0.0\)"),
    ],
)
def test_what_is_no_reduced_body_is_refused(changes, words):
    with pytest.raises(ModelError, match=words):
        particles(**changes)


@pytest.mark.parametrize(
    "changes, words",
    [
        ({"attachments": (Attachment(position=2.0),)}, r"\[2.0\] m lie beyond its length 1.2 m"),
        ({"axial_stiffness": None}, "need axial_stiffness"),
        ({"modes": 0, "axial_modes": 0}, "no modes"),
        ({"damping_ratio": (0.1, 0.2)}, "damping_ratio of 's' has 2 entries.*each of its 3"),
        ({"modes": 20, "elements": 5}, "give more elements"),
        ({"attachments": (Attachment(position=0.7), Attachment(position=0.7))}, "leave it out"),
        ({"attachments": (Attachment(position=0.0),)}, "leave it out"),
        ({"boundary_conditions": "clamped"}, "cantilever"),
    ],
)
def test_what_is_no_beam_is_refused(changes, words):
    with pytest.raises(ModelError, match=words):
        beam(**changes)


def test_points_of_a_reduced_body_are_those_that_it_gives():
    given_point = ReducedPoint(point=(0.5, 0.1), shape=((0.1, 0.2), (1.0, -1.0)), rotation=(0.3, 0.4))
    body, _ = particles(points=(given_point,))
    shape = body.material_point((0.5, 0.1))
    assert shape.shape.tolist() == [[0.1, 0.2], [1.0, -1.0]] and shape.slope.tolist() == [[0.0, 0.0], [0.3, 0.4]]
    with pytest.raises(ModelError, match=r"no point \(0.0, 0.0\); `points` gives \[\(0.5, 0.1\)\]"):
        body.material_point((0.0, 0.0))
