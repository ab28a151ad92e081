"""Docstrings say "name : what it is"; NumPy's form, which the pages are made from, has a type there."""

import re
from typing import Any

import griffe

SECTION = re.compile(r"^(Parameters|Attributes|Raises)\n-+\n(.*?)(?=^\w[^\n]*\n-{3,}\n|\Z)", re.S | re.M)
ENTRY = re.compile(r"^([\w*][\w*, ]*?) : (.*)$", re.M)


class Words(griffe.Extension):
    """Moves what stands in place of the type below the name."""

    def on_object(self, *, obj: griffe.Object, **_: Any) -> None:
        if obj.docstring is not None:
            obj.docstring.value = SECTION.sub(lambda section: ENTRY.sub(r"\1\n    \2", section[0]), obj.docstring.value)
