"""Attitudes in many frames at once: unit quaternions, scalar part first."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
STILL = np.array([1.0, 0.0, 0.0, 0.0])


def matrices(p: Floats) -> Floats:
    """Axes as columns (..., 3, 3) of unit quaternions (..., 4)."""
    e0, e = p[..., 0], p[..., 1:]
    cross = np.zeros((*p.shape[:-1], 3, 3))
    cross[..., 0, 1], cross[..., 0, 2], cross[..., 1, 2] = -e[..., 2], e[..., 1], -e[..., 0]
    cross[..., 1, 0], cross[..., 2, 0], cross[..., 2, 1] = e[..., 2], -e[..., 1], e[..., 0]
    outer = e[..., :, None] * e[..., None, :]
    whole = (e0**2 - np.sum(e * e, axis=-1))[..., None, None] * np.eye(3)
    found: Floats = whole + 2.0 * outer + 2.0 * e0[..., None, None] * cross
    return found


def towards(direction: Floats) -> Floats:
    """The shortest turns (N, 4) that bring z to these directions (N, 3); none where there is no direction."""
    size = np.linalg.norm(direction, axis=-1, keepdims=True)
    unit = np.divide(direction, size, out=np.tile([0.0, 0.0, 1.0], (*direction.shape[:-1], 1)), where=size > 0.0)
    p = np.stack([1.0 + unit[..., 2], -unit[..., 1], unit[..., 0], 0.0 * unit[..., 2]], axis=-1)
    p[np.linalg.norm(p, axis=-1) < 1e-7] = (0.0, 1.0, 0.0, 0.0)
    return p / np.linalg.norm(p, axis=-1, keepdims=True)


def nearest(p: Floats) -> Floats:
    """The same attitudes (F, 4), each with the sign that is nearer to the one before, of length 1."""
    found = p / np.linalg.norm(p, axis=-1, keepdims=True)
    dots = np.sum(found[1:] * found[:-1], axis=1)
    signs = np.cumprod(np.concatenate([[1.0], np.where(dots < 0.0, -1.0, 1.0)]))
    result: Floats = found * signs[:, None]
    return result
