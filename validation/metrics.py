"""Quantities of impacts and trajectories from sampled channels: pure functions of (t, y) arrays.

Times in s; `rate` is the time derivative of `gap` or `y` at the same samples. With rates, values between
samples are cubic Hermite interpolants, whose error is of fourth order in the sample distance.
"""

from dataclasses import dataclass

import numpy as np
from scipy.interpolate import CubicHermiteSpline

Array = np.ndarray


@dataclass(frozen=True)
class ContactInterval:
    """One contact: when it starts and ends, and the samples in it."""

    start: float
    """s."""
    end: float | None
    """s; None if it lasts beyond the last sample."""
    first: int
    """Index of the first sample in contact."""
    last: int
    """Index of the last sample in contact."""

    @property
    def duration(self) -> float | None:
        return None if self.end is None else self.end - self.start


def hermite(t: Array, y: Array, rate: Array, at: Array) -> Array:
    """Values at times `at` of the cubic Hermite interpolant of y.

    Repeated times (two records at an impact) are allowed: at such a time the later record counts.
    Raises ValueError for times outside the samples.
    """
    at = np.asarray(at, dtype=float)
    span = t[-1] - t[0]
    if at.size and (at.min() < t[0] - 1e-12 * span or at.max() > t[-1] + 1e-12 * span):
        raise ValueError(f"times {at.min():g} ... {at.max():g} s reach outside the samples {t[0]:g} ... {t[-1]:g} s")
    i = np.clip(np.searchsorted(t, at, side="right") - 1, 0, len(t) - 2)
    # at the very end of a doubled last record the interval may have no length
    while np.any(t[i + 1] == t[i]):
        i = np.where((t[i + 1] == t[i]) & (i > 0), i - 1, i)
    h = t[i + 1] - t[i]
    s = (at - t[i]) / h
    return (
        (1.0 + 2.0 * s) * (1.0 - s) ** 2 * y[i]
        + s * (1.0 - s) ** 2 * h * rate[i]
        + s**2 * (3.0 - 2.0 * s) * y[i + 1]
        + s**2 * (s - 1.0) * h * rate[i + 1]
    )


def crossing(t: Array, y: Array, rate: Array, i: int) -> float:
    """Time in [t[i], t[i+1]] where the Hermite interpolant is zero.

    Raises ValueError if y does not change sign there.
    """
    a, b = slice(i, i + 2), (t[i], t[i + 1])
    if y[i] == 0.0:
        return float(t[i])
    if y[i] * y[i + 1] > 0.0 or b[1] <= b[0]:
        raise ValueError(f"no change of sign between samples {i} and {i + 1}: {y[i]:g}, {y[i + 1]:g}")
    roots = CubicHermiteSpline(t[a], y[a], rate[a]).roots(extrapolate=False)
    inside = [r for r in np.atleast_1d(roots) if np.isfinite(r)]
    # a change of sign has a root; rounding may put it just outside
    return float(inside[0]) if inside else float(b[0] + (b[1] - b[0]) * y[i] / (y[i] - y[i + 1]))


def contact_intervals(t: Array, gap: Array, gap_rate: Array) -> list[ContactInterval]:
    """Where gap < 0: each contact with its start and end, located between the samples."""
    inside = gap < 0.0
    edges = np.flatnonzero(np.diff(inside.astype(int)))
    starts = [int(i) for i in edges if inside[i + 1]]
    found = []
    if inside[0]:
        starts.insert(0, -1)
    for i in starts:
        start = float(t[0]) if i < 0 else crossing(t, gap, gap_rate, i)
        ends = [int(k) for k in edges if k > i and not inside[k + 1]]
        end = crossing(t, gap, gap_rate, ends[0]) if ends else None
        found.append(ContactInterval(start, end, i + 1, ends[0] if ends else len(t) - 1))
    return found


def released(t: Array, force: Array, interval: ContactInterval) -> ContactInterval:
    """The same contact, ended where its force comes to zero if that is before the gap opens (a damper lets go)."""
    inside = force[interval.first : interval.last + 1]
    top = int(np.argmax(inside))
    gone = np.flatnonzero(inside[top:] <= 0.0)
    if not gone.size or inside[top] <= 0.0:
        return interval
    k = interval.first + top + int(gone[0])
    # the force falls steeply until it is switched off: follow the line of its last two samples to zero
    slope = (force[k - 1] - force[k - 2]) / (t[k - 1] - t[k - 2]) if k - 2 >= interval.first else 0.0
    end = t[k - 1] - force[k - 1] / slope if slope < 0.0 else t[k]
    return ContactInterval(interval.start, float(min(end, t[k])), interval.first, k - 1)


def speeds(t: Array, gap_rate: Array, interval: ContactInterval) -> tuple[float, float]:
    """(approach speed at the start, separation speed at the end) of a contact, m/s.

    Taken from the two samples outside on either side, on the line through them: inside the rate bends sharply.
    """
    before = _linear(t, gap_rate, interval.first - 1, interval.first - 2, interval.start)
    end = float(t[interval.last]) if interval.end is None else interval.end
    after = _linear(t, gap_rate, interval.last + 1, interval.last + 2, end)
    return -before, after


