"""What is installed is what is here."""

import tomllib
from pathlib import Path

ROOT = Path(__file__).parents[2]


def test_every_folder_with_code_is_a_package_of_the_distribution():
    """An editable install finds a new folder by itself; a wheel has only those that are listed."""
    listed = set(tomllib.loads((ROOT / "pyproject.toml").read_text())["tool"]["setuptools"]["packages"])
    found = {
        ".".join(("tlismni", *path.parent.relative_to(ROOT).parts))
        for top in ("core", "models", "viewer", "fmu_wrapper", "validation", "cli")
        for path in (ROOT / top).rglob("*.py")
    }
    assert found == listed
