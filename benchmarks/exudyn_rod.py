"""exudyn's side of rod_cost.py: the rod as one GenericODE2 object, or as a chain of Mass1D and springs."""

from dataclasses import dataclass
from time import process_time
from typing import Any

import exudyn as exu
import numpy as np
from exudyn.itemInterface import (
    CoordinateSpringDamper,
    MarkerNodeCoordinate,
    Mass1D,
    Node1D,
    NodeGenericData,
    NodeGenericODE2,
    NodePointGround,
    ObjectContactCoordinate,
    ObjectGenericODE2,
)
from scipy.sparse import diags_array

LENGTH, STIFFNESS, MASS, SPEED = 1.0, 210e9 * 3.14e-4, 7800.0 * 3.14e-4, 0.1
WAVE = (STIFFNESS / MASS) ** 0.5


@dataclass(frozen=True)
class RodRun:
    """s in the solver, Newton iterations a step."""

    seconds: float
    iterations: float


def _contact(mbs: Any, end: int, elements: int) -> None:
    """The end's coordinate (a displacement) stays below the gap, by penalty."""
    ground = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=mbs.AddNode(NodePointGround()), coordinate=0))
    data = mbs.AddNode(NodeGenericData(initialCoordinates=[1.0], numberOfDataCoordinates=1))
    mbs.AddObject(
        ObjectContactCoordinate(
            markerNumbers=[end, ground], nodeNumber=data, contactStiffness=0.5 * STIFFNESS * elements / LENGTH,
            offset=-1e-3 / elements,
        )
    )  # fmt: skip


def _solve(mbs: Any, elements: int, steps: int, solver: str, modified: bool) -> RodRun:
    mbs.Assemble()
    s = exu.SimulationSettings()
    ti = s.timeIntegration
    h = 0.2 * LENGTH / elements / WAVE
    ti.endTime = 1e-3 / elements / SPEED + steps * h
    ti.numberOfSteps = round(ti.endTime / h)
    ti.verboseMode = 0
    ti.generalizedAlpha.spectralRadius = 0.9
    ti.newton.useModifiedNewton = modified
    ti.newton.relativeTolerance, ti.newton.absoluteTolerance = 1e-6, 1e-6
    ti.discontinuous.iterationTolerance = 1.0
    ti.discontinuous.useRecommendedStepSize = False
    s.solution.file.write = False
    s.linearSolver.solverType = getattr(exu.LinearSolverType, solver)
    start = process_time()
    if not mbs.SolveDynamic(s, storeSolver=True):
        raise SystemExit(f"exudyn failed: {elements} elements, {solver}")
    taken = process_time() - start
    return RodRun(taken, mbs.sys["dynamicSolver"].it.newtonStepsCount / ti.numberOfSteps)


def generic(elements: int, steps: int, solver: str, modified: bool) -> RodRun:
    """One object with sparse matrices (consistent mass)."""
    mbs = exu.SystemContainer().AddSystem()
    n, le = elements + 1, LENGTH / elements
    ends = np.ones(n)
    ends[[0, -1]] = 0.5
    mass = MASS * le * diags_array([np.full(n - 1, 1 / 6), ends * 2 / 3, np.full(n - 1, 1 / 6)], offsets=[-1, 0, 1])
    stiffness = (
        STIFFNESS / le * diags_array([np.full(n - 1, -1.0), 2.0 * ends, np.full(n - 1, -1.0)], offsets=[-1, 0, 1])
    )
    containers = []
    for matrix in (mass, stiffness):
        container = exu.MatrixContainer()
        container.SetWithSparseMatrix(matrix.tocsr(), n, n)
        containers.append(container)
    node = mbs.AddNode(
        NodeGenericODE2(
            referenceCoordinates=[0.0] * n, initialCoordinates=[0.0] * n, initialCoordinates_t=[SPEED] * n,
            numberOfODE2Coordinates=n,
        )
    )  # fmt: skip
    mbs.AddObject(ObjectGenericODE2(nodeNumbers=[node], massMatrix=containers[0], stiffnessMatrix=containers[1]))
    _contact(mbs, mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=n - 1)), elements)
    return _solve(mbs, elements, steps, solver, modified)


def chain(elements: int, steps: int, solver: str, modified: bool) -> RodRun:
    """Masses and springs (lumped mass)."""
    mbs = exu.SystemContainer().AddSystem()
    le = LENGTH / elements
    previous = -1
    for k in range(elements + 1):
        node = mbs.AddNode(Node1D(referenceCoordinates=[0.0], initialCoordinates=[0.0], initialVelocities=[SPEED]))
        mbs.AddObject(Mass1D(mass=MASS * le * (0.5 if k in (0, elements) else 1.0), nodeNumber=node))
        marker = mbs.AddMarker(MarkerNodeCoordinate(nodeNumber=node, coordinate=0))
        if k:
            mbs.AddObject(CoordinateSpringDamper(markerNumbers=[previous, marker], stiffness=STIFFNESS / le))
        previous = marker
    _contact(mbs, previous, elements)
    return _solve(mbs, elements, steps, solver, modified)
