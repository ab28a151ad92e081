"""Contact pools: pairs of shapes that come near take a slot, a contact in the tables, and leave it when they part.

A pair is near if the broad phase finds it (`broad_phase.py`), which it does before anything of it can touch. It keeps
its slot while it is near or closed, so its memory lives as long as it matters; a slot is given away only where a new
pair needs one. Which pair has which slot is part of the state. Slots of near pairs are found by a hash table (linear
probing; Knuth 1998, section 6.4).
"""

from typing import Any

from ..assembly.structure_switch import APART
from ..compiled.jit import internal
from ..compiled.views import ivec, vec
from ..contacts.normal3d import GAP_KIND, PAIR_AT, RADIUS_A, RADIUS_B
from ..elements.measure3d import AXES_A, AXES_B, DISTANCE, PLACE, POINT_A, POINT_B
from ..state.modes import OPEN, memories_at
from ..state.pool_records import NO_PAIR, groups_at, shapes_at
from ..state.workspace_records import building_at, structure_at
from .balls import MARKS, NEW_PAIRS
from .contact_evaluation import BRACKET, HAPPENS, probe_of
from .contact_sleeping import DEEPLY


@internal
def begin_pairs(loop: Any) -> None:
    """The hash table of the slots' pairs; no pair is new."""
    table, pairs = ivec(loop.slot_hash, loop.n_hash), ivec(loop.slot_pair, loop.n_slots)
    marks = ivec(loop.broad, MARKS)
    marks[NEW_PAIRS] = 0
    for i in range(loop.n_hash):
        table[i] = 0
    for slot in range(loop.n_slots):
        if pairs[slot] != NO_PAIR:
            at = _place_of(loop, pairs[slot])
            table[at] = slot + 1


