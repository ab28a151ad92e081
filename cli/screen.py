"""What goes to the screen: figures to stdout, progress and messages to stderr."""

import json
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager
from typing import Any

import typer
from rich import box
from rich.console import Console
from rich.progress import BarColumn, Progress, SpinnerColumn, TextColumn, TimeElapsedColumn
from rich.table import Table
from rich.text import Text

WIDTH = 120
"""Columns of a table that goes into a file or a pipe."""


def stdout() -> Console:
    """Where figures go."""
    return Console(highlight=False, width=None if sys.stdout.isatty() else WIDTH)


def stderr() -> Console:
    """Where everything else goes."""
    return Console(stderr=True, highlight=False, soft_wrap=True)


def say(text: str) -> None:
    """A message that is no figure."""
    stderr().print(text, markup=False)


def number(value: Any, digits: int = 6) -> str:
    """A number with `digits` significant digits; other values as they are."""
    if isinstance(value, bool) or not isinstance(value, float):
        return str(value)
    return f"{value:.{digits}g}"


def print_json(data: Any) -> None:
    """`data` as one JSON object on stdout; figures that are not finite become null."""
    typer.echo(json.dumps(plain(data), allow_nan=False))


def plain(data: Any) -> Any:
    """`data` with plain types only, fit for JSON."""
    if isinstance(data, dict):
        return {str(key): plain(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [plain(value) for value in data]
    if hasattr(data, "tolist"):  # numpy
        return plain(data.tolist())
    if isinstance(data, float):
        return data if math.isfinite(data) else None
    return data if data is None or isinstance(data, bool | int | str) else str(data)


def print_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[Any]], left: int = 1) -> None:
    """A table; numbers with six digits, the columns after the first `left` to the right."""
    table = Table(title=title or None, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, pad_edge=False)
    for k, column in enumerate(columns):
        table.add_column(column, justify="left" if k < left else "right", overflow="fold")
    for row in rows:
        table.add_row(*(Text(number(value)) for value in row))
    stdout().print(table)


def shortened(rows: Sequence[Sequence[Any]], most: int = 24) -> list[Sequence[Any]]:
    """The rows, those in the middle left out if there are more than `most`."""
    if len(rows) <= most:
        return list(rows)
    half = most // 2
    gap = [f"… {len(rows) - 2 * half} more …", *([""] * (len(rows[0]) - 1))]
    return [*rows[:half], gap, *rows[-half:]]


@contextmanager
def compile_notice() -> Iterator[None]:
    """Say when compiling begins and what it took: a warm cache compiles nothing, so this is the first run (or a new
    method)."""
    from ..core.compiled.notices import hear

    with hear(lambda level, text: say(text)):
        yield


@contextmanager
def progress_bar(text: str, t_end: float) -> Iterator[Callable[[float], None]]:
    """A bar over simulated time, or other work up to `t_end`, on a terminal only; gives what is called with how far it
    is."""
    console = stderr()
    if not console.is_terminal:
        yield lambda t: None
        return
    columns = (SpinnerColumn(), TextColumn("{task.description}"), BarColumn(), TimeElapsedColumn())
    with Progress(*columns, console=console, transient=True) as bar:
        task = bar.add_task(text, total=t_end)
        yield lambda t: bar.update(task, completed=t)


@contextmanager
def status_line(text: str) -> Iterator[Callable[[str], None]]:
    """A line that says what is being done: replaced on a terminal, one below the other elsewhere."""
    console = stderr()
    if not console.is_terminal:
        say(text)
        yield say
        return
    with console.status(Text(text)) as status:
        yield lambda line: status.update(Text(line))
