"""Compiled code on disk: damage, folders that cannot be written, several processes, and who hears of compiling.

The functions compiled here are a line long, in a folder of their own.
"""

import errno
import importlib.util
import logging
import multiprocessing
import os
import signal
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
from numba import types
from tlismni.core.compiled import cache, kept, notices, store
from tlismni.core.compiled.lock import ProcessLock

SOURCE = """
from tlismni.core.compiled.jit import compiled, internal

@internal
def twice(x):
    return 2 * x

@compiled
def shifted(x):
    return twice(x) + 1
"""
ENTRIES = 2


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A private cache."""
    place = tmp_path / "cache"
    use(place, monkeypatch)
    return place


def use(place: Path | None, monkeypatch: pytest.MonkeyPatch) -> None:
    for module in (kept, notices):
        monkeypatch.setattr(module, "cache_folder", lambda: place)
    lock = None if place is None else ProcessLock(place / "compiling.lock", patience=20.0)
    monkeypatch.setattr(kept, "_lock", lambda: lock)
    monkeypatch.setattr(store, "_told", set())


@pytest.fixture
def fresh(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Callable[[], Any]:
    """Gives the module anew, as a new process would have it: with nothing compiled."""
    path = tmp_path / "small.py"
    path.write_text(SOURCE)

    def load() -> Any:
        spec = importlib.util.spec_from_file_location("small", path)
        assert spec is not None and spec.loader is not None
        module = importlib.util.module_from_spec(spec)
        monkeypatch.setitem(sys.modules, "small", module)
        spec.loader.exec_module(module)
        return module

    return load


def compiled_by(call: Callable[[], Any]) -> int:
    """How many functions were compiled for a call; those that it calls count with it."""
    before = notices.compiled_so_far().functions
    assert call() == 7
    return notices.compiled_so_far().functions - before


def warnings_in(log: pytest.LogCaptureFixture) -> list[str]:
    return [record.getMessage() for record in log.records if record.levelno >= logging.WARNING]


def test_code_is_compiled_once_and_loaded_after(folder, fresh):
    assert compiled_by(lambda: fresh().shifted(3)) == 1
    assert len(list(folder.rglob("*.nbc"))) == ENTRIES and not list(folder.rglob("*.tmp"))
    assert compiled_by(lambda: fresh().shifted(3)) == 0


def test_a_signature_with_result_is_the_same_code(folder, fresh):
    """A slave asks for the address of a function of given types, a run calls it: one entry serves both."""
    module = fresh()
    module.shifted.compile(types.int64(types.int64))
    assert compiled_by(lambda: fresh().shifted(3)) == 0
    other = fresh().shifted
    other.compile(types.float64(types.int64))  # another result is other code
    assert other(3) == 7.0 and isinstance(other(3), float)


def empty(data: bytes) -> bytes:
    return b""


def cut(data: bytes) -> bytes:
    return data[: len(data) // 2]


def flipped(data: bytes) -> bytes:
    middle = 3 * len(data) // 4
    return data[:middle] + bytes([data[middle] ^ 1]) + data[middle + 1 :]


def foreign(data: bytes) -> bytes:
    return b"not what was written"


@pytest.mark.sampled(2)
@pytest.mark.parametrize("damage", [empty, cut, flipped, foreign])
def test_damaged_entries_are_removed_and_compiled_anew(folder, fresh, caplog, damage):
    fresh().shifted(3)
    for path in folder.rglob("*.nbc"):
        path.write_bytes(damage(path.read_bytes()))
    assert compiled_by(lambda: fresh().shifted(3)) == 1
    told = warnings_in(caplog)
    assert told and all("damaged" in text and str(folder) in text for text in told)
    caplog.clear()
    assert compiled_by(lambda: fresh().shifted(3)) == 0 and not warnings_in(caplog)


def test_entries_that_were_exchanged_are_not_taken(folder, fresh):
    """The right code under the wrong name would compute something else."""
    fresh().shifted(3)
    one, other = sorted(folder.rglob("*.nbc"))
    kept_bytes = one.read_bytes()
    one.write_bytes(other.read_bytes())
    other.write_bytes(kept_bytes)
    assert compiled_by(lambda: fresh().shifted(3)) == 1


def test_where_nothing_can_be_written_memory_serves(tmp_path, fresh, caplog, monkeypatch):
    """As on a read-only file system: the folder cannot be made, nor the lock in it."""
    (tmp_path / "file").write_text("")
    use(tmp_path / "file" / "cache", monkeypatch)
    module = fresh()
    assert compiled_by(lambda: module.shifted(3)) == 1
    assert compiled_by(lambda: module.shifted(3)) == 0
    (told,) = [text for text in warnings_in(caplog) if "kept" in text]
    assert str(tmp_path / "file" / "cache") in told and "NUMBA_CACHE_DIR" in told


def test_a_full_disk_is_told_with_its_path(folder, fresh, caplog, monkeypatch):
    def write(self: Path, data: bytes) -> int:
        self.touch()
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), str(self))

    with monkeypatch.context() as full:
        full.setattr(Path, "write_bytes", write)
        assert compiled_by(lambda: fresh().shifted(3)) == 1
    (told,) = warnings_in(caplog)
    assert os.strerror(errno.ENOSPC) in told and str(folder) in told
    assert not [path for path in folder.rglob("*") if path.suffix in (".nbc", ".tmp")]


def test_without_a_folder_memory_serves(fresh, caplog, monkeypatch):
    use(None, monkeypatch)
    assert compiled_by(lambda: fresh().shifted(3)) == 1
    assert len(warnings_in(caplog)) == 1


@pytest.mark.skipif(sys.platform != "linux", reason="the custom of Linux")
def test_the_user_cache_follows_the_custom(monkeypatch, tmp_path):
    from tlismni.fmu_wrapper import boot

    monkeypatch.setenv("HOME", str(tmp_path))
    for value, expected in (
        (None, tmp_path / ".cache"),
        ("", tmp_path / ".cache"),
        ("relative/place", tmp_path / ".cache"),
        (str(tmp_path / "own"), tmp_path / "own"),
    ):
        monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
        if value is not None:
            monkeypatch.setenv("XDG_CACHE_HOME", value)
        assert cache.user_cache() == Path(boot.user_cache()) == expected
    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(os.path, "expanduser", lambda path: path)  # nobody's home
    assert cache.user_cache() is boot.user_cache() is None


# several processes

forks = pytest.mark.skipif(not hasattr(os, "fork"), reason="needs fork")


def _compile(load: Callable[[], Any], queue: Any, start: Any) -> None:
    module = load()
    start.wait()
    before = notices.compiled_so_far().functions
    result = module.shifted(3)
    queue.put((result, notices.compiled_so_far().functions - before))


@forks
def test_processes_that_start_together_compile_once(folder, fresh):
    fork = multiprocessing.get_context("fork")
    queue, start = fork.Queue(), fork.Event()
    processes = [fork.Process(target=_compile, args=(fresh, queue, start)) for _ in range(8)]
    for process in processes:
        process.start()
    start.set()
    found = [queue.get(timeout=1200) for _ in processes]
    for process in processes:
        process.join()
    assert [result for result, _ in found] == [7] * 8
    assert sum(count for _, count in found) == 1


def _hold(lock: ProcessLock, queue: Any) -> None:
    lock.acquire()
    queue.put("held")
    signal.pause()


@forks
def test_a_dead_process_holds_no_lock(tmp_path):
    fork, path = multiprocessing.get_context("fork"), tmp_path / "lock"
    queue = fork.Queue()
    holder = fork.Process(target=_hold, args=(ProcessLock(path), queue))
    holder.start()
    assert queue.get(timeout=200.0) == "held"
    assert ProcessLock(path, patience=0.05).acquire()  # held beyond our patience: we go on without
    holder.kill()
    holder.join()
    assert not ProcessLock(path, patience=20.0).acquire()  # free at once


@forks
def test_a_child_does_not_keep_its_parents_lock(tmp_path):
    lock = ProcessLock(tmp_path / "lock")
    lock.acquire()
    ready, tell = os.pipe()
    child = os.fork()
    if child == 0:
        os.write(tell, b"!")
        signal.pause()
        os._exit(0)
    try:
        os.read(ready, 1)
        lock.release()
        assert not ProcessLock(tmp_path / "lock", patience=5.0).acquire()
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)


# who hears of it


def test_compiling_is_told_once_with_what_it_took(folder, fresh, caplog):
    caplog.set_level(logging.INFO)
    heard: list[str] = []
    with notices.hear(lambda level, text: heard.append(text)), notices.compile_notices("a test"):
        fresh().shifted(3)
        fresh().twice.compile((types.float64,))
    assert [text.split(" in ")[0] for text in heard] == [
        "compiling for this machine what a test needs, once: it can take a minute",
        "compiled 2 functions",
    ]
    assert str(folder) in heard[1]
    assert [record.getMessage() for record in caplog.records] == heard
    heard.clear()
    with notices.hear(lambda level, text: heard.append(text)), notices.compile_notices("a test"):
        fresh().shifted(3)
    assert heard == []


def test_a_function_that_cannot_be_compiled_leaves_nothing_behind(folder, tmp_path, fresh):
    path = tmp_path / "wrong.py"
    path.write_text(SOURCE + "\n@compiled\ndef wrong(x):\n    return twice(x) + 'text'\n")
    spec = importlib.util.spec_from_file_location("wrong", path)
    assert spec is not None and spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    with pytest.raises(Exception, match="No implementation"):
        module.wrong(3)
    assert not kept._in_progress._stack
    lock = ProcessLock(folder / "compiling.lock", patience=5.0)
    assert not lock.acquire()
    lock.release()
    assert compiled_by(lambda: fresh().shifted(3)) == 1
