"""Rates of contacts with two tangents, what impulses do to them, and the problem of their friction cones."""

from typing import Any

from ..assembly.sticking_force import in_space
from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..contact_solvers.directions import call_farthest
from ..contact_solvers.friction_cones import CONES_SOLVED, MOST_SWEEPS, SWEEPS, solve_friction_cones
from ..contact_solvers.least_forces import take_least_forces
from ..contact_solvers.planar_contacts import MANY
from ..contact_solvers.projections import motion_left, motion_of
from ..rounding import FRICTION_GOOD, STICKS_STILL
from .independent_directions import cones_at
from .pivot_in_plane import has_one_tangent, pivot_in_plane
from .records import scalars, touching


@internal
def masses(instant: Any, count: int) -> Any:
    """Inverse effective masses (3 count, 3 count): normals, first and second tangents, 1/kg."""
    return mat(instant.space_a, 3 * count, 3 * count)


@internal
def pressing(instant: Any, count: int) -> Any:
    """The same for forces that last: normal forces come with their torques against rolling and spinning."""
    return mat(instant.pressing_a if scalars(instant).contact_torques != 0 else instant.space_a, 3 * count, 3 * count)


@internal
def read_level(instant: Any, workspace: Any, level: Any, of_gap: Any, of_slide: Any, of_sway: Any) -> None:
    """Normals' and tangents' rows of a level of the touching contacts; zeros along tangents without friction."""
    contacts = ivec(instant.contacts, instant.most)
    rows, slides = (
        ivec(workspace.contact_rows, workspace.n_contacts),
        ivec(workspace.contact_slide_rows, workspace.n_contacts),
    )
    static = vec(workspace.contact_sticking, workspace.n_contacts)
    for i in range(scalars(instant).count):
        k = contacts[i]
        rubs = slides[k] >= 0 and static[k] > 0.0
        of_gap[i] = level[rows[k]]
        of_slide[i] = level[slides[k]] if rubs else 0.0
        of_sway[i] = level[slides[k] + 1] if rubs and in_space(workspace, k) else 0.0


@internal
def read_all_rates(instant: Any, workspace: Any) -> None:
    """Rates of gaps and of sliding, as the residuals have been evaluated last."""
    contact = touching(instant)
    read_level(
        instant,
        workspace,
        vec(workspace.phid, workspace.m_ext),
        contact.gap_rate,
        contact.sliding_rate,
        contact.sliding_rate2,
    )


@internal
def push(instant: Any, workspace: Any, p: Any) -> None:
    """Add the velocities that impulses p (3 count,) cause; rates follow."""
    contact = touching(instant)
    count, v = scalars(instant).count, vec(workspace.v, workspace.n_ext)
    responses, a = mat(instant.responses, 3 * count, workspace.n), masses(instant, count)
    for i in range(3 * count):
        if p[i] == 0.0:
            continue
        for j in range(workspace.n):
            v[j] += p[i] * responses[i, j]
        for j in range(count):
            contact[j].gap_rate += p[i] * a[j, i]
            contact[j].sliding_rate += p[i] * a[count + j, i]
            contact[j].sliding_rate2 += p[i] * a[2 * count + j, i]


@internal
def _repeat(instant: Any, n: int, a: Any, b: Any, known: Any, p: Any, work: int) -> bool:
    """True if rows of the contacts that press repeat each other, normals and tangents of those that stick, so that
    their forces p are not unique."""
    fastest, rows = 0.0, ivec(work, 3 * n)
    for i in range(3 * n):
        fastest = max(fastest, abs(b[i]))
    count = 0
    for block in range(3):
        for i in range(n):
            row = block * n + i
            counts = (block == 0 or known[i] == 0.0) and a[row, row] > 0.0
            if counts and abs(motion_of(a, b, p, row)) <= STICKS_STILL * fastest:
                rows[count] = row
                count += 1
    kept, room = ivec(work + 24 * n, 3 * n), vec(work + 48 * n, count * (count + 2))
    return int(call_farthest(instant.farthest, a, rows[:count], kept, room)) < count


