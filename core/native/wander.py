"""Positions that a mechanism may come to with other inputs: a random walk along its constraints.

At each of them the structures are given partitions and pivots, so that compiled code finds them when it comes there.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from ..errors import ConsistencyError, SimulationError
from ..linalg import SingularMatrixError
from ..linalg.record import MOST_ANALYSES
from ..state.modes import ACTIVE, CLOSED, MODE, OPEN, SLIDE, STICKS
from ..state.run_records import STEP_SIZE
from ..tables.evaluate import evaluate_residuals, evaluate_tangent
from ..tables.partition import prepare
from ..tables.partitions import MOST_PARTITIONS
from ..tables.projection import bring_to_rest
from .scratch import factorizations_of

Key = tuple[frozenset[int], frozenset[int], frozenset[int]]
"""Contacts closed, engaged and sticking."""

MOST_LOOKS = 1024
"""Positions times structures that are looked at."""
MOST_STEPS = 256
STRIDE = 0.3
"""Of the walk, as a part of the coordinates' scales (a turn: of 1 rad)."""
FULL = 0.75
"""Of the places for partitions and analyses of a structure: the rest is for what the run itself meets."""
MOST_BYTES = 500_000
"""Of analyses: larger images take longer to open than a model is worth."""
TRIALS = 1.0, 0.1
"""Steps, as parts of the solver's next one, for whose matrices pivots are chosen too."""


def know(sim: Any, keys: Sequence[Key]) -> None:
    """Let the structures of these states of contacts have partitions and analyses for the present position."""
    workspace = sim.workspace
    for key in keys:
        _set_modes(sim, *key)
        try:
            workspace.engage(*key)
            prepare(workspace)
            if not workspace.structure.kkt.dense:
                for part in TRIALS:
                    c_v = part * sim.clock[STEP_SIZE]
                    evaluate_tangent(workspace.record, c_v * c_v, c_v)
                    workspace.structure.kkt.analyze(workspace.arrays["values"])
        except (ConsistencyError, SingularMatrixError, SimulationError):
            continue  # contacts that cannot all be closed here


def _set_modes(sim: Any, closed: frozenset[int], engaged: frozenset[int], sticking: frozenset[int]) -> None:
    """Let contacts be in these states: those that are open have no part in the matrix."""
    for k, contact in enumerate(sim.assembly.contacts):
        memory = sim.memory[k]
        memory[MODE] = CLOSED if k in closed else ACTIVE if k in engaged else OPEN
        if contact.slide_row >= 0:
            memory[SLIDE] = STICKS if k in sticking else 1.0


def wander(sim: Any, keys: Sequence[Key]) -> None:
    """Walk from the present position of `sim`, which is left wherever the walk ends."""
    if not keys:
        return
    nobody: frozenset[int] = frozenset()
    workspace, open_key = sim.workspace, (nobody, nobody, nobody)
    arrays, n, scale = workspace.arrays, sim.assembly.n, sim.assembly.coordinate_scale
    random = np.random.default_rng(0)
    for _ in range(min(MOST_STEPS, MOST_LOOKS // len(keys))):
        if nearly_full(sim):
            return
        here = arrays["q"][:n].copy()
        _set_modes(sim, *open_key)
        workspace.engage(*open_key)
        try:
            prepare(workspace)
        except (ConsistencyError, SingularMatrixError):
            return
        arrays["q"][:n] += STRIDE * scale * random.uniform(-1.0, 1.0, n)
        evaluate_residuals(workspace.record)
        if not bring_to_rest(workspace, "phi", "q"):
            arrays["q"][:n] = here
            continue
        know(sim, keys)


def nearly_full(sim: Any) -> bool:
    """True where more would take too much room, or the place of what the run itself meets."""
    size = 0
    for structure in sim.workspace.patterns:
        if len(structure.known) > FULL * MOST_PARTITIONS:
            return True
        for factorization in factorizations_of(structure):
            analyses = factorization.known._kept.values()
            size += sum(x.nbytes for analysis in analyses for x in analysis.arrays.values())
            if len(analyses) > FULL * MOST_ANALYSES or size > MOST_BYTES:
                return True
    return False
