"""A user's own classes in a model: the modules that define them, written into the FMU and imported from there.

An FMU carries the sources of these modules, and of those beside them that they import. They are imported under names
that no other module has, made of their content, and `tlismni` means in them the package that runs the FMU, a bundled
one too: so FMUs with different versions of a module live in one process, and nothing has to be on the path.
"""

import ast
import builtins
import hashlib
import importlib
import importlib.util
import os
import sys
import threading
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import ModuleType
from typing import Any

from ..core.compiled.cache import user_cache
from ..core.model.base import Record
from ..core.model.open_union import OpenRecord
from ..core.model.own_types import is_own, own_classes, place_of
from ..core.multibody_model import Model
from .errors import ExportError

FOLDER = "own"
"""Of the modules, in the FMU's resources."""
_LIBRARY = __name__.partition(".fmu_wrapper.")[0]
_LOCK = threading.RLock()
_SHARED_FOLDERS = {"site-packages", "dist-packages"}


@dataclass(frozen=True)
class OwnCode:
    """Own classes by their `type`, "module:Class", and sources of modules by path, "joints.py", "parts/__init__.py"."""

    types: Mapping[str, str]
    sources: Mapping[str, str]

    @classmethod
    def of(cls, model: Model) -> "OwnCode":
        """Of a model. Raises ExportError for classes that are in no module file."""
        classes = own_classes(model)
        found: dict[str, str] = {}
        for kind in classes.values():
            for base in kind.__mro__:
                if issubclass(base, Record) and is_own(base):
                    _refuse_homeless(base)
                    _collect(base.__module__, found)
        return cls({name: place_of(kind) for name, kind in classes.items()}, dict(sorted(found.items())))

    @classmethod
    def read(cls, data: Any, resources: Path) -> "OwnCode":
        """What `to_data` and `files` have written. Raises ExportError if it is damaged."""
        if data is None:  # no own classes, or an FMU of an earlier version
            return cls({}, {})
        try:
            types, names = dict(data["types"]), [str(name) for name in data["modules"]]
            if any(Path(name).is_absolute() or ".." in Path(name).parts for name in names):
                raise ValueError(f"a path leads out of the folder: {names}")
            sources = {name: (resources / FOLDER / name).read_text(encoding="utf-8") for name in names}
        except (OSError, ValueError, TypeError, KeyError) as error:
            raise ExportError(
                f"the own modules in the FMU's resources cannot be read ({type(error).__name__}: {error}); "
                "export the FMU anew"
            ) from None
        return cls(types, sources)

    def to_data(self) -> dict[str, Any] | None:
        """What has to be known besides the files; None without own classes."""
        return {"types": dict(self.types), "modules": list(self.sources)} if self.types else None

    @property
    def files(self) -> dict[str, bytes]:
        """The FMU's files by their paths."""
        return {f"resources/{FOLDER}/{name}": text.encode() for name, text in self.sources.items()}

    @property
    def digest(self) -> str:
        """Of all sources."""
        digest = hashlib.sha256()
        for name, text in sorted(self.sources.items()):
            digest.update(name.encode() + b"\0" + text.encode() + b"\0")
        return digest.hexdigest()[:16]

    def classes(self, resources: Path) -> dict[str, type[OpenRecord]]:
        """The classes by their `type`, imported.

        Raises
        ------
        ExportError : if a module cannot be imported, or does not define its class.
        """
        found: dict[str, type[OpenRecord]] = {}
        if not self.types:
            return found
        with _LOCK:
            modules = _Modules(self, resources)
            for name, path in self.types.items():
                module, _, kind = path.partition(":")
                try:
                    found[name] = vars(modules.load(module))[kind]
                except Exception as error:  # a user's code: anything may go wrong in it
                    raise ExportError(
                        f"own class '{path}' of this FMU cannot be imported ({type(error).__name__}: {error}): the "
                        f"Python in {sys.prefix} may lack a package that its module needs"
                    ) from error
        return found


