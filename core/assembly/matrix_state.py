"""What of the matrices decides a run's future, as words: written down, and brought back by compiled code.

Structure, partition and pivots follow from the codes of the contacts, the dependent coordinates and the rows of the
pivots (`building.py`, `partition_building.py`, `linalg/analyze.py`), so a state holds these and the numbers of the
factors only. Going back keeps what fits and builds the rest, as `simulation/restore.py` does in Python.

The words: how many there are; codes of the contacts; how many dependent coordinates, these, and the probe; the rows of
compatibility; then of each
matrix its kind (`linalg/record.py`; that of all sparse ones is PROGRAM), size, count of numbers, pivots, and numbers.
"""

from typing import Any

from ..compiled import types
from ..compiled.jit import compiled, internal
from ..compiled.views import ivec, vec
from ..linalg import lu_at
from ..linalg.analyze import call_analyze
from ..linalg.record import ANALYZE_SPARSE, DENSE, PROGRAM, UNREADY
from ..state.workspace_records import OK, WORKSPACE_TYPE, building_at, call_engage, partition_at, structure_at
from .partition_building import partition_wanted
from .serials import same_numbers
from .structure_switch import CODES

MATRIX_HEAD = 3
"""Words before each matrix."""
OF_QUERY = 1
"""Number of the matrix for queries."""
KEPT, BUILT = 0, 1
"""What `restore_matrices` returns: all fitted, or some was built."""
UNFIT = 50
"""The words are none of this run's, or there is no room for what they ask for."""
SAVE_ARGUMENTS = (WORKSPACE_TYPE, types.int64)
RESTORE_ARGUMENTS = (WORKSPACE_TYPE, types.int64, types.int64)


@internal
def _kind(lu: Any) -> int:
    """What kind of matrix this is, for a state."""
    if lu.kind == DENSE:
        return DENSE
    return PROGRAM if lu.ready != 0 else UNREADY


@internal
def _numbers(lu: Any) -> int:
    """How many numbers the factors are."""
    if lu.n == 0 or _kind(lu) == UNREADY:
        return 0
    return int(lu.n * (lu.n + 1) if lu.kind == DENSE else lu.nl + lu.nu + 2 * lu.n)


@internal
def _matrix(structure: Any, k: int) -> int:
    """Address of the k-th matrix: two of the equations, that of velocities and that of positions."""
    if k < 2:
        return int(structure.kkt if k == 0 else structure.kkt_query)
    partition = partition_at(structure.partition)
    return int(partition.lu_d if k == 2 else partition.lu_p)


@compiled
def matrix_words(workspace: Any) -> int:
    """How many words `save_matrices` writes now."""
    structure = structure_at(workspace.structure)
    count = 2 + workspace.n_contacts + 2 * structure.m_act + structure.n_sharing
    for k in range(4):
        lu = lu_at(_matrix(structure, k))
        count += MATRIX_HEAD + lu.n + _numbers(lu)
    return int(count)


@compiled
def save_matrices(workspace: Any, at: int) -> int:
    """Write the words to the address `at`; how many."""
    structure = structure_at(workspace.structure)
    partition, m_act, n_contacts, size = (
        partition_at(structure.partition),
        structure.m_act,
        workspace.n_contacts,
        matrix_words(workspace),
    )
    words = ivec(at, 2 + n_contacts + m_act)
    words[0], words[1 + n_contacts] = size, m_act
    codes, dependent, probe = (
        ivec(structure.codes, n_contacts),
        ivec(partition.dependent, m_act),
        vec(structure.probe, m_act),
    )
    for k in range(n_contacts):
        words[1 + k] = codes[k]
    for i in range(m_act):
        words[2 + n_contacts + i] = dependent[i]
    at += 8 * (2 + n_contacts + m_act)
    reals = vec(at, m_act)
    for i in range(m_act):
        reals[i] = probe[i]
    at += 8 * m_act
    sharing = structure.n_sharing
    reals, rows = vec(at, sharing), vec(structure.compatibility, sharing)
    for i in range(sharing):
        reals[i] = rows[i]
    at += 8 * sharing
    for k in range(4):
        lu = lu_at(_matrix(structure, k))
        head, count = ivec(at, MATRIX_HEAD), _numbers(lu)
        head[0], head[1], head[2] = _kind(lu), lu.n, count
        pivots, own = ivec(at + 8 * MATRIX_HEAD, lu.n), ivec(lu.pivots if lu.kind == DENSE else lu.perm_r, lu.n)
        # the factors for queries are computed anew whenever they are used: of sparse ones the limits of L decide
        forgotten = 0 if k != OF_QUERY else count - (0 if lu.kind == DENSE else min(lu.n, count))
        for i in range(lu.n):
            pivots[i] = i if k == OF_QUERY and lu.kind == DENSE else own[i]
        at += 8 * (MATRIX_HEAD + lu.n)
        numbers, values = vec(at, count), vec(lu.values, count)
        for p in range(count):
            numbers[p] = 0.0 if p < forgotten else values[p]
        at += 8 * count
    return size


