"""Bodies in space reduced from the matrices of a solid: modes of Craig and Bampton, and what they weigh.

Interfaces of three nodes and more are held together rigidly (six coordinates each), single nodes have three. With
these coordinates b held, the lowest modes; for each of b moved by one, the static shape (Craig and Bampton, AIAA J. 6,
1968, 1313). Of this basis the modes of the free body are taken, without its six rigid motions ("mean": mean axes at the
centre of mass), or those with one interface held, where the frame then is.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..elements.reduced_body3d import Interface3D, ReducedBody3D
from ..errors import ModelError
from ..rounding import SYMMETRY
from .finite_elements import FiniteElements

Array = NDArray[np.float64]
MEAN = "mean"
RIGID = 1e-6
"""Squared frequencies below this share of the first elastic one are those of rigid motions."""


def reduced_body(
    name: str,
    solid: FiniteElements,
    interfaces: Mapping[str, Sequence[int]] | None = None,
    modes: "int | Array" = 6,
    frame: str = MEAN,
    damping_ratio: float = 0.0,
    **fields: Any,
) -> ReducedBody3D:
    """A solid as a ReducedBody3D; its amplitudes are the largest displacements of its modes, m.

    Parameters
    ----------
    interfaces : numbers of their nodes by name; a single node, or three and more that move as if rigid.
    modes : how many with all interfaces held (the static shapes of the interfaces come in addition), or mode shapes
        (3N, n) of one's own, which are taken as they are, in the solid's axes and origin.
    frame : "mean" for mean axes with the centre of mass as origin, or the name of an interface that it stays with.
    damping_ratio : of every mode.
    fields : other fields of the record: position, attitude, velocity ...

    Raises
    ------
    ModelError : for matrices that do not fit, nodes that do not exist or are shared, interfaces that do not hold the
        solid, too many modes.
    """
    held = {key: np.unique(np.asarray(nodes, dtype=np.int64)) for key, nodes in (interfaces or {}).items()}
    weight = _mass_of_nodes(name, solid)
    _check_interfaces(name, held, len(solid.nodes), frame)
    total = float(weight.sum())
    origin = np.zeros(3)
    if isinstance(modes, int | np.integer):
        origin = _middle(solid, held[frame]) if frame in held else np.asarray(weight.sum(axis=0) @ solid.nodes) / total
        shapes = _shapes(name, solid, held, int(modes), frame, origin)
    else:
        shapes = np.asarray(modes, dtype=float)
        if shapes.ndim != 2 or len(shapes) != 3 * len(solid.nodes):
            raise ModelError(f"modes of '{name}' are {shapes.shape}: (3N, n) with N = {len(solid.nodes)} is needed")
    stiffness = shapes.T @ (solid.stiffness @ shapes)
    stiffness = 0.5 * (stiffness + stiffness.T)
    places = solid.nodes - origin
    moved = shapes.reshape(-1, 3, shapes.shape[1]).transpose(2, 0, 1)  # (n, N, 3)
    all_fields = np.concatenate([places[None], moved])
    weighted = np.stack([weight @ field for field in all_fields])
    second = np.einsum("kai,laj->klij", all_fields, weighted)
    second = 0.5 * (second + second.transpose(1, 0, 3, 2))
    first = weighted.sum(axis=1)
    if frame == MEAN and isinstance(modes, int | np.integer):
        first[:] = 0.0  # by the choice of the frame, but for rounding
    damping = None
    if damping_ratio:
        own_mass = np.einsum("kkii->k", second[1:, 1:])
        damping = np.diag(2.0 * damping_ratio * np.sqrt(np.diag(stiffness) * own_mass)).tolist()
    return ReducedBody3D(
        name=name,
        mass=total,
        first_moment=first[0].tolist(),
        second_moment=second[0, 0].tolist(),
        modal_first_moment=first[1:].tolist(),
        modal_moment=second[0, 1:].tolist(),
        modal_second_moment=second[1:, 1:].tolist(),
        stiffness=stiffness.tolist(),
        damping=damping,
        interfaces=[_interface(key, nodes, solid, origin, moved) for key, nodes in held.items()],
        **fields,
    )


def _mass_of_nodes(name: str, solid: FiniteElements) -> Any:
    """The mass of pairs of nodes (N, N), the same in all three directions."""
    from scipy.sparse import csr_array

    n = len(solid.nodes)
    if solid.nodes.shape != (n, 3) or solid.mass.shape != (3 * n, 3 * n) or solid.stiffness.shape != (3 * n, 3 * n):
        raise ModelError(
            f"'{name}' has nodes {solid.nodes.shape}, mass {solid.mass.shape}, stiffness {solid.stiffness.shape}: "
            "(N, 3) and twice (3N, 3N) are needed, with the displacements x, y, z of each node, and no rotations"
        )
    mass = csr_array(solid.mass)
    blocks = [[csr_array(mass[i::3][:, j::3]) for j in range(3)] for i in range(3)]
    size = float(np.abs(mass.data).max())
    for i in range(3):
        for j in range(3):
            off = blocks[i][j] - blocks[0][0] if i == j else blocks[i][j]
            if off.nnz and float(np.abs(off.data).max()) > SYMMETRY * size:
                raise ModelError(f"mass of '{name}' is not the same in x, y and z, or couples them: a consistent or "
                                 "lumped mass matrix of a solid's displacements is needed")  # fmt: skip
    return blocks[0][0]


def _check_interfaces(name: str, held: Mapping[str, NDArray[np.int64]], count: int, frame: str) -> None:
    seen: set[int] = set()
    for key, nodes in held.items():
        if len(nodes) in (0, 2) or nodes.min() < 0 or nodes.max() >= count:
            raise ModelError(f"interface '{key}' of '{name}' needs one node, or three and more, of 0..{count - 1}; it "
                             f"has {len(nodes)}")  # fmt: skip
        if seen & set(nodes.tolist()):
            raise ModelError(f"interface '{key}' of '{name}' shares nodes {sorted(seen & set(nodes.tolist()))[:5]} "
                             "with another: a node can be in one only")  # fmt: skip
        seen |= set(nodes.tolist())
    if frame != MEAN and (frame not in held or len(held[frame]) < 3):
        raise ModelError(f"frame = '{frame}' of '{name}' must be '{MEAN}' or an interface of three nodes and more; "
                         f"there are {[key for key, nodes in held.items() if len(nodes) > 2]}")  # fmt: skip


def _middle(solid: FiniteElements, nodes: NDArray[np.int64]) -> Array:
    middle: Array = solid.nodes[nodes].mean(axis=0)
    return middle


def _rigid(places: Array, middle: Array) -> Array:
    """Displacements (3 N, 6) of places (N, 3) by unit displacements and small rotations about `middle`."""
    arms = places - middle
    found = np.zeros((len(places), 3, 6))
    found[:, :, :3] = np.eye(3)
    for c in range(3):
        found[:, :, 3 + c] = np.cross(np.eye(3)[c], arms)
    return found.reshape(-1, 6)


def _shapes(
    name: str, solid: FiniteElements, held: Mapping[str, NDArray[np.int64]], modes: int, frame: str, origin: Array
) -> Array:
    """Modes (3N, n) of the reduced body, largest displacement 1."""
    from scipy.linalg import eigh
    from scipy.sparse import csc_array

    k, m = csc_array(solid.stiffness), csc_array(solid.mass)
    full = np.zeros((k.shape[0], 6 * len(held)))
    fixed = np.zeros(k.shape[0], dtype=bool)
    columns, of_frame = 0, slice(0, 0)
    for key, nodes in held.items():
        rows = (3 * nodes[:, None] + np.arange(3)).ravel()
        own = _rigid(solid.nodes[nodes], _middle(solid, nodes))
        own = own if len(nodes) > 2 else own[:, :3]
        full[rows, columns : columns + own.shape[1]] = own
        if key == frame:
            of_frame = slice(columns, columns + own.shape[1])
        fixed[rows] = True
        columns += own.shape[1]
    inner = np.flatnonzero(~fixed)
    basis = full[:, :columns]
    k_ii, m_ii = k[inner][:, inner], m[inner][:, inner]
    if columns:
        basis[inner] = -_factor(name, k_ii, float(k.diagonal().max()))(k[inner] @ basis)
    wanted = modes if columns else modes + 6
    if not 0 <= modes or wanted >= len(inner):
        raise ModelError(f"modes = {modes} of '{name}' must be from 0 to fewer than its {len(inner)} inner coordinates")
    if wanted:
        normal = np.zeros((len(full), wanted))
        normal[inner] = _lowest(k_ii, m_ii, wanted, not columns)
        basis = np.concatenate([basis, normal], axis=1)
    if frame != MEAN:
        basis = np.delete(basis, np.r_[of_frame], axis=1)
    basis /= np.sqrt(np.einsum("ij,ij->j", basis, m @ basis))
    squares, own = eigh(basis.T @ (k @ basis), basis.T @ (m @ basis))
    shapes: Array = basis @ own
    if frame == MEAN:
        if len(squares) < 7 or not abs(squares[5]) < RIGID * squares[6]:
            raise ModelError(f"'{name}' has squared frequencies {squares[:8]}: six rigid motions and at least one "
                             "mode are needed; are parts of it loose, or is it held somewhere?")  # fmt: skip
        shapes = shapes[:, 6:]
        rigid = _rigid(solid.nodes, origin)
        # rounding of the eigenvectors leaves some rigid motion, which belongs to the frame
        weighted = m @ rigid
        shapes = shapes - rigid @ np.linalg.solve(rigid.T @ weighted, weighted.T @ shapes)
    largest = np.sqrt(np.square(shapes).reshape(-1, 3, shapes.shape[1]).sum(axis=1)).max(axis=0)
    return np.asarray(shapes / largest)


def _factor(name: str, k_ii: Any, size: float) -> Any:
    from scipy.sparse.linalg import splu

    try:
        factors = splu(k_ii, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options={"SymmetricMode": True})
    except RuntimeError:
        factors = None
    if factors is None or float(np.abs(factors.U.diagonal()).min()) < 1e-12 * size:
        raise ModelError(
            f"the interfaces of '{name}' do not hold it: one of three nodes and more, not in a line, or several single "
            "nodes are needed; or give none, for the modes of the free body"
        )
    return factors.solve


def _lowest(k: Any, m: Any, count: int, free: bool) -> Array:
    """The lowest modes; of a free body by a shift below zero."""
    from scipy.sparse.linalg import eigsh

    shift = -1e-6 * float(k.diagonal().sum() / m.diagonal().sum()) if free else 0.0
    start = np.random.default_rng(0).normal(size=k.shape[0])  # the same modes, with the same signs, each time
    _, shapes = eigsh(k, count, m, sigma=shift, v0=start)
    return np.asarray(shapes)


def _interface(key: str, nodes: NDArray[np.int64], solid: FiniteElements, origin: Array, moved: Array) -> Interface3D:
    """Its place, and how the modes (n, N, 3) move and turn it: the rigid motion nearest to that of its nodes."""
    middle = _middle(solid, nodes)
    point, shape = (middle - origin).tolist(), moved[:, nodes]
    if len(nodes) < 3:
        return Interface3D(name=key, point=point, shape=shape[:, 0].tolist())
    rigid = _rigid(solid.nodes[nodes], middle)
    motion, *_ = np.linalg.lstsq(rigid, shape.reshape(len(shape), -1).T, rcond=None)
    return Interface3D(name=key, point=point, shape=motion[:3].T.tolist(), rotation=motion[3:].T.tolist())
