"""Structures and partitions that compiled code builds, against their definition, for any states of the contacts."""

import numpy as np
import pytest
from test_heap import heap
from tlismni.core import Simulation
from tlismni.core.assembly.patterns import contacts_alone
from tlismni.models import load

MODELS = {
    "heap": lambda: heap(4, 0.3, 0.4, 0),
    "cable_ground": lambda: load("cable_ground").model,
    "woodpecker": lambda: load("woodpecker").model,
    "sphere_beam": lambda: load("sphere_beam").model,
    "mass_on_rod": lambda: load("mass_on_rod").model,
    "rod_rod": lambda: load("rod_rod").model,
    "slider_crank_stop": lambda: load("slider_crank_stop").model,
    "spatial_slider_crank": lambda: load("spatial_slider_crank").model,
    "rolling_disk": lambda: load("rolling_disk").model,
    "dropped_box": lambda: load("dropped_box", friction=0.4).model,
    "spatial_cradle": lambda: load("spatial_cradle").model,
}


def definition(workspace, closed, engaged, sticking):
    """Active rows; the places of the matrix and of the watched gradients with the local entries that belong there. Rows
    of joints that are left out have multipliers, and in the place of their equation one of the multipliers of their
    mechanism."""
    assembly, dropped = workspace.assembly, workspace.dropped
    contacts = assembly.contacts
    count = len(contacts)
    constraints = {contacts[k].row for k in closed} | {contacts[k % count].slide_row + k // count for k in sticking}
    replaced = {row for row, by in assembly.replaced_rows.items() if by & closed}
    out, implied = dropped | replaced, sorted(dropped - replaced)
    active = [r for r in range(assembly.m) if (r < assembly.m_joints and r not in out) or r in constraints]
    active.sort(key=lambda row: row in assembly.rate_rows)  # those with a position form come first
    # of contacts that can be evaluated alone, these are asked for gradients instead
    listed = [c for c, (batch, _, _) in zip(contacts, contacts_alone(assembly), strict=True) if batch is None]
    watched = {c.row for c in listed} | {c.slide_row + k for c in listed if c.slide_row >= 0 for k in range(c.tangents)}
    watched = watched - set(active) | set(implied)
    n, matrix, gradients = assembly.n, {(i, i): [] for i in range(assembly.n)}, {}
    rows = [*active, *implied]
    compliance, mechanism = workspace.arrays["compliance"], workspace.arrays["mechanism"]
    for own in implied:
        for row in (row for row in rows if row < assembly.m_joints and mechanism[row] == mechanism[own]):
            if compliance[row] > 0.0 or row == own:
                matrix[n + rows.index(own), n + rows.index(row)] = []
    for b, batch in enumerate(assembly.batches):
        width = batch.coord.shape[1]
        for e in range(len(batch.coord)):
            here = [(int(x) if x < assembly.ground else None) for x in batch.coord[e]]
            for i, j in batch.tangent_pattern if batch.contact[e] < 0 or batch.contact[e] in engaged else ():
                if here[i] is not None and here[j] is not None:
                    matrix.setdefault((here[i], here[j]), []).append((0, b, e, i * width + j))
            for k, j in batch.jacobian_pattern:
                row = int(batch.row[e, k])
                if here[j] is None:
                    continue
                if row in active:
                    at = n + active.index(row)
                    matrix.setdefault((at, here[j]), []).append((1, b, e, k * width + j))
                    matrix.setdefault((here[j], at), []).append((2, b, e, k * width + j))
                if row in implied:
                    matrix.setdefault((here[j], n + rows.index(row)), []).append((2, b, e, k * width + j))
                if row in watched:
                    gradients.setdefault((row, here[j]), []).append((1, b, e, k * width + j))
    return active, matrix, gradients


@pytest.mark.parametrize("name", MODELS)
def test_structures_are_what_they_are_defined_to_be(name):
    sim = Simulation(MODELS[name]())
    workspace, assembly, rng = sim.workspace, sim.assembly, np.random.default_rng(5)
    count = len(assembly.contacts)
    for _ in range(12):
        codes = rng.integers(0, 5, count) * (rng.random(count) < 0.6)
        closed = frozenset(np.flatnonzero(codes >= 2).tolist())
        sticking = frozenset(k for k in closed if codes[k] >= 3 and assembly.contacts[k].slide_row >= 0)
        sticking |= {k + count for k in sticking if codes[k] == 4 and assembly.contacts[k].tangents == 2}
        engaged = closed | set(np.flatnonzero(codes == 1).tolist())
        workspace.drop(frozenset(np.flatnonzero(rng.random(assembly.m_joints) < 0.1).tolist()))
        workspace.engage(closed, engaged, sticking)
        active, matrix, gradients = definition(workspace, closed, engaged, sticking)
        s, n = workspace.structure, assembly.n
        assert s.active.tolist() == active
        assert s.m_held == len([row for row in active if row not in assembly.rate_rows])
        assert assembly.count_active(closed, sticking, workspace.dropped, frozenset()) == (len(active), s.m_held)
        assert s.redundant.tolist() == sorted(workspace.dropped)
        assert list(zip(s.rows.tolist(), s.cols.tolist(), strict=True)) == sorted(matrix)
        assert s.mass_slot.tolist() == [k for k, (i, j) in enumerate(sorted(matrix)) if i < n and j < n]
        below = [(k, i - n, j) for k, (i, j) in enumerate(sorted(matrix)) if i >= n and j < n]
        assert (
            list(zip(s.jacobian_slot.tolist(), s.jacobian_row.tolist(), s.jacobian_col.tolist(), strict=True)) == below
        )
        rows = np.repeat(np.arange(assembly.m), np.diff(s.gradient_start))
        assert list(zip(rows.tolist(), s.gradient_col.tolist(), strict=True)) == sorted(gradients)
        assert s.gradient_slot.tolist() == list(range(len(matrix), len(matrix) + len(gradients)))
        wanted = [
            [np.full(s.table_of(3 * b + x).shape, s.n_values - 1) for x in range(3)]
            for b in range(len(assembly.batches))
        ]
        for k, place in enumerate((*sorted(matrix), *sorted(gradients))):
            for x, b, e, at in matrix[place] if k < len(matrix) else gradients[place]:
                wanted[b][x][e, at] = k
        for b in range(len(assembly.batches)):
            for x in range(3):
                assert np.array_equal(s.table_of(3 * b + x), wanted[b][x])


@pytest.mark.parametrize(
    "name", ["slider_crank_stop", "spatial_slider_crank", "woodpecker", "heap", "rolling_disk", "dropped_box"]
)
def test_partitions_are_what_they_are_defined_to_be(name):
    sim = Simulation(MODELS[name]())
    workspace, rng = sim.workspace, np.random.default_rng(5)
    closed = frozenset(range(min(3, len(sim.assembly.contacts))))
    workspace.engage(closed, closed)
    structure, n = workspace.structure, sim.assembly.n
    entries = list(zip(structure.jacobian_row, structure.jacobian_col, structure.jacobian_slot, strict=True))
    for _ in range(5):
        dependent = rng.permutation(n)[: len(structure.active)]
        workspace.set_partition(dependent)
        present = structure.present
        assert np.array_equal(present.dependent, dependent) and np.array_equal(structure.dependent, dependent)
        where = {int(x): k for k, x in enumerate(dependent)}
        free = [entry for entry in entries if int(entry[1]) not in where]
        of_free = (present.array(part) for part in ("free_row", "free_col", "free_slot"))
        assert list(zip(*of_free, strict=True)) == free
        bound = [(i, where[int(j)], k) for i, j, k in entries if int(j) in where]
        held = [(i, j, k) for i, j, k in bound if max(i, j) < structure.m_held]
        two = bool(sim.assembly.rate_rows)
        assert len(present.factorizations) == 1 + two
        # where all rows have a position form, one does for both
        of_positions = (structure.m_held, held) if structure.m_held < len(dependent) else (0, [])
        for lu, size, wanted in ((present.lu_d, len(dependent), bound), (present.lu_p, *of_positions)):
            assert lu is not None or not two
            if lu is not None:
                nnz = lu.record["nnz"]
                assert lu.n == size
                assert list(zip(*(lu._at(x, nnz) for x in ("row", "col", "slot")), strict=True)) == wanted
