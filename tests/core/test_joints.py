"""Every joint against independent solutions in minimal coordinates."""

import math

import numpy as np
import pytest
from helpers import GROUND, G, integrate, on, pendulum_angles, residuals, rod_pendulum
from tlismni.core import (
    AppliedTorque2D,
    Constant,
    Distance2D,
    Model,
    PointMass2D,
    Prismatic2D,
    Revolute2D,
    RigidBody2D,
    simulate,
)

TIGHT = {"rtol": 1e-10, "atol": 1e-12}


def double_pendulum_rhs(m1, a1, l1, j1, m2, a2, j2):
    """Two links with centres at a1, a2 from their joints; angles from the horizontal."""

    def rhs(t, y):
        th1, th2, w1, w2 = y
        c, s = math.cos(th1 - th2), math.sin(th1 - th2)
        mass = [[j1 + m1 * a1**2 + m2 * l1**2, m2 * l1 * a2 * c], [m2 * l1 * a2 * c, j2 + m2 * a2**2]]
        load = [
            -m2 * l1 * a2 * s * w2**2 - (m1 * a1 + m2 * l1) * G * math.cos(th1),
            m2 * l1 * a2 * s * w1**2 - m2 * a2 * G * math.cos(th2),
        ]
        return [w1, w2, *np.linalg.solve(mass, load)]

    return rhs


def test_revolute_physical_pendulum_with_an_offset_pin():
    """Pin at (-0.3, 0.1) of the body: J_O theta'' = -m g d cos(theta + phi), d, phi to the centre of mass."""
    mass, inertia, start, rate = 2.0, 0.15, 0.4, 1.0
    pin = np.array([-0.3, 0.1])
    c, s = math.cos(start), math.sin(start)
    arm = -np.array([c * pin[0] - s * pin[1], s * pin[0] + c * pin[1]])
    body = RigidBody2D(
        name="b", mass=mass, inertia=inertia, position=tuple(arm), angle=start,
        velocity=(-rate * arm[1], rate * arm[0]), angular_velocity=rate,
    )  # fmt: skip
    model = Model(bodies=[body], joints=[Revolute2D(name="pin", a=GROUND, b=on("b", *pin))])
    d, phi = np.hypot(*pin), math.atan2(-pin[1], -pin[0])
    times = np.linspace(0.0, 3.0, 31)
    result = simulate(model, 3.0, t_eval=times, **TIGHT)
    expected = pendulum_angles(times, start + phi, rate, mass * G * d / (inertia + mass * d**2))
    assert np.abs(result["b.angle"] + phi - expected[:, 0]).max() < 1e-8
    assert np.abs(result["b.angular_velocity"] - expected[:, 1]).max() < 1e-7
    assert np.abs(result["pin.force_x"] - mass * result["b.ax"]).max() < 1e-7
    assert np.abs(result["pin.force_y"] - mass * (result["b.ay"] + G)).max() < 1e-7
    assert max(residuals(result)) < 1e-10


def test_revolute_between_bodies_double_pendulum():
    m1, l1, m2, l2 = 1.5, 1.0, 0.7, 0.8
    th1, th2 = 0.2, -0.9
    p1 = 0.5 * l1 * np.array([math.cos(th1), math.sin(th1)])
    p2 = 2.0 * p1 + 0.5 * l2 * np.array([math.cos(th2), math.sin(th2)])
    j1, j2 = m1 * l1**2 / 12.0, m2 * l2**2 / 12.0
    model = Model(
        bodies=[
            RigidBody2D(name="a", mass=m1, inertia=j1, position=tuple(p1), angle=th1),
            RigidBody2D(name="b", mass=m2, inertia=j2, position=tuple(p2), angle=th2),
        ],
        joints=[
            Revolute2D(name="p", a=GROUND, b=on("a", -0.5 * l1)),
            Revolute2D(name="q", a=on("a", 0.5 * l1), b=on("b", -0.5 * l2)),
        ],
    )
    times = np.linspace(0.0, 1.5, 16)
    result = simulate(model, 1.5, t_eval=times, **TIGHT)
    rhs = double_pendulum_rhs(m1, 0.5 * l1, l1, j1, m2, 0.5 * l2, j2)
    expected = integrate(rhs, [th1, th2, 0.0, 0.0], times, 0.02)
    found = np.stack([result[name] for name in ("a.angle", "b.angle", "a.angular_velocity", "b.angular_velocity")], 1)
    assert np.abs(found - expected).max() < 1e-7
    # the force on the lower link is what its motion needs
    assert np.abs(result["q.force_x"] - m2 * result["b.ax"]).max() < 1e-7
    assert np.abs(result["q.force_y"] - m2 * (result["b.ay"] + G)).max() < 1e-7


