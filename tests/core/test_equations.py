"""Own equations: jets against closed forms, residuals and tangents of user functions, and what is refused."""

import math

import numba as nb
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tlismni.core import EquationSystem, GapContact, NewtonImpact
from tlismni.core.equations import EquationError, EquationFunctions, Jet, LineJet

numbers = st.floats(-2.0, 2.0).map(lambda x: round(x, 6))
quick = settings(deadline=None, max_examples=40)


def jets(x, order=2):
    """Independent variables at the point x (k,)."""
    k = len(x)
    array = np.empty(k, dtype=object)
    for i in range(k):
        array[i] = Jet(x[i], np.eye(k)[i], np.zeros((k, k)) if order == 2 else None)
    return array


def complex_step(f, x):
    """Gradient of an analytic f at x (k,)."""
    return np.array([np.imag(f(x + 1e-100j * e)) / 1e-100 for e in np.eye(len(x))])


# ---- jets ---------------------------------------------------------------------------------------------

UNARY = {  # first and second derivative by hand, at an inner point of the domain
    "sin": (0.7, np.cos(0.7), -np.sin(0.7)),
    "cos": (0.7, -np.sin(0.7), -np.cos(0.7)),
    "tan": (0.7, 1 / np.cos(0.7) ** 2, 2 * np.sin(0.7) / np.cos(0.7) ** 3),
    "exp": (0.7, np.exp(0.7), np.exp(0.7)),
    "expm1": (0.7, np.exp(0.7), np.exp(0.7)),
    "log": (0.7, 1 / 0.7, -1 / 0.49),
    "log1p": (0.7, 1 / 1.7, -1 / 1.7**2),
    "log2": (0.7, 1 / (0.7 * np.log(2)), -1 / (0.49 * np.log(2))),
    "log10": (0.7, 1 / (0.7 * np.log(10)), -1 / (0.49 * np.log(10))),
    "sqrt": (0.7, 0.5 * 0.7**-0.5, -0.25 * 0.7**-1.5),
    "cbrt": (0.7, 0.7 ** (-2 / 3) / 3, -2 / 9 * 0.7 ** (-5 / 3)),
    "arcsin": (0.6, 1 / 0.8, 0.6 / 0.8**3),
    "arccos": (0.6, -1 / 0.8, -0.6 / 0.8**3),
    "arctan": (0.7, 1 / 1.49, -1.4 / 1.49**2),
    "sinh": (0.7, np.cosh(0.7), np.sinh(0.7)),
    "cosh": (0.7, np.sinh(0.7), np.cosh(0.7)),
    "tanh": (0.7, 1 / np.cosh(0.7) ** 2, -2 * np.tanh(0.7) / np.cosh(0.7) ** 2),
    "arcsinh": (0.7, 1.49**-0.5, -0.7 * 1.49**-1.5),
    "arccosh": (1.7, 1.89**-0.5, -1.7 * 1.89**-1.5),
    "arctanh": (0.6, 1 / 0.64, 1.2 / 0.64**2),
    "radians": (0.7, np.pi / 180, 0.0),
    "degrees": (0.7, 180 / np.pi, 0.0),
    "square": (0.7, 1.4, 2.0),
    "absolute": (-0.7, -1.0, 0.0),
    "sign": (-0.7, 0.0, 0.0),
    "reciprocal": (0.7, -1 / 0.49, 2 / 0.343),
    "negative": (0.7, -1.0, 0.0),
}


