"""`method_matrix`: every method on every scenario, in two processes, each pair written down as it is done."""

import json
import os
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import closing, contextmanager
from dataclasses import asdict, dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

from ....core import ModelError
from ....models import ScenarioError, names
from ...provenance import provenance
from ...workers import Workers
from ..cases import Setting, contenders
from .equal import equal_rows
from .jobs import Done, Job, died, do, wall_limit
from .measure import QUICK, Sweep
from .records import Header, Pair, ReferenceFigures

PROCESSES = 2
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS")
Key = tuple[str, str]
"""Scenario and label of a setting."""


@dataclass(frozen=True)
class MethodMatrix:
    """The figures of the matrix."""

    sweep: Sweep
    references: tuple[ReferenceFigures, ...]
    pairs: tuple[Pair, ...]

    @cached_property
    def scenarios(self) -> tuple[str, ...]:
        """Those with a reference, in the order of the catalogue."""
        return tuple(reference.scenario for reference in self.references if reference.ok)

    @cached_property
    def labels(self) -> tuple[str, ...]:
        """Of the settings, in the order of the contenders."""
        found = {pair.setting.label for pair in self.pairs}
        return tuple(setting.label for setting in contenders() if setting.label in found)

    def pair(self, scenario: str, label: str) -> Pair:
        """One pair. Raises KeyError if there is none."""
        return self._by_key[scenario, label]

    @cached_property
    def _by_key(self) -> dict[Key, Pair]:
        return {(pair.scenario, pair.setting.label): pair for pair in self.pairs}

    def rows(self) -> list[dict[str, Any]]:
        """One row a pair, see `equal_rows`."""
        return equal_rows(self.pairs, {r.scenario: r for r in self.references}, self.sweep.levels)

    def to_dict(self) -> dict[str, Any]:
        """Plain data."""
        return {
            "machine": provenance(),
            "sweep": asdict(self.sweep),
            "references": [reference.model_dump() for reference in self.references],
            "pairs": [{**pair.model_dump(), "label": pair.setting.label} for pair in self.pairs],
            "rows": self.rows(),
        }


def method_matrix(
    scenarios: Iterable[str] | None = None,
    methods: Iterable[str] | None = None,
    *,
    sweep: Sweep | None = None,
    quick: bool = False,
    processes: int | None = None,
    records: str | Path | None = None,
    tell: Callable[[str, float], None] | None = None,
) -> MethodMatrix:
    """Run every contender on every scenario with tolerances from loose to tight, against a reference.

    Parameters
    ----------
    scenarios, methods : names; None: all of them.
    sweep : tolerances, levels of error, limit of a run; `quick` is a shorter one.
    processes : that work at once; None: two, or one on a machine with one core. 1 works in this process.
    records : a file (JSON lines) to which each pair is added when it is done, and from which those that are done
        are read: a study that was stopped goes on. If it was made with other settings or versions it is refused.
    tell : called with what has been done, and the share of all pairs (0 ... 1).

    Raises
    ------
    ModelError : for an unknown method, or records of another study. ScenarioError : for an unknown scenario.
    """
    chosen = tuple(dict.fromkeys(names() if scenarios is None else scenarios))
    for name in chosen:
        if name not in names():
            raise ScenarioError(f"unknown scenario '{name}'; there are {list(names())}")
    settings, what = contenders(methods), sweep or (QUICK if quick else Sweep())
    say = tell or (lambda text, share: None)
    with tempfile.TemporaryDirectory(prefix="tlismni-study-") as folder:
        book = _Book(None if records is None else Path(records), what)
        workers = min(PROCESSES, os.cpu_count() or 1) if processes is None else max(1, processes)
        if workers == 1:
            _work_here(chosen, settings, what, book, folder, say)
        else:
            _work_apart(chosen, settings, what, book, folder, say, workers)
    references = tuple(book.references[name] for name in chosen)
    keys = [(name, setting.label) for name in chosen for setting in settings if book.references[name].ok]
    return MethodMatrix(what, references, tuple(book.pairs[key] for key in keys))


