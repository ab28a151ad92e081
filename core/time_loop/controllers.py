"""Step-size controllers of one-step formulas.

The next step is h (0.9 / e_n)^(b1/k) (0.9 / e_n-1)^(b2/k) (h_n / h_n-1)^(-a2), e the error norm, k the order of the
estimate plus one (Soederlind 2003, Digital filters in adaptive time-stepping, eq. 11).
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Controller:
    """Coefficients of a controller."""

    b1: float
    b2: float
    a2: float
    description: str


CONTROLLERS = {
    "elementary": Controller(1.0, 0.0, 0.0, "each step from its own error"),
    "pi": Controller(0.7, -0.4, 0.0, "proportional-integral, as in DOPRI5 and for stiff problems (Gustafsson 1991)"),
    "h211b": Controller(0.25, 0.25, 0.25, "digital filter H211b with b = 4 (Soederlind 2003, table 3)"),
}
