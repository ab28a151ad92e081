"""A body in space in a floating frame, reduced to modes: from a mesh and its matrices (`tlismni.core.flexible`)."""

from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, ClassVar, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import Field, GetJsonSchemaHandler, model_validator
from pydantic_core import CoreSchema

from ..errors import ModelError
from ..model.angular_velocity import AngularVelocity
from ..model.array_files import arrays_from_file, or_arrays
from ..model.attitude import UPRIGHT, Attitude
from ..model.base import Name, Positive, Record, Vector3
from ..model.derived import Derived
from ..model.markers import Marker3D
from .base import Form, Numbering, Row
from .coordinate import Coordinate, X, Y, Z
from .linear_system import Matrix, Vector
from .reduced_checks import check_mass, check_sign, check_size, check_symmetry
from .reduced_kernel3d import reduced_body3d_kernel
from .spatial_body import EULER, SpatialFrame, marker_on, parameter_rates

Array = NDArray[np.float64]
Rows3 = tuple[Vector3, ...]
Moment = tuple[Vector3, Vector3, Vector3]
IN_FILE = frozenset({
    "mass", "first_moment", "second_moment", "modal_first_moment", "modal_moment", "modal_second_moment", "stiffness",
    "damping",
})  # fmt: skip
"""Fields that a file of arrays holds, the interfaces beside them."""


class Interface3D(Record):
    """A place of a reduced body to which something can be attached by an InterfaceFrame3D."""

    name: Name
    """Its name on the body."""
    point: Vector3
    """Undeformed position in the frame, m."""
    shape: Rows3
    """Displacement for unit amplitudes, a vector for each of the n modes."""
    rotation: Rows3 | None = None
    """Small rotation for unit amplitudes, a vector for each mode, rad; left out: it turns with the frame."""


