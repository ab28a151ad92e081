"""`tlismni cache`: what is kept on this machine to start faster, and how to be rid of it."""

from typing import Annotated

import typer

from ..errors import one_line_errors
from ..options import Debug, Json
from ..screen import print_json, print_table, say

EXAMPLES = "Examples:\n\n  tlismni cache\n\n  tlismni cache --clear old\n\n  tlismni cache --clear all"

Clear = Annotated[
    str | None,
    typer.Option(
        "--clear", metavar="old|all", help="Remove code of other versions of the sources (old), or all that is kept."
    ),
]


@one_line_errors
def cache(clear: Clear = None, json: Json = False, debug: Debug = False) -> None:
    """Show or clear what is kept: compiled code, binaries and packages of FMUs. It is made anew where it is needed."""
    if clear not in (None, "old", "all"):
        raise typer.BadParameter(f"'{clear}' is neither old nor all", param_hint="--clear")

    from ..cached import entries, remove

    found = entries()
    chosen = [entry for entry in found if clear == "all" or (clear == "old" and entry.old)]
    removed, kept = remove(chosen)
    if json:
        print_json(
            {
                "entries": [
                    {"path": entry.path, "kind": entry.kind, "bytes": entry.size, "old": entry.old} for entry in found
                ],
                "removed": [entry.path for entry in removed],
            }
        )
        return
    groups: dict[tuple[str, str, str], list[int]] = {}
    for entry in found:
        group = entry.kind, "old" if entry.old else "in use", str(entry.path.parent)
        groups.setdefault(group, []).append(entry.size)
    rows = [
        (kind, state, len(sizes), f"{sum(sizes) / 1e6:.1f}", place) for (kind, state, place), sizes in groups.items()
    ]
    if rows:
        print_table("kept on this machine", ("what", "state", "folders", "MB", "in"), rows, left=2)
    else:
        say("nothing is kept")
    if clear is not None:
        say(f"removed {len(removed)} folders, {sum(entry.size for entry in removed) / 1e6:.1f} MB")
    for entry in kept:
        say(f"could not be removed: {entry.path}")