@compiled
def restore_matrices(workspace: Any, at: int, anew: int) -> int:
    """Bring back what `save_matrices` has written to the address `at`: KEPT, BUILT or UNFIT. `anew`: nothing that is
    there counts, as after a start with other units. The state's numbers have to be there, and again after BUILT."""
    b, n_contacts = building_at(workspace.building), workspace.n_contacts
    places, left = ivec(b.structures, b.n_slots), ivec(at, 1)[0] - 2 - n_contacts
    if anew != 0:
        for i in range(b.n_slots):
            structure_at(places[i]).built = 0
    if left < 0:
        return UNFIT
    words, found = ivec(at, 2 + n_contacts), KEPT
    structure, m_act = structure_at(workspace.structure), words[1 + n_contacts]
    if structure.built == 0 or structure.dropped != b.dropped or not same_numbers(structure.codes, at + 8, n_contacts):
        found = BUILT
        wanted = ivec(workspace.wanted, n_contacts)
        for k in range(n_contacts):
            if words[1 + k] < 0 or words[1 + k] >= CODES:
                return UNFIT
            wanted[k] = words[1 + k]
        if call_engage(workspace.engage, workspace) != OK:
            return UNFIT
        structure = structure_at(workspace.structure)
    sharing = structure.n_sharing
    at, left = at + 8 * (2 + n_contacts), left - 2 * m_act - sharing
    if m_act != structure.m_act or left < 0:
        return UNFIT
    partition = partition_at(structure.partition)
    if partition.ready == 0 or not same_numbers(partition.dependent, at, m_act):
        found = BUILT
        wanted, dependent = ivec(workspace.wanted_dependent, m_act), ivec(at, m_act)
        for i in range(m_act):
            if dependent[i] < 0 or dependent[i] >= workspace.n:
                return UNFIT
            wanted[i] = dependent[i]
        partition_wanted(workspace)
    probe, reals = vec(structure.probe, m_act), vec(at + 8 * m_act, m_act)
    for i in range(m_act):
        probe[i] = reals[i]
    at += 16 * m_act
    rows, reals = vec(structure.compatibility, sharing), vec(at, sharing)
    for i in range(sharing):
        rows[i] = reals[i]
    at += 8 * sharing
    for k in range(4):
        lu, head = lu_at(_matrix(structure, k)), ivec(at, MATRIX_HEAD)
        left -= MATRIX_HEAD
        if left < 0 or head[1] != lu.n or head[2] < 0 or lu.n > left or head[2] > left - lu.n:
            return UNFIT
        how = _restore(lu, head[0], head[2], at + 8 * MATRIX_HEAD)
        if how == UNFIT:
            return UNFIT
        found, left, at = max(found, how), left - lu.n - head[2], at + 8 * (MATRIX_HEAD + lu.n + head[2])
    return found if left == 0 else UNFIT


@internal
def _restore(lu: Any, kind: int, count: int, at: int) -> int:
    """One matrix: its pivots stand at the address `at`, `count` numbers behind them."""
    how, n = KEPT, lu.n
    if kind == UNREADY and lu.kind != DENSE:
        functions = ivec(lu.functions, 2)
        lu.kind, lu.ready, lu.factor_function, lu.solve_function = UNREADY, 0, functions[0], functions[1]
    elif (kind == DENSE) != (lu.kind == DENSE):
        return UNFIT
    elif kind == DENSE:
        own, pivots = ivec(lu.pivots, n), ivec(at, n)
        for i in range(n):
            if pivots[i] < 0 or pivots[i] >= n:
                return UNFIT
            own[i] = pivots[i]
    elif n > 0 and (lu.ready == 0 or not same_numbers(lu.perm_r, at, n)):
        how = BUILT
        if (
            not _want_pivots(lu, at)
            or call_analyze(ivec(lu.functions, ANALYZE_SPARSE + 1)[ANALYZE_SPARSE], lu, 0) != OK
        ):
            return UNFIT
    if count != _numbers(lu):
        return UNFIT
    numbers, values = vec(at + 8 * n, count), vec(lu.values, count)
    for p in range(count):
        values[p] = numbers[p]
    return how


@internal
def _want_pivots(lu: Any, at: int) -> bool:
    """Ask for the pivots at the address `at`; False if they are no permutation."""
    n, room = lu.n, ivec(lu.scratch, 2)
    if n > room[1]:
        return False
    pivots, wanted, seen = ivec(at, n), ivec(lu.wanted, n), ivec(room[0], n)
    for i in range(n):
        seen[i] = 0
    for i in range(n):
        if pivots[i] < 0 or pivots[i] >= n or seen[pivots[i]] != 0:
            return False
        seen[pivots[i]], wanted[i] = 1, pivots[i]
    return True
