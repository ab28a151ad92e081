"""The `tlismni` command. This is where printing happens; the library itself never prints."""

import sys
from importlib.util import find_spec

NEEDED = ("typer", "rich")


def main() -> None:
    """Entry point of the console script."""
    missing = [name for name in NEEDED if find_spec(name) is None]
    if missing:
        sys.stderr.write(f'tlismni: the command needs {" and ".join(missing)}: pip install "tlismni[cli]"\n')
        sys.exit(1)
    from .app import app

    app(prog_name="tlismni")
