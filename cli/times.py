"""Times at which a run is recorded."""

from .options import check_samples


def times_of(t_end: float, every: float) -> list[float]:
    """0, every, 2 every ... and the end, s. Raises BadParameter for more than can be kept."""
    check_samples(t_end, every, "--every")
    count = int(t_end / every * (1.0 + 1e-12))
    times = [min(k * every, t_end) for k in range(count + 1)]
    return times if times[-1] >= t_end * (1.0 - 1e-12) else [*times, t_end]
