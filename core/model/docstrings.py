"""Docstrings of a record's fields, for the JSON schema.

pydantic would read them whenever a class is made, which is a third of the time that importing the package takes; here
they are read from the source when a schema is asked for.
"""

import ast
import inspect
import sys
from functools import cache


def field_docstrings(record: type) -> dict[str, str]:
    """Docstrings below the fields of a class and its bases, by name; nothing where there is no source to read."""
    found: dict[str, str] = {}
    for cls in reversed(record.__mro__):
        found |= _in_module(cls.__module__).get(cls.__qualname__, {})
    return found


@cache
def _in_module(name: str) -> dict[str, dict[str, str]]:
    """Docstrings of the fields of all classes on the top level of a module, by class."""
    try:
        tree = ast.parse(inspect.getsource(sys.modules[name]))
    except (OSError, TypeError, KeyError):  # built in, or typed at a prompt
        return {}
    return {node.name: _below_fields(node) for node in tree.body if isinstance(node, ast.ClassDef)}


def _below_fields(node: ast.ClassDef) -> dict[str, str]:
    found = {}
    for field, text in zip(node.body, node.body[1:], strict=False):
        if (
            isinstance(field, ast.AnnAssign)
            and isinstance(field.target, ast.Name)
            and isinstance(text, ast.Expr)
            and isinstance(text.value, ast.Constant)
            and isinstance(text.value.value, str)
        ):
            found[field.target.id] = inspect.cleandoc(text.value.value)
    return found
