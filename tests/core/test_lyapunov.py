"""Lyapunov exponents and Floquet multipliers: closed forms, differences of neighbouring runs, invariance."""

import math

import numpy as np
import pytest
from tlismni.core import (
    AppliedTorque2D,
    CoulombFriction,
    EquationSystem,
    GapContact,
    Hertz,
    ModelError,
    NewtonImpact,
    SimulationError,
    Sine,
)
from tlismni.core.analysis import floquet_multipliers, lyapunov_exponents
from tlismni.models import load

TIGHT = {"rtol": 1e-11, "atol": 1e-13}


def driven_oscillator(damping_ratio, frequency, restitution, q0, v0):
    """x'' + 2 z x' + x = cos(w t) for x <= 0, as one equation."""

    def force(t, q, v):
        return np.array([np.cos(frequency * t) - 2.0 * damping_ratio * v[0] - q[0]])

    stop = GapContact("stop", lambda t, q: -q[0], NewtonImpact(restitution=restitution))
    return EquationSystem(np.eye(1), force, q0=[q0], v0=[v0], contacts=[stop])


class Oscillator:
    """The same in closed form between impacts, and its variational equation."""

    def __init__(self, z, w, r):
        self.z, self.w, self.r = z, w, r
        self.wd = math.sqrt(1.0 - z * z)
        self.response = 1.0 / complex(1.0 - w * w, 2.0 * z * w)

    def forced(self, t):
        x = self.response * np.exp(1j * self.w * t)
        return np.array([x.real, (1j * self.w * x).real])

    def flow(self, h):
        """Fundamental matrix over h."""
        c, s = math.cos(self.wd * h), math.sin(self.wd * h) / self.wd
        return math.exp(-self.z * h) * np.array([[c + self.z * s, s], [-s, c - self.z * s]])

    def move(self, t, x, h):
        return self.flow(h) @ (x - self.forced(t)) + self.forced(t + h)

    def to_impact(self, t, x, step=0.01):
        """Time until x = 0 from below, found by bisection."""
        low = step if x[0] > -1e-12 else 0.0
        while self.move(t, x, low + step)[0] < 0.0:
            low += step
        high = low + step
        for _ in range(60):
            middle = 0.5 * (low + high)
            low, high = (middle, high) if self.move(t, x, middle)[0] < 0.0 else (low, middle)
        return 0.5 * (low + high)

    def saltation(self, t, v):
        """For v+ = -r v- at a fixed x: [[-r, 0], [(a+ + r a-)/v-, -r]]."""
        before = math.cos(self.w * t) - 2.0 * self.z * v
        after = math.cos(self.w * t) + 2.0 * self.z * self.r * v
        return np.array([[-self.r, 0.0], [(after + self.r * before) / v, -self.r]])

    def fundamental(self, t, x, end):
        """(fundamental matrix up to `end`, impacts)."""
        y, impacts = np.eye(2), 0
        x = np.array(x, dtype=float)
        while True:
            h = self.to_impact(t, x)
            if t + h > end:
                return self.flow(end - t) @ y, impacts
            x = self.move(t, x, h)
            t += h
            y = self.saltation(t, x[1]) @ self.flow(h) @ y
            x = np.array([0.0, -self.r * x[1]])
            impacts += 1


# ---- without impacts -------------------------------------------------------------------------------------------------


def test_damped_oscillator_has_the_real_parts_of_its_eigenvalues():
    """Over whole half periods the fundamental matrix of a complex pair is a multiple of the identity."""
    z = 0.1
    period = 2.0 * math.pi / math.sqrt(1.0 - z * z)
    system = EquationSystem(np.eye(1), lambda t, q, v: np.array([-2.0 * z * v[0] - q[0]]), q0=[1.0], v0=[0.0])
    found = lyapunov_exponents(system, 10.0 * period)
    assert found.exponents == pytest.approx([-z, -z], abs=1e-8)
    assert abs(found.sum_residual) < 1e-8


def test_coupled_oscillators_have_the_real_parts_of_their_eigenvalues():
    mass = np.array([[2.0, 0.3], [0.3, 1.0]])
    stiffness = np.array([[5.0, -2.0], [-2.0, 3.0]])
    damping = np.array([[0.4, 0.1], [-0.2, 3.0]])
    system = EquationSystem(
        mass, lambda t, q, v: -stiffness @ q - damping @ v + np.array([0.0, np.sin(t)]), q0=[1.0, 0.0], v0=[0.0, 1.0]
    )
    lower = -np.linalg.solve(mass, np.hstack([stiffness, damping]))
    matrix = np.vstack([np.hstack([np.zeros((2, 2)), np.eye(2)]), lower])
    real = np.sort(np.linalg.eigvals(matrix).real)[::-1]
    found = floquet_multipliers(system, 3.0)
    assert found.exponents == pytest.approx(real, abs=1e-8)
    assert lyapunov_exponents(system, 20.0).volume_rate == pytest.approx(np.sum(real), abs=1e-8)


