"""A sweep's parts on a Dask cluster."""

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError, SimulationError
from ..extras import require
from .problem import Outcomes, Problem
from .store import Store

CONNECT = 30.0
"""Longest time to wait for the scheduler, s."""
AHEAD = 4
"""Parts that are with the cluster at one time, for each of its threads: the rest waits here, where nothing is lost."""


@contextmanager
def client_of(cluster: Any) -> Iterator[Any]:
    """A client of the scheduler at an address ("tcp://host:8786"), or the one that was given.

    Raises
    ------
    MissingExtraError : without Dask. ModelError : if no scheduler answers.
    """
    require("a sweep on a cluster", "sweep", dask="", distributed="")
    from distributed import Client

    if isinstance(cluster, Client):
        yield cluster
        return
    try:
        client = Client(cluster, timeout=CONNECT)
    except (OSError, TimeoutError, ValueError) as error:
        raise ModelError(
            f"no Dask scheduler answers at {cluster!r} ({error}): start one with `dask scheduler`, workers with "
            "`dask worker ADDRESS --nthreads 1`, and give the address that it prints"
        ) from None
    with client:
        yield client


def run_part(problem: Problem, points: Mapping[str, NDArray[np.float64]]) -> Outcomes:
    """One part, by one thread: a cluster has a worker's thread for each core."""
    return problem.run(points, 1)


def run_on_cluster(cluster: Any, problem: Problem, store: Store, done: Any) -> None:
    """Let the cluster answer all parts that are missing; each is kept as soon as it is answered.

    A worker that dies gives its unfinished parts back to Dask, which hands them to others.

    Raises
    ------
    SimulationError : if a part has been lost with several workers; all others are kept.
    """
    with client_of(cluster) as client:
        from distributed import as_completed

        missing = iter(store.missing())
        numbers: dict[Any, int] = {}
        lost: list[tuple[int, BaseException]] = []

        def submit() -> Any:
            k = next(missing, None)
            if k is None:
                return None
            future = client.submit(run_part, problem, store.points_of(k), pure=False)
            numbers[future.key] = k
            return future

        threads = max(1, sum(client.nthreads().values()))
        first = [future for _ in range(AHEAD * threads) if (future := submit()) is not None]
        queue = as_completed(first)
        for future in queue:
            k = numbers.pop(future.key)
            error = future.exception()
            if error is None:
                store.put(k, future.result())
                done(k)
            else:
                lost.append((k, error))
            future.release()
            if (following := submit()) is not None:
                queue.add(following)
    if lost:
        k, error = lost[0]
        raise SimulationError(
            f"{len(lost)} of {store.parts} parts have no answers, part {k} (runs {k * store.size} on) because of "
            f"{type(error).__name__}: {error}. All others are kept: the same sweep again asks for these alone",
            t=0.0,
            loop="sweep",
        ) from error
