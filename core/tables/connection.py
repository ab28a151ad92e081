"""Which contacts elements connect, and with how many tangents their instants are decided by that."""

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from .assembly import Assembly


def connected(n: int, elements: Iterable[NDArray[np.int64]]) -> NDArray[np.int64]:
    """The part of the mechanism that each of the n coordinates belongs to, (n,): `elements` are the coordinates of each
    element, which connects them; numbers from n on are none. A part is named by one of its coordinates."""
    of = list(range(n))

    def part(i: int) -> int:
        while of[i] != i:
            of[i] = of[of[i]]
            i = of[i]
        return i

    for coordinates in elements:
        own = [int(i) for i in coordinates if i < n]
        for i in own[1:]:
            of[part(i)] = part(own[0])
    return np.array([part(i) for i in range(n)], dtype=np.int64)


def contact_tangents(assembly: Assembly) -> NDArray[np.int64]:
    """With how many tangents the instants of each contact are decided, (contacts,): as many as friction has in its part
    of the mechanism, 1 in the plane and 2 in space; in a model with friction of one kind, as many as there."""
    contacts = assembly.contacts
    kinds = {contact.tangents for contact in contacts if contact.coulomb}
    if len(kinds) < 2:
        return np.full(len(contacts), assembly.tangents, dtype=np.int64)
    parts = connected(assembly.n, [coord for batch in assembly.batches for coord in batch.coord])
    own = {}
    for batch in assembly.batches:
        for k, coord in zip(batch.contact, batch.coord, strict=True):
            if k >= 0:
                own[int(k)] = int(parts[coord[coord < assembly.n][0]])
    spatial = {own[k] for k, contact in enumerate(contacts) if contact.coulomb and contact.tangents == 2}
    return np.array([2 if own[k] in spatial else 1 for k in range(len(contacts))], dtype=np.int64)
