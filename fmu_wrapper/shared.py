"""What the slave of an FMU shares with the shim (shim/shared.h): real values and what holds of them, so that calls
whose answer is known need no Python."""

from typing import Any

import numpy as np
import numpy.typing as npt

LAYOUT = 1
"""Number of the layout below and of what it means; a new one with each change, here and in shared.h."""
TIME, HORIZON, POINT, STEP, REACHED = range(5)
"""Numbers, s: the instance's time; up to where steps only move it; of a step that is asked, its start and size; where
the last step has ended."""
EVENT_DUE, EARLY, BEHIND, TOLD, SETTABLE, FRESH, ASKED = range(7)
"""Flags: how the last step has ended; the time has moved; no inputs have been set that the slave does not know; inputs
can be set; the values are those of now; what came first after the last step that was made here, READING or GLIDE."""
READING, GLIDE = 1, 2
NUMBERS, FLAGS = 5, 7


class Shared:
    """Memory that is shared for `count` real values.

    Attributes
    ----------
    numbers, flags : see above.
    values : (count,) the reals, in the order of the slave's.
    address : of all of it.
    """

    def __init__(self, count: int) -> None:
        memory = np.zeros(NUMBERS + FLAGS + count)
        self.address = int(memory.ctypes.data)
        # elements of memory views are read and written in half the time of those of arrays
        numbers: Any = memory[:NUMBERS].data
        flags: Any = memory[NUMBERS : NUMBERS + FLAGS].view(np.int64).data
        numbers[HORIZON], flags[TOLD] = -np.inf, 1
        self.numbers, self.flags = numbers, flags
        self.values: npt.NDArray[np.float64] = memory[NUMBERS + FLAGS :]
