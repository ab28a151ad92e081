"""A fault that is seeded into one side is found by the cross-check: each of them, in each kind of comparison."""

from collections.abc import Callable
from typing import Any

import pytest
from tlismni.core import Model
from tlismni.core.model.signals import Constant
from tlismni.models import Scenario, load
from tlismni.validation import CrossCheck, crosscheck
from tlismni.validation.exudyn_import import exudyn_available

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="exudyn cannot be imported")
Fault = Callable[[Model], Model]


def replaced(kind: str, name: str, **update: Any) -> Fault:
    """The model with fields of one of its elements changed, unchecked."""

    def fault(model: Model) -> Model:
        elements = [e.model_copy(update=update) if e.name == name else e for e in getattr(model, kind)]
        return model.model_copy(update={kind: tuple(elements)})

    return fault


def scaled_law(field: str, factor: float) -> Fault:
    def fault(model: Model) -> Model:
        contacts = []
        for contact in model.contacts:
            value = factor * getattr(contact.law, field)
            contacts.append(contact.model_copy(update={"law": contact.law.model_copy(update={field: value})}))
        return model.model_copy(update={"contacts": tuple(contacts)})

    return fault


def scaled(field: str, factor: float) -> Fault:
    """A field of all bodies that have it."""

    def fault(model: Model) -> Model:
        bodies = [
            b.model_copy(update={field: factor * getattr(b, field)}) if hasattr(b, field) else b for b in model.bodies
        ]
        return model.model_copy(update={"bodies": tuple(bodies)})

    return fault


def upwards(model: Model) -> Model:
    return model.model_copy(update={"gravity": (model.gravity[0], -model.gravity[1], model.gravity[2])})


BALL: dict[str, Any] = {"height": 0.3, "stiffness": 1e6}
FAULTS: list[tuple[str, str, dict[str, Any], float, Fault]] = [
    ("wrong sign of a torque, in a constraint contact", "slider_crank_stop", {}, 0.4,
     replaced("forces", "drive", torque=Constant(value=-1.0))),
    ("wrong sign of a spring, in a force contact", "impact_oscillator", {"law": "hunt_crossley", "step": 2e-5}, 1.4,
     replaced("forces", "spring", stiffness=-1.0)),
    ("wrong sign of the weight, in smooth motion", "pendulum", {}, 1.0, upwards),
    ("wrong sign of the weight of a cable", "cantilever", {"damping_time": 1e-4, "elements": 4}, 0.1, upwards),
    ("factor 2 in a force law", "bouncing_ball", {"law": "hunt_crossley", **BALL}, 0.7, scaled_law("stiffness", 2.0)),
    ("factor 2 in a damping", "bouncing_ball", {"law": "kelvin_voigt_gap", "step": 2e-6, **BALL}, 0.7,
     scaled_law("damping", 2.0)),
    ("factor 2 in the stiffness of a rod", "rod_wall", {"elements": 20}, 1.1e-3, scaled("axial_stiffness", 2.0)),
    ("wrong inertia, in smooth motion", "slider_crank", {}, 0.2, scaled("inertia", 1.02)),
    ("wrong inertia, in a constraint contact", "pendulum_stop", {}, 1.4, scaled("inertia", 1.02)),
    ("wrong inertia, in a force contact", "pendulum_stop", {"law": "flores", "stiffness": 1e6}, 1.4,
     scaled("inertia", 1.02)),
    ("1 % in restitution, as a constraint", "bouncing_ball", {"restitution": 0.8, **BALL}, 0.7,
     scaled_law("restitution", 1.01)),
    ("1 % in restitution, by force", "bouncing_ball", {"law": "hunt_crossley", "restitution": 0.8, **BALL}, 0.7,
     scaled_law("restitution", 1.01)),
]  # fmt: skip


def checked(name: str, parameters: dict[str, Any], t_end: float, fault: Fault | None) -> CrossCheck:
    given = dict(parameters)
    step = given.pop("step", None)
    scenario: Scenario = load(name, **given)
    other = None if fault is None else fault(scenario.model)
    return crosscheck(scenario, exudyn_model=other, t_end=t_end, step=step)


TWICE = ("wrong inertia, in a force contact", "1 % in restitution, as a constraint", "1 % in restitution, by force")
"""Found in test_crosscheck.py, too, where more is asked of them: here with `-m full`."""


@pytest.mark.sampled(3)
@pytest.mark.parametrize(
    "kind, what, name, parameters, t_end, fault",
    [pytest.param(f[0][:8], *f, id=f[0], marks=[pytest.mark.full] if f[0] in TWICE else []) for f in FAULTS],
)
def test_a_seeded_fault_is_found(
    kind: str, what: str, name: str, parameters: dict[str, Any], t_end: float, fault: Fault
) -> None:
    """The sample has each kind: signs, factors, inertias."""
    found = checked(name, parameters, t_end, fault)
    assert not found.ok, what


@pytest.mark.sampled(1)
@pytest.mark.parametrize(
    "name, parameters, t_end",
    sorted({(f[1], tuple(f[2].items()), f[3]) for f in FAULTS if f[1] in ("impact_oscillator", "cantilever")}),
)
def test_without_the_fault_they_agree(name: str, parameters: Any, t_end: float) -> None:
    """For the cases that no other test runs: else a comparison that always differs would pass."""
    found = checked(name, dict(parameters), t_end, None)
    assert found.ok, [(r.quantity, r.relative) for r in found.rows if r.verdict == "differ"]
