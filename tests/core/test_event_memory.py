"""Memory of a run does not grow with the number of its events, but for the list of them."""

import gc
import tracemalloc

from tlismni.core import Simulation
from tlismni.models import load


def test_memory_of_a_run_does_not_grow_with_its_events():
    sim = Simulation(load("bouncing_ball", restitution=0.998).model)
    sim.advance(20.0)
    own = sum(x.nbytes for group in sim.workspace.memory() for x in group)
    tracemalloc.start()
    try:
        sizes, counts = [], []
        for t in (100.0, 200.0, 300.0):
            sim.advance(t)
            counts.append(len(sim.events))
            sim.events.clear()
            gc.collect()
            sizes.append(tracemalloc.get_traced_memory()[0])
    finally:
        tracemalloc.stop()
    assert min(counts) > 100
    # one number of 8 bytes an event would be more
    assert sizes[2] - sizes[1] < 8 * counts[2]
    assert sum(x.nbytes for group in sim.workspace.memory() for x in group) == own
