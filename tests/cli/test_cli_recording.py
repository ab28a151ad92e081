"""`tlismni run` of a large model does not fill the memory with its record."""

import pytest
from tlismni.cli.recording import LARGEST_RECORD, affordable_stride, record_bytes
from tlismni.models import load


def test_small_models_record_every_step() -> None:
    assert affordable_stride(load("pendulum_stop")) == 1
    assert affordable_stride(load("rod_wall")) == 1


@pytest.mark.parametrize("elements", [5_000, 50_000])
def test_large_models_record_as_many_steps_as_fit(elements: int) -> None:
    scenario = load("rod_wall", elements=elements)
    stride = affordable_stride(scenario)
    assert record_bytes(scenario) / stride <= LARGEST_RECORD < record_bytes(scenario) / (stride - 1)
