"""Passages of singular positions over a grid of methods, tolerances and starts, against the motion in one coordinate.

Every run must pass, with an error of the method's own size: rounding at the position must not decide. The widest grid
is `benchmarks/singular_passages.py`; under other code generations: `benchmarks/codegen.sh`.
"""

import math

import numpy as np
import pytest
from helpers import on
from linkages import four_bar, stiffness
from scipy.integrate import solve_ivp
from tlismni.core import (
    Disk2D,
    DiskOnHalfPlane2D,
    EquationSystem,
    HalfPlane2D,
    Marker2D,
    NewtonImpact,
    Simulation,
    simulate,
)

# error of a run relative to rtol: of formulas whose error estimate is of a lower order than they are, of order 3 and 4,
# of order 2 (local errors of fixed size add up over more and more steps)
HIGH = {"ebdf": {}, "mebdf": {}, "irk": {}, "irk gauss3": {"tableau": "gauss3"}, "irk sdirk4": {"tableau": "sdirk4"}}
MEDIUM = {"bdf": {}, "adams": {}, "ebdf auto": {"k": "auto"}}
LOW = {"park": {}, "hht": {}, "trapezoidal": {}, "newmark": {}}
STARTS = ((math.pi / 2, -1.0), (1.1, -6.0), (0.4, -5.3), (0.25, -5.7), (0.9, -3.1), (0.31, -12.0), (0.6, -0.4))


def allowed(name, rtol):
    """Error in units of rtol."""
    if name in HIGH:
        return 20.0
    # local errors of size rtol in rtol^(-1/(p + 1)) steps
    return 50.0 * rtol ** (-1.0 / 4.0) if name in MEDIUM else 20.0 * rtol ** (-1.0 / 3.0)


def exact(theta, rate, loops, t=2.0):
    k = stiffness(loops + 1, loops)
    return solve_ivp(
        lambda _, y: [y[1], -k * math.cos(y[0])], (0.0, t), [theta, rate], "DOP853", rtol=1e-13, atol=1e-14,
        max_step=0.01, dense_output=True,
    ).sol  # fmt: skip


def time_of(solution, angle, t=2.0):
    low, high = 0.0, t
    for _ in range(80):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if solution(middle)[0] > angle else (low, middle)
    return low


def passes(name, rtol, start, loops):
    method, options = name.split()[0], {**HIGH, **MEDIUM, **LOW}[name]
    solution = exact(*start, loops)
    t_end = time_of(solution, -0.35)
    sim = Simulation(four_bar(loops, *start), method, rtol, 0.01 * rtol, max_steps=60_000, **options)
    sim.advance(t_end)
    row, n = sim.sample(), sim.assembly.n
    q, v = row[1 : 1 + n], row[sim.table.layout.v]
    angle, rate = solution(t_end)
    most = allowed(name, rtol) * rtol
    assert abs(q[2] - angle) < most
    assert abs(v[2] - rate) < 30.0 * most
    # on the branch of the parallelograms
    assert np.abs(q[3 * (loops + 1) + 2 :: 3][:loops]).max() < 1e-9 or loops == 0


@pytest.mark.sampled(4)
@pytest.mark.parametrize("name", [*HIGH, *MEDIUM, *LOW])
def test_sample_of_the_grid(name):
    tolerances = (1e-4, 1e-6, 1e-7) if name in LOW else (1e-4, 1e-7, 1e-9, 1e-11, 1e-12)
    for k, rtol in enumerate(tolerances):
        for loops in (1, 2):
            passes(name, rtol, STARTS[(2 * k + loops) % len(STARTS)], loops)


@pytest.mark.full
@pytest.mark.parametrize("rtol", [10.0**-k for k in range(4, 13)])
@pytest.mark.parametrize("name", [*HIGH, *MEDIUM, *LOW])
def test_grid(name, rtol):
    if name in LOW and rtol < 0.9e-8:
        return
    for start in STARTS:
        for loops in (1, 2):
            passes(name, rtol, start, loops)


