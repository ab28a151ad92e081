"""Workspace: the arrays of one running system and the record through which compiled code reaches them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Take, twin
from ..compiled.jit import address_of
from ..compiled.kernels import BATCH
from ..compiled.records import ArrayRecord, Record, words_of
from ..linalg.analyze import ANALYZE_SIGNATURE, analyze
from ..state.workspace_records import (
    CONDITIONS,
    CONTROL_SIZE,
    COUPLED_STAGES,
    EVALUATE_SIGNATURE,
    FACTOR_AGE,
    WORKSPACE,
)
from .assembly import Assembly
from .evaluate import all_kernels
from .numbers import constraints_are_cheap, level_scale, release, sticking
from .partitions import Partition
from .patterns import MOST_STRUCTURES, Patterns
from .state_fields import STATE, Field, row_length, state_fields
from .structure import Structure
from .switch import key_of, use_partition, use_structure

_SHARED = (
    "q", "v", "a", "lam", "r", "phi", "phid", "phidd", "values", "coef", "inputs", "energy", "monitor", "memory",
    "asleep",
)  # fmt: skip

_OF_STRUCTURE = (
    "values", "probe", "active", "redundant", "gradient_start", "gradient_col", "gradient_slot", "mass_slot",
)  # fmt: skip
_OF_PARTITION = ("dependent", "free_row", "free_col", "free_slot")
_NEVER_CHANGES = (
    *_OF_STRUCTURE, *_OF_PARTITION, "entry_row", "entry_col", "kernels", "contact_rows", "contact_slide_rows", "known",
)  # fmt: skip
"""Arrays that runs may share: others take their place, but nobody writes into them."""

_STRUCTURE = words_of(WORKSPACE)["structure"]
_CONDITIONS = [*CONDITIONS]
MOST_STAGES = 13
"""Stages of a Runge-Kutta formula that there is room for."""


class Workspace:
    """Arrays of one running system. Nothing is shared between two workspaces.

    Attributes
    ----------
    assembly : what it was built from.
    arrays : the arrays by name; `record` is what compiled functions get.
    dropped : redundant rows that are left out of the equations; `drop` changes it.
    structure : the present structure; `engage` changes it.
    state : (1,) one buffer, the arrays that decide the future: those of `state_fields` and `also`, in this order.

    Parameters
    ----------
    also : name, type and shape of what else decides the future: its place is `state[name][0]`.
    """

    def __init__(self, assembly: Assembly, also: Sequence[Field] = ()) -> None:
        self.assembly = assembly
        a = assembly
        n_ext, m_ext, contacts = a.n_extended, a.m + 1, len(a.contacts)
        self.state = np.zeros(1, [*state_fields(a), *also])
        self.state_bytes = self.state.view(np.uint8)  # to copy in one go: numpy copies records field by field
        arrays: dict[str, NDArray[Any]] = {name: self.state[name][0] for name in STATE}
        arrays |= {name: np.zeros(n_ext) for name in (
            "r", "q_star", "v_star", "base_q", "base_v", "base_a", "weight_q", "weight_v", "offset",
        )}  # fmt: skip
        arrays |= {name: np.zeros(m_ext) for name in ("phi", "phid", "phidd")}
        arrays |= {
            "values": np.zeros(1),
            "coef": np.zeros(2),
            "energy": np.zeros(3),
            "monitor": np.zeros(2 * max(contacts, 1)),
            "signals": a.signals.copy(),
            "kernels": np.array([b.address for b in a.batches], dtype=np.int64),
            "batches": np.zeros(len(a.batches), dtype=np.int64),
            "contact_rows": np.array([c.row for c in a.contacts], dtype=np.int64),
            "contact_slide_rows": np.array([c.slide_row for c in a.contacts], dtype=np.int64),
            "contact_sticking": sticking(a),
            "contact_release": np.array([release(c.law) for c in a.contacts], dtype=np.int64),
            "asleep": np.zeros(max(contacts, 1), dtype=np.int64),
            "probe": np.zeros(0),
            **{
                name: np.zeros(0, dtype=np.int64)
                for name in (*_OF_PARTITION, *_OF_STRUCTURE, "entry_row", "entry_col")
                if name not in ("values", "probe")
            },
            "wanted": np.zeros(max(contacts, 1), dtype=np.int64),
            "wanted_dependent": np.zeros(a.n + m_ext, dtype=np.int64),
            "known": np.zeros(MOST_STRUCTURES, dtype=np.int64),
            "stage_v": np.zeros(MOST_STAGES * n_ext),
            "stage_a": np.zeros(MOST_STAGES * n_ext + m_ext),
            "stage_rows": np.zeros(COUPLED_STAGES * row_length(a)),
            "rhs": np.zeros(a.n + a.m),
            "scale": a.coordinate_scale.copy(),
            "row_scale": np.ones(m_ext),
            "work_scale": np.ones(n_ext),
            "level_scale": level_scale(a),
            "scratch": np.zeros(64),
            "basis": np.zeros((1, n_ext)),
            "atol_q": np.zeros(n_ext),
            "atol_v": np.zeros(n_ext),
            "control": np.zeros(CONTROL_SIZE),
        }
        arrays["rate"][FACTOR_AGE] = -1.0
        arrays["inputs"][: len(a.input_start), 0] = a.input_start
        self.patterns = Patterns()
        self.units = np.ones(a.n + m_ext)
        """What brings coordinates (with forces) and rows of Phi (with multipliers) to one unit."""
        self.dropped: frozenset[int] = frozenset()
        self.arrays = arrays
        self._batches = [self._batch(k) for k in range(len(a.batches))]
        arrays["batches"][:] = [batch.address for batch in self._batches]
        record_arrays = {k: v for k, v in arrays.items() if k != "signals"}
        self._record = ArrayRecord(
            WORKSPACE,
            record_arrays,
            {
                "n": a.n, "n_ext": n_ext, "m_ext": m_ext, "m_act": 0, "n_redundant": 0, "n_free": 0, "n_mass": 0,
                "n_kernels": len(a.batches), "n_values": 1, "n_basis": 1, "n_contacts": contacts,
                "n_work": len(a.work_names), "structure": 0, "n_known": 0,
                "row_length": row_length(a), "part_first": int(constraints_are_cheap(a)),
                "stage_function": 0, "analyze": address_of(analyze, ANALYZE_SIGNATURE),
                "evaluate_function": address_of(all_kernels, EVALUATE_SIGNATURE), "kkt": 0, "lu_d": 0, "kkt_query": 0,
            },
        )  # fmt: skip
        self.structure: Structure
        self.engage(frozenset(), frozenset())
        if assembly.bind is not None:
            assembly.bind(self)

    def memory(self) -> tuple[list[NDArray[Any]], list[NDArray[Any]]]:
        """Own arrays, and records of addresses: of the workspace and of its present structure."""
        own = [
            self.state,
            self.state_bytes,
            *(x for name, x in self.arrays.items() if name not in (*_NEVER_CHANGES, "batches")),
        ]
        for batch in self._batches:
            own.append(batch.arrays["par"])
        arrays, tables = self.structure.memory()
        records = [
            self._record.table, *(batch.table for batch in self._batches), self.arrays["batches"], self.arrays["known"]
        ]  # fmt: skip
        return [*own, *arrays], [*records, *tables]

    def moved(self, take: Take) -> "Workspace":
        """The same workspace in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        new.state, new.state_bytes = take(self.state), take(self.state_bytes)
        new._record = self._record.moved(take)
        new._batches = [batch.moved(take) for batch in self._batches]
        new.arrays = {**new._record.arrays, "signals": take(self.arrays["signals"])}
        new.structure = self.structure.moved(take)
        new.patterns = self.patterns.of_copy((*self.key, self.dropped), new.structure)
        new._list_structures()
        new._use(new.structure)
        return new

    def take_numbers(self, assembly: Assembly) -> None:
        """Go on with another assembly of the same tables but for their numbers; before the run starts."""
        self.assembly, arrays = assembly, self.arrays
        for own, batch in zip(self._batches, assembly.batches, strict=True):
            own.arrays["par"][...] = batch.par
        arrays["signals"][:] = assembly.signals
        arrays["contact_sticking"][:] = sticking(assembly)
        arrays["contact_release"][:] = [release(contact.law) for contact in assembly.contacts]
        arrays["scale"][:] = assembly.coordinate_scale
        arrays["level_scale"][:] = level_scale(assembly)
        arrays["inputs"][: len(assembly.input_start), 0] = assembly.input_start

    @property
    def record(self) -> Record:
        """The workspace record."""
        return self._record.record

    @property
    def address(self) -> int:
        """Address of the record."""
        return self._record.address

    def use_stage(self, address: int) -> None:
        """Let steps solve their stages with the function at `address` (STAGE_SIGNATURE)."""
        self._record.table["stage_function"] = address

    def make_basis(self, count: int) -> None:
        """Room for `count` vectors of an accelerated or Krylov outer loop."""
        self._set("basis", np.zeros((count, self.assembly.n_extended)), n_basis=count)

    def _batch(self, k: int) -> ArrayRecord:
        batch, a = self.assembly.batches[k], self.arrays
        count, width = batch.coord.shape
        rows = batch.row.shape[1] if batch.row.size else 0
        return ArrayRecord(
            BATCH,
            {
                "par": batch.par, "coord": batch.coord, "row": batch.row, "extra": batch.extra,
                "slot_s": np.zeros((count, width * width), dtype=np.int64),
                "slot_j": np.zeros((count, max(rows, 1) * width), dtype=np.int64),
                "slot_jt": np.zeros((count, max(rows, 1) * width), dtype=np.int64),
                "signals": a["signals"],
                **{name: a[name] for name in _SHARED},
            },
            {
                "count": count, "npar": batch.par.shape[1], "ncoord": width, "nrow": rows,
                "nextra": batch.extra.shape[1],
                "n_extended": len(a["q"]), "m_extended": len(a["lam"]), "n_values": len(a["values"]),
                "n_inputs": len(a["inputs"]), "n_signals": len(a["signals"]),
                "n_monitor": len(a["monitor"]), "n_memory": len(a["memory"]),
            },
        )  # fmt: skip

    def batch_table(self, k: int) -> NDArray[Any]:
        """The record of batch k, as a structured array (1,)."""
        return self._batches[k].table

    def engage(self, closed: frozenset[int], engaged: frozenset[int], sticking: frozenset[int] = frozenset()) -> None:
        """Make contacts `closed` constraints, along the tangent too if they are `sticking`, and give all `engaged` ones
        a place in the matrix."""
        structure = self.structure_of(closed, closed | engaged, sticking, self.dropped)
        use_structure(self.record, structure.record.address)
        self._use(structure)

    def _use(self, structure: Structure) -> None:
        """Name the arrays of the structure that the record has now."""
        self.structure, self.key = structure, key_of(structure.codes[: len(self.assembly.contacts)])
        named = {name: getattr(structure, name) for name in _OF_STRUCTURE}
        self.arrays |= {**named, "entry_row": structure.rows, "entry_col": structure.cols}
        present = structure.present
        if present is not None:
            self._use_partition(present)

    def _use_partition(self, partition: Partition) -> None:
        row, col, slot = partition.free
        self.arrays |= {"dependent": partition.dependent, "free_row": row, "free_col": col, "free_slot": slot}

    def sync(self) -> None:
        """Take over what compiled code has chosen: structure and partition."""
        address = self.record.word(_STRUCTURE)
        if address != self.structure.record.address:
            self._use(self.patterns.at(address))
        elif (present := self.structure.present) is not None and present.dependent is not self.arrays["dependent"]:
            self._use_partition(present)

    def engage_wanted(self) -> None:
        """Build the structure that compiled code has asked for (`switch.py`) and does not know."""
        self.structure_of(*key_of(self.arrays["wanted"][: len(self.assembly.contacts)]), self.dropped).order_columns()

    def partition_wanted(self) -> None:
        """Build the partition that compiled code has asked for, of the structure that it wanted."""
        key = key_of(self.arrays["wanted"][: len(self.assembly.contacts)])
        structure = self.structure_of(*key, self.dropped)
        structure.know_partition(self.arrays["wanted_dependent"][: len(structure.active)].copy())

    def pivots_wanted(self) -> None:
        """Make what compiled code has asked for to choose pivots."""
        for structure in self.patterns:
            structure.make_wanted()

    def _forget(self) -> None:
        """What is known of the matrices' factors and conditions holds no more."""
        self.arrays["rate"][FACTOR_AGE] = -1.0
        self.arrays["rate"][_CONDITIONS] = 0.0

    def use_units(self, units: NDArray[np.float64]) -> None:
        """Choose pivots with coordinates and rows of Phi brought to one unit by `units` (n + m + 1,)."""
        self.units = units
        for structure in self.patterns:
            structure.use_units(units, self.assembly.n)
        self.arrays["values"][:] = 0.0
        self._forget()

    def structure_of(self, *key: frozenset[int]) -> Structure:
        """The structure with contacts closed, engaged and sticking, and with rows dropped: kept, or built."""
        present = self.structure if self.record.word(_STRUCTURE) else None
        structure, new = self.patterns.get(self.assembly, key, present)
        if structure.units is not self.units:
            structure.use_units(self.units, self.assembly.n)
        if new:
            self._list_structures()
        return structure

    def _list_structures(self) -> None:
        """Say which structures compiled code may choose from: those with the rows that are dropped now."""
        addresses = [structure.record.address for structure in self.patterns.with_dropped(self.dropped)]
        self.arrays["known"][: len(addresses)] = addresses
        self._record.set_size("n_known", len(addresses))

    def drop(self, rows: frozenset[int]) -> None:
        """Leave the redundant `rows` of joints out of the equations; their multipliers are zero."""
        if rows == self.dropped:
            return
        self.dropped = rows
        self._list_structures()
        self.arrays["lam"][sorted(rows)] = 0.0
        self.engage(*self.key)

    def set_probe(self, probe: NDArray[np.float64]) -> None:
        """Right-hand side (m_act,) with which the condition of the constraints is measured."""
        self.structure.probe[:] = probe

    def set_partition(self, dependent: NDArray[np.int64]) -> None:
        """Choose the dependent coordinates of the present structure."""
        self.structure.partition(dependent)
        partition = self.structure.present
        if partition is None:
            raise RuntimeError("a structure has a partition once one was chosen")
        use_partition(self.record, partition.record.address)
        self._use_partition(partition)

    def _set(self, name: str, array: NDArray[Any], **sizes: int) -> None:
        self.arrays[name] = array
        self._record.set_array(name, array)
        for size, value in sizes.items():
            self._record.set_size(size, value)

    def jacobian(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """Rows (of the active constraints), columns and values of Phi_q as last evaluated."""
        structure = self.structure
        return structure.jacobian_row, structure.jacobian_col, self.arrays["values"][structure.jacobian_slot]
