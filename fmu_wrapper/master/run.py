"""Runs a coupled system: from its description, or from instances that exist."""

import tempfile
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path

import numpy as np

from .control import Algorithm, Controlled, fixed_steps
from .coupled import Coupled, Vector, probe_feedthrough
from .description import Connection, MasterSettings, SystemDescription
from .errors import MasterError, near
from .explicit import GaussSeidel, Jacobi
from .graph import Graph, arrange, declared_feedthrough, resolve
from .instance import Instance
from .iterated import Iterated
from .newton import Newton
from .result import Recorder, SystemResult
from .sources import LoadScenario, make_instance


def simulate_system(
    description: SystemDescription,
    folder: str | Path = ".",
    *,
    load_scenario: LoadScenario | None = None,
    progress: Callable[[float], None] | None = None,
) -> SystemResult:
    """Make the instances of a description, run them to the end, and free them.

    Parameters
    ----------
    folder : paths in the description start here.
    load_scenario : `tlismni.models.load`, for instances that are scenarios.
    progress : called with the time reached, s.

    Raises
    ------
    MasterError : for a description that does not fit the instances, or a step that failed.
    """
    with tempfile.TemporaryDirectory(prefix="tlismni_", ignore_cleanup_errors=True) as unzipped:
        instances: list[Instance] = []
        try:
            for name, record in description.instances.items():
                instances.append(make_instance(name, record, Path(folder), Path(unzipped), load_scenario))
            return run(instances, description.connections, description.master, description.record, progress)
        finally:
            for instance in instances:
                instance.close()


def run(
    instances: Sequence[Instance],
    connections: Iterable[Connection],
    settings: MasterSettings,
    record: Sequence[str] = ("*",),
    progress: Callable[[float], None] | None = None,
) -> SystemResult:
    """Run new instances to the end; they are not freed. See `simulate_system`."""
    links, unconnected = resolve(connections, settings.hold, instances)
    sequence = _sequence(settings, instances)
    for instance in instances:
        instance.initialize(0.0, settings.t_end)
    known, open_ = declared_feedthrough(links, instances)
    found = probe_feedthrough(Coupled(instances, Graph(links, (), ())), open_)
    graph = arrange(links, unconnected, [*known, *found])
    coupled = Coupled(instances, graph)
    coupled.values = _present_inputs(coupled)
    coupled.settle()
    for instance in instances:
        instance.finish_initialization()
    coupled.settle()
    algorithm = _algorithm(settings, coupled, sequence)
    recorder = Recorder(instances, links, record)
    recorder.take(0.0)
    controlled = Controlled(coupled, algorithm, settings) if settings.control is not None else None
    steps = 0
    for t in controlled.steps() if controlled else fixed_steps(coupled, algorithm, settings):
        steps += 1
        recorder.take(t)
        if progress is not None:
            progress(t)
    times, columns = recorder.columns()
    stats = {
        "communication_steps": steps,
        "rejected": controlled.rejected if controlled else 0,
        "passes": algorithm.passes,
        "instance_steps": sum(instance.steps for instance in instances),
        "rollbacks": coupled.rollbacks,
    }
    if isinstance(algorithm, Newton):
        stats["jacobians"] = algorithm.jacobians
    return SystemResult(times, columns, tuple(recorder.channels), stats, graph.unconnected, tuple(graph.loops))


def _present_inputs(coupled: Coupled) -> Vector:
    return np.array([coupled.instances[link.target].get([link.input.reference])[0] for link in coupled.links])


def _sequence(settings: MasterSettings, instances: Sequence[Instance]) -> list[int]:
    number = {instance.name: k for k, instance in enumerate(instances)}
    for name in settings.order:
        if name not in number:
            raise MasterError(f"master.order: there is no instance '{name}'; {near(name, number)}")
    if settings.order and sorted(settings.order) != sorted(number):
        raise MasterError(f"master.order must name each of {list(number)} once, not {list(settings.order)}")
    return [number[name] for name in settings.order] or list(range(len(instances)))


def _algorithm(settings: MasterSettings, coupled: Coupled, sequence: Sequence[int]) -> Algorithm:
    match settings.algorithm:
        case "jacobi":
            return Jacobi(coupled, settings.extrapolation == "linear")
        case "gauss-seidel":
            return GaussSeidel(coupled, sequence, settings.extrapolation == "linear")
        case "iterated":
            return Iterated(settings, coupled, sequence)
        case _:
            return Newton(settings, coupled, sequence)
