"""Loads on the bodies of scenarios as inputs, for tests of derivatives."""

from tlismni.core import (
    AppliedForce2D,
    AppliedForce3D,
    AppliedTorque2D,
    AppliedTorque3D,
    CoordinateLoad,
    Input,
    InputSignal,
    Marker2D,
    Marker3D,
    MaterialPoint2D,
    PointMass2D,
    PointMass3D,
    RigidBody2D,
    RigidBody3D,
)

PLANAR, SPATIAL = (PointMass2D, RigidBody2D, MaterialPoint2D), (PointMass3D, RigidBody3D)
LOADED = {"AxialRod", "Cable2D", "FloatingBeam2D", "LinearSystem"}
"""Bodies whose last coordinate is loaded by itself: nodes of cables and rods, modes, degrees of freedom."""
MOTIONS = {"split_wall"}
"""Their own inputs are motions, which change nothing at once."""


def with_inputs(model):
    """The model with loads as inputs: forces and torques `u_...` on its last body, or point of a cable, and loads on a
    coordinate of each flexible body or linear system; and the names of these inputs."""
    inputs, forces = [], []

    def signal(name, unit="N"):
        inputs.append(Input(name=name, unit=unit))
        return InputSignal(channel=name)

    body = next((b for b in reversed(model.bodies) if isinstance(b, (*PLANAR, *SPATIAL))), None)
    if isinstance(body, PLANAR):
        at = Marker2D(body=body.name)
        pushes = {f"force_{axis}": signal(f"u_{axis}") for axis in "xy"}
        forces.append(AppliedForce2D(name="push_in_test", marker=at, **pushes))
        if not isinstance(body, PointMass2D):
            forces.append(AppliedTorque2D(name="turn_in_test", body=body.name, torque=signal("u_turn", "N.m")))
    elif isinstance(body, SPATIAL):
        at = Marker3D(body=body.name)
        pushes = {f"force_{axis}": signal(f"u_{axis}") for axis in "xyz"}
        forces.append(AppliedForce3D(name="push_in_test", marker=at, **pushes))
        if isinstance(body, RigidBody3D):
            turns = {f"torque_{axis}": signal(f"u_turn_{axis}", "N.m") for axis in "xyz"}
            forces.append(AppliedTorque3D(name="turn_in_test", marker=at, **turns))
    for loaded in (b for b in model.bodies if type(b).__name__ in LOADED):
        last, load = loaded.coordinate_records()[-1].name, signal(f"u_{loaded.name}")
        forces.append(CoordinateLoad(name=f"load_on_{loaded.name}", body=loaded.name, coordinate=last, load=load))
    found = model.model_copy(update={"inputs": (*model.inputs, *inputs), "forces": (*model.forces, *forces)})
    return found, [x.name for x in inputs]


def settable(scenario, added):
    """Inputs that change outputs at once."""
    return [*added, *(x.name for x in scenario.model.inputs if scenario.name not in MOTIONS)]
