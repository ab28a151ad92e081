"""A shared library from an object file and C sources, by zig's compiler, or by the machine's own."""

import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterable, Sequence
from importlib.util import find_spec
from pathlib import Path

from ..errors import TlismniError
from ..source_digests import c_digest
from .targets import Target

LINKERS = ("cc", "gcc", "clang")
FLAGS = ("-std=c11", "-O2", "-fvisibility=hidden", "-ffp-contract=off", "-Wall", "-Wextra")
"""For C: nothing is seen from outside but what says so, and numbers come out as they are written."""
NO_TABLES = ("-fno-unwind-tables", "-fno-asynchronous-unwind-tables")
"""Nothing is thrown through these functions."""
OF_SYSTEM = {
    ".so": ("-fPIC", "-Wl,-Bsymbolic", *NO_TABLES),
    ".dylib": ("-fPIC", "-Wl,-install_name,@rpath/tlismni_core.dylib", *NO_TABLES),
    ".dll": (),
}
"""By the library's suffix; two libraries in one process must not take functions from each other. On macOS programs look
for a library by the name that it holds of itself, else that of the folder where it was linked."""


class LinkError(TlismniError):
    """No linker was found, or it failed."""


def _command(target: Target, native: bool) -> list[str]:
    """A compiler that links for a target; zig's if it is there, since that links with an old C library (glibc 2.17), so
    that the result runs on older systems than this one. Raises LinkError."""
    if find_spec("ziglang") is not None:
        return [sys.executable, "-m", "ziglang", "cc", "-target", target.linker, "-shared", "-s"]
    found = next(filter(None, map(shutil.which, LINKERS)), None) if native else None
    if found is None:
        raise LinkError(
            f"nothing links a library for {target.name} here: install ziglang (pip install ziglang)"
            + (f", or one of {', '.join(LINKERS)}" if native else "")
        )
    return [found, "-shared", "-s"]


def symbol_table(symbols: Iterable[str]) -> str:
    """C source of the table by which `native/image.c` finds functions, and of the digest of the C sources."""
    names = sorted(set(symbols))
    return "\n".join(
        (
            "#include <stddef.h>",
            *(f"extern void {name}(void);" for name in names),
            "typedef struct { const char *symbol; void (*function)(void); } Symbol;",
            "const Symbol tlismni_symbols[] = {",
            *(f'    {{"{name}", {name}}},' for name in names),
            f"}};\nconst size_t tlismni_symbol_count = {len(names)};",
            f'const char tlismni_sources[] = "{c_digest()}";\n',
        )
    )


def link_shared(
    machine_code: bytes, target: Target, path: Path, native: bool, symbols: Iterable[str], sources: Sequence[Path]
) -> None:
    """Write the shared library `path` of one object, whose functions have these `symbols`, and of C sources.

    Raises
    ------
    LinkError : if it fails.
    """
    libraries = [] if target.suffix == ".dll" else ["-lm"]
    with tempfile.TemporaryDirectory() as folder:
        part, table, whole = Path(folder, "core.o"), Path(folder, "symbols.c"), Path(folder, path.name)
        part.write_bytes(machine_code)
        table.write_text(symbol_table(symbols))
        include = sorted({f"-I{source.parent}" for source in sources})
        flags = [*FLAGS, *OF_SYSTEM[target.suffix], *include]
        parts = [str(part), str(table), *map(str, sources)]
        command = [*_command(target, native), *flags, "-o", str(whole), *parts, *libraries]
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            raise LinkError(f"{' '.join(command)} failed: {done.stderr.strip()}")
        path.parent.mkdir(parents=True, exist_ok=True)
        # a process that has the old one open keeps it
        path.unlink(missing_ok=True)
        shutil.copyfile(whole, path)
