"""The command in this process, and as a process of its own."""

import json
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import pytest

pytest.importorskip("typer")

from tlismni.cli.app import app
from typer.testing import CliRunner


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    code: int
    out: str
    err: str

    @property
    def json(self) -> Any:
        """The one JSON object on stdout (a second one, or other text, is an error)."""
        return json.loads(self.out)

    @property
    def cause(self) -> str:
        """The one line on stderr, besides the notices of compiling that a cold cache brings."""
        notices = ("compiling ", "compiled ", "waiting for ")
        (line,) = [line for line in self.err.splitlines() if not line.startswith(notices)]
        return line


@pytest.fixture
def tlismni() -> Callable[..., Outcome]:
    """Run a command in this process."""

    def run(*arguments: object) -> Outcome:
        result = CliRunner().invoke(app, [str(a) for a in arguments], prog_name="tlismni")
        return Outcome(result.exit_code, result.stdout, result.stderr)

    return run


@pytest.fixture
def process() -> Callable[..., Outcome]:
    """Run a command as a process of its own."""

    def run(*arguments: object) -> Outcome:
        result = subprocess.run(
            [sys.executable, "-m", "tlismni.cli", *(str(a) for a in arguments)],
            capture_output=True,
            text=True,
            timeout=1200,
            check=False,
        )
        return Outcome(result.returncode, result.stdout, result.stderr)

    return run
