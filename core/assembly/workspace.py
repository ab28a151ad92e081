"""Workspace: the arrays of one running system and the record through which compiled code reaches them."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..compiled.image import Arrays, Take, twin
from ..compiled.jit import address_of
from ..compiled.kernels import BATCH
from ..compiled.records import ArrayRecord, Record, words_of
from ..compiled.weakly import Weakly
from ..contacts.geometry_kinds import JOINT
from ..linalg import DENSE_LIMIT
from ..linalg.analyze import ANALYZE_SIGNATURE, analyze
from ..linalg.memory import addresses
from ..linalg.record import PROGRAM_LIMIT
from ..state.method_records import MAX_NODES
from ..state.workspace_records import (
    BUILDING,
    CONTROL_SIZE,
    COUNTERS_SIZE,
    COUPLED_STAGES,
    ENGAGE_SIGNATURE,
    EVALUATE_SIGNATURE,
    OK,
    SCRATCH_SIZE,
    SPIN_SIZE,
    STRUCTURE,
    WORKSPACE,
    convergence_of,
)
from .assembly import Assembly
from .building import engage_wanted
from .evaluate import all_kernels
from .joint_compliance import joint_compliance
from .numbers import constraints_are_cheap, given_compliance, level_scale, release, sticking
from .partition_building import partition_wanted
from .patterns import FEW, entries_of_few, patterns, shows
from .slots import MOST_STRUCTURES, Slots
from .state_fields import STATE_ARRAYS, Field, row_length, state_fields
from .structure import OF_PARTITION, OF_STRUCTURE, Structure
from .structure_switch import Key, codes_of

_SHARED = (
    "q", "v", "a", "lam", "r", "phi", "phid", "phidd", "values", "coef", "inputs", "energy", "monitor", "memory",
    "sleeping",
)  # fmt: skip

_OF_NOW = (*OF_STRUCTURE, *OF_PARTITION)
"""Arrays of the present structure and partition."""
_NEVER_CHANGES = (*_OF_NOW, "kernels", "contact_rows", "contact_slide_rows", "contact_second_rows", "contact_companion")
"""Arrays that runs may share: others take their place, but nobody writes into them."""

_OF_BUILDING = ("left_out", "units", "compliance", "mechanism")
"""Arrays of the record of the building of structures."""
_STRUCTURE, _SERIAL = words_of(WORKSPACE)["structure"], words_of(STRUCTURE)["serial"]
FEW_CONTACTS = FEW
"""Contacts up to which there is room from the start for the structure of all of them."""
MOST_WORDS = 200_000
"""About so many numbers all places together have."""
MOST_STAGES = 13
"""Stages of a Runge-Kutta formula that there is room for."""


def most_places(assembly: Assembly) -> int:
    """How many structures there are places for."""
    states, size = 1, 4 * sum(entries_of_few(assembly, FEW_CONTACTS))
    for contact in assembly.contacts:
        states = min(states * (2 + contact.tangents), MOST_STRUCTURES)
    # the present one, the one to come back to, and one to build
    return max(min(states + 1, MOST_STRUCTURES, MOST_WORDS // max(size, 1)), 3)


def all_tangents(assembly: Assembly) -> frozenset[int]:
    """What `engage` takes for contacts that all stick."""
    slides = [k for k, contact in enumerate(assembly.contacts) if contact.slide_row >= 0]
    both = [k + len(assembly.contacts) for k in slides if assembly.contacts[k].tangents > 1]
    return frozenset([*slides, *both])


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
        arrays: dict[str, NDArray[Any]] = {name: self.state[name][0] for name in STATE_ARRAYS}
        arrays |= {name: np.zeros(n_ext) for name in (
            "r", "q_star", "v_star", "base_q", "base_v", "base_a", "weight_q", "weight_v", "offset",
        )}  # fmt: skip
        arrays |= {name: np.zeros(m_ext) for name in ("phi", "phid", "phidd")}
        arrays |= {
            "counters": np.zeros(COUNTERS_SIZE, dtype=np.int64),  # statistics: they decide nothing
            "values": np.zeros(1),
            "coef": np.zeros(2),
            "energy": np.zeros(3),
            "monitor": np.zeros(3 * max(contacts, 1)),
            "signals": a.signals.copy(),
            "kernels": np.array([b.address for b in a.batches], dtype=np.int64),
            "batches": np.zeros(len(a.batches), dtype=np.int64),
            "contact_rows": np.array([c.row for c in a.contacts], dtype=np.int64),
            "contact_slide_rows": np.array([c.slide_row for c in a.contacts], dtype=np.int64),
            "contact_second_rows": np.array([c.second_row for c in a.contacts], dtype=np.int64),
            "contact_companion": np.array([c.companion for c in a.contacts], dtype=np.int64),
            "contact_sticking": sticking(a),
            "contact_release": np.array([release(c.law) for c in a.contacts], dtype=np.int64),
            "sleeping": np.zeros(max(contacts, 1), dtype=np.int64),
            "looked": np.array([contacts, *range(contacts)], dtype=np.int64),
            "probe": np.zeros(0),
            **{
                name: np.zeros(0, dtype=np.int64)
                for name in (*OF_PARTITION, *OF_STRUCTURE)
                if name not in ("values", "probe")
            },
            "wanted": np.zeros(max(contacts, 1), dtype=np.int64),
            "wanted_dependent": np.zeros(a.n + m_ext, dtype=np.int64),
            "stage_v": np.zeros(MOST_STAGES * n_ext),
            "stage_a": np.zeros(MOST_STAGES * n_ext + m_ext),
            "stage_rows": np.zeros(COUPLED_STAGES * row_length(a)),
            "rhs": np.zeros(a.n + a.m),
            "scale": a.coordinate_scale.copy(),
            "row_scale": np.ones(m_ext),
            "work_scale": np.ones(n_ext),
            "level_scale": level_scale(a),
            "scratch": np.zeros(SCRATCH_SIZE),
            "query_kept": np.zeros(2 * (a.n + m_ext)),
            "basis": np.zeros((1, n_ext)),
            "attitudes": a.attitudes,
            "attitude_bodies": a.attitude_bodies,
            "spinning": np.zeros(len(a.attitudes), dtype=np.int64),
            "spin": np.zeros((max(len(a.attitudes), 1), SPIN_SIZE)),
            "turned": np.zeros((MAX_NODES, row_length(a)) if len(a.attitudes) else 1),
            "atol_q": np.zeros(n_ext),
            "atol_v": np.zeros(n_ext),
            "control": np.zeros(CONTROL_SIZE),
        }
        convergence_of(arrays["rate"]).factor_age = -1.0
        arrays["inputs"][: len(a.input_start), 0] = a.input_start
        self._shapes = [(*b.coord.shape, b.row.shape[1] if b.row.size else 0) for b in a.batches]
        sparse = addresses(a.n + a.m > DENSE_LIMIT)
        self.slots = Slots(most_places(a), sparse, PROGRAM_LIMIT, len(self._shapes))
        arrays["units"] = np.ones(a.n + m_ext)  # of coordinates (with forces) and rows of Phi (with multipliers)
        arrays["left_out"] = np.zeros(m_ext, dtype=np.int64)
        arrays["compliance"] = given_compliance(a)
        arrays["mechanism"] = np.zeros(m_ext, dtype=np.int64)
        self._building = self._make_building(arrays)
        self._dropped_before: dict[frozenset[int], int] = {frozenset(): 0}
        self._views: dict[int, Structure] = {}
        self.dropped: frozenset[int] = frozenset()
        self.arrays: Any = arrays
        self._make_batches: Callable[[], list[ArrayRecord]] = list
        self._made_batches: list[ArrayRecord] | None = [self._batch(k) for k in range(len(a.batches))]
        arrays["batches"][:] = [batch.address for batch in self._batches]
        record_arrays = {k: v for k, v in arrays.items() if k not in ("signals", *_OF_BUILDING)}
        self._record = ArrayRecord(
            WORKSPACE,
            record_arrays,
            {
                "n": a.n, "n_ext": n_ext, "m_ext": m_ext, "m_act": 0, "m_held": 0, "n_implied": 0,
                "n_redundant": 0, "n_free": 0, "n_mass": 0, "n_kernels": len(a.batches), "n_values": 1,
                "n_basis": 1, "n_contacts": contacts,
                "n_slots": a.n_slots, "n_work": len(a.work_names), "structure": 0, "kept": 0,
                "building": self._building.address, "engage": address_of(engage_wanted, ENGAGE_SIGNATURE),
                "row_length": row_length(a), "part_first": int(constraints_are_cheap(a)),
                "stage_function": 0, "plain_stage": 0, "n_attitudes": 0, "n_spins": 0,
                "analyze": address_of(analyze, ANALYZE_SIGNATURE),
                "evaluate_function": address_of(all_kernels, EVALUATE_SIGNATURE),
                "kkt": 0, "lu_d": 0, "lu_p": 0, "kkt_query": 0,
            },
        )  # fmt: skip
        self.arrays = Arrays(arrays, Weakly(self._of_now))
        self.arrays.update({name: x for name, x in arrays.items() if name not in _OF_NOW})
        self._structure: Structure | None = None
        if 0 < contacts <= FEW_CONTACTS:
            # the largest structure first: from then on there is room for all
            self.engage(frozenset(range(contacts)), frozenset(), all_tangents(a))
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
            own += [
                batch.arrays[name]
                for name in ("par", "shown", *(("coord",) if self.assembly.pool is not None else ()))
                if name in batch.arrays
            ]
        arrays, tables, _ = self.slots.memory()
        records = [
            self._record.words, self._building.words, *(batch.words for batch in self._batches), self.arrays["batches"],
        ]  # fmt: skip
        return [*own, *arrays], [*records, *tables]

    def blank(self) -> list[NDArray[Any]]:
        """Own memory whose content a copy need not have."""
        return self.slots.memory()[2]

    def moved(self, take: Take) -> "Workspace":
        """The same workspace in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        new.state, new.state_bytes = take(self.state), take(self.state_bytes)
        new._record, new._building = self._record.moved(take), self._building.moved(take)
        batches, arrays, of_now = self._batches, self.arrays, Weakly(new._of_now)
        new._made_batches, new._make_batches = None, lambda: [batch.moved(take) for batch in batches]
        new.arrays = Arrays(arrays.names, lambda name: of_now(name) if name in _OF_NOW else take(arrays[name]))
        new.slots = self.slots.moved(take)
        new._dropped_before, new._views, new._structure = dict(self._dropped_before), {}, None
        return new

    @property
    def _batches(self) -> list[ArrayRecord]:
        if self._made_batches is None:
            self._made_batches = self._make_batches()
        return self._made_batches

    def _of_now(self, name: str) -> NDArray[Any]:
        """An array of the present structure or partition."""
        if name in OF_STRUCTURE:
            return self.structure.arrays[name]
        present = self.structure.present
        return np.zeros(0, dtype=np.int64) if present is None else present.array(name)

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
        arrays["compliance"][:] = given_compliance(assembly)
        if self.dropped:
            self._take_compliance()

    @property
    def record(self) -> Record:
        """The workspace record."""
        return self._record.record

    @property
    def address(self) -> int:
        """Address of the record."""
        return self._record.address

    def use_stage(self, address: int, corotating: int = 0) -> None:
        """Let steps solve their stages with the function at `address` (STAGE_SIGNATURE). That at `corotating`, if not
        0, calls it for models with bodies that turn in space, whose attitudes are in turning frames then."""
        attitudes = len(self.assembly.attitudes) if corotating else 0
        self._record.set_size("plain_stage", address)
        self._record.set_size("n_attitudes", attitudes)
        self._record.set_size("stage_function", corotating if attitudes else address)

    def make_basis(self, count: int) -> None:
        """Room for `count` vectors of an accelerated or Krylov outer loop."""
        self._set("basis", np.zeros((count, self.assembly.n_extended)), n_basis=count)

    def _make_building(self, arrays: dict[str, NDArray[Any]]) -> ArrayRecord:
        a, slots = self.assembly, self.slots
        replaced = [(row, k) for row, contacts in a.replaced_rows.items() for k in sorted(contacts)]
        rows, contacts = (np.array([pair[x] for pair in replaced], dtype=np.int64) for x in (0, 1))
        return ArrayRecord(
            BUILDING,
            {
                **patterns(a), "replaced_row": rows, "replaced_contact": contacts,
                **{name: arrays[name] for name in (
                    *_OF_BUILDING, "contact_rows", "contact_slide_rows", "contact_second_rows",
                )},
                "rate_rows": np.array([int(row in a.rate_rows) for row in range(a.m + 1)], dtype=np.int64),
                "needs": slots.needs, "structures": slots.addresses,
            },
            {
                "n": a.n, "m": a.m, "m_joints": a.m_joints, "m_ext": a.m + 1, "n_contacts": len(a.contacts),
                "n_kernels": len(a.batches), "n_replaced": len(rows),
                "two_partitions": int(bool(a.rate_rows)), "loads_felt": int(any(c.kind == JOINT for c in a.contacts)),
                "dropped": 0, "dense_limit": DENSE_LIMIT, "scratch": slots.scratch.cell.ctypes.data,
                "n_slots": len(slots.structures), "serial": 0,
            },
        )  # fmt: skip

    def _batch(self, k: int) -> ArrayRecord:
        batch, a = self.assembly.batches[k], self.arrays
        count, width = batch.coord.shape
        rows = batch.row.shape[1] if batch.row.size else 0
        list_of_shown = {"shown": np.array([count, *range(count)], dtype=np.int64)} if shows(self.assembly, k) else {}
        return ArrayRecord(
            BATCH,
            {
                "par": batch.par, "coord": batch.coord, "row": batch.row, "extra": batch.extra,
                # those of the present structure
                **{name: np.zeros(0, dtype=np.int64) for name in ("slot_s", "slot_j", "slot_jt", "line")},
                **list_of_shown,
                "signals": a["signals"],
                **{name: a[name] for name in _SHARED},
            },
            {
                **({} if list_of_shown else {"shown": 0}),
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

    def engage(
        self,
        closed: frozenset[int],
        engaged: frozenset[int],
        sticking: frozenset[int] = frozenset(),
        implied: frozenset[int] = frozenset(),
    ) -> None:
        """Make contacts `closed` constraints, along the tangent too if they are `sticking`, and give all `engaged` ones
        a place in the matrix; `implied` rows, as `switch.codes_of` takes them, are not solved for."""
        self.arrays["wanted"][:] = codes_of(len(self.assembly.contacts), closed, closed | engaged, sticking, implied)
        self.engage_wanted()

    def engage_wanted(self) -> None:
        """Take the structure that compiled code has asked for last (`structure_switch.py`)."""
        while int(engage_wanted(self.record)) != OK:
            self.give_room()
        self._see_structure()

    def give_room(self) -> None:
        """More memory for structures, as compiled code has asked for it."""
        records = [self._record.words, *(batch.words for batch in self._batches)]
        if self.slots.grow(records):
            self._views.clear()
            if self.record.word(_STRUCTURE):
                self._see_structure()

    def keep_slots(self, count: int) -> None:
        """Have so few places for structures from now on, of which one is that of the present structure."""
        self.slots.keep(count, self.record.word(_STRUCTURE))
        self._building.set_array("structures", self.slots.addresses)
        self._building.set_size("n_slots", count)
        self._views.clear()
        self._record.set_size("structure", 0)
        self.engage(*self.key)

    def _see_structure(self) -> None:
        """Look at the structure that the record has now."""
        address = self.record.word(_STRUCTURE)
        seen = self._views.get(address)
        if seen is None or seen.serial != seen.record.word(_SERIAL):
            two = bool(self.assembly.rate_rows)
            seen = self._views[address] = Structure(self.slots, address, self._shapes, two, Weakly(self.give_room))
        self._structure, self._partition = seen, seen.present
        self._forget_arrays(_OF_NOW)

    def _forget_arrays(self, names: tuple[str, ...]) -> None:
        for name in names:
            self.arrays.pop(name, None)

    @property
    def structure(self) -> Structure:
        """The present structure, as of the last `sync`."""
        if self._structure is None:
            self._see_structure()
        return self._structure  # type: ignore[return-value]

    @property
    def key(self) -> Key:
        """Its contacts: closed, engaged, sticking; and the rows that others imply."""
        return self.structure.key

    def sync(self) -> None:
        """Take over what compiled code has chosen: structure and partition."""
        structure = self._structure
        if structure is None:
            return  # nobody has looked yet
        if self.record.word(_STRUCTURE) != structure.address or structure.record.word(_SERIAL) != structure.serial:
            self._see_structure()
        elif (present := structure.present) is not self._partition:
            self._partition = present
            self._forget_arrays(OF_PARTITION)

    def _take_compliance(self) -> None:
        self.arrays["compliance"][:], self.arrays["mechanism"][:] = joint_compliance(self.assembly)

    def sharing_size(
        self, dropped: frozenset[int], closed: frozenset[int], sticking: frozenset[int], implied: frozenset[int]
    ) -> tuple[int, int]:
        """How many rows are implied if the rows `dropped` of joints are left out and these contacts are closed, stick
        and are implied (`structure_switch.key_of`), and how many numbers the rows of compatibility have."""
        replaced = {row for row, contacts in self.assembly.replaced_rows.items() if contacts & closed}
        left_out = dropped - replaced
        by_contacts = len(implied) * (len(closed) + len(sticking))
        if not left_out:
            return len(implied), by_contacts
        if self.dropped:
            compliance, mechanism = self.arrays["compliance"], self.arrays["mechanism"]
        else:
            compliance, mechanism = joint_compliance(self.assembly)
        of_joints = np.arange(self.assembly.m_joints)
        shares = (compliance[of_joints] > 0.0) & ~np.isin(of_joints, sorted(replaced))
        by_joints = sum(
            int(np.sum((shares & (mechanism[of_joints] == mechanism[row])) | (of_joints == row))) for row in left_out
        )
        return len(implied) + len(left_out), by_contacts + by_joints

    def drop(self, rows: frozenset[int]) -> None:
        """Leave the redundant `rows` of joints out of the equations; they share the load with those that imply them."""
        if rows == self.dropped:
            return
        if not self.dropped:
            self._take_compliance()
        self.dropped = rows
        flags = self.arrays["left_out"]
        flags[:] = 0
        flags[sorted(rows)] = 1
        self._building.set_size("dropped", self._dropped_before.setdefault(rows, len(self._dropped_before)))
        self.arrays["lam"][sorted(rows)] = 0.0
        self.engage(*self.key)

    def set_probe(self, probe: NDArray[np.float64]) -> None:
        """Right-hand side (m_act,) with which the condition of the constraints is measured."""
        self.structure.arrays["probe"][:] = probe

    def set_partition(self, dependent: NDArray[np.int64]) -> None:
        """Choose the dependent coordinates of the present structure."""
        self.arrays["wanted_dependent"][: len(dependent)] = dependent
        partition_wanted(self.record)
        partition = self.structure.present
        if partition is None:
            raise RuntimeError("a structure has a partition once one was chosen")
        self._partition = partition
        self._forget_arrays(OF_PARTITION)

    def _set(self, name: str, array: NDArray[Any], **sizes: int) -> None:
        arrays = self.arrays = self.arrays.copy()  # in the old ones copies of this may look for arrays later
        arrays[name] = array
        self._record.set_array(name, array)
        for size, value in sizes.items():
            self._record.set_size(size, value)

    def jacobian(self) -> tuple[NDArray[np.int64], NDArray[np.int64], NDArray[np.float64]]:
        """Rows (of the active constraints), columns and values of Phi_q as last evaluated."""
        structure = self.structure
        return structure.jacobian_row, structure.jacobian_col, self.arrays["values"][structure.jacobian_slot]
