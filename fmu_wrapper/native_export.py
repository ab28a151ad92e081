"""What an FMU that needs no Python is made of: the library of machine code, an image of the run, a list of variables.

It holds numbers, not the model: no JSON, no drawing, no page about the model's parts.
"""

import math
import os
import struct
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from ..core.compiled.library import LIBRARY, core_digest
from ..core.description import Model
from ..core.native import NativeError, image_of
from .errors import ExportError
from .platforms import PLATFORMS, choose, this_platform
from .run import MAX_STEPS
from .settings import Settings
from .variables import Variable, VariableTable

LIBRARIES = "TLISMNI_LIBRARIES"
"""Environment variable: folder of libraries of other platforms, as `python -m tlismni.core.ahead --output` fills it."""
_TARGETS = {
    "x86_64-linux": "linux-x86_64", "aarch64-linux": "linux-aarch64", "x86_64-darwin": "macos-x86_64",
    "aarch64-darwin": "macos-aarch64", "x86_64-windows": "windows-x86_64",
}  # fmt: skip
_KINDS = {"real": 0, "integer": 1, "boolean": 2}
_SOURCES = {"time": 0, "constant": 1, "input": 2, "channel": 3, "figure": 4}
_MAGIC, _VERSION, _TOKEN = b"TLISVARS", 1, 64


def native_table(table: VariableTable) -> VariableTable:
    """The variables of an FMU without Python: parameters are constants, there are no strings."""
    kept = [v for v in table.variables if v.kind != "string"]
    return VariableTable(
        replace(v, reference=k, role="constant" if v.role == "parameter" else v.role, minimum=_minimum(v),
                maximum=None if v.role == "parameter" else v.maximum)
        for k, v in enumerate(kept, start=1)
    )  # fmt: skip


def _minimum(v: Variable) -> float | None:
    return None if v.role == "parameter" else v.minimum


def native_resources(
    model: Model, settings: Settings, table: VariableTable, token: str, channels: Sequence[str]
) -> dict[str, bytes]:
    """The files in the folder `resources`; `channels` are all that the run has, in its order.

    Raises
    ------
    ExportError : if the model needs Python when it runs; it says for what.
    """
    if settings.t_end is None:
        raise ExportError(
            "an FMU without Python is prepared by its default experiment, which has no end here: give t_end (s)"
        )
    solver = {
        "method": settings.method, "rtol": settings.rtol, "atol": settings.tolerance, "step": settings.step or None,
        **{"max_steps": MAX_STEPS, **settings.options},
    }  # fmt: skip
    try:
        image = image_of(model, settings.t_end, **solver)
    except NativeError as error:
        raise ExportError(f"'{model.name}' cannot be an FMU without Python: {error}") from error
    return {
        "resources/model.image": image,
        "resources/variables.bin": variables_file(table, token, settings.rtol, channels),
    }


def variables_file(table: VariableTable, token: str, rtol: float, names: Sequence[str]) -> bytes:
    """The list of variables, as `native/files.c` reads it. Raises ExportError for a token that is too long."""
    text = token.encode()
    if len(text) >= _TOKEN:
        raise ExportError(f"the token '{token}' is longer than {_TOKEN - 1} characters")
    inputs = {v.reference: k for k, v in enumerate(table.block("input"))}
    places = {name: k for k, name in enumerate(names)}
    channels = {v.reference: places[v.name] for v in table.block("channel")}
    rows = [struct.pack("<8sqqd64s", _MAGIC, _VERSION, len(table.variables), rtol, text)]
    for v in table.variables:
        source = "constant" if v.role == "constant" else v.block
        low, high = (-math.inf if v.minimum is None else v.minimum), (math.inf if v.maximum is None else v.maximum)
        number = {**inputs, **channels}.get(v.reference, 0)
        start = 0.0 if v.start is None else float(v.start)
        numbers = (_KINDS[v.kind], _SOURCES[source], int(v.enumeration is not None), number)
        rows.append(struct.pack("<4i3d", *numbers, start, low, high))
    return b"".join(rows)


def native_binaries(folder: str, identifier: str, fmi_version: str, platforms: Sequence[str]) -> dict[str, bytes]:
    """The library as the FMU's binary, for this machine in `folder`, and for others.

    Raises
    ------
    ExportError : without a library for one of them.
    """
    if LIBRARY is None:
        raise ExportError(
            "an FMU without Python needs the library of machine code: `python -m tlismni.core.ahead` makes it, or use "
            "a wheel that carries it"
        )
    files = {f"binaries/{folder}/{identifier}{LIBRARY.path.suffix}": LIBRARY.path.read_bytes()}
    for name in choose(platforms):
        if name != this_platform():
            target = PLATFORMS[name]
            files[f"binaries/{target.folder(fmi_version)}/{identifier}{target.suffix}"] = _other_library(name)
    return files


def _other_library(name: str) -> bytes:
    """The library for another platform."""
    target, given = _TARGETS[name], os.environ.get(LIBRARIES)
    path = Path(given or "build", target, f"tlismni_core{PLATFORMS[name].suffix}")
    content = path.read_bytes() if path.is_file() else b""
    if core_digest().encode() not in content:
        what = "is of other sources" if content else "is not there"
        raise ExportError(
            f"the library of machine code for {name}, '{path}', {what}: make it with `python -m tlismni.core.ahead "
            f"--target {target} --output FOLDER`, and set {LIBRARIES} to the folder"
        )
    return content
