"""Bodies thrown into a trough at random: the run ends, and nothing is taken from or given to the energy in silence."""

import numpy as np
import pytest
from thrown_scenes import thrown_scene
from tlismni.core import simulate

QUICK = [0, 2, 4, 6, 8, 1, 5, 7, 9, 11]
"""Of all kinds of shapes, laws and methods."""


def wrong(seed, t_end):
    """What is wrong with a run of this scene; empty if nothing."""
    scene, found = thrown_scene(seed), []
    result = simulate(scene.model, t_end, scene.method)
    energy = result["energy.kinetic"] + result["energy.potential"]
    if np.max(np.abs(result["energy.balance"])) > 1e-4 * energy[0]:
        found.append("energy out of account")
    if not scene.may_gain and np.max(np.diff(energy)) > 1e-5 * energy[0]:
        found.append("energy grows")
    ends = {
        ending: [result[name] for name in result.channels if name.endswith(ending)]
        for ending in (".gap", ".normal_force")
    }
    # where shapes are far from each other their gap is not looked at
    if min((np.nanmin(gap) for gap in ends[".gap"]), default=0.0) < -1e-9:
        found.append("overlap")
    if min((np.nanmin(force) for force in ends[".normal_force"]), default=0.0) < 0.0:
        found.append("pull")
    return found


@pytest.mark.parametrize("seed", QUICK)
def test_what_is_thrown_comes_down(seed):
    assert wrong(seed, 1.0) == []


def test_a_contact_without_a_force_has_no_friction_to_share():
    """The quotient of friction and normal force, both of them rounding, was the ratio of a contact that others hold. It
    was infinite, and the run ended with a singular matrix."""
    assert wrong(10, 0.9) == []


@pytest.mark.parametrize("seed", [84, 109])
def test_impulse_steps_do_not_begin_with_the_mean_forces_of_contacts(seed):
    """`hht` begins a step with the accelerations of the newest row: impulse steps were tried for ever."""
    assert thrown_scene(seed).method == "hht"
    assert wrong(seed, 2.0) == []


def test_restitution_of_contacts_at_rest():
    """What is left of the motion was compared with the motion before the restitution, which was rounding."""
    assert wrong(124, 2.0) == []


@pytest.mark.full
@pytest.mark.parametrize("seed", range(200))
def test_two_hundred_scenes(seed):
    assert wrong(seed, 2.0) == []
