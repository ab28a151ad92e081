"""Who runs in `accuracy_per_time.py`, with which settings: ours, exudyn, solve_dae, IDA."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cache
from time import perf_counter, process_time
from typing import Any

from accuracy_problems import Array, Problem
from peer_equations import Equations, equations
from peer_solvers import PeerFailed, dae_solver, ida, missing
from tlismni.core import Simulation, SimulationError

OURS, EXUDYN, EXUDYN_TREE, SOLVE_DAE, IDA = "ours", "exudyn", "exudyn, minimal", "solve_dae", "IDA"


@dataclass(frozen=True)
class Run:
    """Seconds of the integration alone (CPU; clock for solve_dae and IDA), coordinates at the end, what was counted."""

    seconds: float
    q: Array
    counts: dict[str, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Contender:
    """A method in one way of running it; `settings` from rough to fine are tolerances, or numbers of steps."""

    side: str
    name: str
    settings: Sequence[float]
    run: Callable[[float], Run]
    fixed_step: bool = False


TRIAL_STEPS = 4000
"""Of exudyn, to find its fastest linear solver and Newton."""


class TimeLimit(Exception):
    """A run took longer than it may."""


def decades(first: float, last: float, per_decade: int = 2) -> tuple[float, ...]:
    """10^-first ... 10^-last."""
    count = round((last - first) * per_decade)
    return tuple(float(f"{10.0 ** -(first + k / per_decade):.3g}") for k in range(count + 1))


SMOOTH: dict[str, tuple[str, dict[str, Any]]] = {
    "adams 4": ("adams", {"order": 4}),
    "adams 6": ("adams", {"order": 6}),
    "adams 8": ("adams", {"order": 8}),
    "bdf auto": ("bdf", {"order": "auto"}),
    "ebdf 4": ("ebdf", {"k": 4}),
    "ebdf auto": ("ebdf", {"k": "auto"}),
    "mebdf auto": ("mebdf", {"k": "auto"}),
    "irk": ("irk", {}),
    "hht": ("hht", {}),
}
# formulas that are not A-stable follow an undamped vibration of 10 kHz with small steps, whatever the tolerance
STIFF: dict[str, tuple[str, dict[str, Any]]] = {
    "ebdf 3": ("ebdf", {"k": 3}),
    "ebdf auto, A-stable": ("ebdf", {"k": "auto", "angle": 90}),
    "mebdf auto, A-stable": ("mebdf", {"k": "auto", "angle": 90}),
    "bdf 2": ("bdf", {"order": 2}),
    "irk": ("irk", {}),
    "hht": ("hht", {}),
}


def ours(problem: Problem, limit: float, quick: bool) -> list[Contender]:
    """Our methods with error control."""
    methods = STIFF if problem.stiff else SMOOTH
    if quick:
        wanted = ("ebdf 3", "irk") if problem.stiff else ("adams 8", "bdf auto", "ebdf auto")
        methods = {name: methods[name] for name in wanted}
    # rougher ones follow the vibration that they excite, which takes longer than to leave it alone
    settings = decades(3 if problem.stiff else 1, 13, 1 if quick else 2)

    def contender(name: str, method: str, options: dict[str, Any]) -> Contender:
        def run(tolerance: float) -> Run:
            simulation = Simulation(problem.model, method, tolerance, 0.01 * tolerance, record=False, **options)
            start, began = perf_counter(), process_time()

            def in_time(t: float) -> None:
                if perf_counter() - start > limit:
                    raise TimeLimit

            simulation.progress = in_time
            try:
                simulation.run_to(problem.t_end)
            except SimulationError as error:
                raise PeerFailed(str(error)) from error
            seconds = process_time() - began
            return Run(seconds, simulation.sample()[simulation.table.layout.q].copy(), simulation.stats)

        return Contender(OURS, name, settings, run)

    return [contender(name, *spec) for name, spec in methods.items()]


def exudyn(problem: Problem, limit: float, quick: bool) -> list[Contender]:
    """exudyn's integrators with fixed steps, each with the linear solver and the Newton that are fastest here.

    Twice each: with a loose tolerance of Newton's iteration, enough for rough results, and with a tight one.
    """
    from exudyn_chain import run_model, settings_for
    from tlismni.validation.errors import ExudynFailed

    found = []
    for integrator in ("generalized_alpha", "trapezoidal"):
        for rtol, atol in ((1e-5, 1e-6), (1e-10, 1e-10)):
            times = []
            for setting in settings_for(problem.bodies, integrator, rtol=rtol, atol=atol):
                try:
                    step = problem.t_end / TRIAL_STEPS
                    tries = [run_model(problem.model, problem.t_end, step, setting.settings)[0] for _ in range(3)]
                except ExudynFailed:
                    continue
                times.append((min(tries), setting))
            if not times:
                continue
            chosen = min(times, key=lambda t: t[0])[1]

            def run(steps: float, chosen: Any = chosen) -> Run:
                try:
                    seconds, q = run_model(problem.model, problem.t_end, problem.t_end / steps, chosen.settings)
                except ExudynFailed as error:
                    raise PeerFailed(str(error)) from error
                return Run(seconds, q, {"steps": int(steps)})

            settings = tuple(125.0 * 2.0**k for k in range(20))
            found.append(Contender(EXUDYN, f"{chosen.name}, Newton {rtol:g}", settings, run, fixed_step=True))
    return found


def exudyn_tree(problem: Problem, limit: float, quick: bool) -> list[Contender]:
    """exudyn's fastest way for chains without loops: minimal coordinates and explicit methods with error control."""
    from exudyn_tree import METHODS, run_chain

    if problem.name != "chain":
        return []

    def contender(method: str) -> Contender:
        def run(tolerance: float) -> Run:
            return Run(*run_chain(problem.model, problem.t_end, method, tolerance))

        return Contender(EXUDYN_TREE, f"ObjectKinematicTree, {method}", settings[method], run)

    settings = {"DOPRI5": decades(2, 11, 2), "ODE23": decades(2, 8, 1)}
    return [contender(method) for method in METHODS]


