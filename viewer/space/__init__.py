"""Mechanisms in space as scenes: solids, their motion, and glTF of both."""
