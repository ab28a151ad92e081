"""Scenarios with bodies in a floating frame: sphere on beam, hub with beam and stop, slider-crank with flexible rod."""

import math
from functools import cache
from typing import Any

import numpy as np
import pytest
from tlismni.core import Result, simulate
from tlismni.models import load


@cache
def run(name: str, tolerance: float = 1.0, **parameters: Any) -> Result:
    s = load(name, **parameters)
    return simulate(s.model, s.t_end, s.method, tolerance * s.rtol, tolerance * s.atol, **s.options)


# ---- sphere_beam ----------------------------------------


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "parameters", [{}, {"formulation": "floating", "modes": 8}], ids=["modes", "floating frame and material point"]
)
def test_sphere_on_beam_is_timoshenkos(parameters: dict[str, Any]) -> None:
    """First case of Timoshenko (1913): reference by modes 1, 3, ... 199 and an explicit method of order 8."""
    result = run("sphere_beam", **parameters)
    force = result["blow.normal_force"]
    first, last = result.events
    assert (first.kind, last.kind) == ("close", "open")
    assert force.max() == pytest.approx(4.9772, rel=5e-4)
    assert result.t[force.argmax()] - first.t == pytest.approx(0.07256e-3, rel=5e-3)
    assert last.t - first.t == pytest.approx(0.1564e-3, rel=1e-3)
    assert result["blow.impulse"][-1] == pytest.approx(4.34231e-4, rel=1e-4)
    assert result["sphere.vy"][-1] == pytest.approx(3.0232e-3, rel=1e-4)
    mass = 7960.0 * 4.0 / 3.0 * math.pi * 1e-6
    assert result["blow.impulse"][-1] == pytest.approx(mass * (0.01 + result["sphere.vy"][-1]), rel=1e-6)
    assert np.abs(result["energy.balance"]).max() < 1e-6 * 0.5 * mass * 0.01**2


def test_both_formulations_of_the_beam_are_one() -> None:
    modes, floating = (run("sphere_beam", formulation=name, modes=8) for name in ("modes", "floating"))
    t = np.linspace(0.0, modes.t[-1], 400)
    force, other = (np.interp(t, r.t, r["blow.normal_force"]) for r in (modes, floating))
    assert np.abs(force - other).max() < 2e-3 * force.max()
    # the floating one has its modes from finite elements, 4 for each
    assert floating["blow.impulse"][-1] == pytest.approx(modes["blow.impulse"][-1], rel=1e-5)


# ---- hub_beam_stop ----------------------------------------

VARIANTS = [(f, c) for f in ("floating", "ancf") for c in ("ccm", "ccfm")]


def moment_of_momentum(formulation: str, contact: str, sample: int) -> float:
    """About the axle, of the hub and of the beam's material points by Gauss's formula, N m s."""
    result = run("hub_beam_stop", formulation=formulation, contact=contact)
    beam: Any = load("hub_beam_stop", formulation=formulation, contact=contact).model.bodies[1]
    value = {r.name: result[f"beam.{r.name}"][sample] for r in beam.coordinate_records()}
    rate = {r.name: result[f"beam.{r.rate}"][sample] for r in beam.coordinate_records()}
    total = 0.1 * result["hub.angular_velocity"][sample]
    for x, weight in zip(*np.polynomial.legendre.leggauss(40), strict=True):
        point = beam.material_point((0.25 * (x + 1.0), 0.0))
        frame = point.frame or ()
        given = [[table[name] for name in names] for table in (value, rate) for names in (frame, point.local)]
        if not frame:
            given[0] = given[2] = [0.0, 0.0, 0.0]
        (px, py, _), (vx, vy, _) = point.place(*given[:2]), point.rates(*given)
        total += 0.25 * weight * 7850.0 * 1e-4 * (px * vy - py * vx)
    return float(total)


@pytest.mark.sampled(1)
@pytest.mark.parametrize("formulation, contact", VARIANTS)
def test_hub_with_beam_keeps_its_balances(formulation: str, contact: str) -> None:
    """Energy; moment of momentum about the axle against the moment of the stop's impulse, which acts at the tip."""
    result = run("hub_beam_stop", formulation=formulation, contact=contact)
    density = 7850.0 * 1e-4
    inertia = 0.1 + density * (0.55**3 - 0.05**3) / 3.0
    energy = 0.5 * inertia * 2.0**2
    assert result["energy.kinetic"][0] == pytest.approx(energy, rel=1e-6)
    assert np.abs(result["energy.balance"]).max() < 1e-5 * energy
    assert result.events[0].t == pytest.approx(0.01, rel=1e-5)  # rigid until then
    assert result["residual.position"].max() < 1e-9
    # the axle carries no moment: what the stop took is its impulse times the tip's arm, 0.55 m but for the bending
    start, end = (moment_of_momentum(formulation, contact, k) for k in (0, -1))
    assert start == pytest.approx(inertia * 2.0, rel=1e-6)
    assert end - start == pytest.approx(-0.55 * result["stop.impulse"][-1], rel=2e-3)
    # and the hub alone, between stop and clamp
    given = np.trapezoid(result["clamp.torque"], result.t) if contact == "ccfm" else None
    if given is not None:
        hub = 0.1 * (result["hub.angular_velocity"][-1] - 2.0)
        pull = np.trapezoid(
            0.05 * (
                np.cos(result["hub.angle"]) * result["clamp.force_y"]
                - np.sin(result["hub.angle"]) * result["clamp.force_x"]
            ),
            result.t,
        )  # fmt: skip
        assert hub == pytest.approx(-given - pull, rel=2e-3)


