"""CPU time of one step of a chain of N rods on ball joints in space: ours beside exudyn's, one run, interleaved.

Run: python benchmarks/space_chain_speed.py [--links 1 10] [--core 1] [--fast]. Fixed-step `hht` against exudyn's
generalized-alpha (spectral radius 0.9) on Euler parameters in its fastest setting. Building and starting are left out
on both sides: a step costs the difference of a long and a short run. The error of the free end, against our `irk` at
its finest, stands beside.
"""

import argparse
import os
from collections.abc import Callable
from time import process_time

import numpy as np
from chain_speed import REPEATS, Case, pin_to_one_core, short
from tlismni.core import Marker3D, Model, RigidBody3D, Simulation, Spherical3D, simulate
from tlismni.core.model.attitude import rotation_matrix

CASES = (
    Case(1, 1e-4, 20_000, 0.25),
    Case(10, 5e-4, 2_000, 0.25),
    Case(100, 5e-4, 400, 0.25),
    Case(1000, 1e-4, 60, 0.25),
)
RADIUS, LENGTH, MASS = 0.05, 1.0, 1.0


def spatial_chain(links: int) -> Model:
    """Round rods from the origin along x, that turn about z as one and fall against z."""
    axial = 0.5 * MASS * RADIUS**2
    across = MASS * (3.0 * RADIUS**2 + LENGTH**2) / 12.0
    bodies, joints = [], []
    for k in range(links):
        x = (k + 0.5) * LENGTH
        body = RigidBody3D(
            name=f"rod{k}", mass=MASS, inertia=(axial, across, across), position=(x, 0.0, 0.0),
            velocity=(0.0, 0.5 * x / links, 0.0), angular_velocity=(0.0, 0.0, 0.5 / links),
        )  # fmt: skip
        place = (k * LENGTH, 0.0, 0.0)
        before = bodies[-1].marker_at(place) if bodies else Marker3D()
        joints.append(Spherical3D(name=f"ball{k}", a=before, b=body.marker_at(place)))
        bodies.append(body)
    return Model(name="space_chain", gravity=(0.0, 0.0, -9.81), bodies=bodies, joints=joints)


def tip(q: np.ndarray) -> np.ndarray:
    """Place of the free end (3,), m."""
    last = q[-7:]
    return last[:3] + rotation_matrix(last[3:]) @ np.array([0.5 * LENGTH, 0.0, 0.0])


def ours(model: Model, case: Case) -> tuple[float, float, np.ndarray]:
    """Seconds of the first quarter and of the whole, and the free end."""
    simulation = Simulation(model, "hht", step=case.step, record=False)
    start = process_time()
    simulation.run_to(case.step * short(case))
    middle = process_time()
    simulation.run_to(case.step * case.steps)
    return middle - start, process_time() - start, tip(simulation.sample()[simulation.table.layout.q])


def run_case(case: Case) -> str:
    """A line of the table."""
    from exudyn_chain import run_model, settings_for

    model = spatial_chain(case.links)

    def theirs(settings: object) -> tuple[float, float, np.ndarray]:
        quick, _ = run_model(model, short(case) * case.step, case.step, settings)
        whole, q = run_model(model, case.steps * case.step, case.step, settings)
        return quick, whole, tip(q)

    sides: dict[str, Callable[[], tuple[float, float, np.ndarray]]] = {"ours": lambda: ours(model, case)}
    for s in settings_for(case.links):
        sides[s.name] = lambda s=s: theirs(s.settings)  # type: ignore[misc]
    ours(model, Case(case.links, case.step, 4, 0.0))  # compiled code is loaded once, outside the timing
    runs = {name: [side() for _ in range(REPEATS)] for name, side in sides.items()}
    counted = case.steps - short(case)
    cost = {name: (min(r[1] for r in rs) - min(r[0] for r in rs)) / counted for name, rs in runs.items()}
    best = min((name for name in cost if name != "ours"), key=lambda name: cost[name])
    exact = tip(simulate(model, case.step * case.steps, "irk", rtol=1e-11, atol=1e-13, record=False).q[-1])
    errors = [float(np.linalg.norm(runs[name][-1][2] - exact)) for name in ("ours", best)]
    return (
        f"{case.links:5d} {case.step:6.0e} {case.steps:6d} {cost['ours'] * 1e6:9.2f} us ({errors[0]:.1e} m) "
        f"{cost[best] * 1e6:9.2f} us ({errors[1]:.1e} m) {cost['ours'] / cost[best]:6.3f} {case.target:5.2f}  {best}"
    )


def main() -> None:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--links", type=int, nargs="*", help="only these numbers of links")
    parser.add_argument("--fast", action="store_true", help="exudyn's module without range checks (AVX2)")
    parser.add_argument("--core", type=int, help="number of the core to run on")
    options = parser.parse_args()
    if options.fast:
        os.environ["EXUDYN_MODULE"] = "fast"
    print(f"core {pin_to_one_core(options.core)}, best of {REPEATS}")
    print("links      h  steps      ours     (error)        exudyn    (error)  ratio target  exudyn's setting")
    for case in CASES:
        if not options.links or case.links in options.links:
            print(run_case(case), flush=True)


if __name__ == "__main__":
    main()
