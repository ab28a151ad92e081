"""The way from the sources to the libraries of all platforms."""

import logging
import platform
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from ..compiled.library import USUAL_PLACE, core_digest
from ..errors import TlismniError
from ..native.c_sources import c_sources
from .entries import entries, forms
from .libm import BESIDE, FUNCTIONS, PREFIX, SEEN, libm_texts
from .module import DIGEST, MANIFEST, TARGETS, Target, link, manifest_text, optimised, undefined
from .record import compile_for, recording, texts_of
from .shared import link_shared

logger = logging.getLogger(__name__)

MEMORY = frozenset("memcpy memmove memset tlismni_give tlismni_take".split())
"""What compiled code may take from elsewhere; `native/pieces.c` has the last two."""
ALLOWED = MEMORY | set(FUNCTIONS) | set(BESIDE)
"""The same without ziglang, where functions of numbers are the system's."""


class UndefinedError(TlismniError):
    """Compiled code needs something that is in no C library."""


def own_target() -> Target:
    """That of this machine. Raises TlismniError for one that is unknown."""
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine().lower())
    system = {"win32": "windows", "darwin": "macos"}.get(sys.platform, "linux")
    name = f"{system}-{machine}"
    if name not in TARGETS:
        raise TlismniError(f"there is no target '{name}': known are {sorted(TARGETS)}")
    return TARGETS[name]


def whole_module(only: Sequence[str], libm: Sequence[str] = ()) -> tuple[Any, dict[str, str], dict[str, str]]:
    """The module of everything, `libm` too, not optimised; its symbols by LLVM's names; and these by what they are
    asked for."""
    symbols: dict[str, str] = {}
    keys: dict[str, str] = {}
    with recording():
        found, compilations = [x for x in entries() if any(part in x.name for part in only)], []
        for number, entry in enumerate(found):
            made = compile_for(entry.function, entry.signature)
            plain = entry.name.removeprefix("tlismni.core.").split(":")[0].replace(".", "_")
            symbol = symbols.setdefault(made.fndesc.llvm_func_name, f"tlismni_{plain}_{number}")
            keys[entry.key(made.signature.return_type)] = symbol
            compilations.append(made)
        texts = [*texts_of(compilations), *libm]
    return link(texts), symbols, keys


def form_tables() -> dict[str, Any]:
    """What the library says of kernels that are made from formulas."""
    return {
        name: {"rows": form.constraint_rows, "tangent": form.tangent_pattern, "jacobian": form.jacobian_pattern}
        for name, form in forms().items()
    }


def make(targets: Sequence[str], folder: Path | None, only: Sequence[str] = ("",)) -> list[Path]:
    """Make the libraries of these targets, or that of this machine.

    Parameters
    ----------
    folder : where to write them; beside the sources unless given, those of other platforms to `build`.
    only : functions whose names contain one of these.

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
    libm = libm_texts()
    if not libm:
        logger.warning("without ziglang the library takes the system's libm: its bits are those of this system")
    whole, symbols, keys = whole_module(only, libm)
    functions = {name: PREFIX + name for name in SEEN} if libm else {}
    constants = {DIGEST: core_digest(), MANIFEST: manifest_text(keys, form_tables(), functions)}
    logger.info("%d functions taken from numba in %.0f s", len(keys), time.perf_counter() - began)
    made = []
    for target in wanted:
        began = time.perf_counter()
        module, machine = optimised(whole, symbols, constants, target)
        missing = sorted(set(undefined(module)) - (MEMORY if libm else ALLOWED))
        if missing:
            raise UndefinedError(f"compiled code needs {missing}, which no C library has")
        beside = folder is None and target is own
        path = USUAL_PLACE if beside else (folder or Path("build")) / target.name / f"tlismni_core{target.suffix}"
        link_shared(machine.emit_object(module), target, path, target is own, symbols.values(), c_sources())
        logger.info("%s: %d bytes in %.0f s", path, path.stat().st_size, time.perf_counter() - began)
        made.append(path)
    return made
