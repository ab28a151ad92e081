"""A contact whose force has ended before the shapes come apart: it presses again where the law's force comes back."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from tlismni.core import Disk2D, DiskOnHalfPlane2D, HalfPlane2D, KelvinVoigt, Marker2D, Model, PointMass2D, simulate

G, STIFFNESS, DAMPING = 10.0, 1000.0, 20.0


def drop(speed):
    law = KelvinVoigt(stiffness=STIFFNESS, damping=DAMPING, release_rule="force")
    disk = Disk2D(marker=Marker2D(body="mass"))
    return Model(
        gravity=(0.0, -G),
        bodies=[PointMass2D(name="mass", mass=1.0, velocity=(0.0, -speed))],
        contacts=[DiskOnHalfPlane2D(name="floor", plane=HalfPlane2D(), disk=disk, law=law)],
    )


def forced(t, state):
    """The mass on a spring and a damper that only push."""
    y, v = state
    return v, -G + (max(0.0, -STIFFNESS * y - DAMPING * v) if y < 0.0 else 0.0)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("method", ["ebdf", "irk"])
@pytest.mark.parametrize("speed", [1.3, 1.35, 1.4, 1.45, 1.8])
def test_gravity_presses_it_again_while_it_still_separates(speed, method):
    """Between 1.3 and 1.4 m/s the force ends, and comes back before the mass has left and even before it turns."""
    result = simulate(drop(speed), 0.4, method, rtol=1e-10, atol=1e-12, t_eval=np.linspace(0.02, 0.4, 20))
    assert any(event.kind == "open" for event in result.events)
    exact = solve_ivp(
        forced, (0.0, 0.4), (0.0, -speed), "DOP853", t_eval=result.t, rtol=1e-11, atol=1e-13, max_step=1e-4
    )
    assert result["mass.y"] == pytest.approx(exact.y[0], abs=1e-6)
    assert np.ptp(result["energy.balance"]) < 1e-7
