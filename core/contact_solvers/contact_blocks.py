"""All rows of one contact side by side, for sweeps: a block of its gradients and one of the motions that they cause.

The rows of a contact act on the same few coordinates. A sweep that comes to a contact reads these once, finds the rates
of all its rows, lets one row after another take its impulse while a small matrix says how that moves the rates of the
others, and changes the coordinates once: the sweep over single rows, but for rounding, in a quarter of its time.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal

WIDE = 6
"""Rows of a block: normal, two tangents, two torques against rolling, one against spinning; what is not there is 0."""
COUPLING = WIDE * WIDE
"""Numbers before the blocks: how an impulse along each row moves the rates of all."""
HEAD = 2
"""Integers before the coordinates: how many the gradients have, and how many the motions."""


SMALL = 28
"""Coordinates that a contact of two free bodies in space has, with those that its motions have."""


def block_wholes(most: int, coordinates: int) -> int:
    """Integers that the blocks of so many contacts may take, with so many coordinates of gradients and motions."""
    return most * (2 + HEAD + coordinates)


def block_reals(most: int, coordinates: int) -> int:
    """Numbers that they may take."""
    return most * (COUPLING + WIDE * coordinates)


@internal
def pack_block(
    i: int, count: int, next_whole: int, next_real: int, gradients: Any, some: Any, width: int, motions: Any,
    moved: Any, others: int, wholes: Any, reals: Any,
) -> Any:  # fmt: skip
    """The block of contact i of `count`, behind those before it: where the next one begins in `wholes` and `reals`;
    (-1, -1) where there is too little room. wholes begins with the places of each contact in both arrays, so that the
    first block begins at 2 count.

    gradients (WIDE, n) have entries at the first `width` of the coordinates `some`, motions (n, WIDE), those that unit
    impulses cause, at the first `others` of `moved`, all of `some` among them.
    """
    most_wholes, most_reals = next_whole + HEAD + width + others, next_real + COUPLING + WIDE * (width + others)
    if most_wholes > len(wholes) or most_reals > len(reals):
        return -1, -1
    wholes[i], wholes[count + i] = next_whole, next_real
    for k in range(WIDE):
        for s in range(WIDE):
            product = 0.0
            for e in range(width):
                product += gradients[k, some[e]] * motions[some[e], s]
            reals[next_real + WIDE * k + s] = product
    at, place = next_whole + HEAD, next_real + COUPLING
    wholes[next_whole], wholes[next_whole + 1] = 0, 0
    for e in range(width):
        j, any_entry = some[e], False
        for k in range(WIDE):
            reals[place + k] = gradients[k, j]
            any_entry = any_entry or gradients[k, j] != 0.0
        if any_entry:
            wholes[at], at, place = j, at + 1, place + WIDE
            wholes[next_whole] += 1
    for e in range(others):
        j, any_entry = moved[e], False
        for k in range(WIDE):
            reals[place + k] = motions[j, k]
            any_entry = any_entry or motions[j, k] != 0.0
        if any_entry:
            wholes[at], at, place = j, at + 1, place + WIDE
            wholes[next_whole + 1] += 1
    return at, place


@internal
def coupling(i: int, count: int, wholes: Any, reals: Any, k: int) -> float:
    """How an impulse along row k of contact i moves the rate of this row: its inverse mass."""
    return float(reals[wholes[count + i] + (WIDE + 1) * k])


@internal
def block_rates(i: int, count: int, wholes: Any, reals: Any, x: Any, rates: Any) -> None:
    """Products of the gradients of contact i with x (n,), to rates (WIDE,)."""
    for k in range(WIDE):
        rates[k] = 0.0
    at, place = wholes[i], wholes[count + i]
    _rates(wholes[at], at + HEAD, place + COUPLING, wholes, reals, x, rates)


@internal
def move_block(i: int, count: int, wholes: Any, reals: Any, steps: Any, x: Any) -> None:
    """Add the motion that impulses `steps` (WIDE,) of contact i cause to x (n,)."""
    at, place = wholes[i], wholes[count + i]
    width = wholes[at]
    _move(wholes[at + 1], at + HEAD + width, place + COUPLING + WIDE * width, wholes, reals, steps, x)


@internal
def normal_rate(i: int, count: int, wholes: Any, reals: Any, x: Any) -> float:
    """Product of the gap's gradient of contact i with x (n,)."""
    at, place, product = wholes[i], wholes[count + i] + COUPLING, 0.0
    for e in range(wholes[at]):
        product += reals[place + WIDE * e] * x[wholes[at + HEAD + e]]
    return float(product)


