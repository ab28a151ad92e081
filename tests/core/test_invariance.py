"""The motion does not depend on units, frame, handedness or the order of bodies."""

import math

import numpy as np
import pytest
from helpers import events
from linkages import slider_crank
from tlismni.core import (
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    Distance2D,
    Flores,
    HalfPlane2D,
    HalfSpace3D,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    PointMass2D,
    Revolute2D,
    RigidBody2D,
    RigidBody3D,
    Simulation,
    Sphere3D,
    SphereOnHalfSpace3D,
    SpringDamper2D,
    simulate,
)

TIMES = np.linspace(0.0, 1.2, 13)


class Scene:
    """A double pendulum with a spring, a bob on a rod, a wall and a free disk, in another frame and other units.

    Points of the inertial frame go through `place`; points of bodies only through scale and mirror.
    """

    def __init__(self, rotate=0.0, mirror=False, scale=1.0, reverse=False, force_law=False):
        self.rotate, self.sign, self.scale = rotate, -1.0 if mirror else 1.0, scale
        self.reverse, self.force_law = reverse, force_law

    def place(self, x, y):
        """Mirror about the x axis, rotate, scale."""
        y *= self.sign
        c, s = math.cos(self.rotate), math.sin(self.rotate)
        return (self.scale * (c * x - s * y), self.scale * (s * x + c * y))

    def angle(self, angle):
        return self.sign * angle + self.rotate

    def local(self, body, x=0.0, y=0.0):
        if body == "ground":
            return Marker2D(point=self.place(x, y))
        return Marker2D(body=body, point=(self.scale * x, self.scale * self.sign * y))

    def floor(self, height):
        """A floor with its normal upwards: its angle is that of the line's first axis."""
        first = self.angle(math.pi if self.sign < 0.0 else 0.0)
        return HalfPlane2D(marker=Marker2D(point=self.place(0.0, height), angle=first))

    def law(self):
        # stiffness in N/m^1.5: forces scale with length, penetrations too
        if self.force_law:
            return Flores(stiffness=2e4 * self.scale**-0.5, restitution=0.6)
        return NewtonImpact(restitution=0.6)

    def model(self):
        length, square = self.scale, self.scale**2

        def rod(name, centre, angle):
            return RigidBody2D(
                name=name, mass=1.2, inertia=0.1 * square, position=self.place(*centre), angle=self.angle(angle)
            )

        th1, th2 = -0.2, -1.1
        end = np.array([math.cos(th1), math.sin(th1)])
        centre = end + 0.4 * np.array([math.cos(th2), math.sin(th2)])
        bodies = [
            rod("a", 0.5 * end, th1),
            rod("b", centre, th2),
            PointMass2D(name="bob", mass=0.5, position=self.place(-1.0, 0.3), velocity=self.place(1.0 / 3.0, 1.0)),
            PointMass2D(name="ball", mass=0.8, position=self.place(-2.0, 0.8), velocity=self.place(0.5, 0.0)),
        ]
        joints = [
            Revolute2D(name="p", a=self.local("ground"), b=self.local("a", -0.5)),
            Revolute2D(name="q", a=self.local("a", 0.5), b=self.local("b", -0.4)),
            Distance2D(
                name="string", a=self.local("ground", -1.3, 0.4), b=self.local("bob"), length=length * math.sqrt(0.1)
            ),
        ]
        forces = [
            SpringDamper2D(
                name="spring", a=self.local("ground", 0.5, -2.0), b=self.local("b", 0.1, 0.1), stiffness=40.0,
                damping=0.5, natural_length=0.8 * length,
            )
        ]  # fmt: skip
        contacts = [
            DiskOnHalfPlane2D(
                name="floor", plane=self.floor(0.2),
                disk=Disk2D(marker=self.local("ball"), radius=0.1 * length), law=self.law(),
            ),
            DiskOnDisk2D(
                name="knock", a=Disk2D(marker=self.local("ball"), radius=0.1 * length),
                b=Disk2D(marker=self.local("bob"), radius=0.1 * length), law=self.law(),
            ),
        ]  # fmt: skip
        if self.reverse:
            bodies, joints, contacts = bodies[::-1], joints[::-1], contacts[::-1]
        return Model(gravity=self.place(0.0, -9.81), bodies=bodies, joints=joints, forces=forces, contacts=contacts)

    def run(self, **options):
        result = simulate(
            self.model(), TIMES[-1], **{"rtol": 1e-9, "atol": 1e-11 * self.scale, "t_eval": TIMES, **options}
        )
        return self.back(result), result

    def back(self, result):
        """Columns in the original frame and units, in one order."""
        c, s = math.cos(self.rotate), math.sin(self.rotate)
        columns = []
        for body in ("a", "b", "bob", "ball"):
            for x, y in (("x", "y"), ("vx", "vy"), ("ax", "ay")):
                u, w = result[f"{body}.{x}"] / self.scale, result[f"{body}.{y}"] / self.scale
                columns += [c * u + s * w, self.sign * (-s * u + c * w)]
        columns += [self.sign * (result["a.angle"] - self.rotate), self.sign * (result["b.angle"] - self.rotate)]
        columns += [result["string.tension"] / self.scale, result["floor.impulse"] / self.scale]
        return np.stack(columns, axis=1)


