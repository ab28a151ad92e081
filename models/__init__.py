"""The scenario catalogue: ready models by name, with parameters in plain words.

A new scenario is one file with its parameter table and its builder, and its name in `registry.py`.
"""

from .parameters import ScenarioError, ScenarioParameter
from .registry import Entry, catalogue, load, names
from .scenario import Scenario

__all__ = ["Entry", "Scenario", "ScenarioError", "ScenarioParameter", "catalogue", "load", "names"]
