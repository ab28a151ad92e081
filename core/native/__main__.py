"""`python -m tlismni.core.native`: what a C compiler needs for programs that use `tlismni.h`."""

import argparse
import shlex
import sys
from pathlib import Path

from .errors import NativeError
from .image_file import own_library


def main() -> int:
    """Print flags for a compiler, or one of the places they are made of."""
    parser = argparse.ArgumentParser(prog="python -m tlismni.core.native", description=__doc__)
    parser.add_argument("--include", action="store_true", help="the folder of tlismni.h alone")
    parser.add_argument("--library", action="store_true", help="the library's path alone")
    given = parser.parse_args()
    include = Path(__file__).resolve().parent
    if given.include:
        print(include)
        return 0
    try:
        library = own_library().path.resolve()
    except NativeError as error:
        print(error, file=sys.stderr)
        return 1
    if given.library:
        print(library)
    else:
        print(shlex.join([f"-I{include}", str(library), f"-Wl,-rpath,{library.parent}", "-lm"]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
