"""Surfaces that move past the bodies that carry them: of belts, of drums, of plates that walking beams shift.

The surface of a shape goes with a speed f(t) along the tangent of the plane, or in space with f(t) d, d a direction of
the body that carries it (`surface3d.py`). Sliding is what is left of the motion of the shapes on each other without it:
f and f' are taken off the sliding velocity and its rate, and nothing else of friction knows of it. Its place says
nothing: a contact that sticks to it is a constraint of velocities. What keeps it going is part of the body that carries
it; its power is the friction times f, work of the account "input".
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ..compiled.jit import internal
from ..compiled.views import imat, vec
from ..model.signals import INPUT_SIZE, evaluate_signal

SURFACE = 4
"""Column of `extra`: place of the surface's numbers in the pool of signals, plus one; 0: it does not move."""
SPEED, SIGN, ACCOUNT, CARRIER, DIRECTION = 0, 1, 2, 3, 4
"""Places among them: where its speed is in the pool, its sign as part of the sliding velocity, the work account, and of
one in space where the Euler parameters of the body that carries it are among the contact's coordinates, and its
direction in the frame of that body."""


@dataclass(frozen=True)
class Numbers:
    """A table of numbers, which goes where those of time functions go: `cast(Signal, ...)` gives it to a numbering."""

    values: Sequence[float]

    def pool(self, inputs: dict[str, int]) -> Sequence[float]:
        """The table."""
        return self.values


@internal
def surface_speed(b: Any, e: int, t: float) -> Any:
    """(speed, its rate) of the surface of element e of a batch, m/s and m/s2; zeros if it does not move."""
    at = imat(b.extra, b.count, b.nextra)[e, SURFACE]
    if at == 0:
        return 0.0, 0.0
    pool = vec(b.signals, b.n_signals)
    f, df, _ = evaluate_signal(pool, vec(b.inputs, INPUT_SIZE * b.n_inputs), int(pool[at - 1 + SPEED]), t)
    return pool[at - 1 + SIGN] * f, pool[at - 1 + SIGN] * df


@internal
def moves(b: Any, e: int) -> bool:
    """True if the surface of element e of a batch has a speed of its own, be it zero."""
    return bool(imat(b.extra, b.count, b.nextra)[e, SURFACE] != 0)


@internal
def put_in(b: Any, e: int, power: float) -> None:
    """Power (W) that keeps the surface of element e of a batch going, to the rate of its account."""
    at = imat(b.extra, b.count, b.nextra)[e, SURFACE]
    if at != 0:
        vec(b.a, b.n_extended)[int(vec(b.signals, b.n_signals)[at - 1 + ACCOUNT])] += power
