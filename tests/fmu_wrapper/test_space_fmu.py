"""FMUs of all scenarios in space: valid, the bits of a run in this process with Python and without; their scene."""

import json
import struct
import zipfile

import fmpy
import numpy as np
import pytest
from fmpy.validation import validate_fmu
from native_pair import Side
from tlismni.core import (
    AngleDriver3D,
    AppliedForce3D,
    AppliedTorque3D,
    Input,
    InputSignal,
    Marker3D,
    Model,
    PositionDriver3D,
    Prismatic3D,
    Revolute3D,
    RigidBody3D,
    Simulation,
)
from tlismni.core.compiled.library import LIBRARY
from tlismni.fmu_wrapper import Slave, export_fmu
from tlismni.fmu_wrapper.terminals import terminals
from tlismni.models import load, names
from tlismni.viewer.space.build import is_spatial

SPATIAL = [name for name in names() if is_spatial(load(name).model)]
STRIKING = [name for name in SPATIAL if load(name).model.contacts]
STEPS = 12


def opened(path, folder, version, **how):
    unzipped = fmpy.extract(str(path), unzipdir=str(folder))
    return Side(version, unzipped, fmpy.read_model_description(unzipped), **how)


def outputs(side):
    """The real outputs by their names."""
    fmu = side.fmu
    found = fmu.getFloat64(side.reals) if side.three else fmu.getReal(side.reals)
    by_reference = {v.valueReference: v.name for v in side.by_name.values()}
    return {by_reference[k]: value for k, value in zip(side.reals, found, strict=True)}


@pytest.mark.sampled(1)
@pytest.mark.parametrize("name", SPATIAL)
def test_the_bits_of_a_run_in_this_process(name, tmp_path):
    scenario, version = load(name), "2.0" if len(name) % 2 else "3.0"
    end = scenario.t_end
    settings = {"t_end": end, "communication_step": end / STEPS}
    path = export_fmu(scenario, tmp_path / "python.fmu", version, **settings)
    assert validate_fmu(str(path)) == []
    sides = [opened(path, tmp_path / "python", version)]
    if LIBRARY is not None:
        native = export_fmu(scenario, tmp_path / "native.fmu", version, native=True, **settings)
        assert validate_fmu(str(native)) == []
        sides.append(opened(native, tmp_path / "native", version))
    slave = Slave(scenario, **settings)
    slave.setup()
    slave.enter_initialization()
    slave.exit_initialization()
    for side in sides:
        side.begin()
    step, time = end / STEPS, 0.0
    for _ in range(STEPS):
        slave.do_step(time, step)
        time += step
        for side in sides:
            side.step(step)
            assert side.read() == sides[0].read()
        found = outputs(sides[0])
        assert np.array([slave[n] for n in found]).tobytes() == np.array(list(found.values())).tobytes()


@pytest.mark.sampled(2)
@pytest.mark.parametrize("name", STRIKING)
def test_steps_end_at_the_events_of_a_run(name, tmp_path):
    """FMI 3.0 with early return: to the bit the instants of a run that knows of no communication points."""
    scenario = load(name)
    alone = Simulation(scenario.model)
    alone.advance(scenario.t_end)
    expected = sorted({event.t for event in alone.events if 0.0 < event.t < scenario.t_end})
    path = export_fmu(scenario, tmp_path / "x.fmu", "3.0", t_end=scenario.t_end)
    side = opened(path, tmp_path / "x", "3.0", eventModeUsed=True, earlyReturnAllowed=True)
    side.begin()
    found = []
    while side.time < scenario.t_end:
        due, _, _, at = side.step(min(scenario.t_end / 40.0, scenario.t_end - side.time))
        if due:
            found.append(at)
            side.fmu.enterEventMode()
            side.leave_event_mode()
    # where the direction of sliding is taken anew steps end too, without an event
    assert expected and [t for t in found if t in expected] == expected


