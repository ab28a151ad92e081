"""Whether a run has to ask for memory on the way changes no bit of it, repairs of pivots and partitions included."""

import numpy as np
import pytest
from tlismni.core import AppliedTorque3D, Input, InputSignal, Marker3D, Simulation
from tlismni.core.native.prepare import rehearse
from tlismni.models import load


def with_torque(body):
    """The arm with a torque on one of its bodies as input, whose elbow has no limit: new pivots at 0.85 s, in a pool
    that moves if there is no room."""
    model = load("arm_stop").model
    load_z = AppliedTorque3D(name="load", marker=Marker3D(body=body), torque_z=InputSignal(channel="u"))
    inputs = (*model.inputs, Input(name="u", unit="N.m"))
    copy = model.model_copy(update={"inputs": inputs, "forces": (*model.forces, load_z)})
    return copy.with_parameters({"elbow_limit": -40.0})


CASES = {
    "torque on the lower arm": ("arm_stop", with_torque("lower")),
    "torque on the upper arm": ("arm_stop", with_torque("upper")),
    "woodpecker": ("woodpecker", None),
    "slider-crank in space": ("spatial_slider_crank_stop", None),
}


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", CASES)
def test_a_run_with_room_has_the_bits_of_one_without(name):
    scenario = load(CASES[name][0])
    settings = {"method": scenario.method, "rtol": scenario.rtol, "atol": scenario.atol, **scenario.options}
    bare, roomy = (Simulation(CASES[name][1] or scenario.model, **settings) for _ in range(2))
    end = min(scenario.t_end, 1.0)
    rehearse(roomy, end)
    for t in np.linspace(0.0, end, 81)[1:]:
        bare.advance(t)
        roomy.advance(t)
        assert bare.values().tobytes() == roomy.values().tobytes(), t