def test_distance_rod_on_a_string():
    """A massless string and a rod hung on its end: a double pendulum whose first link has no mass."""
    m, length, string = 0.9, 0.6, 0.8
    th1, th2 = -1.0, -0.3
    end = string * np.array([math.cos(th1), math.sin(th1)])
    centre = end + 0.5 * length * np.array([math.cos(th2), math.sin(th2)])
    j = m * length**2 / 12.0
    model = Model(
        bodies=[RigidBody2D(name="rod", mass=m, inertia=j, position=tuple(centre), angle=th2)],
        joints=[Distance2D(name="string", a=GROUND, b=on("rod", -0.5 * length), length=string)],
    )
    times = np.linspace(0.0, 2.0, 21)
    result = simulate(model, 2.0, t_eval=times, **TIGHT)
    rhs = double_pendulum_rhs(0.0, 0.0, string, 0.0, m, 0.5 * length, j)
    expected = integrate(rhs, [th1, th2, 0.0, 0.0], times, 0.02)
    assert np.abs(result["rod.angle"] - expected[:, 1]).max() < 1e-7
    assert np.abs(result["rod.angular_velocity"] - expected[:, 3]).max() < 1e-6
    tension = np.hypot(m * result["rod.ax"], m * (result["rod.ay"] + G))
    assert result["string.tension"] == pytest.approx(tension, abs=1e-7)  # it pulls throughout


def test_distance_between_two_free_points():
    """Free in space they turn at a constant rate about the centre of mass; tension m_red w^2 L."""
    m1, m2, length, w = 1.0, 3.0, 1.6, 2.5
    r1, r2 = length * m2 / (m1 + m2), length * m1 / (m1 + m2)
    drift = (0.4, -0.2)
    model = Model(
        gravity=(0.0, 0.0),
        bodies=[
            PointMass2D(name="p", mass=m1, position=(r1, 0.0), velocity=(drift[0], drift[1] + w * r1)),
            PointMass2D(name="o", mass=m2, position=(-r2, 0.0), velocity=(drift[0], drift[1] - w * r2)),
        ],
        joints=[Distance2D(name="rod", a=on("p"), b=on("o"), length=length)],
    )
    result = simulate(model, 3.0, **TIGHT)
    t = result.t
    assert np.abs(result["p.x"] - drift[0] * t - r1 * np.cos(w * t)).max() < 1e-8
    assert np.abs(result["p.y"] - drift[1] * t - r1 * np.sin(w * t)).max() < 1e-8
    assert result["rod.tension"] == pytest.approx(m1 * m2 / (m1 + m2) * w**2 * length, rel=1e-8)


@pytest.mark.parametrize("slope", [0.0, 0.5, -1.2, math.pi / 2])
def test_prismatic_sliding_down_a_slope(slope):
    """s = s0 + u t - g sin(slope) t^2 / 2; the guide carries m g cos(slope) through the centre of mass."""
    axis = np.array([math.cos(slope), math.sin(slope)])
    body = RigidBody2D(
        name="b", mass=1.3, inertia=0.2, position=tuple(0.5 * axis), velocity=tuple(2.0 * axis), angle=0.7
    )
    model = Model(bodies=[body], joints=[Prismatic2D(name="rail", a=on("ground", angle=slope), b=on("b"))])
    result = simulate(model, 1.0, **TIGHT)
    s = 0.5 + 2.0 * result.t - 0.5 * G * math.sin(slope) * result.t**2
    assert np.abs(result["b.x"] - axis[0] * s).max() < 1e-9
    assert np.abs(result["b.y"] - axis[1] * s).max() < 1e-9
    assert np.abs(result["b.angle"] - 0.7).max() < 1e-11
    assert result["rail.normal_force"] == pytest.approx(-1.3 * G * math.cos(slope), abs=1e-9)
    assert np.abs(result["rail.torque"]).max() < 1e-9


