"""A heap of spheres of different size in a box: time and events until it rests, beside exudyn's and MuJoCo's contact.

    python benchmarks/heap3d.py [--spheres 20] [--end 2.0] [--most 300] [--only ours exudyn mujoco]
    python benchmarks/heap3d.py --only ours --method moreau --step 1e-3

Ours: contacts as constraints (e = 0.3, mu = 0.4), `ebdf` or another method, one group for all pairs; friction against
rolling and spinning, since what rolls without it never rests. exudyn's, without these: `GeneralContact`, a spring and
a damper that give the same restitution to two spheres of the mean mass, friction proportional to the speed below 1
mm/s; explicit, at a hundredth of the contact's period. MuJoCo's: its soft constraints with default softness, steps of
1 ms, elliptic cones, the same arms; it knows no restitution, so that its heap bounces less (pip install mujoco, or
leave it out with --only). All hand out positions every 10 ms.
"""

import argparse
import math
from time import process_time, thread_time

import numpy as np
from numpy.typing import NDArray
from tlismni.core import (
    Axes,
    ContactGroup3D,
    CoulombFriction,
    HalfSpace3D,
    Marker3D,
    Model,
    NewtonImpact,
    RigidBody3D,
    Simulation,
    Sphere3D,
    TurningFriction,
)

SMALLEST, LARGEST, DENSITY, G = 0.03, 0.05, 2000.0, 9.81
RESTITUTION, FRICTION = 0.3, 0.4
WIDTH = 0.36
"""Of the square box, m: three spheres side by side."""
SPIN = 0.5
"""Arm against spinning, of that against rolling."""
OUTPUT = 0.01
STIFFNESS = 1e6
"""Of a contact between two spheres, N/m: a sphere's weight presses it by 6 um."""
STILL = 1e-3
"""m/s: a heap with all speeds below rests, as far as it is looked at from outside."""
Places = tuple[NDArray[np.float64], NDArray[np.float64]]


