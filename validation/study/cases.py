"""What the study runs: one list of cases with their theory orders, one of contenders. A new method is a line here.

A case of a method or option that the core does not have is left out; a method that the core has but that has no line
here is run with its defaults, and its theory order stays open.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from ...core import METHODS, ModelError


@dataclass(frozen=True)
class Setting:
    """A method with options."""

    method: str
    options: Mapping[str, Any] = field(default_factory=dict, hash=False)

    @property
    def label(self) -> str:
        """As it stands in tables and legends."""
        options = " ".join(f"{name}={_short(value)}" for name, value in self.options.items())
        return f"{self.method} {options}".strip()

    @property
    def available(self) -> bool:
        """True if the core has the method and these options."""
        return self.method in METHODS and set(self.options) <= set(METHODS[self.method].options)


@dataclass(frozen=True)
class OrderCase:
    """A setting and its order in theory: of positions and velocities, and of multipliers."""

    setting: Setting
    order: int | None
    """None: not stated here."""
    multiplier_order: int | None = None
    """Where it differs; TLISMNI's multipliers follow from (q, v), and so have the same order."""

    @property
    def theory(self) -> tuple[int | None, int | None, int | None]:
        """Of positions, velocities, multipliers."""
        return self.order, self.order, self.multiplier_order or self.order


def _short(value: Any) -> str:
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def _case(method: str, theory: int, /, **options: Any) -> OrderCase:
    return OrderCase(Setting(method, options), theory)


SCHEMES = {"rk23": 3, "rk45": 5, "dop853": 8, "sdirk4": 4, "trapezoidal": 2}
IMPLICIT = ("sdirk4", "trapezoidal")

ORDER_CASES = (
    _case("newmark", 2),
    _case("newmark", 1, gamma=0.6, beta=0.3025),
    *(_case("hht", 2, alpha=alpha) for alpha in (0.0, -0.05, -0.1, -0.3)),
    _case("trapezoidal", 2),
    _case("park", 2),
    *(_case("bdf", k, order=k) for k in range(1, 7)),
    *(_case("ebdf", k + 1, k=k) for k in range(1, 9)),
    *(_case("mebdf", k + 1, k=k) for k in range(1, 9)),
    *(_case("adams", order, order=order) for order in range(2, 9)),
    # stages of the state-space equation: no order is lost to the constraints (Hairer and Wanner II, IV.5 and VII)
    _case("irk", 4, tableau="sdirk4"),
    _case("irk", 4, tableau="gauss2"),
    _case("irk", 5, tableau="radau3"),
    _case("irk", 6, tableau="gauss3"),
    # without contacts: the implicit midpoint rule
    _case("moreau", 2),
    # comparison methods: Negrut, Rampalli, Ottarsson and Sajdak 2007; Arnold and Bruels 2007
    _case("hht_i3", 2),
    _case("hht_ggl", 2),
    _case("generalized_alpha", 2),
    _case("generalized_alpha", 2, form="index3"),
    _case("generalized_alpha", 2, rho=0.5),
    # all coordinates by an ODE formula: the violation, and with it every error, is of the order of the formula
    *(_case("baumgarte", order, scheme=scheme) for scheme, order in SCHEMES.items() if scheme != "rk45"),
    # alpha = 5 1/s takes the violation away faster than h^5 builds it up in these steps: an order above 5 would show
    _case("baumgarte", SCHEMES["rk45"], scheme="rk45", alpha=1.0, beta=1.0),
    *(_case("projection", order, scheme=scheme) for scheme, order in SCHEMES.items() if scheme not in IMPLICIT),
)

IRK_WITHOUT_TABLEAUS = _case("irk", 4)
"""The irk of a core in which it has no option `tableau`: SDIRK of order 4."""

CONTENDERS = (
    Setting("hht"),
    Setting("newmark"),
    Setting("trapezoidal"),
    Setting("park"),
    Setting("bdf", {"order": 3}),
    Setting("bdf", {"order": "auto"}),
    Setting("ebdf", {"k": 4}),
    Setting("ebdf", {"k": "auto"}),
    Setting("mebdf", {"k": 4}),
    Setting("adams", {"order": 4}),
    *(Setting("irk", {"tableau": name}) for name in ("sdirk4", "gauss2", "radau3", "gauss3")),
)
"""What `study iterations` compares."""
TIME_STEPPING = "time stepping"
"""Family of the methods whose steps follow from no tolerance where there are contacts."""


def order_cases(methods: Iterable[str] | None = None) -> tuple[OrderCase, ...]:
    """The cases that the core can run, of the given methods or all; every method has at least one.

    Raises ModelError for a method that the core does not have.
    """
    cases = [case for case in (*ORDER_CASES, IRK_WITHOUT_TABLEAUS) if case.setting.available]
    if "tableau" in METHODS["irk"].options:
        cases.remove(IRK_WITHOUT_TABLEAUS)
    with_line = {case.setting.method for case in cases}
    cases += [OrderCase(Setting(name), None) for name in METHODS if name not in with_line]
    chosen = _known(methods)
    return tuple(case for case in cases if case.setting.method in chosen)


def contenders(methods: Iterable[str] | None = None) -> tuple[Setting, ...]:
    """The contenders that the core can run, of the given methods or all; every method with error control has at least
    one.

    Raises ModelError for a method that the core does not have.
    """
    found = [setting for setting in CONTENDERS if setting.available]
    with_line = {setting.method for setting in found}
    found += [
        Setting(name) for name, method in METHODS.items() if name not in with_line and method.family != TIME_STEPPING
    ]
    chosen = _known(methods)
    return tuple(setting for setting in found if setting.method in chosen)


def _known(methods: Iterable[str] | None) -> set[str]:
    chosen = set(METHODS if methods is None else methods)
    unknown = sorted(chosen - set(METHODS))
    if unknown:
        raise ModelError(f"unknown method {unknown}; there are {sorted(METHODS)}")
    return chosen
