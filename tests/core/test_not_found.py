"""What an instant of many contacts has not found is counted, and told once."""

import logging

import pytest
from stacks import stack
from tlismni.core import Simulation
from tlismni.core.state.run_records import LEFT_APPROACH, UNSHARED_LOAD


def test_stats_have_both():
    sim = Simulation(stack(2, 1, 40.0))
    assert sim.stats["unshared_loads"] == sim.stats["left_approaches"] == 0


@pytest.mark.parametrize(("kind", "counted"), [(UNSHARED_LOAD, "unshared_loads"), (LEFT_APPROACH, "left_approaches")])
def test_only_the_first_is_told_and_it_is_no_event(kind, counted, caplog):
    sim = Simulation(stack(2, 1, 40.0))
    sim.drive.take_events()
    with caplog.at_level(logging.WARNING):
        for t in (0.25, 0.5):
            sim.drive.events[0], sim.drive.events[0, :3] = 0.0, (t, kind, 0)
            sim.drive.counts.events = 1
            assert sim.drive.take_events() == []
    (said,) = [record.getMessage() for record in caplog.records]
    assert "0.25" in said and counted in said and sim.assembly.contacts[0].name in said
