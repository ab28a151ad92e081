"""Lyapunov exponents of the chaotic impact oscillator: the closed form over millions of impacts, and our run.

x'' + 2 z x' + x = cos(w t), x <= 0, v+ = -r v-. Between impacts motion and variations are known in closed form; impacts
are found by Newton's iteration inside a bracket; the saltation matrix is [[-r, 0], [(a+ + r a-)/v-, -r]]. Errors are
those of the mean over 30 parts.

    python benchmarks/lyapunov_reference.py [IMPACTS OF THE CLOSED FORM] [SECONDS OF OUR RUN]
"""

import math
import sys
import time
from typing import Any

import numba
import numpy as np
from tlismni.core.analysis import lyapunov_exponents
from tlismni.models import load

DAMPING, FREQUENCY, RESTITUTION = 0.05, 2.8, 0.8
PARTS, SETTLING, SCAN = 30, 100, 0.005


@numba.njit
def closed_form(z: float, w: float, r: float, x: float, v: float, impacts: int) -> Any:
    """Time of each impact and the logarithms of the growth up to it, (impacts, 3)."""
    wd, norm = math.sqrt(1.0 - z * z), (1.0 - w * w) ** 2 + (2.0 * z * w) ** 2
    a, b = (1.0 - w * w) / norm, -2.0 * z * w / norm  # forced motion a cos(w t) - b sin(w t)
    found, t = np.zeros((impacts, 3)), 0.0
    y00, y01, y10, y11 = 1.0, 0.0, 0.0, 1.0
    for k in range(impacts):
        x0 = x - (a * math.cos(w * t) - b * math.sin(w * t))
        v0 = v + w * (a * math.sin(w * t) + b * math.cos(w * t))
        low = 1e-9 if k else 0.0
        high, h, speed, inside = low + SCAN, low + SCAN, 0.0, False
        for _ in range(10_000_000):
            e, c, s = math.exp(-z * h), math.cos(wd * h), math.sin(wd * h) / wd
            cosine, sine = math.cos(w * (t + h)), math.sin(w * (t + h))
            place = e * ((c + z * s) * x0 + s * v0) + a * cosine - b * sine
            speed = e * (-s * x0 + (c - z * s) * v0) - w * (a * sine + b * cosine)
            if not inside and place <= 0.0:
                low, h = h, h + SCAN
                continue
            if place > 0.0:
                high = h
            else:
                low = h
            inside = True
            better = h - place / speed
            if not low < better < high:
                better = 0.5 * (low + high)
            if abs(better - h) <= 1e-15 * max(1.0, h):
                break
            h = better
        t += h
        before, after = math.cos(w * t) - 2.0 * z * speed, math.cos(w * t) + 2.0 * z * r * speed
        lower = (after + r * before) / speed
        f00, f01, f10, f11 = e * (c + z * s), e * s, -e * s, e * (c - z * s)
        s00, s01, s10, s11 = -r * f00, -r * f01, lower * f00 - r * f10, lower * f01 - r * f11
        u0, u1 = s00 * y00 + s01 * y10, s10 * y00 + s11 * y10
        w0, w1 = s00 * y01 + s01 * y11, s10 * y01 + s11 * y11
        first = math.hypot(u0, u1)
        y00, y10 = u0 / first, u1 / first
        along = w0 * y00 + w1 * y10
        w0, w1 = w0 - along * y00, w1 - along * y10
        second = math.hypot(w0, w1)
        y01, y11 = w0 / second, w1 / second
        growth = found[k - 1] if k else np.zeros(3)
        found[k, 0], found[k, 1], found[k, 2] = t, growth[1] + math.log(first), growth[2] + math.log(second)
        x, v = 0.0, -r * speed
    return found


def reference(impacts: int) -> tuple[np.ndarray, np.ndarray]:
    """Exponents and their standard errors, 1/s."""
    found = closed_form(DAMPING, FREQUENCY, RESTITUTION, -0.5, 0.0, impacts)[SETTLING:]
    ends = found[np.linspace(0, len(found) - 1, PARTS + 1).astype(int)]
    means = np.diff(ends[:, 1:], axis=0) / np.diff(ends[:, 0])[:, None]
    total = (found[-1, 1:] - found[0, 1:]) / (found[-1, 0] - found[0, 0])
    return total, np.std(means, axis=0, ddof=1) / math.sqrt(PARTS)


def shown(exponents: np.ndarray, errors: np.ndarray) -> str:
    """As text."""
    return ", ".join(f"{x:+.5f} ± {e:.5f}" for x, e in zip(exponents, errors, strict=True))


if __name__ == "__main__":
    count = int(float(sys.argv[1])) if len(sys.argv) > 1 else 1_000_000
    end = float(sys.argv[2]) if len(sys.argv) > 2 else 2000.0
    exponents, errors = reference(count)
    print(f"closed form, {count} impacts: {shown(exponents, errors)}")
    model = load("impact_oscillator", damping_ratio=DAMPING, frequency=FREQUENCY, restitution=RESTITUTION).model
    lyapunov_exponents(model, 3.0)  # compiled
    start, cpu = time.perf_counter(), time.process_time()
    run = lyapunov_exponents(model, end, transient=50.0)
    start, cpu = time.perf_counter() - start, time.process_time() - cpu
    print(f"our run, {run.impacts} impacts: {shown(run.exponents, run.errors)}")
    print(f"sum less what damping and impacts take: {run.sum_residual:.1e}")
    each = f"{1e3 * start / run.impacts:.2f} ms ({1e3 * cpu / run.impacts:.2f} of one core)"
    print(f"an impact takes {each} and {run.stats['steps'] / run.impacts:.0f} steps")
