"""The polynomial of the dense output: Hermite's, through the newest rows."""

import numpy as np
import pytest
from numpy.polynomial import Polynomial
from tlismni.core.event_detection.dense_output import _hermite

NODES = [(0.0, -1.0), (0.0, -1.0, -2.0), (0.0, -1.0, -1.1), (0.0, -1.0, -37.0)]


def interpolated(polynomial, z, alike, s):
    """Value and slope at s of what `_hermite` makes of a polynomial's Taylor coefficients at the nodes."""
    values, slopes = np.zeros((3, 3)), np.zeros((3, 3))
    _hermite.py_func(np.array(z), len(z), alike, s, values, slopes)
    taylor = (polynomial, polynomial.deriv(), 0.5 * polynomial.deriv(2))
    known = np.array([[f(node) for f in taylor[:alike]] for node in z])
    return np.sum(values[: len(z), :alike] * known), np.sum(slopes[: len(z), :alike] * known)


@pytest.mark.parametrize("alike", [2, 3])
@pytest.mark.parametrize("z", NODES)
def test_exact_for_polynomials(z, alike):
    """Of the degree that the conditions determine, within the newest step and beside it."""
    rng = np.random.default_rng(len(z) + alike)
    size = max(map(abs, z))
    polynomial = Polynomial(rng.normal(size=alike * len(z)))(Polynomial([0.0, 1.0 / size]))
    apart = min(1.0, *(abs(a - b) for a in z for b in z if a != b))
    rounding = 1e-14 / apart ** (2 * alike - 1)
    for s in (-1.0, -0.75, -0.3, -1e-9, 0.0, 0.2):
        expected = (polynomial(s), polynomial.deriv()(s))
        assert interpolated(polynomial, z, alike, s) == pytest.approx(expected, rel=rounding, abs=rounding)


@pytest.mark.parametrize("alike", [2, 3])
def test_not_exact_beyond(alike):
    """One degree more is not determined: what is left out is the product over the nodes."""
    z = NODES[1]
    beyond = Polynomial.fromroots(np.repeat(z, alike))
    value, slope = interpolated(beyond, z, alike, -0.5)
    assert (value, slope) == pytest.approx((0.0, 0.0), abs=1e-13)
    assert abs(beyond(-0.5)) > 1e-3