class ReducedBody3D(SpatialFrame):
    """A flexible body in space over n modes: r = R + A(p) (u0 + S w), S small displacements.

    Coordinates are those of the frame, x, y, z and the Euler parameters e0 ... e3, and the amplitudes mode1 ... moden.
    The integrals are over the mass of the undeformed body, u0 from the frame's origin; of a mesh they are sums with its
    mass matrix. A marker on the body is one on its frame; the frame of an interface is that of an InterfaceFrame3D. A
    rigid motion has no place among the modes: the frame has it already. Displacements are of first order: the body
    does not stiffen as it spins (cut it into several where that counts).

    Raises
    ------
    ModelError : for sizes that do not fit, matrices that are not symmetric, a mass matrix of frame and modes that is
        not positive definite, stiffness or damping with a negative eigenvalue, an interface's name given twice.
    """

    type: Literal["ReducedBody3D"] = "ReducedBody3D"
    kernel: ClassVar[Any] = reduced_body3d_kernel

    mass: Positive
    """Mass, kg."""
    first_moment: Vector3 = (0.0, 0.0, 0.0)
    """int u0 dm, kg m."""
    second_moment: Moment
    """int u0 u0^T dm, (3, 3), kg m^2; the moment of inertia about x is the yy entry and the zz entry."""
    modal_first_moment: Rows3
    """int S_k dm, a vector for each of the n modes."""
    modal_moment: tuple[Moment, ...]
    """int u0 S_k^T dm, (n, 3, 3)."""
    modal_second_moment: tuple[tuple[Moment, ...], ...]
    """int S_k S_l^T dm, (n, n, 3, 3)."""
    stiffness: Annotated[Matrix, Field(min_length=1)]
    """(n, n), symmetric, without negative eigenvalues."""
    damping: Matrix | None = None
    """(n, n), its symmetric part without negative eigenvalues; left out: none."""
    interfaces: tuple[Interface3D, ...] = ()
    """Where others can be attached."""
    position: Vector3 = (0.0, 0.0, 0.0)
    """Where the frame's origin starts, m."""
    velocity: Vector3 = (0.0, 0.0, 0.0)
    """Initial velocity of the frame's origin, m/s."""
    attitude: Attitude = UPRIGHT
    """Initial attitude of the frame."""
    angular_velocity: Vector3 = (0.0, 0.0, 0.0)
    """Initial angular velocity of the frame, rad/s, in the axes that `angular_velocity_in` names."""
    angular_velocity_in: Literal["body", "space"] = "body"
    """Axes of `angular_velocity`: those of the frame, or of space."""
    amplitudes: Vector | None = None
    """Initial modal amplitudes; left out: zero."""
    amplitude_rates: Vector | None = None
    """Their initial rates, 1/s; left out: zero."""

    @model_validator(mode="before")
    @classmethod
    def _from_file(cls, data: Any) -> Any:
        """`"arrays": "bar.npz"` in place of fields: those are the arrays of this file."""
        return arrays_from_file(data, cls)

    @classmethod
    def __get_pydantic_json_schema__(cls, core_schema: CoreSchema, handler: GetJsonSchemaHandler) -> dict[str, Any]:
        schema = super().__get_pydantic_json_schema__(core_schema, handler)
        or_arrays(handler.resolve_ref_schema(schema), IN_FILE)
        return schema

    def save_arrays(self, path: str | Path) -> None:
        """Write the arrays to a file (.npz), which a model file can then name under "arrays"."""
        places = {place.name: place.model_dump(exclude={"name"}, exclude_none=True) for place in self.interfaces}
        fields = {name: getattr(self, name) for name in IN_FILE if getattr(self, name) is not None}
        parts = {f"interfaces.{name}.{part}": x for name, place in places.items() for part, x in place.items()}
        arrays: dict[str, Any] = {name: np.array(x) for name, x in {**fields, **parts}.items()}
        np.savez(path, **arrays)

    @model_validator(mode="after")
    def _check(self) -> "ReducedBody3D":
        n = len(self.stiffness)
        sizes: dict[str, tuple[int, ...]] = {
            "stiffness": (n, n), "damping": (n, n), "modal_first_moment": (n, 3), "modal_moment": (n, 3, 3),
            "modal_second_moment": (n, n, 3, 3), "amplitudes": (n,), "amplitude_rates": (n,),
        }  # fmt: skip
        rows = f"stiffness has n = {n}"
        for name, size in sizes.items():
            check_size(self.name, name, getattr(self, name), size, rows)
        for place in self.interfaces:
            check_size(self.name, f"shape of the interface '{place.name}'", place.shape, (n, 3), rows)
            check_size(self.name, f"rotation of the interface '{place.name}'", place.rotation, (n, 3), rows)
        names = [place.name for place in self.interfaces]
        if len(set(names)) < len(names):
            raise ValueError(f"interfaces of '{self.name}' need names of their own: {names}")
        both = np.array(self.modal_second_moment)
        check_symmetry(self.name, "second_moment", np.array(self.second_moment))
        check_symmetry(self.name, "stiffness", np.array(self.stiffness))
        check_symmetry(self.name, "modal_second_moment", both.transpose(0, 2, 1, 3).reshape(3 * n, 3 * n))
        check_mass(self.name, self.mass_matrix())
        check_sign(self.name, "stiffness", self.stiffness, "no strain has negative energy")
        check_sign(self.name, "damping", self.damping, "it would put energy in")
        return self

    def mode_names(self) -> tuple[str, ...]:
        """Names of the amplitudes."""
        return tuple(f"mode{k + 1}" for k in range(len(self.stiffness)))

    def mass_matrix(self) -> Array:
        """Of the undeformed body in (velocity, angular velocity, amplitudes' rates), (6 + n, 6 + n)."""
        n = len(self.stiffness)
        h, own, rows = np.array(self.first_moment), np.array(self.second_moment), np.array(self.modal_first_moment)
        full = np.zeros((6 + n, 6 + n))
        full[:3, :3] = self.mass * np.eye(3)
        full[3:6, :3] = _skew(h)
        full[3:6, 3:6] = np.trace(own) * np.eye(3) - own
        full[6:, :3] = rows
        full[6:, 3:6] = _axis(np.array(self.modal_moment))
        full = full + np.tril(full, -1).T
        full[6:, 6:] = np.einsum("klii->kl", np.array(self.modal_second_moment))
        return full

    def interface(self, name: str) -> Interface3D:
        """The interface of this name. Raises ModelError if there is none."""
        for place in self.interfaces:
            if place.name == name:
                return place
        raise ModelError(f"'{self.name}' has no interface '{name}'; it has {[place.name for place in self.interfaces]}")

    def marker_at(self, point: Vector3, attitude: Attitude = UPRIGHT) -> Marker3D:
        """The marker on the frame that is at `point` (m) with `attitude` in space where the body starts."""
        return marker_on(self, point, attitude)

    def extent(self) -> Sequence[tuple[float, ...]]:
        return (self.position, *(tuple(np.add(self.position, place.point).tolist()) for place in self.interfaces))

    def typical_mass(self) -> float:
        return self.mass

    def coordinate_records(self) -> Sequence[Coordinate]:
        return (X, Y, Z, *EULER, *(Coordinate(name, "m", f"d_{name}", f"dd_{name}") for name in self.mode_names()))

    def derived_channels(self, numbering: Numbering, rows: Sequence[int]) -> Sequence[Derived]:
        return (AngularVelocity(self.name, numbering.coordinates(self.name)[3:7]),)

    def initial_state(self) -> tuple[tuple[float, ...], tuple[float, ...]]:
        """(q0, v0)."""
        p, zero = self.attitude.parameters(), (0.0,) * len(self.stiffness)
        rates = parameter_rates(p, self.angular_velocity, self.angular_velocity_in)
        return (
            (*self.position, *p, *(self.amplitudes or zero)),
            (*self.velocity, *rates, *(self.amplitude_rates or zero)),
        )

    def form(self) -> Form:
        n = 7 + len(self.stiffness)
        apart = {(i, j) for i in range(3) for j in range(3) if i != j}
        pattern = tuple((i, j) for i in range(n) for j in range(n) if (i, j) not in apart)
        return Form(type(self).kernel, 1, pattern, tuple((0, j) for j in range(3, 7)))

    def row(self, numbering: Numbering) -> Row:
        n = len(self.stiffness)
        own, moment, both = (
            np.array(x) for x in (self.second_moment, self.modal_moment, self.modal_second_moment)
        )  # fmt: skip
        modes = np.concatenate([np.array(self.modal_first_moment), _axis(moment), _of_inertia(moment)], axis=1)
        pairs = np.concatenate([_of_inertia(both), _axis(both)], axis=2)
        tables = (
            [self.mass], self.first_moment, np.trace(own) * np.eye(3) - own, numbering.gravity, modes, pairs,
            np.einsum("klii->kl", both), self.stiffness, np.zeros((n, n)) if self.damping is None else self.damping,
        )  # fmt: skip
        parameters = np.concatenate([np.asarray(table, dtype=float).ravel() for table in tables])
        indices = tuple(numbering.coordinate(self.name, name) for name in self.coordinate_names)
        return Row(tuple(parameters.tolist()), indices, (numbering.work("dampers"),))


def _skew(u: Array) -> Array:
    """u~."""
    return np.array([[0.0, -u[2], u[1]], [u[2], 0.0, -u[0]], [-u[1], u[0], 0.0]])


def _axis(moment: Array) -> Array:
    """int a x b dm from int a b^T dm, over the last two indices."""
    return np.stack([moment[..., i, j] - moment[..., j, i] for i, j in ((1, 2), (2, 0), (0, 1))], axis=-1)


def _of_inertia(moment: Array) -> Array:
    """-int a~ b~ dm from int a b^T dm, row by row as the last index (9)."""
    trace = np.einsum("...ii->...", moment)[..., None, None]
    found: Array = trace * np.eye(3) - np.swapaxes(moment, -1, -2)
    return found.reshape(*moment.shape[:-2], 9)
