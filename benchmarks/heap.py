"""A heap of disks in a box: time and events until it rests, beside exudyn's penalty contact in the same run.

    python benchmarks/heap.py [--disks 30] [--end 3.0] [--rest-ratio 1e-3] [--seed 0]

Ours: contacts as constraints (e = 0.3, mu = 0.4), `ebdf`. exudyn's: `GeneralContact`, a spring and a damper that give
the same restitution, friction that is proportional to the speed below 1 mm/s; explicit, at a hundredth of the
contact's period. Both hand out positions every 10 ms.
"""

import argparse
import math
from time import process_time, thread_time

import exudyn as exu
import numpy as np
from exudyn.itemInterface import MarkerBodyRigid, NodeRigidBody2D, ObjectGround, ObjectRigidBody2D, SensorNode
from numpy.typing import NDArray
from tlismni.core import (
    CoulombFriction,
    Disk2D,
    DiskOnDisk2D,
    DiskOnHalfPlane2D,
    HalfPlane2D,
    Marker2D,
    Model,
    NewtonImpact,
    RigidBody2D,
    Simulation,
)

RADIUS, WIDTH, MASS, G = 0.05, 0.34, 1.0, 9.81
RESTITUTION, FRICTION = 0.3, 0.4
OUTPUT = 0.01
STIFFNESS = 1e6
"""Of a contact between two disks, N/m: a disk's weight presses it by 10 um."""


