"""The comparison methods by name: what else is in use for the equations that TLISMNI solves."""

from collections.abc import Mapping
from typing import Any

from ..stage.explicit import solve_explicit_stage
from ..stage.index1 import solve_index1_stage
from ..stage.index2 import solve_index2_stage
from ..stage.index3 import solve_index3_stage
from .generalized_alpha import generalized_alpha_step
from .hht_dae import hht_dae_step
from .method import Formula, Method, Option
from .schemes import EXPLICIT_SCHEMES, IMPLICIT_SCHEMES

FORMS = {"index2": (2.0, solve_index2_stage), "index3": (3.0, solve_index3_stage)}
_EXPLICIT = "explicit Runge-Kutta formula and error estimate, as in scipy"
_RATE = "1/s: rate of decay of the violation; equal: critically damped. Above about 2/h explicit schemes are unstable"


def _baumgarte(values: Mapping[str, Any]) -> Formula:
    # only now: the coefficients come from scipy.integrate, which takes 0.7 s to import
    from . import baumgarte

    scheme, stage, number = values["scheme"], solve_index1_stage, 0.0
    if scheme == "sdirk4":
        step = baumgarte.baumgarte_sdirk_step
    elif scheme == "trapezoidal":
        step = baumgarte.baumgarte_trapezoidal_step
    else:
        step, stage = baumgarte.baumgarte_explicit_step, solve_explicit_stage
        number = float(EXPLICIT_SCHEMES.index(scheme))
    parameters = (values["alpha"], values["beta"], float(values["rule"] == "step"), number)
    return Formula(step, 0, parameters, stage=stage, exact=False)


def _projection(values: Mapping[str, Any]) -> Formula:
    from .projection import projection_step

    parameters = (float(EXPLICIT_SCHEMES.index(values["scheme"])),)
    return Formula(projection_step, 0, parameters, stage=solve_explicit_stage, exact=False)


def _hht_dae(values: Mapping[str, Any], form: str) -> Formula:
    alpha = values["alpha"]
    index, stage = FORMS[form]
    return Formula(hht_dae_step, 0, (alpha, (1.0 - alpha) ** 2 / 4.0, 0.5 - alpha, index), stage=stage, exact=False)


def _generalized_alpha(values: Mapping[str, Any]) -> Formula:
    r = values["rho"]
    am, af = (2.0 * r - 1.0) / (r + 1.0), r / (r + 1.0)
    gamma = 0.5 + af - am
    index, stage = FORMS[values["form"]]
    parameters = (am, af, 0.25 * (gamma + 0.5) ** 2, gamma, float(values["start"] == "shifted"), index)
    return Formula(generalized_alpha_step, 0, parameters, stage=stage, carries=True, exact=False)


_DAMPING = Option(-0.05, -1.0 / 3.0, 0.0, "numerical damping: 0 none, -1/3 most")
COMPARISON_METHODS = (
    Method(
        "baumgarte",
        "all coordinates by an ODE formula, constraints by Baumgarte's stabilised accelerations",
        {
            "scheme": Option.word("rk45", (*EXPLICIT_SCHEMES, *IMPLICIT_SCHEMES), f"{_EXPLICIT}, or an implicit one"),
            "alpha": Option(5.0, 0.0, 1e6, _RATE),
            "beta": Option(5.0, 0.0, 1e6, "1/s: frequency of the violation; alpha = beta = 0: not stabilised"),
            "rule": Option.word("given", ("given", "step"), "step: alpha = 1/h, beta = sqrt(2)/h; for fixed steps"),
        },
        _baumgarte,
        "comparison",
    ),
    Method(
        "projection",
        "explicit Runge-Kutta steps, each projected onto position and velocity constraints by the least M-norm",
        {"scheme": Option.word("rk45", EXPLICIT_SCHEMES, _EXPLICIT)},
        _projection,
        "comparison",
    ),
    Method(
        "hht_i3",
        "HHT-alpha on the index-3 equations: position constraints only; order 2",
        {"alpha": _DAMPING},
        lambda o: _hht_dae(o, "index3"),
        "comparison",
    ),
    Method(
        "hht_ggl",
        "HHT-alpha on the stabilised index-2 equations: position and velocity constraints; order 2",
        {"alpha": _DAMPING},
        lambda o: _hht_dae(o, "index2"),
        "comparison",
    ),
    Method(
        "generalized_alpha",
        "generalized-alpha on the stabilised index-2 or the index-3 equations; order 2",
        {
            "rho": Option(0.9, 0.0, 1.0, "spectral radius for infinite frequency: 1 no damping, 0 most"),
            "form": Option.word("index2", tuple(FORMS), "position and velocity constraints, or positions only"),
            "start": Option.word(
                "shifted",
                ("shifted", "plain"),
                "first algorithmic acceleration (index3: and velocity); plain: the true",
            ),
        },
        _generalized_alpha,
        "comparison",
    ),
)
