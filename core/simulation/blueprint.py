"""Runs of one model that share its tables: a new one is a copy of memory, and other numbers where these differ.

What a run owns (arrays, records of addresses, factorisations of its present structure) is one `Image`; patterns, index
arrays, formulas and names are shared, since nothing writes into them.
"""

from typing import Any

import numpy as np

from ..assembly.assembly import Assembly
from ..assembly.contact_pool import same_pools
from ..compiled.image import Image, twin
from ..compiled.records import ArrayRecord
from ..errors import ModelError
from ..event_detection.pool_tables import take_pool
from .simulation import Simulation

_BLANK = ("samples", "log", "events")
"""Buffers that are empty whenever a blueprint is made."""
_LISTS = ("events", "fallbacks", "step_logs", "samples", "pending")
_OF_ONE_RUN = ("crossing", "outside")
"""Cached properties that hold addresses of a run."""


class Unstarted(Simulation):
    """A simulation that is built but has not begun."""

    _begins = False


class Blueprint:
    """Simulations in the state of `sim`, as many as wanted. `sim` goes on as it did.

    Raises
    ------
    ModelError : for a system of user-written equations, whose functions read the memory of one run.
    """

    def __init__(self, sim: Simulation) -> None:
        if not can_be_copied(sim.assembly):
            raise ModelError(f"a run of a {type(sim.system).__name__} cannot be copied: build another one")
        sim.flush()
        self._sim = sim
        arrays, tables = sim.workspace.memory()
        for record in _records(sim):
            arrays += [x for name, x in record.arrays.items() if name not in (*_BLANK, "probes")]
            tables.append(record.words)
        tables += [sim._loop.arrays["probes"], *sim.drive.instant.tables()]
        arrays, tables = [*arrays, *sim.beginning.memory()[0]], [*tables, *sim.beginning.memory()[1]]
        blank = [record.arrays[name] for record in _records(sim) for name in _BLANK if name in record.arrays]
        blank += [*sim.drive.instant.scratch(), *sim.workspace.blank()]
        self._image = Image(arrays, tables, blank)

    def with_room(self, other: Simulation) -> "Blueprint":
        """The same runs with as much memory for structures as `other` had to ask for; this one, if they have."""
        if np.all(other.workspace.slots.rooms <= self._sim.workspace.slots.rooms):
            return self
        # of a copy: other threads may be copying from this one
        sim = self.simulation()
        sim.workspace.slots.ask_for_as_much_as(other.workspace.slots)
        sim.workspace.give_room()
        return Blueprint(sim)

    @property
    def size(self) -> int:
        """Bytes of a run's memory that are copied; behind them is room without content."""
        return self._image.copied

    def simulation(self) -> Simulation:
        """One more run, independent of all others."""
        old, new, take = self._sim, object.__new__(Simulation), self._image.take()
        attributes = new.__dict__
        attributes.update(old.__dict__)
        for name in _OF_ONE_RUN:
            attributes.pop(name, None)
        for name in _LISTS:
            attributes[name] = list(attributes[name])
        new.workspace = old.workspace.moved(take)
        new._method, new._loop, new.drive = old._method.moved(take), old._loop.moved(take), old.drive.moved(take)
        new.guard, new.beginning = old.guard.moved(take), old.beginning.moved(take)
        new.table = twin(old.table)
        new.name_arrays()
        return new


def _records(sim: Simulation) -> tuple[ArrayRecord, ...]:
    return sim._method, sim._loop, sim.drive.record


def can_be_copied(assembly: Assembly) -> bool:
    """False for user-written equations."""
    return assembly.bind is None


def take_numbers(sim: Simulation, system: Any, assembly: Assembly) -> None:
    """Let `sim`, which has not begun, be a run of `system`, whose `assembly` has the same tables but for numbers."""
    sim.system, sim.assembly = system, assembly
    sim.workspace.take_numbers(assembly)
    sim.drive.take_numbers(assembly)
    sim._loop.arrays["leap"][:] = assembly.leap
    take_pool(sim._loop.arrays, assembly)
    sim.clock.max_step = min(sim.settings.max_step or np.inf, assembly.longest_step)
    sim.table = sim.table.moved(assembly)
    sim.__dict__.pop("model_hash", None)


def what_differs(a: Assembly, b: Assembly) -> str:
    """In which table, and not only in numbers, two assemblies differ; empty if in none."""
    for name in (
        "n", "m", "m_joints", "n_internal", "linear", "row_names", "work_names", "input_names", "replaced_rows",
        "rate_rows", "motions", "placed", "coordinate_names",
    ):  # fmt: skip
        if getattr(a, name) != getattr(b, name):
            return name
    for name in ("signals", "breakpoints", "batches", "contacts", "derived"):
        if len(getattr(a, name)) != len(getattr(b, name)):
            return name
    for x, y in zip(a.batches, b.batches, strict=True):
        same = x.address == y.address and x.par.shape == y.par.shape
        for name in ("coord", "row", "extra", "contact"):
            same = same and getattr(x, name).tobytes() == getattr(y, name).tobytes()
        if not (same and x.tangent_pattern == y.tangent_pattern and x.jacobian_pattern == y.jacobian_pattern):
            return "elements"
    for c, d in zip(a.contacts, b.contacts, strict=True):
        kept = (
            "name", "row", "slide_row", "impulse_account", "dissipation_account", "bristles", "kind",
            "units",
        )  # fmt: skip
        same = all(getattr(c, name) == getattr(d, name) for name in kept)
        if not (same and type(c.law) is type(d.law) and type(c.friction) is type(d.friction)):
            return f"contact '{c.name}'"
    if not same_pools(a.pool, b.pool):
        return "pools of contacts"
    for p, q in zip(a.derived, b.derived, strict=True):
        if type(p) is not type(q) or tuple(p.channels) != tuple(q.channels):
            return f"channel '{p.channels[0].name}'"
    return ""