def test_pendulum_in_absolute_coordinates_has_the_exponents_of_one_angle():
    """A driven rod between two stops. Lengths are those of the kinetic energy, which knows no coordinates: the
    estimates agree after any time, not only their limits."""

    def torque(t):
        return 6.0 * np.sin(2.0 * t)

    def force(t, q, v):
        return np.array([torque(t) - 4.905 * np.cos(q[0])])

    stop = GapContact("stop", lambda t, q: np.sin(q[0] + 1.0), NewtonImpact(restitution=0.8))
    angle = EquationSystem(np.array([[1.0 / 3.0]]), force, q0=[0.0], v0=[0.0], contacts=[stop])
    model = load("pendulum_stop", stop_angle=-1.0, restitution=0.8, driven=False).model
    drive = AppliedTorque2D(name="drive", body="pendulum", torque=Sine(amplitude=6.0, angular_frequency=2.0))
    model = model.model_copy(update={"forces": (drive,)})
    found = [lyapunov_exponents(system, 5.0, rtol=1e-10, atol=1e-12) for system in (model, angle)]
    assert found[0].impacts == found[1].impacts > 3
    assert found[0].exponents == pytest.approx(found[1].exponents, abs=1e-6)
    assert max(abs(f.sum_residual) for f in found) < 1e-9


# ---- impacts ---------------------------------------------------------------------------------------------------------


def test_stable_orbit_of_the_impact_oscillator():
    z, w, r = 0.02, 2.0, 0.8
    period, after = 2.0 * math.pi / w, 1.0
    t0 = 0.7742709267 + after
    x, v = Oscillator(z, w, r).move(t0 - after, np.array([0.0, -4.1567220979]), after)
    system = load("impact_oscillator", damping_ratio=z, frequency=w, start_position=x, start_velocity=v).model
    found = floquet_multipliers(system, period, t0=t0)
    assert found.impacts == 1
    assert found.closure < 1e-8
    assert found.multipliers == pytest.approx([0.75307082, 0.74949563], abs=2e-8)
    assert found.exponents == pytest.approx([-0.0902714, -0.0917862], abs=1e-6)
    run = lyapunov_exponents(system, t0 + 20.0 * period, t0=t0)
    assert run.impacts == 20
    assert run.volume_rate == pytest.approx(-2.0 * z + 2.0 * math.log(r) / period, abs=1e-9)
    assert abs(run.sum_residual) < 1e-9


def test_unstable_orbit_of_the_impact_oscillator():
    z, w, r, after = 0.05, 2.8, 0.8, 1.0
    t0 = 1.0662655684 + after
    x, v = Oscillator(z, w, r).move(t0 - after, np.array([0.0, -0.2675857055]), after)
    found = floquet_multipliers(driven_oscillator(z, w, r, x, v), 2.0 * math.pi / w, t0=t0)
    assert found.multipliers == pytest.approx([-2.646309, -0.193234], rel=1e-5)


def test_chaotic_impact_oscillator_follows_the_closed_form():
    """The fundamental matrix over 30 s, in which differences grow by a factor of 400."""
    z, w, r, end = 0.05, 2.8, 0.8, 30.0
    # "multipliers" of a motion that is not periodic are the eigenvalues of the same matrix
    found = floquet_multipliers(load("impact_oscillator").model, end, rtol=1e-12, atol=1e-14)
    expected, impacts = Oscillator(z, w, r).fundamental(0.0, (-0.5, 0.0), end)
    assert found.impacts == impacts > 10
    assert found.multipliers[0].real == pytest.approx(np.trace(expected), rel=1e-5)  # the other is 1e-7


def test_chaotic_impact_oscillator_has_the_known_exponents():
    """+0.1576 and -0.4759 (closed form over 3 million impacts, benchmarks/lyapunov_reference.py): within the error that
    the run gives for itself. The sum follows from the impacts counted."""
    z, r, end = 0.05, 0.8, 900.0
    found = lyapunov_exponents(load("impact_oscillator").model, end, rtol=1e-6, transient=30.0)
    assert np.max(found.errors) < 0.03
    assert np.all(np.abs(found.exponents - [0.1576, -0.4759]) < 3.0 * found.errors)
    expected = -2.0 * z + 2.0 * math.log(r) * found.impacts / (end - 30.0)
    assert np.sum(found.exponents) == pytest.approx(expected, abs=1e-6)
    assert found.kaplan_yorke_dimension == pytest.approx(1.0 - found.exponents[0] / found.exponents[1])


