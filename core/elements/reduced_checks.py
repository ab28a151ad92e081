"""What tables of reduced bodies have to be, in the plane and in space: their sizes, symmetry and signs."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..rounding import SYMMETRY


def check_size(body: str, name: str, value: Any, size: tuple[int, ...], modes: str) -> None:
    """Refuse a table `name` of another size than `size`, which follows from the rows of the table `modes`."""
    if value is None:
        return
    try:
        found: Any = np.array(value, dtype=float).shape
    except ValueError:
        found = "rows of different length"
    if found != size:
        raise ValueError(f"{name} of '{body}' has {found}, but {modes} rows: {size} is needed")


def check_symmetry(body: str, name: str, value: Any, sign: float = 1.0) -> None:
    """Refuse a matrix that is not symmetric, or with `sign` -1 not skew."""
    x = np.zeros((1, 1)) if value is None else np.array(value)
    wrong = np.abs(x - sign * x.T)
    if wrong.max() > SYMMETRY * np.abs(x).max():
        i, j = np.unravel_index(int(np.argmax(wrong)), x.shape)
        kind = "symmetric" if sign > 0.0 else "skew"
        raise ValueError(
            f"{name} of '{body}' must be {kind}; entries ({i}, {j}) and ({j}, {i}) are {x[i, j]:g} and {x[j, i]:g}"
        )


def check_sign(body: str, name: str, value: Any, why: str) -> None:
    """Refuse a matrix whose symmetric part has a negative eigenvalue."""
    if value is None:
        return
    found = np.linalg.eigvalsh(0.5 * (np.array(value) + np.array(value).T))
    if found[0] < -SYMMETRY * np.abs(found).max():
        raise ValueError(
            f"{name} of '{body}' has, in its symmetric part, the negative eigenvalue {found[0]:.3g}: {why}"
        )


def check_mass(body: str, full: NDArray[np.float64]) -> None:
    """Refuse a mass matrix of frame and modes that is not positive definite."""
    scale = np.sqrt(np.maximum(np.diag(full), 1e-300))
    least = float(np.linalg.eigvalsh(full / np.outer(scale, scale))[0])
    if least <= SYMMETRY:
        raise ValueError(
            f"the mass matrix of frame and modes of '{body}', scaled to a unit diagonal, has the eigenvalue "
            f"{least:.3g}: it must be positive definite; do the modes hold a rigid motion, which the frame has already?"
        )
