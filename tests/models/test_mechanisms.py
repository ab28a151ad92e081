"""Pendulum, four-bar and slider-crank against minimal coordinates, which scipy integrates."""

import cmath
import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import Result, Simulation, simulate
from tlismni.models import load

G, R, L = 9.81, 0.15, 0.3
CRANK, ROD, SLIDER = 0.36, 0.15, 0.075
TIGHT = {"rtol": 1e-11, "atol": 1e-13}


def integrate(rhs: Callable, times: np.ndarray, y0: list[float], method: str = "DOP853") -> np.ndarray:
    """The solution at `times`, (len(y0), N)."""
    run = solve_ivp(rhs, (0.0, times[-1]), y0, method, t_eval=times, rtol=1e-12, atol=1e-13, max_step=0.01)
    assert run.success
    return np.asarray(run.y)


# pendulum


@pytest.mark.parametrize("angle, length, gravity", [(math.pi, 1.0, 9.81), (0.4, 0.3, 1.62), (-1.2, 2.0, 20.0)])
def test_pendulum_follows_its_angle(angle: float, length: float, gravity: float) -> None:
    times = np.linspace(0.0, 3.0, 31)
    model = load("pendulum", angle=angle, length=length, gravity=gravity, mass=2.5).model
    result = simulate(model, 3.0, t_eval=times, **TIGHT)
    phi, rate = integrate(lambda t, y: [y[1], -gravity / length * math.cos(y[0])], times, [angle, 0.0])
    assert np.abs(result["bob.x"] - length * np.cos(phi)).max() < 1e-9
    assert np.abs(result["bob.vy"] - length * np.cos(phi) * rate).max() < 1e-8
    assert np.abs(result["rod.tension"] - 2.5 * (length * rate**2 - gravity * np.sin(phi))).max() < 1e-6


# four-bar


def four_bar_reference(loops: int, times: np.ndarray, length: float, gravity: float, speed: float) -> np.ndarray:
    """(angle, rate) of the cranks: N + 1 rods turn about their pins, N move in parallel."""
    factor = (0.5 * (loops + 1) + loops) / ((loops + 1) / 3.0 + loops)
    return integrate(
        lambda t, y: [y[1], -factor * gravity / length * math.cos(y[0])], times, [0.5 * math.pi, -speed / length]
    )


@pytest.mark.parametrize("loops", [1, 2, 4])
@pytest.mark.parametrize("length, speed", [(1.0, 1.0), (0.5, -2.0)])
def test_four_bar_follows_the_angle_of_its_cranks(loops: int, length: float, speed: float) -> None:
    """Until shortly before the cranks first lie level."""
    times = np.linspace(0.0, 0.7, 36)
    angle, rate = four_bar_reference(loops, times, length, G, speed)
    before = np.abs(angle - 0.5 * math.pi) < 0.5 * math.pi - 0.1
    times, angle, rate = times[before], angle[before], rate[before]
    assert np.abs(angle - 0.5 * math.pi).max() > 1.2
    result = simulate(load("four_bar", loops=loops, length=length, speed=speed).model, times[-1], t_eval=times, **TIGHT)
    for k in range(loops + 1):
        assert np.abs(result[f"crank{k}.angle"] - angle).max() < 1e-9
        assert np.abs(result[f"crank{k}.angular_velocity"] - rate).max() < 1e-8
        assert np.abs(result[f"crank{k}.x"] - k * length - 0.5 * length * np.cos(angle)).max() < 1e-9
    for k in range(1, loops + 1):
        assert np.abs(result[f"coupler{k}.angle"]).max() < 1e-9
        assert np.abs(result[f"coupler{k}.y"] - length * np.sin(angle)).max() < 1e-9


@pytest.mark.parametrize("loops", [1, 2, 4])
def test_four_bar_has_one_degree_of_freedom_and_no_redundant_constraints(loops: int) -> None:
    assembly = Simulation(load("four_bar", loops=loops).model).assembly
    assert (assembly.n, assembly.m) == (3 * (2 * loops + 1), 2 * (3 * loops + 1))
    assert assembly.n - assembly.m == 1


