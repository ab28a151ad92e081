"""The two problems of the coupling study: a mechanism cut in two where its bodies touch, and its monolithic whole.

`blow`: the hammer of `split_whole` strikes the anvil once and leaves. `press`: it lies on the anvil, pressed by
gravity, over a linear contact that never opens: a linear system, on which a coupling is stable or not.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from ...core import Model
from ...fmu_wrapper.master import Connection, MasterSettings, SystemResult, of_source, run
from ...models import load

SOLVER = {"rtol": 1e-10, "atol": 1e-13}
"""Of both halves: what is left is the coupling's error."""
BLOW_END = 0.03
"""s; the hammer is off the anvil again."""
LONG_END = 0.15
"""s, of a run that is mostly free flight after the blow."""
APPROACH_SPEED = 1.0
"""m/s, of the blow."""
GRAVITY, STIFFNESS, DAMPING, HAMMER, ANVIL, ANVIL_FREQUENCY = 20.0, 1e5, 20.0, 1.0, 2.0, 100.0
"""Of `press`: m/s^2, N/m, N s/m, kg, kg, rad/s."""
CONTACT_FREQUENCY = (STIFFNESS * (1.0 / HAMMER + 1.0 / ANVIL)) ** 0.5
"""rad/s: hammer against anvil over the contact."""
DISTURBANCE = 1e-5
"""m, of the hammer from its rest on the anvil."""


@dataclass(frozen=True)
class Contender:
    """A way to couple the halves: the master's settings, and what the contact's force is during a step."""

    label: str
    settings: tuple[tuple[str, Any], ...]

    def master(self, step: float, t_end: float, **more: Any) -> MasterSettings:
        """The master's settings for a step, s."""
        return MasterSettings(step=step, t_end=t_end, **{**dict(self.settings), **more})


def _of(label: str, **settings: Any) -> Contender:
    return Contender(label, tuple(settings.items()))


JACOBI = _of("Jacobi", algorithm="jacobi")
GAUSS_SEIDEL = _of("Gauss-Seidel", algorithm="gauss-seidel")
JACOBI_LINEAR = _of("Jacobi, extrapolated", algorithm="jacobi", extrapolation="linear")
GAUSS_SEIDEL_LINEAR = _of("Gauss-Seidel, extrapolated", algorithm="gauss-seidel", extrapolation="linear")
END = _of("iterated, value at the end", algorithm="iterated", hold="end")
ITERATED = _of("iterated, mean", algorithm="iterated")
AITKEN = _of("iterated, mean, Aitken", algorithm="iterated", aitken=True)
BY_STEPS = _of("Newton, Jacobian by steps", algorithm="newton", jacobian="steps")
NEWTON = _of("Newton, derivatives", algorithm="newton")
LINEAR = _of("Newton, straight line", algorithm="newton", hold="linear")
CONTENDERS = (
    JACOBI, GAUSS_SEIDEL, JACOBI_LINEAR, GAUSS_SEIDEL_LINEAR, END, ITERATED, AITKEN, BY_STEPS, NEWTON, LINEAR,
)  # fmt: skip


def couple(
    halves: Sequence[Any], contender: Contender, step: float, t_end: float, record: Sequence[str], **more: Any
) -> SystemResult:
    """Run two halves: the striker gives position and velocity, the wall the contact's force. FMI 2.0 lets inputs go on
    with a derivative."""
    striker, wall = (of_source(n, half, "2.0", **SOLVER) for n, half in zip(("striker", "wall"), halves, strict=True))
    connections = (
        # the wall carries the position on with the velocity, so what it gets must meet the end of the step
        Connection.between("striker.hammer.x", "wall.hammer_x", hold="meet"),
        Connection.between("striker.hammer.vx", "wall.hammer_vx"),
        Connection.between("wall.blow.normal_force", "striker.contact_force"),
    )
    try:
        return run((striker, wall), connections, contender.master(step, t_end, **more), record)
    finally:
        striker.close()
        wall.close()


def blow() -> tuple[Any, Any, Any]:
    """Whole, striker and wall of the blow."""
    return tuple(load(f"split_{name}") for name in ("whole", "striker", "wall"))  # type: ignore[return-value]


def press(disturbance: float = DISTURBANCE) -> tuple[Model, Model, Model]:
    """Whole, striker and wall of the press, the hammer a little (m) off its rest."""
    law = {"law": "kelvin_voigt", "stiffness": STIFFNESS, "damping": DAMPING}
    masses = {"anvil_mass": ANVIL, "anvil_frequency": ANVIL_FREQUENCY}
    soft = {"hammer_frequency": 1e-3}  # as good as no spring: gravity holds it
    start = {"hammer_mass": HAMMER, "gap": 0.0, "speed": 0.0}
    models = (
        load("split_whole", **law, **masses, **soft, **start).model,
        load("split_striker", **soft, **start).model,
        load("split_wall", **law, **masses, **start).model,
    )
    anvil = -(HAMMER + ANVIL) * GRAVITY / (ANVIL * ANVIL_FREQUENCY**2)
    at = {"anvil": anvil, "hammer": anvil - HAMMER * GRAVITY / STIFFNESS + disturbance}
    return tuple(_placed(model, at) for model in models)  # type: ignore[return-value]


def _placed(model: Model, at: dict[str, float]) -> Model:
    """The model under gravity with its bodies at these x, m."""
    bodies = tuple(
        body.model_copy(update={"position": (at[body.name], 0.0)}) if body.name in at else body for body in model.bodies
    )
    starts = {"hammer_x": at["hammer"], "hammer_vx": 0.0}
    inputs = tuple(
        channel.model_copy(update={"start": starts[channel.name]}) if channel.name in starts else channel
        for channel in model.inputs
    )
    return model.model_copy(update={"bodies": bodies, "inputs": inputs, "gravity": (-GRAVITY, 0.0)})
