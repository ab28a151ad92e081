"""Which output is the derivative in time of which: declared in the FMU, else by the names of our channels."""

from .instance import Instance
from .variable import Variable

RATES = {
    "x": "vx", "y": "vy", "angle": "angular_velocity", "vx": "ax", "vy": "ay",
    "angular_velocity": "angular_acceleration", "gap": "gap_rate",
}  # fmt: skip
"""By quantity of a channel "owner.quantity", that of its derivative."""


def time_derivatives(instance: Instance, variable: Variable) -> list[Variable]:
    """The first and, if there is one, the second derivative of an output among the instance's outputs."""
    found: list[Variable] = []
    while len(found) < 2:
        rate = _rate(instance, found[-1] if found else variable)
        if rate is None:
            break
        found.append(rate)
    return found


def _rate(instance: Instance, variable: Variable) -> Variable | None:
    for other in instance.variables.values():
        if other.derivative_of == variable.name and other.is_real:
            return other
    owner, _, quantity = variable.name.rpartition(".")
    # a linear system's coordinate `x` has the rates `d_x` and `dd_x`
    second = [f"d{quantity}"] if quantity.startswith("d_") else []
    for name in (RATES.get(quantity), *second, f"d_{quantity}"):
        found = instance.variables.get(f"{owner}.{name}") if name else None
        if found is not None and found.is_real and found.causality == "output":
            return found
    return None
