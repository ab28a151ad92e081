"""Tangents and constraint levels of every element against differences of its residuals.

The sixth-order central difference with span H has an error of about 1e-10 for functions of scale 1.
"""

import math

import element_cases
import numpy as np
import pytest
from helpers import GROUND, circle_pendulum, on
from hypothesis import settings
from own_parts import CrankRotor, Drag, HardeningSpring, InBowl, OnParabola, WheelOnFloor
from random_seeds import assume, at_seeds
from tlismni.core import (
    AppliedForce2D,
    AppliedTorque2D,
    AxialRod,
    Bushing2D,
    Constant,
    CoordinateDriver,
    CoordinateLoad,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    Distance2D,
    EquationSystem,
    Flores,
    Gear2D,
    HalfPlane2D,
    Hertz,
    KelvinVoigt,
    KuwabaraKono,
    LinearSystem,
    Model,
    NewtonImpact,
    PointMass2D,
    Polynomial,
    Prismatic2D,
    Revolute2D,
    RigidBody2D,
    Sine,
    SpringDamper2D,
    Table,
    Tsuji,
)
from tlismni.core.assembly.evaluate import evaluate_residuals, evaluate_tangent
from tlismni.core.assembly.workspace import Workspace
from tlismni.core.state.modes import ACTIVE, CLOSED, contact_memories

quick = settings(deadline=None, max_examples=8, derandomize=True)

H = 1e-2
WEIGHTS = {1: 45.0 / 60.0, 2: -9.0 / 60.0, 3: 1.0 / 60.0}

A = RigidBody2D(name="a", mass=1.3, inertia=0.4)
B = RigidBody2D(name="b", mass=0.7, inertia=0.2, position=(2.0, 0.5))
P = PointMass2D(name="p", mass=2.0, position=(0.5, 1.5))
LEFT, RIGHT = on("a", 0.3, -0.2), on("b", -0.4, 0.1)
TOY = LinearSystem(
    name="toy", coordinates=("u", "w", "z"), mass=((2.0, 0.3, 0.1), (0.3, 1.0, 0.2), (0.1, 0.2, 0.7)),
    damping=((0.4, 0.3, 0.0), (-0.3, 0.2, 0.1), (0.0, 0.1, 0.5)),
    stiffness=((4.0, -1.0, 0.0), (-1.0, 3.0, 0.5), (0.0, 0.5, 2.0)), force=(1.0, -2.0, 0.3),
)  # fmt: skip
SINE = Sine(amplitude=0.7, angular_frequency=2.0, phase=0.3, offset=0.2)


def contact(law, kind="plane"):
    if kind == "plane":
        plane, disk = HalfPlane2D(marker=on("a", 0.3, -0.2, 0.4)), Disk2D(marker=RIGHT, radius=2.5)
        return DiskOnHalfPlane2D(name="c", plane=plane, disk=disk, law=law)
    return DiskOnDisk2D(name="c", a=Disk2D(marker=LEFT, radius=1.5), b=Disk2D(marker=RIGHT, radius=1.4), law=law)


