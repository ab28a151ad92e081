"""Rates of contacts with two tangents, what impulses do to them, and the problem of their friction cones."""

from typing import Any

from ..compiled.jit import internal
from ..compiled.views import ivec, mat, vec
from ..cones.friction_cones import FOUND, solve_friction_cones
from ..linalg.small import call_least_norm
from ..rounding import DIRECTION_RANK, FRICTION_NEAR, STICKS_STILL
from ..tables.held import in_space
from .forces import cones_at
from .records import COS_WAY, COUNT, RATE, SIN_WAY, SLIDE_RATE, SWAY_RATE, TURNS, col, whole


@internal
def masses(ev: Any, count: int) -> Any:
    """Inverse effective masses (3 count, 3 count): normals, first and second tangents, 1/kg."""
    return mat(ev.space_a, 3 * count, 3 * count)


@internal
def pressing(ev: Any, count: int) -> Any:
    """The same for forces that last: normal forces come with their torques against rolling and spinning."""
    return mat(ev.pressing_a if whole(ev)[TURNS] != 0 else ev.space_a, 3 * count, 3 * count)


@internal
def read_in_space(ev: Any, ws: Any, level: Any, of_gap: Any, of_slide: Any, of_sway: Any) -> None:
    """Normals' and tangents' rows of a level of the touching contacts; zeros along tangents without friction."""
    contacts = ivec(ev.contacts, ev.most)
    rows, slides = ivec(ws.contact_rows, ws.n_contacts), ivec(ws.contact_slide_rows, ws.n_contacts)
    static = vec(ws.contact_sticking, ws.n_contacts)
    for i in range(whole(ev)[COUNT]):
        k = contacts[i]
        rubs = slides[k] >= 0 and static[k] > 0.0
        of_gap[i] = level[rows[k]]
        of_slide[i] = level[slides[k]] if rubs else 0.0
        of_sway[i] = level[slides[k] + 1] if rubs and in_space(ws, k) else 0.0


@internal
def read_rates_in_space(ev: Any, ws: Any) -> None:
    """Rates of gaps and of sliding, as the residuals have been evaluated last."""
    read_in_space(ev, ws, vec(ws.phid, ws.m_ext), col(ev, RATE), col(ev, SLIDE_RATE), col(ev, SWAY_RATE))


@internal
def push_in_space(ev: Any, ws: Any, p: Any) -> None:
    """Add the velocities that impulses p (3 count,) cause; rates follow."""
    count, v = whole(ev)[COUNT], vec(ws.v, ws.n_ext)
    responses, a = mat(ev.responses, 3 * count, ws.n), masses(ev, count)
    for i in range(3 * count):
        if p[i] == 0.0:
            continue
        for j in range(ws.n):
            v[j] += p[i] * responses[i, j]
        for j in range(count):
            col(ev, RATE)[j] += p[i] * a[j, i]
            col(ev, SLIDE_RATE)[j] += p[i] * a[count + j, i]
            col(ev, SWAY_RATE)[j] += p[i] * a[2 * count + j, i]


@internal
def _spread(least_norm: int, n: int, a: Any, b: Any, mu: Any, known: Any, p: Any, work: int) -> None:
    """Friction of contacts that stick is not unique where they hold each other: of all that leave the same motion take
    the one that is farthest from its limits, by the sum of squares, if it is within them all."""
    m, fastest, held = 3 * n, 0.0, 0
    for i in range(m):
        fastest = max(fastest, abs(b[i]))
    sticking, matrix = ivec(work, n), work + 8 * n
    for i in range(n):
        speed = 0.0
        for block in range(1, 3):
            w = b[block * n + i]
            for j in range(m):
                w += a[block * n + i, j] * p[j]
            speed = max(speed, abs(w))
        if known[i] == 0.0 and mu[i] * p[i] > 0.0 and speed <= STICKS_STILL * fastest:
            sticking[held] = i
            held += 1
    if held < 2:
        return
    shares, effect = mat(matrix, m, 2 * held), mat(matrix + 8 * 2 * m * held, m, 1)
    found = mat(matrix + 8 * (2 * m * held + m), 2 * held, 1)
    for i in range(m):
        effect[i, 0] = 0.0
        for k in range(held):
            for block in range(2):
                j = (block + 1) * n + sticking[k]
                shares[i, 2 * k + block] = a[i, j] * mu[sticking[k]] * p[sticking[k]]
                effect[i, 0] += a[i, j] * p[j]
    call_least_norm(least_norm, shares, effect, found, DIRECTION_RANK, matrix + 8 * (2 * m * held + m + 2 * held))
    largest = 0.0
    for k in range(held):
        largest = max(largest, found[2 * k, 0] ** 2 + found[2 * k + 1, 0] ** 2)
    # (their limits as well as the forces are known)
    if largest > 1.0 + FRICTION_NEAR:
        return
    for k in range(held):
        for block in range(2):
            p[(block + 1) * n + sticking[k]] = found[2 * k + block, 0] * mu[sticking[k]] * p[sticking[k]]


@internal
def solve_cones_in_space(
    ev: Any, a: Any, count: int, part: Any, b: Any, mu: Any, base: Any, known: Any, p: Any
) -> bool:
    """Forces p (3 count,) of the contacts `part` from inverse masses a and the motion b (3 count,); the others get
    none."""
    n, some = 0, ivec(ev.some, 3 * ev.most)
    for i in range(count):
        if part[i] != 0.0:
            some[n] = i
            n += 1
    # room: matrix, motion, coefficients, forces, directions
    own = mat(ev.space_room, 3 * n, 3 * n)
    room = vec(ev.space_room + 8 * 9 * n * n, 12 * n)
    own_b, own_p, own_mu = room[: 3 * n], room[3 * n : 6 * n], room[6 * n : 7 * n]
    own_base, own_known = room[7 * n : 8 * n], room[8 * n : 9 * n]
    way = mat(ev.space_room + 8 * (9 * n * n + 9 * n), 2, n)
    for i in range(n):
        p_i = some[i]
        own_mu[i], own_base[i], own_known[i] = mu[p_i], base[p_i], known[p_i]
        way[0, i], way[1, i] = col(ev, COS_WAY)[p_i], col(ev, SIN_WAY)[p_i]
        for block in range(3):
            own_b[block * n + i] = b[block * count + p_i]
            for j in range(n):
                for other in range(3):
                    own[block * n + i, other * n + j] = a[block * count + p_i, other * count + some[j]]
    status = solve_friction_cones(
        cones_at(ev.cones).least_norm, n, own, own_b, own_mu, own_base, own_known, way, own_p,
        ev.space_room + 8 * (9 * n * n + 11 * n),
    )  # fmt: skip
    for i in range(3 * count):
        p[i] = 0.0
    if status != FOUND:
        return False
    _spread(
        cones_at(ev.cones).least_norm, n, own, own_b, own_mu, own_known, own_p, ev.space_room + 8 * (9 * n * n + 11 * n)
    )
    for i in range(n):
        for block in range(3):
            p[block * count + some[i]] = own_p[block * n + i]
    return True
