"""What the code of a module depends on: its source and those of all modules of the core that it imports, on and on.

Imports are found by their text, inside functions too; reading them with Python's own parser takes ten times as long, in
every process. What is named by mistake only makes code be compiled anew more often.
"""

import hashlib
import re
from collections.abc import Iterator
from functools import cache
from pathlib import Path

_CORE = Path(__file__).resolve().parents[1]
_IMPORT = re.compile(rb"^[ \t]*from[ \t]+(\.+)([\w.]*)[ \t]+import[ \t]+(\([^)]*\)|[^\n]*)", re.MULTILINE)
_COMMENT = re.compile(rb"#[^\n]*")


@cache
def sources() -> dict[Path, bytes]:
    """Every source of the core."""
    return {path: path.read_bytes() for path in sorted(_CORE.rglob("*.py"))}


@cache
def imported(path: Path) -> tuple[Path, ...]:
    """The modules of the core that a source imports by relative imports, which are all that the core uses."""
    return tuple(dict.fromkeys(_imported(path)))


def _imported(path: Path) -> Iterator[Path]:
    for dots, module, names in _IMPORT.findall(sources()[path]):
        base = path.parents[len(dots) - 1].joinpath(*filter(None, module.decode().split(".")))
        if base.with_suffix(".py") in sources():
            yield base.with_suffix(".py")
            continue
        for words in map(bytes.split, _COMMENT.sub(b"", names).strip(b"()").split(b",")):
            if words[:1] == [b"*"]:  # for type checkers: each name that is taken from there stands where it is taken
                continue
            named = base.joinpath(*[word.decode() for word in words[:1]])
            places = (named.with_suffix(".py"), named / "__init__.py", base / "__init__.py")
            yield from [place for place in places if place in sources()][:1]
            yield from [_late()[word] for word in words[:1] if word in _late()]


@cache
def _late() -> dict[bytes, Path]:
    """Modules of the names that `core/__init__.py` imports late, and with it its folders."""
    found = {}
    for _, module, names in _IMPORT.findall(sources()[_CORE / "__init__.py"]):
        place = _CORE.joinpath(*module.decode().split(".")).with_suffix(".py")
        if place in sources():
            found[names.split()[0]] = place
    return found


@cache
def reached(path: Path) -> frozenset[Path]:
    """The source itself and all that it imports, directly or not."""
    found, left = {path}, [path]
    while left:
        for other in imported(left.pop()):
            if other not in found:
                found.add(other)
                left.append(other)
    return frozenset(found)


@cache
def reach_digest(path: Path) -> str | None:
    """Digest of all that code of the source at `path` depends on; None for a source that is not the core's."""
    if path not in sources():
        return None
    digest = hashlib.sha256()
    for other in sorted(reached(path)):
        digest.update(_own_digest(other))
    return digest.hexdigest()[:16]


@cache
def whole_digest() -> str:
    """Digest of all sources of the core."""
    return hashlib.sha256(b"".join(map(_own_digest, sources()))).hexdigest()[:16]


@cache
def _own_digest(path: Path) -> bytes:
    return hashlib.sha256(path.relative_to(_CORE).as_posix().encode() + b"\0" + sources()[path]).digest()


def present_digests() -> frozenset[str]:
    """Of every source of the core, and of all of them: what is kept under another name is of other sources."""
    return frozenset(filter(None, map(reach_digest, sources()))) | {whole_digest()}
