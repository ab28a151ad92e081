"""What a run without Python starts from when a parameter has another value: the record of `begin_now`."""

from typing import Any

import numpy as np

from ..compiled.records import ArrayRecord
from ..run import begin_record as places
from ..run.begin_record import BEGIN, BEGIN_SIZE, LATER
from ..run.blueprint import Unstarted
from ..run.settings import KINDS
from ..tables.assembly import Assembly
from ..tolerances import DEFAULT_ATOL, OfScales


class Beginning:
    """The start of `sim`, a run of a Model, as arrays.

    Attributes
    ----------
    record : BEGIN.
    scratch : arrays that decide nothing between two calls.
    """

    def __init__(self, sim: Any, settings: dict[str, Any]) -> None:
        assembly, workspace = sim.assembly, sim.workspace
        n, n_ext = assembly.n, assembly.n_extended
        before = Unstarted(sim.system, **settings)
        room = {
            name: np.zeros(size)
            for name, size in (("later", LATER), ("scale", n), ("mass", n), ("sizes", assembly.m + 1))
        }
        self.scratch = list(room.values())
        self.numbers = np.zeros(BEGIN_SIZE)
        self._arrays = {
            "blank": before.workspace.state.view(np.float64).copy(),
            "numbers": self.numbers, "q0": np.zeros(n), "v0": np.zeros(n),
            "placed": np.array(assembly.placed, dtype=np.int64).reshape(-1, 2),
            "internal": assembly.is_internal.astype(np.int64), "angle": assembly.is_angle.astype(np.int64),
            "work_sizes": np.zeros(n_ext), **room,
        }  # fmt: skip
        self.record = ArrayRecord(
            BEGIN,
            self._arrays,
            {
                "exchange": sim.crossing._record.address, "drive": sim.drive.address,
                "state": workspace.state.ctypes.data,
                "n_blank": len(self._arrays["blank"]), "n_placed": len(assembly.placed), "m_joints": assembly.m_joints,
                "energies": sim.table.layout.kinetic,
            },
        )  # fmt: skip
        self._set_settings(sim.settings)
        self.take_numbers(assembly)

    def _set_settings(self, s: Any) -> None:
        numbers = self.numbers
        numbers[places.T0], numbers[places.START_TOLERANCE] = s.t0, s.start_tolerance
        numbers[places.STEP], numbers[places.FIRST_STEP] = s.step or 0.0, s.first_step or 0.0
        numbers[places.NEWTON_TOLERANCE] = s.newton_tolerance or 0.0
        for kind, place in zip(
            KINDS, (places.LENGTHS, places.ANGLES, places.SPEEDS, places.ANGULAR_SPEEDS), strict=True
        ):
            atol = s.atol.get(kind, DEFAULT_ATOL) if isinstance(s.atol, dict) else s.atol
            numbers[place], numbers[place + places.OF_SCALES] = float(atol), float(isinstance(atol, OfScales))

    def take_numbers(self, assembly: Assembly) -> None:
        """Start from another assembly of the same tables but for their numbers."""
        arrays = self._arrays
        arrays["q0"][:], arrays["v0"][:] = assembly.q0, assembly.v0
        self.numbers[places.LENGTH], self.numbers[places.LONGEST_STEP] = assembly.length, assembly.longest_step
        for name, size in assembly.work_sizes.items():
            arrays["work_sizes"][assembly.work_index(name)] = size

    def own(self) -> list[Any]:
        """Memory that a run has for itself."""
        return [self.record.table, self.numbers, *self.scratch]
