"""What a run without Python has to find ready: structures, partitions and analyses of matrices.

Compiled code chooses from what Python has built (`docs/architecture.md`). So the run is made once before it is written
down: with all that it meets on its way, and with the structures of all states of contacts where these are few, at the
positions that it goes through, and at others (`wander.py`). None of this changes a bit of the run.
"""

from collections.abc import Iterable, Iterator
from itertools import product
from typing import Any

import numpy as np

from ..compiled.jit import address_of
from ..description import Model
from ..events.instant import PART_SIGNATURE, Instant
from ..events.prepare import use_modes
from ..laws import ForceLaw
from ..run.drive_record import Drive
from ..tables.evaluate import evaluate_residuals
from ..tables.patterns import MOST_STRUCTURES
from ..tables.switch import APART, ENGAGED, HELD, STUCK, STUCK_TWICE, key_of
from .errors import NativeError
from .parameters import Tried, take
from .scratch import factorizations_of
from .wander import Key, know, nearly_full, wander

POINTS = 32
"""Positions of the rehearsal at which other states of contacts are looked at."""
ROOMS = 4
"""How much more room than they had at first the eliminations get."""


def points(began: float, t_end: float) -> list[float]:
    """Times of the rehearsal, s."""
    return [began + (t_end - began) * k / POINTS for k in range(1, POINTS + 1)]


def start_inputs(sim: Any) -> list[float]:
    """The inputs as they are."""
    return [float(sim.workspace.arrays["inputs"][k, 0]) for k in range(len(sim.assembly.input_names))]


def rehearse(sim: Any, t_end: float, tried: Iterable[Tried] = ()) -> None:
    """Let `sim`, which has just begun, know what its run to `t_end` (s) meets, and other starts; it is as before then.

    Raises
    ------
    NativeError : for a model that takes Python at any event. SimulationError : if the run fails.
    """
    _refuse(sim)
    start, states = sim.state(), [sim.state()]
    began, events = sim.t, list(sim.events)
    keys = list(_keys(sim))
    for t in points(began, t_end):
        sim.exchange(start_inputs(sim), t, False)
        states.append(sim.state())
    for state in states:
        if not nearly_full(sim):
            sim.restore(state)
            know(sim, keys)
    sim.restore(start)
    if tried:
        _know_starts(sim, tried)
        sim.restore(start)
    wander(sim, keys)
    sim.restore(start)
    sim.events[:] = events
    _make_room(sim)
    _as_at_first(sim)


def _know_starts(sim: Any, tried: Iterable[Tried]) -> None:
    """Partitions and pivots at other starts, with contacts open."""
    nobody: frozenset[int] = frozenset()
    model, key = sim.system, (nobody, nobody, nobody)
    try:
        for values in tried:
            for x, variant in values.values:
                if values.starts and x in values.starts and not nearly_full(sim):
                    take(sim, variant)
                    sim.workspace.arrays["q"][:] = values.starts[x].q
                    evaluate_residuals(sim.workspace.record)
                    know(sim, [key])
    finally:
        take(sim, model)


def _refuse(sim: Any) -> None:
    """Raise NativeError for a model that takes Python at any event."""
    assembly = sim.assembly
    if not isinstance(sim.system, Model):
        raise NativeError(
            f"a {type(sim.system).__name__} is made of Python functions, which only Python can call: describe it as a "
            "Model"
        )
    if sim.settings.fallback and sim.outer != "newton":
        raise NativeError(
            "which outer loop takes over from another (fallback) is for Python to say: leave fallback out, or use "
            "outer='newton'"
        )
    if assembly.contacts and sim.workspace.dropped:
        raise NativeError(
            f"{len(sim.workspace.dropped)} constraints repeat others, and there are contacts: which of them are left "
            "out Python looks at in every impact. Leave the redundant joints out of the model, or use the FMU that "
            "runs with Python"
        )


def _keys(sim: Any) -> Iterator[Key]:
    """Closed, engaged and sticking contacts, in all states that they can be in; none where there are too many."""
    contacts = sim.assembly.contacts
    states = [_codes(contact) for contact in contacts]
    most = 1
    for state in states:
        most *= len(state)
        if most > MOST_STRUCTURES:
            return
    for codes in product(*states):
        yield key_of(np.array(codes, dtype=np.int64))


def _codes(contact: Any) -> tuple[int, ...]:
    """What a contact can be."""
    if isinstance(contact.law, ForceLaw):
        return APART, ENGAGED
    if contact.slide_row < 0:
        return APART, HELD
    return (APART, HELD, STUCK) if contact.tangents == 1 else (APART, HELD, STUCK, STUCK_TWICE)


def _make_room(sim: Any) -> None:
    """Room for more than the rehearsal has needed: there is nobody to give it later."""
    drive: Drive = sim.drive
    if sim.assembly.contacts:
        rows_space = ROOMS * drive.instant.rows_space
        drive.instant = Instant(sim.assembly, max(len(sim.assembly.contacts), drive.instant.most), rows_space)
        drive.record.set_size("instant", drive.instant.address)
    # `repair_now` takes it from there, with contacts or without
    drive.instant.tables()[0]["use_modes"] = address_of(use_modes, PART_SIGNATURE)
    for structure in sim.workspace.patterns:
        structure.order_columns()
        for factorization in factorizations_of(structure):
            if not factorization.dense:
                factorization.order_columns()
                size = min(factorization.n**2, ROOMS * factorization.record["choice_room"])
                factorization._make_room(max(size, factorization.record["choice_room"]))
                factorization.have_room()


def _as_at_first(sim: Any) -> None:
    """Counters and the guard against endless events begin anew, as in a run that has not been restored."""
    sim.drive.counts[:] = 0
    sim.guard.numbers[:] = sim.t, sim.t, 0.0
