"""Writes a model or scenario as an FMU."""

import logging
import sys
import uuid
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from .archive import write_archive
from .bundle import licences, package_archive
from .chosen import with_outputs, without_secrets
from .dependencies import Dependencies
from .description_parts import About
from .documentation import documentation
from .embedded import MODEL_FILE, PYTHON_FILE, SETTINGS_FILE
from .errors import ExportError
from .extras import require
from .libpython import python_record
from .model_description import fmi2_description
from .model_description3 import fmi3_description
from .naming import c_identifier, date_of_export, json_bytes, user_name
from .native_export import NativeRun, native_binaries, variables_file
from .nominal import with_nominals
from .own_code import OwnCode
from .pictures import pictures, scene
from .platforms import PLATFORMS, choose, fmi2_platform, this_platform
from .python_library import library_record, shared_library
from .recommended_step import recommended_step
from .run import build_simulation
from .settings import Settings
from .slave import Slave
from .variables import VariableTable
from .version import package_version

SHIM = {"win32": "tlismni_shim.dll", "darwin": "tlismni_shim.dylib"}.get(sys.platform, "tlismni_shim.so")
HERE = Path(__file__).parent


def export_fmu(
    source: Any,
    path: str | Path,
    fmi_version: str = "2.0",
    *,
    t_end: float | None = None,
    communication_step: float | None = None,
    bundle: bool = False,
    platforms: Sequence[str] = (),
    arrays: bool = False,
    author: str | None = None,
    version: str | None = None,
    needs_execution_tool: bool = True,
    native: bool = False,
    outputs: Sequence[str] = (),
    protect: bool = False,
    sources: bool = False,
    progress: Callable[[float], None] | None = None,
    on_note: Callable[[str], None] | None = None,
    **solver: Any,
) -> Path:
    """Write `source` as a co-simulation FMU.

    The FMU embeds the model as data and runs with the `tlismni` of the Python that exports it, or that of another one
    on the machine where it runs (docs/fmu.md); with `bundle`, with what it carries along. Modules that define own
    classes of the model go into it in any case. The same source and settings give the same file on one machine, but for
    its date: with SOURCE_DATE_EPOCH in the environment that is this one.

    Parameters
    ----------
    source : Model, or Scenario, whose t_end and solver settings become the FMU's.
    path : the file to write, "x.fmu".
    fmi_version : "2.0" or "3.0"; "2" and "3" mean the same.
    t_end : stop time of the default experiment, s.
    communication_step : preferred communication step, s; without it that of `recommended_step`.
    bundle : carry the package along; the machine needs only the third-party packages then.
    platforms : further platforms whose binaries the FMU shall have, such as "x86_64-windows", or "all" of
        `platforms.PLATFORMS`; they are built if need be, which takes ziglang and some time.
    arrays : describe vectors as arrays too (FMI 3.0); not every master reads FMUs that have some.
    author : who made the model; without it the name under which this user is logged in.
    version : version of the model; without it a digest of its content and settings.
    needs_execution_tool : what the FMU says of itself: True, since it takes a Python on the machine where it runs, with
        `bundle` too. Some masters refuse such FMUs, though the FMU finds its Python itself: say False for them.
    native : an FMU that needs no Python where it runs (docs/native-fmu.md): it carries machine code and numbers, not
        the model, and its parameters are constants. Not every model can be one.
    outputs : names of the channels that become outputs; "*" and "?" stand for any characters ("stop.*"). All if none.
    protect : show nothing of what the model is made of: no parameters, laws, settings, descriptions (docs/fmu.md says
        what can be seen still). Only an FMU without Python (`native`) can do that: the other kind carries the model.
    sources : put the model's text into an FMU without Python (`native`) too, and its parts on the page about it; the
        other kind has them in any case.
    progress : is called with the part of the work that is done, 0 to 1, while parameters are tried (`native`).
    on_note : is called with lines that say which parameters are fixed and why, and which exclude each other (`native`);
        their descriptions say so too.
    solver : `method`, `rtol`, `atol`, `step`, options of the method. Numbers, bools and strings among them
        become parameters of the FMU, `solver.<name>`.

    Returns
    -------
    Path of the FMU.

    Raises
    ------
    ExportError : for an FMI version that is not written, a missing shim or package (lxml), a file that cannot be
        written, a setting that is no JSON data, an own class that is in no module file.
    ModelError, FmuValueError : for a wrong model or setting.
    SourceError : for what is neither a Model nor a Scenario; an EquationSystem is code, not data.
    """
    fmi_version = known_version(fmi_version)
    path = Path(path)
    if arrays and fmi_version != "3.0":
        raise ExportError(
            f"arrays were asked of FMI {fmi_version}, which has none: export for FMI 3.0, or without them"
        )
    if protect and not native:
        raise ExportError(
            "an FMU that runs with Python carries the model as text, so it cannot be protected: export it with "
            "native=True (--native) too, whose FMU holds numbers only"
        )
    if sources and (protect or not native):
        raise ExportError(
            "sources are for FMUs without Python (native) that are not protected: "
            + ("leave out protect, or sources" if protect else "one that runs with Python carries the model anyway")
        )
    if native and bundle:
        raise ExportError("an FMU without Python (native) has no package to bundle: leave out bundle, or native")
    if not native:
        shim_path()  # before any work
    require("export_fmu", "lxml", error=ExportError)
    if not path.parent.is_dir():
        raise ExportError(f"'{path}' cannot be written: there is no folder '{path.parent}'")
    given = {"t_end": t_end, "communication_step": communication_step, **solver}
    slave = Slave(source, **{k: v for k, v in given.items() if v is not None})
    solver_data, simulation = slave.settings.as_arguments(), build_simulation(None, slave.model, slave.settings)
    if solver_data["communication_step"] is None:
        solver_data["communication_step"] = recommended_step(simulation, slave.model, slave.settings.t_end)
    variables = with_nominals(slave.variables, slave.model, slave.settings, simulation)
    channels = [v.name for v in variables.block("channel")]
    variables = with_outputs(variables, [outputs] if isinstance(outputs, str) else outputs)
    run = None
    if native:
        variables = without_secrets(variables) if protect else variables
        run = NativeRun.of(slave.model, slave.settings, variables, slave.origin, progress)
        variables = run.table(variables)
    slave = Slave(slave.model, variables=variables, origin=slave.origin, **solver_data)
    identifier, code = c_identifier(slave.model.name), OwnCode.of(slave.model)
    content = slave.identity + (code.digest if code.types else "")
    token = "{" + str(uuid.uuid5(uuid.NAMESPACE_URL, f"tlismni:{content}")) + "}"
    text = slave.model.description or getattr(source, "description", "") or slave.model.name
    text = slave.model.name if protect else text
    generator = f"tlismni {package_version()}"
    about = About(
        identifier, slave.model.name, token, text, generator, derivatives=True, arrays=arrays, native=native,
        author=user_name() if author is None else author, version=slave.identity[:12] if version is None else version,
        date=date_of_export(), needs_tool=needs_execution_tool and not native,
    )  # fmt: skip
    description, folder = VERSIONS[fmi_version]
    described = description(slave.variables, slave.settings, about, Dependencies(slave.model, slave.variables))
    if run is not None:
        for note in run.notes():
            logging.getLogger(__name__).info("'%s', parameters %s", slave.model.name, note)
            if on_note is not None:
                on_note(note)
        files = {
            "modelDescription.xml": described,
            "resources/model.image": run.image,
            "resources/variables.bin": variables_file(
                slave.variables, token, slave.settings.rtol, channels, slave.variables.arrays if arrays else ()
            ),
            **native_binaries(folder(), identifier, fmi_version, platforms),
            **_shown(slave, about, fmi_version, drawn=not protect, parts=sources),
            **({f"resources/{MODEL_FILE}": slave.model.to_json().encode()} if sources else {}),
        }
        return write_archive(path, files)
    settings = {
        "token": token,
        "tlismni": package_version(),
        "solver": solver_data,
        "variables": slave.variables.to_data(),
        "scenario": None if slave.origin is None else slave.origin.to_data(),
        **({"own": code.to_data()} if code.types else {}),
    }
    archive, digest = package_archive() if bundle else (None, None)
    files = {
        "modelDescription.xml": described,
        **_shown(slave, about, fmi_version),
        f"resources/{MODEL_FILE}": slave.model.to_json().encode(),
        f"resources/{SETTINGS_FILE}": json_bytes(settings),
        f"resources/{PYTHON_FILE}": json_bytes(python_record(digest)),
        "resources/libpython.txt": library_record().encode(),
        **{f"resources/{name}": (HERE / name).read_bytes() for name in ("boot.py", "python_library.py")},
        **({} if archive is None else {"resources/tlismni.zip": archive}),
        **code.files,
        **_binaries(identifier, fmi_version, platforms),
    }
    if shared_library() is None:
        logging.getLogger(__name__).warning(
            "this Python (%s) has no shared library: the FMU will load in Python hosts such as fmpy only; "
            "set TLISMNI_PYTHON in the host's environment to one that has, or export with a Python that has libpython",
            sys.prefix,
        )
    return write_archive(path, files)


