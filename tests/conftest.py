"""Slow tests come last, and may be left out from some moment on: on a machine of which nobody knows how fast it is, the
others are all run in any case."""

import time

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption(
        "--slow-until",
        type=float,
        metavar="SECONDS",
        help="tests marked slow that have not begun by then (seconds since 1970, as `date +%%s` prints) are skipped",
    )


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    items.sort(key=lambda item: item.get_closest_marker("slow") is not None)


def pytest_runtest_setup(item: pytest.Item) -> None:
    until = item.config.getoption("--slow-until")
    if until is not None and time.time() > until and item.get_closest_marker("slow"):
        pytest.skip("slow, and time is out (--slow-until)")
