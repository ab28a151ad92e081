"""What compiled code reports beside events, as warnings in the log."""

import logging

from ..rounding import UNSOLVED

logger = logging.getLogger(__name__)


def warn_of_gain(t: float, gains: list[tuple[str, float]], laws: dict[str, str]) -> None:
    logger.warning(
        "at t = %.9g s an impact of %s raises the energy by %.3g J: Newton's law can with friction or several "
        "contacts; PoissonImpact does not with friction",
        t,
        ", ".join(f"'{name}' ({laws[name]})" for name, _ in gains),
        gains[0][1],
    )


def warn_of_rounds(t: float, names: list[str]) -> None:
    """Say which contacts the first impact in rounds has struck, and by which law."""
    logger.warning(
        "at t = %.9g s no velocities are found that fulfil the impact laws of all contacts at once without a gain of "
        "energy: %s are struck in rounds, in each of them the contacts that approach then. So they may leave with less "
        "than restitution times approach. Further ones of this run are counted in stats['impacts_in_rounds']",
        t,
        ", ".join(f"'{name}'" for name in names),
    )


def warn_of_unshared_load(t: float, name: str) -> None:
    """Say that contacts that repeat each other share their load in another way than the least forces."""
    logger.warning(
        "at t = %.9g s the least forces of contacts that repeat each other ('%s' and others) are not found: they have "
        "others that fulfil all conditions, and the motion of the bodies is the same unless friction depends on it. "
        "Instants like this are counted in stats['unshared_loads']",
        t,
        name,
    )


def warn_of_left_approach(t: float, name: str) -> None:
    """Say that an impact of many contacts has left approaches, for which no impulses are found."""
    logger.warning(
        "at t = %.9g s an impact leaves approaches of less than %.0e of its speeds, which no impulses are found for "
        "('%s' and others): gaps may close by as much. Instants like this are counted in stats['left_approaches']",
        t,
        UNSOLVED,
        name,
    )


def warn_of_jump(t: float, jumps: list[tuple[str, float]]) -> None:
    """Say which drivers strike: an event is of a contact, and a jump of a Ramp's velocity is seldom meant."""
    logger.warning(
        "at t = %.9g s the velocity jumps (%s): an impact of the driver; its work is in energy.input_work. "
        "A Polynomial or a Table starts smoothly",
        t,
        ", ".join(f"driver '{name}' by {jump:.6g}" for name, jump in jumps),
    )
