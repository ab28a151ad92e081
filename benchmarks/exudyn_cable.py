"""exudyn's side of cable_cost.py: the cable pendulum from ObjectANCFCable2D, timed without recording."""

import math
from dataclasses import dataclass
from time import perf_counter

import exudyn
from exudyn import itemInterface as items
from tlismni.core import Cable2D

TOLERANCE = 1e-6
"""Relative and absolute, of exudyn's Newton: 1e-10, its default, is out of reach for thousands of elements."""


@dataclass(frozen=True)
class CableRun:
    """Wall time of the solver in s, place of the tip in m, Newton iterations and Jacobians a step."""

    seconds: float
    tip: tuple[float, float]
    iterations: float
    jacobians: float


def pendulum(cable: Cable2D, step: float, steps: int, solver: str, modified: bool) -> CableRun:
    """`steps` fixed steps of generalized-alpha (spectral radius 0.9) from rest, pinned at the first node."""
    mbs = exudyn.SystemContainer().AddSystem()
    h = cable.length / cable.elements
    nodes = [
        mbs.AddNode(items.NodePoint2DSlope1(referenceCoordinates=[k * h, 0.0, 1.0, 0.0]))
        for k in range(cable.elements + 1)
    ]
    for k in range(cable.elements):
        element = mbs.AddObject(
            items.ObjectANCFCable2D(
                length=h,
                massPerLength=cable.mass_per_length,
                bendingStiffness=cable.bending_stiffness,
                axialStiffness=cable.axial_stiffness,
                nodeNumbers=nodes[k : k + 2],
            )
        )
        marker = mbs.AddMarker(items.MarkerBodyMass(bodyNumber=element))
        mbs.AddLoad(items.LoadMassProportional(markerNumber=marker, loadVector=[0.0, -9.81, 0.0]))
    ground = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=mbs.AddNode(items.NodePointGround()), coordinate=0))
    for c in range(2):
        marker = mbs.AddMarker(items.MarkerNodeCoordinate(nodeNumber=nodes[0], coordinate=c))
        mbs.AddObject(items.CoordinateConstraint(markerNumbers=[ground, marker]))
    mbs.Assemble()
    s = exudyn.SimulationSettings()
    s.timeIntegration.numberOfSteps, s.timeIntegration.endTime = steps, steps * step
    s.timeIntegration.generalizedAlpha.spectralRadius = 0.9
    s.timeIntegration.newton.useModifiedNewton = modified
    s.timeIntegration.newton.relativeTolerance = s.timeIntegration.newton.absoluteTolerance = TOLERANCE
    s.timeIntegration.verboseMode = 0
    s.solution.file.write = False
    s.linearSolver.solverType = getattr(exudyn.LinearSolverType, solver)
    start = perf_counter()
    done = mbs.SolveDynamic(s, storeSolver=True)
    seconds = perf_counter() - start
    if done is False:
        return CableRun(math.inf, (math.nan, math.nan), math.nan, math.nan)
    counts, q = mbs.sys["dynamicSolver"].it, mbs.systemData.GetODE2Coordinates()
    tip = (cable.length + float(q[-4]), float(q[-3]))
    return CableRun(seconds, tip, counts.newtonStepsCount / steps, counts.newtonJacobiCount / steps)
