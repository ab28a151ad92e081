"""Cross-checks of contacts that are closed or touch at the start, that carry nothing, or that nothing strikes: there is
no approach speed, impulse or duration to be relative to."""

import math
from itertools import product

import pytest
from tlismni.core import (
    AppliedForce2D,
    CoulombFriction,
    Disk2D,
    DiskOnHalfPlane2D,
    Flores,
    HalfPlane2D,
    Hertz,
    HuntCrossley,
    KelvinVoigt,
    KuwabaraKono,
    Marker2D,
    Model,
    NewtonImpact,
    PointMass2D,
    Step,
    Tsuji,
    simulate,
)
from tlismni.validation import crosscheck, run_exudyn
from tlismni.validation.errors import NotTranslatable
from tlismni.validation.exudyn_import import exudyn_available

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")
K, T_END = 1e5, 0.01
FORCES = [
    Hertz(stiffness=K, exponent=1.0), KelvinVoigt(stiffness=K, damping=50.0),
    KelvinVoigt(stiffness=K, damping=50.0, release_rule="gap"),
    HuntCrossley(stiffness=K, restitution=0.5, exponent=1.0),
    Flores(stiffness=K, restitution=0.3), Tsuji(stiffness=K, damping=50.0),
    KuwabaraKono(stiffness=K, relaxation_time=1e-4),
]  # fmt: skip
HARD = [NewtonImpact(restitution=0.0), NewtonImpact(restitution=0.5)]
STARTS = {
    "pressed in": {"height": -1e-3}, "laid": {}, "touching, without weight": {"gravity": 0.0},
    "above, without weight": {"height": 0.1, "gravity": 0.0}, "pressed in and leaving": {"height": -1e-4, "speed": 1.0},
    "leaving": {"speed": 1.0},
}  # fmt: skip


def ball(law, height=0.0, gravity=9.81, speed=0.0, friction=None):
    disk = Disk2D(marker=Marker2D(body="ball"))
    body = PointMass2D(name="ball", mass=1.0, position=(0.0, height), velocity=(0.0, speed))
    floor = DiskOnHalfPlane2D(name="floor", plane=HalfPlane2D(), disk=disk, law=law, friction=friction)
    return Model(name="ball", gravity=(0.0, -gravity), bodies=[body], contacts=[floor])


def compared(model, step=2e-5, **options):
    found = crosscheck(model, t_end=T_END, step=step, refine=False, **options)
    assert found.rows
    assert all(math.isfinite(row.ours) and math.isfinite(row.exudyn) for row in found.rows)
    assert found.ok, [(row.quantity, row.ours, row.exudyn) for row in found.rows if row.verdict == "differ"]
    return found


def by_force():
    """Each law from one of the starts at least, each start with one of the laws; the other pairs with `-m full`."""
    for law, start in product(FORCES, STARTS):
        yield pytest.param(law, start, id=f"{law.type}-{start}")


@pytest.mark.sampled(len(FORCES))
@pytest.mark.parametrize("law, start", list(by_force()))
def test_by_force(law, start):
    compared(ball(law, **STARTS[start]))


@pytest.mark.sampled(3)
@pytest.mark.parametrize("law, start", list(product(HARD, [s for s in STARTS if "pressed" not in s])))
def test_as_a_constraint(law, start):
    compared(ball(law, **STARTS[start]), step=1e-4)


@pytest.mark.sampled(2)
@pytest.mark.parametrize("law", [HARD[1], FORCES[1], FORCES[3]], ids=lambda law: law.type)
@pytest.mark.parametrize("start", ["laid", "touching, without weight"])
def test_over_the_whole_run(law, start):
    compared(ball(law, **STARTS[start]), step=1e-4 if law is HARD[1] else 2e-5, whole=True)


def test_coulomb_friction_is_refused_in_words_over_the_whole_run():
    model = ball(HARD[1], friction=CoulombFriction(coefficient=0.3))
    with pytest.raises(NotTranslatable, match="Coulomb friction"):
        crosscheck(model, t_end=T_END, step=1e-4, refine=False, whole=True)


def test_a_blow_beside_a_contact_that_starts_pressed_is_compared():
    """The first of the events has no approach; the impact that comes later has."""
    held = ball(KelvinVoigt(stiffness=K, damping=50.0), height=-9.81e-5)
    falling = PointMass2D(name="second", mass=1.0, position=(1.0, 2e-5), velocity=(0.0, -0.1))
    stop = DiskOnHalfPlane2D(
        name="stop", plane=HalfPlane2D(), disk=Disk2D(marker=Marker2D(body="second")), law=NewtonImpact(restitution=0.5)
    )
    model = held.model_copy(update={"bodies": (*held.bodies, falling), "contacts": (*held.contacts, stop)})
    found = crosscheck(model, t_end=1.2e-3, refine=False)
    assert found.ok
    assert any(row.quantity == "stop: impulse" and row.verdict == "agree" for row in found.rows)


def test_exudyn_s_own_contact_that_pulls_is_run_as_a_function():
    """A force draws the ball out of a blow, soon faster than v0/D."""
    struck = ball(Flores(stiffness=1e6, restitution=0.3), height=1e-4, gravity=0.0, speed=-0.5)
    pull = AppliedForce2D(name="pull", marker=Marker2D(body="ball"), force_y=Step(time=5e-4, after=5e4))
    model = struck.model_copy(update={"forces": (pull,)})
    found = run_exudyn(model, 1e-3, 1e-6)
    assert found["floor.normal_force"].min() >= 0.0
    assert any("exudyn's own contact pulls" in note for note in found.notes)
    mine = simulate(model, 1e-3, rtol=1e-9, atol=1e-12)
    assert mine["floor.normal_force"].min() >= 0.0
    assert found["ball.vy"][-1] == pytest.approx(mine["ball.vy"][-1], rel=1e-2)
