"""Step and order control: controllers, tolerances by kind of coordinate, automatic order, per-step records."""

import math

import numpy as np
import pytest
from helpers import GROUND, Marker2D, on, point_pendulum, residuals
from test_orders import ANGLE, RATE, exact
from tlismni.core import Model, ModelError, RigidBody2D, Simulation, SpringDamper2D, simulate
from tlismni.models import load


def error_of(result):
    return np.abs(np.concatenate([result.q[-1], result.v[-1]]) - exact(1.0)).max()


class TestControllers:
    @pytest.mark.parametrize("controller", ["elementary", "pi", "h211b"])
    def test_each_keeps_to_the_tolerance(self, controller):
        for rtol in (1e-5, 1e-8):
            result = simulate(
                point_pendulum(ANGLE, RATE), 1.0, "irk", rtol, rtol * 1e-2, controller=controller, tableau="sdirk4"
            )
            assert 1e-2 * rtol < error_of(result) < 10.0 * rtol

    def test_the_proportional_integral_controller_gives_smoother_steps(self):
        """Root mean square of the logarithm of step ratios (Gustafsson 1991)."""
        rough, smooth = (
            simulate(
                point_pendulum(ANGLE, RATE), 5.0, "irk", 1e-9, 1e-11, controller=c, step_records=True, tableau="sdirk4"
            ).steps
            for c in ("elementary", "pi")
        )

        def roughness(steps):
            return np.sqrt(np.mean(np.diff(np.log(steps["h"][5:-2])) ** 2))

        assert roughness(smooth) < 0.7 * roughness(rough)


class TestBounds:
    def test_a_target_within_rounding_of_the_newest_step_is_reached(self):
        sim = Simulation(point_pendulum(ANGLE, RATE))
        sim.advance(1.0)
        for t in (math.nextafter(1.0, 2.0), math.nextafter(1.0 + 1e-15, 2.0)):
            sim.advance(t)
            assert sim.t == t
            assert sim.sample()[0] == t

    def test_first_and_largest_step_are_kept(self):
        result = simulate(point_pendulum(ANGLE, RATE), 1.0, "irk", 1e-3, 1e-5, max_step=0.01, first_step=1e-5,
                          step_records=True)  # fmt: skip
        h = result.steps["h"]
        assert h[0] == pytest.approx(1e-5, rel=1e-6)
        assert h.max() <= 0.01 * (1.0 + 1e-12)

    def test_a_first_step_that_is_too_large_is_rejected(self):
        result = simulate(point_pendulum(ANGLE, RATE), 1.0, "irk", 1e-9, 1e-11, first_step=0.5, step_records=True)
        assert result.steps["rejected"][0] >= 1
        assert result.stats["rejected"] == result.steps["rejected"].sum()
        assert error_of(result) < 1e-7


class TestTolerancesByKind:
    @staticmethod
    def system():
        """Two independent oscillators: one in translation, one in rotation."""
        slider = RigidBody2D(name="slider", mass=1.0, inertia=1.0, position=(1.1, 0.0))
        wheel = RigidBody2D(name="wheel", mass=1e6, inertia=1.0, position=(0.0, 5.0), angle=0.3)
        along = SpringDamper2D(name="along", a=GROUND, b=on("slider"), stiffness=50.0, natural_length=1.0)
        arm = SpringDamper2D(
            name="arm", a=Marker2D(point=(3.0, 5.0)), b=on("wheel", 1.0), stiffness=30.0, natural_length=2.0
        )
        return Model(gravity=(0.0, 0.0), bodies=[slider, wheel], forces=[along, arm])

    def test_a_loose_kind_saves_steps_and_a_tight_one_is_exact(self):
        system, tight = self.system(), 1e-10
        kinds = ("length", "angle", "speed", "angular_speed")
        reference = simulate(system, 2.0, "irk", 1e-12, 1e-13)
        counts, errors = {}, {}
        for loose in ("length", "angle"):
            atol = dict.fromkeys(kinds, tight)
            atol[loose] = atol["speed" if loose == "length" else "angular_speed"] = 1e-2
            result = simulate(system, 2.0, "irk", 1e-14, atol)
            counts[loose] = result.stats["steps"]
            errors[loose] = np.abs(result.q[-1] - reference.q[-1])
        everything = simulate(system, 2.0, "irk", 1e-14, tight).stats["steps"]
        assert counts["length"] <= everything and counts["angle"] <= everything
        # kinds left tight are exact to their tolerance whatever the other is allowed
        assert errors["angle"][0] < 1e-7 and errors["length"][5] < 1e-7

    def test_one_number_and_the_same_number_for_every_kind_are_the_same(self):
        kinds = dict.fromkeys(("length", "angle", "speed", "angular_speed"), 1e-8)
        one, many = (simulate(self.system(), 1.0, "ebdf", 1e-6, atol) for atol in (1e-8, kinds))
        assert np.array_equal(one.t, many.t) and np.array_equal(one.q, many.q)

    @pytest.mark.parametrize("atol", [{"volume": 1e-6}, {"length": 0.0}, {"angle": math.nan}, {"speed": "small"}])
    def test_bad_kinds_are_refused(self, atol):
        with pytest.raises(ModelError, match="atol"):
            simulate(self.system(), 1.0, atol=atol)


