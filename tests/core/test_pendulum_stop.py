"""The pendulum against a stop (contact as constraint) and an independent solution in the angle alone."""

import math

import numpy as np
import pytest
from helpers import G, events, residuals
from scipy.integrate import solve_ivp
from tlismni.core import simulate
from tlismni.models import load

E = 0.7
STOP = -math.pi / 2
T_END = 3.0


def segments(t_end=T_END, e=E):
    """Impact times and one solution (angle, rate) for each flight of theta'' = -(3 g / 2 L) cos(theta)."""

    def rhs(t, y):
        return [y[1], -1.5 * G * math.cos(y[0])]

    def touch(t, y):
        return y[0] - STOP

    touch.terminal, touch.direction = True, -1.0
    t, y, impacts, flights = 0.0, [0.0, 0.0], [], []
    while True:
        flight = solve_ivp(
            rhs, (t, t_end), y, "DOP853", events=touch, dense_output=True, rtol=1e-13, atol=1e-13, max_step=0.02
        )
        flights.append(flight.sol)
        if flight.status != 1:
            return impacts, flights
        t = flight.t_events[0][0]
        y = [STOP, -e * flight.y_events[0][0][1]]
        impacts.append(t)


IMPACTS, FLIGHTS = segments()


def reference(t, flight):
    """q, v of the rod from the angle; `flight` numbers the flights."""
    angle, rate = np.array([FLIGHTS[k](x) for x, k in zip(t, flight, strict=True)]).T
    q = np.stack([0.5 * np.cos(angle), 0.5 * np.sin(angle), angle], axis=1)
    v = np.stack([-0.5 * np.sin(angle) * rate, 0.5 * np.cos(angle) * rate, rate], axis=1)
    return q, v


@pytest.fixture(scope="module")
def model():
    return load("pendulum_stop", restitution=E, driven=False).model


@pytest.fixture(scope="module")
def run(model):
    return simulate(model, T_END, "ebdf", rtol=1e-10, atol=1e-12)


def test_state_follows_the_minimal_coordinate_solution_through_three_impacts(run):
    assert len(IMPACTS) >= 3
    flight = np.concatenate([[0], np.cumsum(np.diff(run.t) == 0.0)])  # before and after an impact: the same time
    assert flight[-1] == len(IMPACTS)
    q, v = reference(run.t, flight)
    assert np.abs(run.q - q).max() < 1e-8
    assert np.abs(run.v - v).max() < 1e-8


def test_state_at_given_times_follows_the_minimal_coordinate_solution(model):
    times = np.linspace(0.0, T_END, 211)
    result = simulate(model, T_END, "ebdf", rtol=1e-10, atol=1e-12, t_eval=times)
    assert np.array_equal(result.t, times)
    q, v = reference(times, np.searchsorted(IMPACTS, times))
    assert np.abs(result.q - q).max() < 1e-8
    assert np.abs(result.v - v).max() < 1e-8
    assert max(residuals(result)) < 1e-10


@pytest.mark.parametrize("method, options", [("irk", {}), ("bdf", {"order": 5}), ("ebdf", {"k": 2})])
def test_other_methods_agree_within_their_error_control(model, method, options):
    times = np.linspace(0.0, T_END, 31)
    result = simulate(model, T_END, method, rtol=1e-9, atol=1e-11, t_eval=times, **options)
    q, v = reference(times, np.searchsorted(IMPACTS, times))
    assert np.abs(result.q - q).max() < 1e-6
    assert np.abs(result.v - v).max() < 1e-5


def test_impact_times_are_those_of_the_minimal_coordinate_solution(run):
    times = [event.t for event in events(run, "impact")]
    assert np.abs(np.array(times) - IMPACTS).max() < 1e-9


def test_constraints_hold_at_every_level_at_every_recorded_time(run):
    assert max(residuals(run)) < 1e-10
    # the channels are not merely zero: recompute the levels from the recorded q, v, a
    x, y, angle = run.q.T
    vx, vy, rate = run.v.T
    ax, ay, alpha = run.a.T
    c, s = 0.5 * np.cos(angle), 0.5 * np.sin(angle)
    assert max(np.abs(x - c).max(), np.abs(y - s).max()) < 1e-10
    assert max(np.abs(vx + s * rate).max(), np.abs(vy - c * rate).max()) < 1e-10
    assert np.abs(ax + s * alpha + c * rate**2).max() < 1e-10
    assert np.abs(ay - c * alpha + s * rate**2).max() < 1e-10


def test_recorded_accelerations_satisfy_the_equations_of_motion(run):
    """alpha = -(3 g / 2 L) cos(angle); the joint force is what Newton's law leaves over."""
    assert np.abs(run["pendulum.angular_acceleration"] + 1.5 * G * np.cos(run["pendulum.angle"])).max() < 1e-8
    assert np.abs(run["pin.force_x"] - run["pendulum.ax"]).max() < 1e-8
    assert np.abs(run["pin.force_y"] - (run["pendulum.ay"] + G)).max() < 1e-8


def test_impulse_is_that_of_newtons_impact_at_the_tip(run):
    """P = (1 + e) J_O |rate| / L with J_O = m L^2 / 3; velocity-increment level of the pin included."""
    rates = []
    for k, event in enumerate(events(run, "impact")):
        rate = -FLIGHTS[k](IMPACTS[k])[1]
        rates.append(rate)
        assert event.approach_speed == pytest.approx(rate, rel=1e-8)
        assert event.separation_speed == pytest.approx(E * rate, rel=1e-8)
        assert event.impulse == pytest.approx((1.0 + E) * rate / 3.0, rel=1e-8)
        assert event.energy_loss == pytest.approx(0.5 * (1.0 - E**2) * rate**2 / 3.0, rel=1e-8)
        assert event.velocity_increment_residual < 1e-12
    assert rates[0] == pytest.approx(math.sqrt(3.0 * G), rel=1e-12)


def test_velocity_jumps_as_recorded_before_and_after_the_impact(run):
    (first, *_) = np.flatnonzero(np.diff(run.t) == 0.0)
    before, after = run.v[first], run.v[first + 1]
    assert np.array_equal(run.q[first], run.q[first + 1])
    assert after == pytest.approx(-E * before, abs=1e-9)
    assert abs(run["stop.gap"][first]) < 1e-14


def test_gap_never_goes_negative(run):
    assert run["stop.gap"].min() > -1e-14


def test_pendulum_comes_to_rest_at_the_stop_on_the_accumulation_point():
    """Near the stop the motion is almost a free flight with the gap's acceleration g_eff: the impacts accumulate.
    Held against the stop beyond the vertical, the pin and the stop carry the static load."""
    scenario = load("pendulum_stop", restitution=0.4, stop_angle=-0.5, driven=False)
    result = simulate(scenario.model, 3.0, rtol=1e-8, atol=1e-11)
    (rest,) = events(result, "rest")
    after = result.t > rest.t
    # moments about the pin: the stop's force, normal to the rod at its tip, carries m g (L/2) cos(angle)
    assert result["stop.normal_force"][after] == pytest.approx(0.5 * G * math.cos(0.5), rel=1e-10)
    assert np.abs(result.v[after]).max() < 1e-12
    assert np.abs(result["stop.gap"][after]).max() < 1e-12
    assert max(residuals(result)) < 1e-10
