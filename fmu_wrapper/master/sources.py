"""Makes instances: from an FMU, with its binary or in this process, from a scenario, from a model."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from ...core.multibody_model import Model
from ..extras import require
from ..slave import Slave
from .description import InstanceRecord
from .errors import MasterError
from .instance import Abilities, Fmi2Instance, Fmi3Instance, Instance
from .listening import instantiate
from .variable import of_description, of_slave

INSTANCES: dict[str, type[Instance]] = {"2.0": Fmi2Instance, "3.0": Fmi3Instance}
LoadScenario = Callable[..., Any]
"""Called with a scenario's name and parameters."""


def make_instance(
    name: str, record: InstanceRecord, folder: Path, unzip_into: Path, load_scenario: LoadScenario | None = None
) -> Instance:
    """The instance that `record` describes, with its start values set.

    Parameters
    ----------
    folder : paths in the record start here.
    unzip_into : an FMU is unzipped into a folder of its own in here, which the caller removes after the run.
    load_scenario : for a record with `scenario`: `tlismni.models.load`.

    Raises
    ------
    MasterError : if it cannot be made, or a start value does not fit.
    """
    if record.fmu is not None:
        instance = of_fmu(name, folder / record.fmu, unzip_into / name, record.in_process)
    else:
        source, solver = source_of(name, record, folder, load_scenario)
        instance = of_source(name, source, record.fmi, **solver)
    try:
        instance.set_start(record.start)
    except BaseException:
        instance.close()
        raise
    return instance


def source_of(
    name: str, record: InstanceRecord, folder: Path, load_scenario: LoadScenario | None
) -> tuple[Any, dict[str, Any]]:
    """The scenario or model of a record that is no FMU, and the solver settings that win over the scenario's.

    Raises
    ------
    MasterError, ModelError : if there is none.
    """
    if record.scenario is None:
        return Model.load(folder / str(record.model)), record.solver
    if load_scenario is None:
        raise MasterError(
            f"instance '{name}' is the scenario '{record.scenario}': give load_scenario=tlismni.models.load"
        )
    return load_scenario(record.scenario, **record.parameters), record.solver


def of_source(name: str, source: Any, fmi: str = "3.0", **solver: Any) -> Instance:
    """An instance whose slave, made from a model or scenario, runs in this process."""
    from ..in_process import InProcess
    from ..in_process3 import InProcess3

    slave = Slave(source, name=name, on_log=_nowhere, **solver)
    direct = InProcess(slave) if fmi == "2.0" else InProcess3(slave)
    variables = of_slave(slave.variables.variables, fmi)
    abilities = Abilities(state=True, variable_step=True, derivatives=True, courses=fmi == "2.0")
    return INSTANCES[fmi](name, direct, variables, abilities, {}, lambda: slave.log.last_problem)


def of_fmu(name: str, path: Path, unzipped: Path, in_process: bool = False) -> Instance:
    """An instance of an FMU, which is unzipped into the folder `unzipped`; see `make_instance`."""
    require(f"instance '{name}', an FMU,", "fmpy", "lxml", error=MasterError)
    import fmpy

    if not path.is_file():
        raise MasterError(f"instance '{name}': there is no FMU '{path}'")
    try:
        fmpy.extract(str(path), unzipdir=str(unzipped))
        description = fmpy.read_model_description(str(unzipped))
    except Exception as error:
        raise MasterError(f"instance '{name}': '{path}' cannot be read as an FMU: {error}") from error
    version = description.fmiVersion
    if version not in INSTANCES or description.coSimulation is None:
        raise MasterError(
            f"instance '{name}': '{path.name}' is of FMI {version}"
            f"{'' if description.coSimulation else ' without co-simulation'}: FMI 2.0 or 3.0 co-simulation is needed"
        )
    messages: list[str] = []

    def listen(message: str) -> None:
        messages[:] = [message]

    def last() -> str:
        return messages[-1] if messages else ""

    try:
        if in_process:
            from ..in_process import InProcess
            from ..in_process3 import InProcess3

            fmu = (InProcess if version == "2.0" else InProcess3).of(unzipped, name=name, on_log=_nowhere)
            last = _last_problem(fmu)
        else:
            fmu = instantiate(str(unzipped), description, listen)
    except Exception as error:
        raise MasterError(f"instance '{name}': '{path.name}' cannot be instantiated: {last() or error}") from error
    return INSTANCES[version](
        name, fmu, of_description(description), _abilities(unzipped), _dependencies(description), last
    )


def _nowhere(*message: Any) -> None:
    """Where messages go that are read from the slave when a call fails."""


def _last_problem(fmu: Any) -> Callable[[], str]:
    return lambda: str(fmu.slave.log.last_problem)


def _abilities(unzipped: Path) -> Abilities:
    """The flags of the CoSimulation element, under their names in FMI 2.0 or 3.0 (fmpy reads not all of the latter)."""
    element = ElementTree.parse(unzipped / "modelDescription.xml").find("CoSimulation")
    flags: Mapping[str, str] = {} if element is None else element.attrib

    def is_set(*names: str) -> bool:
        return any(flags.get(name) in ("true", "1") for name in names)

    return Abilities(
        is_set("canGetAndSetFMUstate", "canGetAndSetFMUState"),
        is_set("canHandleVariableCommunicationStepSize"),
        is_set("providesDirectionalDerivative", "providesDirectionalDerivatives"),
        is_set("canInterpolateInputs"),
    )


def _dependencies(description: Any) -> dict[str, frozenset[str]]:
    """What outputs declare to depend on; an output that declares nothing is left out."""
    return {
        unknown.variable.name: frozenset(v.name for v in unknown.dependencies)
        for unknown in description.outputs
        if unknown.dependencies is not None
    }
