"""Structures are kept, a certain number of them: how many makes no difference."""

import numpy as np
import pytest
from test_heap import heap
from tlismni.core import Simulation
from tlismni.core.assembly import workspace
from tlismni.models import load


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "build, t_end",
    [
        (lambda: heap(5, 0.3, 0.4, 0), 0.6),
        (lambda: load("woodpecker").model, 0.4),
        (lambda: load("cable_ground").model, 0.5),
    ],
    ids=["heap", "woodpecker", "cable"],
)
def test_few_kept_patterns_change_no_bit(build, t_end, monkeypatch):
    plenty = Simulation(build())
    plenty.advance(t_end)
    monkeypatch.setattr(workspace, "MOST_STRUCTURES", 3)
    short = Simulation(build())
    short.advance(t_end)
    assert len(short.workspace.slots) <= 3
    assert len(plenty.workspace.slots) > 3 or t_end == 0.4
    assert short.events == plenty.events
    assert np.array_equal(short.values(), plenty.values())
