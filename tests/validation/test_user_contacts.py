"""Laws and friction that exudyn gets as user functions: against the solver, momentum and closed forms."""

from typing import Any

import numpy as np
import pytest
from momentum import momentum_drift
from tlismni.core import Model, simulate
from tlismni.core.contacts.contact2d import Disk2D, DiskOnDisk2D, DiskOnHalfPlane2D, HalfPlane2D
from tlismni.core.contacts.coordinate_contact import CoordinateContact, CoordinateTerm
from tlismni.core.elements import Cable2D, LinearSystem, MaterialPoint2D, PointMass2D, RigidBody2D
from tlismni.core.laws import Flores, Hertz, KelvinVoigt, KuwabaraKono, Tsuji
from tlismni.core.laws.friction import (
    AmbrosioFriction,
    BrownMcPheeFriction,
    LuGreFriction,
    StepFriction,
    TanhFriction,
    ThrelfallFriction,
)
from tlismni.core.model.markers import Marker2D
from tlismni.validation import ExudynSettings, run_exudyn
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.translation.formulas import friction_force, normal_force

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
FRICTIONS = [
    TanhFriction(coefficient=0.4, transition_speed=0.05),
    ThrelfallFriction(coefficient=0.4, transition_speed=0.05),
    AmbrosioFriction(coefficient=0.4, lower_speed=0.01, upper_speed=0.05),
    StepFriction(coefficient=0.3, static_coefficient=0.4, stiction_speed=0.02, sliding_speed=0.06),
    BrownMcPheeFriction(coefficient=0.3, static_coefficient=0.4, transition_speed=0.05),
]


class Hardening(Hertz):
    """A law of a user's own."""


def test_formulas_are_the_solvers() -> None:
    laws = [
        Tsuji(stiffness=1e6, damping=30.0), KuwabaraKono(stiffness=1e6, relaxation_time=1e-3),
        Flores(stiffness=1e6, restitution=0.6), KelvinVoigt(stiffness=1e5, damping=3.0),
        Hardening(stiffness=1e6, exponent=2.0),
    ]  # fmt: skip
    for law in laws:
        for d, dd in ((1e-3, 0.2), (2e-3, -0.7)):
            assert normal_force(law)(d, dd, 1.3) == pytest.approx(law.evaluate(d, dd, 1.3)[0], rel=1e-12)
    for friction in FRICTIONS:
        for v in (-0.2, -0.03, 0.0, 0.005, 0.04, 0.055, 1.0):
            assert friction_force(friction)(v, 7.0) == pytest.approx(friction.evaluate(v, 7.0)[0], abs=1e-12)


def rolling(friction: Any, law: Any = None, disks: bool = False) -> Model:
    """A spinning disk that falls on a turning body and rubs on it, without weight."""
    disk = Disk2D(marker=Marker2D(body="b", point=(0.02, 0.0)), radius=0.1)
    law = law or KelvinVoigt(stiffness=1e4, damping=20.0, release_rule="gap")
    below: dict[str, Any] = {"name": "w", "mass": 3.0, "inertia": 0.5, "angular_velocity": 0.4, "velocity": (0.0, 2.0)}
    if disks:
        first = Disk2D(marker=Marker2D(body="w", point=(0.01, 0.02)), radius=0.1)
        contact: Any = DiskOnDisk2D(name="c", a=first, b=disk, law=law, friction=friction)
        top, body = 0.25, RigidBody2D(position=(0.01, 0.0), **below)
    else:
        plane = HalfPlane2D(marker=Marker2D(body="w", point=(0.05, 0.2), angle=0.2))
        contact = DiskOnHalfPlane2D(name="c", plane=plane, disk=disk, law=law, friction=friction)
        top, body = 0.11, RigidBody2D(position=(0.0, -0.2), **below)
    ball = RigidBody2D(name="b", mass=1.0, inertia=0.01, position=(0.0, top), velocity=(1.0, -0.5),
                       angular_velocity=-3.0)  # fmt: skip
    return Model(gravity=(0.0, 0.0), bodies=(ball, body), contacts=(contact,))


@needs_exudyn
@pytest.mark.parametrize("friction", FRICTIONS, ids=lambda f: f.type)
def test_friction_laws_follow_the_solver(friction: Any) -> None:
    model = rolling(friction)
    r = run_exudyn(model, 0.06, 1e-4)
    ours = simulate(model, 0.06, "ebdf", 1e-9, 1e-11, t_eval=r.t)
    assert np.ptp(ours["c.friction_force"]) > 5.0
    for channel in ("b.x", "b.y", "b.angle", "w.angle"):
        assert np.abs(r[channel] - ours[channel]).max() < 2e-3 * np.ptp(ours[channel]), channel


@needs_exudyn
@pytest.mark.parametrize("disks", [False, True])
def test_a_contact_by_user_function_keeps_the_momenta(disks: bool) -> None:
    assert momentum_drift(rolling(FRICTIONS[0], disks=disks), 0.06, 2e-4) < 2e-6


@needs_exudyn
def test_two_disks_that_rub_follow_the_solver() -> None:
    model = rolling(FRICTIONS[0], disks=True)
    r = run_exudyn(model, 0.06, 1e-4)
    ours = simulate(model, 0.06, "ebdf", 1e-9, 1e-11, t_eval=r.t)
    for channel in ("b.x", "b.angle", "w.angle", "w.x"):
        assert np.abs(r[channel] - ours[channel]).max() < 2e-3 * np.ptp(ours[channel]), channel


