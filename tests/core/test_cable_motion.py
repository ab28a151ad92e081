"""The ANCF cable in motion: momentum, energy, its own vibrations, damping, and exudyn's ObjectANCFCable2D."""

import math

import numpy as np
import pytest
from cables import EA, EI, LENGTH, LINE, beam_frequencies, straight
from helpers import GROUND, on, order, residuals
from tlismni.core import (
    Cable2D,
    Clamp2D,
    Constant,
    CoordinateDriver,
    CoordinateLoad,
    MaterialPoint2D,
    Model,
    Revolute2D,
    simulate,
)

BENT = tuple(
    (2.0 * math.sin(0.5 * s), 2.0 * (1.0 - math.cos(0.5 * s)), math.cos(0.5 * s), math.sin(0.5 * s))
    for s in np.linspace(0.0, LENGTH, 4)
)


def moments(result, elements):
    """Momentum (x, y) and angular momentum about the origin, over the samples, from the consistent mass matrix."""
    h = LENGTH / elements
    mass = LINE * h / 420.0 * np.array([
        [156, 22 * h, 54, -13 * h], [22 * h, 4 * h**2, 13 * h, -3 * h**2], [54, 13 * h, 156, -22 * h],
        [-13 * h, -3 * h**2, -22 * h, 4 * h**2],
    ])  # fmt: skip
    total, spin = np.zeros((2, len(result))), np.zeros(len(result))

    def column(axis, k, rate):
        return [result[f"cable.{'v' * rate}{axis}{k}"], result[f"cable.{'d_' * rate}slope_{axis}{k}"]]

    for e in range(elements):
        place, rate = ([np.array(column(a, e, r) + column(a, e + 1, r)) for a in "xy"] for r in (0, 1))
        total += np.array([(mass @ rate[c])[[0, 2]].sum(axis=0) for c in range(2)])
        spin += np.sum(place[0] * (mass @ rate[1]) - place[1] * (mass @ rate[0]), axis=0)
    return total, spin


def test_free_flight_keeps_momentum_and_energy():
    """A bent cable is let go while it flies and turns: m g t, no torque about the centre of mass."""
    cable = Cable2D(**straight(3, shape=BENT, velocity=(0.5, 2.0), angular_velocity=3.0))
    result = simulate(Model(bodies=[cable]), 0.3, method="irk", rtol=1e-7, atol=1e-9)
    total, spin = moments(result, 3)
    weight = 9.81 * LINE * LENGTH
    assert np.abs(total[0] - total[0, 0]).max() < 1e-6
    assert np.abs(total[1] - total[1, 0] + weight * result.t).max() < 1e-6
    centre = spin - spin[0]  # the weight's torque about the origin is that on the centre of mass
    x = (total[0, 0] * result.t**2 / 2.0 / (LINE * LENGTH) + start_centre() * result.t) * -weight
    assert np.abs(centre - x).max() < 1e-5
    assert np.abs(result["energy.balance"]).max() < 1e-5
    assert np.ptp(result["energy.strain"]) > 0.1  # it does deform


def start_centre():
    """x of the centre of mass at the start: integral of the cubics."""
    h = LENGTH / 3
    nodes = np.array(BENT)
    parts = 0.5 * h * (nodes[:-1, 0] + nodes[1:, 0]) + h**2 / 12.0 * (nodes[:-1, 2] - nodes[1:, 2])
    return parts.sum() / LENGTH


@pytest.mark.parametrize("axial, bending", [(0.0, 0.0), (0.5, 0.0), (0.0, 0.02), (0.5, 0.02)])
def test_damping_takes_energy_out_and_the_ledger_knows(axial, bending):
    cable = Cable2D(**straight(3, shape=BENT, axial_damping=axial, bending_damping=bending))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[cable]), 0.2, method="irk", rtol=1e-7, atol=1e-9)
    lost = result["energy.dissipation"]
    assert np.abs(result["energy.balance"]).max() < 1e-5
    assert np.all(np.diff(lost) >= -1e-12)
    assert (lost[-1] > 1e-3) == (axial + bending > 0.0)


def test_damping_does_not_act_on_rigid_motion():
    cable = Cable2D(**straight(2, axial_damping=5.0, bending_damping=2.0, velocity=(1.0, -1.0)))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[cable]), 0.1, method="irk")
    assert abs(result["energy.dissipation"][-1]) < 1e-15


def test_a_struck_cantilever_vibrates_with_its_first_frequency():
    """A short push at the tip; the damped higher modes die out and the zero crossings tell the period."""
    omega = (beam_frequencies("cantilever", 1)[0] / LENGTH) ** 2 * math.sqrt(EI / LINE)
    shape = [(s, 1e-4 * s**2 * (3 * LENGTH - s), 1.0, 1e-4 * (6 * LENGTH * s - 3 * s**2)) for s in np.linspace(0, 2, 5)]
    cable = Cable2D(**straight(4, shape=tuple(shape), bending_damping=1e-3))
    points = [MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("root", 0.0), ("tip", LENGTH))]
    joint = Clamp2D(name="clamp", a=GROUND, b=on("root"))
    model = Model(gravity=(0.0, 0.0), bodies=[cable, *points], joints=[joint])
    result = simulate(model, 4.2 * math.pi / omega, method="irk", rtol=1e-6, atol=1e-9)
    t, y = result.t, result["tip.y"]
    k = np.flatnonzero(y[1:] * y[:-1] < 0.0)
    crossings = t[k] - y[k] * (t[k + 1] - t[k]) / (y[k + 1] - y[k])
    period = 2.0 * np.diff(crossings).mean()
    assert len(crossings) == 4
    assert abs(period * omega / (2.0 * math.pi) - 1.0) < 2e-3


