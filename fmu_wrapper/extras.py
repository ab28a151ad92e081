"""What the optional parts of an installation must bring."""

from importlib.util import find_spec

from .errors import FmuError


def require(what: str, *modules: str, error: type[FmuError] = FmuError) -> None:
    """Raise `error` unless the third-party `modules` that `what` needs can be imported."""
    missing = [name for name in modules if find_spec(name) is None]
    if missing:
        raise error(
            f"{what} needs {' and '.join(missing)}, which this Python does not have: install the extra `fmu` with "
            "pip install 'tlismni[fmu]'"
        )
