"""The page on the contact problem: docs/contact-problem.md runs and gives what it says."""

import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

PAGE = (Path(__file__).parents[2] / "docs" / "contact-problem.md").read_text()


def test_the_code_runs() -> None:
    names: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE, re.S):
        exec(block, names)
    impact = names["impact"]
    assert impact.converged and set(impact.modes) == {"slip"}
    assert impact.forces[::3].sum() == pytest.approx(1.0, rel=1e-10)
    assert 2.5 < names["after"][0] < 3.0 and names["after"][2] == pytest.approx(0.0, abs=1e-11)
    least = names["solve_friction"](
        names["J"] * names["inverse_mass"] @ names["J"].T, names["J"] @ names["velocity"], 0.4, least=True
    )
    assert least.least and np.ptp(least.forces[::3]) > 0.01
