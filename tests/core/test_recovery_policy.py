"""What follows where steps cannot be made (`core/recovery/policy.py`): in which order, and the same however a run is
asked for."""

import math

import pytest
from stacks import stack
from tlismni.core import Simulation, State
from tlismni.core.recovery.policy import MOST_LOCATIONS, recover
from tlismni.core.recovery.step_division import ALLOWANCE, MOST_HALVINGS
from tlismni.core.state.run_records import (
    DIVIDES,
    DONE,
    FALL_BACK,
    JAM,
    LAST_RESORT,
    NEAR_SINGULAR,
    NOT_DONE,
    OTHER_ROWS,
    REACHED,
    REPARTITION,
    STEP_TOO_SMALL,
    UNLOCATED,
    UNREPAIRED,
    VIOLATED,
)
from tlismni.core.state.workspace_records import (
    INNER_DIVERGED,
    NOT_FINITE,
    OK,
    OUTER_DIVERGED,
    OUTER_SLOW,
    REANALYZE,
    convergence_of,
)
from tlismni.models import load

H = 1e-3
DIVIDED = {
    "a block tips over the edge of another": (lambda: stack(2, 1, 20.0), 1.0),
    "a cable reaches the ground": (lambda: load("cable_ground").model, 0.3),
    "a mass on a rod strikes": (lambda: load("mass_on_rod").model, 1.5e-3),
}
"""Runs with fixed steps of H, and their ends, s."""


class Asked:
    """A run on its way, and what its policy says of failures."""

    def __init__(self, name, t=0.1, **settings):
        self.sim = Simulation(load(name).model, **settings)
        self.sim.advance(t)

    def __call__(self, code):
        return recover(self.sim.drive.record.record, code)

    def answer(self, what):
        self.sim.drive.answer(what)
        return self(OK)

    def strain(self):
        """The constraints become nearly dependent."""
        rate = convergence_of(self.sim.workspace.arrays["rate"])
        rate.least_condition, rate.worst_condition = 1.0, 1e6


def test_new_pivots_then_smaller_steps():
    asked = Asked("pendulum_stop")
    sim, clock = asked.sim, asked.sim.clock
    partitions = sim.stats["partitions"]
    assert asked(INNER_DIVERGED) == OK and sim.stats["partitions"] == partitions + 1
    assert clock.repaired_at == sim.t_internal
    clock.trial_step = 0.01
    assert asked(INNER_DIVERGED) == OK and clock.step_size == 0.0025 and sim.stats["partitions"] == partitions + 1
    assert asked(REANALYZE) == OK and clock.repaired_at == -math.inf
    assert asked(REANALYZE) == OK and sim.stats["partitions"] == partitions + 2
    assert asked(OUTER_SLOW) == OUTER_SLOW and clock.repaired_at == -math.inf
    assert asked(NOT_FINITE) == NOT_FINITE and asked(STEP_TOO_SMALL) == STEP_TOO_SMALL and asked(JAM) == JAM
    assert sim.stats["partitions"] == partitions + 2
    clock.trial_step = 1e-30
    assert asked(INNER_DIVERGED) == OK and asked(INNER_DIVERGED) == INNER_DIVERGED


def test_a_singular_position_is_passed_before_a_run_is_given_up():
    asked = Asked("slider_crank")
    asked.strain()
    assert asked(NOT_FINITE) == LAST_RESORT and asked.answer(NOT_DONE) == NOT_FINITE
    assert asked(NOT_FINITE) == LAST_RESORT and asked.answer(DONE) == OK
    assert asked(NEAR_SINGULAR) == NEAR_SINGULAR and asked.answer(NOT_DONE) == OK
    assert asked(NEAR_SINGULAR) == NEAR_SINGULAR and asked.answer(DONE) == OK
    assert asked(REPARTITION) == OK and asked(REACHED) == REACHED


def test_fixed_steps_are_halved_and_grow_again():
    asked = Asked("pendulum", method="hht", step=H)
    sim, clock, start = asked.sim, asked.sim.clock, asked.sim.t_internal
    asked.strain()
    clock.trial_step, steps = H, sim.stats["steps"]
    assert asked(OUTER_DIVERGED) == OK and clock.fixed_step == H
    assert asked(OUTER_DIVERGED) == DIVIDES and clock.fixed_step == H / 2
    assert asked(OUTER_DIVERGED) == OK and clock.fixed_step == H / 4
    assert clock.parts_until == start + H and sim.divided_steps == 1
    assert asked(NOT_FINITE) == OK and clock.fixed_step == H / 8 and clock.parts_until == start + H / 2
    assert asked(REACHED) == REACHED  # something else than the end of its parts
    sim.advance(start + H)
    assert sim.t_internal == start + H and clock.fixed_step == H and clock.halvings == 0.0
    assert sim.stats["steps"] == steps + 6  # 4 parts of H/8, then 2 of H/4
    clock.trial_step = H
    halvings = [asked(NOT_FINITE) for _ in range(MOST_HALVINGS)]
    assert halvings == [DIVIDES, *[OK] * (MOST_HALVINGS - 1)] and asked(NOT_FINITE) == NOT_FINITE
    sim.drive.end_recovery(clock)
    assert clock.fixed_step == H
    clock.divided_steps = ALLOWANCE + 0.1 * sim.t_internal / H + 1.0
    assert asked(NOT_FINITE) == NOT_FINITE


