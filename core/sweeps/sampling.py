"""Points of a sweep: grids, and samples of ranges."""

from collections.abc import Mapping, Sequence
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..errors import ModelError

Sampling = Literal["random", "latin", "sobol"]
Points = dict[str, NDArray[np.float64]]

MOST_RUNS = 100_000_000


def grid(axes: Mapping[str, ArrayLike]) -> Points:
    """All combinations of the values of each axis, (runs,) by name; the last axis changes fastest.

    Raises
    ------
    ModelError : for an axis without values, or with values that are no finite numbers.
    """
    values = {name: _axis(name, x) for name, x in axes.items()}
    if not values:
        raise ModelError("name at least one parameter to vary and its values, such as {'restitution': [0.5, 0.7]}")
    count = 1
    for x in values.values():
        count *= len(x)
    if count > MOST_RUNS:
        raise ModelError(f"the grid has {count:.3g} points, more than {MOST_RUNS:.0e}: take fewer values, or sample")
    mesh = np.meshgrid(*values.values(), indexing="ij")
    return {name: x.ravel().copy() for name, x in zip(values, mesh, strict=True)}


def sampled(
    ranges: Mapping[str, Sequence[float]], count: int, sampling: Sampling | str = "latin", seed: int = 0
) -> Points:
    """`count` points within the ranges (low, high) of each name, (count,) by name.

    Parameters
    ----------
    sampling : "random": independent; "latin": a Latin hypercube, each of count equal parts of every range is hit once;
        "sobol": a scrambled Sobol sequence (count best a power of two).
    seed : the same seed gives the same points.

    Raises
    ------
    ModelError : for a range that is none, or an unknown kind of sampling.
    """
    from scipy.stats import qmc

    if not ranges:
        raise ModelError("name at least one parameter to vary and its range, such as {'restitution': (0.5, 0.9)}")
    if isinstance(count, bool) or not isinstance(count, int) or not 0 < count <= MOST_RUNS:
        raise ModelError(f"samples must be a whole number of at least 1, not {count!r}")
    for name, bounds in ranges.items():
        ends = _axis(name, bounds)
        if len(ends) != 2 or not ends[0] < ends[1]:
            raise ModelError(f"'{name}': a range (low, high) with low < high is needed to sample it, not {bounds!r}")
    low, high = np.array([tuple(map(float, bounds)) for bounds in ranges.values()]).T
    if sampling == "random":
        unit = np.random.default_rng(seed).random((count, len(ranges)))
    elif sampling == "latin":
        unit = qmc.LatinHypercube(len(ranges), rng=np.random.default_rng(seed)).random(count)
    elif sampling == "sobol":
        unit = qmc.Sobol(len(ranges), rng=np.random.default_rng(seed)).random(count)
    else:
        raise ModelError(f"there is no sampling '{sampling}'; there are 'random', 'latin' and 'sobol'")
    values = qmc.scale(unit, low, high)
    return {name: np.ascontiguousarray(values[:, k]) for k, name in enumerate(ranges)}


def _axis(name: str, values: Any) -> NDArray[np.float64]:
    try:
        x = np.atleast_1d(np.asarray(values, dtype=np.float64))
    except (TypeError, ValueError):
        raise ModelError(f"'{name}': numbers are needed, not {values!r}") from None
    if x.ndim != 1 or len(x) == 0 or not np.all(np.isfinite(x)):
        raise ModelError(f"'{name}': a list of finite numbers is needed, not {values!r}")
    return x
