"""Spatial scenarios against closed forms and figures that were converged in two ways elsewhere.

Heavy top, slider-crank and pendulum: each converged by two programmes of their own to the digits that stand here.
"""

import numpy as np
import pytest
from scipy.special import ellipj, ellipk, ellipkinc
from tlismni.core import EulerParameters, Simulation, simulate
from tlismni.core.model.attitude import rotation_matrix
from tlismni.models import load

HEAVY_TOP = {
    0.2: (
        (0.605550561377, 0.598957681795, -0.523983027430),
        (-0.708279152974, 0.438781088127, 0.545728396145, 0.089399752824),
    ),
    1.0: (
        (0.173343964098, 0.640088592070, -0.748490791134),
        (0.732943980680, -0.278285719338, 0.531824611334, -0.320176142736),
    ),
    2.0: (
        (-0.150416822746, -0.724165591637, -0.673022269560),
        (0.122947135042, -0.491079892551, 0.350430030343, -0.787986887550),
    ),
}
CRANK = {
    0.5: (5.5837625533, 0.184952629778),
    1.0: (10.9135907299, 0.211721661393),
    5.0: (54.3333321683, 0.240719573732),
}
PENDULUM = {1.0: (-0.63624922, -0.61408089, -1.79390401), 5.0: (-1.4349547, -1.3925780, -0.0403918)}


def run(name, times, method="ebdf", rtol=1e-11, atol=1e-13):
    return simulate(load(name).model, times[-1], method=method, rtol=rtol, atol=atol, t_eval=times)


def check_levels(result, most=1e-10):
    """Joints and norms at all levels; accelerations in parts of the largest one."""
    assert np.abs(result["residual.position"]).max() < most
    assert np.abs(result["residual.velocity"]).max() < most
    assert np.abs(result["residual.acceleration"]).max() < most * max(1.0, np.abs(result.a).max())


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method", ["ebdf", "irk", "adams"])
def test_heavy_top(method):
    result = run("heavy_top", [*HEAVY_TOP], method)
    for k, (place, parameters) in enumerate(HEAVY_TOP.values()):
        assert np.abs(result.q[k, :3] - place).max() < 1e-7
        assert np.abs(result.q[k, 3:] - parameters).max() < 1e-7
    check_levels(result)
    energy = result["energy.kinetic"] + result["energy.potential"]
    assert np.ptp(energy) < 1e-8 * energy[0]
    # what the pivot carries moves the centre of mass
    force = np.stack([result[f"pivot.force_{axis}"] for axis in "xyz"], axis=1)
    assert np.abs(force - 15.0 * (result.a[:, :3] + [0.0, 0.0, 9.81])).max() < 1e-8 * np.abs(force).max()


def free_rotation(t, inertia, w0):
    """Euler's equations in closed form about axes with J1 < J2 < J3 (Landau and Lifshitz, section 37): w(t), period."""
    j1, j2, j3 = inertia
    w1, w2, w3 = w0
    double_energy = j1 * w1**2 + j2 * w2**2 + j3 * w3**2
    square = (j1 * w1) ** 2 + (j2 * w2) ** 2 + (j3 * w3) ** 2
    assert square > double_energy * j2
    a1 = np.sqrt((double_energy * j3 - square) / (j1 * (j3 - j1)))
    a2 = np.sqrt((double_energy * j3 - square) / (j2 * (j3 - j2)))
    a3 = np.sqrt((square - double_energy * j1) / (j3 * (j3 - j1)))
    rate = np.sqrt((j3 - j2) * (square - double_energy * j1) / (j1 * j2 * j3))
    modulus = (j2 - j1) * (double_energy * j3 - square) / ((j3 - j2) * (square - double_energy * j1))
    quarter = ellipk(modulus)
    start = ellipkinc(np.arctan2(w2 / a2, w1 / a1), modulus)
    sn, cn, dn, _ = ellipj(start + rate * np.asarray(t), modulus)
    return np.stack([a1 * cn, a2 * sn, a3 * dn], axis=-1), 4.0 * quarter / rate


def test_closed_form_of_a_free_body_is_that_of_the_reference():
    w, period = free_rotation(2.0, (1.0, 2.0, 3.0), (0.01, 5.0, 0.01))
    assert w == pytest.approx((-1.161250059636, 4.863290891875, 0.670497750681), abs=1e-10)
    assert period == pytest.approx(10.051858276, abs=2e-9)


@pytest.mark.parametrize("method, most", [("ebdf", 1e-8), ("irk", 1e-8), ("adams", 1e-6)])
def test_free_body_over_two_periods(method, most):
    """The turn near the middle axis is unstable: each time it begins to turn over, errors have grown 200 times for a
    while, and they are small again where it is back."""
    times = np.linspace(0.0, 20.103716552, 41)
    result = run("free_body", times, method, rtol=1e-13, atol=1e-15)
    found = np.stack([result[f"body.body_angular_velocity_{axis}"] for axis in "xyz"], axis=1)
    exact, _ = free_rotation(times, (1.0, 2.0, 3.0), (0.01, 5.0, 0.01))
    assert np.abs(found - exact)[[20, 40]].max() < most
    assert np.abs(found - exact).max() < 200.0 * most
    # the norm's multiplier is zero, since nothing acts on the body
    assert np.abs(result.multipliers).max() < 1e-9 * np.abs(result.a).max()
    check_levels(result)


