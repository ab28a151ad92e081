"""A user's own records in model files: where their classes can be imported from, and whether that is allowed."""

import importlib
import os
import re
import sys
from collections.abc import Collection, Iterator, Mapping
from typing import Any

from ..errors import ModelError
from .base import Record
from .open_union import OpenRecord, meant_now, subclasses

ALLOW = "TLISMNI_ALLOW_IMPORTS"
"""Environment variable: names of modules (with commas between them) that model files may import; * for all."""
_LIBRARY = __name__.partition(".core.")[0] + "."
_PATH = re.compile(r"[^\W\d]\w*(\.[^\W\d]\w*)*:[^\W\d]\w*")


def is_own(kind: type) -> bool:
    """Whether a class is a user's, not this library's."""
    return not kind.__module__.startswith(_LIBRARY)


def own_classes(model: Record) -> dict[str, type[OpenRecord]]:
    """The user's own classes in a model, by their `type`.

    Raises
    ------
    ModelError : if two of them have the same.
    """
    found: dict[str, type[OpenRecord]] = {}
    for record in _records(model):
        if not isinstance(record, OpenRecord):
            continue
        kind = type(record)
        name = kind.model_fields["type"].default
        if is_own(kind) and not _read_as_ours(kind, name):
            if found.setdefault(name, kind) is not kind:
                raise ModelError(
                    f"two own classes of the model have the type '{name}': {place_of(found[name])} and "
                    f"{place_of(kind)}; a model file tells them apart by that name: give one of them another"
                )
    return found


def _read_as_ours(kind: type[OpenRecord], name: str) -> bool:
    """Whether a user's class has the type of a class of this library that it inherits from (`contacts/shape.py`)."""
    bases = [base for base in kind.__mro__[1:] if issubclass(base, OpenRecord) and not is_own(base)]
    return any("type" in base.model_fields and base.model_fields["type"].default == name for base in bases)


def place_of(kind: type) -> str:
    """Where a class is, "module:Class"."""
    return f"{kind.__module__}:{kind.__qualname__}"


def import_paths(model: Record) -> dict[str, str]:
    """Where the model's own classes can be imported from, by their `type`; not those that cannot be imported (of a
    script, or made inside a function)."""
    paths = {name: place_of(kind) for name, kind in own_classes(model).items()}
    return {name: path for name, path in paths.items() if _PATH.fullmatch(path) and not path.startswith("__main__:")}


def find_classes(imports: Any, allowed: bool | Collection[str]) -> dict[str, type[OpenRecord]]:
    """The classes that a model file's `imports` name, by their `type`.

    What has been imported already is taken from there; a class of that name from elsewhere will do as well.

    Raises
    ------
    ModelError : for what is no import path or cannot be imported, and for what would have to be imported without
        leave.
    """
    if not isinstance(imports, Mapping):
        raise ModelError(f'imports: an object {{"Type": "module:Class"}} is needed, not {imports!r:.80}')
    found = {}
    for name, path in imports.items():
        if not isinstance(path, str) or not _PATH.fullmatch(path):
            raise ModelError(f"imports: '{name}' is said to be at {path!r:.80}; 'module:Class' is needed")
        module, _, kind = path.partition(":")
        if name in meant_now():
            continue
        new = module not in sys.modules
        if new:
            if not _may_import(module, allowed):
                if any(k.model_fields["type"].default == name for k in subclasses(OpenRecord)):
                    continue
                raise ModelError(
                    f"type '{name}' is an own class of its author, {path}, and to import it runs that module's code: "
                    f"if you trust it, read the file with Model.load(path, allow_imports=['{module}']), give the "
                    f"command --allow-imports {module}, or set the environment variable {ALLOW}={module}"
                )
            try:
                importlib.import_module(module)
            except Exception as error:  # a user's code: anything may go wrong in it
                raise ModelError(
                    f"type '{name}' cannot be imported from {path} ({type(error).__name__}: {error}): put the module "
                    "where Python finds it (PYTHONPATH)"
                ) from error
        given = vars(sys.modules[module]).get(kind)
        if isinstance(given, type) and issubclass(given, OpenRecord):
            found[name] = given
        elif new:
            raise ModelError(f"type '{name}': there is no record class {kind} in module {module}")
    return found


def _may_import(module: str, allowed: bool | Collection[str]) -> bool:
    if isinstance(allowed, bool):
        names: set[str] = {"*"} if allowed else set()
    else:
        names = {allowed} if isinstance(allowed, str) else set(allowed)
    names |= {name.strip() for name in os.environ.get(ALLOW, "").split(",")}
    parts = module.split(".")
    return "*" in names or any(".".join(parts[: k + 1]) in names for k in range(len(parts)))


def _records(value: Any) -> Iterator[Record]:
    """A record and all records in it."""
    if isinstance(value, Record):
        yield value
        for name in type(value).model_fields:
            yield from _records(getattr(value, name))
    elif isinstance(value, tuple | list) and value and not isinstance(value[0], int | float):
        for entry in value:
            yield from _records(entry)
