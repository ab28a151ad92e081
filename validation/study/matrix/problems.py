"""How the matrix runs scenarios: with their defaults, but where those cost more than they show."""

from ..problems import Problem

PROBLEMS = {
    problem.scenario: problem
    for problem in (
        # stiff cables: the waves along them ask error control for steps of microseconds
        Problem("cable_ground", t_end=0.35),
        Problem("cable_pendulum", t_end=0.2),
        Problem("cantilever", t_end=0.05),
        # before its bounces accumulate: then each comes sooner after the other than any tolerance tells
        Problem("bouncing_ball", t_end=3.9),
        # meshes as coarse as in the short form of the cross-check: a mesh is part of the problem here
        Problem("rod_wall", {"elements": 20}),
        Problem("rod_rod", {"elements": 20}),
        Problem("mass_on_rod", {"elements": 20}),
    )
}


def problem_of(scenario: str) -> Problem:
    """How the matrix runs a scenario."""
    return PROBLEMS.get(scenario, Problem(scenario))
