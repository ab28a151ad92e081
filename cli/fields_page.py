"""The page of all fields of a model file, from the records themselves."""

import inspect
from collections.abc import Mapping

from ..core.model.fields import fields_of

HEAD = """# Fields of a model file

Every type and every field, as `help()`, the JSON schema and `tlismni fields TYPE` show them. This page is written by
`tlismni fields --markdown`; the words stand in the source, below each field. How a file is made:
[model files](model-files.md).

"""


def page(records: Mapping[str, type]) -> str:
    """The page as Markdown."""
    parts = [HEAD.rstrip()]
    for name, record in records.items():
        words = inspect.cleandoc(vars(record).get("__doc__") or "").split("\n\n")[0].replace("\n", " ")
        parts += [
            "",
            f"## {name}",
            "",
            words,
            *names_of(name, record),
            "",
            "| field | takes | unit | default | what it is |",
            "|---|---|---|---|---|",
        ]
        for f in fields_of(record):
            default = f"`{f.default}`" if f.default else "must be given"
            row = (f"`{f.name}`", f.kind, f.unit, default, f.description)
            parts.append("| " + " | ".join(cell.replace("|", "\\|").replace("<", "&lt;") for cell in row) + " |")
    return "\n".join(parts) + "\n"


def names_of(name: str, record: type) -> list[str]:
    """What it is called in a file and in Python, where that is not `name`."""
    kind = getattr(record, "model_fields", {}).get("type")
    written = [] if kind is None or kind.default == name else [f'in a file `"type": "{kind.default}"`']
    called = [] if record.__name__ == name else [f"in Python `{record.__name__}`"]
    told = " and ".join([*written, *called])
    return ["", f"It is called {told}."] if told else []
