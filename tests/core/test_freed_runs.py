"""What a run is made of is freed with it, without the search for circles of references."""

import ctypes
import gc
from pathlib import Path
from weakref import ref

import numpy as np
import pytest
from linkages import four_bar
from tlismni.core import EquationSystem, Simulation, simulate
from tlismni.core.assembly.structure import Structure
from tlismni.core.assembly.workspace import Workspace
from tlismni.core.compiled.from_python import NO_VALUE, FromPython
from tlismni.core.compiled.weakly import Weakly
from tlismni.models import load

STATUS = Path("/proc/self/statm")


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


def test_own_equations_leave_nothing_for_the_search(no_search):
    """Their kernel calls Python through ctypes, whose functions refer to themselves once their address is cast."""
    for _ in range(3):
        simulate(equations(), 0.02)
    gc.collect()
    simulate(equations(), 0.02)
    assert gc.collect() == 0


def test_what_compiled_code_has_called_is_freed(no_search):
    """A step over a singular position is called so, with the simulation that it belongs to."""

    class Part:
        def status(self, step):
            raise ValueError(f"no step of {step}")

    part = Part()
    called, kept_by_it = FromPython(part.status), ref(part)
    del part
    assert kept_by_it() is not None
    value = np.zeros(1, dtype=np.int64)
    place = value.ctypes.data_as(ctypes.POINTER(ctypes.c_int64))
    called._entry(place, None, None, None, None, 0.5)
    assert value[0] == NO_VALUE
    with pytest.raises(ValueError, match=r"no step of 0\.5"):
        called.raise_error()
    called.raise_error()  # nothing is left
    del called
    assert kept_by_it() is None


@pytest.mark.skipif(not STATUS.exists(), reason="the memory of a process is read from Linux's /proc")
def test_memory_of_the_process_stays(no_search):
    """Megabytes after thirty runs more of four scenarios, in plane and space, each of which takes two or more."""
    scenarios = [load(name) for name in ("chain", "dropped_box", "rocking_block", "spinning_sphere")]

    def runs(count):
        for k in range(count):
            scenario = scenarios[k % len(scenarios)]
            simulate(scenario.model, 0.1 * scenario.t_end, method=scenario.method)
        return 4096e-6 * int(STATUS.read_text().split()[1])

    before = runs(16)
    gc.collect()
    assert runs(32) < before + 8.0
    assert gc.collect() == 0


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