@pytest.mark.parametrize("name", UNARY)
def test_unary_functions_and_their_derivatives(name):
    x, first, second = UNARY[name]
    ufunc = getattr(np, name)
    y = ufunc(Jet(x, np.array([2.0, 3.0]), np.array([[0.0, 1.0], [1.0, 0.0]])))
    in_array = ufunc(jets([x, 0.5 if name != "arccosh" else 1.5]))[0]
    line = ufunc(LineJet(x, 2.0, 5.0))
    if name == "sign":  # constant: numpy gives plain numbers
        assert y == in_array == line == -1
        return
    assert y.value == pytest.approx(ufunc(x), rel=1e-15)
    np.testing.assert_allclose(y.gradient, first * np.array([2.0, 3.0]), rtol=1e-14)
    expected = second * np.array([[4.0, 6.0], [6.0, 9.0]]) + first * np.array([[0.0, 1.0], [1.0, 0.0]])
    np.testing.assert_allclose(y.hessian, expected, rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(in_array.hessian, [[second, 0.0], [0.0, 0.0]], rtol=1e-13, atol=1e-15)
    assert line.hessian == pytest.approx(4 * second + 5 * first, rel=1e-13)


BINARY = {  # f and its five derivatives by hand at (x, y) = (0.8, 1.3)
    "add": (1, 1, 0, 0, 0),
    "subtract": (1, -1, 0, 0, 0),
    "multiply": (1.3, 0.8, 0, 1, 0),
    "divide": (1 / 1.3, -0.8 / 1.69, 0, -1 / 1.69, 1.6 / 1.3**3),
    "power": (
        1.3 * 0.8**0.3,
        0.8**1.3 * np.log(0.8),
        0.39 * 0.8**-0.7,
        0.8**0.3 * (1 + 1.3 * np.log(0.8)),
        0.8**1.3 * np.log(0.8) ** 2,
    ),
    "arctan2": (1.3 / 2.33, -0.8 / 2.33, -2.08 / 2.33**2, (0.64 - 1.69) / 2.33**2, 2.08 / 2.33**2),
    "hypot": (0.8 / 2.33**0.5, 1.3 / 2.33**0.5, 1.69 / 2.33**1.5, -1.04 / 2.33**1.5, 0.64 / 2.33**1.5),
    "maximum": (0, 1, 0, 0, 0),
    "minimum": (1, 0, 0, 0, 0),
}


@pytest.mark.parametrize("name", BINARY)
def test_binary_functions_and_their_derivatives(name):
    fx, fy, fxx, fxy, fyy = BINARY[name]
    ufunc = getattr(np, name)
    x, y = jets([0.8, 1.3])
    f = ufunc(x, y)
    assert f.value == pytest.approx(ufunc(0.8, 1.3), rel=1e-15)
    np.testing.assert_allclose(f.gradient, [fx, fy], rtol=1e-14)
    np.testing.assert_allclose(f.hessian, [[fxx, fxy], [fxy, fyy]], rtol=1e-13, atol=1e-15)
    with_number, number_with = ufunc(x, 1.3), ufunc(np.float64(0.8), y)
    if isinstance(with_number, Jet):
        np.testing.assert_allclose(with_number.gradient, [fx, 0], rtol=1e-14)
        np.testing.assert_allclose(with_number.hessian, [[fxx, 0], [0, 0]], rtol=1e-13, atol=1e-15)
    mixed = ufunc(np.array([0.8, 0.1]), y)  # a plain array and a jet
    if name == "minimum":
        assert number_with == mixed[0] == 0.8 and mixed[1] == 0.1
        return
    np.testing.assert_allclose(number_with.gradient, [0, fy], rtol=1e-14)
    np.testing.assert_allclose(number_with.hessian, [[0, 0], [0, fyy]], rtol=1e-13, atol=1e-15)
    np.testing.assert_allclose(mixed[0].gradient, [0, fy], rtol=1e-14)


def test_arrays_of_jets_in_linear_algebra():
    x = np.array([0.3, -0.4, 1.2])
    q, matrix = jets(x), np.arange(9.0).reshape(3, 3)
    gradients = np.array([y.gradient for y in matrix @ q])
    np.testing.assert_array_equal(gradients, matrix)
    np.testing.assert_allclose(np.dot(q, q).gradient, 2 * x)
    np.testing.assert_allclose(np.dot(q, q).hessian, 2 * np.eye(3))
    np.testing.assert_allclose((q @ matrix @ q).hessian, matrix + matrix.T)
    cross = np.cross(np.array([1.0, 2.0, 3.0]), q)
    np.testing.assert_allclose([y.gradient for y in cross], [[0, -3, 2], [3, 0, -1], [-2, 1, 0]])
    mixed = np.array([q[0] ** 2, 1.0, q[1] * q[2]])
    assert mixed.dtype == object and mixed[1] == 1.0
    np.testing.assert_allclose(np.sum(mixed).gradient, [0.6, 1.2, -0.4])
    np.testing.assert_allclose((2.0 * q / np.float64(4.0))[2].gradient, [0, 0, 0.5])
    np.testing.assert_array_equal(q > 0, x > 0)
    assert (q[2] > q[0]) and (q[0] > 0) and (q[0] != q[1]) and q[0] != 1


def test_special_points_follow_numpy():
    zero, minus = jets([0.0, -1.0])
    with np.errstate(invalid="ignore"):
        assert (1.0 / zero).value == math.inf and math.isnan(np.sqrt(minus).value)
    assert (zero**2).hessian[0, 0] == 2.0 and (zero**3).gradient[0] == 0.0 and (zero**0).value == 1.0
    assert (jets([0.0], order=1)[0] ** 1.5).gradient[0] == 0.0  # a Hertz force at the first touch
    assert (minus**3).gradient[1] == 3.0 and abs(zero).gradient[0] == 0.0
    assert (jets([7.0])[0] % 2.0).value == 1.0


@pytest.mark.parametrize("convert", [float, int, complex, math.sin, math.sqrt, lambda x: np.array([x], dtype=float)])
def test_no_silent_loss_of_derivatives(convert):
    with pytest.raises(TypeError, match=r"lose its derivatives.*numpy.sin instead of math.sin"):
        convert(jets([0.5])[0])


@quick
@given(st.lists(numbers, min_size=9, max_size=9), numbers, numbers)
def test_polynomials_against_closed_form(coefficients, x, y):
    c = np.reshape(coefficients, (3, 3))
    terms = [(c[i, j], i, j) for i in range(3) for j in range(3)]

    def p(i):
        return [1.0, i, i * i], [0.0, 1.0, 2 * i], [0.0, 0.0, 2.0]

    (px, dx, ddx), (py, dy, ddy) = p(x), p(y)
    q = jets([x, y])
    f = sum(a * q[0] ** i * q[1] ** j for a, i, j in terms) + 0.0 * q[0]
    assert f.value == pytest.approx(sum(a * px[i] * py[j] for a, i, j in terms), rel=1e-12, abs=1e-12)
    gradient = [sum(a * dx[i] * py[j] for a, i, j in terms), sum(a * px[i] * dy[j] for a, i, j in terms)]
    mixed = sum(a * dx[i] * dy[j] for a, i, j in terms)
    hessian = [
        [sum(a * ddx[i] * py[j] for a, i, j in terms), mixed],
        [mixed, sum(a * px[i] * ddy[j] for a, i, j in terms)],
    ]
    np.testing.assert_allclose(f.gradient, gradient, rtol=1e-12, atol=1e-12)
    np.testing.assert_allclose(f.hessian, hessian, rtol=1e-12, atol=1e-11)


@quick
@given(st.lists(numbers, min_size=3, max_size=3), st.lists(numbers, min_size=3, max_size=3), numbers)
def test_waves_against_closed_form(point, wave, phase):
    x, b = np.array(point), np.array(wave)
    f = np.sin(b @ jets(x) + phase) * np.exp(0.3 * jets(x)[0]) + np.cos(phase)
    if not isinstance(f, Jet):
        return
    angle, e0 = b @ x + phase, np.array([0.3, 0.0, 0.0])
    s, c, e = np.sin(angle), np.cos(angle), np.exp(0.3 * x[0])
    np.testing.assert_allclose(f.gradient, e * (c * b + s * e0), rtol=1e-12, atol=1e-13)
    hessian = e * (-s * np.outer(b, b) + c * (np.outer(b, e0) + np.outer(e0, b)) + s * np.outer(e0, e0))
    np.testing.assert_allclose(f.hessian, hessian, rtol=1e-12, atol=1e-13)


expressions = st.recursive(
    st.sampled_from([lambda q: q[0], lambda q: q[1], lambda q: q[2], lambda q: 0.7]),
    lambda inner: st.one_of(
        st.tuples(inner, inner).map(lambda p: lambda q: p[0](q) + p[1](q)),
        st.tuples(inner, inner).map(lambda p: lambda q: p[0](q) * p[1](q)),
        st.tuples(inner, inner).map(lambda p: lambda q: p[0](q) / (3.0 + np.cos(p[1](q)))),
        inner.map(lambda f: lambda q: np.sin(f(q))),
        inner.map(lambda f: lambda q: np.arctan(f(q))),
        inner.map(lambda f: lambda q: np.sqrt(1.5 + np.sin(f(q)))),
        inner.map(lambda f: lambda q: np.tanh(f(q))),
    ),
    max_leaves=12,
)


@quick
@given(expressions, st.lists(numbers, min_size=3, max_size=3))
def test_random_expressions_against_complex_step(f, point):
    x, u = np.array(point), np.array([0.3, -0.5, 0.8])
    jet = f(jets(x)) + 0.0 * jets(x)[0]
    gradient = complex_step(f, x)
    scale = 1.0 + np.max(np.abs(gradient))
    np.testing.assert_allclose(jet.gradient, gradient, rtol=1e-11, atol=1e-12 * scale)
    line = f(np.array([LineJet(x[i], u[i], 0.0) for i in range(3)])) + LineJet(0.0, 0.0, 0.0)
    curvature = u @ jet.hessian @ u
    np.testing.assert_allclose(jet.hessian, jet.hessian.T, rtol=1e-12, atol=1e-12)
    assert line.gradient == pytest.approx(gradient @ u, rel=1e-11, abs=1e-11 * scale)
    assert line.hessian == pytest.approx(curvature, rel=1e-10, abs=1e-10 * (1 + np.max(np.abs(jet.hessian))))


# ---- equations of motion ------------------------------------------------------------------------------

MASS, GRAVITY = 2.0, 9.81


def length(t):
    return 1 + 0.1 * np.sin(t)


def pull(t, q, v):
    return [-0.3 * v[0], -MASS * GRAVITY - 0.5 * q[1] * v[1] ** 2]


def circle(t, q):
    return q[0] ** 2 + q[1] ** 2 - 1


def breathing(t, q):
    return q[0] ** 2 + q[1] ** 2 - length(t) ** 2


def filled(t, q):
    phi = np.zeros(1)
    phi[0] = q[0] ** 2 + q[1] ** 2 - (1 + 0.1 * math.sin(t)) ** 2
    return phi


@nb.njit
def compiled_length(t):
    return 1 + 0.1 * math.sin(t)


@nb.njit
def compiled(t, q):
    phi = np.empty(1)
    phi[0] = q[0] ** 2 + q[1] ** 2 - compiled_length(t) ** 2
    return phi


def breathing_jacobian(t, q):
    return [[2 * q[0], 2 * q[1]]]


def breathing_gamma(t, q, v):
    rate, bend = 0.1 * np.cos(t), -0.1 * np.sin(t)
    return -2 * (v[0] ** 2 + v[1] ** 2) + 2 * (rate**2 + length(t) * bend)


def breathing_rate(t, q):
    return -2 * length(t) * 0.1 * np.cos(t)


T, Q, V, A, LAM = 0.4, np.array([0.5, -0.8]), np.array([0.7, 0.3]), np.array([1.1, -2.3]), np.array([4.2])


def expected_breathing():
    force = np.array([-0.3 * V[0], -MASS * GRAVITY - 0.5 * Q[1] * V[1] ** 2])
    r = MASS * A + 2 * Q * LAM - force
    phi = Q @ Q - length(T) ** 2
    phid = 2 * Q @ V + breathing_rate(T, Q)
    return r, phi, phid, 2 * Q @ A - breathing_gamma(T, Q, V)


VARIANTS = {
    "nothing given": (breathing, {}),
    "filled array and math": (filled, {}),
    "compiled": (compiled, {}),
    "jacobian": (breathing, {"constraint_jacobian": breathing_jacobian}),
    "gamma": (breathing, {"gamma": breathing_gamma}),
    "both": (breathing, {"constraint_jacobian": breathing_jacobian, "gamma": breathing_gamma}),
    "all": (
        lambda t, q: [breathing(t, q)],
        {
            "constraint_jacobian": lambda t, q: 2 * q,
            "gamma": breathing_gamma,
            "constraint_rate": breathing_rate,
        },
    ),
}


@pytest.mark.parametrize("name", VARIANTS)
def test_rheonomic_constraint_at_all_levels(name):
    constraint, given_functions = VARIANTS[name]
    f = EquationFunctions(MASS * np.eye(2), pull, constraint, n=2, **given_functions)
    f.check(T, Q, V)
    assert f.m == 1
    for result, expected in zip(f.residuals(T, Q, V, A, LAM), expected_breathing(), strict=True):
        np.testing.assert_allclose(result, np.atleast_1d(expected), rtol=1e-13, atol=1e-14)
    np.testing.assert_allclose(f.gamma(T, Q, V), [breathing_gamma(T, Q, V)], rtol=1e-13)
    np.testing.assert_allclose(f.velocity_offset(T, Q), [breathing_rate(T, Q)], rtol=1e-13)
    np.testing.assert_allclose(f.jacobian(T, Q), [2 * Q], rtol=1e-15)
    s, jacobian = f.tangent(T, Q, V, A, LAM, 0.2, 0.3)
    k = 2 * LAM[0] * np.eye(2) + np.array([[0, 0], [0, 0.5 * V[1] ** 2]])
    d = np.array([[0.3, 0], [0, Q[1] * V[1]]])
    np.testing.assert_allclose(s, MASS * np.eye(2) + 0.3 * d + 0.2 * k, rtol=1e-13)
    np.testing.assert_allclose(jacobian, [2 * Q], rtol=1e-15)


def test_mixed_time_derivative_in_gamma():
    """Phi = x cos(w t) + y sin(w t) - t^3: Phi_qt is not zero."""
    w = 1.7

    def line(t, q):
        return q[0] * np.cos(w * t) + q[1] * np.sin(w * t) - t**3

    f = EquationFunctions(np.eye(2), lambda t, q, v: np.zeros(2), line, n=2)
    s, c = np.sin(w * T), np.cos(w * T)
    gamma = -2 * w * (-V[0] * s + V[1] * c) + w**2 * (Q[0] * c + Q[1] * s) + 6 * T
    np.testing.assert_allclose(f.gamma(T, Q, V), [gamma], rtol=1e-13)
    np.testing.assert_allclose(f.velocity_offset(T, Q), [w * (-Q[0] * s + Q[1] * c) - 3 * T**2], rtol=1e-13)


def test_tangent_is_the_derivative_of_the_residual():
    """A double pendulum in angles with a mass matrix of its own, a rod to a wall, forces of all arguments."""

    def mass(t, q):
        m = np.zeros((2, 2))
        m[0, 0], m[1, 1] = 2.0, 1.0
        m[0, 1] = m[1, 0] = np.cos(q[0] - q[1])
        return m

    def force(t, q, v):
        s = np.sin(q[0] - q[1])
        return np.array([-s * v[1] ** 2 - 2 * np.sin(q[0]), s * v[0] ** 2 - np.sin(q[1]) * (1 + t)])

    def constraint(t, q):
        return (np.sin(q[0]) + np.sin(q[1]) - 0.3 * t,)

    f = EquationFunctions(mass, force, constraint, n=2)
    f.check(T, Q, V)

    def r(x):  # written again, for complex arguments
        q, v = x[:2], x[2:]
        c, s = np.cos(q[0] - q[1]), np.sin(q[0] - q[1])
        forces = np.array([-s * v[1] ** 2 - 2 * np.sin(q[0]), s * v[0] ** 2 - np.sin(q[1]) * (1 + T)])
        return np.array([[2.0, c], [c, 1.0]]) @ A + np.cos(q) * LAM[0] - forces

    state = np.concatenate([Q, V])
    np.testing.assert_allclose(f.residuals(T, Q, V, A, LAM)[0], r(state), rtol=1e-14)
    kd = np.array([np.imag(r(state + 1e-100j * e)) / 1e-100 for e in np.eye(4)]).T
    s, _ = f.tangent(T, Q, V, A, LAM, 0.2, 0.3)
    np.testing.assert_allclose(s, mass(T, Q) + 0.2 * kd[:, :2] + 0.3 * kd[:, 2:], rtol=1e-13)


def test_unconstrained_and_constant():
    f = EquationFunctions(np.diag([1.0, 2.0]), [0.0, -9.81], n=2)
    f.check(0.0, Q, V)
    r, *levels = f.residuals(0.0, Q, V, A, np.zeros(0))
    np.testing.assert_allclose(r, [A[0], 2 * A[1] + 9.81])
    assert f.m == 0 and all(x.shape == (0,) for x in levels)
    s, jacobian = f.tangent(0.0, Q, V, A, np.zeros(0), 0.1, 0.1)
    np.testing.assert_array_equal(s, np.diag([1.0, 2.0]))
    assert jacobian.shape == (0, 2)


def test_one_coordinate_with_plain_numbers():
    f = EquationFunctions(lambda t, q: 2.0, lambda t, q, v: -3 * q[0], n=1)
    f.check(0.0, [1.0], [0.0])
    s, _ = f.tangent(0.0, np.ones(1), np.zeros(1), np.zeros(1), np.zeros(0), 0.1, 0.0)
    np.testing.assert_allclose(s, [[2.3]])


def test_given_derivatives_spare_the_jets(monkeypatch):
    f = EquationFunctions(np.eye(2), pull, circle, breathing_jacobian, lambda t, q, v: -2 * v @ v, n=2)
    f.check(0.0, Q, V)
    monkeypatch.setattr(Jet, "__init__", lambda *arguments: pytest.fail("a jet was made"))
    _, phi, phid, _ = f.residuals(0.0, Q, V, A, LAM)
    np.testing.assert_allclose([phi[0], phid[0]], [Q @ Q - 1, 2 * Q @ V])


def test_functions_see_later_changes_of_their_parameters():
    parameters = {"stiffness": 1.0}
    stiffness = 1.0

    def force(t, q, v):
        f = np.zeros(2)
        f[0] = -stiffness * parameters["stiffness"] * q[0]
        return f

    functions = EquationFunctions(np.eye(2), force, n=2)
    zero = np.zeros(0)
    assert functions.tangent(0.0, Q, V, A, zero, 1.0, 0.0)[0][0, 0] == 2.0
    stiffness, parameters["stiffness"] = 3.0, 2.0
    assert functions.tangent(0.0, Q, V, A, zero, 1.0, 0.0)[0][0, 0] == 7.0


def test_norm_methods_and_in_place_arithmetic():
    class Spring:
        rest = 0.4

        def force(self, t, q, v):
            f = np.zeros(2)
            f -= (np.linalg.norm(q) - self.rest) * q / np.linalg.norm(q)
            return f

    s, _ = EquationFunctions(np.eye(2), Spring().force, n=2).tangent(0.0, Q, V, A, np.zeros(0), 1.0, 0.0)
    size = np.linalg.norm(Q)
    expected = np.eye(2) + (1 - 0.4 / size) * np.eye(2) + 0.4 * np.outer(Q, Q) / size**3
    np.testing.assert_allclose(s, expected, rtol=1e-13)


def test_complex_step_where_jets_fail():
    stiffness = np.array([[3.0, 1.0], [1.0, 2.0]])

    def force(t, q, v):  # LAPACK knows no jets
        return -np.linalg.solve(stiffness + np.diag(q), q) - v

    s, _ = EquationFunctions(np.eye(2), force, n=2).tangent(0.0, Q, V, A, np.zeros(0), 1.0, 0.5)
    x = np.linalg.solve(stiffness + np.diag(Q), Q)
    expected = 1.5 * np.eye(2) + np.linalg.solve(stiffness + np.diag(Q), np.eye(2) - np.diag(x))
    np.testing.assert_allclose(s, expected, rtol=1e-12)


# ---- what is refused ----------------------------------------------------------------------------------


def opaque(x):
    """A number without its derivatives, as a table look-up would give it."""
    return float(np.interp(x, [-10.0, 10.0], [-10.0, 10.0]))


def opaque_circle(t, q):
    return opaque(q[0]) ** 2 + opaque(q[1]) ** 2 - 1


def test_a_constraint_that_cannot_be_differentiated_needs_its_derivatives():
    f = EquationFunctions(np.eye(2), pull, opaque_circle, n=2)
    with pytest.raises(EquationError, match=r"constraint\(t, q\) cannot .*numpy.sin.*constraint_jacobian= and gamma="):
        f.check(0.0, Q, V)
    given_all = EquationFunctions(np.eye(2), pull, opaque_circle, breathing_jacobian, lambda t, q, v: -2 * v @ v, n=2)
    given_all.check(0.0, Q, V)
    np.testing.assert_allclose(given_all.tangent(0.0, Q, V, A, LAM, 1.0, 0.0)[0][0, 0], 1 + 2 * LAM[0])
    # Without time in it, the jacobian alone gives gamma.
    jacobian_only = EquationFunctions(np.eye(2), pull, opaque_circle, breathing_jacobian, n=2)
    np.testing.assert_allclose(jacobian_only.gamma(0.0, Q, V), [-2 * V @ V], rtol=1e-14)


def test_lost_imaginary_parts_are_noticed():
    f = EquationFunctions(np.eye(2), lambda t, q, v: -np.linalg.svd(np.diag(q))[1], n=2)
    with pytest.raises(EquationError, match=r"force\(t, q, v\) cannot be differentiated"):
        f.check(0.0, Q, V)


def still(t, q, v):
    return np.zeros(2)


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({"mass": np.eye(3)}, r"mass\(t, q\) gave an array of shape \(3, 3\); needed is shape \(2, 2\)"),
        ({"mass": [1.0, 1.0]}, r"shape \(2,\); needed is shape \(2, 2\).*numpy.diag"),
        ({"mass": [[1.0, 0.1], [0.2, 1.0]]}, r"symmetric: mass\[0, 1\] = 0.1"),
        ({"mass": np.diag([1.0, -1.0])}, r"positive \(semi\)definite.*-1"),
        ({"mass": np.diag([1.0, 0.0])}, "positive definite .*no constraints"),
        ({"mass": np.diag([0.0, 1.0]), "constraint": lambda t, q: q[1]}, "the constraints leave free"),
        ({"mass": lambda t, q: np.full((2, 2), np.nan)}, r"mass\(t, q\) is nan at entry \[0, 0\]"),
        ({"force": lambda t, q, v: [1.0, 2.0, 3.0]}, r"force\(t, q, v\) gave an array of shape \(3,\)"),
        ({"force": lambda t, q, v: [1.0, math.inf]}, r"force\(t, q, v\) is inf at entry \[1\]"),
        ({"force": lambda t, q, v: [1.0, "two"]}, r"force\(t, q, v\) gave .*no array of real numbers"),
        ({"force": lambda t, q, v: None}, r"force\(t, q, v\) gave None"),
        ({"force": lambda t, q, v: [1.0, [2.0, 3.0]]}, r"force\(t, q, v\) gave .*no array"),
        ({"force": lambda t, q, v: v * 1j}, r"force\(t, q, v\) gave .*no array of real"),
        ({"constraint": lambda t, q: [[q[0], q[1]]]}, r"constraint\(t, q\) gave an array of shape \(1, 2\)"),
        (
            {"constraint": circle, "constraint_jacobian": np.eye(2)},
            r"constraint_jacobian.*needed is shape \(1, 2\)",
        ),
        (
            {"constraint": circle, "constraint_jacobian": lambda t, q: [2 * q[0], 2.1 * q[1]]},
            r"constraint_jacobian disagrees.*\[0, 1\] = -1.68.* gives -1.6.*or leave constraint_jacobian out",
        ),
        ({"constraint": circle, "gamma": lambda t, q, v: 2 * v @ v}, r"gamma disagrees with constraint"),
        ({"constraint": breathing, "constraint_rate": lambda t, q: 0.0}, "constraint_rate disagrees"),
        ({"gamma": still}, "gamma is given without constraint"),
        ({"constraint": 3.0}, "constraint is 3.0; needed is a function"),
        (
            {"constraint": lambda t, q: np.sqrt(q[0] - 0.5)},
            r"Jacobian Phi_q of constraint\(t, q\) is (nan|inf)",
        ),
        ({"force": None}, "force is None"),
        ({"n": 0}, "n is 0"),
    ],
)
def test_refusals_say_what_and_how(arguments, message):
    with pytest.raises(EquationError, match=message):
        EquationFunctions(**({"mass": np.eye(2), "force": still, "n": 2} | arguments)).check(T, Q, V)


