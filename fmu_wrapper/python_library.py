"""Where the shared library of a Python is.

Standard library only: the export imports this file, and copies it into each FMU, where the shim runs it with the Python
that TLISMNI_PYTHON names and reads what it prints.
"""

import os
import sys
import sysconfig


def shared_library():  # type: ignore[no-untyped-def]
    """Path of the shared library of this Python, or None: some builds have none; then only Python hosts load FMUs."""
    for path in _candidates():
        if not path.endswith(".a") and os.path.isfile(path):
            return os.path.realpath(path)
    return None


def _candidates():  # type: ignore[no-untyped-def]
    if os.name == "nt":
        return [os.path.join(sys.base_prefix, f"python{sys.version_info[0]}{sys.version_info[1]}.dll")]
    names = [sysconfig.get_config_var(key) for key in ("INSTSONAME", "LDLIBRARY")]
    libdir = sysconfig.get_config_var("LIBDIR") or ""
    multiarch = sysconfig.get_config_var("MULTIARCH") or ""
    framework = sysconfig.get_config_var("PYTHONFRAMEWORKPREFIX") or ""
    folders = [libdir, os.path.join(libdir, multiarch), os.path.join(sys.base_prefix, "lib"), framework]
    return [os.path.join(folder, name) for name in names if name for folder in folders if folder]


def library_record():  # type: ignore[no-untyped-def]
    """The lines that the shim reads: shared library (or empty line), home, a file of the standard library."""
    return f"{shared_library() or ''}\n{sys.base_prefix}\n{os.__file__}\n"


if __name__ == "__main__":
    sys.stdout.write(library_record())
