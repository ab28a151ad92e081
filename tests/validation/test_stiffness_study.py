"""Contact forces of growing stiffness come to the impact of a constraint with the rate of theory."""

import math

import pytest
from tlismni.validation.study.stiffness import CASES, STIFFNESSES, StiffnessCase, StiffnessRow, hertz_duration, measure

SPEED = math.sqrt(2.0 * 9.81)
"""Of the ball at the floor."""
ROWS: dict[str, StiffnessRow] = {}


def row(case: StiffnessCase) -> StiffnessRow:
    """Each case is run once."""
    return ROWS.setdefault(case.label, measure(case))


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.label)
def test_duration_and_trajectory_approach_as_stiffness_to_the_minus_one_over_n_plus_one(case: StiffnessCase) -> None:
    found = row(case)
    duration, position, _ = found.rates
    assert duration == pytest.approx(-1.0 / (case.exponent + 1.0), abs=2e-3)
    assert position == pytest.approx(-1.0 / (case.exponent + 1.0), abs=5e-3)
    assert found.ok
    for k in range(3):
        sizes = [abs(d[k]) for d in found.differences]
        assert sizes == sorted(sizes, reverse=True)


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.label)
def test_impulse_approaches_as_the_duration_where_weight_acts_along_the_normal(case: StiffnessCase) -> None:
    """At the pendulum's lowest point it does not: there the moment of the weight grows with the penetration, and the
    impulse differs by the product of penetration and duration."""
    along = case.scenario == "bouncing_ball" or bool(case.settings)
    rate = -1.0 / (case.exponent + 1.0) * (1.0 if along else 2.0)
    assert row(case).rates[2] == pytest.approx(rate, abs=0.01 if along else 0.02)


def test_elastic_blow_has_to_carry_the_weight_for_its_duration() -> None:
    """m g T_c over the impulse 2 m v of the impact. (Damping makes the rebound slower too.)"""
    duration, _, impulse = row(CASES[0]).differences[-1]
    assert impulse == pytest.approx(9.81 * duration / (2.0 * SPEED), rel=2e-3)


def test_ball_without_damping_is_late_by_the_duration_of_the_blow() -> None:
    """A quarter of the way to the next impact it moves with half the speed that it left with."""
    duration, position, _ = row(CASES[0]).differences[-1]
    assert position == pytest.approx(-0.5 * SPEED * duration, rel=2e-3)


@pytest.mark.parametrize("k", [3, 4, 5])
def test_duration_is_that_of_hertz_in_the_limit(k: int) -> None:
    """Weight lengthens the blow by a relative 1/K^(2/5); the pendulum's effective mass is 1/3 kg."""
    stiffness = STIFFNESSES[k]
    ball = row(CASES[0]).differences[k][0]
    assert ball == pytest.approx(hertz_duration(1.0, stiffness, 1.5, SPEED), rel=3.0 / stiffness**0.4)
    rod = next(case for case in CASES if case.scenario == "pendulum_stop" and case.law == "hertz")
    speed = math.sqrt(3.0 * 9.81 * math.sin(1.0))
    assert row(rod).differences[k][0] == pytest.approx(
        hertz_duration(1.0 / 3.0, stiffness, 1.5, speed), rel=3.0 / stiffness**0.4
    )


def test_hertz_duration_is_the_known_one() -> None:
    """Half a period for n = 1; 2.9432751843 d_max/v for n = 3/2."""
    assert hertz_duration(2.0, 8.0, 1.0, 0.3) == pytest.approx(math.pi / 2.0, rel=1e-14)
    deepest = (1.25 * 2.0 * 0.3**2 / 8.0) ** 0.4
    assert hertz_duration(2.0, 8.0, 1.5, 0.3) == pytest.approx(2.9432751843 * deepest / 0.3, rel=1e-10)


def test_wrong_rate_would_show() -> None:
    stiffnesses = (1e5, 1e6, 1e7)
    right = tuple((k**-0.4, k**-0.4, k**-0.8) for k in stiffnesses)
    assert StiffnessRow(CASES[0], stiffnesses, right).ok
    for wrong in (tuple((k**-0.4, k**-0.2, k**-0.4) for k in stiffnesses), tuple((k**-0.5,) * 3 for k in stiffnesses)):
        assert not StiffnessRow(CASES[0], stiffnesses, wrong).ok
