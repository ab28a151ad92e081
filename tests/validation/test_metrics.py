"""Metrics against data whose answer is known in closed form."""

import math

import numpy as np
import pytest
from tlismni.validation.metrics import (
    contact_intervals,
    crossing,
    hermite,
    impulse,
    peak,
    power_limit,
    richardson,
    trajectory_difference,
)


def half_sine_contact(start: float, duration: float, depth: float, samples: int):  # type: ignore[no-untyped-def]
    """Free approach, half a sine of penetration, free departure, as a linear contact has it."""
    t = np.linspace(0.0, 1.0, samples)
    w = math.pi / duration
    s = t - start
    inside = (s >= 0.0) & (s <= duration)
    speed = depth * w
    gap = np.where(inside, -depth * np.sin(w * s), np.where(s < 0.0, -speed * s, speed * (s - duration)))
    rate = np.where(inside, -speed * np.cos(w * s), np.where(s < 0.0, -speed, speed))
    return t, gap, rate


def test_contact_interval_is_located_between_the_samples() -> None:
    t, gap, rate = half_sine_contact(0.3017, 0.0513, 1e-3, 2001)
    (contact,) = contact_intervals(t, gap, rate)
    assert contact.start == pytest.approx(0.3017, abs=1e-7)
    assert contact.duration == pytest.approx(0.0513, abs=1e-7)
    assert gap[contact.first] < 0.0 <= gap[contact.first - 1]
    assert gap[contact.last] < 0.0 <= gap[contact.last + 1]


def test_contacts_that_are_open_at_the_end_or_closed_at_the_start() -> None:
    t = np.linspace(0.0, 2.0 * math.pi, 400)
    contacts = contact_intervals(t, np.sin(t + 4.0), np.cos(t + 4.0))
    assert [c.end is None for c in contacts] == [False, True] or len(contacts) == 1
    assert contacts[0].start == 0.0
    assert contacts[0].end == pytest.approx(2.0 * math.pi - 4.0, abs=1e-6)
    assert contact_intervals(t, 1.0 + 0.0 * t, 0.0 * t) == []


def test_peak_and_impulse_of_a_half_sine() -> None:
    t, gap, rate = half_sine_contact(0.3017, 0.0513, 1e-3, 4001)
    force = np.maximum(0.0, -1e6 * gap)
    (contact,) = contact_intervals(t, gap, rate)
    at, value = peak(t, force)
    assert at == pytest.approx(0.3017 + 0.5 * 0.0513, abs=1e-6)
    assert value == pytest.approx(1000.0, rel=1e-7)
    assert impulse(t, force, contact) == pytest.approx(1000.0 * 2.0 * 0.0513 / math.pi, rel=2e-5)


def test_impulse_of_a_force_that_jumps_at_first_touch() -> None:
    t, gap, rate = half_sine_contact(0.30171, 0.0513, 1e-3, 4001)
    k, c = 1e6, 2e3
    force = np.where(gap < 0.0, np.maximum(0.0, -k * gap - c * rate), 0.0)
    (contact,) = contact_intervals(t, gap, rate)
    w = math.pi / 0.0513
    release = (math.pi - math.atan(c * w / k)) / w  # k sin + c w cos = 0
    exact = 1e-3 * (k / w * (1.0 - math.cos(w * release)) + c * math.sin(w * release))
    assert impulse(t, force, contact) == pytest.approx(exact, rel=3e-5)


def test_hermite_is_exact_for_cubics_and_takes_the_later_of_two_records() -> None:
    t = np.array([0.0, 0.7, 1.0, 2.0])
    at = np.linspace(0.0, 2.0, 23)
    assert np.allclose(hermite(t, t**3 - t, 3.0 * t**2 - 1.0, at), at**3 - at)
    t = np.array([0.0, 1.0, 1.0, 2.0])
    y, rate = np.array([1.0, 0.0, 0.0, 1.0]), np.array([-1.0, -1.0, 1.0, 1.0])
    assert np.allclose(hermite(t, y, rate, np.array([0.5, 1.0, 1.5, 2.0])), [0.5, 0.0, 0.5, 1.0])
    with pytest.raises(ValueError, match="outside"):
        hermite(t, y, rate, np.array([2.1]))


def test_crossing_of_a_parabola_is_exact() -> None:
    t = np.array([0.0, 1.0])
    assert crossing(t, t**2 - 0.5, 2.0 * t, 0) == pytest.approx(math.sqrt(0.5), abs=1e-15)
    with pytest.raises(ValueError, match="no change of sign"):
        crossing(t, 1.0 + t, 0.0 * t, 0)


def test_trajectory_difference() -> None:
    t = np.linspace(0.0, 1.0, 101)
    found = trajectory_difference(t, np.sin(t) + 0.01 * t, np.sin(t))
    assert found.maximum == pytest.approx(0.01)
    assert found.at == 1.0
    assert found.relative == pytest.approx(0.01 / (0.5 * math.sin(1.0)))
    assert trajectory_difference(t, t, 0.0 * t, t < 0.5).maximum < 0.5
    with pytest.raises(ValueError, match="no time left"):
        trajectory_difference(t, t, t, t > 2.0)


def test_richardson_removes_the_leading_error() -> None:
    h = np.array([0.1, 0.05])
    values = 2.0 + 3.0 * h**2
    limit, error = richardson(values[0], values[1])
    assert limit == pytest.approx(2.0)
    assert error == pytest.approx(abs(values[1] - 2.0))


def test_power_limit_is_exact_for_parabolas() -> None:
    x = np.array([0.1, 0.4, 0.2])
    values = np.stack([1.0 + 2.0 * x + 3.0 * x**2, 5.0 - x], axis=1)
    limit, uncertainty = power_limit(x, values)
    assert np.allclose(limit, [1.0, 5.0])
    assert uncertainty[1] == pytest.approx(0.0, abs=1e-14)
    with pytest.raises(ValueError, match="three different"):
        power_limit(np.array([1.0, 1.0, 2.0]), values)
