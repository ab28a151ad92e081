"""Matrices of an elastic solid: from a mesh with scikit-fem (extra `fe`), or from files of another programme."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..errors import ModelError
from ..extras import require

Array = NDArray[np.float64]
EXTRA = "fe"


@dataclass(frozen=True)
class FiniteElements:
    """A solid as matrices of its nodes' displacements, three for each node, one node after the other.

    Attributes
    ----------
    nodes : (N, 3), m.
    mass, stiffness : (3N, 3N), dense or sparse (scipy), symmetric; kg, N/m.
    """

    nodes: Array
    mass: Any
    stiffness: Any

    def near(self, point: Any, distance: float = 0.0) -> NDArray[np.int64]:
        """Numbers of the nodes within a distance (m) of a point (3,); without one, of the nearest node."""
        away = np.linalg.norm(self.nodes - np.asarray(point, dtype=float), axis=1)
        found = np.flatnonzero(away <= distance)
        return found if len(found) and distance else np.array([np.argmin(away)])

    def on_plane(self, axis: str, place: float) -> NDArray[np.int64]:
        """Numbers of the nodes with this x, y or z, m. Raises ModelError if there are none."""
        along = self.nodes[:, "xyz".index(axis)]
        found = np.flatnonzero(np.abs(along - place) <= 1e-9 * np.ptp(along))
        if not len(found):
            raise ModelError(f"no node has {axis} = {place} m; they go from {along.min():g} to {along.max():g}")
        return found


def finite_elements(
    mesh: Any, density: float, youngs_modulus: float, poisson_ratio: float, order: int = 2
) -> FiniteElements:
    """Linear elastic solid, of small strains.

    Parameters
    ----------
    mesh : a mesh of scikit-fem of hexahedra or tetrahedra, or the name of a file that meshio reads; m.
    density : kg/m^3.
    youngs_modulus : Pa.
    poisson_ratio : between -1 and 0.5.
    order : of the elements' polynomials, 1 or 2; of order 1 they are too stiff in bending.

    Raises
    ------
    ModelError : for another mesh, or numbers that no material has.
    """
    require("a solid from a mesh", EXTRA, skfem="scikit-fem", meshio="")
    import skfem
    from scipy.sparse import eye_array, kron

    if not (density > 0.0 and youngs_modulus > 0.0 and -1.0 < poisson_ratio < 0.5 and order in (1, 2)):
        raise ModelError(
            f"density = {density} kg/m3 and youngs_modulus = {youngs_modulus} Pa must be positive, poisson_ratio = "
            f"{poisson_ratio} between -1 and 0.5, order = {order} must be 1 or 2"
        )
    if isinstance(mesh, str | Path):
        try:
            mesh = skfem.Mesh.load(str(mesh))
        except Exception as error:
            raise ModelError(f"mesh '{mesh}' cannot be read: {error}") from None
    kinds = {"MeshHex": (skfem.ElementHex1, skfem.ElementHex2), "MeshTet": (skfem.ElementTetP1, skfem.ElementTetP2)}
    kind = next((found for name, found in kinds.items() if type(mesh).__name__.startswith(name)), None)
    if kind is None:
        raise ModelError(f"a mesh of hexahedra or tetrahedra is needed, not a {type(mesh).__name__}")
    basis = skfem.Basis(mesh, kind[order - 1]())
    values = np.stack(
        [np.broadcast_to(np.asarray(field[0]), basis.dx.shape) for field in basis.basis], axis=1
    )  # (e, i, q)
    slopes = np.stack([field[0].grad for field in basis.basis]).transpose(2, 0, 1, 3)  # (e, i, direction, q)
    elements, each = slopes.shape[:2]
    of_node = density * (values * basis.dx[:, None, :]) @ values.transpose(0, 2, 1)
    flat = slopes.reshape(elements, 3 * each, -1)
    products = ((flat * basis.dx[:, None, :]) @ flat.transpose(0, 2, 1)).reshape(elements, each, 3, each, 3)
    shear = 0.5 * youngs_modulus / (1.0 + poisson_ratio)
    dilation = 2.0 * shear * poisson_ratio / (1.0 - 2.0 * poisson_ratio)
    stiffness = dilation * products + shear * products.transpose(0, 1, 4, 3, 2)
    stiffness += shear * np.einsum("eicjc->eij", products)[:, :, None, :, None] * np.eye(3)[:, None, :]
    dofs = basis.element_dofs.T
    each_three = (3 * dofs[:, :, None] + np.arange(3)).reshape(elements, -1)
    mass = kron(_assembled(of_node, dofs, basis.N), eye_array(3)).tocsr()
    stiff = _assembled(stiffness.reshape(elements, 3 * each, 3 * each), each_three, 3 * basis.N)
    return FiniteElements(np.ascontiguousarray(basis.doflocs.T), mass, stiff)


def _assembled(matrices: Array, places: NDArray[np.int64], size: int) -> Any:
    """Sum of matrices of elements (elements, k, k) at their places (elements, k)."""
    from scipy.sparse import coo_array

    rows, columns = np.repeat(places, places.shape[1], axis=1), np.tile(places, places.shape[1])
    return coo_array((matrices.ravel(), (rows.ravel(), columns.ravel())), shape=(size, size)).tocsr()


def read_matrix(path: str | Path) -> Any:
    """A matrix from a file: .npz (of scipy, or one array), .npy, .mtx (Matrix Market), else text with numbers.

    Raises
    ------
    ModelError : if it cannot be read.
    """
    from scipy.io import mmread
    from scipy.sparse import load_npz

    name = str(path)
    try:
        if name.endswith(".mtx"):
            return mmread(name)
        if name.endswith(".npz"):
            with np.load(name, allow_pickle=False) as file:
                if len(file.files) == 1:
                    return file[file.files[0]]
            return load_npz(name)
        return np.load(name, allow_pickle=False) if name.endswith(".npy") else np.loadtxt(name, ndmin=2)
    except (OSError, ValueError) as error:
        raise ModelError(f"matrix '{name}' cannot be read: {error}") from None


def read_finite_elements(nodes: str | Path, mass: str | Path, stiffness: str | Path) -> FiniteElements:
    """A solid from three files (see `read_matrix`); sizes are looked at when it is reduced."""
    return FiniteElements(np.asarray(read_matrix(nodes), dtype=float), read_matrix(mass), read_matrix(stiffness))
