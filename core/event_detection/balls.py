"""Which balls the broad phase sweeps over, and which contacts are between two of them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly, Batch
from ..assembly.patterns import contacts_alone
from ..compiled.jit import internal
from ..compiled.views import mat
from ..contacts.geometry_kinds import DISKS, SPHERE
from ..contacts.moving_point3d import HOLLOW, ON_CABLE, POINT_OF_CABLE, SUPPORT
from ..contacts.normal3d import EXTENT_A, EXTENT_B, GAP_KIND, PAIR_AT, RADIUS_A, RADIUS_B
from ..elements.measure3d import PLACE, POINT_A, POINT_B
from .contact_evaluation import probe_of

IN_SPACE, WHO, SIDE = 7, 8, 9
BALL_INTEGERS = 10
"""Columns of `ball_coords`: the coordinates of the body that carries the ball, three in the plane and seven in space;
whether it is of space; a contact that it belongs to (-1: it is a shape of a pool), and whether it is its second
shape."""
BALL_POINT, BALL_RADIUS, BALL_REST = 0, 3, 4
BALL_NUMBERS = 5
"""Columns of `balls`: the centre on its body, the radius, and what is added to the body's first Euler parameter."""
BALL_MOVES = 7
CENTRE, SKIN, THICK_SKIN, RELATIVE_WAY, WHOLE_WAY = 0, 3, 4, 5, 6
"""Columns of `ball_moves`, m: where the centre was at the last sweep; the skins for the way relative to the mean of all
balls and for the whole way; upper bounds of both ways within the present step."""
BALL_POLYGON = 15
"""Columns of `ball_polygons`: differences of the control points of a centre's path within the present step, m."""
MARKS = 6
VALID, PAIRS_FOUND, ORDERED, SWEEP_DUE, NEW_PAIRS, WITHOUT_SLOT = range(MARKS)
"""Entries of `broad`: whether the last sweep holds, its number, whether there is an order of the balls, whether skins
are too thick, how many pairs that came near have had no slot of their pool yet, and for how many there is none."""
FEWEST = 24
"""Contacts between balls from which on a sweep pays."""
SHARED = 2
"""Contacts that each ball has at least, on average, or a sweep does not pay."""
ENDLESS = (PLACE, SUPPORT, POINT_OF_CABLE, ON_CABLE, HOLLOW)
"""Kinds of gaps of which one shape has no end, bends, or holds the other in it."""
_SUM, _FIRST = 5, 6
"""Columns of the parameters of two disks: the sum of their radii, and the first one."""


def build_balls(assembly: Assembly) -> dict[str, NDArray[Any]]:
    """The arrays of the loop's record that `broad_phase.py` needs. Balls about the same point of a body are one; which
    are so decides how much work there is, never what is found."""
    keys, contacts = _sides(assembly)
    unique, which = np.unique(keys, axis=0, return_inverse=True)
    if len(contacts) < max(FEWEST, SHARED * len(unique)):
        keys, contacts, unique, which = keys[:0], contacts[:0], unique[:0], np.zeros(0, dtype=np.int64)
    n, which = len(unique), which.reshape(-1, 2)
    coords, pooled = np.zeros((n, BALL_INTEGERS), dtype=np.int64), _pooled(assembly)
    coords[:, : IN_SPACE + 1] = unique[:, : IN_SPACE + 1]
    for side in range(2):
        coords[which[:, side], WHO], coords[which[:, side], SIDE] = contacts, side
    turned = which[:, 0] > which[:, 1]
    first, other = np.where(turned, which[:, 1], which[:, 0]), np.where(turned, which[:, 0], which[:, 1])
    order = np.lexsort((other, first))
    found = np.full(max(len(assembly.contacts), 1), -1, dtype=np.int64)
    found[contacts] = 0
    if assembly.pool is not None:
        found[assembly.pool.contacts] = 0
    every = n + len(pooled["balls"])  # those of pools come last, as `take_pool_numbers` expects
    return {
        "ball_coords": np.concatenate([coords, pooled["coords"]]),
        "balls": np.concatenate([np.zeros((n, BALL_NUMBERS)), pooled["balls"]]),
        "ball_shape": np.concatenate([np.full(n, -1, dtype=np.int64), pooled["shapes"]]),
        "ball_moves": np.zeros((every, BALL_MOVES)), "ball_polygons": np.zeros((every, BALL_POLYGON)),
        "ball_reach": np.zeros(every), "ball_order": np.zeros(every, dtype=np.int64),
        "pair_start": np.searchsorted(first[order], np.arange(every + 1)).astype(np.int64),
        "pair_other": other[order].astype(np.int64), "pair_contact": contacts[order],
        "pair_turned": turned[order].astype(np.int64), "pair_found": found, "broad": np.zeros(MARKS, dtype=np.int64),
    }  # fmt: skip


