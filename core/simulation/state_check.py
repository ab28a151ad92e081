"""Is a state that came as bytes one that a run could have been in?

Compiled code takes indices from a state (pivots, dependent coordinates, rings, orders, modes) and does not look at them
again. A checksum says that bytes are as they were written, not who wrote them.
"""

import math
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.slots import MATRICES
from ..errors import ModelError
from ..events import Event
from ..methods.order_selection import MOST_K
from ..recovery.step_division import MOST_HALVINGS
from ..stage import OUTER_LOOPS
from ..state.method_records import NEXT_K, K
from ..state.modes import AT_LIMIT, CLOSED, IDLE, MODE_NAMES, STICKS, contact_memories
from ..state.pool_records import NO_PAIR
from ..state.run_records import (
    clock_of,
)
from ..state.workspace_records import COUNTERS_SIZE
from .state import State

if TYPE_CHECKING:
    from .simulation import Simulation

_FINITE = (
    "t",
    "q",
    "v",
    "a",
    "aux",
    "lam",
    "memory",
    "probe",
    "compatibility",
    "method_weights",
    "method_times",
    "method_history",
    "guard",
)
_NO_NAN = ("inputs", "watch", "clock")
_SETTINGS = ("max_step", "largest_growth", "hold", "eager", "b1", "b2", "a2")
"""Fields of the clock that never change in a run."""
_NOT_NEGATIVE = (
    "equal_steps", "previous_norm", "previous_ratio", "rejected_here", "halvings", "failures", "divided_steps",
)  # fmt: skip
_LARGEST_COUNT = 2**53
_HUGE = 1e300
_SLIDES = (STICKS, IDLE, 1.0, -1.0)


def check_state(sim: "Simulation", state: State, own: State) -> None:
    """Refuse what cannot be a state of `sim`, whose own present state is `own`; `sim` stays as it is.

    Raises
    ------
    ModelError : says what is wrong with which part.
    """
    _check_facts(sim, state)
    closed, sticking, implied, dropped = (
        frozenset(state.facts[name]) for name in ("closed", "sticking", "implied", "dropped")
    )
    active, held = sim.assembly.count_active(closed, sticking, dropped, implied)
    left_out, sharing = sim.workspace.sharing_size(dropped, closed, sticking, implied)
    _check_arrays(state, own, {"dependent": active, "probe": active, "compatibility": sharing})
    arrays = state.arrays
    _need("dependent", len(set(arrays["dependent"].tolist())) == len(arrays["dependent"]), "names a coordinate twice")
    _need_range("dependent", arrays["dependent"], 0, sim.assembly.n - 1)
    _check_factorizations(arrays, {"lu_d": active, "lu_p": held}, active + left_out + sim.assembly.n)
    _check_memory(sim, state)
    _check_slots(sim, arrays["slot_pair"])
    _check_method(sim, arrays, own.arrays)
    _check_clock(clock_of(arrays["clock"]), clock_of(own.arrays["clock"]))
    newest = _newest_time(arrays)
    t = state.facts["t"]
    _need("t", t <= newest and (arrays["method_ring"][1] < 2 or t >= _time_before(arrays)), f"{t!r} s is not in a step")


def _check_slots(sim: "Simulation", pairs: NDArray[np.int64]) -> None:
    """Which pairs have the slots of contact pools."""
    pool = sim.assembly.pool
    if pool is None:
        return
    taken = pairs[pairs != NO_PAIR]
    _need("slot_pair", len(np.unique(taken)) == len(taken), "has a pair twice")
    _need_range("slot_pair", pairs, NO_PAIR, len(pool.shapes) ** 2)
    for number, group in enumerate(pool.groups):
        first = int(group["first_slot"])
        own = pairs[first : first + int(group["slots"])]
        ones, others = divmod(own[own != NO_PAIR] - 1, len(pool.shapes))
        fits = (ones < others) & (pool.shapes["group"][ones] == number) & (pool.shapes["group"][others] == number)
        _need("slot_pair", bool(np.all(fits)), "has pairs that are none of their group")


def _refuse(part: str, text: str) -> None:
    raise ModelError(
        f"the solver state is none that this simulation could have been in: '{part}' {text}; "
        "give back exactly the bytes of State.to_bytes()"
    )


def _need(part: str, holds: Any, text: str) -> None:
    if not holds:
        _refuse(part, text)


def _need_range(part: str, array: NDArray[Any], low: float, high: float) -> None:
    if len(array) and not (array.min() >= low and array.max() <= high):
        _refuse(part, f"has values from {array.min()} to {array.max()}, where {low} to {high} are possible")


