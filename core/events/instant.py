"""What settling the instants of one run works with: the INSTANT record and its memory."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.patterns import entries_of_few
from ..compiled.image import Take, twin
from ..compiled.jit import address_of
from ..compiled.records import BlockRecord
from ..contact_solvers.contact_blocks import SMALL, block_reals, block_wholes
from ..contact_solvers.directions import (
    FARTHEST_SIGNATURE,
    INDEPENDENT_SIGNATURE,
    farthest_directions,
    farthest_size,
    independent_directions,
    independent_size,
)
from ..contact_solvers.friction_cones import friction_cones_size
from ..contact_solvers.least_forces import least_forces_size
from ..contact_solvers.planar_contacts import CALLED, CONES, CONES_SIGNATURE, addresses, solve_cones, work_size
from ..contact_solvers.planar_contacts import PLANAR_VECTORS as VECTORS_OF_CONES
from ..laws import ForceLaw
from ..linalg.small import least_norm_size
from ..state.modes import MEMORY_SIZE
from ..state.workspace_records import COUNTERS_SIZE, RATE_SIZE
from .contact_forces import find_forces
from .delassus import open_touching
from .force_contact import settle_forces
from .friction_rows import keep
from .impact_law import strike
from .impulse_rows import ROW_ROOM, TURNING_ROWS
from .moreau_jean_step import push_apart
from .prepare import use_modes
from .records import (
    INSTANT,
    OF_BLOCKS,
    OF_CONTACTS,
    OF_DECIDED,
    OF_ELIMINATION,
    PART_SIGNATURE,
    SCALARS,
    SOLVER_VECTORS,
    TOUCHING,
)
from .resting import begin_rest
from .row_blocks import opening_reals, opening_wholes
from .zeno import step_through

PARTS = {
    "open_touching": open_touching, "strike": strike, "begin_rest": begin_rest,
    "find_forces": find_forces, "keep": keep, "use_modes": use_modes,
    "settle_forces": settle_forces, "push_apart": push_apart, "step_through": step_through,
}  # fmt: skip
_OTHERS = (
    ("solve_cones", solve_cones, CONES_SIGNATURE),
    ("independent", independent_directions, INDEPENDENT_SIGNATURE),
    ("farthest", farthest_directions, FARTHEST_SIGNATURE),
)
FEW = 8
"""Touching contacts that there is room for at first."""


def _functions(assembly: Assembly) -> dict[str, int]:
    """Addresses of what the record calls; zeros, and nothing to compile, where it never will."""
    parts = [(name, part, PART_SIGNATURE) for name, part in PARTS.items()]
    needed = {name: bool(assembly.contacts) for name, _, _ in (*parts, *_OTHERS)}
    needed["settle_forces"] = any(isinstance(contact.law, ForceLaw) for contact in assembly.contacts)
    needed["use_modes"] = True  # runs start with it
    return {name: address_of(f, signature) if needed[name] else 0 for name, f, signature in (*parts, *_OTHERS)}


class Instant:
    """Scratch for the instants of a run with `assembly`.

    Parameters
    ----------
    most, decided : touching contacts that there is room for, and those for the problem of an instant that is decided at
        once, whose matrices are dense; dimensionless.
    rows_space : numbers in the elimination of the constraints' rows; dimensionless.
    coordinates : that gradients and motions of a contact have in steps of impulses, on average; dimensionless.
    """

    def __init__(
        self, assembly: Assembly, most: int = FEW, decided: int = FEW, rows_space: int = 0, coordinates: int = 0
    ) -> None:
        self._assembly = assembly
        n, n_ext, m, contacts = assembly.n, assembly.n_extended, assembly.m + 1, max(len(assembly.contacts), 1)
        most = self.most = max(min(most, contacts), 1)
        decided = self.decided = max(min(decided, contacts), 1)
        self.coordinates = min(coordinates or SMALL, 2 * n)
        entries = entries_of_few(assembly, most)[1]
        space = self.rows_space = rows_space or 4 * (entries + n)
        # normals and tangents of so many contacts, and torques against turning
        # (on a patch the spin has a row, too)
        every, rows = 3 * decided, (3 + TURNING_ROWS) * most
        work = max(independent_size(every, n), farthest_size(decided), least_norm_size(2 * decided, 2 * decided, 1))
        of_cones = dict.fromkeys(("nn", "nt", "tt"), decided * decided) | dict.fromkeys(VECTORS_OF_CONES, decided)
        self._cones = BlockRecord(
            CONES,
            {**of_cones, "work": work_size(decided)},
            {"n": decided, **(addresses() if assembly.contacts else dict.fromkeys(CALLED, 0))},
        )
        self._record = BlockRecord(
            INSTANT,
            {
                **dict.fromkeys(("velocities", "bounced", "noise", "sum", "terms"), n_ext),
                **dict.fromkeys(("some", "chosen", "order"), 3 * most),
                "contacts": most, "table": TOUCHING.itemsize // 8 * most, "scalars": SCALARS.itemsize // 8,
                **dict.fromkeys(SOLVER_VECTORS, most),
                "a": 4 * decided**2, "matrix": 4 * decided**2 + 4 * decided, "work": work,
                "directions": (every + decided) * n, "responses": (every + decided) * n, "columns": n + 1,
                "sweeps": ROW_ROOM * rows + 2 * n,
                "opening_wholes": opening_wholes(n, m), "opening_reals": opening_reals(n, m),
                "block_wholes": block_wholes(most, self.coordinates),
                "block_reals": block_reals(most, self.coordinates),
                "kept_memory": contacts * MEMORY_SIZE, "kept_rate": RATE_SIZE, "kept_counters": COUNTERS_SIZE,
                "modes": contacts, "unsettled": contacts, "massless_rates": contacts, "joint_rates": m,
                "row_wholes": 6 * (n + m + 1) + 2 * space, "row_reals": n + m + 1 + 3 * space,
                "space_a": every * every, "space_b": every, "space_p": every,
                "pressing_a": every * every, "torques": decided * n,
                "space_room": every * every + 4 * every + friction_cones_size(decided) + least_forces_size(decided),
                "space_kept": every * every + 4 * every + 2,
                "slots_work": min(n * n, n + entries_of_few(assembly, contacts)[0]),
            },
            {
                "most": most, "most_decided": decided, "block_coordinates": self.coordinates, "work_size": work,
                "rows_space": space, "cones": self._cones.address,
                **_functions(assembly),
            },
        )  # fmt: skip

    @property
    def address(self) -> int:
        """Address of the record."""
        return self._record.address

    @property
    def _scalars(self) -> NDArray[Any]:
        return self._record.part("scalars").view(SCALARS)

    @property
    def touching(self) -> list[int]:
        """The contacts that touched at the instant looked at last."""
        return [int(k) for k in self._record.whole("contacts")[: self._scalars["count"][0]]]

    @touching.setter
    def touching(self, contacts: list[int]) -> None:
        self._record.whole("contacts")[: len(contacts)] = contacts
        self._scalars["count"] = len(contacts)

    @property
    def inverse_masses(self) -> NDArray[np.float64]:
        """Of the contacts that have been opened last, (2 contacts, 2 contacts), 1/kg: normals first; the tangent of a
        contact in space is that along which it slides, the first one where it does not."""
        count = len(self.touching)
        table = self._record.part("table").view(TOUCHING)[:count]
        along = np.stack([table["sliding_rate"], table["sliding_rate2"]])
        slides = np.hypot(*along) * [self._assembly.contacts[k].tangents == 2 for k in self.touching]
        along = np.where(slides > 0.0, along / np.where(slides > 0.0, slides, 1.0), [[1.0], [0.0]])
        turn = np.zeros((2 * count, 3 * count))
        turn[:count, :count] = np.eye(count)
        turn[count:, count : 2 * count], turn[count:, 2 * count :] = np.diag(along[0]), np.diag(along[1])
        all_three = self._record.part("space_a")[: 9 * count * count].reshape(3 * count, 3 * count)
        return np.asarray(turn @ all_three @ turn.T)

    @property
    def unsettled(self) -> NDArray[np.int64]:
        """1 for each contact found unsettled."""
        return self._record.whole("unsettled")

    @property
    def who(self) -> int:
        """Of these, the one that a failure is of."""
        return int(self._scalars["failed_contact"][0])

    def grown(self) -> "Instant":
        """One with more room of what there was too little."""
        of = int(self._scalars["short_of"][0])
        return self.with_room(
            2 * self.most if of == OF_CONTACTS else self.most,
            max(2 * self.decided, len(self.touching)) if of == OF_DECIDED else self.decided,
            2 * self.rows_space if of == OF_ELIMINATION else self.rows_space,
            2 * self.coordinates if of == OF_BLOCKS else self.coordinates,
        )

    def with_room(self, most: int, decided: int, rows_space: int = 0, coordinates: int = 0) -> "Instant":
        """One with room as the parameters of the class say, but at least this one's."""
        return Instant(
            self._assembly, max(most, self.most), max(decided, self.decided), max(rows_space, self.rows_space),
            max(coordinates, self.coordinates),
        )  # fmt: skip

    def scratch(self) -> list[NDArray[Any]]:
        """The memory, whose content decides nothing."""
        return [self._record.block, self._cones.block]

    def tables(self) -> list[NDArray[Any]]:
        """The records of addresses."""
        return [self._record.table, self._cones.table]

    def moved(self, take: Take) -> "Instant":
        """The same in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        new._record, new._cones = self._record.moved(take), self._cones.moved(take)
        return new