def test_all_variants_agree_on_the_impulse() -> None:
    impulses = [run("hub_beam_stop", formulation=f, contact=c)["stop.impulse"][-1] for f, c in VARIANTS]
    assert max(impulses) / min(impulses) - 1.0 < 1e-3
    # a little less than the full rebound of a hub on a massless spring: the beam keeps vibrating
    rigid = 0.1 + 0.785 * (0.55**3 - 0.05**3) / 3.0
    assert 0.8 < np.mean(impulses) / (2.0 * rigid * 2.0 / 0.55) < 1.0


@pytest.mark.sampled(1)
@pytest.mark.parametrize("formulation, parameter", [("floating", "modes"), ("ancf", "elements")])
def test_impulse_converges_and_the_impact_loses_ever_less(formulation: str, parameter: str) -> None:
    """The mass at the tip that an impact stops goes to zero as the beam is resolved, and its energy with it."""
    results = [run("hub_beam_stop", formulation=formulation, **{parameter: n}) for n in (2, 4, 8)]
    impulses = [r["stop.impulse"][-1] for r in results]
    assert abs(impulses[2] - impulses[1]) < abs(impulses[1] - impulses[0])
    assert impulses[2] == pytest.approx(impulses[1], rel=2e-3)
    losses = [r.events[0].energy_loss for r in results]
    assert losses[0] > 1.5 * losses[1] > 2.25 * losses[2] > 0.0


def test_impulse_does_not_depend_on_the_tolerances() -> None:
    loose, tight = (run("hub_beam_stop", tolerance)["stop.impulse"][-1] for tolerance in (10.0, 0.1))
    assert loose == pytest.approx(tight, rel=1e-5)


@pytest.mark.parametrize("formulation", ["floating", "ancf"])
def test_an_undamped_beam_goes_through_its_first_blows(formulation: str) -> None:
    """Right after the impact nothing presses the tip against the stop, but the rest of the beam still approaches: the
    contact stays closed until that arrives."""
    s = load("hub_beam_stop", formulation=formulation, elements=4, damping_time=0.0)
    result = simulate(s.model, 0.011, s.method, s.rtol, s.atol, **s.options)
    impact, close, leave = result.events[:3]
    assert [e.kind for e in (impact, close, leave)] == ["impact", "close", "open"]
    assert close.t == impact.t and leave.t > impact.t + 1e-6
    closed = (result["stop.in_contact"] > 0.0) & (result.t < leave.t)
    assert result["stop.normal_force"][closed].max() > 1.0
    assert np.abs(result["energy.balance"]).max() < 1e-5


# ---- flexible_slider_crank_stop ----------------------------------------


def test_flexible_slider_crank_touches_when_the_rigid_one_does_and_bends_a_little() -> None:
    result = run("flexible_slider_crank_stop")
    rigid = load("slider_crank_stop", driven=False, crank_speed=10.0, rod_mass=7870.0 * 0.008**2 * 0.3)
    expected = simulate(rigid.model, 0.2)
    assert result.events[0].t == pytest.approx(expected.events[0].t, rel=1e-4)
    assert result.events[0].separation_speed == pytest.approx(0.5 * result.events[0].approach_speed, rel=1e-6)
    # in bending the rod gives way at once: the slider feels a little less than the rigid mechanism's inertia
    assert 0.95 < result.events[0].impulse / expected.events[0].impulse < 1.0
    assert np.abs(result["energy.balance"]).max() < 1e-5
    assert result["residual.position"].max() < 1e-10
    angle = result["rod.angle"]
    bend = np.cos(angle) * (result["middle.y"] - result["rod.y"]) - np.sin(angle) * (
        result["middle.x"] - result["rod.x"]
    )
    assert 2e-5 < np.abs(bend).max() < 3e-4


def test_a_stiff_rod_with_a_force_law_moves_as_the_rigid_mechanism() -> None:
    """Hertz's contact lasts longer than the vibrations of a rod that is a hundred times stiffer."""
    result = run("flexible_slider_crank_stop", law="hertz", youngs_modulus=2e13, stiffness=1e6, damping_ratio=0.2)
    rigid = load(
        "slider_crank_stop", law="hertz", stiffness=1e6, driven=False, crank_speed=10.0,
        rod_mass=7870.0 * 0.008**2 * 0.3,
    )  # fmt: skip
    expected = simulate(rigid.model, 0.2)
    assert result["stop.impulse"][-1] == pytest.approx(expected["stop.impulse"][-1], rel=2e-3)
    assert result["crank.angle"][-1] == pytest.approx(expected["crank.angle"][-1], abs=2e-3)


def test_a_rod_that_stretches_gives_the_impulse_bit_by_bit() -> None:
    """Its end has less mass for the impact: more and smaller blows, and in the end about the same impulse."""
    stretching, stiff = run("flexible_slider_crank_stop", axial=True), run("flexible_slider_crank_stop", law="hertz")
    first = stretching.events[0]
    assert first.impulse < 0.3 * stiff["stop.impulse"][-1]
    assert stretching["stop.impulse"][-1] == pytest.approx(stiff["stop.impulse"][-1], rel=0.15)
