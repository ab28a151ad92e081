"""Positions in which constraints depend on one another only there: refused at a start, passed by a run."""

import math

import numpy as np
import pytest
from helpers import G, on, pendulum_angles, residuals
from linkages import four_bar, slider_crank, stiffness
from tlismni.core import (
    ConsistencyError,
    EquationSystem,
    Marker3D,
    Model,
    RigidBody3D,
    Simulation,
    SimulationError,
    Spherical3D,
    simulate,
)

# IFToMM benchmark A02, two loops, at t = 10 s: the upper end of the first crank
A02_END = np.array([0.328458111533, 0.944518538181])


def crank_end(result):
    angle = result["v0.angle"][-1]
    return np.array([math.cos(angle), math.sin(angle)])


def passages(angles, every=math.pi, offset=0.0):
    """How often the angle has passed offset + k * every."""
    return int(np.sum(np.abs(np.diff(np.floor((angles - offset) / every)))))


@pytest.mark.parametrize("theta", [0.0, 1e-9, 1e-7, math.pi])
def test_start_in_a_singular_position_is_refused(theta):
    with pytest.raises(ConsistencyError, match=r"singular position: only here, .*'b0'.*'c0'.*Start a little before"):
        simulate(four_bar(1, theta), 1.0)


def test_singular_start_of_own_equations():
    """Two lines through the origin: x y = 0."""
    system = EquationSystem(
        mass=np.eye(2), force=np.zeros(2), constraint=lambda t, q: q[0] * q[1], q0=[0.0, 0.0], v0=[1.0, 0.0]
    )
    with pytest.raises(ConsistencyError, match=r"singular position: only here, 'constraint\[0\]'"):
        simulate(system, 1.0)


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "method, rtol, error, drift",
    [
        ("ebdf", 1e-11, 1e-6, 1e-7),
        ("mebdf", 1e-11, 1e-6, 1e-7),
        ("irk", 1e-11, 1e-6, 1e-7),
        ("ebdf", 1e-6, 1e-3, 1e-5),
        ("mebdf", 1e-6, 1e-3, 1e-5),
        ("irk", 1e-6, 1e-3, 1e-5),
        ("hht", 1e-6, 1e-2, 1e-3),
        ("bdf", 1e-6, 1e-2, 1e-3),
        ("ebdf", 1e-4, 5e-2, 1e-3),
    ],
)
def test_a02_passes_its_singular_positions(method, rtol, error, drift):
    result = simulate(four_bar(), 10.0, method, rtol, 0.1 * rtol)
    assert passages(result["v0.angle"]) >= 10
    assert np.abs(crank_end(result) - A02_END).max() < error
    energy = 2.5 + G * (3 * 0.5 + 2 * 1.0)
    assert np.abs(result["energy.balance"]).max() < drift * energy
    # on the branch of the parallelograms: the couplers never turn
    assert max(np.abs(result["h0.angle"]).max(), np.abs(result["h1.angle"]).max()) < 1e-8
    # the angle is 28 rad at the end: rounding of the constraints is relative to that
    assert residuals(result)[0] < 1e-10


@pytest.mark.sampled(3)
@pytest.mark.parametrize("method", ["ebdf", "irk"])
@pytest.mark.parametrize("rate", [-5.5, -6.1, -7.3, 8.0, -9.7])
def test_parallelogram_passes_at_any_phase(method, rate):
    """Full turns at several speeds; each passage meets the grid of steps at another phase."""
    result = simulate(four_bar(1, 1.1, rate), 6.0, method, 1e-7, 1e-9)
    angles = result["v0.angle"]
    assert passages(angles) >= 8
    assert angles[-1] == pytest.approx(pendulum_angles([6.0], 1.1, rate, stiffness(2, 1))[0][0], abs=2e-3)
    assert np.abs(result["h0.angle"]).max() < 1e-8
    assert residuals(result)[0] < 1e-10
    assert np.abs(result["energy.balance"]).max() < 2e-4


