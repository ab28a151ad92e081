"""The variable table of a slave: names, kinds, roles, units and value references.

Value references are 1, 2, 3, ... in the order of modelDescription.xml: one numbering over all kinds (FMI 3.0 wants
that, FMI 2.0 allows it), in which each is also the variable's index. FMI 2.0 lists dependencies by index and FMI 3.0 by
reference; a master that takes the one for the other (OMSimulator does) finds the same variable. The order is

    time; `solver.method`, `.rtol`, `.atol`, `.step` and the method's further options, by name: parameters
    `solver.events`, an output
    the parameters of the scenario, if the model comes from one, in its order; the model's others, in its order
    the contacts' laws (`CONTACT.law`), constants, in the order of the model
    the model's inputs, in the order of the model
    the channels, in the order of `Simulation.channels`
    arrays of channels (FMI 3.0), which hold no values of their own

so a reference belongs to one FMU and not to a model: masters look names up.
"""

from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from .arrays import arrays_of
from .errors import ExportError, FmuValueError

Kind = Literal["real", "integer", "boolean", "string"]
Role = Literal["independent", "parameter", "input", "output", "constant"]
Block = Literal["time", "solver", "figure", "law", "scenario", "parameter", "input", "channel"]

KINDS: tuple[Kind, ...] = ("real", "integer", "boolean", "string")
EVENTS = "solver.events"
TIME = "time"
PLANS_KEPT = 256  # a master asks for the same few lists of references over and over


@dataclass(frozen=True)
class Variable:
    """One variable of the slave. `block` says where its value lives, `start` is None for outputs and time.

    Of an integer that is a choice, `enumeration` names the type and `items` the values 0, 1, ...; `nominal` is a
    typical magnitude, None for 1.
    """

    reference: int
    name: str
    kind: Kind
    role: Role
    block: Block
    unit: str | None = None
    description: str = ""
    start: float | int | bool | str | None = None
    minimum: float | None = None
    maximum: float | None = None
    enumeration: str | None = None
    items: tuple[str, ...] = ()
    nominal: float | None = None

    def item(self, value: Any) -> str:
        """Name of the value `value` of an enumeration."""
        return self.items[int(value)]


@dataclass(frozen=True)
class Plan:
    """A list of value references, looked up: their variables, positions among their kind, roles, and whether they are
    enumerations."""

    variables: tuple[Variable, ...]
    positions: npt.NDArray[np.intp]
    roles: frozenset[Role]
    enumerations: frozenset[bool]
    unbounded: bool
    """Whether all are reals that may take any finite value."""


class VariableTable:
    """All variables of a slave, found by reference and by name.

    Raises
    ------
    FmuValueError : if two variables have one name.
    """

    def __init__(self, variables: Iterable[Variable]) -> None:
        self.variables = tuple(variables)
        self.by_reference = {v.reference: v for v in self.variables}
        self.by_name = {v.name: v for v in self.variables}
        if len(self.by_name) != len(self.variables):
            names = [v.name for v in self.variables]
            twice = sorted({n for n in names if names.count(n) > 1})
            raise FmuValueError(
                f"the variables {twice} would exist twice in the FMU (model parameters, inputs and channels "
                "share one list of names): rename them in the model"
            )
        self.of_kind: dict[Kind, tuple[Variable, ...]] = {
            kind: tuple(v for v in self.variables if v.kind == kind) for kind in KINDS
        }
        self.position = {v.reference: i for kind in KINDS for i, v in enumerate(self.of_kind[kind])}
        self.outputs: dict[Kind, npt.NDArray[np.intp]] = {
            kind: np.array([i for i, v in enumerate(self.of_kind[kind]) if v.role == "output"], dtype=np.intp)
            for kind in KINDS
        }
        """Positions of the outputs among their kind."""
        self.arrays = arrays_of(self.variables, len(self.variables) + 1)
        self._elements = {array.reference: array.elements for array in self.arrays}
        self._plans: dict[tuple[Kind, bytes], Plan] = {}

    def block(self, block: Block) -> list[Variable]:
        """The variables of one block, in the order of their references."""
        return [v for v in self.variables if v.block == block]

    def of_role(self, role: Role) -> list[Variable]:
        """The variables of one role, in the order of their references."""
        return [v for v in self.variables if v.role == role]

    def plan(self, kind: Kind, references: npt.NDArray[np.uint32]) -> Plan:
        """Where the variables of `kind` behind `references` are.

        Raises
        ------
        FmuValueError : for a reference that no variable of this kind has.
        """
        key = (kind, references.tobytes())
        plan = self._plans.get(key)
        if plan is None:
            variables = tuple(v for r in references for v in self._find(kind, int(r)))
            positions = np.array([self.position[v.reference] for v in variables], dtype=np.intp)
            enumerations = frozenset(v.enumeration is not None for v in variables)
            unbounded = kind == "real" and all(
                v.minimum is None and v.maximum is None and v.block != "solver" for v in variables
            )
            plan = Plan(variables, positions, frozenset(v.role for v in variables), enumerations, unbounded)
            if len(self._plans) >= PLANS_KEPT:
                self._plans.clear()
            self._plans[key] = plan
        return plan

    def _find(self, kind: Kind, reference: int) -> tuple[Variable, ...]:
        """The variable, or the elements of the array."""
        if kind == "real" and reference in self._elements:
            return self._elements[reference]
        variable = self.by_reference.get(reference)
        if variable is None:
            raise FmuValueError(
                f"value reference {reference} is unknown: this FMU has {len(self.of_kind[kind])} {kind} "
                "variables, their references stand in modelDescription.xml"
            )
        if variable.kind != kind:
            own = variable.kind if variable.enumeration is None else "enumeration"
            how = own if variable.enumeration is None else "Integer (FMI 2.0) or Int64 (FMI 3.0)"
            raise FmuValueError(
                f"value reference {reference} is '{variable.name}', which is of kind {own}, not "
                f"{kind}: use the get and set functions for {how}"
            )
        return (variable,)

    def to_data(self) -> list[dict[str, Any]]:
        """The table as JSON data."""
        return [asdict(v) for v in self.variables]

    @classmethod
    def from_data(cls, data: Iterable[Mapping[str, Any]]) -> "VariableTable":
        """The table in JSON data made by `to_data`.

        Raises
        ------
        ExportError : if references are not indices, as they were in earlier versions.
        """
        table = cls(Variable(**{**record, "items": tuple(record["items"])}) for record in data)
        if [v.reference for v in table.variables] != list(range(1, len(table.variables) + 1)):
            raise ExportError(
                "the value references in this FMU are not 1, 2, 3, ...: another version of tlismni wrote it, or its "
                "resources were changed; export the FMU anew"
            )
        return table


def kind_of(value: object) -> Kind | None:
    """The kind of variable that holds `value`, or None if there is none."""
    if isinstance(value, bool | np.bool_):
        return "boolean"
    if isinstance(value, int | np.integer):
        return "integer"
    if isinstance(value, float | np.floating):
        return "real"
    return "string" if isinstance(value, str) else None
