"""`tlismni export`: write an FMU."""

import zipfile
from contextlib import nullcontext
from pathlib import Path

import typer

from ..errors import one_line_errors
from ..fmu_file import binaries
from ..options import (
    Arrays,
    Atol,
    Author,
    Bundle,
    CommunicationStep,
    Debug,
    EndTime,
    ExecutionTool,
    FmiVersion,
    FmuFile,
    Json,
    MethodName,
    MethodOption,
    ModelVersion,
    Native,
    Outputs,
    Platforms,
    Protect,
    Rtol,
    Set,
    Source,
    Sources,
    Step,
    check_suffix,
)
from ..screen import compile_notice, print_json, progress_bar, say
from ..targets import check_file, is_system_file

EXAMPLES = (
    "Examples:\n\n  tlismni export pendulum_stop -o pendulum.fmu\n\n"
    "  tlismni export pendulum_stop -o pendulum3.fmu --fmi 3\n\n"
    "  tlismni export pendulum_stop -o anywhere.fmu --bundle --platform all\n\n"
    "  tlismni export pendulum_stop -o pendulum.fmu --native\n\n"
    "  tlismni export pendulum_stop -o pendulum.fmu --native --protect --outputs 'pendulum.*,stop.gap'\n\n"
    "  tlismni export system.toml -o system.ssp\n\n"
    "  tlismni export my_model.json -o ball.fmu --t-end 2 --method ebdf --option k=3 --set restitution=0.5"
)


@one_line_errors
def export(
    source: Source,
    output: FmuFile,
    fmi: FmiVersion = "2.0",
    sets: Set = None,
    t_end: EndTime = None,
    communication_step: CommunicationStep = None,
    method: MethodName = None,
    rtol: Rtol = None,
    atol: Atol = None,
    step: Step = None,
    option: MethodOption = None,
    bundle: Bundle = False,
    native: Native = False,
    outputs: Outputs = None,
    protect: Protect = False,
    sources: Sources = False,
    arrays: Arrays = False,
    platform: Platforms = None,
    author: Author = None,
    model_version: ModelVersion = None,
    execution_tool: ExecutionTool = True,
    json: Json = False,
    debug: Debug = False,
) -> None:
    """Export a scenario or a model file as a co-simulation FMU, or a system file (.toml) as an SSP archive (.ssp)."""
    if is_system_file(source):
        solver = (t_end, communication_step, method, rtol, atol, step, option)
        others = (
            sets,
            *solver,
            native or None,
            outputs,
            protect or None,
            sources or None,
            arrays or None,
            author,
            model_version,
            None if execution_tool else False,
        )
        _system(source, output, json, any(value is not None for value in others), bundle, platform)
        return
    check_suffix(output, (".fmu",), "--output")
    check_file(output)

    from ...fmu_wrapper import export_fmu
    from ...fmu_wrapper.export import known_version
    from ...fmu_wrapper.platforms import choose
    from ..source import read_source, solver_settings

    fmi, platforms = known_version(fmi), choose(platform or ())
    scenario = read_source(source, sets, t_end=t_end, method=method, rtol=rtol, atol=atol, step=step, options=option)
    output.parent.mkdir(parents=True, exist_ok=True)
    notes: list[str] = []
    bar = progress_bar(f"trying the parameters of {scenario.name}", 1.0) if native else nullcontext()
    with compile_notice(), bar as progress:
        path = export_fmu(
            scenario,
            output,
            fmi,
            communication_step=communication_step,
            bundle=bundle,
            native=native,
            outputs=outputs_of(outputs),
            protect=protect,
            sources=sources,
            platforms=platforms,
            arrays=arrays,
            author=author,
            version=model_version,
            needs_execution_tool=execution_tool,
            progress=progress,
            on_note=notes.append,
        )
    size = path.stat().st_size
    with zipfile.ZipFile(path) as archive:
        held = binaries(archive.namelist())
    if json:
        print_json(
            {
                "file": str(path),
                "bytes": size,
                "fmi": fmi,
                "scenario": scenario.name,
                "parameters": dict(scenario.parameters),
                "t_end": scenario.t_end,
                "solver": solver_settings(scenario),
                "bundle": bundle,
                "native": native,
                "platforms": held,
                **({"notes": notes} if native else {}),
                "inputs": [channel.name for channel in scenario.model.inputs],
            }
        )
    else:
        carried = ", with tlismni inside" if bundle else ", without Python" if native else ""
        say(f"wrote {path} (FMI {fmi}, {size / 1024:.0f} KiB, for {', '.join(held)}{carried})")
        for note in notes:
            say(f"parameters {note}")


def outputs_of(given: list[str] | None) -> list[str]:
    """Names and patterns, from texts in which commas part them."""
    return [name.strip() for text in given or () for name in text.split(",") if name.strip()]


def _system(source: str, output: Path, json: bool, more: bool, bundle: bool, platform: list[str] | None) -> None:
    """Write the SSP archive of a system file."""
    if more:
        raise typer.BadParameter(f"'{source}' describes its instances and their solvers itself: change them there")
    check_suffix(output, (".ssp",), "--output")
    check_file(output)

    from ...fmu_wrapper.master import read_system, write_ssp
    from ...fmu_wrapper.platforms import choose
    from ...models import load

    described = read_system(source)
    output.parent.mkdir(parents=True, exist_ok=True)
    with compile_notice():
        carried = {"bundle": bundle, "platforms": choose(platform or ())}
        path = write_ssp(described, output, Path(source).parent, load_scenario=load, **carried)
    if json:
        print_json({"file": str(path), "bytes": path.stat().st_size, "instances": list(described.instances)})
    else:
        say(f"wrote {path} (SSP 1.0, {len(described.instances)} instances)")
