"""Writes a system as an SSP 1.0 archive: its FMUs and the description of how they are connected, for other masters."""

import os
import tempfile
import zipfile
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from ...core.model.units import parse_unit
from ..description_parts import add, finish
from ..export import export_fmu
from ..version import package_version
from .description import InstanceRecord, SystemDescription
from .errors import MasterError
from .graph import Link, resolve
from .instance import Instance
from .sources import LoadScenario, of_fmu, source_of

SSD = "http://ssp-standard.org/SSP1/SystemStructureDescription"
SSC = "http://ssp-standard.org/SSP1/SystemStructureCommon"
SSV = "http://ssp-standard.org/SSP1/SystemStructureParameterValues"
TYPES = {"Real": "Real", "Float64": "Real", "Float32": "Real", "Boolean": "Boolean", "String": "String"}
"""By kind of a variable the SSP type; all others are integers."""


def write_ssp(
    description: SystemDescription,
    path: str | Path,
    folder: str | Path = ".",
    *,
    load_scenario: LoadScenario | None = None,
    **export: Any,
) -> Path:
    """Write a system as an SSP archive. Scenarios and models in it become FMUs.

    An SSP says what is connected, not how a master couples it: algorithm, order and holds stay behind. Factors of
    connections become linear transformations, which not every master applies.

    Parameters
    ----------
    path : the file to write, "x.ssp".
    folder : paths in the description start here.
    load_scenario : `tlismni.models.load`, for instances that are scenarios.
    export : further arguments of `export_fmu` (`bundle`, `platforms`) for scenarios and models.

    Raises
    ------
    MasterError : for a description that does not fit its instances, or a file that cannot be written.
    """
    path = Path(path)
    with tempfile.TemporaryDirectory(prefix="tlismni_", ignore_cleanup_errors=True) as temporary:
        place = Path(temporary)
        fmus: dict[str, Path] = {}
        instances: list[Instance] = []
        try:
            for name, record in description.instances.items():
                fmus[name] = _fmu(name, record, Path(folder), place, description, load_scenario, export)
                instances.append(of_fmu(name, fmus[name], place / f"{name}_unzipped"))
                instances[-1].set_start(record.start)
            links, _ = resolve(description.connections, description.master.hold, instances)
            ssd = _structure(description, instances, links)
        finally:
            for instance in instances:
                instance.close()
        _write(path, ssd, fmus)
    return path


def _fmu(
    name: str,
    record: InstanceRecord,
    folder: Path,
    place: Path,
    system: SystemDescription,
    load: LoadScenario | None,
    export: dict[str, Any],
) -> Path:
    if record.fmu is not None:
        return folder / record.fmu
    source, solver = source_of(name, record, folder, load)
    times: dict[str, Any] = {"t_end": system.master.t_end, "communication_step": system.master.step}
    return export_fmu(source, place / f"{name}.fmu", record.fmi, **times, **export, **solver)


def _structure(description: SystemDescription, instances: Sequence[Instance], links: Iterable[Link]) -> bytes:
    """SystemStructure.ssd."""
    from lxml import etree

    links = list(links)
    root = etree.Element(
        f"{{{SSD}}}SystemStructureDescription",
        {"version": "1.0", "name": description.name, "generationTool": f"tlismni {package_version()}"},
        nsmap={"ssd": SSD, "ssc": SSC, "ssv": SSV},
    )
    system = _add(root, SSD, "System", name=description.name, description=description.description or None)
    elements = _add(system, SSD, "Elements")
    units: set[str] = set()
    for number, instance in enumerate(instances):
        component = _add(
            elements, SSD, "Component",
            name=instance.name, type="application/x-fmu-sharedlibrary", source=f"resources/{instance.name}.fmu",
        )  # fmt: skip
        connectors = _add(component, SSD, "Connectors")
        ends = [(link.output, "output") for link in links if link.source == number]
        ends += [(link.input, "input") for link in links if link.target == number]
        for variable, kind in dict.fromkeys(ends):
            connector = _add(connectors, SSD, "Connector", name=variable.name, kind=kind)
            _add(connector, SSC, "Real", unit=variable.unit)
            units |= {variable.unit} if variable.unit else set()
        _starts(component, instance, description.instances[instance.name])
    connections = _add(system, SSD, "Connections")
    for link in links:
        connection = _add(
            connections, SSD, "Connection",
            startElement=instances[link.source].name, startConnector=link.output.name,
            endElement=instances[link.target].name, endConnector=link.input.name,
            # the factor holds the conversion already
            suppressUnitConversion="true" if link.output.unit != link.input.unit else None,
        )  # fmt: skip
        if link.factor != 1.0:
            _add(connection, SSC, "LinearTransformation", factor=link.factor)
    listed = _add(root, SSD, "Units") if units else None
    for name in sorted(units):
        base = parse_unit(name)
        unit = _add(listed, SSC, "Unit", name=name)
        exponents = (
            {} if base is None else {**base.exponents, **({} if base.factor == 1.0 else {"factor": base.factor})}
        )
        _add(unit, SSC, "BaseUnit", **exponents)
    _add(root, SSD, "DefaultExperiment", startTime=0.0, stopTime=description.master.t_end)
    return finish(root)


def _starts(component: Any, instance: Instance, record: InstanceRecord) -> None:
    """The start values of an instance, as parameters of its component."""
    if not record.start:
        return
    binding = _add(_add(component, SSD, "ParameterBindings"), SSD, "ParameterBinding")
    values = _add(_add(binding, SSD, "ParameterValues"), SSV, "ParameterSet", version="1.0", name=instance.name)
    parameters = _add(values, SSV, "Parameters")
    for name, value in record.start.items():
        parameter = _add(parameters, SSV, "Parameter", name=name)
        _add(parameter, SSV, TYPES.get(instance.variable(name).kind, "Integer"), value=value)


def _add(parent: Any, namespace: str, tag: str, **attributes: Any) -> Any:
    return add(parent, f"{{{namespace}}}{tag}", **attributes)


def _write(path: Path, ssd: bytes, fmus: dict[str, Path]) -> None:
    """Write the archive whole or not at all."""
    try:
        handle, temporary = tempfile.mkstemp(suffix=".ssp", dir=path.parent)
        os.close(handle)
    except OSError as error:
        raise MasterError(f"'{path}' cannot be written: {error.strerror or error}") from None
    try:
        with zipfile.ZipFile(temporary, "w", zipfile.ZIP_DEFLATED) as archive:
            archive.writestr("SystemStructure.ssd", ssd)
            for name, fmu in fmus.items():
                archive.write(fmu, f"resources/{name}.fmu")
        os.chmod(temporary, 0o644)
        os.replace(temporary, path)
    except BaseException:
        Path(temporary).unlink(missing_ok=True)
        raise