FORCE_LAWS = [
    Hertz(stiffness=5.0, exponent=2.0),
    KelvinVoigt(stiffness=4.0, damping=0.8),
    Flores(stiffness=6.0, restitution=0.5, exponent=2.0, release_rule="gap"),
    Tsuji(stiffness=5.0, damping=0.7),
    KuwabaraKono(stiffness=5.0, relaxation_time=0.1),
]
CASES = {
    "bodies": {},
    "rod": {"bodies": [AxialRod(name="rod", elements=4, length=1.3, axial_stiffness=4.0, mass_per_length=0.8,
                                damping_time=0.3, massless_ends=("left",))]},
    "revolute": {"joints": [Revolute2D(name="j", a=LEFT, b=RIGHT)]},
    "revolute on ground": {"joints": [Revolute2D(name="j", a=on("ground", 0.1, 0.2), b=RIGHT)]},
    "revolute with a point mass": {"joints": [Revolute2D(name="j", a=LEFT, b=on("p"))]},
    "prismatic": {"joints": [Prismatic2D(name="j", a=on("a", 0.3, -0.2, 0.4), b=RIGHT)]},
    "prismatic on ground": {"joints": [Prismatic2D(name="j", a=on("ground", 0.1, 0.3, 1.1), b=RIGHT)]},
    "distance": {"joints": [Distance2D(name="j", a=LEFT, b=RIGHT, length=1.2)]},
    "distance to ground": {"joints": [Distance2D(name="j", a=on("ground", -1.0, 0.3), b=on("p"), length=1.2)]},
    "gear": {"joints": [Gear2D(name="j", a=on("a"), b=on("b"), radius_a=1.2, radius_b=math.hypot(2.0, 0.5) - 1.2)]},
    "inner gear to ground": {
        "joints": [Gear2D(name="j", a=GROUND, b=on("b"), radius_a=-3.0, radius_b=3.0 - math.hypot(2.0, 0.5))]
    },
    "own joint": {"joints": [OnParabola(name="j", a=on("a", 0.3, -0.2, 0.4), b=RIGHT, curvature=0.8)]},
    "own joint on ground": {"joints": [OnParabola(name="j", b=on("p"), curvature=0.8)]},
    "own force": {
        "forces": [
            HardeningSpring(name="f", a=LEFT, b=RIGHT, natural_length=0.9, stiffness=3.0, cubic=0.8, damping=0.7)
        ]
    },
    "own kernel": {"forces": [Drag(name="f", marker=on("p"), coefficient=0.7)]},
    "own body": {"bodies": [CrankRotor(name="crank", mean=1.3, swing=0.4)]},
    "driver": {"joints": [CoordinateDriver(name="j", body="a", coordinate="angle", motion=SINE)]},
    "polynomial driver": {
        "joints": [
            CoordinateDriver(name="j", body="b", coordinate="x", motion=Polynomial(coefficients=(0.1, -1.0, 2.0, 0.5)))
        ]
    },
    "table driver": {
        "joints": [
            CoordinateDriver(
                name="j", body="p", coordinate="y",
                motion=Table(times=(0.0, 1.0, 2.0, 3.0), values=(0.0, 1.0, -1.0, 2.0)),
            )
        ]
    },
    "spring": {"forces": [SpringDamper2D(name="f", a=LEFT, b=RIGHT, stiffness=3.0, damping=0.7, natural_length=0.9)]},
    "spring to ground": {
        "forces": [
            SpringDamper2D(
                name="f", a=on("ground", 0.0, -1.0), b=on("p"), stiffness=3.0, damping=0.7, natural_length=0.9
            )
        ]
    },
    "bushing": {
        "forces": [
            Bushing2D(
                name="f", a=on("a", 0.3, -0.2, 0.4), b=on("b", -0.4, 0.1, -0.3), stiffness=3.0, damping=0.7,
                rotational_stiffness=1.1, rotational_damping=0.3,
            )
        ]
    },
    "bushing to ground": {
        "forces": [
            Bushing2D(
                name="f", a=on("ground", 0.0, -1.0, 0.2), b=RIGHT, stiffness=3.0, damping=0.7,
                rotational_stiffness=1.1, rotational_damping=0.3,
            )
        ]
    },
    "bushing with a point mass": {"forces": [Bushing2D(name="f", a=LEFT, b=on("p"), stiffness=3.0, damping=0.7)]},
    "force": {"forces": [AppliedForce2D(name="f", marker=RIGHT, force_x=SINE, force_y=Constant(value=1.4))]},
    "follower": {
        "forces": [AppliedForce2D(name="f", marker=RIGHT, force_x=SINE, force_y=Constant(value=1.4), follower=True)]
    },
    "torque": {"forces": [AppliedTorque2D(name="f", body="a", torque=SINE)]},
    "linear system": {"bodies": [TOY]},
    "two linear systems": {
        "bodies": [TOY, LinearSystem(name="one", coordinates=("s",), mass=((1.5,),), stiffness=((3.0,),))]
    },
    "driven linear system": {
        "bodies": [TOY], "joints": [CoordinateDriver(name="j", body="toy", coordinate="w", motion=SINE)]
    },
    "load on a linear system": {
        "bodies": [TOY], "forces": [CoordinateLoad(name="f", body="toy", coordinate="z", load=SINE)]
    },
    "load on a coordinate": {"forces": [CoordinateLoad(name="f", body="b", coordinate="angle", load=SINE)]},
    "closed plane": {"contacts": [contact(NewtonImpact(restitution=0.5))], "mode": CLOSED},
    "closed disks": {"contacts": [contact(NewtonImpact(restitution=0.5), "disks")], "mode": CLOSED},
    "closed own contact": {
        "contacts": [
            InBowl(name="c", a=on("a", 0.3, -0.2, 0.4), b=RIGHT, curvature=0.4, law=NewtonImpact(restitution=0.5))
        ],
        "mode": CLOSED,
    },
    "own contact with a force law": {
        "contacts": [WheelOnFloor(name="c", a=on("a", 0.3, -0.2, 0.4), b=RIGHT, radius=2.5, law=FORCE_LAWS[1])],
        "mode": ACTIVE,
    },
    "open plane": {"contacts": [contact(NewtonImpact(restitution=0.5))]},
    **{f"{law.type} on plane": {"contacts": [contact(law)], "mode": ACTIVE} for law in FORCE_LAWS},
    **{f"{law.type} on disk": {"contacts": [contact(law, "disks")], "mode": ACTIVE} for law in FORCE_LAWS},
    "Flores on disk, laid": {"contacts": [contact(FORCE_LAWS[2], "disks")], "mode": ACTIVE, "laid": 1e-3},
    **element_cases.CASES,
}  # fmt: skip


