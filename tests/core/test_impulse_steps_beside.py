"""Steps of impulses among force laws and redundant joints: momentum, ledger, rest."""

import math

import numpy as np
import pytest
from tlismni.core import (
    Axes,
    BrownMcPheeFriction,
    ContactGroup3D,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    HalfSpace3D,
    HuntCrossley,
    KelvinVoigt,
    Marker2D,
    Marker3D,
    Model,
    NewtonImpact,
    Revolute3D,
    RigidBody2D,
    RigidBody3D,
    Simulation,
    Sphere3D,
    TurningFriction,
    contacts_between,
)
from tlismni.core.events.zeno import SIZE
from tlismni.core.state.modes import CLOSED

G, WIDTH, BAR = 9.81, 0.36, 0.1
LAWS = {
    "linear": KelvinVoigt(stiffness=2e4, damping=20.0),
    "stiff": KelvinVoigt(stiffness=1e6, damping=200.0),
    "hertz": HuntCrossley(stiffness=1e5, restitution=0.3),
}


def walls():
    sides = [((0, 0, 0), (0, 0, 1)), ((0, 0, 0), (1, 0, 0)), ((0, 0, 0), (0, 1, 0))]
    sides += [((WIDTH, 0, 0), (-1, 0, 0)), ((0, WIDTH, 0), (0, -1, 0))]
    return [HalfSpace3D(marker=Marker3D(point=point, attitude=Axes(z=normal))) for point, normal in sides]


def parallelogram(rate=3.0):
    """Three swinging bars beside the box, of hinges in space: three of their rows repeat others."""
    top, up = np.array([1.0, 0.0, 0.5]), Axes(z=(0, 1, 0), x=(1, 0, 0))
    right, low = np.array([4.0 * BAR, 0.0, 0.0]), np.array([0.0, 0.0, -2.0 * BAR])

    def at(body, point):
        return Marker3D(**({"body": body} if body else {}), point=tuple(point), attitude=up)

    swing = {"angular_velocity": (0.0, rate, 0.0), "velocity": (-rate * BAR, 0.0, 0.0)}
    places = (("crank", top + 0.5 * low, swing), ("rocker", top + right + 0.5 * low, swing))
    places += (("coupler", top + 0.5 * right + low, {"velocity": (-2.0 * rate * BAR, 0.0, 0.0)}),)
    inertia = (1e-3, 2e-3, 2e-3)
    bodies = [RigidBody3D(name=name, mass=0.5, inertia=inertia, position=tuple(p), **how) for name, p, how in places]
    pins = ((None, top, "crank", -0.5 * low), ("crank", 0.5 * low, "coupler", -0.5 * right))
    pins += (("coupler", 0.5 * right, "rocker", 0.5 * low), (None, top + right, "rocker", -0.5 * low))
    return bodies, [Revolute3D(name=f"h{k}", a=at(*pin[:2]), b=at(*pin[2:])) for k, pin in enumerate(pins)]


def heap(count, law=None, loop=False, friction=0.4, gravity=(0.0, 0.0, -G)):
    """Spheres that fall into a box, nine in a layer; the last one has the force law in all its contacts."""
    rng = np.random.default_rng(0)
    radii, k = rng.uniform(0.03, 0.05, count), np.arange(count)
    places = np.stack([WIDTH * (k % 3 + 0.5) / 3, WIDTH * (k // 3 % 3 + 0.5) / 3, 0.08 + 0.13 * (k // 9)], axis=1)
    places += rng.uniform(-0.008, 0.008, (count, 3))
    bodies, spheres = [], []
    for i, (place, radius) in enumerate(zip(places, radii, strict=True)):
        mass = 8400.0 * radius**3
        inertia = (0.4 * mass * radius**2,) * 3
        bodies.append(RigidBody3D(name=f"s{i}", mass=mass, inertia=inertia, position=tuple(place)))
        spheres.append(Sphere3D(marker=Marker3D(body=f"s{i}"), radius=radius))
    turning = TurningFriction(rolling=1e-3, spinning=5e-4) if friction else None
    hard = len(spheres) - (law is not None)
    group = ContactGroup3D(
        name="heap", spheres=spheres[:hard], half_spaces=walls(), law=NewtonImpact(restitution=0.3, rest_ratio=1e-3),
        friction=CoulombFriction(coefficient=friction) if friction else None, turning=turning,
    )  # fmt: skip
    soft, joints = (), []
    if law is not None:
        rubs = BrownMcPheeFriction(coefficient=friction, transition_speed=1e-2) if friction else None
        soft = contacts_between("soft", spheres[hard:], [*spheres[:hard], *walls()], law=law, friction=rubs,
                                turning=turning)  # fmt: skip
    if loop:
        bars, joints = parallelogram()
        bodies += bars
    return Model(gravity=gravity, bodies=bodies, joints=joints, groups=[group], contacts=soft), 8400.0 * radii**3


def go_in_steps(sim, end, size=1.0, each=10):
    """Go to `end` (s) in steps of impulses of `size` times the usual step; rows that end begin again."""
    step, clock, t = size * SIZE * sim.scales.time, sim.clock, sim.t
    while t < end:
        if clock.push_step == 0.0:
            clock.push_step = clock.step_size = step
            clock.pushes = clock.pushes_left = 1e9
            clock.pushed_from = sim.t_internal
            sim.pending = [int(k) for k in np.flatnonzero(sim.memory.mode == CLOSED)]
        t = min(t + each * step, end)
        sim.advance(t)


def values(sim):
    return dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))


def energy(now):
    return now["energy.kinetic"] + now["energy.potential"] + now["energy.strain"]


def newest(sim):
    """Velocities and work accounts at the newest row."""
    n, row = sim.assembly.n_extended, sim.method_arrays["history"][sim.method_arrays["ring"][0]]
    return row[n : 2 * n]


def out_of_balance(sim, model, masses):
    """Momentum of the spheres less that of gravity and of the walls' impulses, N s, (3,)."""
    v, received = newest(sim), np.zeros(3)
    for k, (contact, info) in enumerate(zip(model.contacts, sim.assembly.contacts, strict=True)):
        if hasattr(contact, "plane"):
            normal = np.array(contact.plane.marker.attitude.z, dtype=float)
            received += normal * (v[info.impulse_account] + sim.memory.impulse_jump[k])
    momentum = masses @ v[: 7 * len(masses)].reshape(-1, 7)[:, :3]
    return momentum - masses.sum() * np.array(model.gravity) * sim.t_internal - received


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("law", "loop"), [("linear", False), ("stiff", False), ("hertz", False), (None, True)])
def test_momentum_is_that_of_gravity_and_walls(law, loop):
    """Without friction; each step adds what the impulses and forces of the walls say."""
    model, masses = heap(10, LAWS.get(law), loop, friction=0.0, gravity=(1.0, -2.0, -G))
    sim = Simulation(model, "ebdf", rtol=1e-8)
    sim.advance(0.25)
    before, made = out_of_balance(sim, model, masses), sim.stats["impulse_steps"]
    went = energy(values(sim))
    go_in_steps(sim, 0.3)
    assert sim.stats["impulse_steps"] - made > 200
    assert out_of_balance(sim, model, masses) == pytest.approx(before, abs=1e-10)
    assert energy(values(sim)) < went
    if loop:
        assert len(sim.workspace.dropped) == 3


