"""The scenario catalogue: ready models by name, with parameters in plain words.

A new scenario is one file with its parameter table and its builder, and its import here.
"""

from . import (  # noqa: F401  (importing a scenario's file puts it in the catalogue)
    arm_stop,
    bouncing_ball,
    bricard,
    cable_ground,
    cable_pendulum,
    cantilever,
    chain,
    double_pendulum_wall,
    dropped_box,
    flexible_slider_crank_stop,
    four_bar,
    free_body,
    heavy_top,
    hub_beam_stop,
    impact_oscillator,
    mass_on_rod,
    newtons_cradle,
    pendulum,
    pendulum_stop,
    rocking_block,
    rod_rod,
    rod_wall,
    rolling_disk,
    slider_crank,
    slider_crank_stop,
    spatial_cradle,
    spatial_slider_crank,
    spatial_slider_crank_stop,
    sphere_beam,
    spinning_sphere,
    split_contact,
    stick_slip,
    tippe_top,
    universal_pendulum,
    woodpecker,
)
from .parameters import ScenarioError, ScenarioParameter
from .registry import Entry, catalogue, load, names
from .scenario import Scenario

__all__ = ["Entry", "Scenario", "ScenarioError", "ScenarioParameter", "catalogue", "load", "names"]
