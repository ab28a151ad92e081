"""All rows of one contact side by side, for sweeps: a block of its gradients and one of the motions that they cause.

The rows of a contact act on the same few coordinates. A sweep that comes to a contact reads these once, finds the rates
of all its rows, lets one row after another take its impulse while a small matrix says how that moves the rates of the
others, and changes the coordinates once: the sweep over single rows, but for rounding, in a quarter of its time.
"""

from typing import Any

import numpy as np

from ..compiled.jit import internal
from ..compiled.views import ivec, vec

WIDE = 6
"""Rows of a block: normal, two tangents, two torques against rolling, one against spinning; what is not there is 0."""
COUPLING = WIDE * WIDE
"""Numbers before the blocks: how an impulse along each row moves the rates of all."""
HEAD = 2
"""Integers before the coordinates: how many the gradients have, and how many the motions."""


def block_wholes(most: int, n: int) -> int:
    """Integers that the blocks of so many contacts may take, with n coordinates."""
    return most * (2 + HEAD + 2 * n) + n


def block_reals(most: int, n: int) -> int:
    """Numbers that they may take."""
    return most * (COUPLING + 2 * WIDE * n)


@internal
def blocks_at(wholes: int, reals: int, most: int, n: int) -> Any:
    """Both arrays at these addresses, of so many numbers."""
    return ivec(wholes, most * (2 + HEAD + 2 * n) + n), vec(reals, most * (COUPLING + 2 * WIDE * n))


@internal
def pack_contacts(
    count: int, n: int, rows: int, directions: Any, responses: Any, of_directions: Any, of_responses: Any,
    wholes: Any, reals: Any,
) -> None:  # fmt: skip
    """The blocks of `count` contacts, whose rows are those of `directions` and `responses` (rows, n) with the entries
    that `list_columns` has found: first that of each contact, then the second of each, and so on. wholes ends with room
    for n marks, and begins with the places of each contact in both arrays."""
    of, at, place = rows // count, 2 * count, 0
    marks = wholes[len(wholes) - n :]
    for j in range(n):
        marks[j] = -1
    for i in range(count):
        wholes[i], wholes[count + i] = at, place
        for k in range(COUPLING):
            reals[place + k] = 0.0
        for k in range(of):
            r = k * count + i
            for e in range(1, of_directions[r, 0] + 1):
                j = of_directions[r, e]
                for s in range(of):
                    reals[place + WIDE * k + s] += directions[r, j] * responses[s * count + i, j]
        first, at, place = at, at + HEAD, place + COUPLING
        for part in range(2):
            listed, values = (of_directions, directions) if part == 0 else (of_responses, responses)
            width, stamp = 0, 2 * i + part
            for k in range(of):
                for e in range(1, listed[k * count + i, 0] + 1):
                    j = listed[k * count + i, e]
                    if marks[j] != stamp:
                        marks[j] = stamp
                        wholes[at + width] = j
                        width += 1
            for e in range(width):
                for k in range(WIDE):
                    reals[place + k] = values[k * count + i, wholes[at + e]] if k < of else 0.0
                place += WIDE
            wholes[first + part] = width
            at += width


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
    """One sweep over all contacts (`row_sweeps.sweep_rows`); by how much a rate has changed most. local (2 WIDE,)."""
    rates, steps, change, of = local[:WIDE], local[WIDE:], 0.0, rows // count
    for i in range(count):
        at, place = wholes[i], wholes[count + i]
        width, others, moved = wholes[at], wholes[at + 1], False
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
                    change = max(change, abs(step) * mass if s < 2 else abs(step) / radius * mass)
        if moved:
            _move(others, at + HEAD + width, place + COUPLING + WIDE * width, wholes, reals, steps, x)
    return change