@pytest.fixture(scope="module")
def plain():
    return Scene().run()


@pytest.fixture(scope="module")
def plain_force_law():
    return Scene(force_law=True).run()


VARIANTS = {
    "millimetres": {"scale": 1e3},
    "kilometres": {"scale": 1e-3},
    "rotated": {"rotate": 0.7},
    "rotated by much": {"rotate": 2.9},
    "mirrored": {"mirror": True},
    "mirrored and rotated": {"mirror": True, "rotate": -1.3},
    "other order": {"reverse": True},
}


@pytest.mark.parametrize("name", VARIANTS)
def test_motion_and_impacts_are_the_same(name, plain):
    found, result = Scene(**VARIANTS[name]).run()
    expected, reference = plain
    assert len(events(reference, "impact")) >= 3
    assert np.abs(found - expected).max() < 1e-6
    scale = VARIANTS[name].get("scale", 1.0)
    for here, there in zip(result.events, reference.events, strict=True):
        assert (here.kind, here.contact) == (there.kind, there.contact)
        assert here.t == pytest.approx(there.t, abs=1e-8)
        assert here.impulse / scale == pytest.approx(there.impulse, abs=1e-6)
        assert here.energy_loss / scale**2 == pytest.approx(there.energy_loss, abs=1e-6)


@pytest.mark.parametrize("name", VARIANTS)
def test_motion_with_a_force_law_is_the_same(name, plain_force_law):
    found, _ = Scene(force_law=True, **VARIANTS[name]).run()
    positions = [c for c in range(found.shape[1]) if c % 6 < 4 or c >= 24]
    assert np.abs(found - plain_force_law[0])[:, positions].max() < 1e-5


@pytest.mark.parametrize("shift", [5.0, -30.0])
def test_start_time_does_not_matter_to_what_does_not_depend_on_time(shift):
    model = Scene().model()
    plain = simulate(model, 1.0, rtol=1e-9, atol=1e-11, t_eval=[0.5, 1.0])
    later = simulate(model, 1.0 + shift, t0=shift, rtol=1e-9, atol=1e-11, t_eval=[0.5 + shift, 1.0 + shift])
    assert np.abs(plain.q - later.q).max() < 1e-6
    assert [e.kind for e in plain.events] == [e.kind for e in later.events]


