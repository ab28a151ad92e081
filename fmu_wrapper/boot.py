"""First Python code of an FMU: the C shim runs this file, from the FMU's resources, in a private namespace.

Only the standard library may be imported here before `tlismni` is found. `sys.path` grows only in a process whose
Python lacks packages that the FMU needs, once: by those of the Python that TLISMNI_PYTHON names, else by the folders
recorded at export.

Instances may be made by several threads at once, and by several FMUs: one lock for the whole process, which all of them
find in `sys`, lets one import at a time. Otherwise one would import while `sys.path` grows for another, and could meet
half of each environment.
"""

import _thread  # built in, as sys is: no path is searched before the lock is held
import sys

LOCK = vars(sys).setdefault("_tlismni_boot", _thread.RLock())

with LOCK:
    import hashlib
    import importlib
    import importlib.machinery
    import importlib.metadata
    import importlib.util
    import json
    import os
    import re
    import shutil
    import site
    import tempfile
    import zipfile


def create(interface, name, token, resources, logging_on, log, event_mode, early_return, own, *updates):  # type: ignore[no-untyped-def]
    """The calls object of a new instance. Raises with cause and remedy, which the shim logs.

    `own` says that the shim has started Python: then its paths belong to the FMUs alone.
    """
    record = _record(os.path.join(resources, "python.json"))
    flags = {"logging_on": bool(logging_on), "event_mode": bool(event_mode), "early_return": bool(early_return)}
    try:
        with LOCK:
            embedded = _bundled(record, resources, own) if record.get("bundle") else _installed(record, own)
        return embedded.create(interface, name, token, resources, log, *updates, **flags)
    except Exception as error:
        # a package that is too old fails in ways of its own, on import or later
        _refuse_missing(record, f" ({type(error).__name__}: {error})")
        raise


def _record(path):  # type: ignore[no-untyped-def]
    """What the export has written of its Python."""
    with open(path, encoding="utf-8") as file:
        try:
            record = json.load(file)
        except (ValueError, RecursionError) as error:
            raise ImportError(f"'{path}' is no JSON: {error}; unzip or export the FMU anew") from None
    needed = {"version": str, "prefix": str, "tlismni": str, "folders": list, "requires": list}
    for name, kind in needed.items():
        if not isinstance(record, dict) or not isinstance(record.get(name), kind):
            raise ImportError(f"'{name}' in '{path}' is missing or broken: unzip or export the FMU anew")
    if not all(isinstance(x, list) and len(x) == 2 and all(isinstance(y, str) for y in x) for x in record["requires"]):
        raise ImportError(f"'requires' in '{path}' is broken: unzip or export the FMU anew")
    return record


def _installed(record, own):  # type: ignore[no-untyped-def]
    """The `tlismni` of this Python, or of the one recorded."""
    name = "tlismni.fmu_wrapper.embedded"
    if name in sys.modules:
        return sys.modules[name]
    if own and os.environ.get("TLISMNI_PYTHON"):
        _extend(record, own)
    try:
        return importlib.import_module(name)
    except ImportError:
        pass
    _extend(record, own)
    try:
        return importlib.import_module(name)
    except ImportError as error:
        if not (error.name or "").startswith("tlismni"):
            _refuse_missing(record)
        needed = f"tlismni=={record['tlismni']}"
        raise ImportError(
            f"{error}; this FMU needs {needed}, which {_here()} has not, and was exported with Python "
            f"{record['version']} in {record['prefix']}: {_remedy(needed)}"
        ) from error


def _bundled(record, resources, own):  # type: ignore[no-untyped-def]
    """The package that the FMU carries along, under a name of its own: nothing meets an installed `tlismni`."""
    digest = record["bundle"]
    package = f"tlismni_{digest}"
    name = f"{package}.fmu_wrapper.embedded"
    if name in sys.modules:
        return sys.modules[name]
    if _missing(record) or (own and os.environ.get("TLISMNI_PYTHON")):
        _extend(record, own)
        _refuse_missing(record)
    if package not in sys.modules:
        spec = importlib.machinery.ModuleSpec(package, None, is_package=True)
        spec.submodule_search_locations = [_unpack(os.path.join(resources, "tlismni.zip"), digest)]
        sys.modules[package] = importlib.util.module_from_spec(spec)
    return importlib.import_module(name)


# where packages are


def _extend(record, own):  # type: ignore[no-untyped-def]
    """Let `sys.path` lead to the packages of the Python that was named, or of the one recorded."""
    program = os.environ.get("TLISMNI_PYTHON") if own else None
    if program:
        folders = _venv_folders(program)
    elif record["version"] == f"{sys.version_info[0]}.{sys.version_info[1]}":
        folders = [folder for folder in record["folders"] if os.path.isdir(folder)]
    else:
        folders = []  # compiled packages of another version do not load
    before = list(sys.path)
    for folder in folders:
        # an entry of sys.path, which PYTHONPATH may have made, does not honour the .pth file of an editable install
        site.addsitedir(folder)
    if own:  # a venv's packages go before those of the Python that it is made from
        added = [entry for entry in sys.path if entry not in before]
        first = next(
            (i for i, entry in enumerate(before) if "site-packages" in entry or "dist-packages" in entry), None
        )
        if added and first is not None:
            # a new list: another thread may be searching the one that there was
            sys.path = [*before[:first], *added, *before[first:]]
    importlib.invalidate_caches()


