"""Text of model files: JSON, and YAML, which may hold comments; and where in it something stands."""

import json
from collections import Counter
from collections.abc import Mapping, Sequence
from io import StringIO
from pathlib import Path
from typing import Any

from ..errors import ModelError
from ..extras import require

YAML_KINDS = (".yaml", ".yml")
MOST_VALUES = 10_000_000
"""A YAML text can repeat its own parts; beyond this number of values it would fill the memory."""


def is_yaml(path: str | Path) -> bool:
    """Whether a file's name says that it is YAML."""
    return Path(path).suffix.lower() in YAML_KINDS


def read_json(text: str | bytes) -> Any:
    """The data in a JSON text. Raises ModelError if it is none, or has a field twice."""
    try:
        return json.loads(text, object_pairs_hook=_without_twins)
    except ModelError:
        raise
    except (ValueError, UnicodeDecodeError, RecursionError) as error:
        hint = " (comments are for YAML files: name it .yaml and begin them with #)" if _has_comments(text) else ""
        raise ModelError(f"this is not JSON: {error}{hint}") from None


def _without_twins(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
    twice = [name for name, count in Counter(name for name, _ in pairs).items() if count > 1]
    if twice:
        raise ModelError(f"{twice} stand twice in one object: leave one of them out")
    return dict(pairs)


def _has_comments(text: str | bytes) -> bool:
    shown = text.decode("utf-8", "replace") if isinstance(text, bytes) else text
    return any(mark in line for mark in ("//", "#", "/*") for line in shown.splitlines())


def read_yaml(text: str | bytes) -> Any:
    """The data in a YAML 1.2 text. Raises ModelError if it is none, MissingExtraError without the library for it."""
    require("a model file in YAML", "yaml", **{"ruamel.yaml": ""})
    from ruamel.yaml import YAML
    from ruamel.yaml.error import YAMLError

    try:
        data = YAML(typ="safe", pure=True).load(text)
    except (YAMLError, ValueError, RecursionError) as error:
        raise ModelError(f"this is not YAML: {' '.join(str(error).split('To suppress')[0].split())}") from None
    if _size(data, {}) > MOST_VALUES:
        raise ModelError(f"this YAML repeats its parts to more than {MOST_VALUES:.0e} values: write it without aliases")
    return data


def _size(data: Any, known: dict[int, int]) -> int:
    """Number of values, repeated ones counted as often as they stand."""
    if not isinstance(data, dict | list):
        return 1
    if id(data) not in known:
        known[id(data)] = 1  # of what holds itself
        known[id(data)] = 1 + sum(_size(part, known) for part in (data.values() if isinstance(data, dict) else data))
    return known[id(data)]


def write_yaml(data: Mapping[str, Any]) -> str:
    """`data` as YAML: objects in blocks, lists of numbers in one line."""
    require("a model file in YAML", "yaml", **{"ruamel.yaml": ""})
    from ruamel.yaml import YAML
    from ruamel.yaml.comments import CommentedSeq

    def in_rows(value: Any) -> Any:
        if isinstance(value, Mapping):
            return {key: in_rows(inner) for key, inner in value.items()}
        if isinstance(value, list):
            rows = CommentedSeq(in_rows(inner) for inner in value)
            if not any(isinstance(inner, Mapping | list) for inner in value):
                rows.fa.set_flow_style()
            return rows
        return value

    writer, stream = YAML(), StringIO()
    writer.width = 120
    writer.dump(in_rows(data), stream)
    return stream.getvalue()


def line_of(text: str | bytes, places: Sequence[Any]) -> int | None:
    """The line, from 1, of what stands at `places` (keys and numbers in lists) in a YAML or JSON text; None where that
    is not known. Parts of `places` that lead nowhere (names of types) are passed over."""
    try:
        from ruamel.yaml import YAML
        from ruamel.yaml.error import YAMLError
        from ruamel.yaml.nodes import MappingNode, SequenceNode
    except ImportError:
        return None
    try:
        here = YAML(typ="safe", pure=True).compose(text)
    except (YAMLError, ValueError, RecursionError):
        return None
    line = None if here is None else here.start_mark.line
    for part in places:
        if isinstance(here, MappingNode):
            for key, value in here.value:
                if key.value == part:
                    here, line = value, key.start_mark.line
                    break
        elif isinstance(here, SequenceNode) and isinstance(part, int) and part < len(here.value):
            here = here.value[part]
            line = here.start_mark.line
    return None if line is None else line + 1


def with_lines(error: ModelError, text: str | bytes) -> str:
    """The message of an error in the model file `text`, each problem with its line where that is known."""
    found = []
    for words, places in error.problems:
        line = line_of(text, places) if places else _line_of_named(text, words)
        found.append(words if line is None else f"line {line}: {words}")
    return "; ".join(found) or str(error)


def _line_of_named(text: str | bytes, words: str) -> int | None:
    """The line, in a YAML or JSON text, of the first element or place ("rod", "rod.mass") that `words` quote."""
    try:
        data = read_yaml(text)
    except (ModelError, ImportError):
        return None
    about = words.partition(": ")[2] if words.startswith("Model '") else words
    for quoted in about.split("'")[1::2]:
        name, *parts = quoted.split(".")
        for kind in ("bodies", "joints", "forces", "contacts", "parameters"):
            elements = data.get(kind) if isinstance(data, dict) else None
            for k, element in enumerate(elements if isinstance(elements, list) else ()):
                if isinstance(element, dict) and element.get("name") == name:
                    return line_of(text, (kind, k, *(int(p) if p.isdecimal() else p for p in parts or ["name"])))
    return None
