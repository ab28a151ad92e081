"""Layout of what decides the future of a run, so far as it belongs to the system.

The state of a run is one buffer, a numpy structured scalar. Its fields stand one after the other without gaps, each
8-byte numbers:

    memory    (contacts, MEMORY_SIZE)  mode and memory of each contact (`state/modes.py`)
    inputs    (inputs, INPUT_SIZE)     value, two derivatives and time of each input (`model/signals.py`)
    rate      (RATE_SIZE,)             convergence of the outer loop, age of the factors
    t         (1,)                     s
    q, v, a   (n_ext,)                 coordinates, velocities and accelerations, with the work accounts
    aux       (n_ext,)                 what Newmark's formula calls its acceleration
    lam       (m_ext,)                 multipliers
    slot_pair (slots,)                 which pairs have the slots of contact pools (`state/pool_records.py`)

Behind them come those of the formula and of the time loop (`simulation/setup.py`).
"""

from typing import Any

import numpy as np

from ..model.motion import input_rows
from ..model.signals import INPUT_SIZE
from ..state.modes import MEMORY_SIZE
from ..state.workspace_records import RATE_SIZE
from .assembly import Assembly

Field = tuple[str, Any, tuple[int, ...]]
"""Name, type and shape."""

STATE_ARRAYS = ("memory", "inputs", "rate", "t", "q", "v", "a", "aux", "lam", "slot_pair")


def state_fields(assembly: Assembly) -> list[Field]:
    """The fields of the state that belong to the system."""
    n_ext, m_ext = assembly.n_extended, assembly.m + 1
    inputs = input_rows(len(assembly.input_names), len(assembly.motions))
    shapes = {
        "memory": (max(len(assembly.contacts), 1), MEMORY_SIZE), "inputs": (inputs, INPUT_SIZE),
        "rate": (RATE_SIZE,), "t": (1,), "lam": (m_ext,),
        "slot_pair": (assembly.n_slots,),
    }  # fmt: skip
    return [
        (name, np.int64 if name == "slot_pair" else np.float64, shapes.get(name, (n_ext,))) for name in STATE_ARRAYS
    ]


def row_length(assembly: Assembly) -> int:
    """Length of a row of history: q, v, a, aux (each n_ext), lam (m_ext)."""
    return 4 * assembly.n_extended + assembly.m + 1