def places(disks: int, seed: int) -> NDArray[np.float64]:
    """Where the disks are dropped, (disks, 2), m: three in a row."""
    rng = np.random.default_rng(seed)
    return np.array(
        [[WIDTH * (k % 3 + 0.5) / 3 + rng.uniform(-0.005, 0.005), 0.08 + 0.12 * (k // 3)] for k in range(disks)]
    )


def our_model(start: NDArray[np.float64], rest_ratio: float) -> Model:
    """The disks and the box."""
    law = NewtonImpact(restitution=RESTITUTION, rest_ratio=rest_ratio)
    rough = CoulombFriction(coefficient=FRICTION)
    bodies = [
        RigidBody2D(name=f"disk{k}", mass=MASS, inertia=0.5 * MASS * RADIUS**2, position=tuple(place))
        for k, place in enumerate(start)
    ]
    disks = [Disk2D(marker=Marker2D(body=body.name), radius=RADIUS) for body in bodies]
    walls = [
        HalfPlane2D(),
        HalfPlane2D(marker=Marker2D(angle=-np.pi / 2)),
        HalfPlane2D(marker=Marker2D(point=(WIDTH, 0.0), angle=np.pi / 2)),
    ]
    contacts = [
        DiskOnHalfPlane2D(name=f"wall{i}_{k}", plane=wall, disk=disk, law=law, friction=rough)
        for i, wall in enumerate(walls)
        for k, disk in enumerate(disks)
    ]
    contacts += [
        DiskOnDisk2D(name=f"pair{i}_{j}", a=disks[i], b=disks[j], law=law, friction=rough)
        for i in range(len(disks))
        for j in range(i)
    ]
    return Model(gravity=(0.0, -G), bodies=bodies, contacts=contacts)


def run_ours(start: NDArray[np.float64], end: float, rest_ratio: float) -> None:
    """Run, and print what a demanding reader asks."""
    count = len(start)
    sim = Simulation(our_model(start, rest_ratio), "ebdf")
    begun, deepest, rests_at, told = process_time(), 0.0, math.nan, 0.0
    for k in range(1, round(end / OUTPUT) + 1):
        sim.advance(k * OUTPUT)
        deepest = min(deepest, min(sim.gap(c) for c in range(len(sim.assembly.contacts))))
        speed = float(np.max(np.abs(sim.workspace.arrays["v"][: 3 * count])))
        if speed > 1e-6:
            rests_at = math.nan
        elif math.isnan(rests_at):
            rests_at = sim.t
        if k * OUTPUT >= told + 0.1:
            told = k * OUTPUT
            print(
                f"  {told:.1f} s: {len(sim.events)} events, fastest {speed:.2g}, {process_time() - begun:.0f} s of CPU"
            )
    seconds = process_time() - begun
    values = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    instants = len({event.t for event in sim.events})
    lost = values["energy.dissipation"] + values["energy.impact_loss"]
    print(
        f"ours: {seconds:.1f} s of CPU; {len(sim.events)} events at {instants} instants; at rest from {rests_at:.2f} s"
    )
    print(f"  deepest overlap {-deepest:.2g} m; energy balance {values['energy.balance']:.2g} J of {lost:.3g} J lost")
    print(f"  highest centre {np.max(sim.workspace.arrays['q'][1 : 3 * count : 3]):.4f} m")


def run_exudyn(start: NDArray[np.float64], end: float) -> None:
    """The same with exudyn's penalty contact."""
    box = exu.SystemContainer()
    mbs = box.AddSystem()
    contact = mbs.AddGeneralContact()
    contact.SetFrictionPairings([[FRICTION]])
    contact.SetFrictionProportionalZone(1e-3)
    contact.SetSearchTreeCellSize([8, 32, 1])
    contact.SetSearchTreeBox([-0.1, -0.1, -0.2], [WIDTH + 0.1, 0.12 * len(start), 0.2])
    # springs in series: each side has twice the stiffness and the damping
    log = math.log(RESTITUTION)
    ratio = -log / math.hypot(math.pi, log)
    stiffness, damping = 2.0 * STIFFNESS, 2.0 * 2.0 * ratio * math.sqrt(STIFFNESS * 0.5 * MASS)
    ground = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround())))
    high, deep = 0.2 * len(start), 1.0
    for a, b in (((-0.2, 0.0), (WIDTH + 0.2, 0.0)), ((0.0, high), (0.0, -0.2)), ((WIDTH, -0.2), (WIDTH, high))):
        corners = [[*a, deep], [*b, deep], [*b, -deep], [*a, -deep]]
        contact.AddTrianglesRigidBodyBased(ground, stiffness, damping, 0, corners, [[0, 1, 2], [0, 2, 3]], False)
    nodes = []
    for place in start:
        node = mbs.AddNode(NodeRigidBody2D(referenceCoordinates=[*place, 0.0]))
        body = mbs.AddObject(ObjectRigidBody2D(mass=MASS, inertia=0.5 * MASS * RADIUS**2, nodeNumber=node))
        marker = mbs.AddMarker(MarkerBodyRigid(bodyNumber=body))
        contact.AddSphereWithMarker(marker, RADIUS, stiffness, damping, 0)
        load(mbs, body)
        nodes.append(node)
    sensors = [
        mbs.AddSensor(
            SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=exu.OutputVariableType.Position)
        )
        for node in nodes
    ]
    mbs.Assemble()
    settings = exu.SimulationSettings()
    period = 2.0 * math.pi * math.sqrt(0.5 * MASS / STIFFNESS)
    settings.timeIntegration.numberOfSteps = math.ceil(100.0 * end / period)
    settings.timeIntegration.endTime = end
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = OUTPUT
    begun = thread_time()
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.ExplicitMidpoint)
    seconds = thread_time() - begun
    tracks = np.array([mbs.GetSensorStoredData(sensor)[:, 1:3] for sensor in sensors])
    q, v = np.asarray(mbs.systemData.GetODE2Coordinates()), np.asarray(mbs.systemData.GetODE2Coordinates_t())
    final = start + q.reshape(-1, 3)[:, :2]
    apart = np.linalg.norm(tracks[:, None] - tracks[None], axis=3) - 2.0 * RADIUS
    apart[np.arange(len(start)), np.arange(len(start))] = np.inf
    walls = np.minimum.reduce([tracks[:, :, 1], tracks[:, :, 0], WIDTH - tracks[:, :, 0]]) - RADIUS
    print(f"exudyn: {seconds:.1f} s of CPU; {settings.timeIntegration.numberOfSteps} steps, no events known")
    print(f"  deepest overlap seen {-min(apart.min(), walls.min()):.2g} m; fastest at the end {np.max(np.abs(v)):.2g}")
    print(f"  highest centre {np.max(final[:, 1]):.4f} m")


def load(mbs: exu.MainSystem, body: int) -> None:
    """Gravity on a body."""
    marker = mbs.AddMarker({"markerType": "BodyMass", "bodyNumber": body})
    mbs.AddLoad({"loadType": "MassProportional", "markerNumber": marker, "loadVector": [0.0, -G, 0.0]})


def main() -> None:
    """Both, one after the other."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--disks", type=int, default=30)
    parser.add_argument("--end", type=float, default=3.0, help="s")
    parser.add_argument("--rest-ratio", type=float, default=1e-3)
    parser.add_argument("--seed", type=int, default=0)
    given = parser.parse_args()
    start = places(given.disks, given.seed)
    run_exudyn(start, given.end)
    run_ours(start, given.end, given.rest_ratio)


if __name__ == "__main__":
    main()
