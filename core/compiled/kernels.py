"""Element kernels as addresses, so that one compiled loop serves any mix of elements, a user's own too.

A kernel is a numba function of the one signature `KERNEL_SIGNATURE`: (job, t, batch) -> None. `batch` is a
`BATCH` record: the addresses of the batch's tables and of the system's current arrays. The loop calls it through
its machine address, which costs a few nanoseconds and leaves the loop's compiled code independent of the model,
so that both are cached on disk.
"""

from typing import Any

import numpy as np

from . import types
from .jit import address_of, caller, internal, record_view
from .views import ivec

# What a kernel is asked to do.
RESIDUAL = 0  # add to r, phi, phid, phidd at the current (t, q, v, a, lam)
TANGENT = 1  # add M + c_v D + c_q K and Phi_q to the sparse values
ENERGY = 2  # add to energy[KINETIC, POTENTIAL, STRAIN]
POWER = 3  # write the power of dissipation and input into the work entries of a
# Asked of the system, not of a kernel: RESIDUAL of those kernels only that have constraint rows; r means nothing then.
CONSTRAINTS = 4

BATCH = np.dtype(
    [
        (name, np.int64)
        for name in (
            # sizes
            "count", "npar", "ncoord", "nrow", "nextra",
            # tables of the batch
            "par",       # (count, npar)  float64
            "coord",     # (count, ncoord) int64: index into q, v, a, r
            "row",       # (count, nrow)  int64: index into lam, phi, phid, phidd
            "slot_s",    # (count, ncoord*ncoord) int64: where d r_i / d q_j goes in `values`
            "slot_j",    # (count, nrow*ncoord) int64: where Phi_q goes in `values`
            "slot_jt",   # (count, nrow*ncoord) int64: where its transpose goes
            "line",      # (count,) int64: which line of these three tables is an element's; 0: all have their own
            "extra",     # (count, nextra) int64: element-specific indices (contact number, work accounts ...)
            "shown",     # (1 + count,) int64: how many elements are looked at, and which; 0: all are
            # current arrays of the system (shared by all batches)
            "q", "v", "a", "lam", "r", "phi", "phid", "phidd", "values", "coef", "inputs", "energy", "monitor",
            "signals",   # float64 pool of the time functions' parameters
            "memory",    # float64 contact memories (approach speed, mode)
            "sleeping",    # (contacts,) int64: 1 for contacts that are too far from touching to be evaluated
            "n_extended", "m_extended", "n_values", "n_inputs", "n_signals", "n_monitor", "n_memory",
        )
    ]
)  # fmt: skip

BATCH_TYPE = types.from_dtype(BATCH)
KERNEL_SIGNATURE = types.void(types.int64, types.float64, BATCH_TYPE)


call_kernel = caller(KERNEL_SIGNATURE)
"""call_kernel(address, job, t, batch)."""

batch_at = record_view(BATCH_TYPE)
"""batch_at(address): the batch record there."""


@internal
def line_of(b: Any, e: int) -> int:
    """The line of the slot tables that is element e's. Of contacts that take no part in the equations there are none:
    they share the first, whose slots belong nowhere."""
    return e if b.line == 0 else int(ivec(b.line, b.count)[e])


@internal
def shown(b: Any) -> int:
    """How many elements of a batch of contacts are not of pairs that are far from each other."""
    return int(b.count) if b.shown == 0 else int(ivec(b.shown, 1)[0])


@internal
def shown_at(b: Any, i: int) -> int:
    """The element that is number i of these."""
    return i if b.shown == 0 else int(ivec(b.shown, b.count + 1)[i + 1])


def kernel_address(kernel: Any) -> int:
    """Machine address of a kernel. Raises TypeError if it is not a numba function of KERNEL_SIGNATURE."""
    return address_of(kernel, KERNEL_SIGNATURE)
