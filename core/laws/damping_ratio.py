"""Damping ratio and restitution of a spring with a damper that lets go where its force would become tensile.

For m d'' + c d' + k d = 0 (Schwager and Poeschel, Granular Matter 9 (2007) 465). With u = d^(5/4) as coordinate and
the time stretched by d^(1/4), Tsuji's law is this one too (Antypov and Elliott, EPL 94 (2011) 50004), with rates in
proportion to d' and the same place of zero force: its restitution is that of the damping ratio c/sqrt(5 m K).
"""

import math

LARGEST_RATIO = 1e9
"""Of the search: restitution 1/(2 zeta)^2 falls to 2.5e-19 there."""


def restitution_without_pull(damping_ratio: float) -> float:
    """Rebound over approach speed for the damping ratio zeta >= 0, dimensionless.

    The force is zero where tan(wd t) = -2 z s/(1 - 2 z^2), s = sqrt(1 - z^2), wd = s w; there the rebound speed is
    v0 exp(-z w t). Above critical damping s becomes imaginary and the tangent hyperbolic: w t = 2 ln(z + s)/s.
    """
    z = damping_ratio
    if z < 1.0:
        s = math.sqrt(1.0 - z * z)
        return math.exp(-z * math.atan2(2.0 * z * s, 2.0 * z * z - 1.0) / s) if s > 0.0 else math.exp(-2.0)
    if z == 1.0:
        return math.exp(-2.0)
    s = math.sqrt(z * z - 1.0)
    return math.exp(-2.0 * z * math.log(z + s) / s)


def damping_ratio_without_pull(restitution: float) -> float:
    """The zeta with which `restitution`, 0 < e <= 1, comes out.

    Raises
    ------
    ValueError : for another restitution.
    """
    if not 0.0 < restitution <= 1.0:
        raise ValueError(f"no damping ratio gives restitution {restitution:g}: give 0 < restitution <= 1")
    if restitution == 1.0:
        return 0.0
    # importing scipy.optimize costs more than most runs: only who needs a root pays
    from scipy.optimize import brentq

    return float(brentq(lambda z: restitution_without_pull(z) - restitution, 0.0, LARGEST_RATIO, xtol=1e-15))
