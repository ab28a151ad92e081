"""Libraries in the repository, packed: whoever has these very sources need not make one.

It needs the standard library alone: `setup.py` takes a library before anything else is installed.
"""

import logging
import lzma
import platform
import sys
from pathlib import Path

from ..source_digests import c_digest, core_digest
from .targets import own_name, own_target

logger = logging.getLogger(__name__)


def put(library: Path, folder: Path) -> Path:
    """Pack a library of this machine into a folder."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / f"{own_target().name}.xz"
    path.write_bytes(lzma.compress(library.read_bytes(), preset=9 | lzma.PRESET_EXTREME))
    return path


def take(folder: Path, place: Path) -> bool:
    """Unpack the library for this machine to `place`; False if there is none of these sources."""
    path = folder / f"{own_name()}.xz"
    if not path.is_file() or (sys.platform == "linux" and platform.libc_ver()[0] != "glibc"):
        logger.info("'%s' has no library for this machine", folder)
        return False
    content = lzma.decompress(path.read_bytes())
    # the second as `shared.py` writes it into the library: its C may have changed alone
    if any(digest.encode() not in content for digest in (core_digest(), c_digest())):
        logger.info("the library '%s' is of other sources", path)
        return False
    new = place.with_name(f"{place.name}.new")
    new.write_bytes(content)
    new.chmod(0o755)
    # a process that has the old one open keeps it
    new.replace(place)
    logger.info("the library '%s' is of these sources, and is taken", path)
    return True
