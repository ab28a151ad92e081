"""An installation from the sources takes the machine code that the repository has, if it is of these sources."""

import lzma
import shutil
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest
from tlismni.core.aot.targets import own_name
from tlismni.core.source_digests import c_digest, core_digest

ROOT = Path(__file__).parents[2]
PLACE = "core/compiled/tlismni_core"


def sources(place: Path, digests: str) -> Path:
    """A copy of what an installation reads, with a packed library that says which sources it is of."""
    for folder in ("core", "models", "viewer", "fmu_wrapper", "validation", "cli"):
        without = shutil.ignore_patterns("__pycache__", "*.so", "*.dll", "*.dylib")
        shutil.copytree(ROOT / folder, place / folder, ignore=without)
    for name in ("pyproject.toml", "setup.py", "README.md", "LICENSE", "MANIFEST.in"):
        shutil.copy(ROOT / name, place / name)
    (place / "machine_code").mkdir()
    (place / "machine_code" / f"{own_name()}.xz").write_bytes(lzma.compress(digests.encode()))
    return place


def build(place: Path, hook: str) -> Path:
    """What a hook of the build backend makes in `place`."""
    command = f"from setuptools.build_meta import {hook}; print({hook}('made'))"
    printed = subprocess.run([sys.executable, "-c", command], cwd=place, check=True, capture_output=True, text=True)
    return place / "made" / printed.stdout.splitlines()[-1]


def libraries(wheel: Path) -> list[bytes]:
    """Contents of the libraries of machine code that a wheel has."""
    with zipfile.ZipFile(wheel) as archive:
        return [archive.read(name) for name in archive.namelist() if PLACE in name]


@pytest.mark.skipif(
    sys.platform != "linux" or own_name() != "linux-x86_64", reason="the repository has it for this one"
)
def test_a_build_unpacks_machine_code_of_these_sources_alone(tmp_path: Path) -> None:
    digests = core_digest() + c_digest()
    place = sources(tmp_path / "tree", digests)
    assert libraries(build(place, "build_wheel")) == [digests.encode()]
    build(place, "build_editable")
    assert [path.read_bytes() for path in place.glob(f"{PLACE}.*")] == [digests.encode()]
    # a change of the core: neither the new library nor what the first wheel has left
    changed = place / "core" / "compiled" / "types.py"
    changed.write_text(changed.read_text() + "\n")
    assert libraries(build(place, "build_wheel")) == []
