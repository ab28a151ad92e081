"""Any model as an exudyn MainSystem, built from primitives, with sensors that give the model's channels."""

from collections.abc import Callable, Sequence
from typing import Any

from ..core.multibody_model import Model
from .errors import NotTranslatable
from .exudyn_import import import_exudyn
from .translation import Build, translate
from .translation.laid_contacts import laid_contacts
from .translation.redundant import drop_shared_loads, redundancy


def build_exudyn_model(model: Model, *, sensors: bool = True, clamped: frozenset[str] = frozenset()) -> Build:
    """`model` in exudyn, assembled and ready to run. Build it anew for every run: exudyn keeps state in it.

    exudyn frees the system with the `Build` that is returned. `sensors=False` leaves out recording (for timing).
    `clamped`: contacts that exudyn's own objects would let pull.

    Raises
    ------
    ExudynUnavailable : if exudyn cannot be used.
    NotTranslatable : for anything that exudyn has no equal of.
    """
    if not isinstance(model, Model):
        raise NotTranslatable(
            f"only a Model of elements can be rerun in exudyn, not {type(model).__name__} (which is code)"
        )
    exudyn = import_exudyn()
    container = exudyn.core.SystemContainer()
    mbs = container.AddSystem()
    ground = mbs.AddObject(exudyn.items.ObjectGround())
    ground_node = mbs.AddNode(exudyn.items.NodePointGround())
    repeated = redundancy(model)
    build = Build(
        exudyn, mbs, model, sensors, ground, ground_node, container, laid=laid_contacts(model), clamped=clamped,
        redundant=repeated.rows, sharing=repeated.sharing,
    )  # fmt: skip
    for element in model.elements():
        translate(element, build)
    drop_shared_loads(build)
    if model.inputs:
        names = ", ".join(f"{i.name} = {i.start:g} {i.unit}" for i in model.inputs)
        build.notes.append(f"input channels keep their start values: {names}")
    if build.before_step:
        mbs.SetPreStepUserFunction(_all_of(build.before_step))
    mbs.Assemble()
    return build


def _all_of(functions: Sequence[Callable[[Any, float], None]]) -> Any:
    def before_step(mbs: Any, t: float) -> bool:
        for function in functions:
            function(mbs, t)
        return True

    return before_step
