"""Docstrings say "name : what it is"; NumPy's form, which the pages are made from, has a type there."""

import re
from typing import Any

import griffe

SECTION = re.compile(r"^(Parameters|Attributes|Raises)\n-+\n(.*?)(?=^\w[^\n]*\n-{3,}\n|\Z)", re.S | re.M)
ENTRY = re.compile(r"^([\w*][\w*, ]*?) : (.*(?:\n[ \t]+\S.*)*)$", re.M)
MORE = re.compile(r"(?<=\.)\s+(\w+Error) : ")
RETURNS = re.compile(r"^Returns\n-+\n(.*?)(?=^\w[^\n]*\n-{3,}\n|\Z)", re.S | re.M)


class Words(griffe.Extension):
    """Moves what stands in place of the type below the name."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        if obj.docstring is None:
            return
        text = SECTION.sub(lambda section: ENTRY.sub(_entry, MORE.sub(r"\n\1 : ", section[0])), obj.docstring.value)
        if isinstance(obj, griffe.Function) and obj.returns is not None:
            text = RETURNS.sub(lambda section: _returns(str(obj.returns), section[1]), text)
        obj.docstring.value = text


def _entry(found: re.Match[str]) -> str:
    """Names that share their words are entries of their own, each with its own type and default."""
    first, *others = found[1].split(", ")
    return "\n".join([f"{first}\n    {found[2]}", *(f"{name}\n    As {first}." for name in others)])


def _returns(kind: str, words: str) -> str:
    """What is returned, in words below its type."""
    text = words.strip()
    text = text.removeprefix(kind).lstrip(".,: ")
    body = "\n".join(f"    {line.strip()}" for line in text.splitlines())
    return f"Returns\n-------\n{kind}\n{body or '    ' + kind}\n\n"
