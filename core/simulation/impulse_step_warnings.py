"""What steps of impulses that are too long do to a run, as warnings in the log: overlaps, and energy from nowhere."""

import logging

import numpy as np
from numpy.typing import NDArray

from ..assembly.assembly import Assembly
from ..assembly.sample_layout import SampleLayout
from ..laws import ImpactLaw
from ..state.pool_records import NO_PAIR

logger = logging.getLogger(__name__)
DEEP = 0.05
"""Of the distance over which two shapes could pass through each other."""
GAIN = 1e-3
"""Of the largest kinetic energy in the samples: what contacts may add between two of them."""


def warn_of_overlap(samples: NDArray[np.float64], assembly: Assembly, layout: SampleLayout) -> None:
    """Log a warning with the deepest overlap of rigid shapes, where that is more than a small part of their size.

    Steps of impulses find contacts at their ends: what moves by much of its size in a step overlaps there, and position
    corrections push it apart by degrees."""
    contacts = [k for k, contact in enumerate(assembly.contacts) if isinstance(contact.law, ImpactLaw)]
    if not contacts or not len(samples):
        return
    extents = np.array([assembly.contacts[k].extent for k in contacts])
    finite = extents[np.isfinite(extents)]
    extents[~np.isfinite(extents)] = np.min(finite, initial=assembly.length)
    parts = -samples[:, layout.gap + np.array(contacts)] / extents
    row, place = np.unravel_index(np.argmax(parts), parts.shape)
    if not parts[row, place] > DEEP:
        return
    k, sample = contacts[int(place)], samples[row]
    name = assembly.contacts[k].name
    if assembly.pool is not None and k in assembly.pool.contacts:
        slot = int(np.flatnonzero(assembly.pool.contacts == k)[0])
        number = int(sample[layout.slot_pairs][slot])
        name = assembly.pool.name_of(number) if number != NO_PAIR else name
    logger.warning(
        "at t = %.6g s the shapes of contact '%s' overlap by %.3g m, and they could pass through each other within "
        "%.3g m: steps are too long for what moves so fast; give a smaller `step`, in which nothing moves by more than "
        "a small part of its size",
        sample[0], name, -sample[layout.gap + k], extents[int(place)],
    )  # fmt: skip


def warn_of_energy(samples: NDArray[np.float64], contacts: int, layout: SampleLayout) -> None:
    """Log a warning with the most energy that contacts have added between two samples, where that is not next to
    nothing.

    Restitution by Newton's law may raise the energy where several contacts with friction are struck at once (Kane and
    Levinson 1985), and so do shapes that overlap and are pushed apart."""
    if len(samples) < 2:
        return
    lost = np.sum(samples[:, layout.loss_jump : layout.loss_jump + contacts], axis=1)
    added, largest = -np.diff(lost), float(np.max(samples[:, layout.kinetic]))
    row = int(np.argmax(added))
    if not added[row] > GAIN * largest:
        return
    logger.warning(
        "between t = %.6g and %.6g s contacts added %.3g J to the motion, whose largest kinetic energy is %.3g J: by "
        "restitution of several contacts with friction at once, or since overlapping shapes are pushed apart; give a "
        "smaller `step` or less restitution, or take a method that locates events, such as 'ebdf'",
        samples[row, 0], samples[row + 1, 0], added[row], largest,
    )  # fmt: skip
