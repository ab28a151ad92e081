"""What workers of xdist are given at a time: tests that share what is made once stay with one worker."""

import json
import re
from functools import cache
from itertools import groupby
from pathlib import Path

from xdist.scheduler import LoadScopeScheduling

DURATIONS = Path(__file__).with_name("durations.json")
"""Mean seconds of the tests of a function, of those above LISTED; written by `pytest --store-durations`. Of functions
that have not been stored, their folder's, if it is there: a guess."""
LISTED = 0.1
SHARED = re.compile(r'scope="(module|session)"|^@(lru_)?cache\b|^@(numba.|nb.)?njit\b', re.M)
"""A test file with this makes or compiles something once, for several of its tests."""
PIECE = 3.0
"""Seconds of the neighbours of a file that are given at a time, if the file shares nothing."""


@cache
def shares(path: Path) -> bool:
    """Whether the tests of a file share what is made once for each worker."""
    return SHARED.search(path.read_text(encoding="utf-8")) is not None


@cache
def durations() -> dict[str, float]:
    """What is stored."""
    known: dict[str, float] = json.loads(DURATIONS.read_text())
    return known


def function_of(nodeid: str) -> str:
    """Without parameters."""
    return nodeid.partition("[")[0]


def seconds_of(nodeid: str) -> float:
    """Of a test, as far as is known; LISTED for what is quicker."""
    function = function_of(nodeid)
    folder = "/".join(function.split("/")[:2])
    return max(durations().get(function, durations().get(folder, LISTED)), LISTED)


def pieces(nodeids: list[str], root: Path) -> dict[str, str]:
    """Piece of work of each test, by its id: a file whose tests share something, or neighbours of one file."""
    found: dict[str, str] = {}
    number = 0
    for file, run in groupby(nodeids, key=lambda nodeid: nodeid.partition("::")[0]):
        number, seconds = number + 1, 0.0
        for nodeid in run:
            seconds += seconds_of(nodeid)
            if seconds > PIECE:
                number, seconds = number + 1, seconds_of(nodeid)
            found[nodeid] = file if shares(root / file) else str(number)
    return found


class SharedWork(LoadScopeScheduling):
    """Pieces of work in the order of the tests."""

    def schedule(self) -> None:
        if self.collection is None:
            self.config.option.loadscopereorder = False
            self._piece = pieces(next(iter(self.registered_collections.values())), self.config.rootpath)
        super().schedule()

    def _split_scope(self, nodeid: str) -> str:
        return self._piece[nodeid]
