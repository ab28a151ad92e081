"""What a run is made of is freed with it, without the search for circles of references."""

import gc
from weakref import ref

import numpy as np
import pytest
from linkages import four_bar
from tlismni.core import EquationSystem, Simulation, simulate
from tlismni.core.assembly.structure import Structure
from tlismni.core.assembly.workspace import Workspace
from tlismni.core.compiled.weakly import Weakly
from tlismni.models import load


@pytest.fixture
def no_search():
    gc.collect()
    gc.disable()
    yield
    gc.enable()


def kept():
    """How many workspaces and structures there are. (What a proxy stands for may be gone: it has a type.)"""
    return sum(issubclass(type(x), Workspace | Structure) for x in gc.get_objects())


def equations():
    return EquationSystem(
        mass=np.eye(2), force=np.zeros(2), constraint=lambda t, q: q[0] - q[1], q0=[0.0, 0.0], v0=[1.0, 1.0]
    )


def scenario(name):
    return lambda: load(name).model


SYSTEMS = {
    "joints": lambda: four_bar(2, 0.5, -3.0),
    "redundant rows": scenario("bricard"),
    "contact": scenario("bouncing_ball"),
    "contact in space": scenario("spinning_sphere"),
    "own equations": equations,
}


@pytest.mark.parametrize("system", SYSTEMS)
def test_a_run_is_freed_with_its_result(system, no_search):
    model = SYSTEMS[system]()
    simulate(model, 0.05)  # what is kept on purpose for the next run of the same model
    before = kept()
    result = simulate(model, 0.05)
    del result
    assert kept() == before


@pytest.mark.parametrize("system", ["joints", "contact"])
def test_a_simulation_and_its_copies_are_freed(system, no_search):
    sim = Simulation(SYSTEMS[system]())
    sim.advance(0.02)
    state = sim.state()
    sim.advance(0.04)
    sim.restore(state)
    sim.advance(0.04)
    other = Simulation(SYSTEMS[system]())
    other.restore(state)
    parts = [ref(x) for x in (sim, sim.workspace, sim.workspace.structure, other, other.workspace)]
    del sim, other, state
    assert [part() for part in parts] == [None] * len(parts)


def test_a_run_over_a_singular_position_is_freed(no_search):
    model = four_bar(1, 0.3, -6.0)
    simulate(model, 0.2, rtol=1e-7, atol=1e-9)
    before = kept()
    result = simulate(model, 0.2, rtol=1e-7, atol=1e-9)
    assert result["v0.angle"][-1] < 0.0
    del result
    assert kept() == before


def test_memory_does_not_grow_with_the_number_of_runs(no_search):
    """Objects that are left after ten runs more, of which each has some hundreds."""
    model = four_bar(1, 0.5, -3.0)
    for _ in range(3):
        simulate(model, 0.02)
    before = len(gc.get_objects())
    for _ in range(10):
        simulate(model, 0.02)
    assert len(gc.get_objects()) < before + 100


def test_a_method_without_its_object_says_so():
    class Part:
        def number(self):
            return 3

    part = Part()
    number = Weakly(part.number)
    assert number() == 3
    del part
    with pytest.raises(ReferenceError, match="keep its simulation"):
        number()