def _pooled(assembly: Assembly) -> dict[str, NDArray[Any]]:
    """Balls of the spheres of contact pools."""
    pool = assembly.pool
    of = (
        np.zeros(0, dtype=np.int64)
        if pool is None
        else np.flatnonzero((pool.shapes["half_space"] == 0) & (pool.shapes["group"] >= 0))
    )
    coords, balls = np.zeros((len(of), BALL_INTEGERS), dtype=np.int64), np.zeros((len(of), BALL_NUMBERS))
    if pool is not None:
        shapes = pool.shapes[of]
        coords[:, :IN_SPACE], coords[:, IN_SPACE], coords[:, WHO] = shapes["coord"], 1, -1
        balls[:, BALL_POINT : BALL_POINT + 3] = shapes["point"]
        balls[:, BALL_RADIUS], balls[:, BALL_REST] = shapes["radius"], shapes["rest"]
    return {"coords": coords, "balls": balls, "shapes": of.astype(np.int64)}


def take_pool_numbers(arrays: Mapping[str, NDArray[Any]], assembly: Assembly) -> None:
    """Points and radii of the spheres of contact pools, of another assembly of the same tables, to the record's
    arrays."""
    own = _pooled(assembly)["balls"]
    arrays["balls"][len(arrays["balls"]) - len(own) :] = own


def _sides(assembly: Assembly) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
    """Of each contact between two balls what tells both, one after another, and the contacts, (m,)."""
    keys, contacts = [np.zeros((0, IN_SPACE + 1 + BALL_NUMBERS))], [np.zeros(0, dtype=np.int64)]
    massless, alone = assembly.massless_contacts, contacts_alone(assembly)
    for number, batch in enumerate(assembly.batches):
        here = [
            (k, e)
            for k, (x, e, _) in enumerate(alone)
            if x == number and k not in massless and not assembly.contacts[k].pooled
        ]
        kind = assembly.contacts[here[0][0]].kind if here else -1
        if kind not in (DISKS, SPHERE):
            continue
        of, at = np.array(here, dtype=np.int64).T
        if kind == SPHERE:
            ends = ~np.isin(batch.par[at, GAP_KIND], ENDLESS)
            of, at = of[ends], at[ends]
        both = np.stack([_told(batch, kind, at, side) for side in range(2)], axis=1)
        keys.append(both.reshape(2 * len(at), both.shape[2]))
        contacts.append(of)
    return np.concatenate(keys), np.concatenate(contacts)


def _told(batch: Batch, kind: int, at: NDArray[np.int64], side: int) -> NDArray[np.float64]:
    """What tells the centre of the ball on this side of the contacts whose elements are `at`."""
    width = 7 if kind == SPHERE else 3
    key = np.zeros((len(at), IN_SPACE + 1 + BALL_NUMBERS))
    key[:, :width], key[:, IN_SPACE] = batch.coord[at, width * side : width * (side + 1)], kind == SPHERE
    par, ball = batch.par[at], key[:, IN_SPACE + 1 :]
    if kind == DISKS:
        ball[:, BALL_POINT : BALL_POINT + 2] = par[:, 2 * side : 2 * side + 2]
        return key
    place = PAIR_AT + (POINT_B if side else POINT_A)
    ball[:, BALL_POINT : BALL_POINT + 3] = par[:, place : place + 3]
    return key


@internal
def tell_ball(loop: Any, k: int, side: int, in_space: int, ball: Any) -> None:
    """Point, radius and rest (BALL_NUMBERS,) of one shape of contact k, as its parameters are now."""
    batch = probe_of(loop, k)
    par = mat(batch.par, batch.count, batch.npar)[0]
    if in_space == 0:
        ball[BALL_POINT], ball[BALL_POINT + 1], ball[BALL_POINT + 2] = par[2 * side], par[2 * side + 1], 0.0
        ball[BALL_RADIUS], ball[BALL_REST] = par[_FIRST] if side == 0 else par[_SUM] - par[_FIRST], 0.0
        return
    at = PAIR_AT + (POINT_A if side == 0 else POINT_B)
    for i in range(3):
        ball[BALL_POINT + i] = par[at + i]
    ball[BALL_RADIUS] = par[RADIUS_A] + par[EXTENT_A] if side == 0 else par[RADIUS_B] + par[EXTENT_B]
    ball[BALL_REST] = par[PAIR_AT + side]