@pytest.mark.parametrize(
    ("q0", "v0", "message"),
    [
        ([1.0], V, r"q0 has shape \(1,\); needed is \(2,\)"),
        (Q, [0.0, math.nan], "v0 is nan at entry"),
        (["x", 1], V, "q0 is .*needed are 2 real"),
    ],
)
def test_bad_initial_states(q0, v0, message):
    with pytest.raises(EquationError, match=message):
        EquationFunctions(np.eye(2), still, n=2).check(T, q0, v0)


def test_massless_coordinate_is_accepted_where_constrained():
    EquationFunctions(np.diag([1.0, 0.0]), still, lambda t, q: q[1] - q[0] ** 2, n=2).check(T, Q, V)
    # Units far apart are no reason to refuse.
    EquationFunctions(np.diag([1e6, 1e-12]), still, n=2).check(T, Q, V)


def test_exceptions_of_the_users_function_pass_with_a_note():
    def force(t, q, v):
        raise KeyError("spring")

    with pytest.raises(KeyError, match="spring") as caught:
        EquationFunctions(np.eye(2), force, n=2).check(T, Q, V)
    assert "force(t, q, v) at t=0.4, q=[0.5, -0.8]" in caught.value.__notes__[0]


def test_functions_cannot_change_the_state():
    def force(t, q, v):
        q[0] += 99.0  # also not between two attempts to differentiate
        f = np.zeros(2)
        f[0] = -(q[0] ** 2)
        return f

    q = Q.copy()
    f = EquationFunctions(np.eye(2), force, n=2)
    f.residuals(T, q, V, A, np.zeros(0))
    s, _ = f.tangent(T, q, V, A, np.zeros(0), 1.0, 0.0)
    assert s[0, 0] == pytest.approx(1 + 2 * 99.5)
    np.testing.assert_array_equal(q, Q)