def test_the_scene_has_the_bodies_where_they_start(tmp_path):
    for name in ("arm_stop", "heavy_top"):
        scenario = load(name)
        path = export_fmu(scenario, tmp_path / f"{name}.fmu", "3.0", t_end=0.1)
        with zipfile.ZipFile(path) as archive:
            data = archive.read("resources/scene.glb")
        magic, version, length, size, kind = struct.unpack_from("<5I", data)
        assert (magic, version, length, kind) == (0x46546C67, 2, len(data), 0x4E4F534A)
        nodes = {node.get("name"): node for node in json.loads(data[20 : 20 + size])["nodes"]}
        for body in scenario.model.bodies:
            assert nodes[body.name].get("translation", [0.0] * 3) == pytest.approx(body.position, abs=1e-6)
            q, _ = body.initial_state()
            turn = nodes[body.name].get("rotation", [0.0, 0.0, 0.0, 1.0])
            assert abs(np.dot(np.roll(turn, 1), q[3:])) == pytest.approx(1.0, abs=1e-6)


def test_the_plane_and_what_is_protected_have_no_scene(tmp_path):
    paths = [export_fmu(load("pendulum_stop"), tmp_path / "plane.fmu", t_end=0.1)]
    if LIBRARY is not None:
        paths.append(export_fmu(load("heavy_top"), tmp_path / "secret.fmu", t_end=0.1, native=True, protect=True))
    for path in paths:
        with zipfile.ZipFile(path) as archive:
            assert not [name for name in archive.namelist() if name.endswith(".glb")]


def test_terminals_of_loads_and_drivers():
    box = RigidBody3D(name="box", mass=1.0, inertia=(0.1, 0.1, 0.1))
    turned = RigidBody3D(name="wheel", mass=1.0, inertia=(0.1, 0.1, 0.1))
    slide = RigidBody3D(name="slide", mass=1.0, inertia=(0.1, 0.1, 0.1))
    at, wheel, on = (Marker3D(body=name) for name in ("box", "wheel", "slide"))
    inputs = [Input(name=name) for name in ("fx", "fz", "off", "ty", "turn", "way")]
    push = {name: InputSignal(channel=name) for name in ("fx", "fz", "off", "ty")}
    model = Model(
        bodies=[box, turned, slide],
        joints=[
            Revolute3D(name="hinge", a=Marker3D(), b=wheel),
            AngleDriver3D(name="motor", a=Marker3D(), b=wheel, angle=InputSignal(channel="turn")),
            Prismatic3D(name="guide", a=Marker3D(), b=on),
            PositionDriver3D(name="jack", a=Marker3D(), b=on, position=InputSignal(channel="way")),
        ],
        forces=[
            AppliedForce3D(name="push", marker=at, force_x=push["fx"], force_z=push["fz"]),
            AppliedForce3D(name="side", marker=Marker3D(body="box", point=(0.1, 0.0, 0.0)), force_y=push["off"]),
            AppliedTorque3D(name="twist", marker=at, torque_y=push["ty"], follower=True),
        ],
        inputs=inputs,
    )
    found = {t.name: t for t in terminals(model, Slave(model).variables)}
    assert found["push"].members == {
        "force_x": "fx", "force_z": "fz", "x": "box.x", "vx": "box.vx", "z": "box.z", "vz": "box.vz"
    }  # fmt: skip
    assert found["push"].flows == {"force_x": "inflow", "force_z": "inflow"}
    assert found["side"].members == {"force_y": "off"}
    assert found["twist"].members == {"torque_y": "ty", "angular_velocity_y": "box.body_angular_velocity_y"}
    assert found["motor"].members == {"angle": "turn", "torque": "motor.torque_z"}
    assert found["jack"].members == {"z": "way", "force_z": "jack.force_z"}
    assert found["motor"].flows == {"torque": "outflow"} and found["jack"].flows == {"force_z": "outflow"}
