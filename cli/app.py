"""The application: one command a file in `commands/`, registered here."""

from typing import Annotated

import typer

from .commands import (
    cache,
    check,
    cosim,
    crosscheck,
    equilibrium,
    export,
    fields,
    info,
    linearise,
    lyapunov,
    methods,
    modes,
    play,
    run,
    sensitivities,
    show,
    study,
    sweep,
    warm,
)
from .commands import list as list_command

AllowImports = Annotated[
    list[str] | None,
    typer.Option(
        metavar="MODULE",
        help="Module that model files may import for their own elements; may be repeated; '*' for any.",
    ),
]

ALLOW_IMPORTS = "TLISMNI_ALLOW_IMPORTS"
"""The variable that `core/model/own_types.py` reads; named again here, as importing the core takes half a second."""

app = typer.Typer(
    name="tlismni",
    epilog=(
        "Start with [bold]tlismni list[/bold], then [bold]tlismni run pendulum_stop[/bold]. "
        "Figures go to stdout (as one JSON object with --json), everything else to stderr. "
        "Exit code: 0 done, 1 failed or not in agreement, 2 wrong usage."
    ),
    no_args_is_help=True,
    rich_markup_mode="rich",
    # a failure is one line (`errors.py`); with --debug it is Python's own traceback
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def print_version(wanted: bool) -> None:
    """Print the version and end."""
    if wanted:
        from importlib.metadata import PackageNotFoundError, version

        try:
            typer.echo(version("tlismni"))
        except PackageNotFoundError:
            typer.echo("unknown (not installed)")
        raise typer.Exit


@app.callback()
def tlismni(
    version: bool = typer.Option(False, "--version", callback=print_version, is_eager=True, help="Print the version."),
    allow_imports: AllowImports = None,
) -> None:
    """Impact in flexible multibody systems with constraints: solve, export as an FMU, cross-check."""
    if allow_imports:
        import os

        # in the environment, so that processes that a command starts follow it too
        allowed = [*filter(None, [os.environ.get(ALLOW_IMPORTS)]), *allow_imports]
        os.environ[ALLOW_IMPORTS] = ",".join(allowed)


app.command("list", epilog=list_command.EXAMPLES)(list_command.list_scenarios)
app.command("methods", epilog=methods.EXAMPLES)(methods.methods)
app.command("fields", epilog=fields.EXAMPLES)(fields.fields)
app.command("run", epilog=run.EXAMPLES)(run.run)
app.command("show", epilog=show.EXAMPLES)(show.show)
app.command("play", epilog=play.EXAMPLES)(play.play)
app.command("export", epilog=export.EXAMPLES)(export.export)
app.command("info", epilog=info.EXAMPLES)(info.info)
app.command("warm", epilog=warm.EXAMPLES)(warm.warm)
app.command("cache", epilog=cache.EXAMPLES)(cache.cache)
app.command("cosim", epilog=cosim.EXAMPLES)(cosim.cosim)
app.command("crosscheck", epilog=crosscheck.EXAMPLES)(crosscheck.crosscheck)
app.command("check", epilog=check.EXAMPLES)(check.check)
app.command("equilibrium", epilog=equilibrium.EXAMPLES)(equilibrium.equilibrium)
app.command("modes", epilog=modes.EXAMPLES)(modes.modes)
app.command("linearise", epilog=linearise.EXAMPLES)(linearise.linearise)
app.command("sensitivities", epilog=sensitivities.EXAMPLES)(sensitivities.sensitivities)
app.command("sweep", epilog=sweep.EXAMPLES)(sweep.sweep)
app.command("lyapunov", epilog=lyapunov.EXAMPLES)(lyapunov.lyapunov)
app.add_typer(study.app, name="study")
