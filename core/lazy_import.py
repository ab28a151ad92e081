"""What is imported when it is first asked for: of a package of many parts most runs need a few."""

import sys
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from typing import Any


def late_names(package: str, places: Mapping[str, str]) -> tuple[Callable[[str], Any], Callable[[], list[str]]]:
    """`__getattr__` and `__dir__` of a package whose names stand in other modules.

    Parameters
    ----------
    places : names, with spaces between, by the module of the package that has them (".module").
    """
    where = {name: module for module, names in places.items() for name in names.split()}

    def __getattr__(name: str) -> Any:
        if name not in where:
            raise AttributeError(f"module '{package}' has no attribute '{name}'")
        found = getattr(import_module(where[name], package), name)
        setattr(sys.modules[package], name, found)
        return found

    def __dir__() -> list[str]:
        return sorted({*vars(sys.modules[package]), *where})

    return __getattr__, __dir__


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