@cache
def _equations(name: str, index: int) -> Equations:
    from accuracy_problems import problems

    return equations(next(p.model for p in problems() if p.name == name), index)


def _peer(side: str, name: str, settings: Sequence[float], run: Callable[[float], tuple[float, Array]]) -> Contender:
    return Contender(side, name, settings, lambda tolerance: Run(*run(tolerance)))


def solve_dae(problem: Problem, limit: float, quick: bool) -> list[Contender]:
    """Radau and BDF on the stabilised index-1 form, which its examples use; the form of index 2 fails.

    Sparse and dense cost the same within a few per cent at 100 unknowns; below that dense is faster.
    """
    system = _equations(problem.name, 1)
    sparse = system.size >= 100
    found = []
    for method, last in (("Radau", 12), ("BDF", 10)):
        orders = (2, 5) if problem.stiff and method == "BDF" and not quick else (5,)
        for order in orders:
            options = {"max_order": order} if method == "BDF" else {}
            run = dae_solver(system, problem.t_end, method, sparse, limit, **options)
            name = f"{method}{f', order up to {order}' if len(orders) > 1 else ''}"
            found.append(_peer(SOLVE_DAE, name, decades(2, last, 1), run))
    return found


def ida_peer(problem: Problem, limit: float, quick: bool) -> list[Contender]:
    """IDA on the Gear-Gupta-Leimkuhler form (index 2), and with the multipliers as derivatives (index 1).

    Its own dense solver: SuperLU_MT and LAPACK were four to ten times slower at 100 unknowns.
    """
    found = []
    for index in (2,) if quick else (2, 1):
        for order in (2, 5) if problem.stiff and not quick else (5,):
            run = ida(_equations(problem.name, index), problem.t_end, "dense", limit, order)
            name = f"GGL, index {index}{f', order up to {order}' if problem.stiff and not quick else ''}"
            found.append(_peer(IDA, name, decades(2, 13, 1 if quick else 2), run))
    return found


PEERS: dict[str, tuple[str, str, Callable[[Problem, float, bool], list[Contender]]]] = {
    EXUDYN: ("exudyn", "exudyn==1.13.*", exudyn),
    EXUDYN_TREE: ("exudyn", "exudyn==1.13.*", exudyn_tree),
    SOLVE_DAE: ("scipy_dae", "scipy_dae", solve_dae),
    IDA: ("sksundae", "scikit-sundae", ida_peer),
}


def absent_peers() -> dict[str, str]:
    """Peers that cannot run, and why."""
    return {side: why for side, (module, package, _) in PEERS.items() if (why := missing(module, package))}


def contenders(problem: Problem, limit: float, quick: bool) -> list[Contender]:
    """All that can run, ours first."""
    found = ours(problem, limit, quick)
    absent = absent_peers()
    for side, (_, _, build) in PEERS.items():
        if side not in absent:
            found += build(problem, limit, quick)
    return found
