"""What stands in the head of an image, in the order in which `image.h` has it."""

import struct
from typing import Any

from numpy.typing import NDArray

from ..compiled.library import Library
from ..rounding import PUNCTUAL, SHORTEST

MAGIC = b"TLISMNI\x01"
VERSION = 1

HEAD = (
    "version", "size", "checksum",
    "shared", "tables", "decisive", "own",     # bytes: never written; that have addresses, that a state has, and all
    "functions", "function_text", "texts", "text_size",
    "parameters", "words", "coefficients", "exclusions",
    "shared_shared", "shared_function", "own_own", "own_shared", "own_function",  # addresses: in, to
)  # fmt: skip
"""Sizes and counts, 8 bytes each."""

CALLED = ("exchange", "tell", "read", "drive", "settle_pending", "repair_now", "locate_now", "along_inputs", "in_time",
          "begin_now")  # fmt: skip
"""Functions that the C code calls itself: the first ones in the list of functions."""
_MODULES = {
    "exchange": "run.exchange", "tell": "run.exchange", "read": "run.exchange", "drive": "loop.drive",
    "settle_pending": "loop.drive", "repair_now": "repair.mend", "locate_now": "loop.drive",
    "along_inputs": "run.slopes", "in_time": "run.slopes",
    "begin_now": "run.begin_now",
}  # fmt: skip

NUMBERS = (
    "inputs", "channels", "contacts", "n", "event_rows", "most_steps", "chunk", "fixed_step", "redundant",
    "events", "begins",
    "start", "shortest", "punctual",
)  # fmt: skip
"""Counts, and whether a run may begin anew; then the start, s, and what steps and changes of inputs are compared
with (`advance.py`, `inputs.py`)."""

PLACES = (
    "exchange", "drive", "reads", "budget", "times", "inputs", "channels", "goals", "counts", "events", "pending",
    "clock", "counters", "method_times", "ring", "parameters",
    "control", "begin", "begin_numbers", "rates",
)  # fmt: skip
"""Where these stand in a run's memory."""


def called_symbols(library: Library) -> list[str]:
    """Symbols of CALLED."""
    found = []
    for name in CALLED:
        full = f"tlismni.core.{_MODULES[name]}.{name}"
        (signature,) = library.signatures(full)
        found.append(library.entries[f"{full} {signature}"])
    return found


def numbers_of(sim: Any, most_steps: int, begins: bool) -> bytes:
    """NUMBERS of a simulation that may begin anew, or may not."""
    assembly, ex = sim.assembly, sim.crossing
    whole = (
        len(assembly.input_names), len(sim.table.channels), len(assembly.contacts), assembly.n,
        len(sim.drive.events), most_steps, int(ex._record.table["chunk"][0]), int(bool(sim.settings.step)),
        len(sim.workspace.dropped), len(sim.events), int(begins),
    )  # fmt: skip
    return struct.pack(f"<{len(whole)}q3d", *whole, sim.t, SHORTEST, PUNCTUAL)


def arrays_in_places(sim: Any, parameters: NDArray[Any]) -> tuple[NDArray[Any], ...]:
    """The arrays of PLACES."""
    ex, ws = sim.crossing._record, sim.workspace.arrays
    return (
        ex.table, sim.drive.record.table, ex.table["read"], ex.table["chunk"], ex.arrays["times"],
        ex.arrays["inputs"], ex.arrays["channels"], sim.drive.goals, sim.drive.counts, sim.drive.events,
        sim.drive.pending, sim.clock, ws["counters"], sim.method_arrays["times"], sim.method_arrays["ring"],
        parameters, ws["control"], sim.beginning.record.table, sim.beginning.numbers,
        ex.arrays["rates"],
    )  # fmt: skip
