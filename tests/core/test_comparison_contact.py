"""The comparison methods run through the same contact machine: events on their own trajectory, impacts, closing."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, ball_over_floor, events, on, residuals
from scipy.integrate import solve_ivp
from test_comparison_methods import VARIANTS, run
from test_pendulum_stop import IMPACTS, T_END, E
from tlismni.core import Disk2D, DiskOnDisk2D, Flores, Model, NewtonImpact, PointMass2D, SimulationError, simulate
from tlismni.models import load

INDEX_3 = ("hht_i3", "generalized_alpha index3")


@pytest.mark.parametrize("name", VARIANTS)
def test_bouncing_ball_hits_at_the_times_of_the_closed_form_and_comes_to_rest(name):
    """Free flight is a parabola, exact for every formula."""
    fall, restitution = math.sqrt(2.0 / G), 0.8
    result = run(name, ball_over_floor(NewtonImpact(restitution=restitution)), 5.0)
    exact = [fall * (1.0 + 2.0 * sum(restitution**k for k in range(1, n))) for n in range(1, 11)]
    times = [event.t for event in events(result, "impact")][:10]
    assert np.abs(np.array(times) - exact).max() < 1e-10
    (rest,) = events(result, "rest")
    after = result.t > rest.t
    assert np.abs(result["floor.gap"][after]).max() < 1e-12
    assert result["floor.normal_force"][after] == pytest.approx(G, rel=1e-9)


@pytest.mark.parametrize("name", VARIANTS)
def test_pendulum_hits_its_stop_as_often_and_when_it_should(name):
    model = load("pendulum_stop", restitution=E, driven=False).model
    result = run(name, model, T_END, 1e-7, 1e-9)
    impacts = events(result, "impact")
    assert len(impacts) == len(IMPACTS)
    assert np.abs(np.array([event.t for event in impacts]) - IMPACTS).max() < 1e-4
    assert max(event.velocity_increment_residual for event in impacts) < 1e-12
    assert result["stop.gap"].min() > -1e-12
    assert np.abs(result["energy.balance"]).max() < 2e-3


@pytest.mark.parametrize("name", VARIANTS)
def test_pendulum_rests_against_its_stop(name):
    scenario = load("pendulum_stop", restitution=0.4, stop_angle=-0.5, driven=False)
    result = run(name, scenario.model, 3.0)
    (rest,) = events(result, "rest")
    late = result.t > rest.t + 0.1
    assert result["stop.normal_force"][late] == pytest.approx(0.5 * G * math.cos(0.5), rel=1e-3)
    assert np.abs(result["stop.gap"][result.t > rest.t]).max() < 1e-10


@pytest.mark.parametrize("name", VARIANTS)
def test_force_law_contact_balances_its_energy(name):
    result = run(name, ball_over_floor(Flores(stiffness=1e4, restitution=0.6)), 1.5, 1e-7, 1e-9)
    kinds = [event.kind for event in result.events]
    assert kinds[:4] == ["close", "open", "close", "open"]
    assert np.abs(result["energy.balance"]).max() < 2e-3
    assert result["energy.dissipation"][-1] > 1.0


# ---- a contact that opens while it moves ----------------------------------------------------------------------------

START, SPEED = 0.1, 0.5


def bead_on_a_hill():
    """A bead slides down a fixed disk of radius 1 from `START` (from the top) with `SPEED`."""
    c, s = math.cos(START), math.sin(START)
    bead = PointMass2D(name="bead", mass=1.0, position=(s, c), velocity=(SPEED * c, -SPEED * s))
    hill = DiskOnDisk2D(
        name="hill", a=Disk2D(marker=GROUND, radius=1.0), b=Disk2D(marker=on("bead")), law=NewtonImpact(restitution=0.0)
    )
    return Model(bodies=[bead], contacts=[hill], gravity=(0.0, -G))


def leaving_time():
    """When g cos(angle) = angle'^2 = SPEED^2 + 2 g (cos START - cos angle): the hill carries no force."""
    angle = math.acos((SPEED**2 + 2.0 * G * math.cos(START)) / (3.0 * G))

    def there(t, y):
        return y[0] - angle

    there.terminal = True
    found = solve_ivp(
        lambda t, y: [y[1], G * math.sin(y[0])],
        (0.0, 2.0),
        [START, SPEED],
        "DOP853",
        events=there,
        rtol=1e-13,
        atol=1e-13,
    )
    return found.t_events[0][0]


LEAVES = leaving_time()


@pytest.mark.parametrize("name", [name for name in VARIANTS if name not in INDEX_3])
def test_bead_leaves_the_hill_once_and_in_time(name):
    result = run(name, bead_on_a_hill(), LEAVES + 0.1)
    assert [event.kind for event in result.events] == ["close", "open"]
    (left,) = events(result, "open")
    assert left.t == pytest.approx(LEAVES, abs=1e-3)
    # it leaves with the gap that the method has let grow, and goes on from there
    assert result["hill.gap"][-1] > 1e-4


@pytest.mark.parametrize("name", [name for name in VARIANTS if name.startswith(("baumgarte", "unstabilised"))])
def test_gap_of_a_closed_contact_drifts_where_positions_are_not_constrained(name):
    result = run(name, bead_on_a_hill(), 0.9 * LEAVES)
    closed = result["hill.mode"] == 1.0
    assert 1e-11 < np.abs(result["hill.gap"][closed]).max() < 1e-4


@pytest.mark.parametrize("name", ["projection", "hht_i3", "hht_ggl", "generalized_alpha index2"])
def test_gap_of_a_closed_contact_does_not_drift_where_they_are(name):
    result = run(name, bead_on_a_hill(), 0.9 * LEAVES)
    assert residuals(result)[0] < 1.1e-10


POSITIONS_ALONE = (1e-6, {"length": 1e-9, "speed": 1e3})
"""rtol and atol with which no error of a velocity counts."""


@pytest.mark.parametrize("name", INDEX_3)
def test_oscillating_multiplier_of_index_3_opens_the_contact_too_early(name):
    """With error-controlled steps each change of the step excites the multiplier, which crosses zero before its time.
    The velocity, which misses its constraint, then drives the bead into the hill again: an impact that is none."""
    result = run(name, bead_on_a_hill(), LEAVES + 0.1, *POSITIONS_ALONE)
    opened = events(result, "open")
    assert opened[0].t < LEAVES - 5e-3
    assert len(events(result, "impact")) >= 1
    steady = simulate(bead_on_a_hill(), LEAVES + 0.1, "ebdf")
    assert [event.kind for event in steady.events] == ["close", "open"]


@pytest.mark.parametrize("name, early, impacts", [("hht_i3", 5e-4, 0), ("generalized_alpha index3", 5e-3, 1)])
def test_control_of_its_velocities_makes_index_3_open_less_early_but_not_in_time(name, early, impacts):
    runs = [run(name, bead_on_a_hill(), LEAVES + 0.1, *tolerances) for tolerances in (POSITIONS_ALONE, ())]
    before, after = (events(result, "open")[0].t for result in runs)
    assert before < after < LEAVES - early
    assert len(events(runs[1], "impact")) >= impacts


def test_contact_that_chatters_ends_in_an_error_that_says_so():
    """alpha = 1/h makes the force follow the size of a step: no step ends where it vanishes."""
    with pytest.raises(SimulationError, match="the contact chatters") as caught:
        run("baumgarte rk23", bead_on_a_hill(), LEAVES + 0.1, step=0.01, rule="step")
    assert caught.value.loop == "event"
    assert len(caught.value.partial) > 10
