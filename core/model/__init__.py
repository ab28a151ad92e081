"""The vocabulary of model records that elements are built from. `Model` itself is in `core/multibody_model.py`."""