def _venv_folders(program):  # type: ignore[no-untyped-def]
    """The package folder of the venv that `program` is of; none for another Python, whose own the shim has set up."""
    root = os.path.dirname(os.path.dirname(os.path.abspath(program)))
    if not os.path.isfile(os.path.join(root, "pyvenv.cfg")):
        return []
    version = f"python{sys.version_info[0]}.{sys.version_info[1]}"
    inside = ("Lib", "site-packages") if os.name == "nt" else ("lib", version, "site-packages")
    return [os.path.join(root, *inside)]


def _missing(record):  # type: ignore[no-untyped-def]
    """What third-party packages are lacking or too old, each with what is there."""
    found = []
    for name, least in record["requires"]:
        if importlib.util.find_spec(name) is None:
            found.append((f"{name}>={least}", "missing"))
            continue
        try:
            version = importlib.metadata.version(name)
        except importlib.metadata.PackageNotFoundError:
            continue  # importable, from nobody knows where
        if _numbers(version) < _numbers(least):
            found.append((f"{name}>={least}", f"{version} is installed"))
    return found


def _refuse_missing(record, because=""):  # type: ignore[no-untyped-def]
    missing = _missing(record)
    if missing and because.find("this FMU needs packages") < 0:  # not said yet
        listed = ", ".join(f"{name} ({state})" for name, state in missing)
        remedy = _remedy(" ".join(f"'{name}'" for name, _ in missing))
        raise ImportError(f"this FMU needs packages that {_here()} lacks: {listed}: {remedy}{because}")


def _here():  # type: ignore[no-untyped-def]
    return f"Python {sys.version_info[0]}.{sys.version_info[1]} in {sys.prefix}"


def _remedy(packages):  # type: ignore[no-untyped-def]
    return (
        f"install them there (python -m pip install {packages}), or set the environment variable TLISMNI_PYTHON to the "
        "python executable of an environment that has them; in a host that is a Python itself, install them into that"
    )


def _numbers(version):  # type: ignore[no-untyped-def]
    return tuple(int(n) for n in re.findall(r"\d+", version.split("+")[0])[:3])


# the package that the FMU carries along


def _unpack(archive, digest):  # type: ignore[no-untyped-def]
    """Folder with the content of `archive`, named by it: unpacked once for each user, so that code compiled from it
    stays cached. Two processes may come at once: each unpacks for itself, and the first to finish gives its folder the
    final name. Where the user's folder cannot be written it is made beside the archive."""
    with open(archive, "rb") as file:
        data = file.read()
    if hashlib.sha256(data).hexdigest()[:16] != digest:
        raise ImportError(f"'{archive}' is damaged: its content is not what the export wrote; unzip the FMU anew")
    with zipfile.ZipFile(archive) as content:
        problems = []
        users = user_cache()
        for parent in (users and os.path.join(users, "tlismni", "packages"), os.path.dirname(archive)):
            if not parent:
                continue
            folder = os.path.join(parent, f"tlismni_{digest}")
            try:
                if not _complete(folder, content):
                    os.makedirs(parent, exist_ok=True)
                    _unpack_into(folder, content)
                return folder
            except OSError as error:
                problems.append(f"'{parent}': {error.strerror or error}")
    raise ImportError(
        f"the package in the FMU cannot be unpacked ({'; '.join(problems)}): set the environment variable "
        f"{'LOCALAPPDATA' if os.name == 'nt' else 'XDG_CACHE_HOME'} to a folder that can be written"
    )


def _unpack_into(folder, content):  # type: ignore[no-untyped-def]
    mine = tempfile.mkdtemp(prefix="unpacking-", dir=os.path.dirname(folder))
    try:
        content.extractall(mine)
        for info in content.infolist():  # one date for all, as compiled code is cached by name, date and size
            os.utime(os.path.join(mine, info.filename), (946684800, 946684800))
        if os.path.isdir(folder) and not _complete(folder, content):
            os.rename(folder, f"{mine}-old")  # somebody has tidied up in it
        try:
            os.rename(mine, folder)
        except OSError:
            if not _complete(folder, content):  # else another process was faster
                raise
    finally:
        for rest in (mine, f"{mine}-old"):
            shutil.rmtree(rest, ignore_errors=True)


def _complete(folder, content):  # type: ignore[no-untyped-def]
    try:
        return all(
            os.stat(os.path.join(folder, info.filename)).st_size == info.file_size for info in content.infolist()
        )
    except OSError:
        return False


def user_cache():  # type: ignore[no-untyped-def]
    """The user's cache folder by the custom of the platform, as `core.compiled.cache` has it; None if there is none."""
    home = os.path.expanduser("~")
    if sys.platform == "win32":
        found = os.environ.get("LOCALAPPDATA") or os.path.join(home, "AppData", "Local")
    elif sys.platform == "darwin":
        found = os.path.join(home, "Library", "Caches")
    else:  # empty counts as not set, and a relative path is to be ignored (XDG Base Directory Specification)
        found = os.environ.get("XDG_CACHE_HOME", "")
        found = found if os.path.isabs(found) else os.path.join(home, ".cache")
    return found if os.path.isabs(found) else None