class Point:
    """A system at some point of its state space, asked for residuals and tangents."""

    def __init__(self, system, mode=None, laid=0.0):
        self.workspace = Workspace(system.assemble())
        if mode is not None:
            closed, engaged = (frozenset({0}) if mode == m else frozenset() for m in (CLOSED, ACTIVE))
            self.workspace.engage(closed, engaged)
            self.remember(("mode", "approach_speed"), (mode, 0.9))
            if mode == ACTIVE:
                self.remember(("laid_mass",), (laid,))
        self.n, self.m = self.workspace.assembly.n, self.workspace.assembly.m

    def _put(self, *state):
        """Writes (t, q, v, a, lam); gives the places where they are."""
        arrays, sizes = self.workspace.arrays, (1, self.n, self.n, self.n, self.m)
        places = [arrays[name][:size] for name, size in zip(("t", "q", "v", "a", "lam"), sizes, strict=True)]
        for place, value in zip(places, state, strict=True):
            place[:] = value
        return places

    def _results(self):
        arrays = self.workspace.arrays
        return (arrays["r"][: self.n], *(arrays[x][: self.m] for x in ("phi", "phid", "phidd")))

    def remember(self, names, values):
        """Fields of the memory of the first contact."""
        memory = contact_memories(self.workspace.arrays["memory"])
        for name, value in zip(names, values, strict=True):
            memory[name][0] = value

    def at(self, t, q, v, a, lam):
        """r and the residuals of the three levels."""
        self._put(t, q, v, a, lam)
        evaluate_residuals(self.workspace.record)
        return tuple(x.copy() for x in self._results())

    def tangent(self, c_q, c_v):
        """The matrix at the last point, dense."""
        evaluate_tangent(self.workspace.record, c_q, c_v)
        structure = self.workspace.structure
        size = self.n + len(structure.active)
        matrix = np.zeros((size, size))
        matrix[structure.rows, structure.cols] = self.workspace.arrays["values"][: structure.nnz]
        return matrix

    def derivative(self, index, along, point, h=H):
        """Derivative of result `index` of `at` along (dt, dq, dv, da, dlam)."""
        # a hundred thousand times in these tests: what does not move is written once
        places, result, record = self._put(*point), self._results()[index], self.workspace.record
        moving = [each for each in zip(places, point, along, strict=True) if np.any(each[2])]
        total = np.zeros(len(result))
        for k, weight in WEIGHTS.items():
            for sign in (1.0, -1.0):
                for place, x, d in moving:
                    place[:] = x + sign * k * h * d
                evaluate_residuals(record)
                total += sign * weight * result
        return total / h


def differences(point, index, ways, state, h=4e-3):
    """Derivatives of result `index` of `at` along each way (one a column), and by how much they may be off.

    Their error, of order 8, is known from another width. States near a kink, or where it is large, are left out.
    """
    wide, narrow = (np.array([point.derivative(index, way, state, width) for way in ways]).T for width in (h, 0.5 * h))
    size, error = max(1.0, np.abs(narrow).max()), np.abs(wide - narrow).max()
    assume(error < 1e-7 * size)
    return narrow, 1e-9 * size + 0.05 * error


def draw(point, seed):
    """Some state near the initial positions (t, q, v, a, lam)."""
    random = np.random.default_rng(seed)
    q0 = point.workspace.assembly.q0
    shift = 0.2 * random.uniform(-1.0, 1.0, point.n)
    return [
        1.3,
        q0 + shift,
        *(random.uniform(-1.0, 1.0, point.n) for _ in range(2)),
        random.uniform(-2.0, 2.0, point.m),
    ]


def system(case):
    parts = {key: value for key, value in CASES[case].items() if key not in ("mode", "bodies", "laid")}
    bodies = [A, *CASES[case].get("bodies", ()), B, P]  # what follows a body of other size keeps its place
    return Point(
        Model(gravity=(0.3, -9.0), bodies=bodies, **parts), CASES[case].get("mode"), CASES[case].get("laid", 0.0)
    )


