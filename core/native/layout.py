"""What stands in the head of an image, in the order in which `image.h` has it."""

import struct
from typing import Any

from numpy.typing import NDArray

from ..assembly.matrix_state import MATRIX_HEAD
from ..compiled.library import Library
from ..linalg.record import VALUES
from ..rounding import PUNCTUAL
from ..state.workspace_records import OF_D, OF_KKT

MAGIC = b"TLISMNI\x01"
VERSION = 1

IMAGE_HEAD = (
    "version", "size", "checksum",
    "shared",                                  # bytes that are never written
    "tables", "decisive", "copied", "own",     # records and addresses; with what decides; what an image has; all
    "functions", "function_text", "texts", "text_size",
    "parameters", "words", "coefficients", "exclusions",
    "shared_shared", "shared_function", "own_own", "own_shared", "own_function",  # addresses: in, to
)  # fmt: skip
"""Sizes and counts, 8 bytes each."""

CALLED = ("exchange", "tell", "read", "drive", "settle_pending", "repair_now", "along_inputs",
          "in_time", "begin_now", "matrix_words", "save_matrices", "restore_matrices", "want", "normalise")  # fmt: skip
"""Functions that the C code calls itself: the first ones in the list of functions."""
_MODULES = {
    **dict.fromkeys(("exchange", "tell", "read"), "simulation.exchange"),
    **dict.fromkeys(("drive", "settle_pending"), "time_loop.drive"),
    "repair_now": "recovery.compiled_repartition",
    **dict.fromkeys(("along_inputs", "in_time"), "simulation.slopes"),
    "begin_now": "simulation.begin_now", "want": "simulation.read_channels", "normalise": "simulation.normal_form",
    **dict.fromkeys(("matrix_words", "save_matrices", "restore_matrices"), "assembly.matrix_state"),
}  # fmt: skip

NUMBERS = (
    "inputs", "channels", "contacts", "n", "event_rows", "most_steps", "chunk", "redundant",
    "events", "begins", "matrix_words",
    "start", "punctual",
)  # fmt: skip
"""Counts, and whether a run may begin anew; then the start, s, and what changes of inputs are compared with
(`inputs.py`)."""

PLACES = (
    "exchange", "drive", "reads", "budget", "times", "inputs", "channels", "goals", "counts", "events", "pending",
    "counters", "method_times", "ring", "parameters", "begin", "begin_numbers", "rates", "workspace",
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
    assembly, exchange = sim.assembly, sim.crossing
    whole = (
        len(assembly.input_names), len(sim.table.channels), len(assembly.contacts), assembly.n,
        len(sim.drive.events), most_steps, int(exchange._record.table["chunk"][0]),
        len(sim.workspace.dropped), len(sim.events), int(begins), most_matrix_words(sim.workspace),
    )  # fmt: skip
    return struct.pack(f"<{len(whole)}q2d", *whole, sim.t, PUNCTUAL)


def most_matrix_words(workspace: Any) -> int:
    """Words that a state has of the matrices at most (`assembly/matrix_state.py`)."""
    a, rooms = workspace.assembly, workspace.slots.rooms
    size, factors = a.n + a.m, 2 * int(rooms[OF_KKT + VALUES] + rooms[OF_D + VALUES])
    return 2 + len(a.contacts) + 2 * a.m + 4 * (MATRIX_HEAD + size) + factors


def arrays_in_places(sim: Any, parameters: NDArray[Any]) -> tuple[NDArray[Any], ...]:
    """The arrays of PLACES."""
    exchange = sim.crossing._record
    return (
        exchange.table, sim.drive.record.table, exchange.table["read"], exchange.table["chunk"],
        exchange.arrays["times"],
        exchange.arrays["inputs"], exchange.arrays["channels"], sim.drive.goals.numbers, sim.drive.counts.numbers,
        sim.drive.events, sim.drive.pending, sim.workspace.arrays["counters"], sim.method_arrays["times"],
        sim.method_arrays["ring"],
        parameters, sim.beginning.record.table, sim.beginning.numbers, exchange.arrays["rates"],
        sim.workspace._record.table,
    )  # fmt: skip