class _Modules:
    """The modules of one FMU, or of several with the same ones."""

    def __init__(self, code: OwnCode, resources: Path) -> None:
        self.prefix = f"{_LIBRARY}_own_{code.digest}"
        self._folder = _unpacked(code, resources)
        if self.prefix not in sys.modules:
            sys.modules[self.prefix] = ModuleType(self.prefix)
            sys.modules[self.prefix].__path__ = []
        self._builtins = {**vars(builtins), "__import__": self._import}

    def load(self, name: str) -> ModuleType:
        """The module that was `name` where the FMU was exported."""
        private = f"{self.prefix}.{name}"
        if private in sys.modules:
            return sys.modules[private]
        parent, _, last = name.rpartition(".")
        holder = self.load(parent) if parent else sys.modules[self.prefix]
        path = self._path(name)
        inside = [str(path.parent)] if path.name == "__init__.py" else None
        spec = importlib.util.spec_from_file_location(private, path, submodule_search_locations=inside)
        if spec is None or spec.loader is None:
            raise ImportError(f"'{path}' cannot be imported")
        module = importlib.util.module_from_spec(spec)
        vars(module)["__builtins__"] = self._builtins
        sys.modules[private] = module
        try:
            spec.loader.exec_module(module)
        except BaseException:
            del sys.modules[private]
            raise
        setattr(holder, last, module)
        return module

    def _path(self, name: str) -> Path:
        base = self._folder / name.replace(".", "/")
        return base / "__init__.py" if (base / "__init__.py").is_file() else base.with_suffix(".py")

    def _has(self, name: str) -> bool:
        return self._path(name).is_file()

    def _import(
        self, name: str, names: Any = None, places: Any = None, wanted: Any = (), level: int = 0
    ) -> ModuleType:  # the signature of __import__
        if level:
            full = importlib.util.resolve_name("." * level + name, names["__package__"])
            name = full[len(self.prefix) + 1 :]
        if self._has(name):
            module = self.load(name)
            for each in wanted or ():
                if self._has(f"{name}.{each}"):
                    self.load(f"{name}.{each}")
            return module if wanted else self.load(name.partition(".")[0])
        first, dot, rest = name.partition(".")
        if first == "tlismni":
            module = importlib.import_module(f"{_LIBRARY}{dot}{rest}")
            return module if wanted else sys.modules[_LIBRARY]
        return builtins.__import__(name, names, places, wanted or (), 0)


def _unpacked(code: OwnCode, resources: Path) -> Path:
    """A folder with the modules that outlives the unzipped FMU, so that what is compiled from them stays cached; the
    FMU's own one if none can be written."""
    users = user_cache()
    if users is None:
        return resources / FOLDER
    folder = users / "tlismni" / "own" / code.digest
    try:
        for name, text in code.sources.items():
            path = folder / name
            if not (path.is_file() and path.read_text(encoding="utf-8") == text):
                path.parent.mkdir(parents=True, exist_ok=True)
                mine = path.with_suffix(f".{os.getpid()}.{threading.get_ident()}")
                mine.write_text(text, encoding="utf-8")
                os.replace(mine, path)
    except OSError:
        return resources / FOLDER
    return folder


# what an FMU has to carry


def _refuse_homeless(kind: type) -> None:
    remedy = "put it into a module file of its own, at its top level, and import it from there"
    if kind.__module__ == "__main__" or "<locals>" in kind.__qualname__:
        where = "in the program that runs" if kind.__module__ == "__main__" else "inside a function"
        raise ExportError(f"own class '{kind.__name__}' is defined {where}, so no FMU can carry it: {remedy}")
    if _file(kind.__module__) is None:
        raise ExportError(f"own class '{place_of(kind)}' is in no Python file that an FMU could carry: {remedy}")


def _file(module: str) -> Path | None:
    given = getattr(sys.modules.get(module), "__file__", None)
    path = Path(given) if given else None
    return path if path is not None and path.suffix == ".py" and path.is_file() else None


def _collect(module: str, found: dict[str, str]) -> None:
    """Add the sources of a module, of the packages it is in, and of those of its neighbours that it imports."""
    parts = module.split(".")
    for k in range(1, len(parts) + 1):
        name = ".".join(parts[:k])
        file = _file(name)
        if file is None:
            continue
        key = "/".join(parts[:k]) + ("/__init__.py" if file.name == "__init__.py" else ".py")
        if key in found:
            continue
        found[key] = file.read_text(encoding="utf-8")
        package = name if file.name == "__init__.py" else name.rpartition(".")[0]
        for imported in _imports(found[key], package):
            if _neighbours(name, imported):
                _collect(imported, found)


def _imports(source: str, package: str) -> Iterator[str]:
    """Full names of what a module in `package` imports, of the names in from-imports too."""
    for node in ast.walk(ast.parse(source)):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            base = node.module or ""
            if node.level:
                base = importlib.util.resolve_name("." * node.level + base, package)
            yield base
            yield from (f"{base}.{alias.name}" for alias in node.names)


def _neighbours(module: str, other: str) -> bool:
    """Whether `other` belongs to the same user's code: the same package, or a file beside it."""
    top, file = module.partition(".")[0], _file(other.partition(".")[0])
    if _file(other) is None or not is_own(type("", (), {"__module__": other})):
        return False
    if other.partition(".")[0] == top:
        return True
    mine = _file(top)
    if mine is None or file is None:
        return False
    roots = [path.parent.parent if path.name == "__init__.py" else path.parent for path in (mine, file)]
    return roots[0] == roots[1] and roots[0].name not in _SHARED_FOLDERS
