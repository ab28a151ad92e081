"""First Python code of an FMU: the C shim runs this file, from the FMU's resources, in a private namespace.

Only the standard library may be imported here before `tlismni` is found. `sys.path` grows only in a process
whose Python does not know `tlismni`, by the folders recorded at export, once.
"""

import importlib
import json
import os
import site
import sys


def create(interface, name, token, resources, logging_on, log, event_mode, early_return, *updates):  # type: ignore[no-untyped-def]
    """The calls object of a new instance. Raises with cause and remedy, which the shim logs."""
    with open(os.path.join(resources, "python.json"), encoding="utf-8") as file:
        record = json.load(file)
    flags = {"logging_on": bool(logging_on), "event_mode": bool(event_mode), "early_return": bool(early_return)}
    return _embedded(record).create(interface, name, token, resources, log, *updates, **flags)


def _embedded(record):  # type: ignore[no-untyped-def]
    wanted, here = record["version"], f"{sys.version_info[0]}.{sys.version_info[1]}"
    try:
        return importlib.import_module("tlismni.fmu_wrapper.embedded")
    except ImportError:
        if wanted != here:
            raise ImportError(
                f"the host process runs Python {here} ({sys.prefix}) without tlismni, and the FMU was exported "
                f"for Python {wanted} ({record['prefix']}): install tlismni=={record['tlismni']} into the "
                "host's Python, or export the FMU with it"
            ) from None
    for folder in record["folders"]:
        if folder not in sys.path:
            site.addsitedir(folder)  # honours the .pth file of an editable install, which an entry would not
    importlib.invalidate_caches()
    try:
        return importlib.import_module("tlismni.fmu_wrapper.embedded")
    except ImportError as error:
        raise ImportError(
            f"{error}; this FMU needs tlismni=={record['tlismni']} and was exported with the Python in "
            f"{record['prefix']} (folders {record['folders']}): install tlismni into Python {here} "
            f"({sys.prefix}), or export the FMU anew on this machine"
        ) from error
