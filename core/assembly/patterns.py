"""Which entries of S and Phi_q the elements of a model have, flat: what structures are built from (`entries.py`)."""

import numpy as np
from numpy.typing import NDArray

from ..contacts.geometry_kinds import SHOWN
from .assembly import Assembly

FEW = 8
"""Contacts that are counted where the size of structures is estimated."""
Numbers = NDArray[np.int64]


def patterns(assembly: Assembly) -> dict[str, Numbers]:
    """Tables by field of BUILDING."""
    batches = assembly.batches
    contacts = [np.asarray(batch.contact, dtype=np.int64) for batch in batches]
    of_s = [np.array(batch.tangent_pattern, dtype=np.int64).reshape(-1, 2) for batch in batches]
    of_j = [np.array(batch.jacobian_pattern, dtype=np.int64).reshape(-1, 2) for batch in batches]
    tables = {"of_contacts": np.array([bool(np.any(x >= 0)) for x in contacts], dtype=np.int64)}
    for name, start, parts in (
        ("element_contact", "element_start", contacts), ("s_pattern", "s_start", of_s), ("j_pattern", "j_start", of_j),
    ):  # fmt: skip
        tables[name] = np.concatenate([np.zeros(0, dtype=np.int64), *(part.ravel() for part in parts)])
        tables[start] = np.cumsum([0, *(len(part) for part in parts)]).astype(np.int64)
    alone = np.array([batch is not None for batch, _, _ in contacts_alone(assembly)], dtype=np.int64)
    tables["listed"] = 1 - alone
    return tables


def shows(assembly: Assembly, number: int) -> bool:
    """True if the kernel of this batch may look at those elements alone that are asked for."""
    of = np.asarray(assembly.batches[number].contact)
    return bool(len(of)) and bool(np.all(of >= 0)) and assembly.contacts[int(of[0])].kind in SHOWN


def contacts_alone(assembly: Assembly) -> list[tuple[int | None, int, int]]:
    """Of each contact the batch that holds its elements, side by side, with the first of them and how many there are;
    None for contacts whose elements are here and there, or which have none of their own: these can be evaluated with
    the whole system only."""
    found: list[tuple[int | None, int, int]] = [(None, 0, 0)] * len(assembly.contacts)
    scattered: set[int] = set()
    for number, batch in enumerate(assembly.batches):
        of = np.asarray(batch.contact)
        edges = np.flatnonzero(np.diff(of, prepend=-1, append=-1))
        for first, end in zip(edges[:-1].tolist(), edges[1:].tolist(), strict=True):
            k = int(of[first])
            if k < 0:
                continue
            if k in scattered or found[k][0] is not None:
                scattered.add(k)
                found[k] = (None, 0, 0)
            else:
                found[k] = (number, first, end - first)
    return found


def entries_of_few(assembly: Assembly, contacts: int) -> tuple[int, int]:
    """Entries of S and of Phi_q of all elements that are no contacts, and of so many contacts."""
    of_s = of_j = most_s = most_j = 0
    for batch in assembly.batches:
        of = np.asarray(batch.contact)
        others = int(np.sum(of < 0))
        of_s, of_j = of_s + others * len(batch.tangent_pattern), of_j + others * len(batch.jacobian_pattern)
        if others < len(of):
            elements = int(np.max(np.bincount(of[of >= 0])))
            most_s = max(most_s, elements * len(batch.tangent_pattern))
            most_j = max(most_j, elements * len(batch.jacobian_pattern))
    few = min(contacts, len(assembly.contacts))
    return of_s + few * most_s, of_j + few * most_j
