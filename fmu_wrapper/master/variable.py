"""What the master knows of a variable, from an FMU's description or a slave's table."""

from dataclasses import dataclass
from typing import Any

from ..variables import Variable as SlaveVariable

KIND_OF_TYPE = {
    "2.0": {"Real": "Real", "Integer": "Integer", "Enumeration": "Integer", "Boolean": "Boolean", "String": "String"},
    "3.0": {
        **{name: name for name in ("Float64", "Float32", "Boolean", "String")},
        **{f"{sign}Int{bits}": f"{sign}Int{bits}" for sign in ("", "U") for bits in (8, 16, 32, 64)},
        "Enumeration": "Int64",
    },
}
"""By FMI version and type of a variable, the word in fmpy's get and set methods."""
REAL = ("Real", "Float64")
"""Kinds that are coupled."""
SLAVE_KINDS = {
    "2.0": {"real": "Real", "integer": "Integer", "boolean": "Boolean", "string": "String"},
    "3.0": {"real": "Float64", "integer": "Int32", "boolean": "Boolean", "string": "String"},
}


@dataclass(frozen=True)
class Variable:
    """One scalar variable. `derivative_of` names the variable whose derivative in time it is."""

    name: str
    reference: int
    kind: str
    causality: str
    unit: str | None = None
    description: str = ""
    derivative_of: str | None = None

    @property
    def is_real(self) -> bool:
        return self.kind in REAL


def of_description(description: Any) -> dict[str, Variable]:
    """The scalar variables in a model description read by fmpy, by name."""
    kinds = KIND_OF_TYPE[description.fmiVersion]
    return {
        v.name: Variable(
            v.name, v.valueReference, kinds[v.type], v.causality or "local", v.unit, v.description or "",
            v.derivative.name if getattr(v, "derivative", None) is not None else None,
        )
        for v in description.modelVariables
        if v.type in kinds and not v.dimensions
    }  # fmt: skip


def of_slave(variables: tuple[SlaveVariable, ...], version: str) -> dict[str, Variable]:
    """The variables in a slave's table, by name."""
    kinds = SLAVE_KINDS[version]
    return {
        v.name: Variable(
            v.name, v.reference, "Int64" if v.enumeration and version == "3.0" else kinds[v.kind], v.role, v.unit,
            v.description,
        )
        for v in variables
    }  # fmt: skip
