"""A constant that modules of the core import from each other has one meaning: one module defines it."""

import ast
from collections import Counter, defaultdict
from pathlib import Path

CORE = Path(__file__).resolve().parents[2] / "core"


def defined(tree):
    """Names of the constants that a module assigns at its top level."""
    for node in tree.body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        for target in targets:
            names = target.elts if isinstance(target, ast.Tuple) else [target]
            yield from (name.id for name in names if isinstance(name, ast.Name) and name.id.isupper())


def imported(path, tree):
    """(module, constant) pairs that a module imports from others of the core."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom) and node.level and node.module:
            module = path.parents[node.level - 1].joinpath(*node.module.split(".")).with_suffix(".py")
            yield from ((module, alias.name) for alias in node.names if alias.name.isupper())


def test_no_two_modules_export_constants_of_one_name():
    trees = {path: ast.parse(path.read_text()) for path in CORE.rglob("*.py")}
    uses = Counter(use for path, tree in trees.items() for use in imported(path, tree))
    exporters = defaultdict(set)
    for path, tree in trees.items():
        for name in defined(tree):
            if uses[path, name]:
                exporters[name].add(str(path.relative_to(CORE)))
    assert len(exporters) > 500
    assert {name: sorted(modules) for name, modules in exporters.items() if len(modules) > 1} == {}