def test_four_bar_joint_forces_have_a_pole_where_the_cranks_are_level() -> None:
    """Of two loops, the middle crank carries twice the weight of couplers that an outer one does, and only forces
    along the level couplers can even that out: by moments about the pins, they grow as 1/sin(angle)."""
    result = simulate(load("four_bar").model, 0.713, t_eval=[0.70, 0.705, 0.71, 0.713], **TIGHT)
    angle, rate = result["crank0.angle"], result["crank0.angular_velocity"]
    turning = -7.0 / 6.0 * G * np.cos(angle)
    vertical = 0.5 * (G + turning * np.cos(angle) - rate**2 * np.sin(angle))  # at each end of a coupler
    # of the couplers on the outer crank: turning/3 = -cos (g/2 + vertical) + sin along
    along = (turning / 3.0 + np.cos(angle) * (0.5 * G + vertical)) / np.sin(angle)
    assert np.abs(result["right0.force_y"] - vertical).max() < 1e-6
    assert result["right0.force_x"] == pytest.approx(along, rel=1e-6)
    assert along[-1] > 4.0 * np.abs(along[:-1]).max()


# slider-crank


def rod_angle(angle: complex) -> complex:
    return -cmath.asin(R / L * cmath.sin(angle))


def rigid_reference(times: np.ndarray, angle: float = 0.25 * math.pi, rate: float = 30.0) -> np.ndarray:
    """(angle, rate) of m(angle) angle'' + m'/2 angle'^2 + V' = 0; derivatives by the complex step."""

    def moving(z: complex) -> complex:
        """m: twice the kinetic energy at unit rate."""
        s, c, phi = cmath.sin(z), cmath.cos(z), rod_angle(z)
        p = -R * c / (L * cmath.cos(phi))
        vx, vy = -R * s - 0.5 * L * cmath.sin(phi) * p, R * c + 0.5 * L * cmath.cos(phi) * p
        slider = -R * s - L * cmath.sin(phi) * p
        return CRANK * R**2 / 3.0 + ROD * (vx**2 + vy**2 + L**2 / 12.0 * p**2) + SLIDER * slider**2

    def height(z: complex) -> complex:
        return G * (CRANK * 0.5 * R * cmath.sin(z) + ROD * (R * cmath.sin(z) + 0.5 * L * cmath.sin(rod_angle(z))))

    def motion(t: float, y: np.ndarray) -> list[float]:
        z = complex(y[0], 1e-30)
        m, v = moving(z), height(z)
        return [y[1], -(0.5 * m.imag * y[1] ** 2 + v.imag) / 1e-30 / m.real]

    return integrate(motion, times, [angle, rate])


def elastic_reference(times: np.ndarray, stiffness: float, damping: float, y0: list[float]) -> np.ndarray:
    """(angle, rod's angle, slider's x and their rates): a double pendulum and a mass joined by the bushing."""

    def motion(t: float, y: np.ndarray) -> list[float]:
        a, b, x, u, w, vx = y
        ca, sa, cb, sb = math.cos(a), math.sin(a), math.cos(b), math.sin(b)
        dx, dy = x - R * ca - L * cb, -R * sa - L * sb
        dvx, dvy = vx + R * sa * u + L * sb * w, -R * ca * u - L * cb * w
        fx, fy = -stiffness * dx - damping * dvx, -stiffness * dy - damping * dvy  # on the slider
        couple = 0.5 * ROD * R * L
        c, s = math.cos(a - b), math.sin(a - b)
        mass = np.array([[(CRANK / 3.0 + ROD) * R**2, couple * c], [couple * c, ROD * L**2 / 3.0]])
        load_a = -couple * s * w**2 - G * (0.5 * CRANK + ROD) * R * ca + R * (sa * fx - ca * fy)
        load_b = couple * s * u**2 - 0.5 * G * ROD * L * cb + L * (sb * fx - cb * fy)
        return [u, w, vx, *np.linalg.solve(mass, [load_a, load_b]), fx / SLIDER]

    return integrate(motion, times, y0)


def deflection(result: Result) -> np.ndarray:
    """Slider against the end of the rod, (2, N)."""
    x = result["rod.x"] + 0.5 * L * np.cos(result["rod.angle"])
    y = result["rod.y"] + 0.5 * L * np.sin(result["rod.angle"])
    return np.array([result["slider.x"] - x, result["slider.y"] - y])