def test_free_body_over_two_periods_by_adams_formulas():
    """With error control Milne's honest estimate, no finer than COORDINATE_DIFFERENCES of the speeds, adds up to what
    the test above allows; the formula itself goes as far as the others, at order 8 with 4000 steps."""
    t_end = 20.103716552
    result = simulate(load("free_body").model, t_end, "adams", order=8, step=t_end / 4000, newton_tolerance=1e-14)
    found = np.stack([result[f"body.body_angular_velocity_{axis}"] for axis in "xyz"], axis=1)
    exact, _ = free_rotation(result.t, (1.0, 2.0, 3.0), (0.01, 5.0, 0.01))
    assert np.abs(found - exact)[[2000, 4000]].max() < 1e-8


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method", ["ebdf", "irk", "adams"])
def test_spatial_slider_crank(method):
    result = run("spatial_slider_crank", [*CRANK], method, rtol=1e-12, atol=1e-14)
    for k, (angle, place) in enumerate(CRANK.values()):
        assert result["crank.angle"][k] == pytest.approx(angle, abs=1e-7)
        assert result["slider.x"][k] == pytest.approx(place, abs=1e-7)
    check_levels(result)


@pytest.mark.parametrize("method", ["ebdf", "irk", "adams"])
def test_universal_pendulum(method):
    result = run("universal_pendulum", [*PENDULUM], method)
    for k, place in enumerate(PENDULUM.values()):
        assert np.abs(result.q[k, :3] - place).max() < 1e-7
    check_levels(result)
    assert np.hypot(np.hypot(*result.q[:, :2].T), result.q[:, 2]) == pytest.approx(2.0, abs=1e-12)


def rotation(result, body, at):
    """Rotation matrix of a body's Euler parameters."""
    return rotation_matrix([result[f"{body}.e{k}"][at] for k in range(4)])


@pytest.mark.parametrize("method", ["ebdf", "irk", "adams"])
def test_bricard(method):
    half_period = 2.495855756844
    result = run("bricard", [0.3, 1.0, half_period], method)
    angles = np.stack([result[f"hinge{k}.angle"] for k in range(6)], axis=1)
    assert angles[1, 0] == pytest.approx(1.03502845952, abs=1e-7)
    assert angles[2, 0] == pytest.approx(np.pi, abs=1e-7)
    f, p = angles[:, 0], -angles[:, 1]
    assert np.sin(p) == pytest.approx(np.sin(f) / (1.0 + np.sin(f)), abs=1e-9)
    assert np.abs(angles[:, [2, 4]] - f[:, None]).max() < 1e-9 and np.abs(angles[:, [3, 5]] + p[:, None]).max() < 1e-9
    place = [result[f"rod3.{axis}"][1] for axis in "xyz"]
    turn = rotation(result, "rod3", 1)
    # P3 is the end of the third rod, the fourth corner
    assert place + turn @ [0.0, 0.0, 0.5] == pytest.approx([0.5105014612, -1.6491675994, 0.1401231146], abs=1e-7)
    check_levels(result)
    (row,) = result.redundant
    assert row.constraint.startswith("hinge") and {f"hinge{k}" for k in range(5)} <= {*row.repeats, row.constraint}


def test_top_that_precesses_steadily():
    """With the axis level: C W s = m g l. The centre of mass goes round at constant height (Goldstein, section 5.7)."""
    precession = 1.3
    spin = 15.0 * 9.81 / (0.46875 * precession)
    times = np.linspace(0.0, 2.0, 9)
    model = load("heavy_top", spin=spin, precession=precession).model
    result = simulate(model, 2.0, "irk", rtol=1e-11, atol=1e-13, t_eval=times)
    exact = np.stack([-np.sin(precession * times), np.cos(precession * times), 0.0 * times], axis=1)
    assert np.abs(result.q[:, :3] - exact).max() < 1e-8
    assert result["top.body_angular_velocity_y"] == pytest.approx(spin, abs=1e-7)


@pytest.mark.parametrize("name, state", [("heavy_top", 3), ("spatial_slider_crank", 10), ("bricard", 3)])
def test_sign_of_the_euler_parameters_means_nothing(name, state):
    """p and -p are one attitude: the motion from either start is the same."""
    model = load(name).model
    body = model.bodies[state // 7]
    p = tuple(-x for x in body.attitude.parameters())
    turned = model.model_copy(
        update={
            "bodies": tuple(
                b.model_copy(update={"attitude": EulerParameters(values=p)}) if b is body else b for b in model.bodies
            )
        }
    )
    first, second = (simulate(m, 0.1, "irk", rtol=1e-10, atol=1e-12, t_eval=[0.1]) for m in (model, turned))
    for channel in first.channels:
        if channel.rpartition(".")[2][:2] not in ("e0", "e1", "e2", "e3") and not channel.startswith("residual"):
            scale = max(1.0, abs(first[channel][0]))
            assert first[channel][0] == pytest.approx(second[channel][0], abs=1e-6 * scale), channel


def test_state_goes_back_with_its_turns():
    """The count of turns is part of the state: a run that goes back repeats itself bit by bit."""
    sim = Simulation(load("spatial_slider_crank").model)
    place = [channel.name for channel in sim.channels].index("crank.angle")
    sim.advance(0.9)
    kept, angle = sim.state(), sim.values()[place]
    sim.advance(2.0)
    later = sim.values().copy()
    sim.restore(kept)
    assert sim.values()[place] == angle and angle > 2.0 * np.pi
    sim.advance(2.0)
    assert np.array_equal(sim.values(), later) and later[place] > 6.0 * np.pi


def test_model_at_a_time_goes_on_from_there():
    first = simulate(load("spatial_slider_crank").model, 1.0, "irk", rtol=1e-10, atol=1e-12, t_eval=[0.5, 1.0])
    second = simulate(first.model_at(0.5), 0.5, "irk", rtol=1e-10, atol=1e-12, t_eval=[0.5])
    for name in ("slider.x", "slider.vx", "rod.y", "rod.angular_velocity_z"):
        assert second[name][0] == pytest.approx(first[name][1], abs=1e-8)