def _linear(t: Array, y: Array, near: int, far: int, at: float) -> float:
    """y at `at` on the line through samples `near` and `far`; the value at `near` where there is no such line."""
    near = min(max(near, 0), len(t) - 1)
    if not 0 <= far < len(t) or t[far] == t[near]:
        return float(y[near])
    return float(y[near] + (y[far] - y[near]) / (t[far] - t[near]) * (at - t[near]))


def peak(t: Array, y: Array) -> tuple[float, float]:
    """(time, value) of the largest y, refined by the parabola through the three samples around it."""
    k = int(np.argmax(y))
    if k == 0 or k == len(y) - 1:
        return float(t[k]), float(y[k])
    (t0, t1, t2), (y0, y1, y2) = t[k - 1 : k + 2], y[k - 1 : k + 2]
    left, right = (y1 - y0) / (t1 - t0), (y2 - y1) / (t2 - t1)
    bend = (right - left) / (t2 - t0)
    if not np.isfinite(bend) or bend >= 0.0:
        return float(t1), float(y1)
    at = 0.5 * (t0 + t1) - left / (2.0 * bend)
    return float(at), float(y0 + left * (at - t0) + bend * (at - t0) * (at - t1))


def impulse(t: Array, force: Array, interval: ContactInterval) -> float:
    """Integral of the force over the contact, N s: trapezoid on the samples.

    The force at the start is extrapolated (a damper's force jumps there), at the end it is zero.
    """
    k = slice(interval.first, interval.last + 1)
    first = _extrapolated(t[k], force[k], interval.start)
    end = float(t[interval.last]) if interval.end is None else interval.end
    times = np.concatenate(([interval.start], t[k], [end]))
    values = np.concatenate(([first], force[k], [0.0 if interval.end is not None else force[interval.last]]))
    return float(np.trapezoid(values, times))


def _extrapolated(t: Array, y: Array, at: float) -> float:
    """y at `at` on the line through its first two samples, but not below zero."""
    if len(t) < 2 or t[1] <= t[0]:
        return 0.0
    return max(0.0, float(y[0] + (y[1] - y[0]) / (t[1] - t[0]) * (at - t[0])))


@dataclass(frozen=True)
class Difference:
    """How far two trajectories are apart."""

    maximum: float
    at: float
    """Time of the largest difference, s."""
    rms: float
    scale: float
    """Half the range of the reference: what the relative values refer to."""

    @property
    def relative(self) -> float:
        return self.maximum / self.scale if self.scale > 0.0 else self.maximum


CONSTANT = 1e-5
"""Of its size: amplitude below which a channel counts as constant. With a relative tolerance of 1e-4 that asks for
1e-9 of the value, what runs with rtol = 1e-10 hold."""


def trajectory_difference(t: Array, y: Array, reference: Array, mask: Array | None = None) -> Difference:
    """Largest and root-mean-square difference of two trajectories on one grid, where `mask` is true.

    Raises ValueError if nothing is left to compare.
    """
    keep = np.ones(len(t), dtype=bool) if mask is None else mask
    if not keep.any():
        raise ValueError("there is no time left at which the trajectories could be compared")
    gap = np.abs(y[keep] - reference[keep])
    k = int(np.argmax(gap))
    # a channel that stays constant has no amplitude: then its own size is the scale, not what rounding and the steps'
    # tolerances make of it
    values = reference[keep]
    scale = max(0.5 * float(np.ptp(values)), CONSTANT * float(np.max(np.abs(values))))
    return Difference(float(gap[k]), float(t[keep][k]), float(np.sqrt(np.mean(gap**2))), scale)


def richardson(coarse: Array, fine: Array, ratio: float = 2.0, order: float = 2.0) -> tuple[Array, Array]:
    """(extrapolated values, estimated error of `fine`) of a method of this order, steps `ratio` h and h."""
    correction = (fine - coarse) / (ratio**order - 1.0)
    return fine + correction, np.abs(correction)


def power_limit(x: Array, values: Array) -> tuple[Array, Array]:
    """Limit for x -> 0 of values(x) = a + b x + c x^2 through three points, and its uncertainty.

    `values` has one row for each of the three x. The uncertainty is the distance to the line through the two
    points of smallest x.

    Raises ValueError unless there are three different x.
    """
    x, values = np.asarray(x, dtype=float), np.asarray(values, dtype=float)
    order = np.argsort(x)
    (a, b, c), (fa, fb, fc) = x[order], values[order]
    if len(x) != 3 or len({float(k) for k in x}) != 3:
        raise ValueError(f"three different points are needed, given {x.tolist()}")
    line = fa - a * (fb - fa) / (b - a)
    weights = (b * c / ((a - b) * (a - c)), a * c / ((b - a) * (b - c)), a * b / ((c - a) * (c - b)))
    parabola = weights[0] * fa + weights[1] * fb + weights[2] * fc
    return parabola, np.abs(parabola - line)
