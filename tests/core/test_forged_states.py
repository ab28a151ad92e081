"""Solver states with a right checksum and wrong content are refused in words, and the simulation stays as it was.

The forging is done in a process of its own: an index out of range in compiled code would end it.
"""

import copy
import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest
from tlismni.core import ModelError, Simulation, TlismniError
from tlismni.core.simulation.state import State
from tlismni.models import load

CASES = {
    "a pendulum over impacts": ("pendulum_stop", {}, "ebdf", 1.2),
    "sticking": ("stick_slip", {}, "irk", 0.5),
    "a chain": ("chain", {"links": 10}, "ebdf", 0.3),
    "an automatic order": ("chain", {"links": 3}, "bdf", 0.4),
    "redundant rows": ("four_bar", {}, "adams", 0.2),
    "a force law": ("slider_crank_stop", {}, "hht", 0.3),
}
UNREAD = ("_values", "rate", "method_error", "probe")
"""Arrays of numbers that no index is made of and that may be anything between two steps."""


def stored(name):
    scenario, given, method, t = CASES[name]
    options = {"order": "auto"} if method == "bdf" else {}
    model = load(scenario, **given).model
    simulation = Simulation(model, method, **options)
    simulation.advance(t)
    other = Simulation(model, method, **options)
    other.advance(0.5 * t)
    return simulation, other, simulation.state()


def integers(state, rng):
    """States with one whole number out of its range: a few of each array, each end of the range, each way out."""
    for name, array in state.arrays.items():
        if array.dtype != np.int64 or not array.size:
            continue
        for place in {0, array.size - 1, int(rng.integers(array.size))}:
            for value in (-1, -(2**63), 2**63 - 1, 2**60):
                changed = array.copy()
                changed.flat[place] = value
                yield f"{name}[{place}] = {value}", {**state.arrays, name: changed}, state.facts
        if name in ("dependent", "kkt_perm_r", "lu_d_pivots") and array.size > 1:
            changed = array.copy()
            changed.flat[0] = changed.flat[1]
            yield f"{name} twice", {**state.arrays, name: changed}, state.facts


def numbers(state):
    for name, array in state.arrays.items():
        if array.dtype == np.float64 and array.size and not name.endswith(UNREAD):
            changed = array.copy()
            changed.flat[:] = np.nan
            yield f"{name} not numbers", {**state.arrays, name: changed}, state.facts
    for name, column, value in (
        ("memory", 0, 7.0), ("memory", 0, 0.5), ("memory", 5, 3.0), ("method_choice", 0, 50.0),
        ("method_choice", 1, 1e9), ("method_choice", 0, 1.5), ("method_parameters", 0, 1e9), ("clock", 0, -1.0),
        ("clock", 0, np.inf), ("clock", 2, 0.0), ("clock", 8, 1e9), ("clock", 27, 1.0), ("clock", 27, -1.0),
        ("clock", 27, 0.5), ("clock", 29, np.inf), ("clock", 31, -1.0),
    ):  # fmt: skip
        if name != "memory" or state.arrays["watch"].any():
            changed = state.arrays[name].copy()
            changed.reshape(-1)[column] = value
            yield f"{name}[{column}] = {value}", {**state.arrays, name: changed}, state.facts


def shapes(state):
    for name, array in state.arrays.items():
        longer = np.concatenate([array.reshape(-1), np.zeros(1, array.dtype)])
        yield f"{name} longer", {**state.arrays, name: longer}, state.facts
        if array.size:
            yield f"{name} shorter", {**state.arrays, name: array.reshape(-1)[:-1]}, state.facts
        kind = np.int64 if array.dtype == np.float64 else np.float64
        yield f"{name} of another type", {**state.arrays, name: np.zeros(array.shape, kind)}, state.facts
        yield f"{name} missing", {k: v for k, v in state.arrays.items() if k != name}, state.facts
    yield "one more", {**state.arrays, "more": np.zeros(3)}, state.facts


def facts(state):
    for name in state.facts:
        for value in (
            None,
            "x",
            -1,
            [99],
            [-1],
            [0.5],
            {"99": [0.0, 0.0]},
            {"0": 1},
            [[1]],
            [True],
            10**400,
            ["nan"] * 3,
        ):
            if not (name == "open_accounts" and value == {}):
                yield f"{name} = {value!r}", state.arrays, {**state.facts, name: value}
        yield f"{name} missing", state.arrays, {k: v for k, v in state.facts.items() if k != name}
    yield "a time beyond", state.arrays, {**state.facts, "t": state.facts["t"] + 1e6}
    yield "a time before", state.arrays, {**state.facts, "t": -1e6}


