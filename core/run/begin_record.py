"""The record that `begin_now` works with: what a model gives a run to start from."""

import numpy as np

from ..tables.scales import MOST_TIMES

BEGIN = np.dtype(
    [
        (name, np.int64)
        for name in (
            "exchange", "drive",                # addresses of the records
            "state", "blank", "n_blank",        # the state, and what it is before a run begins: words
            "numbers",                          # (BEGIN_SIZE,) float64
            "q0", "v0",                         # (n,) float64: as they are given
            "placed", "n_placed",               # (n_placed, 2) int64: coordinates that start where a row of Phi says
            "internal", "angle",                # (n,) int64: 1 for internal coordinates, and for angles
            "work_sizes",                       # (n_ext,) float64: of work accounts that are no energies; 0: none
            "m_joints", "energies",             # rows of joints; column of a sample of the first of three energies
            "later", "scale", "mass", "sizes",  # room: (LATER,), (n,), (n,), (m_ext,) float64
        )
    ]
)  # fmt: skip

# columns of `numbers`
T0 = 0  # s
LENGTH, LONGEST_STEP = 1, 2  # size of the mechanism, m; step beyond which error control misses a time function, s
START_TOLERANCE = 3
STEP, FIRST_STEP, NEWTON_TOLERANCE = 4, 5, 6  # settings; 0: not given
LENGTHS, ANGLES, SPEEDS, ANGULAR_SPEEDS = 7, 8, 9, 10  # absolute tolerances
OF_SCALES = 4  # so many columns behind each: 1 where it is a part of the model's own scales
BEGIN_SIZE = 15

LATER = MOST_TIMES + 3
"""Now, later times of forces and drivers, and two more within the longest step."""
