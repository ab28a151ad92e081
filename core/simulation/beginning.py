"""What one run starts from: the record of the compiled start, and its numbers."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..compiled.image import Take, twin
from ..compiled.records import ArrayRecord
from ..tolerances import DEFAULT_ATOL, OfScales
from . import begin_record as places
from .begin_record import BEGIN, BEGIN_SIZE, LATER, START_FOUND_SIZE
from .settings import TOLERANCE_KINDS, Settings

if TYPE_CHECKING:
    from .engine import Engine

_ROOM = ("later", "scale", "mass", "sizes", "found")
_OWN = ("numbers", "q0", "v0", "usual_v0", "row_sizes", "work_sizes", *_ROOM)
"""Arrays that a run writes; nobody writes into the others."""


class Beginning:
    """The start of a run as arrays.

    Attributes
    ----------
    record : BEGIN.
    """

    def __init__(self, sim: "Engine") -> None:
        assembly = sim.assembly
        n, given = assembly.n, assembly.row_scale is not None
        room = {"later": LATER, "scale": n, "mass": n, "sizes": assembly.m + 1, "found": START_FOUND_SIZE}
        self.record = ArrayRecord(
            BEGIN,
            {
                "numbers": np.zeros(BEGIN_SIZE), "q0": np.zeros(n), "v0": np.zeros(n), "usual_v0": np.zeros(n),
                "placed": np.array(assembly.placed, dtype=np.int64).reshape(-1, 2),
                "internal": assembly.is_internal.astype(np.int64), "angle": assembly.is_angle.astype(np.int64),
                "row_sizes": np.zeros(assembly.m if given else 0), "work_sizes": np.zeros(assembly.n_extended),
                "blank": np.zeros(0), "turned": np.zeros((0, 2), dtype=np.int64), "turn_numbers": np.zeros(0),
                **{name: np.zeros(size) for name, size in room.items()},
            },
            {
                "drive": sim.drive.address, "n_placed": len(assembly.placed), "m_joints": assembly.m_joints,
                "n_row_sizes": int(given), "exchange": 0, "state": 0, "n_blank": 0, "energies": 0,
                "n_turned": 0, "n_turn_numbers": 0,
            },
        )  # fmt: skip
        self._set_settings(sim.settings, sim.rtol / sim.settings.rtol)

    def _set_settings(self, s: Settings, share: float) -> None:
        """`share`: of the tolerances that were asked for, what steps are held to."""
        numbers = self.numbers
        numbers[places.T0], numbers[places.START_TOLERANCE] = s.t0, s.start_tolerance
        numbers[places.STEP], numbers[places.FIRST_STEP] = s.step or 0.0, s.first_step or 0.0
        numbers[places.NEWTON_TOLERANCE] = s.newton_tolerance or 0.0
        numbers[places.LOOK_AT_RANK] = float(s.redundant != "refuse")
        for kind, place in zip(
            TOLERANCE_KINDS, (places.LENGTHS, places.ANGLES, places.SPEEDS, places.ANGULAR_SPEEDS), strict=True
        ):
            atol = s.atol.get(kind, DEFAULT_ATOL) if not isinstance(s.atol, int | float) else s.atol
            numbers[place], numbers[place + places.OF_SCALES] = share * float(atol), float(isinstance(atol, OfScales))

    @property
    def numbers(self) -> NDArray[np.float64]:
        """Settings and sizes (`begin_record.py`)."""
        return self.record.arrays["numbers"]

    @property
    def found(self) -> NDArray[np.float64]:
        """What the last start has found (`begin_record.py`)."""
        return self.record.arrays["found"]

    @property
    def scratch(self) -> list[NDArray[Any]]:
        """Arrays that decide nothing between two calls."""
        return [self.record.arrays[name] for name in _ROOM]

    def take_numbers(self, assembly: Assembly, model: Assembly | None = None) -> None:
        """Start from this assembly, whose tables are the same but for their numbers. `model`: that of the model, where
        this one has start values of its own, which its scales do not follow."""
        arrays = self.record.arrays
        arrays["q0"][:], arrays["v0"][:], arrays["usual_v0"][:] = assembly.q0, assembly.v0, (model or assembly).v0
        self.numbers[places.LENGTH], self.numbers[places.LONGEST_STEP] = assembly.length, assembly.longest_step
        for name, size in assembly.work_sizes.items():
            arrays["work_sizes"][assembly.work_index(name)] = size
        if assembly.row_scale is not None:
            # one that nothing moves, or no number tells of: as large as the largest of the others
            sizes = np.where(np.isfinite(assembly.row_scale), assembly.row_scale, 0.0)
            arrays["row_sizes"][:] = np.where(sizes == 0.0, np.max(sizes, initial=0.0) or 1.0, sizes)

    def memory(self) -> tuple[list[NDArray[Any]], list[NDArray[Any]]]:
        """Memory that a run has for itself: arrays, and records of addresses."""
        return [self.record.arrays[name] for name in _OWN], [self.record.words]

    def moved(self, take: Take) -> "Beginning":
        """The same in a copy of its memory (`compiled/image.py`)."""
        new = twin(self)
        new.record = self.record.moved(take)
        return new
