"""Cases in processes of their own: several at once, and exudyn's end is not the end of the others."""

import logging
import multiprocessing
import os
import signal
import threading
import time
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from multiprocessing.connection import Connection, wait
from typing import Any, Generic, TypeVar, cast

logger = logging.getLogger(__name__)

Item = TypeVar("Item")
Result = TypeVar("Result")
Tell = Callable[[str], None]
Job = Callable[[Any, Tell], Any]
"""What a process does with an item; it may tell how far it is. Importable, like its items and results."""


class _Worker:
    """One process that is given an item after the other."""

    def __init__(self, job: Job) -> None:
        # spawned, not forked: exudyn and numba bring threads and state that a fork would halve
        context = multiprocessing.get_context("spawn")
        self.pipe, theirs = context.Pipe()
        self.process = context.Process(target=_serve, args=(theirs, job), daemon=True)
        self.process.start()
        theirs.close()
        self.item: Any = None
        self.since, self.begun = 0.0, False

    def give(self, item: Any) -> None:
        self.item, self.since, self.begun = item, time.perf_counter(), False
        self.pipe.send(item)

    def stop(self) -> None:
        self.process.kill()
        self.process.join()
        self.pipe.close()


class Workers(Generic[Item, Result]):
    """`count` processes that do `job` with items.

    died : makes the result of an item whose process ended (its exit code, and the seconds it took), or took
        longer than `limit` seconds (exit code None), or `start_limit` to begin.
    """

    def __init__(
        self,
        job: Job,
        count: int,
        died: Callable[[Item, int | None, float], Result],
        limit: float = 1800.0,
        start_limit: float = 300.0,
    ) -> None:
        self.job, self.count, self.died = job, count, died
        self.limit, self.start_limit = limit, start_limit

    def run(self, items: Sequence[Item], tell: Callable[[Item, str], None]) -> Iterator[tuple[Item, Result]]:
        """Items with their results as they come; `tell` gets what the processes tell in between."""
        waiting: deque[Item] = deque(items)
        workers: list[_Worker] = []
        try:
            while waiting and len(workers) < min(self.count, len(items)):
                workers.append(_Worker(self.job))
                workers[-1].give(waiting.popleft())
            while workers:
                ready = wait([w.pipe for w in workers], timeout=1.0)
                for worker in list(workers):
                    longest = self.limit if worker.begun else self.start_limit
                    if worker.pipe in ready:  # first: it may be done, and only have waited to be heard
                        kind, value = _received(worker)
                    elif time.perf_counter() - worker.since > longest:
                        kind, value = "late", None
                    else:
                        continue
                    if kind == "begun":  # a process needs seconds to start, which are not the item's
                        worker.since, worker.begun = time.perf_counter(), True
                        continue
                    if kind == "tell":
                        tell(worker.item, str(value))
                        continue
                    item, seconds = worker.item, time.perf_counter() - worker.since
                    if kind == "done":
                        result = cast(Result, value)
                    else:
                        result = self.died(item, worker.process.exitcode if kind == "died" else None, seconds)
                    if kind != "done" or not waiting:
                        worker.stop()
                        workers.remove(worker)
                        if waiting:
                            worker = _Worker(self.job)
                            workers.append(worker)
                    if waiting:
                        with suppress(ConnectionError):  # one that has ended meanwhile is found by its silence
                            worker.give(waiting.popleft())
                    yield item, result
        finally:
            for worker in workers:
                worker.stop()


def _received(worker: _Worker) -> tuple[str, Any]:
    try:
        kind, value = worker.pipe.recv()
    except Exception:  # its end, or what cannot be read
        logger.debug("no answer from a worker", exc_info=True)
        worker.process.join(5.0)
        return "died", None
    return str(kind), value


def _end_with_parent() -> None:
    """A parent that is killed stops nobody, and in a session of its own a process would go on."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        wait([parent.sentinel])
        os._exit(1)


def _serve(pipe: Connection, job: Job) -> None:
    # an interruption is the parent's to handle, which ends its processes itself: none comes from its terminal
    if hasattr(os, "setsid"):
        os.setsid()
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()
    # what compiled code prints would come between the lines of the progress
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    while True:
        try:
            item = pipe.recv()
        except EOFError:
            return
        pipe.send(("begun", None))
        pipe.send(("done", job(item, lambda text: pipe.send(("tell", text)))))
