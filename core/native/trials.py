"""Runs of a model with other numbers, from one compiled model: what parameters are tried with.

All of them are copies of the memory of one run that has not begun (`simulation/blueprint.py`). So two of them are the
same where their bytes are, but for addresses within each, and what is scratch.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly, assemble
from ..assembly.start_turns import Watched
from ..multibody_model import Model
from ..simulation.blueprint import Blueprint, Unstarted, take_numbers, what_differs
from .errors import NativeError
from .reach import begin_of
from .scratch import OF_EXCHANGE, scratch_of


def take(sim: Any, model: Model, assembly: Assembly) -> None:
    """Let a run take the numbers of another model. Raises NativeError if more than numbers differ."""
    if differs := what_differs(sim.assembly, assembly):
        raise NativeError(f"another value changes more than numbers ({differs})")
    take_numbers(sim, model, assembly)
    if sim.crossing is not None:
        sim.crossing._record.arrays["derived_numbers"][:] = sim.table.index_arrays()["derived_numbers"]
    sim.beginning.take_numbers(assembly)
    _take_turns(sim, model)


def _take_turns(sim: Any, model: Model) -> None:
    """Numbers of the angles at the start whose whole turns drivers say (`turning.py`)."""
    numbers = sim.beginning.record.arrays["turn_numbers"]
    if len(numbers):
        watched = Watched(model)
        assemble(watched, t0=sim.settings.t0)
        found = [x for turn in watched.turns if turn is not None for x in turn.numbers()]
        if len(found) != len(numbers):
            raise NativeError("another value changes which angles at the start a driver says")
        numbers[:] = found


class Trials:
    """Runs of `model`, and of others that differ from it in numbers.

    Parameters
    ----------
    settings : of `Simulation`.
    """

    def __init__(self, model: Model, settings: dict[str, Any]) -> None:
        self.model, bare = model, Unstarted(model, **settings)
        self._blueprint, self._own = Blueprint(bare), bare.assembly
        self._t0 = bare.settings.t0
        self._others: dict[int, tuple[Model, Assembly]] = {}
        # all of them have the room that one start takes, so that few have to ask for more
        self._blueprint = self._blueprint.with_room(self.begun(model))
        self._probe = self.begun(model)

    def assembly(self, model: Model) -> Assembly:
        """The assembly of a model, made once."""
        if model is self.model:
            return self._own
        if id(model) not in self._others:
            self._others[id(model)] = model, model.assemble(t0=self._t0)
        return self._others[id(model)][1]

    def forget(self) -> None:
        """Free the assemblies of other models."""
        self._others.clear()

    def begun(self, model: Model) -> Any:
        """A run of a model at its start.

        Raises
        ------
        NativeError : if more than numbers differ.
        ConsistencyError, SimulationError, ModelError : if it does not begin.
        """
        sim = self._blueprint.simulation()
        if model is not self.model:
            take(sim, model, self.assembly(model))
        sim.begin()
        return sim

    def follows(self, other: Any) -> bool:
        """Whether a run that has begun, and takes the numbers of the model of `other`, is `other` then: nothing else
        in a start follows from these numbers."""
        probe = self._probe
        take(probe, other.system, self.assembly(other.system))
        try:
            return self._same(probe, other)
        finally:
            take(probe, self.model, self._own)

    def _same(self, one: Any, other: Any) -> bool:
        facts = [(run.t, run.table.initial_energy, list(run.pending)) for run in (one, other)]
        if facts[0] != facts[1]:
            return False
        arrays, others = (run.crossing._record.arrays for run in (one, other))
        if any(x.tobytes() != others[name].tobytes() for name, x in arrays.items() if name not in OF_EXCHANGE):
            return False
        blocks = [_block(run) for run in (one, other)]
        first, second = (block[: self._blueprint.size].view(np.int64) for block in blocks)
        differ = first != second
        begin, end = begin_of(blocks[0]), begin_of(blocks[0]) + blocks[0].nbytes
        for x in scratch_of(one):
            at = begin_of(x)
            if x.nbytes and begin <= at < end:  # as a rule in whole words; else the neighbours count as scratch too
                differ[(at - begin) // 8 : (at - begin + x.nbytes + 7) // 8] = False
        left = np.flatnonzero(differ)
        places = first[left] - begin
        inside = (places >= 0) & (places <= blocks[0].nbytes) & (places == second[left] - begin_of(blocks[1]))
        return bool(inside.all())


def _block(run: Any) -> NDArray[np.uint8]:
    """The memory that a copied run has of its own."""
    block = run.workspace.state_bytes.base
    if block is None or block.dtype != np.uint8:
        raise TypeError("this run is no copy of another one")
    return np.asarray(block)