def sweep(name):
    """Number of forgeries that were refused. Raises for one that was not, or that left a trace."""
    simulation, other, state = stored(name)
    before, refused = other.state(), 0
    rng = np.random.default_rng(1)
    for what, arrays, altered in (*integers(state, rng), *numbers(state), *shapes(state), *facts(state)):
        forged = replace(state, arrays=arrays, facts=copy.deepcopy(altered))
        try:
            other.restore(State.from_bytes(forged.to_bytes()))
        except ModelError as error:
            if not 40 < len(str(error)) or other.state() != before:
                raise AssertionError(f"{what}: {error}") from error
            refused += 1
        else:
            raise AssertionError(f"{what} was taken")
    other.restore(State.from_bytes(state.to_bytes()))
    end = simulation.t + 0.2
    for sim in (simulation, other):
        sim.advance(end)
    if simulation.state() != other.state():
        raise AssertionError("the state itself does not lead on")
    return refused


def forge_past(name):
    """The same of what goes beside a state."""
    _, other, state = stored(name)
    before, refused = other.state(), 0
    for what, value in (
        ("counters", []), ("counters", [0] * 13), ("counters", [-1] * 12), ("counters", [2**60] * 12),
        ("counters", [0.5] * 12), ("counters", None), ("fallbacks", [[1]]), ("fallbacks", "x"), ("more", 0),
        ("divided_steps", 0),
    ):  # fmt: skip
        forged = replace(state, past={**state.past, what: value})
        try:
            other.restore(State.from_bytes(forged.to_bytes()))
        except ModelError as error:
            if not 40 < len(str(error)) or other.state() != before:
                raise AssertionError(f"{what}: {error}") from error
            refused += 1
    return refused


def scramble(name, seed, count):
    """Random numbers at random places: refused, or a run that ends, in whatever way it tells."""
    _, other, state = stored(name)
    rng = np.random.default_rng(seed)
    names = [k for k, v in state.arrays.items() if v.size]
    for _ in range(count):
        arrays = dict(state.arrays)
        for k in rng.choice(names, size=rng.integers(1, 3), replace=False):
            arrays[k] = arrays[k].copy()
            places = rng.integers(arrays[k].size, size=rng.integers(1, 4))
            if arrays[k].dtype == np.int64:
                arrays[k].flat[places] = rng.integers(-3, arrays[k].size + 3, size=len(places))
            else:
                arrays[k].flat[places] = rng.choice([0.0, -1.0, 1e30, np.inf, np.nan, rng.normal()], size=len(places))
        try:
            other.restore(State.from_bytes(replace(state, arrays=arrays).to_bytes()))
            other.advance(other.t + 1e-3)
            other.values()
        except TlismniError:
            pass
    return count


def in_a_process(*arguments):
    command = [sys.executable, __file__, *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, timeout=1200)
    assert done.returncode == 0, f"ended with {done.returncode}: {done.stderr[-2000:]}"
    return [int(line) for line in done.stdout.split()]


def test_what_is_out_of_range_is_refused():
    counts = in_a_process("sweep", *CASES)
    assert len(counts) == len(CASES) and min(counts) > 250


def test_a_past_that_cannot_be_is_refused():
    assert forge_past("a chain") == 10


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", ["a pendulum over impacts", "a chain"])
def test_random_numbers_end_no_process(name):
    assert in_a_process("scramble", name, 1, 60) == [60]


@pytest.mark.full
@pytest.mark.parametrize("name", CASES)
def test_many_random_numbers_end_no_process(name):
    for seed in range(2, 12):
        assert in_a_process("scramble", name, seed, 500) == [500]


@pytest.mark.parametrize("damage", ["one more byte", "a page more", "no arrays", "no header"])
def test_bytes_around_a_state_are_refused(damage):
    import hashlib

    payload = stored("a chain")[2].to_bytes()[32:]
    start = 8 + int.from_bytes(payload[:8], "little")
    altered = {
        "one more byte": payload + b"\0",
        "a page more": payload + bytes(4096),
        "no arrays": payload[:start],
        "no header": payload[start:],
    }[damage]
    with pytest.raises(ModelError, match="state"):
        State.from_bytes(hashlib.sha256(altered).digest() + altered)


if __name__ == "__main__":
    task, *given = sys.argv[1:]
    if task == "sweep":
        for case in given:
            print(sweep(case))
    else:
        print(scramble(given[0], int(given[1]), int(given[2])))