@needs_exudyn
def test_bristles_hold_a_block_as_their_law_says() -> None:
    """Under a push of half the static friction a block comes to rest beyond F/s0; under 1.05 times it slides."""
    friction = LuGreFriction(coefficient=0.3, static_coefficient=0.4, stribeck_speed=0.01, bristle_stiffness=1e3,
                             bristle_damping=30.0)  # fmt: skip
    block = PointMass2D(name="p", mass=1.0, position=(0.0, -0.5 * 9.81e-4))
    contact = DiskOnHalfPlane2D(name="c", plane=HalfPlane2D(), disk=Disk2D(marker=Marker2D(body="p")),
                                law=KelvinVoigt(stiffness=2e4, damping=100.0), friction=friction)  # fmt: skip
    for share, slides in ((0.5, False), (1.05, True)):
        push = share * 0.4 * 9.81
        model = Model(gravity=(push, -9.81), bodies=(block,), contacts=(contact,))
        r = run_exudyn(model, 0.5, 5e-4)
        if slides:
            assert r["p.vx"][-1] > 0.1
        else:
            ours = simulate(model, 0.5, "ebdf", 1e-8, 1e-10, t_eval=r.t)
            assert abs(r["p.vx"][-1]) < 1e-4 and r["p.x"][-1] > push / 1e3
            assert r["c.friction_force"][-1] == pytest.approx(-push, rel=5e-3)
            assert np.abs(r["p.x"] - ours["p.x"]).max() < 2e-3 * np.ptp(ours["p.x"])


@needs_exudyn
@pytest.mark.parametrize(
    "law", [Tsuji(stiffness=1e5, damping=20.0), KuwabaraKono(stiffness=1e5, relaxation_time=1e-3),
            Hardening(stiffness=1e5)], ids=lambda law: law.type,
)  # fmt: skip
def test_laws_that_exudyn_lacks_follow_the_solver(law: Any) -> None:
    contact = DiskOnHalfPlane2D(name="c", plane=HalfPlane2D(), disk=Disk2D(marker=Marker2D(body="p")), law=law)
    model = Model(bodies=(PointMass2D(name="p", mass=1.0, position=(0.0, 0.02)),), contacts=(contact,))
    r = run_exudyn(model, 0.1, 2e-5)
    ours = simulate(model, 0.1, "ebdf", 1e-9, 1e-11, t_eval=r.t)
    assert np.abs(r["p.y"] - ours["p.y"]).max() < 1e-5
    assert r["c.normal_force"].max() == pytest.approx(ours["c.normal_force"].max(), rel=5e-3)


@needs_exudyn
def test_gaps_of_coordinates_native_and_by_user_function() -> None:
    """One coordinate against its limit (exudyn's own object) and a sum of two with a law of approach speed."""
    system = LinearSystem(name="s", coordinates=("u", "w"), mass=((1.0, 0.2), (0.2, 2.0)), velocity=(1.0, 0.5))
    native = CoordinateContact(name="stop", offset=0.02, terms=(CoordinateTerm(body="s", coordinate="u", factor=-1.0),),
                               law=Hertz(stiffness=1e6))  # fmt: skip
    both = CoordinateContact(
        name="sum", offset=0.05, law=Flores(stiffness=1e6, restitution=0.7),
        terms=(CoordinateTerm(body="s", coordinate="u"), CoordinateTerm(body="s", coordinate="w", factor=-3.0)),
    )  # fmt: skip
    model = Model(gravity=(0.0, 0.0), bodies=(system,), contacts=(native, both))
    r = run_exudyn(model, 0.15, 1e-5)
    ours = simulate(model, 0.15, "ebdf", 1e-9, 1e-11, t_eval=r.t)
    assert {e.contact for e in ours.events} == {"stop", "sum"}
    for name in ("stop", "sum"):
        assert np.abs(r[f"{name}.gap"] - ours[f"{name}.gap"]).max() < 1e-4 * np.ptp(ours[f"{name}.gap"])
        assert r[f"{name}.impulse"][-1] == pytest.approx(ours[f"{name}.impulse"][-1], rel=1e-3)


@needs_exudyn
def test_friction_on_a_point_of_a_cable_follows_the_solver() -> None:
    cable = Cable2D(name="rope", elements=2, length=0.5, mass_per_length=0.4, axial_stiffness=200.0,
                    bending_stiffness=0.05, axial_damping=1.0, bending_damping=1e-3, position=(0.0, 0.005),
                    velocity=(1.0, -0.5))  # fmt: skip
    points = [MaterialPoint2D(name=f"p{k}", body="rope", point=(0.125 + 0.25 * k, 0.0)) for k in range(2)]
    contacts = [
        DiskOnHalfPlane2D(name=f"c{k}", plane=HalfPlane2D(), disk=Disk2D(marker=Marker2D(body=f"p{k}")),
                          law=KelvinVoigt(stiffness=5e3, damping=5.0, release_rule="gap"), friction=FRICTIONS[0])
        for k in range(2)
    ]  # fmt: skip
    model = Model(bodies=(cable, *points), contacts=contacts)
    r = run_exudyn(model, 0.05, 1e-4, ExudynSettings(absolute_tolerance=1e-8))
    ours = simulate(model, 0.05, "irk", 1e-8, 1e-10, t_eval=r.t)
    for channel in ("p0.x", "p1.y", "p0.angle"):
        assert np.abs(r[channel] - ours[channel]).max() < 5e-3 * np.ptp(ours[channel]), channel
