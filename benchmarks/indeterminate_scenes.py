"""Random scenes with indeterminate contact forces: are forces those of the dense reference, is the motion that of any
order of the lists and of any units?

    python benchmarks/indeterminate_scenes.py [--first 0] [--scenes 1000] [--plane | --space] [--limit 60]

Scenes and reference are those of `tests/core/test_random_indeterminate_scenes.py`. Each scene runs in three orders and
in other units (of 1e-6 to 1e3 for a metre, and of any mass and time). A scene whose motion at the end differs by more
than 1e-9 runs again with a tolerance of 1e-10: what differs then by ten times less is the error of integration,
whose steps follow the choice of dependent coordinates. A worker process is ended where a scene takes longer than
the limit (s). "no forces" are scenes of which the reference finds none.
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
from scene_checks import TIGHT, wrong


def work(scenes: Connection) -> None:
    """Examine scenes of (seed, dimension) until there are none."""
    from indeterminate_scenes import scene
    from scene_checks import deviations

    logging.disable(logging.WARNING)
    while (task := scenes.recv()) is not None:
        kind = "?"
        try:
            drawn = scene(*task)
            kind = f"{drawn.kind} {drawn.method}"
            scenes.send((kind, *deviations(drawn), ""))
        except Exception as error:
            scenes.send((kind, None, None, f"{type(error).__name__}: {error}"))


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
        if error:
            says = "no forces" if error.startswith("NotFound") else "error"
        else:
            says = " ".join(wrong(found, tight)) or ("same" if tight is None else "steps")
        counts[says] += 1
        counts[f"({kind.split()[0]})"] += 1
        for what in ("order", "units", "forces", "motion"):
            if not error:
                worst[what] = max(worst.get(what, 0.0), getattr(found, what))
                if tight is not None and what in ("order", "units"):
                    worst[f"tight {what}"] = max(worst.get(f"tight {what}", 0.0), getattr(tight, what))
        if says != "same":
            again = "" if tight is None else f"; at {TIGHT:g}: {tight}"
            print(f"{seed} {kind} {perf_counter() - begun:.1f} s: {says}; {error or found}{again}", flush=True)
    if process is not None and end is not None:
        end.send(None)
    for name, count in sorted(counts.items()):
        print(f"{count:6d} {name}")
    print(", ".join(f"{name} {value:.1e}" for name, value in worst.items()))


if __name__ == "__main__":
    main()