def test_steps_of_any_size_pass():
    """max_step varied: the singular position falls everywhere in a step."""
    passed = 0
    for k in range(12):
        result = simulate(four_bar(1, 1.1, -6.0), 1.5, rtol=1e-6, atol=1e-8, max_step=0.01 + 0.0013 * k)
        passed += passages(result["v0.angle"])
        assert np.abs(result["h0.angle"]).max() < 1e-8
    assert passed >= 24


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method", ["ebdf", "mebdf", "irk"])
def test_slider_crank_with_rod_as_long_as_its_crank(method):
    """Singular with the slider on the pin (theta = +-90 degrees): it must go through, x = 2 r cos(theta), and not stay
    there while crank and rod turn together. Energy gives the rate: T = I(theta) theta'^2 / 2."""
    result = simulate(slider_crank(0.3, 4.0, 0.5, 0.5), 14.0, method, 1e-8, 1e-10)
    theta = result["crank.angle"]
    assert passages(theta, math.pi, math.pi / 2) >= 10
    assert result["slider.x"] == pytest.approx(np.cos(theta), abs=1e-8)
    assert result["rod.angle"] == pytest.approx(-theta, abs=1e-8)
    kinetic = result["energy.kinetic"]
    assert kinetic == pytest.approx(kinetic[0], rel=1e-6)
    # m r^2/3 for the crank; rod: centre at (1.5 r cos, 0.5 r sin), turning at -theta'; slider at 2 r cos
    r, s2, c2 = 0.5, np.sin(theta) ** 2, np.cos(theta) ** 2
    inertia = r**2 / 3.0 + r**2 * (2.25 * s2 + 0.25 * c2) + r**2 / 12.0 + 4.0 * r**2 * s2
    assert 0.5 * inertia * result["crank.angular_velocity"] ** 2 == pytest.approx(kinetic[0], rel=1e-5)
    assert residuals(result)[0] < 1e-10


def test_samples_between_steps_are_smooth_through_the_position():
    """Densely sampled around a passage: accelerations and multipliers do not show the rounding that the singular
    matrix would multiply."""
    plain = simulate(four_bar(1, 1.1, -6.0), 0.4, rtol=1e-8, atol=1e-10)
    angle, t = plain["v0.angle"], plain.t
    k = int(np.argmax(angle < 0.0))
    crossing = float(np.interp(0.0, -angle[k - 1 : k + 1], t[k - 1 : k + 1]))
    sim = Simulation(four_bar(1, 1.1, -6.0), rtol=1e-8, atol=1e-10)
    times = crossing + np.concatenate([-np.logspace(-3, -9, 13), np.logspace(-9, -3, 13)])
    rows = []
    for time in times:
        sim.advance(float(time))
        rows.append(sim.sample())
    rows = np.array(rows)
    a = rows[:, sim.table.layout.a]
    lam = rows[:, sim.table.layout.multipliers]
    for values, size in ((a, np.abs(a).max()), (lam, np.abs(lam).max())):
        line = np.polynomial.Polynomial.fit(times - crossing, values[:, 0], 2)
        assert np.abs(values[:, 0] - line(times - crossing)).max() < 1e-3 * size
        assert np.abs(np.diff(values, axis=0)).max() < 0.05 * size
    # the crank's angle has its own equation
    angles, rates = rows[:, 1 + 2], rows[:, sim.table.layout.v][:, 2]
    assert rates == pytest.approx(-np.sqrt(36.0 + 2.0 * stiffness(2, 1) * (math.sin(1.1) - np.sin(angles))), rel=1e-6)


def test_state_near_a_singular_position_goes_on_bit_for_bit():
    def build():
        return Simulation(four_bar(1, 1.1, -6.0), rtol=1e-10, atol=1e-12)

    plain = simulate(four_bar(1, 1.1, -6.0), 0.4, rtol=1e-10, atol=1e-12)
    before = float(plain.t[int(np.argmax(plain["v0.angle"] < 0.01))])
    sim = build()
    sim.advance(before)
    state = sim.state()
    sim.advance(before + 0.2)
    other = build()
    other.restore(state)
    other.advance(before + 0.2)
    assert other.sample().tobytes() == sim.sample().tobytes()


