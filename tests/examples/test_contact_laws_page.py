"""The page of the contact laws: its code runs, its tables name every law and hold what the laws give."""

import math
import re
from pathlib import Path
from typing import Any

import pytest
from tlismni.core import laws
from tlismni.core.laws import FORCE_LAWS
from tlismni.core.laws.friction import FRICTION_LAWS
from tlismni.core.laws.friction.lugre import LuGreFriction
from tlismni.core.laws.hunt_crossley import HuntCrossleyFamily
from tlismni.models.laws import LAW_NAMES, contact_law

PAGE = (Path(__file__).parents[2] / "docs" / "contact-laws.md").read_text()
TABLE = PAGE.split("| law \\ e |")[1].split("\n\n")[0].splitlines()
REQUESTED = [float(x) for x in TABLE[0].strip("| ").split("|")]


def test_the_code_runs() -> None:
    names: dict[str, Any] = {}
    for block in re.findall(r"```python\n(.*?)```", PAGE, re.S):
        exec(block, names)
    assert names["law"].stiffness == pytest.approx(1.538e10, rel=5e-4)
    assert [event.kind for event in names["result"].events][:2] == ["close", "open"]
    # loading stores 1.2 of what the spring holds, unloading gives 0.8 of it back
    opened = names["result"].events[1]
    assert opened.separation_speed / opened.approach_speed == pytest.approx(math.sqrt(2.0 / 3.0), rel=1e-2)
    assert names["Spring"](stiffness=2.0).evaluate(0.5, 0.0, 1.0)[0] == 1.0


def test_every_law_stands_on_the_page() -> None:
    for law in FORCE_LAWS.values():
        assert f"| `{law.__name__}`" in PAGE
    for record in (*FRICTION_LAWS.values(), LuGreFriction):
        fields = set(record.model_fields) - {"type"}
        (row,) = [line for line in PAGE.splitlines() if line.startswith(f"| `{record.model_fields['type'].default}` ")]
        assert all(f"`{name}`" in row for name in fields), (record, fields)
    for name in LAW_NAMES:
        assert f"`{name}`" in PAGE or name == "newton"
        contact_law(name, restitution=0.5, stiffness=1e5, exponent=1.5, damping=None, mass=1.0)


@pytest.mark.parametrize("line", TABLE[2:])
def test_the_table_of_restitutions_solves_the_relation(line: str) -> None:
    name, *values = (cell.strip() for cell in line.strip("|").split("|"))
    law: type[HuntCrossleyFamily] = getattr(laws, re.findall("`(.*)`", name)[0])
    variant = {"variant": name.split(", ")[1]} if "," in name else {}
    for e, value in zip(REQUESTED, values, strict=True):
        factor = law(stiffness=1.0, restitution=e, **variant).damping_factor()

        def miss(out: float, d: float = factor) -> float:
            # d (1 + out) = ln((1 + d)/(1 - d out)), which grows without bound as d out goes to 1
            return math.log1p(d) - math.log1p(-d * out) - d * (1.0 + out) if d * out < 1.0 else math.inf

        found = float(value)
        assert miss(found - 5.1e-5) < 0.0 < miss(found + 5.1e-5)
