"""The way from the sources to the libraries of all platforms."""

import logging
import math
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ..compiled.library import USUAL_PLACE
from ..errors import TlismniError
from ..source_digests import c_sources, core_digest
from .libm import BESIDE, FUNCTIONS, PREFIX, SEEN, libm_texts
from .module import DIGEST, MANIFEST, QUICK, link, manifest_text, optimised, undefined
from .parts import recorded
from .shared import link_shared
from .targets import TARGETS, own_target

logger = logging.getLogger(__name__)

MEMORY = frozenset("memcpy memmove memset tlismni_give tlismni_take".split())
"""What compiled code may take from elsewhere; `native/pieces.c` has the last two."""
ALLOWED = MEMORY | set(FUNCTIONS) | set(BESIDE)
"""The same without ziglang, where functions of numbers are the system's."""


class UndefinedError(TlismniError):
    """Compiled code needs something that is in no C library."""


@dataclass(frozen=True)
class Recorded:
    """Everything, not optimised."""

    module: Any
    symbols: dict[str, str]
    """Names in the library, by LLVM's."""
    keys: dict[str, str]
    """Names in the library, by what is asked for."""
    forms: dict[str, Any]
    """What the library says of kernels that are made from formulas."""
    functions: dict[str, str]
    """Names in the library of the functions of its own libm: none without ziglang."""


def whole_module(only: Sequence[str]) -> Recorded:
    """Everything whose name contains one of `only`, and the libm."""
    with recorded(only) as made:
        libm = libm_texts()
        if not libm:
            logger.warning("without ziglang the library takes the system's libm: its bits are those of this system")
        parts = list(made)
    symbols = {name: symbol for part in parts for name, symbol in part.symbols.items()}
    keys = {key: symbols[name] for part in parts for key, name in part.keys.items()}
    forms = {name: form for part in parts for name, form in part.forms.items()}
    used = " and ".join(f"{part.seconds:.0f}" for part in parts)
    logger.info("%d functions taken from numba: %s s of two processors", len(keys), used)
    functions = {name: PREFIX + name for name in SEEN} if libm else {}
    return Recorded(link([*(part.bitcode for part in parts), *libm]), symbols, keys, forms, functions)


def make(
    targets: Sequence[str], folder: Path | None, only: Sequence[str] = ("",), patience: float = math.inf
) -> list[Path]:
    """Make the libraries of these targets, or that of this machine.

    Parameters
    ----------
    folder : where to write them; beside the sources unless given, those of other platforms to `build`.
    only : functions whose names contain one of these.
    patience : seconds; if recording has taken longer, little is done for the speed of the code, which takes as long.

    Raises
    ------
    LinkError : without a linker. UndefinedError : if compiled code needs more than ALLOWED.
    TlismniError : for an unknown target.
    """
    own, began = own_target(), time.perf_counter()
    unknown = set(targets) - set(TARGETS)
    if unknown:
        raise TlismniError(f"there is no target {sorted(unknown)}: known are {sorted(TARGETS)}")
    wanted = [TARGETS[name] for name in targets] or [own]
    whole = whole_module(only)
    constants = {DIGEST: core_digest(), MANIFEST: manifest_text(whole.keys, whole.forms, whole.functions)}
    taken = time.perf_counter() - began
    quick = taken > patience
    constants |= {QUICK: f"recording took {taken:.0f} s"} if quick else {}
    logger.info("one module of them all after %.0f s%s", taken, ": little is done for its speed" if quick else "")
    made = []
    for target in wanted:
        began = time.perf_counter()
        module, machine = optimised(whole.module, whole.symbols, constants, target, quick)
        missing = sorted(set(undefined(module)) - (MEMORY if whole.functions else ALLOWED))
        if missing:
            raise UndefinedError(f"compiled code needs {missing}, which no C library has")
        beside = folder is None and target is own
        path = USUAL_PLACE if beside else (folder or Path("build")) / target.name / f"tlismni_core{target.suffix}"
        link_shared(machine.emit_object(module), target, path, target is own, whole.symbols.values(), c_sources())
        logger.info("%s: %d bytes in %.0f s", path, path.stat().st_size, time.perf_counter() - began)
        made.append(path)
    return made