def places(count: int, seed: int) -> Places:
    """Centres (count, 3) and radii (count,) of the spheres before they drop, m: nine in a layer."""
    rng = np.random.default_rng(seed)
    radii = rng.uniform(SMALLEST, LARGEST, count)
    k = np.arange(count)
    grid = np.stack([WIDTH * (k % 3 + 0.5) / 3, WIDTH * (k // 3 % 3 + 0.5) / 3, 0.08 + 0.13 * (k // 9)], axis=1)
    return grid + rng.uniform(-0.008, 0.008, (count, 3)), radii


def masses(radii: NDArray[np.float64]) -> NDArray[np.float64]:
    """kg."""
    return DENSITY * 4.0 / 3.0 * math.pi * radii**3


def our_model(start: Places, rest_ratio: float, rolling: float, most: int | None = None) -> Model:
    """The spheres and the box; rolling: arm of the friction against rolling, m, 0: none; most: room for so many
    contacts at once, None: a contact for each pair."""
    bodies, spheres = [], []
    for k, (centre, radius, mass) in enumerate(zip(*start, masses(start[1]), strict=True)):
        moment = 0.4 * mass * radius**2
        bodies.append(RigidBody3D(name=f"s{k}", mass=mass, inertia=(moment,) * 3, position=tuple(centre)))
        spheres.append(Sphere3D(marker=Marker3D(body=f"s{k}"), radius=radius))
    walls = [((0.0, 0.0, 0.0), (0.0, 0.0, 1.0))]
    for axis in range(2):
        for side, place in ((1.0, 0.0), (-1.0, WIDTH)):
            point, normal = [0.0] * 3, [0.0] * 3
            point[axis], normal[axis] = place, side
            walls.append((tuple(point), tuple(normal)))
    group = ContactGroup3D(
        name="heap", spheres=spheres, most_contacts=most,
        law=NewtonImpact(restitution=RESTITUTION, rest_ratio=rest_ratio),
        half_spaces=[HalfSpace3D(marker=Marker3D(point=point, attitude=Axes(z=normal))) for point, normal in walls],
        friction=CoulombFriction(coefficient=FRICTION),
        turning=TurningFriction(rolling=rolling, spinning=SPIN * rolling) if rolling else None,
    )  # fmt: skip
    return Model(gravity=(0.0, 0.0, -G), bodies=bodies, groups=[group])


def overlap(centres: NDArray[np.float64], radii: NDArray[np.float64]) -> float:
    """The deepest overlap of spheres and walls, m; negative if nothing touches. centres : (..., count, 3)."""
    apart = np.linalg.norm(centres[..., :, None, :] - centres[..., None, :, :], axis=-1) - radii[:, None] - radii
    apart[..., np.arange(len(radii)), np.arange(len(radii))] = np.inf
    low = np.minimum(centres.min(axis=-1), WIDTH - centres[..., :2].max(axis=-1)) - radii
    return -float(min(apart.min(), low.min()))


def run_ours(
    start: Places, end: float, rest_ratio: float, most: float, rolling: float, method: str, step: float | None,
    contacts: int | None,
) -> None:  # fmt: skip
    """Run, for `most` seconds of CPU, and print what a demanding reader asks."""
    radii = start[1]
    begun = process_time()
    sim = Simulation(our_model(start, rest_ratio, rolling, contacts), method, step=step)
    made, deepest, rests_at, said = process_time() - begun, -math.inf, math.nan, 0.0
    begun = process_time()
    for k in range(1, round(end / OUTPUT) + 1):
        sim.advance(k * OUTPUT)
        q, v = (sim.workspace.arrays[name][: 7 * len(radii)].reshape(-1, 7) for name in "qv")
        deepest = max(deepest, overlap(q[:, :3], radii))
        speed = float(np.max(np.abs(v[:, :3])))
        rests_at = math.nan if speed > STILL else sim.t if math.isnan(rests_at) else rests_at
        if k * OUTPUT >= said + 0.1 - 1e-9:
            said = k * OUTPUT
            print(
                f"  {said:.1f} s: {len(sim.events)} events, {sim.stats['steps']} steps, fastest {speed:.2g} m/s, "
                f"{process_time() - begun:.0f} s of CPU",
                flush=True,
            )
        if process_time() - begun > most:
            print(f"  given up after {most:g} s of CPU")
            break
    seconds = process_time() - begun
    values = dict(zip((c.name for c in sim.table.channels), sim.values(), strict=True))
    instants = len({event.t for event in sim.events})
    lost = values["energy.dissipation"] + values["energy.impact_loss"]
    print(
        f"ours ({method}): {seconds:.1f} s of CPU ({made:.1f} s to make it); {len(sim.events)} events at {instants} "
        f"instants; {sim.stats['steps']} steps, {sim.stats['impulse_steps']} of impulses; at rest from "
        f"{rests_at:.2f} s (now {sim.t:.2f} s: fastest {speed:.1g} m/s)"
    )
    now = overlap(q[:, :3], radii)
    print(
        f"  deepest overlap {deepest:.2g} m, {now:.1g} m at the end; energy balance {values['energy.balance']:.2g} J "
        f"of {lost:.3g} J lost"
    )
    print(f"  highest centre {np.max(q[:, 2]):.4f} m")


def run_exudyn(start: Places, end: float) -> None:
    """The same with exudyn's penalty contact."""
    import exudyn as exu
    from exudyn.itemInterface import MarkerBodyRigid, NodeRigidBodyRotVecLG, ObjectGround, ObjectRigidBody, SensorNode

    centres, radii = start
    box = exu.SystemContainer()
    mbs = box.AddSystem()
    contact = mbs.AddGeneralContact()
    contact.SetFrictionPairings([[FRICTION]])
    contact.SetFrictionProportionalZone(1e-3)
    high = float(centres[:, 2].max()) + 0.2
    contact.SetSearchTreeCellSize([4, 4, 16])
    contact.SetSearchTreeBox([-0.2, -0.2, -0.2], [WIDTH + 0.2, WIDTH + 0.2, high])
    # springs in series: each side has twice the stiffness and the damping
    log, mass = math.log(RESTITUTION), float(masses(radii).mean())
    ratio = -log / math.hypot(math.pi, log)
    stiffness, damping = 2.0 * STIFFNESS, 2.0 * 2.0 * ratio * math.sqrt(STIFFNESS * 0.5 * mass)
    ground = mbs.AddMarker(MarkerBodyRigid(bodyNumber=mbs.AddObject(ObjectGround())))
    low, far = -0.2, WIDTH + 0.2
    for corners in (
        [[low, low, 0.0], [far, low, 0.0], [far, far, 0.0], [low, far, 0.0]],
        [[0.0, low, low], [0.0, far, low], [0.0, far, high], [0.0, low, high]],
        [[WIDTH, far, low], [WIDTH, low, low], [WIDTH, low, high], [WIDTH, far, high]],
        [[far, 0.0, low], [low, 0.0, low], [low, 0.0, high], [far, 0.0, high]],
        [[low, WIDTH, low], [far, WIDTH, low], [far, WIDTH, high], [low, WIDTH, high]],
    ):
        contact.AddTrianglesRigidBodyBased(ground, stiffness, damping, 0, corners, [[0, 1, 2], [0, 2, 3]], False)
    sensors = []
    for centre, radius, own in zip(centres, radii, masses(radii), strict=True):
        moment = 0.4 * own * radius**2
        node = mbs.AddNode(NodeRigidBodyRotVecLG(referenceCoordinates=[*centre, 0.0, 0.0, 0.0]))
        body = mbs.AddObject(ObjectRigidBody(mass=own, inertia=[moment] * 3 + [0.0] * 3, nodeNumber=node))
        contact.AddSphereWithMarker(mbs.AddMarker(MarkerBodyRigid(bodyNumber=body)), radius, stiffness, damping, 0)
        at = mbs.AddMarker({"markerType": "BodyMass", "bodyNumber": body})
        mbs.AddLoad({"loadType": "MassProportional", "markerNumber": at, "loadVector": [0.0, 0.0, -G]})
        kinds = exu.OutputVariableType
        sensors.append(
            [
                mbs.AddSensor(SensorNode(nodeNumber=node, storeInternal=True, outputVariableType=kind))
                for kind in (kinds.Position, kinds.Velocity)
            ]
        )
    mbs.Assemble()
    settings = exu.SimulationSettings()
    period = 2.0 * math.pi * math.sqrt(0.5 * mass / STIFFNESS)
    settings.timeIntegration.numberOfSteps = math.ceil(100.0 * end / period)
    settings.timeIntegration.endTime = end
    settings.timeIntegration.verboseMode = 0
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = OUTPUT
    begun = thread_time()
    mbs.SolveDynamic(settings, solverType=exu.DynamicSolverType.ExplicitMidpoint)
    seconds = thread_time() - begun
    tracks, speeds = (
        np.stack([mbs.GetSensorStoredData(pair[k])[:, 1:4] for pair in sensors], axis=1) for k in range(2)
    )
    print(f"exudyn: {seconds:.1f} s of CPU; {settings.timeIntegration.numberOfSteps} steps, no events known")
    told(tracks, speeds, radii)


def run_mujoco(start: Places, end: float, rolling: float) -> None:
    """The same with MuJoCo's soft constraints."""
    import mujoco

    centres, radii = start
    walls = "".join(
        f'<geom type="plane" size="1 1 1" pos="{pos}" zaxis="{axis}"/>'
        for pos, axis in (
            ("0 0 0", "0 0 1"), ("0 0 0", "1 0 0"), (f"{WIDTH} 0 0", "-1 0 0"), ("0 0 0", "0 1 0"),
            (f"0 {WIDTH} 0", "0 -1 0"),
        )
    )  # fmt: skip
    balls = "".join(
        f'<body pos="{x} {y} {z}"><freejoint/><geom type="sphere" size="{radius}" mass="{mass}"/></body>'
        for (x, y, z), radius, mass in zip(centres, radii, masses(radii), strict=True)
    )
    model = mujoco.MjModel.from_xml_string(
        f'<mujoco><option timestep="1e-3" cone="elliptic" gravity="0 0 {-G}"/><default><geom '
        f'friction="{FRICTION} {SPIN * rolling} {rolling}" condim="{6 if rolling else 3}"/></default>'
        f"<worldbody>{walls}{balls}</worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    steps, every = round(end / 1e-3), round(OUTPUT / 1e-3)
    tracks, speeds = [], []
    begun = thread_time()
    for k in range(1, steps + 1):
        mujoco.mj_step(model, data)
        if k % every == 0:
            tracks.append(data.qpos.reshape(-1, 7)[:, :3].copy())
            speeds.append(data.qvel.reshape(-1, 6)[:, :3].copy())
    seconds = thread_time() - begun
    print(f"MuJoCo {mujoco.__version__}: {seconds:.1f} s of CPU; {steps} steps, no events known")
    told(np.array(tracks), np.array(speeds), radii)


def told(tracks: NDArray[np.float64], speeds: NDArray[np.float64], radii: NDArray[np.float64]) -> None:
    """What is seen of a run; tracks, speeds : (outputs, count, 3)."""
    print(
        f"  deepest overlap seen {overlap(tracks, radii):.2g} m; fastest at the end {np.max(np.abs(speeds[-1])):.2g} "
        f"m/s; highest centre {np.max(tracks[-1, :, 2]):.4f} m"
    )


def main() -> None:
    """All three, one after the other."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spheres", type=int, default=20)
    parser.add_argument("--end", type=float, default=2.0, help="s")
    parser.add_argument("--rest-ratio", type=float, default=1e-3)
    parser.add_argument(
        "--rolling", type=float, default=1e-3, help="arm of the friction against rolling, m (not exudyn)"
    )
    parser.add_argument("--most", type=float, default=300.0, help="s of CPU for ours")
    parser.add_argument("--method", default="ebdf", help="of ours: ebdf, moreau ...")
    parser.add_argument("--step", type=float, help="of ours, s: fixed; left out: as the method has it")
    parser.add_argument("--contacts", type=int, help="of ours: room for so many at once; left out: one for each pair")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", nargs="+", choices=("mujoco", "exudyn", "ours"), default=("mujoco", "exudyn", "ours"))
    given = parser.parse_args()
    start = places(given.spheres, given.seed)
    if "mujoco" in given.only:
        run_mujoco(start, given.end, given.rolling)
    if "exudyn" in given.only:
        run_exudyn(start, given.end)
    if "ours" in given.only:
        run_ours(
            start, given.end, given.rest_ratio, given.most, given.rolling, given.method, given.step,
            given.contacts,
        )  # fmt: skip


if __name__ == "__main__":
    main()