def test_linkage_that_only_comes_near_is_not_mistaken():
    """A four-bar whose coupler is 2 % longer than its base: it never has all bars in line; all residuals and the
    energy hold, and two methods with different steps agree."""
    model = four_bar(1, 1.1, -6.0)
    bodies = list(model.bodies)
    # longer coupler: q0 from the loop's closure by Newton on the two angles
    length = 1.02
    theta, phi, psi = 1.1, 0.0, 1.1
    for _ in range(30):
        f = np.array(
            [
                math.cos(theta) + length * math.cos(phi) - 1.0 - math.cos(psi),
                math.sin(theta) + length * math.sin(phi) - math.sin(psi),
            ]
        )
        jac = np.array([[-length * math.sin(phi), math.sin(psi)], [length * math.cos(phi), -math.cos(psi)]])
        dphi, dpsi = np.linalg.solve(jac, -f)
        phi, psi = phi + dphi, psi + dpsi
    tip = np.array([math.cos(theta), math.sin(theta)])
    place = {
        "v0": ((0.5 * tip[0], 0.5 * tip[1]), theta),
        "v1": ((1.0 + 0.5 * math.cos(psi), 0.5 * math.sin(psi)), psi),
        "h0": ((tip[0] + 0.5 * length * math.cos(phi), tip[1] + 0.5 * length * math.sin(phi)), phi),
    }
    bodies = [
        b.model_copy(
            update={
                "position": place[b.name][0],
                "angle": place[b.name][1],
                "velocity": (0.0, 0.0),
                "angular_velocity": 0.0,
            }
        )
        for b in bodies
    ]
    joints = [
        j.model_copy(update={"b": on("h0", math.copysign(0.5 * length, j.b.point[0]))}) if j.b.body == "h0" else j
        for j in model.joints
    ]
    near = model.model_copy(update={"bodies": tuple(bodies), "joints": tuple(joints)})
    runs = [simulate(near, 3.0, method, 1e-9, 1e-11) for method in ("ebdf", "irk")]
    for result in runs:
        assert residuals(result)[0] < 1e-10
        assert np.abs(result["energy.balance"]).max() < 1e-6
    assert runs[0].q[-1] == pytest.approx(runs[1].q[-1], abs=1e-5)


def test_long_chain_that_bends_is_not_looked_at(monkeypatch):
    """The move of least mass that mends its rows grows to 27 times what it was, the smallest one does not. A look for
    a singular position takes minutes with so many rods."""

    def looked(*_):
        raise AssertionError("a singular position was looked for")

    monkeypatch.setattr("tlismni.core.recovery.singular_passage.find_singular", looked)
    bodies, joints = [], []
    for k in range(1000):
        body = RigidBody3D(name=f"rod{k}", mass=1.0, inertia=(0.00125, 0.084, 0.084), position=(k + 0.5, 0.0, 0.0))
        place = (float(k), 0.0, 0.0)
        before = bodies[-1].marker_at(place) if bodies else Marker3D()
        joints.append(Spherical3D(name=f"ball{k}", a=before, b=body.marker_at(place)))
        bodies.append(body)
    simulation = Simulation(
        Model(gravity=(0.0, 0.0, -G), bodies=bodies, joints=joints), "adams", 1e-10, 1e-12, record=False, order=8
    )
    simulation.run_to(0.06)
    assert simulation.stats["steps"] > 20


def test_fixed_steps_that_cannot_pass_say_why():
    """A grid that meets the position exactly: the end of a step is singular."""
    angle, rate = 0.05, -1.0
    system = four_bar(1, angle, rate, gravity=0.0)
    with pytest.raises(SimulationError, match=r"singular position.*step=None"):
        simulate(system, 0.1, "hht", step=0.05 / 4)
