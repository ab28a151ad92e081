"""What the optional parts of an installation must bring."""

from importlib.util import find_spec

from .errors import TlismniError


class MissingExtraError(TlismniError, ImportError):
    """A library that is not part of the plain installation is needed. Says which, and how to get it."""


def require(what: str, extra: str, **modules: str) -> None:
    """Raise MissingExtraError unless the third-party modules that `what` needs can be imported.

    Parameters
    ----------
    extra : of tlismni, that brings them.
    modules : name of the module to name of its package, where they differ; else an empty text.
    """
    missing = [package or module for module, package in modules.items() if find_spec(module) is None]
    if missing:
        raise MissingExtraError(
            f"{what} needs {' and '.join(missing)}, which this Python does not have: pip install 'tlismni[{extra}]'"
        )
