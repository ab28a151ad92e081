"""numba's interface to kept code: looked up before a function is compiled, told after.

numba's own cache probes for a folder that can be written when a function is defined, trusts its files, and gives up
where it cannot write. This one keeps a file for each function and types of arguments (`store.py`), lets one process at
a time compile (`lock.py`), and says what takes long (`notices.py`).
"""

import hashlib
import inspect
import pickle
import sys
import time
from functools import cache
from pathlib import Path
from typing import Any

import numba
from numba.core import event, sigutils
from numba.core.caching import CompileResultCacheImpl, FunctionCache
from numba.core.serialize import dumps

from . import notices, store
from .cache import cache_folder, folder_name
from .lock import ProcessLock
from .reach import whole_digest


class _Place:
    """Where numba's own code expects the name of a function's file, for its warnings."""

    def __init__(self, file: str) -> None:
        self._py_file = file


class _Content(CompileResultCacheImpl):
    """How compiled code becomes data and back; numba's, without its search for folders."""

    def __init__(self, function: Any) -> None:
        self._lineno = function.__code__.co_firstlineno
        self._locator = _Place(inspect.getfile(function))
        self._filename_base = function.__qualname__


class KeptCode(FunctionCache):
    """The code of one function, for all types of arguments that it has been compiled for."""

    def __init__(self, function: Any) -> None:
        self._py_func = function
        self._name = f"{function.__module__}.{function.__qualname__}"
        self._impl = _Content(function)
        self._source = Path(self._impl._locator._py_file)
        self.enable()

    @property
    def cache_path(self) -> str | None:
        """The folder of this function's entries."""
        folder = self._folder()
        return None if folder is None else str(folder)

    def load_overload(self, sig: Any, target_context: Any) -> Any:
        """The code for the argument types of `sig`, or None: then numba compiles it, and calls `save_overload`."""
        target_context.refresh()
        if not self._enabled:
            return None
        found = self._find(sig, target_context)
        if found is None and _in_progress.begin(self):
            # others were at it meanwhile
            found = self._find(sig, target_context)
            if found is not None:
                _in_progress.end(self)
        return found

    def save_overload(self, sig: Any, data: Any) -> None:
        """Keep the code `data` for the argument types of `sig`."""
        try:
            if self._enabled and self._impl.check_cachable(data):
                key = self._key(sig, data.codegen)
                path = self._path(key)
                if path is not None:
                    store.save(path, key, dumps(self._impl.reduce(data)))
                elif cache_folder() is None:
                    store.no_place()
        finally:
            _in_progress.end(self)

    def flush(self) -> None:
        """Remove what is kept."""
        folder = self._folder()
        for path in [] if folder is None else folder.glob(f"{self._stem()}.*.nbc"):
            path.unlink(missing_ok=True)

    def _find(self, sig: Any, target_context: Any) -> Any:
        key = self._key(sig, target_context.codegen())
        path = self._path(key)
        content = None if path is None else store.load(path, key)
        if path is None or content is None:
            return None
        try:
            found = self._impl.rebuild(target_context, pickle.loads(content))
        except Exception as error:
            # whatever is wrong with it (a package that it was made with has changed, say), compiling mends it
            store.discard(path, f"{type(error).__name__}: {error}")
            return None
        wanted = sigutils.normalize_signature(sig)[1]
        return found if wanted is None or found.signature.return_type == wanted else None

    def _key(self, sig: Any, codegen: Any) -> bytes:
        """All that the code depends on: source, types of arguments, machine, versions."""
        arguments, _ = sigutils.normalize_signature(sig)
        own = self._index_key(arguments, codegen)
        versions = numba.__version__, sys.version_info[:2], getattr(sys, "abiflags", "")
        return repr((self._name, _source_stamp(self._source), versions, own)).encode()

    def _folder(self) -> Path | None:
        """None if there is none, or the source is no file: nobody could tell whether code fits it."""
        folder = cache_folder()
        if folder is None or not self._source.is_file():
            return None
        return folder / folder_name(self._source.resolve())

    def _path(self, key: bytes) -> Path | None:
        folder = self._folder()
        return None if folder is None else folder / f"{self._stem()}.{hashlib.sha256(key).hexdigest()[:16]}.nbc"

    def _stem(self) -> str:
        name = f"{self._source.stem}.{self._py_func.__qualname__}".replace("<", "").replace(">", "")
        return f"{name}-{self._py_func.__code__.co_firstlineno}"


class _InProgress(event.Listener):
    """What is being compiled: a function, what it calls, and so on. numba's compiler lock guards it."""

    def __init__(self) -> None:
        self._stack: list[KeptCode] = []
        self._began = 0.0

    def begin(self, code: KeptCode) -> bool:
        """`code` is missing. True if others compiled before we were given the lock."""
        self._stack.append(code)
        if len(self._stack) > 1:
            return False
        lock = _lock()
        waited = lock is not None and lock.acquire()
        self._began = time.perf_counter()
        return waited

    def end(self, code: KeptCode) -> None:
        """`code` is there, or cannot be had."""
        if self._stack and self._stack[-1] is code:
            self._stack.pop()
            lock = _lock()
            if not self._stack and lock is not None:
                lock.release()

    def on_start(self, event: Any) -> None:
        if len(self._stack) == 1 and event.data["dispatcher"]._cache is self._stack[0]:
            notices.begin(self._stack[0]._name)

    def on_end(self, event: Any) -> None:
        code = event.data["dispatcher"]._cache
        if not self._stack or code is not self._stack[-1]:
            return
        if len(self._stack) == 1:
            notices.end(code._name, time.perf_counter() - self._began)
        # without code there will be nothing to save (an event's own `is_failed` says the contrary, numba 0.68)
        if tuple(event.data["args"]) not in event.data["dispatcher"].overloads:
            self.end(code)


_in_progress = _InProgress()
event.register("numba:compile", _in_progress)


@cache
def _lock() -> ProcessLock | None:
    folder = cache_folder()
    return None if folder is None else ProcessLock(folder / whole_digest() / "compiling.lock")


@cache
def _source_stamp(source: Path) -> str:
    """Digest of a source file."""
    return hashlib.sha256(source.read_bytes()).hexdigest() if source.is_file() else ""
