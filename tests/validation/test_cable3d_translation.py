"""A cable that swings through space with a weight at its end: exudyn's element goes the same way."""

import numpy as np
import pytest
from tlismni.core import Cable3D, Marker3D, MaterialPoint3D, Model, PointMass3D, RotationVector, Spherical3D, simulate
from tlismni.validation import ExudynSettings, run_exudyn
from tlismni.validation.exudyn_import import exudyn_available

pytestmark = pytest.mark.skipif(not exudyn_available(), reason="needs exudyn 1.13")
END = 0.25
SPIN = (0.0, 3.0, 2.0)


def conical() -> Model:
    attitude = RotationVector(vector=(0.0, 0.3, 0.0))
    cable = Cable3D(
        name="rope", elements=3, length=1.0, mass_per_length=0.3, axial_stiffness=4e3, bending_stiffness=0.2,
        axial_damping=20.0, attitude=attitude, angular_velocity=SPIN,
    )  # fmt: skip
    end = cable.start_shape()[-1, 0]
    weight = PointMass3D(name="weight", mass=0.2, position=tuple(end), velocity=tuple(np.cross(SPIN, end)))
    points = [
        MaterialPoint3D(name=name, body="rope", s=s) for name, s in (("root", 0.0), ("middle", 0.6), ("tip", 1.0))
    ]
    return Model(
        gravity=(0.0, 0.0, -9.81),
        bodies=[cable, weight, *points],
        joints=[
            Spherical3D(name="pin", a=Marker3D(), b=Marker3D(body="root")),
            Spherical3D(name="hook", a=Marker3D(body="tip"), b=Marker3D(body="weight")),
        ],
    )


def test_a_conical_pendulum_on_a_cable_follows_the_solver() -> None:
    model = conical()
    flexible = ExudynSettings(modified_newton=True, absolute_tolerance=1e-8)
    ours = simulate(model, END, "irk", 1e-8, 1e-10, t_eval=np.linspace(0.0, END, 26))
    coarse, fine = (run_exudyn(model, END, h, flexible) for h in (5e-4, 2.5e-4))
    for channel in ("weight.x", "weight.y", "weight.z", "middle.y", "middle.z"):
        values = [np.interp(ours.t[1:], r.t, r[channel]) for r in (coarse, fine)]
        limit = values[1] + (values[1] - values[0]) / 3.0
        scale = np.ptp(ours[channel])
        own = np.abs(values[1] - values[0]).max()  # exudyn's own error
        assert scale > 1e-2 and own < 2e-2 * scale, channel
        assert np.abs(limit - ours[channel][1:]).max() < 2.0 * own + 1e-4 * scale, channel
