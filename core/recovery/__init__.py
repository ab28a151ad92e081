"""What compiled code hands to Python: redundant rows, singular positions, failed steps."""