def test_closed_contact_carries_its_share_of_an_impact_like_a_joint():
    """The impact oscillator on a floor, against an overhanging stop that also presses it onto the floor."""
    z, w, r, c, s = 0.05, 2.8, 0.8, math.cos(0.4), math.sin(0.4)

    def force(t, q, v):
        return np.array([np.cos(w * t) - 2.0 * z * v[0] - q[0], -9.81])

    contacts = [
        GapContact("floor", lambda t, q: q[1], NewtonImpact(restitution=0.5)),
        GapContact("stop", lambda t, q: -c * q[0] - s * q[1], NewtonImpact(restitution=r)),
    ]
    on_floor = EquationSystem(np.eye(2), force, q0=[-0.5, 0.0], v0=[0.0, 0.0], contacts=contacts)
    found = lyapunov_exponents(on_floor, 9.0, rtol=1e-9, atol=1e-11)
    expected = lyapunov_exponents(driven_oscillator(z, w, r, -0.5, 0.0), 9.0, rtol=1e-9, atol=1e-11)
    assert found.impacts == expected.impacts > 3
    assert found.exponents == pytest.approx(expected.exponents, abs=1e-6)


def test_resting_contact_leaves_the_exponents_of_the_constrained_motion():
    """A ball that bounces to rest keeps the two exponents of its motion along the floor."""
    c, k, m = 0.4, 2.0, 1.0
    floor = GapContact("floor", lambda t, q: q[1], NewtonImpact(restitution=0.3))
    system = EquationSystem(
        m * np.eye(2), lambda t, q, v: np.array([-k * q[0] - c * v[0], -9.81]), q0=[1.0, 0.1], v0=[0.0, 0.0],
        contacts=[floor],
    )  # fmt: skip
    half = math.pi / math.sqrt(k / m - (0.5 * c / m) ** 2)
    found = lyapunov_exponents(system, 1.0 + 6.0 * half, transient=1.0)
    assert found.exponents[:2] == pytest.approx([-0.5 * c / m] * 2, abs=1e-7)
    assert np.all(np.isneginf(found.exponents[2:]))


# ---- parts -----------------------------------------------------------------------------------------------------------


def test_methods_agree():
    model = load("impact_oscillator").model
    found = [lyapunov_exponents(model, 6.0, method, rtol=1e-10, atol=1e-12).exponents for method in ("irk", "ebdf")]
    assert found[0] == pytest.approx(found[1], abs=1e-6)


def test_few_exponents_are_the_first_of_all():
    model = load("impact_oscillator").model
    few, everything = (lyapunov_exponents(model, 40.0, transient=10.0, count=count) for count in (1, None))
    assert few.exponents == pytest.approx(everything.exponents[:1], abs=0.1)
    assert math.isnan(few.sum_residual) and len(few.exponents) == 1


# ---- refusals --------------------------------------------------------------------------------------------------------


def two_balls_on_two_floors(offset=0.0):
    def force(t, q, v):
        return np.array([-9.81, -9.81])

    floors = [GapContact(f"floor{k}", lambda t, q, k=k: q[k], NewtonImpact(restitution=0.5)) for k in range(2)]
    return EquationSystem(np.eye(2), force, q0=[1.0, 1.0 + offset], v0=[0.0, 0.0], contacts=floors)


def test_contacts_that_strike_at_one_instant_are_refused():
    with pytest.raises(SimulationError, match=r"'floor0', 'floor1'.*strike at one instant"):
        lyapunov_exponents(two_balls_on_two_floors(), 0.6)
    assert lyapunov_exponents(two_balls_on_two_floors(0.01), 0.6).impacts == 2


@pytest.mark.parametrize(
    "arguments, text",
    [
        ({"t_end": 1.0, "transient": 2.0}, "the transient must"),
        ({"t_end": math.inf}, "t_end must be a finite number"),
        ({"t_end": 1.0, "count": 3}, "3 exponents are asked for; the state has 2 dimensions"),
        ({"t_end": 1.0, "samples": 0}, "samples"),
        ({"t_end": 1.0, "method": "baumgarte"}, "does not meet the constraints at all levels"),
    ],
)
def test_bad_arguments(arguments, text):
    with pytest.raises(ModelError, match=text):
        lyapunov_exponents(load("impact_oscillator").model, **arguments)


def test_friction_is_refused():
    model = load("pendulum_stop").model
    rough = model.contacts[0].model_copy(update={"friction": CoulombFriction(coefficient=0.1)})
    with pytest.raises(ModelError, match="'stop' has friction"):
        lyapunov_exponents(model.model_copy(update={"contacts": (rough,)}), 1.0)


def test_contacts_that_are_forces_are_refused():
    stop = GapContact("stop", lambda t, q: -q[0], Hertz(stiffness=1e5))
    system = EquationSystem(np.eye(1), lambda t, q, v: -q, q0=[-1.0], v0=[0.0], contacts=[stop])
    with pytest.raises(ModelError, match="'stop' has the law Hertz"):
        lyapunov_exponents(system, 1.0)
    with pytest.raises(ModelError, match="period must be a positive number"):
        floquet_multipliers(system, -1.0)
