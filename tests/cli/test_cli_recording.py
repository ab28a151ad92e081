"""`tlismni run` of a large model does not fill the memory with its record."""

import pytest
from tlismni.cli.recording import FEWEST_TIMES, LARGEST_RECORD, affordable_times, record_bytes
from tlismni.models import load


def test_small_models_record_every_step() -> None:
    assert affordable_times(load("pendulum_stop")) is None
    assert affordable_times(load("rod_wall")) is None


@pytest.mark.parametrize("elements", [5_000, 50_000])
def test_large_models_record_as_many_times_as_fit(elements: int) -> None:
    scenario = load("rod_wall", elements=elements)
    times = affordable_times(scenario)
    assert times is not None and times[0] == 0.0 and times[-1] == pytest.approx(scenario.t_end, rel=1e-12)
    assert len(times) > FEWEST_TIMES and list(times) == sorted(times) and times[-1] <= scenario.t_end
    assert 8 * 3 * (elements + 1) * (len(times) - 1) <= LARGEST_RECORD < record_bytes(scenario)