@pytest.mark.parametrize("method, rtol", [("ebdf", 1e-6), ("irk", 1e-10)])
@pytest.mark.parametrize("away", [-1e-3, -1e-7, -1e-12, 0.0, 1e-9, 1e-5, 1e-3])
def test_run_may_stop_next_to_the_position_and_go_on(method, rtol, away):
    solution = exact(1.1, -6.0, 2)
    stop = time_of(solution, 0.0) + away
    sim = Simulation(four_bar(2, 1.1, -6.0), method, rtol, 0.01 * rtol, max_steps=20_000)
    sim.run_to(stop)
    assert sim.sample()[3] == pytest.approx(solution(stop)[0], abs=5.0 * rtol)
    sim.run_to(stop + 0.05)
    row = sim.sample()
    assert row[3] == pytest.approx(solution(stop + 0.05)[0], abs=5.0 * rtol)
    assert np.abs(row[[12, 15]]).max() < 1e-10


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method, rtol, interval", [("ebdf", 1e-6, 1e-3), ("irk", 1e-10, 1e-3), ("ebdf", 1e-9, 2e-4)])
def test_steps_that_end_at_fixed_times_pass_too(method, rtol, interval):
    """No step may be longer than the interval, so that some begin and end where rounding is large."""
    solution = exact(1.1, -6.0, 2)
    sim = Simulation(four_bar(2, 1.1, -6.0), method, rtol, 0.01 * rtol, max_steps=20_000)
    sim.run_to(0.15)
    for k in range(1, int(0.03 / interval)):
        sim.run_to(0.15 + k * interval)
        assert sim.sample()[3] == pytest.approx(solution(0.15 + k * interval)[0], abs=10.0 * rtol)


def test_samples_within_a_long_step():
    """The step over the position is long; the motion in it is as accurate as at the ends of steps."""
    rtol, solution = 1e-9, exact(1.1, -6.0, 2)
    crossing = time_of(solution, 0.0)
    times = np.linspace(crossing - 0.1, crossing + 0.1, 101)
    result = simulate(four_bar(2, 1.1, -6.0), times[-1], "ebdf", rtol, 0.01 * rtol, t_eval=times)
    angle, rate = np.array([solution(t) for t in times]).T
    assert result["v0.angle"] == pytest.approx(angle, abs=10.0 * rtol)
    assert result["v0.angular_velocity"] == pytest.approx(rate, abs=200.0 * rtol)
    assert result.a[:, 2] == pytest.approx(-stiffness(3, 2) * np.cos(angle), abs=1e4 * rtol)


@pytest.mark.parametrize("method", ["ebdf", "irk", "bdf", "hht"])
@pytest.mark.parametrize("start", [-1.0, -0.037])
def test_own_equations_on_crossing_lines(method, start):
    """x^2 = y^2: the point goes on along its line through the crossing."""
    system = EquationSystem(
        mass=np.diag([1.0, 2.0]), force=np.zeros(2), constraint=lambda t, q: q[0] ** 2 - q[1] ** 2,
        q0=[start, start], v0=[1.0, 1.0],
    )  # fmt: skip
    result = simulate(system, 1.5, method, 1e-8, 1e-10)
    assert result.q[-1] == pytest.approx([start + 1.5, start + 1.5], abs=1e-9)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("angle", [0.05, 0.005, -0.005, -0.05])
def test_impact_beside_the_position(angle):
    """The tip of a crank strikes a floor; the motion is that of one coordinate, so that e belongs to its rate."""
    solution = exact(1.1, -6.0, 2)
    time = time_of(solution, angle)
    plane = HalfPlane2D(marker=Marker2D(point=(0.0, math.sin(angle))))
    disk = Disk2D(marker=on("v0", 0.5), radius=0.0)
    floor = DiskOnHalfPlane2D(name="floor", plane=plane, disk=disk, law=NewtonImpact(restitution=0.5))
    model = four_bar(2, 1.1, -6.0).model_copy(update={"contacts": (floor,)})
    sim = Simulation(model, "ebdf", 1e-8, 1e-10, max_steps=20_000)
    sim.advance(time + 0.02)
    (event,) = [e for e in sim.events if e.kind == "impact"]
    speed = -solution(time)[1] * math.cos(angle)
    assert event.t == pytest.approx(time, abs=1e-8)
    assert event.approach_speed == pytest.approx(speed, rel=1e-5)
    assert event.separation_speed == pytest.approx(0.5 * speed, rel=1e-5)
