"""The cross-check: agreement where both solve the same, and a fault that is seeded is found. The pendulum against a
stop by force is compared in tests/examples/test_site.py, as a page does it."""

import json
import math
from pathlib import Path
from typing import Any

import pytest
from tlismni.core.elements import PointMass2D
from tlismni.core.multibody_model import Model
from tlismni.models import ScenarioError, load
from tlismni.validation import CrossCheck, ExudynUnavailable, NotTranslatable, Row, crosscheck
from tlismni.validation.exudyn_import import exudyn_available
from tlismni.validation.report import render

needs_exudyn = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")


def row(found: CrossCheck, part: str) -> Row:
    """The one row whose quantity contains `part`."""
    (match,) = [r for r in found.rows if part in r.quantity]
    return match


def verdicts(found: CrossCheck) -> dict[str, str]:
    return {r.quantity: r.verdict for r in found.rows}


@pytest.mark.sampled(1)
@needs_exudyn
@pytest.mark.parametrize(
    "law",
    ["hertz", "kelvin_voigt", "hunt_crossley", "carvalho_martins", "lankarani_nikravesh", "flores", "gonthier"],
)
def test_every_force_law_agrees(law: str) -> None:
    found = crosscheck("bouncing_ball", law=law, stiffness=1e5, height=0.3, t_end=0.9)
    assert found.ok, verdicts(found)
    # the force of Kelvin-Voigt jumps at first touch, which limits what exudyn's fixed steps can decide
    assert law == "kelvin_voigt" or not found.undecided, verdicts(found)


@pytest.mark.sampled(1)
@needs_exudyn
@pytest.mark.parametrize("restitution", [1.0, 0.5])
def test_constraint_contact_is_the_penalty_limit(restitution: float) -> None:
    found = crosscheck("bouncing_ball", restitution=restitution, height=0.3, t_end=0.7)
    assert found.ok, verdicts(found)
    assert row(found, "impulse").ours == pytest.approx((1.0 + restitution) * math.sqrt(2.0 * 9.81 * 0.3))


@needs_exudyn
def test_chain_agrees_with_extrapolated_trajectories() -> None:
    found = crosscheck("chain", links=2, t_end=1.0)
    assert found.ok and not found.undecided, verdicts(found)


def with_inertia(model: Model, factor: float) -> Model:
    """The model with the inertia of all its bodies changed."""
    bodies = tuple(b.model_copy(update={"inertia": factor * b.inertia}) for b in model.bodies)
    return model.model_copy(update={"bodies": bodies})


@needs_exudyn
def test_a_wrong_inertia_is_found_in_contact() -> None:
    scenario = load("pendulum_stop", law="flores", stiffness=1e6)
    found = crosscheck(scenario, exudyn_model=with_inertia(scenario.model, 1.01), t_end=1.5)
    assert not found.ok
    assert row(found, "start").verdict == "differ"


@needs_exudyn
def test_a_wrong_inertia_is_found_in_motion() -> None:
    scenario = load("chain", links=2)
    found = crosscheck(scenario, exudyn_model=with_inertia(scenario.model, 1.001), t_end=0.5)
    assert not found.ok


@pytest.mark.sampled(1)
@needs_exudyn
@pytest.mark.parametrize("law", ["newton", "hunt_crossley"])
def test_one_per_cent_of_restitution_is_found(law: str) -> None:
    given = load("bouncing_ball", law=law, restitution=0.8, stiffness=1e6, height=0.3)
    wrong = load("bouncing_ball", law=law, restitution=0.808, stiffness=1e6, height=0.3)
    found = crosscheck(given, exudyn_model=wrong.model, t_end=0.7)
    assert not found.ok
    assert row(found, "separation speed").verdict == "differ"
    assert row(found, "approach speed").verdict == "agree"


@needs_exudyn
def test_a_model_of_ones_own_can_be_checked() -> None:
    model = Model(name="falling", bodies=(PointMass2D(name="p", mass=1.0, velocity=(1.0, 2.0)),))
    assert crosscheck(model, t_end=0.5).ok
    with pytest.raises(ValueError, match="needs t_end"):
        crosscheck(model)
    with pytest.raises(ValueError, match="by name"):
        crosscheck(model, t_end=0.5, restitution=0.3)


@needs_exudyn
def test_a_run_that_ends_before_its_first_impact_is_compared() -> None:
    found = crosscheck("bouncing_ball", t_end=0.1)
    assert found.ok and any("ball.y" in r.quantity and r.verdict == "agree" for r in found.rows)


@needs_exudyn
def test_what_cannot_be_compared_is_said() -> None:
    with pytest.raises(NotTranslatable, match="Coulomb friction"):
        crosscheck("rocking_block", whole=True, t_end=0.01, step=5e-4)
    with pytest.raises(ScenarioError, match="did you mean"):
        crosscheck("pendulum_stp")


@needs_exudyn
def test_report_and_figures_are_written(tmp_path: Path) -> None:
    pytest.importorskip("matplotlib")
    pytest.importorskip("jinja2")
    told: list[str] = []
    found = crosscheck("chain", tmp_path / "new", told.append, links=1, t_end=0.2)
    assert len(told) >= 3
    (figure,) = found.figures
    assert figure.read_bytes().startswith(b"\x89PNG")
    assert found.report is not None
    text = found.report.read_text(encoding="utf-8")
    assert "link1.angle" in text and "data:image/png;base64," in text
    numbers = json.loads((tmp_path / "new" / "chain_crosscheck.json").read_text(encoding="utf-8"))
    assert numbers["ok"] is True
    assert {r["verdict"] for r in numbers["rows"]} == {"agree"}
    assert render(found) == text


@pytest.mark.parametrize(
    "fields, verdict",
    [
        ({"ours": 1.0, "exudyn": 1.0005}, "agree"),
        ({"ours": 1.0, "exudyn": 1.01}, "differ"),
        ({"ours": 1.0, "exudyn": 1.01, "uncertainty": 0.02}, "undecided"),
        ({"ours": 1.0, "exudyn": 1.0005, "uncertainty": 0.01}, "undecided"),
        ({"ours": 1.0, "exudyn": 1.0005, "ours_uncertainty": math.inf}, "undecided"),
        ({"ours": 1.0, "exudyn": 1.0005, "uncertainty": 0.01, "required": False}, "agree"),
        ({"ours": math.nan, "exudyn": 1.0, "uncertainty": 1.0}, "differ"),
        ({"ours": 1e-9, "exudyn": 0.0}, "differ"),
        ({"ours": 0.0, "exudyn": 0.0}, "agree"),
        ({"ours": 0.0, "exudyn": 0.01, "scale": 100.0}, "agree"),
    ],
)
def test_verdicts(fields: dict[str, Any], verdict: str) -> None:
    assert Row("x", "m", tolerance=1e-3, tolerance_kind="relative", **fields).verdict == verdict


def test_missing_exudyn_is_said_before_anything_is_run(monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(name: str) -> Any:
        raise ImportError("libGL.so.1: cannot open shared object file")

    monkeypatch.setattr("tlismni.validation.exudyn_import.importlib.import_module", refuse)
    with pytest.raises(ExudynUnavailable, match="libgl1"):
        crosscheck("chain")


@needs_exudyn
@pytest.mark.parametrize("name, words", [("hub_beam_stop", "nearest route: a Cable2D"), ("rod_wall", "massless ends")])
def test_what_has_no_equal_in_exudyn_is_refused(name: str, words: str) -> None:
    given = {"massless_contact": True} if name == "rod_wall" else {}
    with pytest.raises(NotTranslatable, match=words):
        crosscheck(name, **given)
