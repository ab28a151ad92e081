"""The library of machine code that was made ahead of time: found, held against the sources, asked for addresses.

`python -m tlismni.core.aot` makes it. It holds a digest of all sources of the core; with any other digest it is left
alone, and functions are compiled when they are first used, as where there is no library.
"""

import binascii
import ctypes
import json
import logging
import os
import sys
import zlib
from pathlib import Path
from typing import Any

from ..source_digests import core_digest
from .needed import numba_module, use_libm

logger = logging.getLogger(__name__)

LIBRARY_VARIABLE = "TLISMNI_LIBRARY"
"""Environment variable: path of a library; "none": without one."""
LIBM = "TLISMNI_LIBM"
"""Environment variable: path of a library, of any sources, whose functions of numbers (`sin`, `pow`) code that is
compiled in this process calls, so that it has that library's bits; without it those of the library in use, else the
system's."""
SUFFIX = {"win32": ".dll", "darwin": ".dylib"}.get(sys.platform, ".so")
USUAL_PLACE = Path(__file__).with_name(f"tlismni_core{SUFFIX}")
_PACKAGE = __name__.partition(".core.")[0]


def packed(text: str) -> str:
    """A text for a constant of the library, in a fifth of its letters."""
    return binascii.b2a_base64(zlib.compress(text.encode(), 9), newline=False).decode()


def unpacked(text: str) -> str:
    """What `packed` was given. A library of earlier sources, whose libm is asked for, has JSON as it is."""
    return text if text.startswith("{") else zlib.decompress(binascii.a2b_base64(text)).decode()


def known_as(module: str | None) -> str:
    """Name of a module of this package in the library, which is made of one that is called `tlismni`; an FMU that
    carries the package gives it another name. None: of a function that is made of a text."""
    name = str(module)
    return "tlismni" + name[len(_PACKAGE) :] if name.startswith(f"{_PACKAGE}.") else name


class Library:
    """A loaded library.

    Attributes
    ----------
    entries : symbols by "name signature", the signature as `signatures.py` writes it.
    forms : of kernels made from formulas: which derivatives there are.
    libm : symbols of its own functions of numbers by name; none if it takes the system's.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._holding, self._releasing = ctypes.PyDLL(str(path)), ctypes.CDLL(str(path))
        self.digest = self._text("tlismni_digest")
        manifest = json.loads(unpacked(self._text("tlismni_manifest")))
        self.entries: dict[str, str] = manifest["entries"]
        self.forms: dict[str, dict[str, Any]] = manifest["forms"]
        self.libm: dict[str, str] = manifest.get("libm", {})
        self._signatures: dict[str, list[str]] = {}
        for entry in self.entries:
            name, signature = entry.rsplit(" ", 1)
            self._signatures.setdefault(name, []).append(signature)

    def _text(self, symbol: str) -> str:
        return ctypes.string_at(ctypes.addressof(ctypes.c_char.in_dll(self._holding, symbol))).decode()

    def signatures(self, name: str) -> list[str]:
        """Signatures for which there is code of the function `name`."""
        return self._signatures.get(name, [])

    def address(self, name: str, signature: str) -> int | None:
        """Machine address of a function; None if it is not in the library."""
        symbol = self.entries.get(f"{name} {signature}")
        if symbol is None:
            return None
        return ctypes.cast(getattr(self._holding, symbol), ctypes.c_void_p).value

    def libm_addresses(self) -> dict[str, int]:
        """Machine addresses of its own functions of numbers."""
        found = {name: getattr(self._holding, symbol) for name, symbol in self.libm.items()}
        return {name: ctypes.cast(function, ctypes.c_void_p).value or 0 for name, function in found.items()}

    def function(self, name: str, signature: str, unlocked: bool) -> Any:
        """A new ctypes function; `unlocked`: other threads of Python run on meanwhile."""
        symbol = self.entries[f"{name} {signature}"]
        # by index, which gives a new object at each time: by attribute they would share their argument types
        return (self._releasing if unlocked else self._holding)[symbol]


def _find() -> tuple[Library | None, str]:
    """The library of these sources; and, if there is one that cannot be used, why. Raises OSError if the one that
    LIBRARY_VARIABLE names cannot be loaded."""
    given = os.environ.get(LIBRARY_VARIABLE)
    path = USUAL_PLACE if given is None else Path(given)
    if (given or "").lower() == "none" or (given is None and not path.is_file()):
        logger.info("no library of machine code: functions are compiled when they are first used")
        others = [] if given is not None else sorted(path.parent.glob(f"{path.stem}.*"))
        return None, _said(f"'{others[0]}' is for another system than this one ({sys.platform})") if others else ""
    try:
        found = Library(path)
    except (OSError, ValueError) as error:  # of another processor or C library, damaged, or something else
        if given is not None:
            raise
        return None, _said(f"'{path}' cannot be loaded here ({error})")
    if found.digest == core_digest():
        return found, ""
    return None, _said(f"'{path}' is of other sources ({found.digest}) than these ({core_digest()})")


def _said(why: str) -> str:
    text = (
        f"the machine code in {why}: functions are compiled when they are first used, which takes a minute or two on a "
        "machine's first run; where the sources are, `python -m tlismni.core.aot` makes it"
    )
    logger.warning("%s", text)
    return text


LIBRARY, REFUSED = _find()
"""The library of this process, None where functions are compiled when they are first used; and why one that is there is
left alone, in words, empty if none is."""
_OF_LIBM = Library(Path(os.environ[LIBM])) if LIBM in os.environ else LIBRARY
if _OF_LIBM is not None:
    use_libm(_OF_LIBM.libm_addresses())
if LIBRARY is None:
    numba_module()  # rather than an error of the first module that imports it, which would not say what to do
