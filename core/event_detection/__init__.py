"""Where within a step something begins or ends: watches, bounds of motion, search, dense output."""
