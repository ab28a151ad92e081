"""What is imported when it is first asked for: of a package of many parts most runs need a few."""

import re
import sys
from collections.abc import Callable, Iterator, Mapping
from functools import cache
from importlib import import_module
from types import MappingProxyType
from typing import Any

_BLOCK = re.compile(r"^if TYPE_CHECKING:\n((?:    .*\n|\n)+)", re.MULTILINE)
_IMPORT = re.compile(r"^    from (\.[.\w]*) import (?:\(([^)]*)\)|(.+))$", re.MULTILINE)


@cache
def _places(package: str) -> Mapping[str, str]:
    """Module of each name that a package imports for type checkers, relative to it. From the text of the package, since
    it is not run there; of `from .. import *` what the package above says of modules in this one.

    Raises
    ------
    ImportError : without the source of the package.
    """
    spec = sys.modules[package].__spec__
    source = "" if spec is None or spec.origin is None else spec.origin
    if spec is None or not source.endswith(".py"):
        raise ImportError(f"'{package}' says its names in its source, which is missing (it is loaded from '{source}')")
    loader: Any = spec.loader
    found: dict[str, str] = {}
    for block in _BLOCK.findall(loader.get_data(source).decode().replace("\r\n", "\n")):
        for module, several, one in _IMPORT.findall(block):
            if module == "..":
                parent, _, own = package.rpartition(".")
                above = _places(parent).items()
                found |= {name: place.removeprefix(f".{own}") for name, place in above if place.startswith(f".{own}.")}
            else:
                names = (several or one.partition("#")[0]).split(",")
                found |= {name.split()[-1]: module for name in names if name.strip()}
    return MappingProxyType(found)


def late_names(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """`__getattr__`, `__dir__` and `__all__` of a package whose names stand in other modules: those that it imports
    under `if TYPE_CHECKING`.

    Raises
    ------
    ImportError : without the source of the package.
    """
    where = _places(package)

    def __getattr__(name: str) -> Any:
        if name not in where:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        found = getattr(import_module(where[name], package), name)
        setattr(sys.modules[package], name, found)
        return found

    def __dir__() -> list[str]:
        return sorted({*vars(sys.modules[package]), *where})

    return __getattr__, __dir__, sorted(where)


class RecordsOf(Mapping[str, type[Any]]):
    """Records that inherit from a base, by name, among the late names of a package; each is imported when it is first
    asked for, all of the package when one asks which there are. Bases, which do not say their `type`, are none.
    """

    def __init__(self, package: str, base: type[Any]) -> None:
        self._package, self._base, self._found = package, base, dict[str, type[Any]]()

    def __getitem__(self, name: str) -> type[Any]:
        if name not in self._found:
            record = getattr(sys.modules[self._package], name) if name in _places(self._package) else None
            own = vars(record).get("__annotations__", {}) if isinstance(record, type) else {}
            if record is None or "type" not in own or not issubclass(record, self._base):
                raise KeyError(name)
            self._found[name] = record
        return self._found[name]

    def __contains__(self, name: object) -> bool:
        return isinstance(name, str) and self.get(name) is not None

    def __iter__(self) -> Iterator[str]:
        return (name for name in _places(self._package) if name in self)

    def __len__(self) -> int:
        return sum(1 for _ in self)


class LateClasses(Mapping[str, type[Any]]):
    """Classes of a package by name, each imported when it is first asked for.

    Parameters
    ----------
    names : of the classes, with spaces between; "Other=Name" for one that is asked for by another name.
    """

    def __init__(self, package: str, names: str) -> None:
        self._package, self._found = package, dict[str, type[Any]]()
        self._classes = {(words := name.split("="))[0]: words[-1] for name in names.split()}

    def __getitem__(self, name: str) -> type[Any]:
        if name not in self._found:
            self._found[name] = getattr(sys.modules[self._package], self._classes[name])
        return self._found[name]

    def __contains__(self, name: object) -> bool:
        return name in self._classes

    def __iter__(self) -> Iterator[str]:
        return iter(self._classes)

    def __len__(self) -> int:
        return len(self._classes)