class _Book:
    """What is done, in memory and, if there is one, in a file."""

    def __init__(self, path: Path | None, sweep: Sweep) -> None:
        self.path, self.torn = path, False
        self.references: dict[str, ReferenceFigures] = {}
        self.pairs: dict[Key, Pair] = {}
        versions = {name: str(x) for name, x in provenance()["versions"].items()}
        # as JSON has it: tuples are lists there
        header = Header(sweep=json.loads(json.dumps(asdict(sweep))), versions=versions)
        if path is not None:
            self._open(path, header)

    def _open(self, path: Path, header: Header) -> None:
        path.parent.mkdir(parents=True, exist_ok=True)
        if not path.exists():
            self._write(header)
            return
        # a study that was stopped may leave half a line, and half a character at its end
        text = path.read_text(encoding="utf-8", errors="replace")
        self.torn, lines = not text.endswith("\n"), text.split("\n")
        try:
            old = Header.model_validate_json(lines[0])
        except ValueError as error:
            raise ModelError(f"'{path}' holds no records of a method study: name another file") from error
        if old != header:
            raise ModelError(
                f"the records in '{path}' were made with other tolerances, limits or versions: name another file, or "
                "remove this one"
            )
        for line in lines[1:]:
            try:
                kind, _, text = line.partition(" ")
                if kind == "reference":
                    self.add(ReferenceFigures.model_validate_json(text), new=False)
                elif kind == "pair":
                    self.add(Pair.model_validate_json(text), new=False)
            except ValueError:
                # the line at which the study was stopped: it is made again
                continue

    def add(self, found: Done, new: bool = True) -> None:
        """Keep it, and write it down if it is new; a reference that is made again, for more pairs, is not."""
        if isinstance(found, Pair):
            self.pairs[found.scenario, found.setting.label] = found
        else:
            new = new and found.scenario not in self.references
            self.references[found.scenario] = found
        if new:
            self._write(found, "pair " if isinstance(found, Pair) else "reference ")

    def _write(self, record: Any, kind: str = "") -> None:
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as stream:
                # what is appended to a torn line would be lost with it
                stream.write("\n" * self.torn + f"{kind}{record.model_dump_json()}\n")
            self.torn = False

    def needs_reference(self, scenario: str, todo: Sequence[Setting]) -> bool:
        """True if there is none yet, or its course is needed again; one that could not be made is not tried again."""
        known = self.references.get(scenario)
        return known is None or (known.ok and bool(todo))

    def missing(self, scenario: str, settings: Sequence[Setting]) -> list[Setting]:
        """Settings that have not been run on a scenario."""
        return [setting for setting in settings if (scenario, setting.label) not in self.pairs]


def _work_here(
    chosen: Sequence[str], settings: Sequence[Setting], sweep: Sweep, book: _Book, folder: str,
    tell: Callable[[str, float], None],
) -> None:  # fmt: skip
    total = len(chosen) * len(settings)
    for k, name in enumerate(chosen):
        todo = book.missing(name, settings)
        if book.needs_reference(name, todo):
            book.add(do(Job(name, sweep, folder)))
        for j, setting in enumerate(todo if book.references[name].ok else ()):
            book.add(do(Job(name, sweep, folder, setting)))
            tell(f"{name}, {setting.label}", (k * len(settings) + j + 1) / total)


def _work_apart(
    chosen: Sequence[str], settings: Sequence[Setting], sweep: Sweep, book: _Book, folder: str,
    tell: Callable[[str, float], None], workers: int,
) -> None:  # fmt: skip
    """First all references, then all pairs. A process that dies takes its own job only."""
    todo = {name: book.missing(name, settings) for name in chosen}
    done, total = sum(len(settings) - len(x) for x in todo.values()), len(chosen) * len(settings)
    pool: Workers[Job, Done] = Workers(do, workers, died, wall_limit(sweep))
    references = [Job(name, sweep, folder) for name in chosen if book.needs_reference(name, todo[name])]
    for job, found in _results(pool, references):
        book.add(found)
        tell(f"{job.scenario}: reference", done / total)
    done += sum(len(todo[name]) for name in chosen if not book.references[name].ok)
    pairs = [Job(name, sweep, folder, x) for name in chosen if book.references[name].ok for x in todo[name]]
    for job, found in _results(pool, pairs):
        book.add(found)
        done += 1
        tell(f"{job.scenario}, {job.setting.label if job.setting else ''}", done / total)


def _results(pool: Workers[Job, Done], jobs: Sequence[Job]) -> Iterator[tuple[Job, Done]]:
    # closed at once if the study is stopped: its processes end with it
    with _one_thread(), closing(pool.run(jobs, lambda job, text: None)) as results:  # type: ignore[type-var]
        yield from results


@contextmanager
def _one_thread() -> Iterator[None]:
    """Processes that start meanwhile keep their linear algebra to one thread: CPU times are those of one core."""
    before = {name: os.environ.get(name) for name in THREADS}
    os.environ.update(dict.fromkeys(THREADS, "1"))
    try:
        yield
    finally:
        for name, value in before.items():
            if value is None:
                os.environ.pop(name, None)
            else:
                os.environ[name] = value
