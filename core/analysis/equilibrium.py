"""Static equilibrium: where a system comes to rest from its start, and what its joints and contacts then carry.

Newton's method on the forces alone stops at any stationary point and is lost far from one. Pseudo-transient
continuation (Kelley and Keyes, SIAM J. Numer. Anal. 35, 1998) follows the way on which the system would creep downhill,

    [K + M/d, Phi_q^T; Phi_q, 0] (dq, lambda) = (Q, -phi),

with pseudo time steps d that grow as the forces left over become smaller, and ends as Newton's method.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled_model import compile_model
from ..methods.default import FIXED_STEPS_METHOD
from ..multibody_model import Model
from ..simulation.simulation import Simulation
from ..state.modes import ACTIVE, CLOSED
from .at_rest import channel_values, run_of
from .pseudo_transient import Creep

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Equilibrium:
    """A place of rest.

    Attributes
    ----------
    system : the Model or EquationSystem.
    channels, values : names of all channels, and what they are at rest (channels,): forces of joints and contacts too.
    q : coordinates (n,). multipliers : of the rows that are constraints at rest.
    start_values : for `simulate(..., start_values=...)`: coordinates and rates by the names of channels.
    iterations : taken. unbalanced : largest generalised force left over, in parts of the largest that acts.
    closed : names of the contacts that carry force.
    """

    system: Any
    channels: tuple[str, ...]
    values: Floats
    q: Floats
    multipliers: Floats
    start_values: dict[str, float]
    iterations: int
    unbalanced: float
    closed: tuple[str, ...]
    sim: Simulation

    def __getitem__(self, channel: str) -> float:
        """Value of a channel at rest. Raises KeyError for an unknown name."""
        if channel not in self.channels:
            raise KeyError(f"there is no channel '{channel}'; there are {list(self.channels)}")
        return float(self.values[self.channels.index(channel)])

    @cached_property
    def model(self) -> Model:
        """The model that starts at rest here. Raises ModelError for bodies whose record has no place for that: use
        `start_values`."""
        from ..results.restart import model_from

        return model_from(self.system, self.start_values)


def static_equilibrium(system: Any, t: float = 0.0, start_values: dict[str, float] | None = None) -> Equilibrium:
    """The place of rest that `system` creeps to from its start, with loads, drivers and inputs as they are at time `t`.

    Contacts close and open on the way; friction does not hold anything. A start that is balanced already, an inverted
    pendulum say, is an answer too: `eigenmodes` tells whether it is stable.

    Parameters
    ----------
    system : Model or EquationSystem.
    t : time, s.
    start_values : coordinates by the names of channels, in place of the model's start.

    Raises
    ------
    SimulationError : if there is no place of rest within reach: says what still moves.
    ConsistencyError, ModelError : as `Simulation`.
    """
    if start_values:
        sim = compile_model(system, FIXED_STEPS_METHOD, t0=t).simulation(start=start_values)
    else:
        sim = run_of(system, t)
    search = Creep(sim)
    search.run()
    arrays, n, active = sim.workspace.arrays, sim.assembly.n, sim.workspace.structure.active
    values = channel_values(sim)
    names = tuple(channel.name for channel in sim.channels)
    layout, plain = sim.table.layout, sim.table.plain_columns()
    row = np.zeros(sim.buffer.shape[1])
    row[layout.q] = arrays["q"][:n]
    states = {*range(layout.q.start, layout.v.stop)}
    start = {name: float(row[column]) for name, column in plain.items() if column in states}
    closed = tuple(c.name for k, c in enumerate(sim.assembly.contacts) if sim.memory.mode[k] in (CLOSED, ACTIVE))
    return Equilibrium(
        system, names, values, arrays["q"][:n].copy(), arrays["lam"][active].copy(), start, search.iterations,
        search.unbalanced, closed, sim,
    )  # fmt: skip
