"""A contact that has opened keeps no multiplier, which no stage would solve for and formulas would extrapolate."""

import numpy as np
import pytest
from tlismni.core import Model, NewtonImpact
from tlismni.core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from tlismni.core.elements import AppliedForce2D, PointMass2D, SpringDamper2D
from tlismni.core.model.markers import Marker2D
from tlismni.core.model.signals import Ramp
from tlismni.core.simulation.simulation import Simulation

GRAVITY, RATE, FREQUENCY, AMPLITUDE = 9.81, 40.0, 1500.0, 1e-3


def lifted_block() -> Model:
    """A mass of 1 kg on the ground, pulled up by a force that grows; another beside it vibrates on a spring, softening
    as it turns, so that steps are many and differ."""
    block = PointMass2D(name="block", mass=1.0, position=(0.0, 0.1))
    other = PointMass2D(name="other", mass=1.0, position=(5.0 + AMPLITUDE, 0.0), velocity=(0.0, 30.0))
    lift = AppliedForce2D(
        name="lift",
        marker=Marker2D(body="block"),
        force_y=Ramp(start=0.0, duration=10.0, before=0.0, after=10.0 * RATE),
    )
    spring = SpringDamper2D(
        name="spring", a=Marker2D(point=(4.0, 0.0)), b=Marker2D(body="other"), stiffness=FREQUENCY**2,
        natural_length=1.0,
    )  # fmt: skip
    ground = DiskOnHalfPlane2D(
        name="floor", plane=HalfPlane2D(marker=Marker2D()), disk=Disk2D(marker=Marker2D(body="block"), radius=0.1),
        law=NewtonImpact(restitution=0.0),
    )  # fmt: skip
    return Model(name="lift", gravity=(0.0, -GRAVITY), bodies=(block, other), forces=(lift, spring), contacts=(ground,))


@pytest.mark.parametrize("method, options", [("adams", {"order": 8}), ("ebdf", {"k": 6}), ("newmark", {})])
def test_a_contact_that_has_opened_keeps_no_multiplier(method: str, options: dict[str, int]) -> None:
    sim = Simulation(lifted_block(), method, 1e-6, 1e-8, **options)
    sim.run_to(0.3)
    (opened,) = [e for e in sim.events if e.kind == "open"]
    assert opened.t == pytest.approx(GRAVITY / RATE, abs=1e-7)
    n = 4 * sim.assembly.n_extended
    rows = sim.method_arrays["ring"][1]
    assert np.all(sim.method_arrays["history"][:rows, n:] == 0.0)
    height = sim.values()[[c.name for c in sim.channels].index("block.y")]
    assert height == pytest.approx(0.1 + RATE * (0.3 - opened.t) ** 3 / 6.0, abs=1e-7)
