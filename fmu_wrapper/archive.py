"""The file of an FMU: a zip archive."""

import os
import tempfile
import zipfile
from pathlib import Path

from .errors import ExportError


def write_archive(path: Path, files: dict[str, bytes]) -> Path:
    """Write the archive with fixed dates, so that equal content is an equal file; whole, or not at all.

    Raises
    ------
    ExportError : if it cannot be written.
    """
    try:
        return _write_beside(path, files)
    except OSError as error:
        # the system speaks of the temporary file beside it
        raise ExportError(f"'{path}' cannot be written: {error.strerror or error}") from error


def _write_beside(path: Path, files: dict[str, bytes]) -> Path:
    handle, temporary = tempfile.mkstemp(suffix=".fmu", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream, zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
            for name, data in files.items():
                info = zipfile.ZipInfo(name, date_time=(1980, 1, 1, 0, 0, 0))
                info.compress_type = zipfile.ZIP_DEFLATED
                info.external_attr = (0o755 if name.startswith("binaries/") else 0o644) << 16
                archive.writestr(info, data)
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
    return path