@pytest.mark.sampled(1)
@pytest.mark.parametrize(("law", "loop"), [("hertz", False), ("linear", True)])
def test_a_heap_comes_to_rest(law, loop):
    """In nothing but such steps; the loop beside it swings on as it does alone."""
    model, masses = heap(8, LAWS[law], loop)
    sim, end = Simulation(model, "ebdf"), 1.2
    start = values(sim)
    sim.advance(0.14)
    go_in_steps(sim, end, 4.0)
    sim.advance(sim.t_internal)
    now = values(sim)
    speeds = newest(sim)[: 7 * len(masses)].reshape(-1, 7)[:, :3]
    assert np.abs(speeds).max() < 1e-3
    lost = now["energy.dissipation"] + now["energy.impact_loss"]
    assert lost == pytest.approx(energy(start) - energy(now), abs=1e-6 * lost)
    assert now["energy.balance"] == pytest.approx(0.0, abs=1e-6 * lost)
    assert max(now[f"residual.{level}"] for level in ("position", "velocity")) < 1e-10
    if loop:
        bars, joints = parallelogram()
        alone = Simulation(Model(gravity=(0.0, 0.0, -G), bodies=bars, joints=joints), "ebdf")
        alone.advance(sim.t)
        assert now["coupler.x"] == pytest.approx(values(alone)["coupler.x"], abs=1e-6)
        assert now["coupler.vx"] == pytest.approx(values(alone)["coupler.vx"], abs=1e-5)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("stiffness", [1e4, 1e6])
def test_a_block_rests_on_a_hard_and_a_soft_foot(stiffness):
    """In the plane: the soft foot is pressed in, which tilts the block, and carries a little more than half of the
    weight. Within a step it feels that the hard one is open: by as much as is proportional to the step."""
    body = RigidBody2D(name="block", mass=1.0, inertia=0.02, position=(0.0, 0.1 + 1e-5), angle=1e-5)
    feet = []
    for name, x, law in (
        ("hard", -0.2, NewtonImpact(restitution=0.0)),
        ("soft", 0.2, KelvinVoigt(stiffness=stiffness, damping=0.5 * math.sqrt(stiffness))),
    ):
        disk = Disk2D(marker=Marker2D(body="block", point=(x, -0.09)), radius=0.01)
        feet.append(DiskOnHalfPlane2D(name=name, plane=HalfPlane2D(), disk=disk, law=law))
    off = []
    for size in (1.0, 0.25):
        sim = Simulation(Model(gravity=(0.0, -G), bodies=[body], contacts=feet), "ebdf")
        start = values(sim)
        go_in_steps(sim, 1.0, size)
        sim.advance(sim.t_internal)
        now = values(sim)
        soft = G * (0.5 - 0.09 * math.tan(now["block.angle"]) / 0.4)
        assert now["hard.normal_force"] == pytest.approx(G - soft, rel=1e-5)
        off.append(abs(now["soft.normal_force"] - soft))
        assert now["soft.gap"] * stiffness == pytest.approx(-soft, abs=1.1 * off[-1])
        assert now["hard.gap"] == pytest.approx(0.0, abs=1e-12)
        lost = now["energy.dissipation"] + now["energy.impact_loss"]
        assert lost == pytest.approx(energy(start) - energy(now), rel=1e-6)
    assert off[0] < 0.02 * G
    assert off[1] < 0.3 * off[0]


@pytest.mark.full
def test_a_heap_that_crowds_comes_to_rest():
    """Twelve spheres, one of them soft, with a redundant loop beside them; the run chooses its steps by itself."""
    model, masses = heap(12, LAWS["hertz"], True)
    sim = Simulation(model, "ebdf")
    sim.advance(1.6)
    now = values(sim)
    lost = now["energy.dissipation"] + now["energy.impact_loss"]
    assert sim.stats["impulse_steps"] > 0
    assert np.abs(newest(sim)[: 7 * len(masses)]).max() < 1e-5
    assert now["energy.balance"] == pytest.approx(0.0, abs=1e-6 * lost)
