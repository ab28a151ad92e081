"""Whole turns at the start where a run without Python begins at another time: those that drivers say.

Nobody lists where tables take an angle at the start. The model is assembled once for each of those that a driver
decides, with one whole turn more of it, and the words that change are that angle.
"""

from typing import Any

import numpy as np

from ..assembly.assembly import assemble
from ..assembly.start_turns import Watched
from .errors import NativeError
from .reach import begin_of, held_by, reached, without_parts
from .trials import take


def let_turn(sim: Any) -> None:
    """Let `sim`, a run of a Model at its start, count turns from the time when it begins anew: its record gets what
    that takes. Raises NativeError where tables hold such an angle in another way than as it is."""
    watched = Watched(sim.system)
    own = assemble(watched, t0=sim.settings.t0)
    if not any(watched.turns):
        return
    record, first = sim.beginning.record, (sim.crossing._record.table, sim.beginning.record.table)
    arrays = [x for x in reached(first, without_parts(list(held_by(sim)))).arrays if x.dtype.itemsize % 8 == 0]
    before = [x.tobytes() for x in arrays]
    rows: list[tuple[int, int]] = []
    numbers: list[float] = []
    for k, turn in enumerate(watched.turns):
        if turn is None:
            continue
        shifted = Watched(sim.system, k)
        take(sim, sim.system, assemble(shifted, t0=sim.settings.t0))
        for x, content in zip(arrays, before, strict=True):
            now = np.frombuffer(x.tobytes(), dtype=np.int64)
            for at in np.flatnonzero(now != np.frombuffer(content, dtype=np.int64)).tolist():
                if float(now[at : at + 1].view(np.float64)[0]) != shifted.angles[k]:
                    raise NativeError(
                        "a number of the run follows from an angle at the start: please report this model"
                    )
                rows.append((begin_of(x) + 8 * at, len(numbers)))
        numbers += turn.numbers()
    take(sim, sim.system, own)
    if [x.tobytes() for x in arrays] != before:
        raise NativeError("numbers of the model that were taken back are not what they were")
    record.set_array("turned", np.array(rows, dtype=np.int64).reshape(-1, 2))
    record.set_array("turn_numbers", np.array(numbers))
    record.set_size("n_turned", len(rows))
    record.set_size("n_turn_numbers", len(numbers))
