"""Arrays of a record in a file beside the model file (.npz): read once, then they are the record's own."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from pathlib import Path
from typing import Any

import numpy as np

ARRAYS = "arrays"
"""Key under which a record names its file."""
_folder: ContextVar[Path | None] = ContextVar("folder", default=None)


@contextmanager
def beside(path: str | Path) -> Iterator[None]:
    """While a model file is read here, names of files are meant beside it, and no others are opened."""
    token = _folder.set(Path(path).resolve().parent)
    try:
        yield
    finally:
        _folder.reset(token)


def arrays_from_file(data: Any, kind: type) -> Any:
    """The data of a record, with the arrays of the file that it names under "arrays" among them.

    A name with dots in the file is a place in the record: "interfaces.tip.shape" is the shape of the interface "tip".

    Raises
    ------
    ValueError : for a file that cannot be read, that is not beside the model file, or that has what the record says
        too.
    """
    if not isinstance(data, Mapping) or ARRAYS not in data:
        return data
    given = data[ARRAYS]
    if not isinstance(given, str) or not given.endswith(".npz"):
        raise ValueError(f"{ARRAYS}: the name of a file that ends with .npz is needed (given: {given!r})")
    found = {key: value for key, value in data.items() if key != ARRAYS}
    groups: dict[str, dict[str, dict[str, Any]]] = {}
    for name, array in _read(given).items():
        key, *rest = name.split(".")
        if len(rest) not in (0, 2):
            raise ValueError(f"{ARRAYS}: '{given}' has '{name}': names are FIELD or FIELD.NAME.PART")
        if key in data:
            raise ValueError(f"{ARRAYS}: '{given}' has {key}, and so has the {kind.__name__}: leave one out")
        if rest:
            groups.setdefault(key, {}).setdefault(rest[0], {"name": rest[0]})[rest[1]] = array.tolist()
        else:
            found[key] = array.tolist()
    found.update({key: list(entries.values()) for key, entries in groups.items()})
    return found


def _read(name: str) -> dict[str, Any]:
    folder = _folder.get()
    path = Path(name) if folder is None else folder / name
    if folder is not None and not path.resolve().is_relative_to(folder):
        raise ValueError(f"{ARRAYS}: '{name}' is not beside the model file: a model may open no other files")
    try:
        with np.load(path, allow_pickle=False) as file:
            return {key: file[key] for key in file.files}
    except (OSError, ValueError, EOFError) as error:
        raise ValueError(f"{ARRAYS}: '{path}' cannot be read as .npz: {error}") from None


def or_arrays(schema: dict[str, Any], fields: frozenset[str]) -> None:
    """In the JSON schema of a record: `fields`, or the file that holds them."""
    schema["properties"][ARRAYS] = {
        "type": "string", "pattern": r"\.npz$",
        "description": "File beside the model file (numpy's .npz) that holds the arrays; then they are left out here.",
    }  # fmt: skip
    needed = schema.get("required", [])
    schema["required"] = [name for name in needed if name not in fields]
    schema["anyOf"] = [{"required": [ARRAYS]}, {"required": [name for name in needed if name in fields]}]