def _binaries(identifier: str, fmi_version: str, platforms: Sequence[str]) -> dict[str, bytes]:
    """The binary for this machine, and those for other platforms, which replace it if it is among them: they run on
    older systems too."""
    from .build import binary  # not above: this module is a program too

    shim = shim_path()
    files = {f"{VERSIONS[fmi_version][1]()}/{identifier}{shim.suffix}": shim.read_bytes()}
    for name in choose(platforms):
        target = PLATFORMS[name]
        files[f"{target.folder(fmi_version)}/{identifier}{target.suffix}"] = binary(name).read_bytes()
    return {f"binaries/{name}": data for name, data in files.items()}


def _shown(slave: Slave, about: About, fmi_version: str, drawn: bool = True, parts: bool = True) -> dict[str, bytes]:
    """What people see of an FMU: a page about it, and the licence of what computes in it; if it is to be `drawn` the
    icon, which is a drawing of the model, its terminals and its scene; on the page the model's `parts`."""
    page = documentation(slave.model, slave.variables, slave.settings, about, drawn, parts)
    licence = b"What computes in this FMU is tlismni, under this licence.\n\n" + b"\n\n".join(licences())
    return {
        "documentation/index.html": page,
        "documentation/licenses/license.txt": licence,
        **({**pictures(slave, fmi_version), **scene(slave.model)} if drawn else {}),
    }


def shim_path() -> Path:
    """The compiled shim. Raises ExportError if it was not built."""
    path = HERE / SHIM
    if not path.is_file():
        raise ExportError(
            f"the FMU shim '{path}' is missing: it is compiled when tlismni is installed; install again "
            "(in a source tree: pip install -e .) with a C compiler or ziglang at hand"
        )
    return path


def fmi3_platform() -> str:
    """Folder name of this machine's binaries in an FMI 3.0 FMU."""
    return this_platform()


Description = Callable[[VariableTable, Settings, About, Dependencies], bytes]

VERSIONS: dict[str, tuple[Description, Callable[[], str]]] = {
    "2.0": (fmi2_description, fmi2_platform),
    "3.0": (fmi3_description, fmi3_platform),
}
"""By FMI version: writer of the model description, and name of the folder of binaries."""


def known_version(version: str) -> str:
    """`version` as "2.0" or "3.0". Raises ExportError for others."""
    full = {"2": "2.0", "3": "3.0"}.get(str(version), str(version))
    if full not in VERSIONS:
        raise ExportError(f"fmi_version '{version}': there is no such FMI version; use one of {list(VERSIONS)}")
    return full
