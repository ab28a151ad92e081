"""Motions that are inputs: a position with its velocity, and what happens when they do not continue the old motion.

Between two changes the input says x(t) = x_k + v_k (t - t_k), x_k being the value of the position channel and v_k that
of its `rate` channel; derivatives given with v_k make x(t) a polynomial of higher degree. Without a rate channel it is
the position channel's own polynomial. A new (x_k, v_k) seldom continues the motion that is there: the old position
was extrapolated. A jump in position is no motion, and one in velocity would be an impact that nobody meant. So what
is constrained follows

    f(t) = x_k + v_k (t - t_k) + c(t - t_k),    c(s) = (1 - s/T)^3 (c_0 + (3 c_0 + c_1 T) s/T) for s < T, then 0,

with c_0 and c_1 the jumps in position and velocity at t_k: f goes on with the position and velocity that it has, and
joins the new motion at the end of the next communication step T, there with its acceleration too. Until T is known (no
step has been asked for) c = c_0 + c_1 s: outputs at t_k show no acceleration that is none of the input's.
For samples (x_k, v_k) of a smooth motion with acceleration a, the positions at communication points lag by a h^2/2 and
the velocities by a h; the errors between them are of the same order. With a given as v_k's derivative it is an order
more.

Accelerations reach 12 c_0/T^2 + 6 c_1/T. For a massless frame (`MovingFrame2D`) that costs nothing; of a body with mass
the driver's reaction has them.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.jit import internal
from .signals import INPUT_SIZE, InputSignal, evaluate_signal

MOTION = 7
"""Kind of a signal beside those of `signals.py`: its pool is MOTION, rows of position, rate and jumps, and a gain."""
# A motion has a row of its own behind those of the input channels: c_0, c_1, t_k, T (0: not known yet).
INPUT_JUMP, INPUT_RATE_JUMP, INPUT_SINCE, INPUT_DURATION = range(INPUT_SIZE)


def input_rows(channels: int, motions: int) -> int:
    """Rows of the array of inputs."""
    return max(channels, 1) + motions


@internal
def evaluate_motion(pool: Any, inputs: Any, offset: int, t: float) -> Any:
    """(f, f', f'') at time `t` of the motion that starts at `pool[offset]`: any time function, or an input's."""
    if int(pool[offset]) != MOTION:
        return evaluate_signal(pool, inputs, offset, t)
    jumps = INPUT_SIZE * int(pool[offset + 3])
    since, gain = inputs[jumps + INPUT_SINCE], pool[offset + 4]
    x, v, a = said(inputs, int(pool[offset + 1]), int(pool[offset + 2]), since, t)
    c, dc, ddc = closing(
        inputs[jumps + INPUT_JUMP], inputs[jumps + INPUT_RATE_JUMP], inputs[jumps + INPUT_DURATION], t - since
    )
    return gain * x + c, gain * v + dc, gain * a + ddc


@internal
def said(inputs: Any, position: int, rate: int, since: float, t: float) -> Any:
    """(x, x', x'') at time `t` as the input channels say since `since`; rate -1: there is no channel for that."""
    k = INPUT_SIZE * position
    s = (t if rate < 0 else since) - inputs[k + 3]
    x = inputs[k] + s * (inputs[k + 1] + 0.5 * s * inputs[k + 2])
    if rate < 0:
        return x, inputs[k + 1] + s * inputs[k + 2], inputs[k + 2]
    k = INPUT_SIZE * rate
    s = since - inputs[k + 3]
    v, a, j = (
        inputs[k] + s * (inputs[k + 1] + 0.5 * s * inputs[k + 2]),
        inputs[k + 1] + s * inputs[k + 2],
        inputs[k + 2],
    )
    s = t - since
    return x + s * (v + s * (0.5 * a + s * j / 6.0)), v + s * (a + 0.5 * s * j), a + s * j


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
    """A motion that is an input: its rows in the array of inputs."""

    position: int
    rate: int
    """-1: none, the velocity is the position's derivative."""
    jumps: int
    gain: float = 1.0

    @classmethod
    def of(cls, signal: InputSignal, inputs: dict[str, int], number: int) -> "InputMotion":
        """The motion `number` of a model whose input channels have these numbers."""
        rate = -1 if signal.rate is None else inputs[signal.rate]
        return cls(inputs[signal.channel], rate, max(len(inputs), 1) + number, signal.gain)

    def pool(self) -> list[float]:
        """Its numbers in the pool of signals."""
        return [float(x) for x in (MOTION, self.position, self.rate, self.jumps, self.gain)]

    def state(self, inputs: NDArray[np.float64], t: float) -> tuple[float, float]:
        """Position and velocity at time `t`, s."""
        c0, c1, since, duration = (float(x) for x in inputs[self.jumps])
        x, v = self.said(inputs, t)
        c, dc, _ = closing.py_func(c0, c1, duration, t - since)
        return x + c, v + dc

    def said(self, inputs: NDArray[np.float64], t: float) -> tuple[float, float]:
        """Position and velocity at time `t` as the channels say."""
        since = float(inputs[self.jumps, INPUT_SINCE])
        x, v, _ = said.py_func(inputs.reshape(-1), self.position, self.rate, since, t)
        return self.gain * float(x), self.gain * float(v)
