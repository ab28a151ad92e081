"""The three ways to compare a run with exudyn: contact by force, contact as a constraint, no contact."""
