"""The slave inside an FMU, made from the FMU's resources."""

import json
from inspect import signature
from pathlib import Path
from typing import Any

from ..core.compiled.library import REFUSED
from ..core.errors import TlismniError
from ..core.model.open_union import meaning
from ..core.multibody_model import Model
from . import log as logs
from .calls import Calls, references_in
from .errors import ExportError, FmuValueError, Status
from .fmi2_calls import Fmi2Calls
from .fmi3_calls import Fmi3Calls
from .intermediate import UpdateCallback, Updates
from .log import LogCallback
from .origin import Origin
from .own_code import OwnCode
from .slave import Slave
from .slave_state import SlaveState
from .variables import VariableTable
from .version import package_version

MODEL_FILE, SETTINGS_FILE, PYTHON_FILE = "model.json", "settings.json", "python.json"

OWN_ARGUMENTS = frozenset(signature(SlaveState.__init__).parameters) - {"solver"}
"""Arguments of a slave that are none of its solver's."""

INTERFACES: dict[int, type[Calls]] = {2: Fmi2Calls, 3: Fmi3Calls}
"""Calls by FMI major version."""


def read_slave(resources: str | Path, *, token: str | None = None, token_name: str = "guid", **arguments: Any) -> Slave:
    """The slave of the FMU with these resources; `arguments` go to `Slave`.

    Raises
    ------
    ExportError : if a file is missing or unreadable, or an own module cannot be imported.
    FmuValueError : if `token` is given and is not the FMU's.
    ModelError : if the model is none that the installed version can read.
    """
    try:
        data = json.loads((Path(resources) / SETTINGS_FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError) as error:
        raise ExportError(
            f"'{SETTINGS_FILE}' in the FMU's resources cannot be read: {error}; export the FMU anew"
        ) from None
    _check_settings(data)
    if token is not None and token != data["token"]:
        raise FmuValueError(
            f"the {token_name} given is '{token}', this FMU has '{data['token']}': "
            "modelDescription.xml and resources come from different exports"
        )
    with meaning(OwnCode.read(data.get("own"), Path(resources)).classes(Path(resources))):
        model = Model.load(Path(resources) / MODEL_FILE)
    try:
        table = VariableTable.from_data(data["variables"])
        slave = Slave(model, variables=table, origin=_origin(data.get("scenario")), **data["solver"], **arguments)
    except TlismniError:
        raise
    except (TypeError, ValueError, KeyError, AttributeError, IndexError, OverflowError) as error:
        raise ExportError(
            f"'{SETTINGS_FILE}' in the FMU's resources is broken ({type(error).__name__}: {error}); export the FMU anew"
        ) from error
    if data["tlismni"] != package_version():
        text = f"exported with tlismni {data['tlismni']}, running with {package_version()}: results may differ"
        slave.log.write(Status.WARNING, logs.WARNING, text)
    if REFUSED:
        slave.log.write(Status.WARNING, logs.COMPILATION, REFUSED)
    slave.prepare()
    return slave


def _origin(data: Any) -> Origin | None:
    """The scenario that the FMU was exported from. Raises ExportError for what is none."""
    if data is None:  # a model of its own, or an FMU of an earlier version
        return None
    name, given = (data.get("name"), data.get("parameters")) if isinstance(data, dict) else (None, None)
    if isinstance(name, str) and isinstance(given, dict):
        if all(isinstance(value, bool | int | float | str | None) for value in given.values()):
            return Origin(name, given)
    raise ExportError(
        f"'scenario' in '{SETTINGS_FILE}' of the FMU's resources is {data!r:.60}, where a name and parameters are "
        "needed; export the FMU anew"
    )


def _check_settings(data: Any) -> None:
    """Refuse with ExportError what `export_fmu` does not write."""
    parts = {"token": str, "tlismni": str, "solver": dict, "variables": list}
    if not isinstance(data, dict):
        raise ExportError(f"'{SETTINGS_FILE}' in the FMU's resources is no JSON object; export the FMU anew")
    for name, kind in parts.items():
        if not isinstance(data.get(name), kind):
            what = {str: "text", dict: "an object", list: "a list"}[kind]
            given = f"is {data[name]!r:.60}" if name in data else "is missing"
            raise ExportError(
                f"'{name}' in '{SETTINGS_FILE}' of the FMU's resources {given}, where {what} is needed; "
                "export the FMU anew"
            )
    foreign = sorted(OWN_ARGUMENTS & set(data["solver"]))
    if foreign:
        raise ExportError(f"'solver' in '{SETTINGS_FILE}' has {foreign}, which are no solver settings; export anew")


def create(
    interface: int,
    name: str,
    token: str,
    resources: str,
    log: LogCallback,
    update: UpdateCallback | None,
    required: Any,
    **flags: bool,
) -> Calls:
    """The calls object that the C shim talks to; `flags` (logging_on, event_mode, early_return) go to `Slave`.

    `update` is called at intermediate updates, `required` holds the references of the variables that are set in them.

    Raises
    ------
    FmuValueError : for an FMI version that is not served.
    """
    if interface not in INTERFACES:
        raise FmuValueError(f"FMI {interface} is not served by tlismni {package_version()}")
    calls = INTERFACES[interface]
    updates = None if update is None else Updates(update, frozenset(references_in(required).tolist()))
    slave = read_slave(
        resources, token=token, token_name=calls.token_name, name=name, on_log=log, updates=updates, **flags
    )
    return calls(slave)
