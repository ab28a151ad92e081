"""Contact laws in exudyn against the relation of their rebound speed, momentum and scipy."""

import math
from typing import Any

import numpy as np
import pytest
from momentum import momentum_drift
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from tlismni.core.contacts.contact2d import Disk2D, DiskOnDisk2D, DiskOnHalfPlane2D, HalfPlane2D
from tlismni.core.contacts.disk_on_line import DiskOnLine2D, Line2D
from tlismni.core.contacts.segment2d import DiskOnSegment2D, Segment2D
from tlismni.core.elements import AxialRod, FloatingBeam2D, PointMass2D, Prismatic2D, RigidBody2D
from tlismni.core.laws import (
    CarvalhoMartins,
    Flores,
    Hertz,
    HuntCrossley,
    KelvinVoigt,
    LankaraniNikravesh,
    NewtonImpact,
)
from tlismni.core.laws.damping_ratio import restitution_without_pull
from tlismni.core.laws.friction import TanhFriction
from tlismni.core.model.markers import Marker2D
from tlismni.core.multibody_model import Model
from tlismni.validation.errors import ExudynUnavailable, NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available, import_exudyn
from tlismni.validation.exudyn_model import build_exudyn_model
from tlismni.validation.exudyn_run import run_exudyn
from tlismni.validation.metrics import contact_intervals, impulse, peak
from tlismni.validation.translation.contact_laws import restitution_for

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
K, V0 = 1e6, 1.3


def rebound(damping_factor: float) -> float:
    """e with (1 + D)/(1 - D e) = exp(D (1 + e)), 0 < e < 1."""
    d = damping_factor
    if d == 0.0:
        return 1.0
    return float(brentq(lambda e: math.log1p(d) - math.log1p(-d * e) - d * (1.0 + e), 1e-9, min(1.0, 1.0 / d) - 1e-12))


def drop(law: Any, *, radius: float = 0.0, angle: float = 0.0, mass: float = 2.0) -> Model:
    """A mass that flies without weight, straight against a half-plane turned by `angle`."""
    nx, ny = -math.sin(angle), math.cos(angle)
    start = radius + 1e-3
    return Model(
        gravity=(0.0, 0.0),
        bodies=(PointMass2D(name="p", mass=mass, position=(start * nx, start * ny), velocity=(-V0 * nx, -V0 * ny)),),
        contacts=(
            DiskOnHalfPlane2D(
                name="floor",
                plane=HalfPlane2D(marker=Marker2D(angle=angle)),
                disk=Disk2D(marker=Marker2D(body="p"), radius=radius),
                law=law,
            ),
        ),
    )


@pytest.mark.parametrize("damping_factor", [0.0, 0.01, 0.3, 1.5, 2.6, 8.0 / 3.0, 2.7, 9.0, 40.0])
def test_every_damping_factor_has_its_restitution_in_exudyns_model_2(damping_factor: float) -> None:
    e = restitution_for(damping_factor)
    chi = 1.5 * (1.0 - e) * (11.0 - e) / (1.0 + 9.0 * e) if e > 1.0 / 3.0 else (1.0 - e**2) / e
    assert chi == pytest.approx(damping_factor, rel=1e-12, abs=1e-12)


@needs_exudyn
@pytest.mark.parametrize("e", [0.9, 0.5, 0.2])
@pytest.mark.parametrize("kind", [HuntCrossley, LankaraniNikravesh, Flores, CarvalhoMartins])
def test_rebound_speed_of_the_hunt_crossley_family(kind: Any, e: float) -> None:
    law = kind(stiffness=K, restitution=e)
    r = run_exudyn(drop(law), 0.03, 5e-6)
    assert r["p.vy"][-1] / V0 == pytest.approx(rebound(law.damping_factor()), rel=2e-4)
    assert r["floor.impulse"][-1] == pytest.approx(2.0 * (r["p.vy"][-1] + V0), rel=1e-6)
    assert r["floor.normal_force"].min() >= 0.0


@needs_exudyn
@pytest.mark.parametrize("exponent", [1.0, 1.5, 2.0])
def test_hertz_peak_force_and_contact_time(exponent: float) -> None:
    law = Hertz(stiffness=K, exponent=exponent)
    r = run_exudyn(drop(law, radius=0.05, angle=2.2), 0.05, 5e-6)
    n = exponent
    depth = ((n + 1.0) * 2.0 * V0**2 / (2.0 * K)) ** (1.0 / (n + 1.0))
    shape = 2.0 * math.sqrt(math.pi) * math.gamma(1 / (n + 1)) / ((n + 1) * math.gamma(1 / (n + 1) + 0.5))
    (contact,) = contact_intervals(r.t, r["floor.gap"], r["floor.gap_rate"])
    assert peak(r.t, r["floor.normal_force"])[1] == pytest.approx(K * depth**n, rel=1e-4)
    assert contact.start == pytest.approx(1e-3 / V0, abs=1e-9)
    assert contact.duration == pytest.approx(shape * depth / V0, rel=1e-3)
    assert impulse(r.t, r["floor.normal_force"], contact) == pytest.approx(2.0 * 2.0 * V0, rel=1e-4)


