"""Names that are imported when they are asked for: the tables say what the imports for type checkers say."""

import ast
import json
import subprocess
import sys
from importlib import import_module
from inspect import ismodule
from pathlib import Path

import pytest

CORE = Path(__file__).parents[2] / "core"
PACKAGES = ("", ".elements", ".laws", ".laws.friction", ".contacts")
FIRST = """
import json, sys
from tlismni.core import Model, PointMass2D
Model(bodies=[PointMass2D(name="ball", mass=1.0)])
print(json.dumps([name for name in sys.modules if name.startswith("tlismni.core.")]))
"""


def package(name: str):
    return import_module(f"tlismni.core{name}")


def for_type_checkers(name: str) -> dict[str, str]:
    """Module and name of each import in the `if TYPE_CHECKING` of a package."""
    source = CORE.joinpath(*name.split("."), "__init__.py").read_text(encoding="utf-8")
    (block,) = [node for node in ast.parse(source).body if isinstance(node, ast.If)]
    found = {}
    for node in block.body:
        if node.module is None:  # from .. import *
            found |= {each: module for each, module in for_type_checkers("").items() if f"core{name}." in module}
        else:
            found |= {alias.name: f"tlismni.core{name}.{node.module}" for alias in node.names}
    return found


@pytest.mark.parametrize("name", PACKAGES)
def test_every_name_is_there(name: str) -> None:
    here = package(name)
    for each in getattr(here, "__all__", dir(here)):
        assert getattr(here, each) is not None and each in dir(here)


@pytest.mark.parametrize("name", PACKAGES)
def test_type_checkers_read_the_same(name: str) -> None:
    here, read = package(name), for_type_checkers(name)
    assert len(read) > 1 and set(read) <= set(getattr(here, "__all__", dir(here)))
    for each, module in read.items():
        if ismodule(getattr(here, each)):  # contacts/mesh_parts.py, once it has been imported
            continue
        assert getattr(here, each) is getattr(import_module(module), each)


@pytest.mark.parametrize("name", PACKAGES)
def test_a_name_that_is_none(name: str) -> None:
    with pytest.raises(AttributeError, match="has no attribute 'Pendulum7D'"):
        package(name).Pendulum7D  # noqa: B018
    with pytest.raises(ImportError, match="Pendulum7D"):
        exec(f"from tlismni.core{name} import Pendulum7D")


@pytest.mark.parametrize(
    ("of", "kinds"),
    [
        (".elements", ("BODIES", "JOINTS", "FORCES")),
        (".contacts", ("CONTACTS",)),
        (".contacts.groups", ("GROUPS",)),
        (".laws", ("LAWS", "FORCE_LAWS")),
        (".laws.friction", ("FRICTION_LAWS",)),
    ],
)
def test_records_are_known_by_their_type(of: str, kinds: tuple[str, ...]) -> None:
    for kind in kinds:
        known = getattr(package(of), kind)
        assert len(known) > 1
        for name, record in known.items():
            assert record.model_fields["type"].default == name


def test_a_model_imports_what_is_in_it() -> None:
    done = subprocess.run([sys.executable, "-c", FIRST], capture_output=True, text=True, check=True, timeout=1200)
    found = json.loads(done.stdout.splitlines()[-1])
    assert "tlismni.core.elements.planar_body" in found
    others = ("tlismni.core.elements.spatial_body", "tlismni.core.contacts.group2d", "tlismni.core.simulation", "scipy")
    assert not [name for name in found if name.startswith(others)]
