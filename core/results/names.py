"""Answers to names that a result does not have."""

from collections.abc import Iterable
from difflib import get_close_matches

MOST_SHOWN = 12


def owners(channels: Iterable[str]) -> dict[str, list[str]]:
    """Channels by what they belong to: the part of the name before the last dot ("" of those without)."""
    found: dict[str, list[str]] = {}
    for name in channels:
        found.setdefault(name.rpartition(".")[0], []).append(name)
    return found


def unknown_channel(name: object, channels: Iterable[str]) -> str:
    """What to say of a channel that there is not: near names, or what a body of this name has."""
    known = list(channels)
    by_owner = owners(known)
    if not isinstance(name, str):
        return f"a channel's name is needed, a text such as '{known[0] if known else 'body.x'}', not {name!r}"
    if name and name in by_owner:
        return f"'{name}' is not a channel but has some: {_listed(by_owner[name])}"
    near = get_close_matches(name, known, 3) or get_close_matches(name, [o for o in by_owner if o], 2)
    owner = name.rpartition(".")[0]
    if near:
        hint = f"; did you mean {near}?"
    elif owner in by_owner and owner:
        hint = f"; '{owner}' has {_listed(by_owner[owner])}."
    else:
        hint = "."
    return f"there is no channel '{name}'{hint} `result.channels` lists all {len(known)}"


def _listed(names: list[str]) -> str:
    more = f" and {len(names) - MOST_SHOWN} more" if len(names) > MOST_SHOWN else ""
    return f"{names[:MOST_SHOWN]}{more}"