class TestAutomaticOrder:
    @pytest.mark.parametrize("method, option", [("ebdf", "k"), ("mebdf", "k"), ("bdf", "order")])
    def test_tolerance_is_kept_and_high_accuracy_gets_high_order(self, method, option):
        orders = []
        # `bdf` holds its steps to finer tolerances than others
        for rtol in (1e-3 if method == "bdf" else 1e-4, 1e-9):
            result = simulate(
                point_pendulum(ANGLE, RATE), 1.0, method, rtol, rtol * 1e-2, step_records=True, **{option: "auto"}
            )
            assert error_of(result) < 30.0 * rtol
            assert max(residuals(result)) < 3e-11
            orders.append(result.steps["k"].mean())
        assert orders[1] > orders[0] + 0.5

    def test_it_takes_fewer_steps_than_a_fixed_order_at_both_ends(self):
        for rtol in (1e-4, 1e-10):
            automatic, fixed = (
                simulate(point_pendulum(ANGLE, RATE), 2.0, "ebdf", rtol, rtol, k=k).stats["steps"] for k in ("auto", 4)
            )
            assert automatic < 1.1 * fixed
        assert automatic < 0.6 * fixed

    def test_a_stiff_oscillation_needs_wide_angles(self):
        """BDF 5 has 51.8 degrees: an undamped high frequency drives it. Orders within 89 degrees stay calm."""
        fast = SpringDamper2D(name="fast", a=GROUND, b=on("p"), stiffness=1e8, natural_length=1.0)
        slow = SpringDamper2D(name="slow", a=on("p"), b=on("r"), stiffness=10.0, natural_length=1.0)
        bodies = [
            RigidBody2D(name=name, mass=1.0, inertia=1.0, position=(x, 0.0)) for name, x in (("p", 1.0), ("r", 2.1))
        ]
        system = Model(gravity=(0.0, 0.0), bodies=bodies, forces=[fast, slow])
        result = simulate(system, 5.0, "bdf", 1e-8, 1e-8, order="auto", angle=89.0, step_records=True)
        assert result.steps["k"].max() <= 2
        wide = simulate(system, 5.0, "mebdf", 1e-8, 1e-8, k="auto", angle=89.0, step_records=True)
        assert wide.steps["k"].max() == 3

    def test_order_survives_impacts(self):
        """Each event restarts the history with the one-step formula; the order rises again."""
        scenario = load("pendulum_stop", restitution=0.8)
        result, reference = (
            simulate(scenario.model, 2.0, method, rtol, rtol * 1e-2, step_records=method == "ebdf", **options)
            for method, rtol, options in (("ebdf", 1e-9, {"k": "auto"}), ("irk", 1e-11, {}))
        )
        times = [[e.t for e in run.events if e.kind == "impact"] for run in (result, reference)]
        assert len(times[0]) == len(times[1]) >= 2
        assert times[0] == pytest.approx(times[1], abs=1e-8)
        assert result.q[-1] == pytest.approx(reference.q[-1], abs=1e-7)
        assert result.steps["k"].max() == 6


class TestStepRecords:
    def test_they_add_up_to_the_statistics(self):
        result = simulate(point_pendulum(ANGLE, RATE), 1.0, "ebdf", 1e-7, 1e-9, step_records=True)
        steps, stats = result.steps, result.stats
        assert len(steps["h"]) == stats["steps"]
        assert steps["h"].sum() == pytest.approx(1.0, rel=1e-12)
        assert np.all(steps["t"] == result.t[1:])
        assert steps["rejected"].sum() == stats["rejected"]
        assert steps["outer"].sum() == stats["outer_iterations"]
        assert steps["factorizations"].sum() == stats["factorizations"]
        assert np.all(steps["error"] <= 1.0) and np.all(steps["k"] == 4)

    def test_they_are_kept_with_t_eval_and_over_many_steps(self):
        result = simulate(point_pendulum(ANGLE, RATE), 20.0, "irk", step=2e-3, t_eval=[0.0, 20.0], step_records=True)
        assert len(result.t) == 2
        assert len(result.steps["h"]) == result.stats["steps"] == 10_000

    def test_they_must_be_asked_for(self):
        with pytest.raises(ModelError, match="step_records=True"):
            _ = simulate(point_pendulum(), 0.1).steps
