"""Which rows of Phi are of one mechanism: bodies that joints connect, not counting connections through the ground."""

import numpy as np
from numpy.typing import NDArray

Numbers = NDArray[np.int64]


def mechanisms(m: int, n: int, rows: Numbers, cols: Numbers) -> Numbers:
    """The least number of a row that each of `m` rows is connected with, (m,): rows that depend on one coordinate are
    of one mechanism.

    Parameters
    ----------
    n : number of coordinates.
    rows, cols : row and coordinate of each entry of the Jacobian.
    """
    number = np.arange(m)
    while True:
        least = np.full(n, m)
        np.minimum.at(least, cols, number[rows])
        before = number.copy()
        np.minimum.at(number, rows, least[cols])
        number = number[number]
        if np.array_equal(number, before):
            return number
