"""The integration formulas. A new one is a file with its coefficients and its step, and a line in `registry.py`."""
