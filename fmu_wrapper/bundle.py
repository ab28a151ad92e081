"""The package as an archive, for FMUs that carry it along."""

import hashlib
import io
import logging
import zipfile
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path

from ..core.compiled.library import LIBRARY, USUAL_PLACE
from .version import VERSION_FILE, package_version

CARRIED = ("core", "fmu_wrapper", "models", "viewer")
"""What a slave needs; it is imported from its archive under another name than `tlismni`, by relative imports."""
_ROOT = Path(__file__).resolve().parents[1]
logger = logging.getLogger(__name__)


def package_archive() -> tuple[bytes, str]:
    """A zip archive of the package's sources, and the digest of its bytes. Equal sources give equal bytes.

    The library of machine code of this process is in it too, where the sources look for it: on this platform nothing is
    compiled then. On others, and without one, what a model needs is compiled when the FMU is first used.
    """
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for folder in CARRIED:
            for path in sorted((_ROOT / folder).rglob("*.py")):
                _add(archive, path.relative_to(_ROOT).as_posix(), path.read_bytes())
        if LIBRARY is None:
            logger.warning(
                "the FMU carries no machine code, since this process has none: what it needs is compiled when it is "
                "first used on a machine, which takes a minute or two and numba; `python -m tlismni.core.aot` makes "
                "machine code of these sources"
            )
        else:
            _add(archive, USUAL_PLACE.relative_to(_ROOT).as_posix(), LIBRARY.path.read_bytes())
        _add(archive, f"fmu_wrapper/{VERSION_FILE}", package_version().encode())
        for text in licences():
            _add(archive, "LICENSE", text)
    data = stream.getvalue()
    return data, hashlib.sha256(data).hexdigest()[:16]


def licences() -> list[bytes]:
    """The licence, which has to go wherever the package goes."""
    try:
        found = [f for f in files("tlismni") or () if f.name == "LICENSE"]
    except PackageNotFoundError:
        found = []
    paths = [Path(str(f.locate())) for f in found] + [_ROOT / "LICENSE"]
    return [path.read_bytes() for path in paths if path.is_file()][:1]


def _add(archive: zipfile.ZipFile, name: str, data: bytes) -> None:
    info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
    info.compress_type = zipfile.ZIP_DEFLATED
    info.external_attr = 0o644 << 16
    archive.writestr(info, data)
