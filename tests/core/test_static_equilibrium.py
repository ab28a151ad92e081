"""Places of rest against closed forms."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, ball_over_floor, floor_contact, on, rod_pendulum
from tlismni.core import (
    Bushing2D,
    Distance2D,
    Hertz,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    SimulationError,
    SpringDamper2D,
    simulate,
)
from tlismni.core.analysis import static_equilibrium
from tlismni.models import load


@pytest.mark.parametrize("angle", [0.0, 1.2, -3.0])
def test_a_pendulum_hangs_wherever_it_starts(angle):
    """Even from near the top it creeps all the way down."""
    rest = static_equilibrium(rod_pendulum(angle))
    assert rest["rod.y"] == pytest.approx(-0.5, abs=1e-12)
    assert math.cos(rest["rod.angle"]) == pytest.approx(0.0, abs=1e-10)
    assert abs(rest["pin.force_y"]) == pytest.approx(G)
    assert rest.unbalanced < 1e-12


def test_masses_on_springs_stretch_them():
    """Two masses, one below the other: the upper spring carries both."""
    k, m = 300.0, 2.0
    masses = [PointMass2D(name=f"m{i}", mass=m, position=(0.0, -1.0 - i)) for i in range(2)]
    ends = [GROUND, on("m0"), on("m1")]
    springs = [
        SpringDamper2D(name=f"s{i}", a=ends[i], b=ends[i + 1], stiffness=k, natural_length=1.0) for i in range(2)
    ]
    rest = static_equilibrium(Model(bodies=masses, forces=springs))
    assert rest["m0.y"] == pytest.approx(-1.0 - 2.0 * m * G / k, rel=1e-10)
    assert rest["m1.y"] == pytest.approx(-2.0 - 3.0 * m * G / k, rel=1e-10)


def test_a_hanging_chain_is_a_funicular_polygon():
    """Equal links and weights: the horizontal force is one, the slopes are in an arithmetic progression."""
    links, span, length = 10, 6.0, 1.0
    x = np.linspace(0.0, span, links + 1)
    height = math.sqrt(length**2 - (span / links) ** 2)
    y = -height * np.abs(np.mod(np.arange(links + 1), 2))
    masses = [PointMass2D(name=f"p{i}", mass=1.0, position=(x[i], y[i])) for i in range(1, links)]
    ends = [GROUND, *(on(f"p{i}") for i in range(1, links)), Marker2D(point=(span, 0.0))]
    rods = [Distance2D(name=f"r{i}", a=ends[i], b=ends[i + 1], length=length) for i in range(links)]
    rest = static_equilibrium(Model(bodies=masses, joints=rods))
    points = np.array([[0.0, 0.0], *([rest[f"p{i}.x"], rest[f"p{i}.y"]] for i in range(1, links)), [span, 0.0]])
    steps = np.diff(points, axis=0)
    slopes = steps[:, 1] / steps[:, 0]
    assert np.hypot(*steps.T) == pytest.approx(np.full(links, length), abs=1e-12)
    assert np.diff(slopes) == pytest.approx(np.full(links - 1, slopes[1] - slopes[0]), rel=1e-7)
    assert slopes == pytest.approx(-slopes[::-1], rel=1e-8)


def test_a_ball_rests_on_a_floor_that_is_a_constraint_and_on_one_that_gives_way():
    rest = static_equilibrium(ball_over_floor(NewtonImpact(restitution=0.5), mass=3.0))
    assert rest.closed == ("floor",)
    assert (rest["ball.y"], rest["floor.normal_force"]) == pytest.approx((0.0, 3.0 * G), abs=1e-12)
    rest = static_equilibrium(ball_over_floor(Hertz(stiffness=1e6)))
    assert rest["ball.y"] == pytest.approx(-((G / 1e6) ** (2 / 3)), rel=1e-9)


def test_a_floor_does_not_hold_what_is_pulled_off_it():
    """A spring holds the ball above the floor that it starts on."""
    model = ball_over_floor(NewtonImpact(restitution=0.5), height=0.0)
    spring = SpringDamper2D(name="s", a=Marker2D(point=(0.0, 3.0)), b=on("ball"), stiffness=20.0, natural_length=1.0)
    rest = static_equilibrium(Model(bodies=model.bodies, contacts=model.contacts, forces=[spring]))
    assert rest.closed == () and rest["ball.y"] == pytest.approx(2.0 - G / 20.0, rel=1e-10)


def test_a_cantilever_sags():
    """m g L^4/(8 EI) and F L^3/(3 EI) of a thin beam; the load is small, the deflection a thousandth."""
    scenario = load("cantilever", elements=8, gravity=0.0, tip_force=1e-4)
    p = scenario.parameters
    stiffness = p["youngs_modulus"] * math.pi * p["diameter"] ** 4 / 64.0
    rest = static_equilibrium(scenario.model)
    assert rest["tip.y"] == pytest.approx(1e-4 * p["length"] ** 3 / (3.0 * stiffness), rel=1e-3)


def test_a_run_from_rest_stays_there():
    rest = static_equilibrium(load("cable_pendulum", elements=4).model)
    result = simulate(rest.system, 0.3, start_values=rest.start_values)
    assert np.ptp(result.q, axis=0).max() < 1e-8
    assert np.abs(simulate(static_equilibrium(rod_pendulum(0.3)).model, 0.5).v).max() < 1e-8


def test_what_nothing_holds_is_named():
    ball = PointMass2D(name="ball", mass=1.0)
    with pytest.raises(SimulationError, match=r"no static equilibrium.*'ball.y'.*Hold what nothing holds"):
        static_equilibrium(Model(bodies=[ball]))
    # sideways nothing acts and nothing holds: that is a rest
    floor = floor_contact(NewtonImpact(restitution=0.0))
    assert static_equilibrium(Model(bodies=[ball], contacts=[floor]))["ball.x"] == pytest.approx(0.0, abs=1e-7)


def test_a_bushing_carries_an_eccentric_weight():
    """Force and torque of a linear bushing: F/k down, and the tilt of a lever arm."""
    model = rod_pendulum(0.0)
    bushing = Bushing2D(name="b", a=GROUND, b=on("rod", -0.5), stiffness=1e4, rotational_stiffness=1e3)
    rest = static_equilibrium(Model(bodies=model.bodies, forces=[bushing]))
    angle = rest["rod.angle"]
    assert 1e3 * angle == pytest.approx(-G * 0.5 * math.cos(angle), rel=1e-9)
    assert rest["rod.y"] == pytest.approx(0.5 * math.sin(angle) - G / 1e4, rel=1e-9)