@internal
def _place_of(loop: Any, pair: int) -> int:
    """Where the slot of this pair is in the table, or would be."""
    table, pairs = ivec(loop.slot_hash, loop.n_hash), ivec(loop.slot_pair, loop.n_slots)
    # multiplication by 2^32 over the golden ratio squared spreads consecutive numbers (Knuth 1998, section 6.4)
    at = ((pair % 2147483648) * 1640531527 % 4294967296 // 256) % loop.n_hash
    while table[at] != 0 and pairs[table[at] - 1] != pair:
        at = (at + 1) % loop.n_hash
    return at


@internal
def find_pair(loop: Any, one: int, other: int, number: int) -> None:
    """Shapes one and other are near, as sweep `number` has found."""
    shapes, marks = shapes_at(loop.shapes, loop.n_shapes), ivec(loop.broad, MARKS)
    if shapes[one].group != shapes[other].group:
        return
    pair = 1 + min(one, other) * loop.n_shapes + max(one, other)
    if _is_excluded(loop, pair):
        return
    at = _place_of(loop, pair)
    table, new = ivec(loop.slot_hash, loop.n_hash), ivec(loop.new_pairs, loop.n_slots)
    if table[at] != 0:
        k = ivec(loop.slot_contact, loop.n_slots)[table[at] - 1]
        ivec(loop.pair_found, k + 1)[k] = number
        return
    if marks[NEW_PAIRS] < loop.n_slots:
        new[marks[NEW_PAIRS]] = pair
    marks[NEW_PAIRS] += 1


@internal
def _is_excluded(loop: Any, pair: int) -> bool:
    excluded, low, high = ivec(loop.excluded, loop.n_excluded), 0, loop.n_excluded
    while low < high:
        middle = (low + high) // 2
        if excluded[middle] < pair:
            low = middle + 1
        else:
            high = middle
    return low < loop.n_excluded and excluded[low] == pair


@internal
def find_half_spaces(loop: Any, ball: int, centre: Any, reach: float, number: int) -> None:
    """The half-spaces that the ball of this sphere comes near."""
    shapes, groups = shapes_at(loop.shapes, loop.n_shapes), groups_at(loop.groups, loop.n_groups)
    sphere = ivec(loop.ball_shape, loop.n_balls)[ball]
    group = groups[shapes[sphere].group]
    last = group.first_shape + group.shapes - 1
    while last >= group.first_shape and shapes[last].half_space != 0:
        height = 0.0
        for i in range(3):
            height += shapes[last].axes[6 + i] * (centre[i] - shapes[last].point[i])
        if height <= reach:
            find_pair(loop, sphere, last, number)
        last -= 1


@internal
def bind_new(workspace: Any, loop: Any, number: int) -> bool:
    """Slots for the new pairs: those that no pair has, then those of pairs that are open and that the sweep with this
    number has not found. False, with nothing done, if they are too few."""
    marks, groups = ivec(loop.broad, MARKS), groups_at(loop.groups, loop.n_groups)
    if marks[NEW_PAIRS] > loop.n_slots:
        return False
    for group in range(loop.n_groups):
        if _new_of(loop, group) > _free_of(workspace, loop, group, number):
            return False
    new, pairs = ivec(loop.new_pairs, loop.n_slots), ivec(loop.slot_pair, loop.n_slots)
    for group in range(loop.n_groups):
        first, count, place = groups[group].first_slot, groups[group].slots, 0
        for p in range(marks[NEW_PAIRS]):
            if _group_of(loop, new[p]) != group:
                continue
            # those that no pair has first; then once more from the first slot on
            while not _is_free(workspace, loop, first + place % count, place < count, number):
                place += 1
            pairs[first + place % count] = new[p]
            bind_slot(workspace, loop, first + place % count, number)
    return True


@internal
def _group_of(loop: Any, pair: int) -> int:
    return int(shapes_at(loop.shapes, loop.n_shapes)[(pair - 1) // loop.n_shapes].group)


@internal
def _new_of(loop: Any, group: int) -> int:
    """New pairs of a group."""
    count, new = 0, ivec(loop.new_pairs, loop.n_slots)
    for p in range(ivec(loop.broad, MARKS)[NEW_PAIRS]):
        count += 1 if _group_of(loop, new[p]) == group else 0
    return count


@internal
def _free_of(workspace: Any, loop: Any, group: int, number: int) -> int:
    """Slots of a group that new pairs may take."""
    count, own = 0, groups_at(loop.groups, loop.n_groups)[group]
    for slot in range(own.first_slot, own.first_slot + own.slots):
        free = _is_free(workspace, loop, slot, True, number) or _is_free(workspace, loop, slot, False, number)
        count += 1 if free else 0
    return count


@internal
def _is_free(workspace: Any, loop: Any, slot: int, never_bound: bool, number: int) -> bool:
    pair, k = ivec(loop.slot_pair, loop.n_slots)[slot], ivec(loop.slot_contact, loop.n_slots)[slot]
    if never_bound:
        return pair == NO_PAIR
    if pair == NO_PAIR or ivec(loop.pair_found, workspace.n_contacts)[k] == number:
        return False
    if memories_at(workspace.memory, workspace.n_contacts)[k].mode != OPEN:
        return False
    return not _is_coded(workspace, workspace.structure, k) and not _is_coded(workspace, workspace.kept, k)


@internal
def _is_coded(workspace: Any, structure: int, k: int) -> bool:
    """True if contact k has a place in the structure at this address; 0: there is none."""
    return bool(structure != 0 and ivec(structure_at(structure).codes, workspace.n_contacts)[k] != APART)


@internal
def bind_slot(workspace: Any, loop: Any, slot: int, number: int) -> None:
    """Tables, memory and structures for the pair that has this slot now."""
    k = ivec(loop.slot_contact, loop.n_slots)[slot]
    write_tables(workspace, loop, slot)
    memory = memories_at(workspace.memory, workspace.n_contacts)[k]
    # what it has done stays in the accounts of the slot
    memory.mode, memory.approach_speed, memory.largest_approach = OPEN, 0.0, 0.0
    memory.slide_mode, memory.slide_start = 0.0, 0.0
    memory.friction_ratio, memory.closed_gap, memory.begun_impulse, memory.begun_loss = 0.0, 0.0, 0.0, 0.0
    memory.implied_rows, memory.laid_mass, memory.tangent_angle, memory.tangent_axis = 0.0, 0.0, 0.0, 0.0
    memory.sliding_lean, memory.slow_sliding = 0.0, 0.0
    for i in range(6):
        memory.step_force[i] = 0.0
    ivec(workspace.sleeping, workspace.n_contacts)[k] = DEEPLY
    vec(loop.brackets, BRACKET * workspace.n_contacts)[BRACKET * k + HAPPENS] = 0.0
    ivec(loop.pair_found, workspace.n_contacts)[k] = number


@internal
def write_tables(workspace: Any, loop: Any, slot: int) -> None:
    """The pair of this slot to the tables of its contact, unless they have it."""
    pair, bound = ivec(loop.slot_pair, loop.n_slots)[slot], ivec(loop.bound_pair, loop.n_slots)
    if pair == bound[slot]:
        return
    k = ivec(loop.slot_contact, loop.n_slots)[slot]
    bound[slot] = pair
    _forget_structures(workspace, k)
    shapes, batch = shapes_at(loop.shapes, loop.n_shapes), probe_of(loop, k)
    # the last two shapes are those of slots that no pair has
    first, second = loop.n_shapes - 1, loop.n_shapes - 2
    if pair != NO_PAIR:
        first, second = (pair - 1) // loop.n_shapes, (pair - 1) % loop.n_shapes
    if shapes[second].half_space != 0:
        first, second = second, first
    a, b = shapes[first], shapes[second]
    par, coord = vec(batch.par, batch.npar), ivec(batch.coord, batch.ncoord)
    par[GAP_KIND], par[RADIUS_A], par[RADIUS_B] = DISTANCE, a.radius, b.radius
    if a.half_space != 0:
        par[GAP_KIND] = PLACE
    par[PAIR_AT], par[PAIR_AT + 1] = a.rest, b.rest
    for i in range(3):
        par[PAIR_AT + POINT_A + i], par[PAIR_AT + POINT_B + i] = a.point[i], b.point[i]
    for i in range(9):
        par[PAIR_AT + AXES_A + i], par[PAIR_AT + AXES_B + i] = a.axes[i], b.axes[i]
    for i in range(7):
        coord[i], coord[7 + i] = a.coord[i], b.coord[i]


@internal
def _forget_structures(workspace: Any, k: int) -> None:
    """Structures with a place for contact k were those of another pair."""
    building = building_at(workspace.building)
    places = ivec(building.structures, building.n_slots)
    for i in range(building.n_slots):
        if structure_at(places[i]).built != 0 and _is_coded(workspace, places[i], k):
            structure_at(places[i]).built = 0


@internal
def write_all_tables(workspace: Any, loop: Any) -> None:
    """Tables for the pairs that have the slots, where another state has been taken."""
    for slot in range(loop.n_slots):
        write_tables(workspace, loop, slot)
