"""`tlismni play`: a stored result, moving."""

from typing import Annotated

import typer

from ..errors import one_line_errors
from ..options import ANIMATION_KINDS, Debug, PageFile, StoredResult, check_suffix
from ..targets import check_file

EXAMPLES = (
    "Examples:\n\n  tlismni run hub_beam_stop --output hub.npz\n\n  tlismni play hub.npz\n\n"
    "  tlismni play hub.npz --channel tip.y --channel stop.normal_force --output hub.html"
)
Channels = Annotated[
    list[str] | None, typer.Option("--channel", metavar="NAME", help="To plot beside the motion; may be repeated.")
]


@one_line_errors
def play(path: StoredResult, channels: Channels = None, output: PageFile = None, debug: Debug = False) -> None:
    """Play a stored result in the browser, or write it as a page (.html) or a film (.gif, .mp4)."""
    check_suffix(output, ANIMATION_KINDS, "--output")
    check_file(output)

    from ...core import load_result
    from ...viewer import animate
    from ..animations import deliver, sketches_for

    result = load_result(path)
    deliver(animate(result, channels=channels, sketches=sketches_for(result)), output, path.stem)
