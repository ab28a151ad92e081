"""Colours of what is drawn in space."""

JOINT, BASE, WIRE = "#47566b", "#8a929e", "#6d4aa3"
"""Of joints, of what stands on the ground, of springs."""
CABLE, FLOOR = "#1f7a5c", "#dfe6ee"
