"""Phases of a slave's life, and what is allowed in each."""

from enum import StrEnum


class Phase(StrEnum):
    """Where a slave is in its life."""

    INSTANTIATED = "instantiated"
    INITIALIZATION = "initialization"
    STEP = "step"
    INTERMEDIATE = "intermediate update"
    EVENT_DUE = "event due"
    EVENT = "event"
    FAILED = "failed"
    TERMINATED = "terminated"


WAYS = {
    Phase.INSTANTIATED: "enter and exit initialization mode first",
    Phase.INITIALIZATION: "exit initialization mode first",
    Phase.STEP: "reset first",
    Phase.INTERMEDIATE: "return from the callback of the intermediate update first",
    Phase.EVENT_DUE: "the last step ended at an event: enter event mode, update the discrete states, enter step mode",
    Phase.EVENT: "update the discrete states and enter step mode first",
    Phase.FAILED: "the last step failed: set a stored state, or reset",
    Phase.TERMINATED: "the run is terminated: reset, or set a stored state",
}
"""How to get out of each phase, for messages."""

INPUTS = frozenset(("input",))
SETTABLE = {
    Phase.INSTANTIATED: frozenset(("parameter", "input")),
    Phase.INITIALIZATION: frozenset(("parameter", "input")),
    Phase.STEP: INPUTS,
    Phase.INTERMEDIATE: INPUTS,
    Phase.EVENT_DUE: INPUTS,
    Phase.EVENT: INPUTS,
}
"""Roles of the variables that can be set; in other phases there are none."""

RUNNING = tuple(phase for phase in Phase if phase != Phase.INSTANTIATED)
"""Phases in which values can be read."""

SOUND = tuple(phase for phase in RUNNING if phase != Phase.FAILED)
"""Phases in which outputs can be computed."""

EVENT_PHASES = (Phase.EVENT, Phase.EVENT_DUE)
"""Phases that only a slave with event mode can be in."""
