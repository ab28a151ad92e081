"""exudyn, imported only when it is needed, with a clear message where it is not there."""

import importlib
import warnings
from dataclasses import dataclass
from types import ModuleType

from .errors import ExudynUnavailable

VERSIONS = "1.13"
"""exudyn renames its interface between minor versions; the translation is written for this one."""


@dataclass(frozen=True)
class Exudyn:
    """The two modules that the translation needs."""

    core: ModuleType
    items: ModuleType
    version: str


def import_exudyn() -> Exudyn:
    """exudyn and its item interface.

    Raises
    ------
    ExudynUnavailable : if it is not installed, cannot load a system library, or has another version.
    """
    try:
        core = importlib.import_module("exudyn")
        items = importlib.import_module("exudyn.itemInterface")
    except ImportError as error:
        raise ExudynUnavailable(_remedy(str(error))) from error
    version = str(getattr(core, "__version__", "unknown"))
    if not version.startswith(VERSIONS + "."):
        raise ExudynUnavailable(
            f"exudyn {version} is installed, but the translation needs {VERSIONS}.*: exudyn renames its "
            f"interface between versions. Install it with: pip install 'exudyn=={VERSIONS}.*'"
        )
    # deprecation notes of exudyn concern its own interface, not the user's model
    warnings.filterwarnings("ignore", category=DeprecationWarning, module=r"exudyn(\..*)?")
    return Exudyn(core, items, version)


def exudyn_available() -> bool:
    """True if exudyn can be used."""
    try:
        import_exudyn()
    except ExudynUnavailable:
        return False
    return True


def _remedy(cause: str) -> str:
    if "libGL" in cause:
        return (
            f"exudyn is installed but cannot load a system library ({cause}). It links against OpenGL even "
            "without a display; install it, e.g. on Debian or Ubuntu: apt install libgl1"
        )
    return (
        f"the cross-check needs exudyn, which cannot be imported ({cause}). "
        "Install it with: pip install 'tlismni[validation]'"
    )