@pytest.mark.parametrize(
    "arguments, message",
    [
        (
            {"mass": lambda q: np.eye(2)},
            r"mass is the function '<lambda>', which takes 1 argument \(q\); .*mass\(t, q\)",
        ),
        (
            {"mass": np.eye(2), "force": breathing},
            r"force is the function 'breathing', which takes 2 .*force\(t, q, v\)",
        ),
        (
            {"constraint": pull},
            r"constraint is the function 'pull', which takes 3 arguments .* of 2: constraint\(t, q\)",
        ),
        ({"constraint": compiled_length}, "constraint is the function 'compiled_length', which takes 1 argument "),
        ({"constraint": circle, "gamma": circle}, r"gamma is the function 'circle', .* of 3: gamma\(t, q, v\)"),
        ({"constraint": circle, "constraint_jacobian": pull}, "constraint_jacobian is the function 'pull'"),
        (
            {"contacts": [GapContact("floor", length, NewtonImpact(restitution=0.5))]},
            "gap of contact 'floor' is the .*'length'",
        ),
        ({"potential": length}, "potential is the function 'length', which takes 1 argument"),
        ({"potential": 3.0}, r"potential is 3\.0; needed is a function of \(t, q\)"),
        ({"potential": lambda t, q: q}, "potential.* must be one number"),
    ],
)
def test_function_with_other_arguments_is_named_with_those_it_needs(arguments, message):
    given = {"mass": np.eye(2), "force": np.zeros(2), "q0": [1.0, 0.0], "v0": [0.0, 0.0], **arguments}
    with pytest.raises(EquationError, match=message):
        EquationSystem(**given)


def test_functions_with_defaults_or_any_arguments_are_called_as_they_are():
    def mass(t, q, density=2.0):
        return density * np.eye(2)

    system = EquationSystem(mass=mass, force=lambda *arguments: np.zeros(2), q0=[1.0, 0.0], v0=[0.0, 0.0])
    assert system.functions.mass(0.0, system.q0) == pytest.approx(2.0 * np.eye(2))
