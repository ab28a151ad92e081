"""Flexible bodies without ANCF elements: rods as one GenericODE2 object."""

import numpy as np
from scipy.sparse import diags_array

from ...core.elements import AxialRod, FloatingBeam2D
from ..errors import NotTranslatable
from .bodies import node_columns
from .registry import BodyItems, Build, no_equal, translates

no_equal(
    "a Cable2D of the same section: exudyn has the ANCF element, and FFRF bodies only from three-dimensional "
    "meshes (`tlismni.validation.as_cables(model)` makes the exchange, `crosscheck` takes it as `exudyn_model`)",
    FloatingBeam2D,
)


@translates(AxialRod)
def axial_rod(record: AxialRod, build: Build) -> None:
    """NodeGenericODE2 with ObjectGenericODE2 of sparse matrices; the reference is the unstrained rod."""
    if record.massless_ends:
        raise NotTranslatable(
            f"'{record.name}' has massless ends {list(record.massless_ends)}, and exudyn needs mass at each coordinate:"
            " compare it with massless_ends = () and more elements, both tend to the same rod"
        )
    n, length = record.elements + 1, record.length / record.elements
    inertia = record.mass_per_length * length
    diagonal, beside = (1.0 / 3.0, 1.0 / 6.0) if record.mass_matrix == "consistent" else (0.5, 0.0)
    shared = np.full(n, 2.0)  # elements at a node
    shared[[0, -1]] = 1.0
    side = np.ones(n - 1)
    mass = inertia * diags_array([beside * side, diagonal * shared, beside * side], offsets=[-1, 0, 1])
    chain = diags_array([-side, shared, -side], offsets=[-1, 0, 1])
    stiffness = record.axial_stiffness / length * chain
    core = build.exudyn.core
    matrices = {}
    for name, matrix in (("mass", mass), ("stiffness", stiffness), ("damping", record.damping_time * stiffness)):
        container = core.MatrixContainer()
        container.SetWithSparseMatrix(matrix.tocsr(), n, n)
        if name != "damping" or record.damping_time:
            matrices[f"{name}Matrix"] = container
    q0, v0 = record.initial_state()
    node = build.add(
        "NodeGenericODE2", numberOfODE2Coordinates=n, referenceCoordinates=list(q0), initialCoordinates=[0.0] * n,
        initialCoordinates_t=list(v0),
    )  # fmt: skip
    weight = (0.5 * inertia * build.model.gravity[0] * shared).tolist()
    item = build.add("ObjectGenericODE2", nodeNumbers=[node], forceVector=weight, **matrices)
    build.bodies[record.name] = BodyItems(node, item, False, reference=tuple(q0))
    build.flexible = True
    node_columns(record, build, (node,), q0)