@pytest.mark.parametrize("angle, rate", [(0.25 * math.pi, 30.0), (2.0, -40.0)])
def test_rigid_slider_crank_follows_its_crank_angle(angle: float, rate: float) -> None:
    times = np.linspace(0.0, 1.0, 51)
    exact = rigid_reference(times, angle, rate)
    result = simulate(load("slider_crank", crank_angle=angle, crank_speed=rate).model, 1.0, t_eval=times, k=6, **TIGHT)
    assert abs(exact[0, -1] - angle) > 8.0 * math.pi  # it turns
    assert np.abs(result["crank.angle"] - exact[0]).max() < 1e-8
    assert np.abs(result["crank.angular_velocity"] - exact[1]).max() < 1e-7
    phi = np.array([rod_angle(a).real for a in exact[0]])
    assert np.abs(result["rod.angle"] - phi).max() < 1e-8
    assert np.abs(result["slider.x"] - R * np.cos(exact[0]) - L * np.cos(phi)).max() < 1e-8
    assert np.abs(result["energy.balance"]).max() < 1e-8


@pytest.mark.sampled(1)
@pytest.mark.parametrize("damping", [0.0, 20.0])
def test_elastic_slider_crank_follows_minimal_coordinates(damping: float) -> None:
    times = np.linspace(0.0, 0.2, 41)
    model = load("slider_crank", bushing_stiffness=1e5, bushing_damping=damping).model
    result = simulate(model, 0.2, t_eval=times, **TIGHT)
    names = ("crank.angle", "rod.angle", "slider.x", "crank.angular_velocity", "rod.angular_velocity", "slider.vx")
    exact = elastic_reference(times, 1e5, damping, [float(result[name][0]) for name in names])
    for k, name in enumerate(names):
        assert np.abs(result[name] - exact[k]).max() < (1e-8 if k < 3 else 1e-5), name


@pytest.mark.parametrize("method", ["ebdf", "irk"])
def test_ledger_closes_with_a_damped_bushing(method: str) -> None:
    model = load("slider_crank", bushing_stiffness=1e4, bushing_damping=50.0).model
    result = simulate(model, 0.3, method, rtol=1e-9, atol=1e-11)
    lost = result["energy.dissipation"]
    assert lost[-1] > 1e-3 and np.all(np.diff(lost) >= -1e-12)
    assert np.abs(result["energy.balance"]).max() < 1e-7


def test_stiff_bushing_tends_to_the_rigid_pin_as_one_over_its_stiffness() -> None:
    times = np.linspace(0.0, 0.2, 81)
    rigid = simulate(load("slider_crank").model, 0.2, t_eval=times, **TIGHT)
    apart = []
    for stiffness in (1e5, 1e6, 1e7):
        model = load("slider_crank", bushing_stiffness=stiffness).model
        elastic = simulate(model, 0.2, t_eval=times, rtol=1e-10, atol=1e-12)
        apart.append(np.abs(elastic["crank.angle"] - rigid["crank.angle"]).max())
    assert apart[0] / apart[1] == pytest.approx(10.0, rel=0.02)
    assert apart[1] / apart[2] == pytest.approx(10.0, rel=0.02)


@pytest.mark.parametrize("stiffness", [1e6, 1e8])
@pytest.mark.parametrize("damping_ratio", [0.0, 0.2])
def test_elastic_start_is_on_the_slow_motion(stiffness: float, damping_ratio: float) -> None:
    """The bushing carries what a rigid pin carries, to a thousandth, from the start on: no vibration about it.
    Started with the bushing unloaded, it would be off by all of that force."""
    damping = damping_ratio * 2.0 * math.sqrt(stiffness * 0.05)
    times = np.linspace(0.0, 2000.0 / math.sqrt(stiffness) * 5e-3, 200)
    rigid = simulate(load("slider_crank").model, times[-1], t_eval=times, **TIGHT)
    model = load("slider_crank", bushing_stiffness=stiffness, bushing_damping=damping).model
    elastic = simulate(model, times[-1], "irk", t_eval=times, rtol=1e-10, atol=1e-13)
    force = -stiffness * deflection(elastic)
    if damping:
        rates = np.gradient(deflection(elastic), times, axis=1, edge_order=2)
        force -= damping * rates
    expected = np.array([rigid["wrist.force_x"], rigid["wrist.force_y"]])
    largest = np.abs(expected).max()
    assert largest > 5.0
    assert np.abs(force - expected)[:, 1:-1].max() < 1e-3 * largest