def test_the_limit_of_the_simple_iteration_is_told():
    assert Asked("pendulum", method="hht", step=H, outer="simple")(NOT_FINITE) == NOT_FINITE
    asked = Asked("pendulum", method="hht", step=H, outer="simple", fallback=True)
    assert asked(OUTER_SLOW) == FALL_BACK
    asked.sim.use_outer_loop("newton")
    assert asked(OUTER_SLOW) == OK and asked(OUTER_SLOW) == DIVIDES


def test_rows_that_repeat_others_are_looked_at_by_whoever_can():
    asked = Asked("bricard")
    assert asked(REPARTITION) == REPARTITION and asked.answer(DONE) == OK
    assert asked(REPARTITION) == REPARTITION and asked.answer(NOT_DONE) == UNREPAIRED
    assert asked(REANALYZE) == REPARTITION and asked.answer(OTHER_ROWS) == OK
    asked.sim.clock.repaired_at = -math.inf
    assert asked(REANALYZE) == REPARTITION and asked.answer(NOT_DONE) == UNREPAIRED
    asked.strain()
    assert asked(REANALYZE) == REPARTITION and asked.answer(NOT_DONE) == LAST_RESORT
    assert asked.answer(NOT_DONE) == UNREPAIRED
    assert asked(VIOLATED) == REPARTITION and asked.answer(OTHER_ROWS) == OK
    assert asked(VIOLATED) == REPARTITION and asked.answer(DONE) == NEAR_SINGULAR and asked.answer(NOT_DONE) == VIOLATED
    assert asked(VIOLATED) == REPARTITION and asked.answer(NOT_DONE) == UNREPAIRED


def test_an_event_is_searched_for_with_new_pivots():
    """There is none in the step, so that it ends with a shorter one."""
    asked = Asked("pendulum_stop", 0.05)
    sim = asked.sim
    sim.clock.trial_step, before = 1e-3, sim.stats["partitions"]
    assert asked(UNLOCATED) == OK and sim.stats["partitions"] == before + MOST_LOCATIONS
    assert sim.clock.step_size == 0.25e-3
    sim.clock.trial_step = 1e-30
    assert asked(UNLOCATED) == UNLOCATED


def begun(name):
    """A run with `hht`, and its end."""
    make, end = DIVIDED[name]
    return Simulation(make(), "hht", step=H), end


def by_events(sim, end, seen=lambda: None):
    """To `end` (s), each event for itself."""
    while sim.advance_to_event(end):
        seen()
        while sim.handle_event():
            pass


@pytest.mark.parametrize("name", DIVIDED)
def test_events_do_not_end_the_division_of_a_step(name):
    """Whoever stops at each event gets the run of who does not."""
    (whole, end), (stopped, _) = begun(name), begun(name)
    whole.advance(end)
    by_events(stopped, end)
    assert whole.divided_steps > 0 and whole.clock.fixed_step == H
    assert stopped.stats == whole.stats and stopped.events == whole.events
    assert stopped.state() == whole.state()


def test_an_event_within_a_divided_step_comes_in_its_time():
    """Whoever asks for a time before it sees the free motion: at 0.1 m/s towards the stop, 5e-5 m away."""
    sim, _ = begun("a mass on a rod strikes")
    sim.advance(3e-4)
    assert sim.divided_steps == 1 and not sim.events
    assert sim.values()[:2] == pytest.approx([-2e-5, 0.1], rel=1e-9)
    sim.advance(5.1e-4)
    assert [event.kind for event in sim.events] == ["impact", "close"]


def test_a_state_within_a_divided_step_leads_on():
    """As bytes, too. Events of the cable come while a step is divided."""
    (sim, end), (other, _) = begun("a cable reaches the ground"), begun("a cable reaches the ground")
    states = []
    by_events(sim, end, lambda: states.append(sim.state()) if sim.clock.halvings else None)
    assert states
    for state in (states[0], states[-1]):
        other.restore(State.from_bytes(state.to_bytes()))
        assert other.state() == state
        assert other.clock.fixed_step < H and other.clock.parts_until >= other.t
        other.advance(end)
        assert other.state() == sim.state()


def test_how_many_steps_have_been_divided_decides():
    """A tenth of all may be: a run that has divided more gives up earlier."""
    sim, end = begun("a block tips over the edge of another")
    sim.advance(end)
    before, divided = sim.state(), sim.divided_steps
    sim.clock.divided_steps += 1.0
    assert sim.state() != before and sim.stats["divided_steps"] == divided + 1


def test_what_was_done_at_a_row_that_is_left_is_in_no_state():
    sim = Simulation(load("pendulum_stop").model)
    sim.advance(0.2)
    state = sim.state()
    sim.clock.repaired_at = 0.1
    assert sim.state() == state
    sim.clock.repaired_at = sim.t_internal
    assert sim.state() != state
