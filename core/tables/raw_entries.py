"""The entries of S and Phi_q as the batches of a model list them, flat: what structures are built from."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from .assembly import Assembly

_OF_S, _OF_J = ("s_row", "s_col", "s_contact", "s_place"), ("j_row", "j_col", "j_place", "j_place_t")


def raw_entries(assembly: Assembly) -> tuple[dict[str, NDArray[np.int64]], list[tuple[int, int]]]:
    """Tables by field of BUILDING, and the shapes of the batches' slot tables: three of each batch, for S, Phi_q and
    Phi_q^T."""
    shapes: list[tuple[int, int]] = []
    for batch in assembly.batches:
        count, width = batch.coord.shape
        rows = batch.row.shape[1] if batch.row.size else 0
        shapes += [(count, width * width), *(2 * [(count, max(rows, 1) * width)])]
    start = np.concatenate(([0], np.cumsum([count * width for count, width in shapes]))).astype(np.int64)
    of_s: list[tuple[Any, ...]] = []
    of_j: list[tuple[Any, ...]] = []
    for k, batch in enumerate(assembly.batches):
        first, first_j, first_t = (int(x) for x in start[3 * k : 3 * k + 3])
        count, width = batch.coord.shape
        element = np.arange(count)[:, None]
        if len(batch.tangent_pattern):
            i, j = np.array(batch.tangent_pattern, dtype=np.int64).T
            row, col = batch.coord[:, i], batch.coord[:, j]
            there = (row < assembly.ground) & (col < assembly.ground)
            place = first + element * width * width + i * width + j
            contact = np.broadcast_to(batch.contact[:, None], row.shape)
            of_s.append(tuple(x[there] for x in (row, col, contact, place)))
        if len(batch.jacobian_pattern):
            i, j = np.array(batch.jacobian_pattern, dtype=np.int64).T
            # -1 is no row: the one behind all others
            row, col = batch.row[:, i] % (assembly.m + 1), batch.coord[:, j]
            there = col < assembly.ground
            place = element * shapes[3 * k + 1][1] + i * width + j
            of_j.append(tuple(x[there] for x in (row, col, first_j + place, first_t + place)))
    tables = {"table_start": start[:-1].copy()}
    for names, parts in ((_OF_S, of_s), (_OF_J, of_j)):
        for x, name in enumerate(names):
            tables[name] = np.concatenate([np.zeros(0, dtype=np.int64), *(part[x] for part in parts)])
    return tables, shapes
