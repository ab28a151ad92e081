"""Quick tests come first, and from some moment on those that are left are left out: how fast the machine is on which a
change is looked at, nobody knows, but when it must end."""

import faulthandler
import gc
import json
import math
import time
from collections import defaultdict
from pathlib import Path
from typing import Any

import pytest
from hypothesis import HealthCheck, settings
from sampled_cases import mark_left_out
from shared_work import DURATIONS, LISTED, SharedWork, durations, function_of, seconds_of, shares

settings.register_profile("no clock", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("no clock")

LEAST_SHARE = 0.25
"""Of the tests that must have run: with fewer the session fails."""
LONGEST = 900.0
"""Seconds after --until: a test that has not ended by then hangs."""
LEFT_OUT = pytest.StashKey[int]()


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--until",
        type=float,
        metavar="SECONDS",
        help="leave out what has not begun by then (seconds since 1970, as `date +%%s` prints)",
    )
    parser.addoption("--store-durations", action="store_true", help=f"write {DURATIONS.name}")


@pytest.hookimpl(trylast=True)
def pytest_configure(config: pytest.Config) -> None:
    config.stash[LEFT_OUT] = 0
    until = config.getoption("--until")
    works_for_another = getattr(config, "workerinput", None) is not None
    if until is not None and (works_for_another or not config.getoption("numprocesses", None)):
        # xdist then names the test, which fails
        faulthandler.dump_traceback_later(max(until - time.time(), 0.0) + LONGEST, exit=True)
    # workers of xdist hand on what they see
    if not works_for_another:
        config.pluginmanager.register(Watch(config))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> SharedWork | None:
    return SharedWork(config, log) if config.getoption("dist") == "load" else None


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """By powers of two of seconds. Tests of a file that share what is made once for it stay together, where the longest
    of them is. What samples leave out is marked before pytest looks for the marker."""
    mark_left_out(items)
    level = {item: math.ceil(math.log2(seconds_of(item.nodeid) / LISTED)) for item in items}
    together: dict[Path, int] = defaultdict(int)
    for item in items:
        if shares(item.path):
            together[item.path] = max(together[item.path], level[item])
    items.sort(key=lambda item: together.get(item.path, level[item]))


def pytest_collection_finish() -> None:
    """What the modules of ten thousand tests hold stays: it is not looked through again and again for what does not."""
    gc.collect()
    gc.freeze()


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> bool | None:
    """True says that the test has been dealt with: there is no report of it, which for thousands takes minutes."""
    until = item.config.getoption("--until")
    if until is None or time.time() < until:
        return None
    item.config.stash[LEFT_OUT] += 1
    return True


def pytest_sessionfinish(session: pytest.Session) -> None:
    output = getattr(session.config, "workeroutput", None)
    if output is not None:
        output["left out"] = session.config.stash[LEFT_OUT]


class Watch:
    """What has run, in all workers."""

    def __init__(self, config: pytest.Config) -> None:
        self._config = config
        self._seconds: dict[str, float] = defaultdict(float)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._seconds[report.nodeid] += report.duration

    @pytest.hookimpl(optionalhook=True)
    def pytest_testnodedown(self, node: Any) -> None:
        """Of xdist. A worker that was lost hands on nothing; that is a failure already."""
        self._config.stash[LEFT_OUT] += getattr(node, "workeroutput", {}).get("left out", 0)

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if self._config.stash[LEFT_OUT] > (1.0 - LEAST_SHARE) * self._all():
            session.exitstatus = pytest.ExitCode.TESTS_FAILED
        if self._config.getoption("--store-durations"):
            self._store()

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        left_out = self._config.stash[LEFT_OUT]
        if left_out:
            text = f"{left_out} of {self._all()} tests were left out, the longest: time is out (--until)"
            terminalreporter.write_line(f"{text}; at least {LEAST_SHARE:.0%} must run")

    def _all(self) -> int:
        return len(self._seconds) + self._config.stash[LEFT_OUT]

    def _store(self) -> None:
        """What was run takes the place of what is known; other functions stay as they are."""
        ran: dict[str, list[float]] = defaultdict(list)
        for nodeid, seconds in self._seconds.items():
            ran[function_of(nodeid)].append(seconds)
        known = {name: seconds for name, seconds in durations().items() if name not in ran}
        known |= {name: round(sum(each) / len(each), 1) for name, each in ran.items()}
        listed = {name: known[name] for name in sorted(known) if known[name] > LISTED}
        DURATIONS.write_text(json.dumps(listed, indent=0) + "\n")