def _number(x: Any) -> bool:
    return isinstance(x, int | float) and not isinstance(x, bool) and -_HUGE <= x <= _HUGE


def _text_number(x: Any, infinite: bool = False) -> bool:
    """Whether `x` is the repr of a number."""
    try:
        return isinstance(x, str) and (infinite or math.isfinite(float(x)))
    except ValueError:
        return False


def _indices(x: Any, count: int) -> bool:
    whole = isinstance(x, list) and all(isinstance(k, int) and not isinstance(k, bool) for k in x)
    return whole and len(set(x)) == len(x) and all(0 <= k < count for k in x)


def _check_facts(sim: "Simulation", state: State) -> None:
    facts, contacts, assembly = state.facts, len(sim.assembly.contacts), sim.assembly
    own = {
        "t", "closed", "dropped", "engaged", "sticking", "implied", "pending", "handled", "outer", "start_open",
        "input_times", "initial_energy",
    }  # fmt: skip
    _need("facts", set(facts) == own, f"are {sorted(facts)}, needed are {sorted(own)}")
    for name, count in (
        ("closed", contacts), ("engaged", contacts), ("sticking", 2 * contacts), ("pending", contacts),
        ("implied", 3 * contacts),
        ("dropped", assembly.m_joints),
    ):  # fmt: skip
        _need(name, _indices(facts[name], count), f"is {facts[name]!r}: a list of different numbers below {count}")
    closed, sticking = set(facts["closed"]), set(facts["sticking"])
    _need("engaged", closed <= set(facts["engaged"]), "lacks contacts that are closed")
    slides = {k for k, contact in enumerate(assembly.contacts) if contact.slide_row >= 0}
    twice = {k + contacts for k in closed & slides if assembly.contacts[k].tangents > 1 and k in sticking}
    _need("sticking", sticking <= closed & slides | twice, "has contacts that are not closed, or have no friction")
    rows = closed | {k + contacts for k in sticking}
    _need("implied", set(facts["implied"]) <= rows, "has rows of contacts that are not closed, or do not stick")
    _need("t", _number(facts["t"]), f"is {facts['t']!r}, no time")
    handled, times = facts["handled"], facts["input_times"]
    counted = isinstance(handled, list) and len(handled) == 2 and _text_number(handled[0], True)
    _need("handled", counted and _indices(handled[1:], _LARGEST_COUNT), f"is {handled!r}: a time and a count")
    two = isinstance(times, list) and len(times) == 2 and all(_text_number(x, True) for x in times)
    _need("input_times", two and not any(math.isnan(float(x)) for x in times), f"is {times!r}: two times")
    _need("outer", facts["outer"] in tuple(OUTER_LOOPS), f"is {facts['outer']!r}, no outer loop")
    _need("start_open", isinstance(facts["start_open"], bool), f"is {facts['start_open']!r}: true or false")
    energy = facts["initial_energy"]
    _need("initial_energy", _text_number(energy), f"is {energy!r}, no energy")
    past = state.past
    _need(
        "past",
        set(past) == {"counters", "fallbacks"},
        f"is {sorted(past)}: counters and fallbacks are needed",
    )
    counters = past["counters"]
    whole = isinstance(counters, list) and all(isinstance(x, int) and not isinstance(x, bool) for x in counters)
    fits = whole and len(counters) == COUNTERS_SIZE and all(0 <= x <= _LARGEST_COUNT for x in counters)
    _need("counters", fits, f"are {counters!r}: {COUNTERS_SIZE} counts")
    fallbacks = past["fallbacks"]
    listed = isinstance(fallbacks, list) and all(
        isinstance(f, list) and len(f) == 3 and _number(f[0]) and isinstance(f[1], str) and isinstance(f[2], str)
        for f in fallbacks
    )
    _need("fallbacks", listed, f"is {fallbacks!r}: time, outer loop and reason each")
    names = {contact.name for contact in assembly.contacts}
    for event in state.events:
        pooled = assembly.pool is not None and assembly.pool.has(event.contact)
        known = (event.contact in names or pooled) and isinstance(event.kind, str)
        _need("events", known and all(map(_number, _numbers_of(event))), f"has {event}")


def _numbers_of(event: Event) -> list[Any]:
    return [value for name, value in event.to_dict().items() if name not in ("kind", "contact")]


