"""`method_matrix`: every method on every scenario, in two processes, each pair written down as it is done."""

import json
import multiprocessing
import os
import signal
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import Future, ProcessPoolExecutor, as_completed
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from functools import cached_property, lru_cache
from pathlib import Path
from typing import Any

from ....core import ModelError
from ....models import ScenarioError, names
from ...provenance import provenance
from ..cases import Setting, contenders
from . import course as courses
from .equal import equal_rows
from .measure import QUICK, Measured, Sweep
from .problems import problem_of
from .records import Header, Pair, ReferenceFigures
from .references import make_reference

PROCESSES = 2
REFERENCE_LIMIT = 60.0
"""CPU time of a reference, s."""
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
        self.path = path
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
        lines = path.read_text(encoding="utf-8").splitlines()
        try:
            old = Header.model_validate_json(lines[0])
        except (ValueError, IndexError) as error:
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
                    self.add_reference(ReferenceFigures.model_validate_json(text), new=False)
                elif kind == "pair":
                    self.add_pair(Pair.model_validate_json(text), new=False)
            except ValueError:
                # the line at which the study was stopped: it is made again
                continue

    def add_reference(self, figures: ReferenceFigures, new: bool = True) -> None:
        self.references[figures.scenario] = figures
        if new:
            self._write(figures, "reference ")

    def add_pair(self, pair: Pair, new: bool = True) -> None:
        self.pairs[pair.scenario, pair.setting.label] = pair
        if new:
            self._write(pair, "pair ")

    def _write(self, record: Any, kind: str = "") -> None:
        if self.path is not None:
            with self.path.open("a", encoding="utf-8") as stream:
                stream.write(f"{kind}{record.model_dump_json()}\n")

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
        if not todo and name in book.references:
            continue
        book.add_reference(_reference(name, folder), new=name not in book.references)
        for j, setting in enumerate(todo if book.references[name].ok else ()):
            book.add_pair(_pair(name, setting, sweep, folder))
            tell(f"{name}, {setting.label}", (k * len(settings) + j + 1) / total)


def _work_apart(
    chosen: Sequence[str], settings: Sequence[Setting], sweep: Sweep, book: _Book, folder: str,
    tell: Callable[[str, float], None], workers: int,
) -> None:  # fmt: skip
    todo = {name: book.missing(name, settings) for name in chosen}
    done, total = sum(len(settings) - len(x) for x in todo.values()), len(chosen) * len(settings)
    context = multiprocessing.get_context("spawn")
    stop = context.Event()
    with _one_thread(), ProcessPoolExecutor(workers, context, _start_worker, (stop,)) as pool:
        try:
            needed = [name for name in chosen if todo[name] or name not in book.references]
            made: list[Future[Any]] = [pool.submit(_reference, name, folder) for name in needed]
            pairs: list[Future[Any]] = []
            for future in as_completed(made):
                figures = future.result()
                book.add_reference(figures, new=figures.scenario not in book.references)
                here = todo[figures.scenario]
                if figures.ok:
                    pairs += [pool.submit(_pair, figures.scenario, setting, sweep, folder) for setting in here]
                else:
                    done += len(here)
                tell(f"{figures.scenario}: reference", done / total)
            for future in as_completed(pairs):
                pair = future.result()
                book.add_pair(pair)
                done += 1
                tell(f"{pair.scenario}, {pair.setting.label}", done / total)
        except BaseException:
            # runs that go on look at this flag, so that the pool is soon closed
            stop.set()
            pool.shutdown(wait=True, cancel_futures=True)
            raise


_stop: Any = None


def _start_worker(stop: Any) -> None:
    global _stop
    _stop = stop
    # the parent alone hears Ctrl-C, and tells the workers
    signal.signal(signal.SIGINT, signal.SIG_IGN)


def _stopped() -> bool:
    return bool(_stop is not None and _stop.is_set())


def _reference(name: str, folder: str) -> ReferenceFigures:
    found = make_reference(problem_of(name), REFERENCE_LIMIT, _stopped)
    if found.course is not None:
        courses.save(found.course, Path(folder) / f"{name}.npz")
    return found.figures


def _pair(name: str, setting: Setting, sweep: Sweep, folder: str) -> Pair:
    return _measured(name, folder).sweep(setting, sweep, _stopped)


@lru_cache(maxsize=2)
def _measured(name: str, folder: str) -> Measured:
    course = courses.load(Path(folder) / f"{name}.npz")
    return Measured(problem_of(name).load(), course, float(course.t[-1]))


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
