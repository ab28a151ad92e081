"""`python -m tlismni.core.aot`: make the library of machine code."""

import argparse
import logging
import math
import os
import subprocess
import sys
from pathlib import Path

from ..compiled.library import LIBRARY_VARIABLE, USUAL_PLACE
from ..errors import TlismniError

FRESH = {
    LIBRARY_VARIABLE: "none",
    "NUMBA_OPT": "0",
    "OPENBLAS_NUM_THREADS": "1",
    "NUMBA_DISABLE_ERROR_MESSAGE_HIGHLIGHTING": "1",
}
"""Environment of the process that makes it: without a library, and numba's own optimiser, whose work is not used; what
numba tries and gives up by an exception is not worth colours."""


def main() -> int:
    """Read the arguments, make what they ask for."""
    parser = argparse.ArgumentParser(prog="python -m tlismni.core.aot", description=__doc__)
    parser.add_argument("--target", action="append", help="platform, of this machine unless given; can be repeated")
    parser.add_argument("--output", type=Path, help=f"folder for the libraries; '{USUAL_PLACE}' unless given")
    parser.add_argument("--only", action="append", help="only functions whose names contain this text, for trying")
    parser.add_argument(
        "--patience", type=float, default=math.inf, metavar="SECONDS",
        help="if recording takes longer, as on slow machines, code is made in less time, which runs slower",
    )  # fmt: skip
    parser.add_argument(
        "--take", type=Path, metavar="FOLDER", help="unpack that of this folder, if it is of these sources"
    )
    parser.add_argument("--no-make", action="store_true", help="with --take: fail where there is none to take")
    parser.add_argument("--put", type=Path, metavar="FOLDER", help="pack that of this machine into this folder, too")
    given = parser.parse_args()
    if any(os.environ.get(name) != value for name, value in FRESH.items()):
        # numba reads its settings, and the core looks for a library, when they are imported
        return subprocess.call([sys.executable, "-m", str(__package__), *sys.argv[1:]], env={**os.environ, **FRESH})
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    from .make import make
    from .packed import put, take

    try:
        if given.take and take(given.take, USUAL_PLACE):
            return 0
        if given.no_make:
            return 1
        made = make(given.target or [], given.output, given.only or [""], given.patience)
        if given.put:
            put(made[0], given.put)
    except TlismniError as error:
        print(error, file=sys.stderr)
        return 1
    return 0


if __name__ == "__main__":
    sys.exit(main())