def test_prismatic_sleeve_on_a_turning_rod():
    """No gravity: (J + m r^2) w is kept, r'' = r w^2."""
    j, m, r0, w0, u0 = 0.5, 1.2, 0.4, 3.0, -0.5
    model = Model(
        gravity=(0.0, 0.0),
        bodies=[
            RigidBody2D(name="rod", mass=2.0, inertia=0.3, angular_velocity=w0),
            RigidBody2D(
                name="sleeve", mass=m, inertia=j - 0.3, position=(r0, 0.0), velocity=(u0, w0 * r0), angle=0.25,
                angular_velocity=w0,
            ),
        ],
        joints=[
            Revolute2D(name="pin", a=GROUND, b=on("rod")),
            Prismatic2D(name="guide", a=on("rod", 0.1, 0.0), b=on("sleeve")),
        ],
    )  # fmt: skip
    times = np.linspace(0.0, 2.0, 21)
    result = simulate(model, 2.0, t_eval=times, **TIGHT)
    momentum = (j + m * r0**2) * w0

    def rhs(t, y):
        r, u, _ = y
        w = momentum / (j + m * r**2)
        return [u, r * w**2, w]

    r, u, angle = integrate(rhs, [r0, u0, 0.0], times, 0.02).T
    assert np.abs(result["rod.angle"] - angle).max() < 1e-8
    assert np.abs(result["sleeve.angle"] - angle - 0.25).max() < 1e-8
    assert np.abs(result["sleeve.x"] - r * np.cos(angle)).max() < 1e-8
    assert (
        np.abs(result["sleeve.vx"] - u * np.cos(angle) + r * result["rod.angular_velocity"] * np.sin(angle)).max()
        < 1e-7
    )
    # the rod pushes the sleeve with m (r w' + 2 u w)
    w = result["rod.angular_velocity"]
    force = m * (r * result["rod.angular_acceleration"] + 2.0 * u * w)
    assert np.abs(result["guide.normal_force"] + force).max() < 1e-7
    assert max(residuals(result)) < 1e-10


def test_prismatic_keeps_a_given_relative_angle():
    body = RigidBody2D(name="b", mass=1.0, inertia=0.1, position=(0.3, 0.0), angle=0.4)
    joint = Prismatic2D(name="rail", a=GROUND, b=on("b", 0.1, 0.05), relative_angle=0.4)
    with pytest.raises(Exception, match="rail"):
        simulate(Model(bodies=[body], joints=[joint]), 0.1)  # the marker b is 0.09 above the rail
    shift = 0.1 * math.sin(0.4) + 0.05 * math.cos(0.4)
    body = body.model_copy(update={"position": (0.3, -shift)})
    result = simulate(Model(bodies=[body], joints=[joint]), 0.1)
    assert np.abs(result["b.y"] + shift).max() < 1e-12


class SliderCrank:
    """Crank (length r) about the origin, connecting rod (length l), slider on the x axis."""

    r, l = 0.3, 0.8
    m1, m2, m3 = 1.0, 0.8, 1.5
    j1, j2 = 0.02, 0.05

    def positions(self, th):
        """Centres of crank, rod and slider, and angle of the rod."""
        phi = -np.arcsin(self.r / self.l * np.sin(th))
        a = self.r * np.array([np.cos(th), np.sin(th)])
        b = self.l * np.array([np.cos(phi), np.sin(phi)])
        return 0.5 * a, a + 0.5 * b, a + b, phi

    def rates(self, th):
        """Derivatives with respect to the crank angle."""
        phi = self.positions(th)[3]
        dphi = -self.r * np.cos(th) / (self.l * np.cos(phi))
        da = self.r * np.array([-np.sin(th), np.cos(th)])
        db = self.l * dphi * np.array([-np.sin(phi), np.cos(phi)])
        return 0.5 * da, da + 0.5 * db, da + db, dphi

    def inertia(self, th):
        v1, v2, v3, dphi = self.rates(th)
        return self.m1 * (v1 @ v1) + self.j1 + self.m2 * (v2 @ v2) + self.j2 * dphi**2 + self.m3 * (v3 @ v3)

    def rhs(self, torque):
        def f(t, y):
            th, w = y
            step = 1e-100
            slope = np.imag(self.inertia(th + 1j * step)) / step
            v1, v2, v3, _ = self.rates(th)
            weight = -G * (self.m1 * v1[1] + self.m2 * v2[1] + self.m3 * v3[1])
            return [w, (torque + weight - 0.5 * slope * w**2) / self.inertia(th)]

        return f

    def model(self, th, w, torque):
        c1, c2, c3, phi = self.positions(th)
        v1, v2, v3, dphi = (w * np.asarray(x) for x in self.rates(th))
        moving = [(self.m1, self.j1, c1, v1), (self.m2, self.j2, c2, v2), (self.m3, 1.0, c3, v3)]
        turning = [(th, w), (phi, float(dphi)), (0.0, 0.0)]
        bodies = [
            RigidBody2D(
                name=name, mass=mass, inertia=inertia, position=tuple(c), velocity=tuple(v), angle=angle,
                angular_velocity=rate,
            )
            for name, (mass, inertia, c, v), (angle, rate) in zip(
                ("crank", "rod", "slider"), moving, turning, strict=True
            )
        ]  # fmt: skip
        return Model(
            bodies=bodies,
            joints=[
                Revolute2D(name="main", a=GROUND, b=on("crank", -0.5 * self.r)),
                Revolute2D(name="big_end", a=on("crank", 0.5 * self.r), b=on("rod", -0.5 * self.l)),
                Revolute2D(name="small_end", a=on("rod", 0.5 * self.l), b=on("slider")),
                Prismatic2D(name="guide", a=GROUND, b=on("slider")),
            ],
            forces=[AppliedTorque2D(name="drive", body="crank", torque=Constant(value=torque))],
        )


