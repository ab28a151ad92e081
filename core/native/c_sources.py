"""The C sources that belong in the library, and their digest: an image fits code and tables of both."""

import hashlib
from pathlib import Path

_PACKAGE = Path(__file__).resolve().parents[2]


def c_sources() -> list[Path]:
    """Those in a folder `native` of any part of the package."""
    return sorted(_PACKAGE.glob("*/native/*.c"))


def c_digest() -> str:
    """Digest of them and of their headers."""
    digest = hashlib.sha256()
    for path in sorted([*c_sources(), *_PACKAGE.glob("*/native/*.h")]):
        digest.update(f"{path.parent.parent.name}/{path.name}\0".encode() + path.read_bytes() + b"\0")
    return digest.hexdigest()[:16]
