"""Arrays of FMI 3.0: the components of a vector under one name, beside the scalars that they are made of."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from .variables import Variable

VECTORS = {
    "position": ("x", "y"),
    "velocity": ("vx", "vy"),
    "acceleration": ("ax", "ay"),
    "force": ("force_x", "force_y"),
}
"""What a vector of a body, point or joint is called, and its components."""


@dataclass(frozen=True)
class ArrayVariable:
    """A vector output; its elements are variables of their own."""

    reference: int
    name: str
    elements: "tuple[Variable, ...]"


def arrays_of(variables: "Iterable[Variable]", first: int) -> tuple[ArrayVariable, ...]:
    """The vectors among `variables`, with value references from `first` on; none that would take another's name."""
    by_name: Mapping[str, Variable] = {v.name: v for v in variables}
    found: list[ArrayVariable] = []
    for owner in dict.fromkeys(name.rpartition(".")[0] for name in by_name):
        for vector, components in VECTORS.items():
            elements = [by_name.get(f"{owner}.{component}") for component in components]
            name = f"{owner}.{vector}"
            parts = tuple(e for e in elements if e is not None and e.kind == "real" and e.role == "output")
            if owner and name not in by_name and len(parts) == len(components) and len({e.unit for e in parts}) == 1:
                found.append(ArrayVariable(first + len(found), name, parts))
    return tuple(found)
