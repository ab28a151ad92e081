"""The method that a run takes unless it is told another one."""

DEFAULT_METHOD = "auto"
"""Chosen from the model, its start and the tolerance (`automatic.py`)."""
FIXED_STEPS_METHOD = "ebdf"
"""What that is with fixed steps, with other outer loops than newton, and where the start cannot be measured."""
