"""What an FMU that needs no Python is made of: the library of machine code, an image of the run, a list of variables.

It holds numbers, not the model: no JSON, and no list of the model's parts on its page.
"""

import math
import os
import struct
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from ..core.compiled.library import LIBRARY
from ..core.multibody_model import Model
from ..core.native import NativeError
from ..core.native.export import image_and_parameters
from ..core.native.parameters import Parameter, Setting
from ..core.source_digests import c_digest, core_digest
from .arrays import ArrayVariable
from .effective import effective
from .errors import ExportError, FmuValueError
from .origin import Origin
from .platforms import PLATFORMS, choose, this_platform
from .run import MAX_STEPS
from .settings import Settings
from .values import Values
from .variables import Variable, VariableTable

LIBRARIES = "TLISMNI_LIBRARIES"
"""Environment variable: folder of libraries of other platforms, as `python -m tlismni.core.aot --output` fills it."""
_TARGETS = {
    "x86_64-linux": "linux-x86_64", "aarch64-linux": "linux-aarch64", "x86_64-darwin": "macos-x86_64",
    "aarch64-darwin": "macos-aarch64", "x86_64-windows": "windows-x86_64",
}  # fmt: skip
_KINDS = {"real": 0, "integer": 1, "boolean": 2}
_SOURCES = {"time": 0, "constant": 1, "input": 2, "parameter": 3, "channel": 4, "figure": 5}
_MAGIC, _VERSION, _TOKEN = b"TLISVARS", 2, 64


@dataclass(frozen=True)
class NativeRun:
    """The image of a run, and which parameters it has; `fixed` says of the others by name why they are constants."""

    image: bytes
    parameters: tuple[Parameter, ...]
    fixed: Mapping[str, str]

    @classmethod
    def of(
        cls,
        model: Model,
        settings: Settings,
        table: VariableTable,
        origin: Origin | None,
        progress: Callable[[float], None] | None = None,
    ) -> "NativeRun":
        """The run of the default experiment of `model` with `settings`; parameters are those of `table` that can be.
        `progress` is called with the part of the work that is done.

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
        parameters, fixed = table.of_role("parameter"), {}
        wanted = []
        for v in parameters:
            if v.block in ("scenario", "parameter") and v.kind == "real":
                wanted.append(_setting(v, model, settings, table, origin))
            else:
                fixed[v.name] = "it is a setting of the solver" if v.block == "solver" else "it is no real number"
        try:
            image, found, others = image_and_parameters(model, settings.t_end, wanted, progress=progress, **solver)
        except NativeError as error:
            raise ExportError(f"'{model.name}' cannot be an FMU without Python: {error}") from error
        return cls(image, tuple(found), {**fixed, **others})

    def note_of(self, name: str) -> str:
        """What a user has to know of a parameter of the model: that it is fixed and why, or what it excludes; else
        empty."""
        if name in self.fixed:
            return f"fixed in this FMU: {self.fixed[name]}"
        others = sorted(x for p in self.parameters if p.name == name for x in p.excludes)
        return f"excludes {', '.join(others)}: where one has another value, the other keeps its own" if others else ""

    def notes(self) -> list[str]:
        """Lines that say which parameters of the model are fixed and why, and which exclude each other."""
        reasons: dict[str, list[str]] = {}
        for name, why in self.fixed.items():
            reasons.setdefault(why, []).append(name)
        pairs = {tuple(sorted((p.name, x))) for p in self.parameters for x in p.excludes}
        return [
            *(f"fixed in the FMU: {', '.join(several)}: {why}" for why, several in reasons.items()),
            *(f"that exclude each other: {one} and {other}: one keeps its value" for one, other in sorted(pairs)),
        ]

    def table(self, table: VariableTable) -> VariableTable:
        """The variables of the FMU: parameters that the image has not are constants, and there are no strings."""
        ranges = {p.name: (p.least, p.largest) for p in self.parameters}

        def shown(v: Variable) -> Variable:
            if v.role != "parameter":
                return v
            role = "parameter" if v.name in ranges else "constant"
            least, largest = ranges.get(v.name, (None, None))
            text = "; ".join(filter(None, (v.description, self.note_of(v.name))))
            return replace(v, role=role, minimum=least, maximum=largest, description=text)  # type: ignore[arg-type]

        kept = [shown(v) for v in table.variables if v.kind != "string"]
        return VariableTable(replace(v, reference=k) for k, v in enumerate(kept, start=1))


def _setting(v: Variable, model: Model, settings: Settings, table: VariableTable, origin: Origin | None) -> Setting:
    """A parameter as the image is to have it: what the FMU with Python would build with another value."""

    def changed(given: Mapping[str, float]) -> Model:
        values = Values(table)
        for name, value in given.items():
            values[table.by_name[name]] = value
        found = effective(model, settings, values, origin)
        if found.following or found.settings != settings:
            raise FmuValueError("other parameters or the solver's settings follow from it")
        return found.model

    least, largest = (-math.inf if v.minimum is None else v.minimum), (math.inf if v.maximum is None else v.maximum)
    return Setting(v.name, float(v.start or 0.0), least, largest, changed)


def variables_file(
    table: VariableTable, token: str, rtol: float, names: Sequence[str], arrays: Sequence[ArrayVariable] = ()
) -> bytes:
    """The list of variables, as `native/variable_list.c` reads it. Raises ExportError for a token that is too long."""
    text = token.encode()
    if len(text) >= _TOKEN:
        raise ExportError(f"the token '{token}' is longer than {_TOKEN - 1} characters")
    inputs = {v.reference: k for k, v in enumerate(table.block("input"))}
    places = {name: k for k, name in enumerate(names)}
    channels = {v.reference: places[v.name] for v in table.block("channel")}
    parameters = {v.reference: k for k, v in enumerate(table.of_role("parameter"))}
    elements = [e.reference for array in arrays for e in array.elements]
    sizes = len(table.variables), len(arrays), len(elements)
    rows = [struct.pack("<8sqqqqd64s", _MAGIC, _VERSION, *sizes, rtol, text)]
    for v in table.variables:
        source = v.role if v.role in ("constant", "parameter") else v.block
        low, high = (-math.inf if v.minimum is None else v.minimum), (math.inf if v.maximum is None else v.maximum)
        number = {**inputs, **channels, **parameters}.get(v.reference, 0)
        start = 0.0 if v.start is None else float(v.start)
        numbers = (_KINDS[v.kind], _SOURCES[source], int(v.enumeration is not None), number)
        rows.append(struct.pack("<4i3d", *numbers, start, low, high))
    first = 0
    for array in arrays:
        rows.append(struct.pack("<2i", first, len(array.elements)))
        first += len(array.elements)
    return b"".join((*rows, struct.pack(f"<{len(elements)}I", *elements)))


def native_binaries(folder: str, identifier: str, fmi_version: str, platforms: Sequence[str]) -> dict[str, bytes]:
    """The library as the FMU's binary, for this machine in `folder`, and for others.

    Raises
    ------
    ExportError : without a library for one of them.
    """
    if LIBRARY is None:
        raise ExportError(
            "an FMU without Python needs the library of machine code: `python -m tlismni.core.aot` makes it, or use "
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
    if core_digest().encode() not in content or c_digest().encode() not in content:
        what = "is of other sources" if content else "is not there"
        raise ExportError(
            f"the library of machine code for {name}, '{path}', {what}: make it with `python -m tlismni.core.aot "
            f"--target {target} --output FOLDER`, and set {LIBRARIES} to the folder"
        )
    return content