@pytest.mark.sampled(1)
@pytest.mark.parametrize("method, bound", [("ebdf", 1e-7), ("irk", 1e-7), ("bdf", 1e-4)])
def test_slider_crank_closed_loop_through_several_turns(method, bound):
    crank, torque, start, rate = SliderCrank(), 1.5, 0.5, 6.0
    times = np.linspace(0.0, 2.0, 21)
    rtol = 1e-8 if method == "bdf" else 1e-10
    result = simulate(crank.model(start, rate, torque), 2.0, method, rtol=rtol, atol=1e-2 * rtol, t_eval=times)
    expected = integrate(crank.rhs(torque), [start, rate], times, 0.01)
    assert expected[-1, 0] > 4.0 * math.pi
    assert np.abs(result["crank.angle"] - expected[:, 0]).max() < bound
    assert np.abs(result["crank.angular_velocity"] - expected[:, 1]).max() < 20.0 * bound
    slider = [crank.positions(th)[2][0] for th in expected[:, 0]]
    assert np.abs(result["slider.x"] - slider).max() < bound
    # up to 16 rad/s: accelerations are large, and the levels hold relative to their entries
    for residual, entries in zip(residuals(result), (result.q, result.v, result.a), strict=True):
        assert residual < 2e-12 * np.abs(entries).max()


def test_four_bar_of_distances_moves_as_a_parallelogram():
    """Two equal cranks and a coupler as massless rods between points: the coupler does not turn; each point moves
    as a pendulum."""
    th = -0.6
    c, s = math.cos(th), math.sin(th)
    model = Model(
        bodies=[
            PointMass2D(name="p", mass=1.0, position=(c, s)),
            PointMass2D(name="o", mass=1.0, position=(c + 2.0, s)),
        ],
        joints=[
            Distance2D(name="left", a=GROUND, b=on("p"), length=1.0),
            Distance2D(name="right", a=on("ground", 2.0), b=on("o"), length=1.0),
            Distance2D(name="coupler", a=on("p"), b=on("o"), length=2.0),
        ],
    )
    times = np.linspace(0.0, 1.2, 13)
    result = simulate(model, 1.2, t_eval=times, **TIGHT)
    angle = pendulum_angles(times, th)[:, 0]
    assert np.abs(result["p.x"] - np.cos(angle)).max() < 1e-8
    assert np.abs(result["o.x"] - 2.0 - np.cos(angle)).max() < 1e-8
    assert np.abs(result["coupler.tension"]).max() < 1e-7


def test_rod_pendulum_swings_as_the_reference_of_these_tests():
    times = np.linspace(0.0, 2.0, 21)
    result = simulate(rod_pendulum(0.3, -1.0, length=1.4, mass=2.5), 2.0, t_eval=times, **TIGHT)
    assert np.abs(result["rod.angle"] - pendulum_angles(times, 0.3, -1.0, 1.5 * G / 1.4)[:, 0]).max() < 1e-8
