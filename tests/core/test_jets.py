"""Compiled jets: exact derivatives as those of the interpreted `Jet`, and no more of them than a formula has."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit, types
from numba.extending import intrinsic
from tlismni.core.compiled.jet_functions import gradient_of, hessian_of, lift, value_of
from tlismni.core.compiled.jets import JetType, Parts, made_of
from tlismni.core.equations.jet import Jet

SIZE = 3


def variable(i):
    kind = JetType(SIZE, (i,))

    @intrinsic
    def seeded(typing_context, x):
        def codegen(context, builder, sig, args):
            return made_of(context, builder, kind, Parts(args[0], {i: context.get_constant(types.float64, 1.0)}, {}))

        return kind(types.float64), codegen

    return seeded


FIRST, SECOND, THIRD = (variable(i) for i in range(SIZE))


def compiled_jet(formula):
    """f(x, y, z) -> value, gradient, Hessian, and the function of jets itself."""
    function = njit(error_model="numpy")(formula)

    @njit(error_model="numpy")
    def run(x, y, z):
        jet = lift(FIRST(x), function(FIRST(x), SECOND(y), THIRD(z)))
        return value_of(jet), gradient_of(jet), hessian_of(jet)

    return run, function


def looped(x, y, z):
    total = 0.0
    for k in range(4):
        total = total + x * y if k % 2 == 0 else total * z - 1
    return total


def branched(x, y, z):
    r = x if x > y else y * z * z
    return r * r - (0.5 if z <= 1.0 else z)


# the same with numpy's functions for the interpreted jets
FORMULAS = {
    "sums and products": (lambda x, y, z: x * y + z - 2 * x, None),
    "quotients": (lambda x, y, z: x / (y * z + x * x) / x + 3.0 / z + y / 2, None),
    "powers": (lambda x, y, z: (x - y) ** 2 + x**3 * z**1.5 + x**1 + y**0 + 2.0**x + x**y, None),
    "roots and logarithms": (lambda x, y, z: np.sqrt(x) * np.exp(y) + np.log(x + y) - np.log1p(z) * np.expm1(y), None),
    "trigonometry": (lambda x, y, z: np.sin(x) * np.cos(y) + np.tan(z / 3) + np.arctan(x * z), None),
    "hyperbolic": (lambda x, y, z: np.sinh(x) * np.cosh(y) - np.tanh(z * x), None),
    "inverse": (lambda x, y, z: np.arcsin(x / 4) + np.arccos(y * z / 20), None),
    "angles": (lambda x, y, z: np.arctan2(y - z, x) * np.hypot(x, z), None),
    "choices": (lambda x, y, z: max(x * y, z) * min(y, z * z) + abs(x - 3.0) - abs(z),
                lambda x, y, z: (x * y if x * y > z else z) * (y if y < z * z else z * z) + abs(x - 3.0) - abs(z)),
    "loops": (looped, None),
    "branches": (branched, None),
    "steps": (lambda x, y, z: x * y - 2.0 * np.floor(x / y) + np.rint(z),
              lambda x, y, z: x * y - 2.0 * math.floor(x.value / y.value) + round(z.value)),
}  # fmt: skip
COMPILED = {}
places = st.floats(0.2, 2.5)


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", FORMULAS)
def test_derivatives_are_those_of_the_interpreted_jets(name):
    formula, plain = FORMULAS[name]
    run, _ = compiled_jet(formula)
    pairs = [(i, j) for i in range(SIZE) for j in range(i, SIZE)]

    @settings(deadline=None, max_examples=25, derandomize=True)
    @given(places, places, places)
    def check(x, y, z):
        seeds = [Jet(v, np.eye(SIZE)[i], np.zeros((SIZE, SIZE))) for i, v in enumerate((x, y, z))]
        expected = (plain or formula)(*seeds)
        value, gradient, hessian = run(x, y, z)
        assert value == pytest.approx(expected.value, rel=1e-13, abs=1e-13)
        assert gradient == pytest.approx(expected.gradient, rel=1e-12, abs=1e-12)
        assert hessian == pytest.approx([expected.hessian[p] for p in pairs], rel=1e-11, abs=1e-11)

    check()


@pytest.mark.parametrize(
    "formula, first, second",
    [
        (lambda x, y, z: x - y, (0, 1), ()),
        (lambda x, y, z: (x - y) * (x - y), (0, 1), ((0, 0), (0, 1), (1, 1))),
        (lambda x, y, z: x * y + z, (0, 1, 2), ((0, 1),)),
        (lambda x, y, z: x / y, (0, 1), ((0, 1), (1, 1))),
        (lambda x, y, z: math.sin(z) + 2.0 * x, (0, 2), ((2, 2),)),
        (lambda x, y, z: x - math.floor(z), (0,), ()),
    ],
)
def test_a_jet_has_the_derivatives_that_its_formula_has(formula, first, second):
    run, function = compiled_jet(formula)
    run(1.0, 2.0, 3.0)
    (signature,) = function.nopython_signatures
    assert signature.return_type == JetType(SIZE, first, second)


def test_angles_are_smooth_all_the_way_round():
    run, _ = compiled_jet(lambda x, y, z: math.atan2(y, x))
    for angle in np.linspace(-math.pi, math.pi, 41)[:-1]:
        c, s = math.cos(angle), math.sin(angle)
        value, gradient, hessian = run(2.0 * c, 2.0 * s, 0.0)
        assert value == pytest.approx(math.atan2(s, c), abs=1e-15)
        assert gradient == pytest.approx((-0.5 * s, 0.5 * c, 0.0), abs=1e-15)
        assert hessian[:2] == pytest.approx((0.5 * c * s, 0.25 * (s * s - c * c)), abs=1e-15)
