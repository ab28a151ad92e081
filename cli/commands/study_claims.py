"""`tlismni study claims`: the claims of the method's papers, recomputed."""

from typing import Annotated

import typer

from ..errors import one_line_errors
from ..options import Debug, Json
from ..screen import compile_notice, print_json, print_table, progress_bar, stdout

CLAIMS_EXAMPLES = "Examples:\n\n  tlismni study claims\n\n  tlismni study claims C3 C4 --json"


@one_line_errors
def claims(
    claim: Annotated[list[str] | None, typer.Argument(metavar="[C1 ... C7]", help="Only these claims.")] = None,
    quick: Annotated[bool, typer.Option("--quick", help="Shorter studies: a first look, not for quoting.")] = False,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """The claims C1 to C7 of the method's papers: verdict, the figures it follows from, the command that makes them."""
    from ...validation.study.claim_table import claim_table

    with compile_notice(), progress_bar("claims", 1.0) as progress:
        rows = claim_table(claim, quick=quick, tell=lambda what, share: progress(share))
    if json:
        print_json({"claims": [row.to_dict() for row in rows], "quick": quick})
        return
    print_table(
        "Claims of the method's papers",
        ("claim", "verdict", "command"),
        [(f"{row.claim.name}: {row.claim.claim}", row.verdict, row.command) for row in rows],
        left=3,
    )
    for row in rows:
        stdout().print(f"{row.claim.name}, {row.verdict}:", markup=False)
        for line in row.claim.observed:
            stdout().print(f"  - {line}", markup=False)
