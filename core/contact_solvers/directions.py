"""Which directions of contacts do not repeat others."""

from typing import Any

import numpy as np

from ..compiled import types
from ..compiled.jit import caller, compiled
from ..linalg.small import add, dot
from ..rounding import DIRECTION_RANK

_TABLE, _VECTOR = types.Array(types.float64, 2, "C"), types.Array(types.float64, 1, "C")
_WHOLES = types.Array(types.int64, 1, "C")
INDEPENDENT_SIGNATURE = types.int64(_TABLE, _TABLE, _WHOLES, types.int64, types.int64, types.float64, _WHOLES, _VECTOR)
FARTHEST_SIGNATURE = types.int64(_TABLE, _WHOLES, _WHOLES, _VECTOR)
call_independent, call_farthest = caller(INDEPENDENT_SIGNATURE), caller(FARTHEST_SIGNATURE)
"""call_independent(address of `independent_directions`, ...) and call_farthest."""
HALF = 0.5
"""Directions of which so much is left, in parts of the most, are as good as those with the most."""


def independent_size(count: int, coordinates: int) -> int:
    """Numbers in the scratch of `independent_directions`."""
    return 2 * (count + 1) * coordinates + 2 * count


def farthest_size(count: int) -> int:
    """Numbers in the scratch of `farthest_directions`."""
    return count * (count + 2)


@compiled
def independent_directions(
    directions: Any, responses: Any, some: Any, first: int, second: int, rank: float, kept: Any, work: Any
) -> int:
    """Positions in `some` of directions that do not repeat one another go to `kept`; returns how many there are.

    Of several choices that span the same motions, one that is well conditioned: each time the first direction of which
    those chosen before leave at least HALF of what they leave of any other (threshold pivoting).

    Parameters
    ----------
    directions, responses : G and G M_b, each (directions, coordinates).
    some : numbers of directions, (count,) int64, the most important ones first.
    first, second : `some` has three classes, which end before these positions and at its end; all that a class can
        give is chosen before the next one.
    rank : part of a direction's inverse mass that must be left of it.
    kept : (count,) int64.
    work : scratch, (independent_size(count, coordinates),).
    """
    count, n = len(some), directions.shape[1]
    left, size = work[:count], work[count : 2 * count]
    x, moved = work[2 * count : 2 * count + n], work[2 * count + n : 2 * count + 2 * n]
    bases, found, begin = work[2 * count + 2 * n :], 0, 0
    for k in range(count):
        size[k] = dot(directions[some[k]], responses[some[k]])
        left[k] = 1.0 if size[k] > 0.0 else 0.0
    for number in range(3):
        end = first if number == 0 else (second if number == 1 else count)
        while True:
            most = rank
            for k in range(begin, end):
                most = max(most, left[k])
            k = begin
            while k < end and not left[k] >= max(HALF * most, rank):
                k += 1
            if k >= end:
                break
            left[k] = 0.0
            for i in range(n):
                x[i], moved[i] = directions[some[k], i], responses[some[k], i]
            # orthogonal to one another, in the product that the inverse masses make, and of unit size; twice, for
            # rounding
            for _ in range(2):
                for i in range(found):
                    at = 2 * i * n
                    part = dot(bases[at + n : at + 2 * n], x)
                    add(x, -part, bases[at : at + n])
                    add(moved, -part, bases[at + n : at + 2 * n])
            rest = dot(x, moved)
            if not rest > rank * size[k]:
                continue
            root, at = np.sqrt(rest), 2 * found * n
            for i in range(n):
                bases[at + i], bases[at + n + i] = x[i] / root, moved[i] / root
            kept[found] = k
            found += 1
            for j in range(begin, count):
                if left[j] > 0.0:
                    part = dot(bases[at + n : at + 2 * n], directions[some[j]])
                    left[j] = max(left[j] - part * part / size[j], 0.0)
        begin = end
    return found


@compiled
def farthest_directions(matrix: Any, among: Any, kept: Any, work: Any) -> int:
    """Those of the directions `among` that do not repeat others, each time the one that is least held by those before
    it, go to `kept` in their order in `among`; returns how many there are.

    Parameters
    ----------
    matrix : inverse masses, (directions, directions).
    among : numbers of directions, (count,) int64, ascending.
    kept : numbers of directions, (count,) int64.
    work : scratch, (farthest_size(count),).
    """
    count, found = len(among), 0
    scale, chosen = work[count * count : count * (count + 1)], work[count * (count + 1) : count * (count + 2)]
    for i in range(count):
        for j in range(count):
            work[i * count + j] = matrix[among[i], among[j]]
        scale[i], chosen[i] = work[i * count + i], 0.0
    for _ in range(count):
        k = 0
        for i in range(count):
            if work[i * count + i] > work[k * count + k]:
                k = i
        pivot = work[k * count + k]
        if not pivot > DIRECTION_RANK * scale[k]:
            break
        chosen[k] = 1.0
        row = work[k * count : (k + 1) * count]
        for i in range(count):
            held = work[i * count + k]
            if i != k and held != 0.0:
                # (the order of product and quotient decides between equals)
                for j in range(count):
                    work[i * count + j] -= held * row[j] / pivot
        for i in range(count):
            row[i] = 0.0
    for i in range(count):
        if chosen[i] != 0.0:
            kept[found] = among[i]
            found += 1
    return found
