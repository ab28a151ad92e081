"""Signatures as short texts: what an entry of the library is called by, whoever asks.

d float64, q int64, I uint32, ? boolean, v nothing, R a record, A with type and number of dimensions a row-major array,
(...) a tuple: `q(RRd)` takes two records and a number, and returns an integer.
"""

from collections.abc import Iterable
from typing import Any

_SCALARS = {"float64": "d", "int64": "q", "uint32": "I", "bool": "?", "boolean": "?", "none": "v", "void": "v"}


def type_text(kind: Any) -> str:
    """The text of a type of numba's, or of `plain_types`.

    Raises
    ------
    TypeError : for one that no entry of the library has.
    """
    text = getattr(kind, "text", None)
    if text is not None:
        return str(text)
    kind = getattr(kind, "literal_type", kind)  # of a function that always returns the same
    what = type(kind).__name__
    if what == "Record":
        return "R"
    if what == "Array" and kind.layout == "C":
        return f"A{type_text(kind.dtype)}{kind.ndim}"
    if what in ("UniTuple", "Tuple", "NamedTuple", "NamedUniTuple"):
        return f"({''.join(map(type_text, kind.types))})"
    if str(kind) in _SCALARS:
        return _SCALARS[str(kind)]
    raise TypeError(f"{kind} has no place in the signature of a function that is compiled ahead of time")


def signature_text(result: Any, arguments: Iterable[Any]) -> str:
    """The text of a signature."""
    return f"{type_text(result)}({''.join(map(type_text, arguments))})"


def split_types(text: str) -> list[str]:
    """The texts of the types in a row of them."""
    found, at = [], 0
    while at < len(text):
        end = at + 1
        if text[at] == "A":
            end = at + 3
        elif text[at] == "(":
            depth = 1
            while depth:
                depth += {"(": 1, ")": -1}.get(text[end], 0)
                end += 1
        found.append(text[at:end])
        at = end
    return found


def split_signature(text: str) -> tuple[str, list[str]]:
    """The texts of the result and of the arguments of a signature."""
    result, *arguments = split_types(text)
    (inside,) = arguments
    return result, split_types(inside[1:-1])