@needs_exudyn
@pytest.mark.parametrize("damping", [200.0, 1500.0])
def test_kelvin_voigt_lets_go_when_its_force_is_zero(damping: float) -> None:
    law = KelvinVoigt(stiffness=K, damping=damping)
    r = run_exudyn(drop(law), 0.03, 2e-6)
    zeta = damping / (2.0 * math.sqrt(K * 2.0))
    assert r["p.vy"][-1] / V0 == pytest.approx(restitution_without_pull(zeta), rel=2e-4)
    # one step of tension at most: the release is decided at the start of a step
    assert r["floor.normal_force"].min() > -0.01 * r["floor.normal_force"].max()


@needs_exudyn
@pytest.mark.parametrize("damping", [200.0, 1500.0])
def test_kelvin_voigt_that_holds_on_has_the_restitution_of_a_half_period(damping: float) -> None:
    r = run_exudyn(drop(KelvinVoigt(stiffness=K, damping=damping, release_rule="gap")), 0.03, 2e-6)
    zeta = damping / (2.0 * math.sqrt(K * 2.0))
    expected = math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta**2))
    # the jump c v0 of the force is taken for a step too many or too few: 2 c h/m of the speed
    assert r["p.vy"][-1] / V0 == pytest.approx(expected, rel=2e-4, abs=2.0 * damping * 2e-6 / 2.0)
    assert r["floor.normal_force"].min() < 0.0


@needs_exudyn
def test_contact_under_gravity_follows_scipy() -> None:
    law = HuntCrossley(stiffness=1e5, restitution=0.6)
    model = drop(law).model_copy(update={"gravity": (0.0, -9.81)})
    r = run_exudyn(model, 0.02, 5e-6)
    first = (-V0 + math.sqrt(V0**2 + 2.0 * 9.81e-3)) / 9.81
    v0 = V0 + 9.81 * first

    def motion(t: float, y: np.ndarray) -> list[float]:
        depth = max(0.0, -y[0])
        return [y[1], -9.81 + 1e5 * depth**1.5 * (1.0 - 0.6 * y[1] / v0) / 2.0]

    inside = r.t >= first
    run = solve_ivp(
        motion,
        (first, r.t[-1]),
        [0.0, -v0],
        "DOP853",
        t_eval=r.t[inside],
        rtol=1e-11,
        atol=1e-14,
        max_step=1e-4,
    )
    assert np.abs(r["p.y"][inside] - run.y[0]).max() < 1e-7
    assert np.abs(r["p.vy"][inside] - run.y[1]).max() < 2e-4 * v0


MOVING = (
    RigidBody2D(name="a", mass=2.0, inertia=0.5, velocity=(0.0, 0.5), angle=0.3, angular_velocity=2.0),
    RigidBody2D(name="b", mass=1.0, inertia=0.2, position=(0.7, 0.7), velocity=(0.0, -3.0)),
)


@pytest.mark.sampled(2)
@needs_exudyn
@pytest.mark.parametrize("law", [Hertz(stiffness=K), KelvinVoigt(stiffness=K, damping=300.0)])
@pytest.mark.parametrize("shape", ["half-plane", "disk"])
def test_contact_between_moving_bodies_conserves_both_momenta(law: Any, shape: str) -> None:
    disk = Disk2D(marker=Marker2D(body="b", point=(0.05, -0.1)), radius=0.1)
    if shape == "half-plane":
        plane = HalfPlane2D(marker=Marker2D(body="a", point=(0.0, 0.1), angle=0.1))
        contact: Any = DiskOnHalfPlane2D(name="c", plane=plane, disk=disk, law=law)
    else:
        other = Disk2D(marker=Marker2D(body="a", point=(0.65, 0.1)), radius=0.2)
        contact = DiskOnDisk2D(name="c", a=other, b=disk, law=law)
    model = Model(gravity=(0.0, 0.0), bodies=MOVING, contacts=(contact,))
    r = run_exudyn(model, 0.16, 2e-5)
    assert r["c.normal_force"].max() > 100.0
    assert momentum_drift(model, 0.16, 2e-5) < 1e-4
    # the force is all that accelerates b, whose mass is 1 kg (but for the steps in which contact begins or ends)
    acceleration, force = np.hypot(r["b.ax"], r["b.ay"]), r["c.normal_force"]
    pressed = force > 0.1 * force.max()
    assert np.median(np.abs(acceleration / np.where(pressed, force, 1.0) - 1.0)[pressed]) < 1e-3
    assert r["c.gap"][0] > 0.0


