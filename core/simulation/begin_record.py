"""The record that the start of a run works with: what a model gives a run to start from."""

import numpy as np

from ..assembly.scales import MOST_TIMES

BEGIN = np.dtype(
    [
        (name, np.int64)
        for name in (
            "drive",                            # address of the record
            "numbers",                          # (BEGIN_SIZE,) float64
            "q0", "v0",                         # (n,) float64: as they are given
            "usual_v0",                         # (n,) float64: the model's, which its scales are measured with
            "placed", "n_placed",               # (n_placed, 2) int64: coordinates that start where a row of Phi says
            "internal", "angle",                # (n,) int64: 1 for internal coordinates, and for angles
            "row_sizes", "n_row_sizes",         # (m,) float64: of rows of Phi, where they are given
            "work_sizes",                       # (n_ext,) float64: of work accounts that are no energies; 0: none
            "m_joints",                         # rows of joints
            "later", "scale", "mass", "sizes",  # room: (LATER,), (n,), (n,), (m_ext,) float64
            "found",                            # (START_FOUND_SIZE,) float64
            # for runs that begin anew without Python: address of the record of `exchange`; the state, and what it is
            # before a run begins, in words; column of a sample of the first of three energies
            "exchange", "state", "blank", "n_blank", "energies",
            # words that are angles at the start whose whole turns a driver says (`native/turning.py`): (n, 2) int64,
            # address, and number of the first of (DRIVER_ANGLE, DRIVER_SIGN, MORE, LESS, its signal) in `turn_numbers`,
            # float64
            "turned", "n_turned", "turn_numbers", "n_turn_numbers",
        )
    ]
)  # fmt: skip

# columns of `numbers`
T0 = 0  # s
GIVEN_LENGTH, LONGEST_STEP = 1, 2  # size of the mechanism, m; step beyond which error control misses a time function, s
GIVEN_START_TOLERANCE = 3
GIVEN_STEP, GIVEN_FIRST_STEP, GIVEN_TOLERANCE = 4, 5, 6  # settings; 0: not given
LENGTH_TOLERANCE, ANGLE_TOLERANCE, SPEED_TOLERANCE, ANGULAR_SPEED_TOLERANCE = 7, 8, 9, 10  # absolute tolerances
OF_SCALES = 4  # so many columns behind each: 1 where it is a part of the model's own scales
LOOK_AT_RANK = 15  # 1: rows that repeat others nearly are no start, as long as it is not known that they may
BEGIN_SIZE = 16

# columns of `found`: how far positions and velocities were moved onto the constraints, as a part of their sizes, -1
# where that did not succeed; and which coordinate moved most, or which contact overlaps
MOVED_POSITIONS, MOVED_RATES, MOVED_MOST = 0, 1, 2
START_FOUND_SIZE = 3

# of each angle in `turn_numbers`: of those that differ from DRIVER_ANGLE by whole turns the one nearest to
# DRIVER_SIGN (signal + MORE - LESS)
DRIVER_ANGLE, DRIVER_SIGN, MORE, LESS, SIGNAL = range(5)

LATER = MOST_TIMES + 3
"""Now, later times of forces and drivers, and two more within the longest step."""
