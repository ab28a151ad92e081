"""Where coordinates tie as dependent ones, rounding does not choose: runs that begin one rounding apart stay so."""

import numpy as np
import pytest
from tlismni.core import Simulation
from tlismni.core.linalg import pivot_rows
from tlismni.models import load


@pytest.mark.parametrize("less", [0.0, 1e-15, 1e-12, 1e-9])
def test_the_lowest_of_equal_columns(less):
    for values in ([1.0, 1.0 - less, 0.5], [1.0 - less, -1.0, 0.5]):
        assert pivot_rows(1, 3, [0, 3], [0, 1, 2], values).pivot_column.tolist() == [0]
    # what follows has lost a digit or two
    second = pivot_rows(2, 3, [0, 3, 6], [0, 1, 2, 0, 1, 2], [4.0, 1.0, 1.0, 4.0, 3.0 - less, 3.0])
    assert second.pivot_column.tolist() == [0, 1]


def test_the_largest_of_others():
    assert pivot_rows(1, 2, [0, 2], [0, 1], [1.0, 1.0 + 1e-5]).pivot_column.tolist() == [1]
    nothing = pivot_rows(2, 2, [0, 1, 1], [1], [2.0])
    assert nothing.pivot_column.tolist() == [1, -1] and nothing.rank == 1


@pytest.mark.parametrize("parameter", [{"width": 0.21}, {"height": 1.096}, {"tilt": 0.1575}, {}])
def test_a_block_that_starts_one_rounding_lower(parameter):
    """The corner that it stands on is as far below its centre as the model's length: x and the angle tie."""
    scenario = load("rocking_block", **parameter)
    (block,) = scenario.model.bodies
    runs = []
    for toward in (None, 9.0, -9.0):
        x, y = block.position
        lower = block.model_copy(update={"position": (x, y if toward is None else float(np.nextafter(y, toward)))})
        model = scenario.model.model_copy(update={"bodies": (lower,)})
        sim = Simulation(model, scenario.method, rtol=scenario.rtol, atol=scenario.atol)
        dependent, rows = sim.workspace.structure.dependent.tolist(), [sim.values()]
        for k in range(1, 13):
            sim.advance(scenario.t_end * k / 12.0)
            rows.append(sim.values())
        runs.append((dependent, np.array(rows)))
    size = np.max(np.abs(runs[0][1]), axis=0) + 1.0
    for dependent, rows in runs[1:]:
        assert dependent == runs[0][0]
        assert np.max(np.abs(rows - runs[0][1]) / size) < 1e-10