def newton_drop() -> Model:
    return drop(NewtonImpact(restitution=0.5))


def floating_beam() -> Model:
    return Model(bodies=(FloatingBeam2D(name="beam", mass=1.0, length=1.0, bending_stiffness=1.0, modes=1),))


def massless_rod() -> Model:
    rod = AxialRod(name="rod", elements=3, length=1.0, axial_stiffness=1.0, mass_per_length=1.0,
                   massless_ends=("right",))  # fmt: skip
    return Model(bodies=(rod,))


def point_mass_in_a_prismatic_joint() -> Model:
    joint = Prismatic2D(name="s", a=Marker2D(), b=Marker2D(body="p"))
    return Model(bodies=(PointMass2D(name="p", mass=1.0),), joints=(joint,))


def drop_on_a_belt() -> Model:
    body = PointMass2D(name="ball", mass=1.0, position=(0.0, 1.0))
    disk, friction = Disk2D(marker=Marker2D(body="ball")), TanhFriction(coefficient=0.3, transition_speed=0.01)
    contact = DiskOnHalfPlane2D(
        name="floor", plane=HalfPlane2D(), disk=disk, law=KelvinVoigt(stiffness=K, damping=1.0), friction=friction,
        surface_speed=0.5,
    )  # fmt: skip
    return Model(bodies=[body], contacts=(contact,))


def drop_on_a_segment() -> Model:
    disk = Disk2D(marker=Marker2D(body="ball"), radius=0.1)
    contact = DiskOnSegment2D(name="floor", segment=Segment2D(length=1.0), disk=disk, law=Hertz(stiffness=K))
    return Model(bodies=(PointMass2D(name="ball", mass=1.0, position=(0.5, 1.0)),), contacts=(contact,))


def drop_on_a_line() -> Model:
    disk = Disk2D(marker=Marker2D(body="ball"), radius=0.1)
    line = Line2D(nodes=(Marker2D(), Marker2D(body="end")))
    bodies = (
        PointMass2D(name="ball", mass=1.0, position=(0.5, 1.0)),
        PointMass2D(name="end", mass=1.0, position=(1.0, 0.0)),
    )
    return Model(bodies=bodies, contacts=(DiskOnLine2D(name="floor", line=line, disk=disk, law=Hertz(stiffness=K)),))


@needs_exudyn
@pytest.mark.parametrize(
    "make, text",
    [
        (drop_on_a_line, "'floor' is a DiskOnLine2D.*nearest route: disks"),
        (drop_on_a_segment, "'floor' is a DiskOnSegment2D.*nearest route: a DiskOnHalfPlane2D"),
        (floating_beam, "'beam' is a FloatingBeam2D.*nearest route: a Cable2D"),
        (massless_rod, "massless ends"),
        (newton_drop, "constraint .* limit"),
        (drop_on_a_belt, "surface that moves past its body .* driver"),
        (point_mass_in_a_prismatic_joint, "point mass: make it a RigidBody2D"),
        (lambda: "not a model", "only a Model"),
    ],
)
def test_what_has_no_equal_in_exudyn_is_said(make: Any, text: str) -> None:
    with pytest.raises(NotTranslatable, match=text):
        build_exudyn_model(make())


@pytest.mark.parametrize(
    "cause, remedy",
    [
        ("libGL.so.1: cannot open shared object file", "apt install libgl1"),
        ("No module named 'exudyn'", "pip install"),
    ],
)
def test_missing_exudyn_is_explained(monkeypatch: pytest.MonkeyPatch, cause: str, remedy: str) -> None:
    def refuse(name: str) -> Any:
        raise ImportError(cause)

    monkeypatch.setattr("tlismni.validation.exudyn_import.importlib.import_module", refuse)
    with pytest.raises(ExudynUnavailable, match=remedy) as caught:
        import_exudyn()
    assert isinstance(caught.value, ImportError)


def test_another_version_of_exudyn_is_refused(monkeypatch: pytest.MonkeyPatch) -> None:
    class Old:
        __version__ = "1.11.3"

    monkeypatch.setattr("tlismni.validation.exudyn_import.importlib.import_module", lambda name: Old)
    with pytest.raises(ExudynUnavailable, match=r"1\.11\.3.*needs 1\.13"):
        import_exudyn()
