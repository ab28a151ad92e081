"""`tlismni check`: how a mechanism can move, and which of its constraints repeat others."""

from ..errors import one_line_errors
from ..options import Debug, Json, PlotFile, Set, Source, check_suffix
from ..screen import compile_notice, number, print_json, print_table, say, stdout
from ..targets import check_file

EXAMPLES = "Examples:\n\n  tlismni check four_bar\n\n  tlismni check my_model.json --json"


@one_line_errors
def check(
    source: Source, sets: Set = None, plot: PlotFile = None, json: Json = False, debug: Debug = False
) -> None:  # fmt: skip
    """Check a scenario or a model file: its fields, whether it can be assembled, degrees of freedom, redundant rows,
    and nodes that lines of contact miss."""
    check_suffix(plot, (".png", ".pdf", ".svg"), "--plot")
    check_file(plot)

    from ...core.analysis import mobility
    from ...core.analysis.line_nodes import missed_nodes
    from ..source import ANY_END, read_source

    scenario = read_source(source, sets, t_end=ANY_END)
    with compile_notice():
        found = mobility(scenario.model)
    missed = missed_nodes(scenario.model)
    figures = {
        "model": scenario.name,
        "coordinates": found.coordinates,
        "constraint_equations": found.rows,
        "independent_equations": found.rank,
        "closed_contacts": list(found.closed),
        "degrees_of_freedom": found.freedom,
        "counted": found.counted,
        "redundant": [{"joint": r.constraint, "row": r.row, "repeats": list(r.repeats)} for r in found.redundant],
        "independent_coordinates": list(found.independent),
        "stuck": list(found.stuck),
        "least_singular_value": found.least_singular_value,
        "joints": found.joints,
        "missed_nodes": [{"contact": m.contact, "node": m.node, "distance": m.distance} for m in missed],
    }
    if plot is not None:
        from ..analysis_plots import plot_mobility

        plot_mobility(found, scenario.name, plot)
    if json:
        print_json(figures)
        return
    rows = [
        ("coordinates", found.coordinates),
        ("constraint equations of joints", found.rows),
        ("  of these independent", found.rank),
        ("closed contacts", len(found.closed)),
        ("degrees of freedom", found.freedom),
        ("least singular value of the constraints", number(found.least_singular_value, 3)),
    ]
    print_table(scenario.name, ("what", "count"), rows)
    for row in found.redundant:
        stdout().print(f"redundant: {row.equation} repeats {', '.join(row.repeats)}", markup=False)
    stdout().print(f"independent: {', '.join(found.independent) or 'none, nothing can move'}", markup=False)
    if found.stuck:
        stdout().print(f"cannot move: {', '.join(found.stuck)}", markup=False)
    for m in missed:
        stdout().print(
            f"the line of '{m.contact}' passes its node {m.node} by {number(m.distance, 3)} m, farther than any other",
            markup=False,
        )
    if plot is not None:
        say(f"wrote {plot}")
