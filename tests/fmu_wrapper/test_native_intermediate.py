"""Intermediate updates of FMUs without Python: what is read in them and behind them is of its time, bit for bit as in
the FMU with Python, and as without a callback."""

import numpy as np
import pytest
from native_pair import scenario_pair
from tlismni.core.compiled.library import LIBRARY

pytestmark = pytest.mark.skipif(LIBRARY is None, reason="needs the library of machine code (tlismni.core.aot)")
STEPS = 40


class Listener:
    """Reads so many of the outputs in each intermediate update; none if `count` is 0."""

    def __init__(self, count):
        self.count, self.side, self.seen = count, None, []

    def __call__(self, environment, time, set_requested, get_allowed, finished, can_return, wanted, end):
        if self.count:
            self.seen.append((time, self.side.fmu.getFloat64(self.side.reals[: self.count])))


def rows(pair, number, count, end):
    """All outputs behind each step, and what was seen in updates; `count` None: no callback."""
    listener = None if count is None else Listener(count)
    how = {} if listener is None else {"intermediateUpdate": listener, "requiredIntermediateVariables": []}
    side = pair.instances(**how)[number]
    if listener is not None:
        listener.side = side
    side.begin()
    found = []
    for k in range(STEPS):
        if k % 7 == 3:  # some points are not read
            side.step(end / STEPS)
            continue
        side.step(end / STEPS)
        found.append(side.read())
    return found, [] if listener is None else listener.seen


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name, end", [("heavy_top", 0.5), ("rod_wall", 1e-3), ("bouncing_ball", 1.5), ("chain", 0.3)])
def test_outputs_are_those_of_the_present_time(name, end, tmp_path):
    pair = scenario_pair(name, tmp_path, "3.0")
    plain, _ = rows(pair, 0, None, end)
    for count in (0, 1, 10**6):
        native, seen = rows(pair, 0, count, end)
        python, seen_too = rows(pair, 1, count, end)
        assert native == plain == python, count
        assert len(seen) == len(seen_too) and (count == 0 or len(seen) > 3)
        for (t, values), (t_too, values_too) in zip(seen, seen_too, strict=True):
            assert t == t_too and np.array(values).tobytes() == np.array(values_too).tobytes()
