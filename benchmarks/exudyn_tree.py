"""exudyn's minimal coordinates: the chain as `ObjectKinematicTree`, with explicit methods that control the error."""

from time import process_time

import numpy as np
from numpy.typing import NDArray
from tlismni.core import Model

METHODS = ("DOPRI5", "ODE23")


def run_chain(model: Model, t_end: float, method: str, tolerance: float) -> tuple[float, NDArray[np.float64]]:
    """(CPU time of exudyn's solver in s, coordinates of all bodies at the end) of the scenario `chain`.

    method : one of METHODS. tolerance : relative; the absolute one is a hundredth of it, as on our side.
    """
    import exudyn as exu
    from exudyn.itemInterface import NodeGenericODE2, ObjectKinematicTree

    links = model.bodies
    count = len(links)
    half = links[0].position[0]
    mbs = exu.SystemContainer().AddSystem()
    zeros = [0.0] * count
    node = mbs.AddNode(
        NodeGenericODE2(
            referenceCoordinates=zeros,
            initialCoordinates=zeros,
            initialCoordinates_t=zeros,
            numberOfODE2Coordinates=count,
        )
    )
    offsets, centres, turns, inertias = exu.Vector3DList(), exu.Vector3DList(), exu.Matrix3DList(), exu.Matrix3DList()
    for k, link in enumerate(links):
        offsets.Append([2.0 * half if k else 0.0, 0.0, 0.0])
        centres.Append([half, 0.0, 0.0])
        turns.Append(np.eye(3))
        inertias.Append(link.inertia * np.eye(3))  # about the centre; only that about z counts
    mbs.AddObject(
        ObjectKinematicTree(
            nodeNumber=node,
            jointTypes=[exu.JointType.RevoluteZ] * count,
            linkParents=list(range(-1, count - 1)),
            jointTransformations=turns,
            jointOffsets=offsets,
            linkInertiasCOM=inertias,
            linkCOMs=centres,
            linkMasses=[link.mass for link in links],
            gravity=[*model.gravity[:2], 0.0],
        )
    )
    mbs.Assemble()
    settings = exu.SimulationSettings()
    settings.solution.file.write = False
    integration = settings.timeIntegration
    integration.endTime, integration.numberOfSteps = t_end, 20
    integration.automaticStepSize, integration.initialStepSize = True, 1e-3
    integration.relativeTolerance, integration.absoluteTolerance = tolerance, 0.01 * tolerance
    integration.verboseMode = 0
    began = process_time()
    mbs.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, method))
    seconds = process_time() - began
    angles = np.cumsum(mbs.systemData.GetODE2Coordinates())
    ways = half * np.column_stack([np.cos(angles), np.sin(angles)])
    return seconds, np.column_stack([2.0 * np.cumsum(ways, axis=0) - ways, angles]).ravel()
