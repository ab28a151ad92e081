"""An FMU whose motion is led by a step table of positions, without rates."""

import fmpy
import numpy as np
import pytest
from tlismni.core import Input, InputSignal, Marker2D, Model, RelativeMotor2D, Revolute2D, RigidBody2D
from tlismni.fmu_wrapper import export_fmu
from tlismni.fmu_wrapper.in_process import InProcess


@pytest.mark.parametrize("host", ["binary", "in process"])
def test_fmpy_leads_a_motor_by_steps(host, tmp_path):
    """It is a communication step late, and rests at each point, as the docs say."""
    a, b = Marker2D(), Marker2D(body="arm", point=(-0.3, 0.0))
    model = Model(
        name="led",
        bodies=[RigidBody2D(name="arm", mass=2.0, inertia=0.5, position=(0.3, 0.0))],
        joints=[
            Revolute2D(name="hinge", a=a, b=b),
            RelativeMotor2D(name="motor", a=a, b=b, motion=InputSignal(channel="x")),
        ],
        inputs=[Input(name="x", unit="rad", start=0.1)],
    )
    path = export_fmu(model, tmp_path / "led.fmu", t_end=1.0, rtol=1e-9, atol=1e-11)
    unzipped = fmpy.extract(str(path), unzipdir=str(tmp_path / "unzipped"))
    table = np.array(
        [(0.0, 0.1), (0.2, 0.1), (0.2, 0.4), (0.6, 0.4), (0.6, -0.3), (1.0, -0.3)],
        dtype=[("time", float), ("x", float)],
    )
    instance = InProcess.of(unzipped) if host == "in process" else None
    found = fmpy.simulate_fmu(
        unzipped, stop_time=1.0, output_interval=0.2, input=table, fmi_type="CoSimulation", fmu_instance=instance,
        output=["arm.angle", "arm.angular_velocity"],
    )  # fmt: skip
    at = [int(np.flatnonzero(np.isclose(found["time"], t))[-1]) for t in (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)]
    np.testing.assert_allclose(found["arm.angle"][at], [0.1, 0.1, 0.4, 0.4, -0.3, -0.3], atol=1e-8)
    np.testing.assert_allclose(found["arm.angular_velocity"][at], 0.0, atol=1e-7)
