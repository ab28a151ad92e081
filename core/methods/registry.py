"""The methods by name: their step, their options and how much history they need."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

from ..errors import ModelError
from .adams import adams_step
from .bdf import bdf_step
from .comparison import COMPARISON_METHODS
from .ebdf import ebdf_step
from .irk import irk_step
from .method import Formula, Method, Option
from .newmark import newmark_step
from .order_selection import select_k, select_stable_k
from .park import park_step
from .sdirk import C, sdirk_fine_step, sdirk_step
from .tableaus import MIDPOINT, TABLEAUS, Tableau

STARTER_STAGES = tuple(float(c) for c in C)

# With growth by 2 after k + 1 equal steps the variable-step formulas are zero-stable up to k = 6; beyond, these are.
EBDF_GROWTH = {7: 1.5, 8: 1.2}
# Angles of A(alpha)-stability in degrees for k = 1, 2 ... (Hairer and Wanner II, V.1 and V.3; Cash 1980, 1983)
ANGLES = {
    "bdf": (90.0, 90.0, 86.03, 73.35, 51.84, 17.84),
    "ebdf": (90.0, 90.0, 90.0, 87.61, 80.21, 67.73, 48.82, 19.98),
    "mebdf": (90.0, 90.0, 90.0, 88.36, 83.07, 74.48, 61.98, 42.87),
}
MOST_AUTOMATIC = {"bdf": 5, "ebdf": 6, "mebdf": 6}
FIRST_AUTOMATIC = 3

_ANGLE = Option(
    0.0, 0.0, 90.0, "automatic choice only: least angle of A(alpha)-stability, degrees; 90 keeps to A-stable formulas"
)


def _steps(default: int, most: int, description: str) -> Option:
    return Option(default, 1, most, description, integer=True, choices=("auto",))


_EXTENDED = Option(
    "stable",
    1,
    8,
    "number of steps k, the order is k + 1; stable: 4, and with flexible bodies 3, which is A-stable, from "
    "when steps do not resolve their fastest vibration; auto: chosen by the error",
    integer=True,
    choices=("stable", "auto"),
)


def _multistep(name: str, step: Any, k: float | str, angle: float, parameters: tuple[float, ...]) -> Formula:
    """A formula of k steps; "auto": k is chosen as the run goes, among those that are stable enough."""
    stages = (1.0,) if name == "bdf" else (1.0, 2.0)
    if k == "stable":
        return Formula(step, 4, (*parameters, 3.0, 4.0), 5, stages, select=select_stable_k)
    if k != "auto":
        growth, sums_up = (2.0, float(k)) if name == "bdf" else (EBDF_GROWTH.get(int(k), 2.0), 0.0)
        return Formula(step, int(k), parameters, int(k) + 1, stages, growth, sums_up=sums_up)
    most = max(i + 1 for i, alpha in enumerate(ANGLES[name][: MOST_AUTOMATIC[name]]) if alpha >= angle)
    first = min(FIRST_AUTOMATIC, most)
    sums_up = float(most) if name == "bdf" else 0.0
    return Formula(step, first, (*parameters, 1.0, float(most)), first + 1, stages, select=select_k, sums_up=sums_up)


# errors of the stages of one-step formulas add up over many more steps than those of multistep ones, and nothing
# smooths their forces
FINE = 1e-3


def _irk(name: str) -> Formula:
    if name == "sdirk4":
        return Formula(sdirk_step, stages=STARTER_STAGES, newton_tolerance=FINE, embedded=True)
    return _coupled(TABLEAUS[name])


def _coupled(tableau: Tableau) -> Formula:
    parameters = (len(tableau.b), float(tableau.stiffly_accurate), tableau.order_of_error)
    stages = (*tableau.c, 1.0)
    return Formula(
        irk_step, 0, parameters, 1, stages, newton_tolerance=FINE, weights=tableau.data(),
        outer_loops=("newton", "simple"),
    )  # fmt: skip


def _newmark(alpha: float, beta: float, gamma: float) -> Formula:
    # its guess is mostly good enough for one increment, which has to see the constraints met: what they leave open goes
    # into the accelerations of stiff parts, and these unsmoothed into the next guess and into the estimate of the error
    sums_up = 2.0 if abs(gamma + alpha - 0.5) < 1e-12 else 1.0
    return Formula(newmark_step, 0, (alpha, beta, gamma), carries=True, slack=1.0, sums_up=sums_up)


def _hht(values: Mapping[str, Any]) -> Formula:
    alpha = values["alpha"]
    return _newmark(alpha, (1.0 - alpha) ** 2 / 4.0, 0.5 - alpha)


METHODS = {
    method.name: method
    for method in (
        Method(
            "newmark",
            "TLISMNI with Newmark's formula, accelerations as unknowns; order 2 for gamma = 1/2",
            {
                "beta": Option(0.25, 0.01, 2.0, "beta; 1/4 with gamma 1/2 is the average acceleration"),
                "gamma": Option(0.5, 0.5, 1.5, "gamma; above 1/2 it damps, at order 1"),
            },
            lambda o: _newmark(0.0, o["beta"], o["gamma"]),
        ),
        Method(
            "hht",
            "TLISMNI with the HHT-alpha formula, accelerations as unknowns; order 2",
            {"alpha": Option(-0.05, -1.0 / 3.0, 0.0, "numerical damping: 0 none, -1/3 most")},
            _hht,
        ),
        Method(
            "trapezoidal",
            "TLISMNI with the trapezoidal rule, coordinates and velocities as unknowns; order 2, A-stable",
            {},
            lambda o: Formula(adams_step, 2, (), 2, sums_up=2.0),
        ),
        Method(
            "park",
            "TLISMNI with Park's formula, the mean of BDF 2 and BDF 3; order 2, L-stable",
            {},
            lambda o: Formula(park_step, 0, (), 3, sums_up=2.0),
        ),
        Method(
            "bdf",
            "TLISMNI with the BDF of k steps and order k, coordinates and velocities as unknowns",
            {
                "order": _steps(3, 6, "order k, or chosen by the error; 7 and 8 are unstable for any step"),
                "angle": _ANGLE,
            },
            lambda o: _multistep("bdf", bdf_step, o["order"], o["angle"], (0.0,)),
        ),
        Method(
            "ebdf",
            "TLISMNI with Cash's extended BDF of k steps, order k + 1; A-stable up to k = 3",
            {"k": _EXTENDED, "angle": _ANGLE},
            lambda o: _multistep("ebdf", ebdf_step, o["k"], o["angle"], (0.0,)),
        ),
        Method(
            "mebdf",
            "TLISMNI with the modified extended BDF: as ebdf, more stable, one matrix for all its stages",
            {"k": _EXTENDED, "angle": _ANGLE},
            lambda o: _multistep("mebdf", ebdf_step, o["k"], o["angle"], (1.0,)),
        ),
        Method(
            "adams",
            "TLISMNI with implicit Adams formulas on the actual grid, Milne's error estimate; not for stiff systems",
            {"order": Option(4, 2, 8, "order; high ones for smooth, soft systems and tight tolerances", integer=True)},
            lambda o: Formula(adams_step, int(o["order"]), (), int(o["order"]), sums_up=o["order"]),
        ),
        Method(
            "irk",
            "TLISMNI with an implicit Runge-Kutta method, self-starting: "
            + "; ".join(f"{name}: {tableau.description}" for name, tableau in TABLEAUS.items())
            + "; sdirk4: SDIRK with 5 stages one after the other, order 4, L-stable",
            {"tableau": Option.word("radau3", (*TABLEAUS, "sdirk4"), "the Runge-Kutta coefficients")},
            lambda o: _irk(o["tableau"]),
        ),
        Method(
            "moreau",
            "Moreau-Jean time stepping: contacts as impulses of fixed steps, without events; order 1, for crowds of "
            "contacts; smooth motion by the implicit midpoint rule",
            {"sweeps": Option(100, 1, 100_000, "sweeps over the contacts of a step, at most", integer=True)},
            lambda o: replace(_coupled(MIDPOINT), impulses=True, carries=True, sweeps=int(o["sweeps"])),
            family="time stepping",
        ),
        *COMPARISON_METHODS,
    )
}

STARTER = sdirk_step
FINE_STARTER = sdirk_fine_step


def get_formula(name: str, options: Mapping[str, Any]) -> Formula:
    """The formula of method `name` with `options`.

    Raises
    ------
    ModelError : for an unknown method or option, or a value outside its range.
    """
    if name not in METHODS:
        raise ModelError(f"unknown method '{name}'; known are {sorted((*METHODS, 'auto'))}")
    method = METHODS[name]
    unknown = set(options) - set(method.options)
    if unknown:
        raise ModelError(f"method '{name}' has no option {sorted(unknown)}; it has {sorted(method.options)}")
    values: dict[str, Any] = {key: option.default for key, option in method.options.items()}
    for key, value in options.items():
        values[key] = method.options[key].read(value, f"option {key} of method '{name}'")
    return method.formula(values)
