"""Random scenes with indeterminate contact forces: are forces those of the dense reference, is the motion that of any
order of the lists and of any units?

    python benchmarks/indeterminate_scenes.py [--first 0] [--scenes 1000] [--plane | --space] [--limit 60]

Scenes and reference are those of `tests/core/test_random_indeterminate_scenes.py`. Each scene runs in three orders and
in other units (lengths of 1e-3 to 1e6 per metre). A scene whose motion at the end differs by more than 1e-9 runs again
with a tolerance of 1e-10: what differs then by ten times less is the error of integration, whose steps follow the choice of
dependent coordinates. A worker process is ended where a scene takes longer than the limit (s).
"""

import argparse
import logging
import multiprocessing
import sys
from collections import Counter
from multiprocessing.connection import Connection
from pathlib import Path
from time import perf_counter

sys.path.insert(0, str(Path(__file__).resolve().parents[1] / "tests" / "core"))

SAME, FORCES, TIGHT = 1e-9, 1e-6, 1e-10


def work(scenes: Connection) -> None:
    """Examine scenes of (seed, dimension) until there are none."""
    from indeterminate_scenes import scene
    from scene_checks import examine

    logging.disable(logging.WARNING)
    while (task := scenes.recv()) is not None:
        kind, found = "?", None
        try:
            drawn = scene(*task)
            kind = f"{drawn.kind} {drawn.method}"
            found = examine(drawn)
            if max(found.order, found.units) > SAME:
                tight = examine(drawn, rtol=TIGHT)
                scenes.send((kind, found, tight, ""))
            else:
                scenes.send((kind, found, None, ""))
        except Exception as error:
            scenes.send((kind, found, None, f"{type(error).__name__}: {error}"))


def verdict(found, tight, error: str) -> str:
    """What is wrong with a scene, or "same", or "steps" where the error of integration alone is another."""
    if error:
        return "error"
    wrong = []
    if found.forces > FORCES:
        wrong.append("forces")
    if found.motion > FORCES:
        wrong.append("motion")
    if tight is None:
        return " ".join(wrong) or "same"
    for what in ("order", "units"):
        if getattr(tight, what) > max(SAME, 0.1 * getattr(found, what)):
            wrong.append(what)
    return " ".join(wrong) or "steps"


def main() -> None:
    """Examine, and print what is wrong and how many of each kind."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--scenes", type=int, default=1000)
    parser.add_argument("--limit", type=float, default=60.0)
    where = parser.add_mutually_exclusive_group()
    where.add_argument("--plane", dest="dimension", action="store_const", const=2)
    where.add_argument("--space", dest="dimension", action="store_const", const=3)
    given = parser.parse_args()
    counts: Counter[str] = Counter()
    worst: dict[str, float] = {}
    process = end = None
    for seed in range(given.first, given.first + given.scenes):
        if process is None or end is None:
            end, other = multiprocessing.Pipe()
            process = multiprocessing.Process(target=work, args=(other,), daemon=True)
            process.start()
        begun = perf_counter()
        end.send((seed, given.dimension))
        if not end.poll(given.limit):
            process.kill()
            process, result = None, ("?", None, None, f"no end within {given.limit:g} s")
        else:
            try:
                result = end.recv()
            except EOFError:
                process, result = None, ("?", None, None, "the process has died")
        kind, found, tight, error = result
        says = verdict(found, tight, error)
        counts[says] += 1
        counts[f"({kind.split()[0]})"] += 1
        for what in ("order", "units", "forces", "motion"):
            if not error:
                worst[what] = max(worst.get(what, 0.0), getattr(found, what))
                if tight is not None and what in ("order", "units"):
                    worst[f"tight {what}"] = max(worst.get(f"tight {what}", 0.0), getattr(tight, what))
        if says != "same":
            print(f"{seed} {kind} {perf_counter() - begun:.1f} s: {says}; {error or found}{f'; at {TIGHT:g}: {tight}' if tight else ''}", flush=True)
    if process is not None and end is not None:
        end.send(None)
    for name, count in sorted(counts.items()):
        print(f"{count:6d} {name}")
    print(", ".join(f"{name} {value:.1e}" for name, value in worst.items()))


if __name__ == "__main__":
    main()
