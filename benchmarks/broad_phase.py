"""What pairs that are far from each other cost: free spheres in a box, with the broad phase and without.

    python benchmarks/broad_phase.py [--spheres 50 100 200] [--steps 200] [--room 8]

One group for all spheres and the walls of the box (`heap3d.py`), no weight, speeds of 5 mm/s, steps of 1 ms: nothing
touches. Memory is what the process has grown by. "margins": no sweep, each pair has a margin that is looked at in every
step (`event_detection/contact_sleeping.py`). With --room the group has so many contacts for each sphere
(`most_contacts`) in place of one for each pair.
"""

import argparse
import gc
from pathlib import Path
from time import process_time

import numpy as np
from heap3d import our_model, places
from tlismni.core import Model, Simulation

STEP = 1e-3
SPEED = 0.005


def flight(count: int, most: int | None) -> Model:
    """The spheres of the heap before they drop, each on its way."""
    model, rng = our_model(places(count, 0), 1e-2, 1e-3, most), np.random.default_rng(0)
    bodies = [body.model_copy(update={"velocity": tuple(rng.normal(0.0, SPEED, 3))}) for body in model.bodies]
    return Model(gravity=(0.0, 0.0, 0.0), bodies=bodies, groups=model.groups)


def resident() -> float:
    """Memory of this process, MB; Linux only."""
    return int(Path("/proc/self/statm").read_text().split()[1]) * 4096 / 1e6


def measure(count: int, steps: int, swept: bool, most: int | None) -> tuple[int, float, float, float]:
    """(pairs, s to make the run, MB that it takes, ms a step)."""
    gc.collect()
    before, start = resident(), process_time()
    sim = Simulation(flight(count, most), "ebdf", max_step=STEP)
    made, grown = process_time() - start, resident() - before
    if not swept:
        sim._loop.set_size("n_balls", 0)
    sim.advance(0.1 * STEP)
    start, first = process_time(), sim.stats["steps"]
    sim.advance(steps * STEP)
    taken = 1e3 * (process_time() - start) / (sim.stats["steps"] - first)
    if sim.events:
        raise RuntimeError(f"{count} spheres have touched: fewer steps")
    return len(sim.assembly.contacts), made, grown, taken


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--spheres", type=int, nargs="*", default=[50, 100, 200])
    parser.add_argument("--steps", type=int, default=200)
    parser.add_argument("--room", type=int, help="contacts for each sphere")
    args = parser.parse_args()
    measure(12, 20, True, None if args.room is None else 12 * args.room)  # what is compiled or loaded at the first use
    print("| spheres | contacts | s to make | MB | ms a step | with margins alone |\n|---|---|---|---|---|---|")
    for count in args.spheres:
        most = None if args.room is None else count * args.room
        contacts, made, grown, swept = measure(count, args.steps, True, most)
        margins = "" if most is not None else f"{measure(count, args.steps, False, None)[-1]:.2f}"
        print(f"| {count} | {contacts} | {made:.1f} | {grown:.0f} | {swept:.2f} | {margins} |", flush=True)


if __name__ == "__main__":
    main()
