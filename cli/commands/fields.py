"""`tlismni fields`: what may stand in a model file."""

import inspect

import typer

from ..errors import one_line_errors
from ..options import Debug, Json
from ..screen import print_json, print_table, stdout

EXAMPLES = "Examples:\n\n  tlismni fields\n\n  tlismni fields RigidBody2D\n\n  tlismni fields --markdown > fields.md"


@one_line_errors
def fields(
    kind: str = typer.Argument(None, metavar="TYPE", help="A type, e.g. RigidBody2D; all types if none."),
    markdown: bool = typer.Option(False, "--markdown", help="All types with their fields as a page."),
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Show the types of a model file, or the fields of one: unit, default, meaning."""
    from ...core import Model, ModelError
    from ...core.model.arithmetic import near
    from ...core.model.fields import fields_of, records
    from ..fields_page import names_of

    known = records(Model)
    if kind is not None and kind not in known:
        raise ModelError(f"there is no type '{kind}'{near(kind, known)}")
    chosen = {kind: known[kind]} if kind is not None else known
    if json:
        print_json({name: [vars(field) for field in fields_of(record)] for name, record in chosen.items()})
    elif markdown:
        from ..fields_page import page

        typer.echo(page(chosen), nl=False)
    elif kind is None:
        rows = [(name, _first_line(record)) for name, record in chosen.items()]
        print_table("types of a model file", ("type", "what it is"), rows, left=2)
    else:
        for line in (_first_line(known[kind]), *names_of(kind, known[kind])[1:]):
            stdout().print(line, markup=False)
        rows = [(f.name, f.kind, f.unit, f.default or "must be given", f.description) for f in fields_of(known[kind])]
        print_table(kind, ("field", "takes", "unit", "default", "what it is"), rows, left=5)


def _first_line(record: type) -> str:
    return inspect.cleandoc(vars(record).get("__doc__") or "").split("\n\n")[0].replace("\n", " ")