@internal
def _connected(instant: Any, a: Any, count: int, left: Any) -> int:
    """The first contact that is `left`, and those that it moves, one by one, go to `some`; they are no more left. How
    many there are."""
    some, n = ivec(instant.some, 3 * instant.most), 0
    for i in range(count):
        if left[i] != 0.0:
            some[0], left[i], n = i, 0.0, 1
            break
    at = 0
    while at < n:
        p = some[at]
        for i in range(count):
            if left[i] != 0.0:
                together = i != p and i == p + int(touching(instant)[p].companion)
                for row in range(9):
                    if together or a[(row // 3) * count + p, (row % 3) * count + i] != 0.0:
                        some[n], left[i] = i, 0.0
                        n += 1
                        break
        at += 1
    # in the order of their numbers
    for k in range(1, n):
        i, at = some[k], k
        while at > 0 and some[at - 1] > i:
            some[at] = some[at - 1]
            at -= 1
        some[at] = i
    return n


@internal
def solve_cone_problem(
    instant: Any, a: Any, count: int, part: Any, b: Any, mu: Any, base: Any, known: Any, p: Any
) -> bool:
    """Forces p (3 count,) of the contacts `part` from inverse masses a and the motion b (3 count,); the others get
    none. Contacts that do not move each other are problems of their own."""
    left = vec(instant.unsolved, instant.most)
    for i in range(count):
        left[i] = part[i]
    for i in range(3 * count):
        p[i] = 0.0
    while True:
        n = _connected(instant, a, count, left)
        if n == 0:
            return True
        if not _solve_connected(instant, a, count, n, b, mu, base, known, p):
            return False


@internal
def _solve_connected(instant: Any, a: Any, count: int, n: int, b: Any, mu: Any, base: Any, known: Any, p: Any) -> bool:
    """`solve_cone_problem` of the first n contacts in `some`. With the compliances C of the contacts, the same for
    normal and tangents of each, it is the problem of equally compliant ones for C^1/2 P, C^-1/2 A C^-1/2 and C^-1/2 b:
    friction cones stay what they are."""
    contact = touching(instant)
    some, firmness = ivec(instant.some, 3 * instant.most), contact.firmness
    # room: matrix, motion, coefficients, forces, directions
    own = mat(instant.space_room, 3 * n, 3 * n)
    room = vec(instant.space_room + 8 * 9 * n * n, 12 * n)
    own_b, own_p, own_mu = room[: 3 * n], room[3 * n : 6 * n], room[6 * n : 7 * n]
    own_base, own_known = room[7 * n : 8 * n], room[8 * n : 9 * n]
    way = mat(instant.space_room + 8 * (9 * n * n + 9 * n), 3, n)
    for i in range(n):
        p_i, firm = some[i], firmness[some[i]]
        own_mu[i], own_base[i], own_known[i] = mu[p_i], base[p_i] / firm, known[p_i]
        way[0, i], way[1, i], step = contact[p_i].direction_cos, contact[p_i].direction_sin, int(contact[p_i].companion)
        way[2, i] = step if 0 <= i + step < n and some[i + step] == p_i + step else 0.0
        for block in range(3):
            own_b[block * n + i] = firm * b[block * count + p_i]
            for j in range(n):
                both = firm * firmness[some[j]]
                for other in range(3):
                    own[block * n + i, other * n + j] = both * a[block * count + p_i, other * count + some[j]]
    if not _recalled(instant, n) and not _solve_in_room(instant, n, some[0]):
        return False
    for i in range(n):
        p_i = some[i]
        for block in range(3):
            p[block * count + p_i] = firmness[p_i] * own_p[block * n + i]
        # less than the least by rounding would pull in the next problem
        p[p_i] = max(p[p_i], base[p_i])
    return True


@internal
def _recalled(instant: Any, n: int) -> bool:
    """True if the problem of n contacts in the room is the last one that was solved: then its forces are in the room
    too. An instant that wants memory is decided again from its beginning."""
    size = 9 * n * n + 12 * n
    room, kept = vec(instant.space_room, size), vec(instant.space_kept, size + 2)
    first, behind = 9 * n * n + 3 * n, 9 * n * n + 6 * n
    if kept[0] != n:
        return False
    for i in range(size):
        if room[i] != kept[2 + i] and not first <= i < behind:
            return False
    for i in range(first, behind):
        room[i] = kept[2 + i]
    if kept[1] != 0.0:
        scalars(instant).unshared_contact = int(kept[1])
    return True


@internal
def _keep_solved(instant: Any, n: int, unshared: int) -> None:
    size = 9 * n * n + 12 * n
    room, kept = vec(instant.space_room, size), vec(instant.space_kept, size + 2)
    kept[0], kept[1] = n, unshared
    for i in range(size):
        kept[2 + i] = room[i]


@internal
def _solve_in_room(instant: Any, n: int, who: int) -> bool:
    """Forces of the problem of n contacts in the room, of which `who` is one."""
    own = mat(instant.space_room, 3 * n, 3 * n)
    room = vec(instant.space_room + 8 * 9 * n * n, 12 * n)
    own_b, own_p, own_mu = room[: 3 * n], room[3 * n : 6 * n], room[6 * n : 7 * n]
    own_base, own_known = room[7 * n : 8 * n], room[8 * n : 9 * n]
    way = mat(instant.space_room + 8 * (9 * n * n + 9 * n), 3, n)
    work, least_norm = instant.space_room + 8 * (9 * n * n + 12 * n), cones_at(instant.cones).least_norm
    found, plane, unshared = False, n > 1 and has_one_tangent(n, own), 0
    for i in range(n):
        plane = plane and way[2, i] == 0.0
    # few contacts: sweeps are faster than pivoting, but for those that take many; many contacts: the other way round
    for attempt in range(3):
        if found or (attempt < 2 and not plane) or (attempt == 0 and n > MANY):
            continue
        if attempt == 1:
            found = pivot_in_plane(instant, n, own, own_b, own_mu, own_base, own_known, way, own_p)
            found = found and motion_left(n, own, own_b, own_mu, own_base, own_known, way, own_p) <= FRICTION_GOOD
        else:
            most = SWEEPS if attempt == 0 else MOST_SWEEPS
            found = solve_friction_cones(
                least_norm, n, own, own_b, own_mu, own_base, own_known, way, own_p, work, most
            ) == CONES_SOLVED  # fmt: skip
    if not found:
        return False
    if n > 1 and _repeat(instant, n, own, own_b, own_known, own_p, work):
        shared = take_least_forces(least_norm, n, own, own_b, own_mu, own_base, own_known, way, own_p, work)
        if not shared:
            scalars(instant).unshared_contact = unshared = 1 + ivec(instant.contacts, instant.most)[who]
    if n > 1:
        _keep_solved(instant, n, unshared)
    return True
