"""Failures as one line on stderr and exit code 1."""

import functools
import os
import sys
from collections.abc import Callable
from typing import Any, TypeVar

import typer

EXTRAS = {
    "fmpy": "fmu", "lxml": "fmu", "exudyn": "validation", "jinja2": "validation", "plotly": "validation",
    "matplotlib": "plot", "pandas": "data", "pyarrow": "data", "xarray": "data", "h5netcdf": "data", "h5py": "data",
    "PIL": "film", "imageio_ffmpeg": "film", "dask": "sweep", "distributed": "sweep", "ziglang": "cross",
    "numba": "own", "ruamel": "yaml",
}  # fmt: skip
"""Which extra of the package brings a module."""

Command = TypeVar("Command", bound=Callable[..., None])


class Failure(Exception):
    """A command has not succeeded, for a reason that the command itself found."""


def one_line_errors(command: Command) -> Command:
    """Turn what `command` raises into one line and exit code 1; with its option `debug`, let it through."""

    @functools.wraps(command)
    def guarded(*args: Any, **kwargs: Any) -> None:
        try:
            command(*args, **kwargs)
        except (typer.Exit, typer.Abort, typer.BadParameter):
            raise
        except BrokenPipeError:
            # the reader (`head`, say) has what it wanted; Python must not fail once more when it flushes stdout
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(1) from None
        except KeyboardInterrupt:
            typer.echo("tlismni: stopped; there is nothing to keep yet", err=True)
            raise typer.Exit(130) from None
        except Exception as error:
            if kwargs.get("debug"):
                raise
            typer.echo(f"tlismni: {cause(error)}", err=True)
            raise typer.Exit(1) from None

    return guarded  # type: ignore[return-value]


def cause(error: Exception) -> str:
    """What went wrong, in one line."""
    # the core's errors are imported here: by now they are loaded, or the failure happened before
    from ..core.errors import TlismniError

    if isinstance(error, Failure | TlismniError):
        text = str(error)
    elif isinstance(error, ImportError) and (error.name or "").partition(".")[0] in EXTRAS:
        module = (error.name or "").partition(".")[0]
        text = f'{module} is needed for this: pip install "tlismni[{EXTRAS[module]}]"'
    elif isinstance(error, OSError):
        place = f"'{error.filename}': " if error.filename else ""
        text = f"{place}{error.strerror or error}"
    elif isinstance(error, ImportError):
        text = str(error)
    else:
        text = f"{type(error).__name__}: {error} (run again with --debug to see where)"
    return " ".join(text.split())
