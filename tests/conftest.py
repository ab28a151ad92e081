"""Quick tests come first, and from some moment on those that are left are left out: how fast the machine is on which a
change is looked at, nobody knows, but when it must end."""

import json
import math
import time
from collections import defaultdict
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile("no clock", deadline=None, suppress_health_check=[HealthCheck.too_slow])
settings.load_profile("no clock")

DURATIONS = Path(__file__).with_name("durations.json")
"""Mean seconds of the tests of a function, of those above LISTED; written by `pytest --store-durations`. Of functions
that have not been stored, their folder's, if it is there: a guess."""
LISTED = 0.1
LEAST_SHARE = 0.25
"""Of the tests that must have run: with fewer the session fails."""


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--until",
        type=float,
        metavar="SECONDS",
        help="leave out what has not begun by then (seconds since 1970, as `date +%%s` prints)",
    )
    parser.addoption("--store-durations", action="store_true", help=f"write {DURATIONS.name}")


def pytest_configure(config: pytest.Config) -> None:
    # workers of xdist hand on what they see
    if getattr(config, "workerinput", None) is None:
        config.pluginmanager.register(Watch(config.getoption("--store-durations")))


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """By powers of two of seconds, so that tests which share what is made for a module stay together."""
    known = json.loads(DURATIONS.read_text())

    def level(item: pytest.Item) -> int:
        function = _function(item.nodeid)
        seconds = known.get(function, known.get("/".join(function.split("/")[:2]), LISTED))
        return max(math.ceil(math.log2(seconds / LISTED)), 0)

    items.sort(key=level)


def pytest_runtest_setup(item: pytest.Item) -> None:
    until = item.config.getoption("--until")
    if until is not None and time.time() > until:
        pytest.skip(Watch.REASON)


def _function(nodeid: str) -> str:
    return nodeid.partition("[")[0]


class Watch:
    """What has run, in all workers."""

    REASON = "time is out (--until)"

    def __init__(self, stores: bool) -> None:
        self._stores = stores
        self._seconds: dict[str, float] = defaultdict(float)
        self._left_out = 0

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        self._seconds[report.nodeid] += report.duration
        self._left_out += report.skipped and self.REASON in str(report.longrepr)

    @pytest.hookimpl(trylast=True)
    def pytest_sessionfinish(self, session: pytest.Session) -> None:
        if self._left_out > (1.0 - LEAST_SHARE) * len(self._seconds):
            session.exitstatus = pytest.ExitCode.TESTS_FAILED
        if self._stores:
            self._store()

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if self._left_out:
            most = f"at least {LEAST_SHARE:.0%} must run"
            text = f"{self._left_out} of {len(self._seconds)} tests were left out, the longest: {self.REASON}; {most}"
            terminalreporter.write_line(text)

    def _store(self) -> None:
        """What was run takes the place of what is known; other functions stay as they are."""
        ran: dict[str, list[float]] = defaultdict(list)
        for nodeid, seconds in self._seconds.items():
            ran[_function(nodeid)].append(seconds)
        known = {name: seconds for name, seconds in json.loads(DURATIONS.read_text()).items() if name not in ran}
        known |= {name: round(sum(each) / len(each), 1) for name, each in ran.items()}
        listed = {name: known[name] for name in sorted(known) if known[name] > LISTED}
        DURATIONS.write_text(json.dumps(listed, indent=0) + "\n")
