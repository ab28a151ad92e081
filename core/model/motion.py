"""Motions that are inputs: a position with its velocity, and what happens when they do not continue the old motion.

Between two changes the input says x(t) = x_k + v_k (t - t_k), x_k being the value of the position channel and v_k that
of its `rate` channel (without one: 0). A new (x_k, v_k) seldom continues the motion that is there: the old position
was extrapolated. A jump in position is no motion, and one in velocity would be an impact that nobody meant. So what
is constrained follows

    f(t) = x_k + v_k (t - t_k) + c(t - t_k),    c(s) = (1 - s/T)^3 (c_0 + (3 c_0 + c_1 T) s/T) for s < T, then 0,

with c_0 and c_1 the jumps in position and velocity at t_k: f goes on with the position and velocity that it has, and
joins the new motion at the end of the next communication step T, there with its acceleration too. Until T is known (no
step has been asked for) c = c_0 + c_1 s: outputs at t_k show no acceleration that is none of the input's.
For samples (x_k, v_k) of a smooth motion the positions at communication points lag by a h^2/2, a its acceleration, the
velocities by a h; the error between them is of the same order.

Accelerations reach 12 c_0/T^2 + 6 c_1/T. For a massless frame (`MovingFrame2D`) that costs nothing; of a body with mass
the driver's reaction has them.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import internal
from .signals import InputSignal, evaluate_signal

MOTION = 7
"""Kind of a signal beside those of `signals.py`: its pool is MOTION, rows of position and rate, place of its block."""
INPUT_WIDTH = 3
"""Numbers an input channel has in the array of inputs."""
BLOCK = 4
"""Numbers a motion has behind the input channels: c_0, c_1, t_k, T (0: not known yet)."""


def input_rows(channels: int, motions: int) -> int:
    """Rows of the array of inputs."""
    return max(channels, 1) + -(-BLOCK * motions // INPUT_WIDTH)


@internal
def evaluate_motion(pool: Any, inputs: Any, offset: int, t: float) -> Any:
    """(f, f', f'') at time `t` of the motion that starts at `pool[offset]`: any time function, or an input's."""
    if int(pool[offset]) != MOTION:
        return evaluate_signal(pool, inputs, offset, t)
    x = inputs[INPUT_WIDTH * int(pool[offset + 1])]
    row, block = int(pool[offset + 2]), int(pool[offset + 3])
    s = t - inputs[block + 2]
    v = 0.0 if row < 0 else inputs[INPUT_WIDTH * row]
    c, dc, ddc = closing(inputs[block], inputs[block + 1], inputs[block + 3], s)
    return x + v * s + c, v + dc, ddc


@internal
def closing(c0: float, c1: float, duration: float, s: float) -> Any:
    """(c, c', c'') a time `s` after jumps c0 in position and c1 in velocity that close within `duration` (s; 0: no end
    known yet)."""
    if duration == 0.0:
        return c0 + c1 * s, c1, 0.0
    if s >= duration or (c0 == 0.0 and c1 == 0.0):
        return 0.0, 0.0, 0.0
    u, b = 1.0 - s / duration, 3.0 * c0 + c1 * duration
    # with u: u^3 (c0 + b) - b u^4
    a = c0 + b
    c = u * u * u * (a - b * u)
    dc = -u * u * (3.0 * a - 4.0 * b * u) / duration
    ddc = u * (6.0 * a - 12.0 * b * u) / (duration * duration)
    return c, dc, ddc


@dataclass(frozen=True)
class InputMotion:
    """A motion that is an input: its channels' numbers, and where its block starts in the flat array of inputs."""

    position: int
    rate: int
    """-1: none, the velocity is 0."""
    block: int

    @classmethod
    def of(cls, signal: InputSignal, inputs: dict[str, int], number: int) -> "InputMotion":
        """The motion `number` of a model whose input channels have these numbers."""
        rate = -1 if signal.rate is None else inputs[signal.rate]
        return cls(inputs[signal.channel], rate, INPUT_WIDTH * max(len(inputs), 1) + BLOCK * number)

    def pool(self) -> list[float]:
        """Its numbers in the pool of signals."""
        return [float(x) for x in (MOTION, self.position, self.rate, self.block)]

    def state(self, inputs: NDArray[np.float64], t: float) -> tuple[float, float]:
        """Position and velocity at time `t`, the same bits as the compiled `evaluate_motion` gives."""
        flat = inputs.reshape(-1)
        c0, c1, since, duration = (float(x) for x in flat[self.block : self.block + BLOCK])
        x, v = self.said(inputs)
        c, dc, _ = closing.py_func(c0, c1, duration, t - since)
        return x + v * (t - since) + c, v + dc

    def said(self, inputs: NDArray[np.float64]) -> tuple[float, float]:
        """Position and velocity that the channels say as of the time they were set."""
        return float(inputs[self.position, 0]), 0.0 if self.rate < 0 else float(inputs[self.rate, 0])

    def jumps(self, inputs: NDArray[np.float64]) -> NDArray[np.float64]:
        """Its block (4,), to be read and written."""
        return inputs.reshape(-1)[self.block : self.block + BLOCK]
