"""Third opinions on the slider-cranks in space: Lagrange's equation in the crank's angle, by scipy."""

from collections.abc import Callable

import numpy as np

from ...models import Scenario
from ..third_opinion import Opinion, opinion
from .common import law_of, opinion_on
from .mechanism import Array, Course, Mechanism, run
from .rotation import components

STEP = 1e-30
"""Of derivatives in the complex plane (Squire and Trapp, 1998), which have no rounding to speak of."""
POINTS = 1024
"""Of a Fourier series."""
X = np.array([1.0, 0.0, 0.0])


def slope(f: Callable[[complex], Array], a: float) -> Array:
    """df/da at a real angle."""
    found: Array = np.imag(f(a + 1j * STEP)) / STEP
    return found


class Crank:
    """Crank about x at (0, y, z), rod with a ball at the crank and a universal joint at the slider on the x axis."""

    def __init__(self, scenario: Scenario) -> None:
        self.p = {name: float(value) for name, value in scenario.parameters.items() if isinstance(value, int | float)}

    def end(self, a: complex) -> Array:
        """The crank's end; a is counted from z, about x."""
        r = self.p["crank_length"]
        return np.array([0.0 * a, self.p["crank_y"] - r * np.sin(a), self.p["crank_z"] + r * np.cos(a)])

    def slider(self, a: complex) -> Array:
        """Place of the slider (1,)."""
        end = self.end(a)
        return np.array([np.sqrt(self.p["rod_length"] ** 2 - end[1] ** 2 - end[2] ** 2)])

    def axes(self, a: complex) -> Array:
        """Axes of the rod (3, 3) as rows: along it, the fork's, which stays across x, and the third."""
        along = (self.end(a) - self.slider(a)[0] * X) / self.p["rod_length"]
        across = np.cross(along, X)
        across = across / np.sqrt(across @ across)
        return np.array([along, across, np.cross(along, across)])

    def middle(self, a: complex) -> Array:
        """The rod's centre of mass."""
        return 0.5 * (self.end(a) + self.slider(a)[0] * X)

    def inertia(self, a: float) -> float:
        """M(a), kg m^2: twice the kinetic energy at unit rate."""
        p = self.p
        axes, turned = np.real(self.axes(a)), slope(self.axes, a)
        spin = 0.5 * np.sum(np.cross(axes, turned), axis=0)
        own = axes @ spin
        go = slope(self.middle, a)
        rod = p["rod_mass"] * go @ go + p["rod_axial_inertia"] * own[0] ** 2 + p["rod_inertia"] * (own[1:] @ own[1:])
        crank = p["crank_inertia"] + p["crank_mass"] * (0.5 * p["crank_length"]) ** 2
        return float(crank + rod + p["slider_mass"] * slope(self.slider, a)[0] ** 2)

    def height(self, a: complex) -> Array:
        """Potential energy over g (1,), kg m."""
        p = self.p
        return np.array([p["crank_mass"] * 0.5 * p["crank_length"] * np.cos(a) + p["rod_mass"] * self.middle(a)[2]])


class NeedsMorePointsError(ArithmeticError):
    """A Fourier series that does not end."""


class Turning:
    """A function of an angle with period 2 pi as its Fourier series (trapezoidal rule, which converges faster than any
    power).

    Raises NeedsMorePointsError where POINTS do not suffice.
    """

    def __init__(self, f: Callable[[float], float]) -> None:
        values = np.array([f(a) for a in 2.0 * np.pi / POINTS * np.arange(POINTS)])
        parts = np.fft.rfft(values) / POINTS
        parts[1:] *= 2.0
        kept = np.flatnonzero(np.abs(parts) > 1e-15 * np.abs(parts).max())
        if kept[-1] > POINTS // 3:
            raise NeedsMorePointsError(f"a function of the crank's angle needs more than {POINTS} points")
        self.parts = parts[: kept[-1] + 1]
        self.order = 1j * np.arange(len(self.parts))

    def __call__(self, a: float) -> float:
        return float(np.real(self.parts @ np.exp(self.order * a)))

    def slope(self, a: float) -> float:
        """The derivative."""
        return float(np.real((self.order * self.parts) @ np.exp(self.order * a)))


def course_of(scenario: Scenario, **contact: object) -> tuple[Crank, Course]:
    """The motion in the crank's angle: M a'' + M' a'^2/2 = -V'."""
    crank = Crank(scenario)
    gravity = crank.p["gravity"]
    inertia, height = Turning(crank.inertia), Turning(lambda a: float(np.real(crank.height(a)[0])))

    def force(t: float, q: Array, v: Array) -> Array:
        a = float(q[0])
        return np.array([-0.5 * inertia.slope(a) * v[0] ** 2 - gravity * height.slope(a)])

    one = Mechanism(mass=lambda q: np.array([[inertia(float(q[0]))]]), force=force, **contact)  # type: ignore[arg-type]
    return crank, run(one, (0.0,), (crank.p["speed"],), scenario.t_end)


def channels_of(crank: Crank, course: Course) -> dict[str, Callable[[float], float]]:
    """What is compared, by channel."""
    angle, rate = course.q(0), course.v(0)
    found: dict[str, Callable[[float], float]] = {
        "crank.angle": angle,
        "crank.angular_velocity": rate,
        "slider.x": lambda t: float(np.real(crank.slider(angle(t))[0])),
        "slider.vx": lambda t: float(slope(crank.slider, angle(t))[0]) * rate(t),
    }
    return found | components(["rod.x", "rod.y", "rod.z"], lambda t: np.real(crank.middle(angle(t))))


@opinion("spatial_slider_crank")
def spatial_slider_crank(scenario: Scenario) -> Opinion | None:
    """The crank's angle by scipy. None where the rod hardly reaches: its series would not end."""
    try:
        return Opinion("scipy, the crank's angle", channels=channels_of(*course_of(scenario)))
    except NeedsMorePointsError:
        return None


@opinion("spatial_slider_crank_stop")
def spatial_slider_crank_stop(scenario: Scenario) -> Opinion | None:
    """The same with the stop's impacts or force."""
    (contact,) = scenario.model.contacts
    probe, stop = Crank(scenario), float(scenario.parameters["stop"])
    try:
        crank, course = course_of(
            scenario,
            gaps=lambda q: np.array([stop - float(np.real(probe.slider(float(q[0]))[0]))]),
            gradients=lambda q: -slope(probe.slider, float(q[0]))[None, :],
            laws=(law_of(contact.law),),
        )
    except NeedsMorePointsError:
        return None
    return opinion_on(course, (contact.name,), channels_of(crank, course), "scipy, the crank's angle")