def _check_arrays(state: State, own: State, sizes: dict[str, int]) -> None:
    """Names, types and shapes, as far as they do not depend on pivots; numbers that must be some."""
    arrays, expected = state.arrays, own.arrays
    _need("arrays", arrays.keys() == expected.keys(), f"are {sorted(arrays)}, needed are {sorted(expected)}")
    for name, array in arrays.items():
        x = expected[name]
        _need(
            name, array.dtype == x.dtype and array.ndim == x.ndim, f"is of type {array.dtype} and shape {array.shape}"
        )
        if not name.startswith(MATRICES):
            shape = (sizes[name],) if name in sizes else x.shape
            _need(name, array.shape == shape, f"has shape {array.shape}, needed is {shape}")
    for name in _FINITE:
        _need(name, np.isfinite(arrays[name]).all(), "has values that are not finite")
    for name in _NO_NAN:
        _need(name, not np.isnan(arrays[name]).any(), "has values that are no numbers")


def _check_factorizations(arrays: dict[str, NDArray[Any]], sizes: dict[str, int], size: int) -> None:
    for name in MATRICES:
        if f"{name}_perm_r" not in arrays:
            continue
        n = sizes.get(name, size)
        for part in ("perm_r", "perm_c", "pivots"):
            array = arrays[f"{name}_{part}"]
            order = len(array) == 0 or np.array_equal(np.sort(array), np.arange(n))
            _need(f"{name}_{part}", order, f"is no permutation of 0 to {n - 1}")


def _check_memory(sim: "Simulation", state: State) -> None:
    memory = contact_memories(state.arrays["memory"])[: len(sim.assembly.contacts)]
    _need("memory", np.isin(memory.mode, list(MODE_NAMES)).all(), f"has modes {memory.mode.tolist()}")
    in_space = np.array([contact.tangents == 2 for contact in sim.assembly.contacts], dtype=bool)
    known = np.isin(memory.slide_mode, _SLIDES) | (in_space & (memory.slide_mode == AT_LIMIT))
    _need("memory", bool(known.all()), f"has ways of sliding {memory.slide_mode.tolist()}")
    closed = set(np.flatnonzero(memory.mode == CLOSED).tolist())
    _need("closed", closed == set(state.facts["closed"]), f"is not what the modes say: {sorted(closed)}")


def _newest_time(arrays: dict[str, NDArray[Any]]) -> float:
    return float(arrays["method_times"][arrays["method_ring"][0]])


def _time_before(arrays: dict[str, NDArray[Any]]) -> float:
    return float(arrays["method_times"][arrays["method_ring"][0] - 1])


def _check_method(sim: "Simulation", arrays: dict[str, NDArray[Any]], own: dict[str, NDArray[Any]]) -> None:
    ring, times = arrays["method_ring"], arrays["method_times"]
    capacity = len(times)
    _need_range("method_ring", ring[:1], 0, capacity - 1)
    _need_range("method_ring", ring[1:2], 1, capacity)
    _need_range("method_ring", ring[2:], 0, capacity)
    rows = times[(ring[0] - np.arange(ring[1])) % capacity]
    _need("method_times", (np.diff(rows) <= 0.0).all(), f"does not grow: {rows[::-1].tolist()}")
    parameters = own["method_parameters"]
    same = np.array_equal(arrays["method_parameters"], parameters)
    _need("method_parameters", same, "are not those of the method")
    formula, choice = sim.formula, arrays["method_choice"]
    most = float(formula.k) if formula.select is None else float(parameters[MOST_K])
    for column, least in ((K, most if formula.select is None else 1.0), (NEXT_K, 0.0)):
        k = float(choice[column])
        whole = k.is_integer() and least <= k <= most
        _need("method_choice", whole, f"has {k!r} steps of a formula that takes {least:g} to {most:g}")


def _check_clock(clock: Any, own: Any) -> None:
    halvings = clock.halvings
    same = all(getattr(clock, name) == getattr(own, name) for name in _SETTINGS)
    _need("clock", same, "has other settings than the simulation")
    step = clock.step_size
    _need("clock", 0.0 < step < math.inf, f"has a step of {step!r} s")
    _need("clock", all(getattr(clock, name) >= 0.0 for name in _NOT_NEGATIVE), "has counts below zero")
    known = halvings.is_integer() and halvings <= (MOST_HALVINGS if own.fixed_step > 0.0 else 0)
    _need("clock", known, f"has a fixed step halved {halvings!r} times")
    whole, expected = (x.fixed_step * 2.0**x.halvings for x in (clock, own))
    _need("clock", whole == expected, f"has a fixed step of {whole!r} s")
    parts = [clock.divided_until, clock.parts_until]
    _need("clock", all(map(math.isfinite, parts)), f"has a divided step that ends at {parts} s")
