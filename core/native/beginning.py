"""What a run without Python starts from when a parameter has another value: the record of `begin_now`."""

from typing import Any

import numpy as np

from ..simulation.blueprint import Unstarted
from .turning import let_turn


def let_begin(sim: Any, settings: dict[str, Any]) -> None:
    """Let `sim`, a run of a Model, begin anew without Python: its record gets what that takes."""
    record = sim.beginning.record
    blank = Unstarted(sim.system, **settings).workspace.state.view(np.float64).copy()
    record.set_array("blank", blank)
    record.set_size("n_blank", len(blank))
    record.set_size("state", sim.workspace.state.ctypes.data)
    record.set_size("exchange", sim.crossing._record.address)
    record.set_size("energies", sim.table.layout.kinetic)
    let_turn(sim)
