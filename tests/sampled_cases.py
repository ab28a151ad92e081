"""Which cases of a function with many parameters run by default: a sample, another one whenever the sources change."""

import hashlib
import random
from collections import defaultdict
from collections.abc import Hashable
from functools import cache
from pathlib import Path

import pytest
from shared_work import function_of

MARKER = "sampled"
"""`@pytest.mark.sampled(n)`: n cases of the function run by default; the others get the marker `full`."""
ROOT = Path(__file__).parents[1]
SOURCES = ("cli", "core", "fmu_wrapper", "models", "validation", "viewer")
Values = set[tuple[str, Hashable]]
"""Arguments with their values."""


@cache
def sources_digest() -> str:
    """Of the Python sources of the package: tests that are edited keep their samples."""
    digest = hashlib.sha256()
    for folder in SOURCES:
        for path in sorted((ROOT / folder).rglob("*.py")):
            digest.update(path.relative_to(ROOT).as_posix().encode() + b"\0" + path.read_bytes() + b"\0")
    return digest.hexdigest()


def mark_left_out(items: list[pytest.Item]) -> None:
    """Mark as `full` what the sample of its function leaves out. A case that is named alone (`file::function[case]`) is
    its sample."""
    grids: dict[str, list[pytest.Item]] = defaultdict(list)
    for item in items:
        if item.get_closest_marker(MARKER) and not item.get_closest_marker("full"):
            grids[function_of(item.nodeid)].append(item)
    for function, cases in grids.items():
        (size,) = cases[0].get_closest_marker(MARKER).args  # type: ignore[union-attr]
        chosen = sample([values(case) for case in cases], size, f"{sources_digest()} {function}")
        for number, case in enumerate(cases):
            if number not in chosen:
                case.add_marker("full")


def values(case: pytest.Item) -> Values:
    """Of a case; objects are told apart by their identity, which the cases of a function share."""
    given = case.callspec.params.items()  # type: ignore[attr-defined]
    plain = (str, int, float, bool, type(None))
    return {(name, value if isinstance(value, plain) else id(value)) for name, value in given}


def sample(cases: list[Values], size: int, seed: str) -> set[int]:
    """Numbers of `size` cases: in a random order, each time one of those with the most values that no chosen one has.
    As soon as `size` allows it, each value of each argument comes at least once."""
    left = list(range(len(cases)))
    random.Random(seed).shuffle(left)
    seen: Values = set()
    chosen: set[int] = set()
    while left and len(chosen) < size:
        best = max(left, key=lambda number: len(cases[number] - seen))
        left.remove(best)
        seen |= cases[best]
        chosen.add(best)
    return chosen