def test_coordinates_of_nodes_take_drivers_and_loads_by_name():
    """A cable held at both ends by drivers; one end moves apart: axial force EA eps in the drivers."""
    fields = {"body": "cable", "motion": Constant(value=0.0)}
    joints = [CoordinateDriver(name=f"hold{c}", coordinate=f"{c}0", **fields) for c in "xy"]
    joints.append(CoordinateDriver(name="end", body="cable", coordinate="y2", motion=Constant(value=0.0)))
    loads = [CoordinateLoad(name="pull", body="cable", coordinate="x2", load=Constant(value=10.0))]
    cable = Cable2D(**straight(2, axial_damping=20.0))
    result = simulate(Model(gravity=(0.0, 0.0), bodies=[cable], joints=joints, forces=loads), 2.0, method="irk")
    assert abs(result["cable.x2"][-1] - LENGTH * (1.0 + 10.0 / EA)) < 1e-5
    assert abs(result["holdx.reaction"][-1] - 10.0) < 0.02


def pendulum(elements, **fields):
    points = [MaterialPoint2D(name=n, body="cable", point=(s, 0.0)) for n, s in (("root", 0.0), ("tip", LENGTH))]
    joint = Revolute2D(name="pin", a=GROUND, b=on("root"))
    return Model(bodies=[Cable2D(**straight(elements, **fields)), *points], joints=[joint])


def test_orders_of_the_methods_on_a_cable_pendulum():
    """Newmark's order two at fixed steps against a tight run."""
    exact = simulate(pendulum(2), 0.2, method="irk", rtol=1e-10, atol=1e-12)
    errors = []
    for step in (2e-3, 1e-3, 5e-4):
        result = simulate(pendulum(2), 0.2, method="newmark", step=step, record=False)
        errors.append(math.hypot(result["tip.x"][-1] - exact["tip.x"][-1], result["tip.y"][-1] - exact["tip.y"][-1]))
    assert order(errors) > 1.8
    assert max(residuals(exact)[:2]) < 1e-10


@pytest.mark.parametrize("integration, reduced", [("full", 0), ("reduced", 1)])
def test_tip_path_against_exudyn(integration, reduced):
    """ObjectANCFCable2D with the same mesh, integration and damping: both at second order in the step."""
    exudyn = pytest.importorskip("exudyn")
    elements, t_end, damping = 4, 0.5, {"axial_damping": 0.5, "bending_damping": 0.01}
    times = np.linspace(0.0, t_end, 51)
    ours = simulate(pendulum(elements, integration=integration, **damping), t_end, t_eval=times, rtol=1e-8, atol=1e-10)
    paths = [exudyn_path(exudyn, elements, reduced, damping, t_end, steps) for steps in (1000, 2000)]
    theirs = paths[1] + (paths[1] - paths[0]) / 3.0
    assert np.abs(ours["tip.x"] - theirs[:, 0]).max() < 2e-5
    assert np.abs(ours["tip.y"] - theirs[:, 1]).max() < 2e-5
    assert np.ptp(ours["tip.y"]) > 1.0


def exudyn_path(exudyn, elements, reduced, damping, t_end, steps):
    """x, y of the tip at 51 times."""
    from exudyn import itemInterface as items

    mbs = exudyn.SystemContainer().AddSystem()
    h = LENGTH / elements
    nodes = [mbs.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[k * h, 0, 1, 0])) for k in range(elements + 1)]
    for k in range(elements):
        item = mbs.AddObject(items.ObjectANCFCable2D(
            length=h, massPerLength=LINE, bendingStiffness=EI, axialStiffness=EA, nodeNumbers=nodes[k : k + 2],
            axialDamping=damping["axial_damping"], bendingDamping=damping["bending_damping"],
            useReducedOrderIntegration=reduced,
        ))  # fmt: skip
        marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=item))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0, -9.81, 0]))
    ground = mbs.AddNode(items.NodePointGround())
    fixed = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=ground, coordinate=0))
    for c in range(2):
        marker = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=c))
        mbs.AddObject(items.CoordinateConstraint(markerNumbers=[fixed, marker]))
    sensor = mbs.AddSensor(items.SensorNode(
        nodeNumber=nodes[-1], storeInternal=True, writeToFile=False,
        outputVariableType=exudyn.OutputVariableType.Position,
    ))  # fmt: skip
    mbs.Assemble()
    settings = exudyn.SimulationSettings()
    settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, t_end
    settings.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    settings.timeIntegration.newton.useModifiedNewton = False
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = t_end / 50
    mbs.SolveDynamic(settings)
    return mbs.GetSensorStoredData(sensor)[:, 1:3]