def test_same_run_twice_gives_the_same_bits():
    model = Scene().model()
    runs = [simulate(model, 1.0) for _ in range(2)]
    assert runs[0].q.tobytes() == runs[1].q.tobytes() and runs[0].a.tobytes() == runs[1].a.tobytes()


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf"])
def test_motion_is_reversible(method):
    """Without losses: turn the velocities about and the start comes back."""

    def model(q, v):
        names = ["a", "b"]
        bodies = [
            RigidBody2D(
                name=name, mass=1.0, inertia=0.1, position=tuple(q[3 * k : 3 * k + 2]), angle=q[3 * k + 2],
                velocity=tuple(v[3 * k : 3 * k + 2]), angular_velocity=v[3 * k + 2],
            )
            for k, name in enumerate(names)
        ]  # fmt: skip
        joints = [
            Revolute2D(name="p", a=Marker2D(), b=Marker2D(body="a", point=(-0.5, 0.0))),
            Revolute2D(name="q", a=Marker2D(body="a", point=(0.5, 0.0)), b=Marker2D(body="b", point=(-0.5, 0.0))),
        ]
        return Model(bodies=bodies, joints=joints)

    q0 = np.array([0.5, 0.0, 0.0, 1.0, -0.5, -math.pi / 2])
    tight = {"method": method, "rtol": 1e-10, "atol": 1e-12}
    there = simulate(model(q0, np.zeros(6)), 0.8, **tight)
    back = simulate(model(there.q[-1], -there.v[-1]), 0.8, **tight)
    assert np.abs(there.q[-1] - q0).max() > 0.3
    assert np.abs(back.q[-1] - q0).max() < (1e-4 if method == "bdf" else 1e-7)


@pytest.mark.parametrize("scale", [1e3, 1e-3])
def test_partition_and_steps_do_not_depend_on_the_unit_of_length(scale):
    """Translations and angles mixed: a mechanism in millimetres or kilometres takes the same dependent coordinates at
    the same times; under error control the steps differ only by what one atol means to lengths of another size."""

    def sim(length, **options):
        model = slider_crank(0.5, 9.0, 0.8, 1.0, gravity=9.81, scale=length)
        return Simulation(model, **options)

    plain, other = sim(1.0, step=2e-3), sim(scale, step=2e-3)
    for k in range(1, 31):
        plain.advance(0.05 * k)
        other.advance(0.05 * k)
        assert other.workspace.structure.dependent.tolist() == plain.workspace.structure.dependent.tolist()

    def steps(length, atol):
        controlled = sim(length, rtol=1e-6, atol=atol)
        controlled.advance(1.5)
        return controlled.stats["steps"]

    # one atol for lengths and angles cannot be scaled for both: that for the one and that for the other bracket the run
    loose, tight = (steps(scale, 1e-6 * f) for f in (max(scale, 1.0), min(scale, 1.0)))
    assert loose <= steps(1.0, 1e-6) <= tight


@pytest.mark.parametrize("kind", ["plane", "space"])
def test_rounding_of_a_place_is_no_size_of_the_model(kind):
    """A ball that lies at the origin but for the rounding of a cosine is as large as it is."""
    x = math.cos(0.5 * math.pi)
    law = NewtonImpact(restitution=0.5)
    if kind == "plane":
        body = RigidBody2D(name="ball", mass=1.0, inertia=1.0, position=(x, 0.0))
        disk = Disk2D(marker=Marker2D(body="ball"), radius=0.2)
        touch = DiskOnHalfPlane2D(name="c", disk=disk, plane=HalfPlane2D(marker=Marker2D(point=(0.0, -x))), law=law)
    else:
        body = RigidBody3D(name="ball", mass=1.0, inertia=(1.0, 1.0, 1.0), position=(x, 0.0, 0.0))
        ball = Sphere3D(marker=Marker3D(body="ball"), radius=0.2)
        touch = SphereOnHalfSpace3D(
            name="c", sphere=ball, plane=HalfSpace3D(marker=Marker3D(point=(0, 0, -x))), law=law
        )
    model = Model(gravity=(0.0, 0.0), bodies=[body], contacts=[touch])
    assert model.assemble().length == 0.2
