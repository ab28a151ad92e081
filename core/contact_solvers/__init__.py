"""The conditions between contacts, with friction: complementarity problems and the ways to solve them."""
