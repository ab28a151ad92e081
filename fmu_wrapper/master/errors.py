"""The errors of the master."""

from collections.abc import Iterable
from difflib import get_close_matches

from ..errors import FmuError


class MasterError(FmuError):
    """A system description that does not fit its instances, or a run of coupled instances that failed."""


class CouplingError(MasterError):
    """An iteration between the instances does not converge, or an output is not finite. A variable step is tried anew
    with a smaller one."""


def near(wanted: str, known: Iterable[str], most: int = 4) -> str:
    """A clause that offers the names nearest to `wanted`."""
    names = list(known)
    # what stands after the last dot is often right where the rest is not
    tail = wanted.rpartition(".")[2]
    found = get_close_matches(wanted, names, most, 0.5) or [name for name in names if name.endswith(tail)][:most]
    return f"near it are {found}" if found else f"there are {names[:12]}{' ...' if len(names) > 12 else ''}"