@internal
def move_normal(i: int, count: int, wholes: Any, reals: Any, impulse: float, x: Any) -> None:
    """Add the motion that a normal impulse of contact i causes to x (n,)."""
    at = wholes[i]
    width, others = wholes[at], wholes[at + 1]
    place = wholes[count + i] + COUPLING + WIDE * width
    for e in range(others):
        x[wholes[at + HEAD + width + e]] += impulse * reals[place + WIDE * e]


@internal
def _rates(width: int, at: int, place: int, wholes: Any, reals: Any, x: Any, rates: Any) -> None:
    """Add the gradients' products with x to the rates (WIDE,)."""
    r0, r1, r2, r3, r4, r5 = rates[0], rates[1], rates[2], rates[3], rates[4], rates[5]
    for j in range(width):
        y, g = x[np.uint64(wholes[at + j])], place + WIDE * j
        r0 += reals[g] * y
        r1 += reals[g + 1] * y
        r2 += reals[g + 2] * y
        r3 += reals[g + 3] * y
        r4 += reals[g + 4] * y
        r5 += reals[g + 5] * y
    rates[0], rates[1], rates[2], rates[3], rates[4], rates[5] = r0, r1, r2, r3, r4, r5


@internal
def _move(width: int, at: int, place: int, wholes: Any, reals: Any, steps: Any, x: Any) -> None:
    """Add what the impulses `steps` (WIDE,) cause to x."""
    s0, s1, s2, s3, s4, s5 = steps[0], steps[1], steps[2], steps[3], steps[4], steps[5]
    for j in range(width):
        g = place + WIDE * j
        x[np.uint64(wholes[at + j])] += (s0 * reals[g] + s1 * reals[g + 1] + s2 * reals[g + 2]) + (
            s3 * reals[g + 3] + s4 * reals[g + 4] + s5 * reals[g + 5]
        )


@internal
def sweep_contacts(
    count: int, tangents: int, stages: int, rows: int, wholes: Any, reals: Any, masses: Any, off: Any, arms: Any,
    p: Any, x: Any, local: Any,
) -> float:  # fmt: skip
    """One sweep over all contacts (`row_sweeps.sweep_rows`); by how much a rate has changed most, m/s. local
    (2 WIDE,)."""
    rates, steps, change, of = local[:WIDE], local[WIDE:], 0.0, rows // count
    for i in range(count):
        at, place = wholes[i], wholes[count + i]
        width, others, moved = wholes[at], wholes[at + 1], False
        if masses[i] == 0.0:
            # no friction without a normal impulse
            continue
        for k in range(WIDE):
            rates[k], steps[k] = off[k * count + i] if k < of else 0.0, 0.0
        _rates(width, at + HEAD, place + COUPLING, wholes, reals, x, rates)
        for stage in range(stages):
            # the normal, the tangents, rolling, spinning: each with the motion that those before have left
            k = 0 if stage == 0 else 1 if stage == 1 else tangents + 2 * stage - 3
            first, two = k * count + i, (stage == 1 and tangents == 2) or stage == 2
            second = first + count
            mass = max(masses[first], masses[second]) if two else masses[first]
            # of a patch the torque against spinning is in the tangents' ball
            spin, radius, third = (tangents + 3) * count + i, 0.0, 0.0
            if stages > 2 and (stage == 1 or stage == 3) and arms[spin] < 0.0:
                radius = -arms[spin]
                mass = max(mass, radius * radius * masses[spin])
            if mass == 0.0 or (stage > 0 and arms[first] == 0.0) or (stage == 3 and radius > 0.0):
                continue
            new = p[first] - rates[k] / mass if masses[first] > 0.0 else 0.0
            other = p[second] - rates[k + 1] / mass if two and masses[second] > 0.0 else 0.0
            if radius > 0.0 and masses[spin] > 0.0:
                third = p[spin] / radius - radius * rates[tangents + 3] / mass
            if stage == 0:
                new = max(new, 0.0)
            else:
                size, limit = np.sqrt(new * new + other * other + third * third), arms[first] * p[i]
                part = limit / size if size > limit else 1.0
                new, other, third = part * new, part * other, part * third
            for s in range(3):
                if (s == 1 and not two) or (s == 2 and radius == 0.0):
                    continue
                row = k + s if s < 2 else tangents + 3
                r = row * count + i
                step = (new if s == 0 else other if s == 1 else radius * third) - p[r]
                if step != 0.0:
                    moved = True
                    p[r] += step
                    steps[row] = step
                    for j in range(WIDE):
                        rates[j] += reals[place + WIDE * j + row] * step
                    moves = abs(step) * mass if s < 2 else abs(step) / radius * mass
                    # of a turning motion that of a point as far off as the contact feels the body's inertia
                    change = max(change, moves if stage < 2 else moves * np.sqrt(masses[i] / mass))
        if moved:
            _move(others, at + HEAD + width, place + COUPLING + WIDE * width, wholes, reals, steps, x)
    return change