def check_matrix(point, state, c_q=0.6, c_v=0.8, h=H):
    """S = dr/da + c_v dr/dv + c_q dr/dq; Phi_q, W of velocity-level rows; its transpose; and nothing below."""
    n, active = point.n, point.workspace.structure.active
    point.at(*state)
    matrix = point.tangent(c_q, c_v)
    zero, unit = np.zeros(n), np.eye(n)
    no_lam = np.zeros(point.m)
    s = np.array([point.derivative(0, (0.0, c_q * e, c_v * e, e, no_lam), state, h) for e in unit]).T
    jacobian = np.array([point.derivative(2, (0.0, zero, e, zero, no_lam), state, h) for e in unit]).T[active]
    by_place = np.array([point.derivative(1, (0.0, e, zero, zero, no_lam), state, h) for e in unit]).T[active]
    held = ~np.isin(active, list(point.workspace.assembly.rate_rows))
    scale = max(1.0, np.abs(s).max())
    assert np.abs(matrix[:n, :n] - s).max() < 1e-8 * scale
    assert np.abs(matrix[n:, :n] - jacobian).max(initial=0.0) < 1e-8
    assert np.abs(matrix[n:, :n] - by_place)[held].max(initial=0.0) < 1e-8
    assert not by_place[~held].any()
    assert np.array_equal(matrix[:n, n:], matrix[n:, :n].T)
    assert not matrix[n:, n:].any()
    for row in active:  # forces of a constraint: r changes with its multiplier by Phi_q^T
        dlam = np.eye(point.m)[row]
        force = point.derivative(0, (0.0, zero, zero, zero, dlam), state)
        assert np.abs(force - matrix[n + list(active).index(row), :n]).max() < 1e-9


def check_levels(point, state, h=H):
    """Phi' and Phi'' along the motion are the velocity and acceleration residuals: all gaps and constraints."""
    _, q, v, a, lam = state
    point.at(*state)
    first = point.derivative(1, (1.0, v, np.zeros_like(q), np.zeros_like(q), np.zeros_like(lam)), state, h)
    _, _, phid, phidd = point.at(*state)
    held = np.setdiff1d(np.arange(point.m), list(point.workspace.assembly.rate_rows))
    assert np.abs(phid - first)[held].max(initial=0.0) < 1e-8
    second = point.derivative(2, (1.0, v, a, np.zeros_like(q), np.zeros_like(lam)), state, h)
    assert np.abs(phidd - second).max(initial=0.0) < 1e-8


@pytest.mark.parametrize("case", CASES)
def test_tangent_is_the_derivative_of_the_residual(case):
    point = system(case)

    @at_seeds
    def check(seed):
        check_matrix(point, draw(point, seed))

    check()


@pytest.mark.parametrize("case", CASES)
def test_velocity_and_acceleration_level_are_the_derivatives_of_the_position_level(case):
    point = system(case)

    @at_seeds
    def check(seed):
        check_levels(point, draw(point, seed))

    check()


def test_contact_forces_really_act_in_these_tests():
    """The shapes overlap at all states drawn above; else the tests of the laws would compare zeros."""
    for case in CASES:
        if CASES[case].get("mode") == ACTIVE:
            point = system(case)
            free = system("bodies")
            for seed in range(10):
                state = draw(point, seed)
                with_force = point.at(*state)
                without = free.at(state[0], state[1], state[2], state[3], np.zeros(0))
                assert with_force[1][0] < 0.0, (case, seed)
                assert np.abs(with_force[0] - without[0]).max() > 1e-3


def pendulum_with_everything():
    """User equations whose mass, force and constraint depend on all they may depend on."""
    return EquationSystem(
        mass=lambda t, q: np.array([[2.0 + np.sin(q[1]), 0.3 * q[0]], [0.3 * q[0], 1.5 + 0.2 * np.cos(t + q[0])]]),
        force=lambda t, q, v: np.array([np.sin(q[0]) * v[1] - 3.0 * v[0] ** 2, t * q[1] ** 2 - v[0] * v[1]]),
        constraint=lambda t, q: q[0] ** 2 + 2.0 * q[1] ** 2 * np.cos(q[0]) - (1.0 + 0.1 * np.sin(t)),
        q0=[1.0, 0.0],
        v0=[0.0, 0.4],
    )


@pytest.mark.parametrize("build", [circle_pendulum, pendulum_with_everything])
@pytest.mark.parametrize("seed", range(4))
def test_tangent_and_levels_of_user_equations(build, seed):
    point = Point(build())
    state = draw(point, seed)
    check_matrix(point, state)
    check_levels(point, state)


def test_spring_at_the_ground_of_both_ends_does_nothing_to_others():
    spring = SpringDamper2D(name="f", a=GROUND, b=on("ground", 1.0), stiffness=3.0, damping=0.7, natural_length=0.9)
    point, free = Point(Model(bodies=[A, B, P], forces=[spring])), Point(Model(bodies=[A, B, P]))
    state = draw(point, 1)
    assert np.array_equal(point.at(*state)[0], free.at(*state)[0])
    assert np.array_equal(point.tangent(1.0, 1.0), free.tangent(1.0, 1.0))
