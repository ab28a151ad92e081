"""`tlismni show`: a model as it starts, drawn."""

from ..errors import one_line_errors
from ..options import Debug, PageFile, Set, Source, check_suffix
from ..targets import check_file

EXAMPLES = "Examples:\n\n  tlismni show slider_crank_stop\n\n  tlismni show my_model.json --output my_model.html"


@one_line_errors
def show(source: Source, sets: Set = None, output: PageFile = None, debug: Debug = False) -> None:
    """Draw a scenario or a model file as it starts, in the browser or as a page. Nothing is run."""
    check_suffix(output, (".html",), "--output")
    check_file(output)

    from ...viewer import show as draw
    from ..animations import deliver
    from ..source import ANY_END, read_source

    scenario = read_source(source, sets, t_end=ANY_END)
    deliver(
        draw(scenario.model, title=f"{scenario.name}, as it starts", sketches=scenario.sketches), output, scenario.name
    )
