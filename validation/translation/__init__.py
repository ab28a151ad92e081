"""Translation of a model's records to exudyn's primitives: one small file for each family of elements."""

# importing a file puts its translators in the registry
from . import (  # noqa: F401
    bodies,
    bushings3d,
    cables,
    contacts,
    flexible,
    forces,
    joints,
    loads3d,
    reduced,
    reduced2d,
    scalar_contacts,
    scalar_forces,
    scalar_joints,
    space,
    space_contacts,
    space_equations,
    space_stops,
    spherical_friction3d,
    springs3d,
)
from .registry import Build, Column, ContactColumns, find_translator, translate, translates

__all__ = ["Build", "Column", "ContactColumns", "find_translator", "translate", "translates"]
