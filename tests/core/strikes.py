"""One contact without gravity: a free mass strikes a half-plane. Its closed forms, and references by scipy only."""

import math

import pytest
from helpers import ball_over_floor, events
from scipy.integrate import solve_ivp
from scipy.optimize import brentq
from scipy.special import gamma
from tlismni.core import simulate


def rebound(factor):
    """Root e of (1 + D)/(1 - D e) = exp(D (1 + e)), sought in 1 - D e, which is tiny for large D."""

    def equation(rest):
        return math.log1p(factor) - math.log(rest) - factor - (1.0 - rest)

    if factor == 0.0:
        return 1.0
    return (1.0 - brentq(equation, 1e-300, 1.0, xtol=1e-300, rtol=1e-15)) / factor


def hertz_contact(mass, stiffness, exponent, speed):
    """Largest penetration, largest force and duration of an undamped contact."""
    n = exponent
    depth = ((n + 1.0) * mass * speed**2 / (2.0 * stiffness)) ** (1.0 / (n + 1.0))
    c = 2.0 * math.sqrt(math.pi) * gamma(1.0 / (n + 1.0)) / ((n + 1.0) * gamma(1.0 / (n + 1.0) + 0.5))
    return depth, stiffness * depth**n, c * depth / speed


def strike(law, mass=1.0, speed=1.0, exponent=1.5, **options):
    """A free ball that strikes the floor: `law` acts for a few contact times."""
    depth, _, duration = hertz_contact(mass, law.stiffness, exponent, speed)
    model = ball_over_floor(law, height=0.5 * depth, speed=-speed, mass=mass, gravity=0.0)
    options = {"rtol": 1e-9, "atol": 1e-10 * min(depth, speed), **options}
    return simulate(model, 8.0 * duration, **options)


def ratio(result):
    """Separation speed over approach speed of the only contact."""
    (opened,) = events(result, "open")
    assert opened.separation_speed == pytest.approx(result["ball.vy"][-1], rel=1e-9)
    return opened.separation_speed / opened.approach_speed


def scipy_rebound(force, release, mass=1.0, speed=1.0):
    """Rebound over approach speed of m d'' = -force(d, d'), released at d = 0 ("gap") or at force = 0 ("force")."""

    def motion(t, y):
        return [y[1], -force(max(y[0], 0.0), y[1]) / mass]

    def end(t, y):
        if t == 0.0 or y[1] > 0.0:
            return 1.0
        return y[0] if release == "gap" else force(max(y[0], 0.0), y[1])

    end.terminal, end.direction = True, -1.0
    run = solve_ivp(motion, (0.0, 1e3), [0.0, speed], "DOP853", events=end, rtol=1e-12, atol=1e-17)
    assert run.status == 1
    return -run.y[1, -1] / speed
