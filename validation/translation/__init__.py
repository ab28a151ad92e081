"""Translation of a model's records to exudyn's primitives: one small file for each family of elements."""

from . import bodies, cables, contacts, flexible, forces, joints, space, space_contacts  # noqa: F401  (importing a file puts its translators in the registry)
from .registry import Build, Column, ContactColumns, find_translator, translate, translates

__all__ = ["Build", "Column", "ContactColumns", "find_translator", "translate", "translates"]
