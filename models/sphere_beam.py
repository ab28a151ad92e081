"""Timoshenko's problem (1913): a sphere strikes a simply supported beam, with Hertz's contact between them."""

import math

import numpy as np

from ..core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from ..core.contacts.coordinate_contact import CoordinateContact, CoordinateTerm
from ..core.elements import Clamp2D, FloatingBeam2D, LinearSystem, MaterialPoint2D, PointMass2D
from ..core.laws import Hertz
from ..core.laws.stiffness import Material, sphere_on_plane
from ..core.model.markers import Marker2D
from ..core.multibody_model import Model
from .parameters import ScenarioParameter
from .registry import scenario
from .scenario import Scenario

PARAMETERS = (
    ScenarioParameter("formulation", "modes", "-", "of the beam: its modes alone, or a body in a floating frame",
                      choices=("modes", "floating")),
    ScenarioParameter("sphere_radius", 0.01, "m", "radius of the sphere", 0.0, exclusive=True),
    ScenarioParameter("speed", 0.01, "m/s", "of the sphere at the start, towards the beam", 0.0, exclusive=True),
    ScenarioParameter("beam_length", 0.1535, "m", "between the supports", 0.0, exclusive=True),
    ScenarioParameter("beam_side", 0.01, "m", "side of the beam's square section", 0.0, exclusive=True),
    ScenarioParameter("youngs_modulus", 2.1575e11, "Pa", "of sphere and beam", 0.0, exclusive=True),
    ScenarioParameter("poissons_ratio", 0.3, "-", "of sphere and beam, for the contact", 0.0, 0.5),
    ScenarioParameter("density", 7960.0, "kg/m^3", "of sphere and beam", 0.0, exclusive=True),
    ScenarioParameter("modes", 15, "-", "of the beam, those that move at midspan: 1, 3, 5 ...", 1, 200),
    ScenarioParameter("gap", 1e-6, "m", "between sphere and beam at the start", 0.0, exclusive=True),
)  # fmt: skip


@scenario("sphere_beam", "a sphere strikes a simply supported beam at midspan, Hertz contact", PARAMETERS)
def sphere_beam(
    *,
    formulation: str,
    sphere_radius: float,
    speed: float,
    beam_length: float,
    beam_side: float,
    youngs_modulus: float,
    poissons_ratio: float,
    density: float,
    modes: int,
    gap: float,
) -> Scenario:
    """Body `sphere`, a `beam` and contact `blow`.

    With formulation "modes" the beam's coordinate `deflection` is that of midspan, upwards. The others are the
    amplitudes of its modes from the second on: the first one's is what the deflection leaves, so that the gap depends
    on two coordinates whatever the number of modes. With "floating" the beam's frame is clamped to the ground, and the
    sphere strikes its point `midspan`; half of its modes stay at rest.
    """
    steel = Material(youngs_modulus=youngs_modulus, poisson_ratio=poissons_ratio)
    law = Hertz(stiffness=sphere_on_plane(sphere_radius, steel, steel))
    line_mass = density * beam_side**2
    bending_stiffness = youngs_modulus * beam_side**4 / 12.0
    sphere = PointMass2D(
        name="sphere", mass=density * 4.0 / 3.0 * math.pi * sphere_radius**3,
        position=(0.5 * beam_length, sphere_radius + gap), velocity=(0.0, -speed),
    )  # fmt: skip
    if formulation == "modes":
        model = Model(
            name="sphere_beam",
            gravity=(0.0, 0.0),
            bodies=(sphere, _modal_beam(modes, line_mass, beam_length, bending_stiffness)),
            contacts=(
                CoordinateContact(
                    name="blow",
                    offset=-sphere_radius,
                    terms=(
                        CoordinateTerm(body="sphere", coordinate="y"),
                        CoordinateTerm(body="beam", coordinate="deflection", factor=-1.0),
                    ),
                    law=law,
                ),
            ),
        )
    else:
        beam = FloatingBeam2D(
            name="beam", mass=line_mass * beam_length, length=beam_length, bending_stiffness=bending_stiffness,
            boundary_conditions="simply_supported", modes=2 * modes - 1,
        )  # fmt: skip
        midspan = MaterialPoint2D(name="midspan", body="beam", point=(0.5 * beam_length, 0.0))
        model = Model(
            name="sphere_beam",
            gravity=(0.0, 0.0),
            bodies=(sphere, beam, midspan),
            joints=(Clamp2D(name="supports", a=Marker2D(), b=Marker2D(body="beam")),),
            contacts=(
                DiskOnHalfPlane2D(
                    name="blow",
                    plane=HalfPlane2D(marker=Marker2D(body="midspan")),
                    disk=Disk2D(marker=Marker2D(body="sphere"), radius=sphere_radius),
                    law=law,
                ),
            ),
        )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=1.2 * beam_length**2 * 2.0 / math.pi * math.sqrt(line_mass / bending_stiffness) + gap / speed,
        atol=1e-10,  # the deepest penetration is half a micrometre
        compare=("sphere.y", "blow.normal_force", "blow.gap"),
    )


def _modal_beam(modes: int, line_mass: float, length: float, bending_stiffness: float) -> LinearSystem:
    """Modes 1, 3, 5 ... of a simply supported beam, with the deflection at midspan as first coordinate."""
    order = np.arange(1, 2 * modes, 2)
    mass = np.full(modes, 0.5 * line_mass * length)
    stiffness = 0.5 * bending_stiffness * length * (order * math.pi / length) ** 4
    # amplitudes of the modes = change . (deflection, amplitudes from the second on)
    change = np.eye(modes)
    change[0] = -np.sin(0.5 * math.pi * order)
    change[0, 0] = 1.0
    return LinearSystem(
        name="beam",
        coordinates=("deflection", *(f"mode{k}" for k in range(2, modes + 1))),
        mass=_reduce(mass, change),
        stiffness=_reduce(stiffness, change),
        units=("m",) * modes,
    )


def _reduce(diagonal: np.ndarray, change: np.ndarray) -> tuple[tuple[float, ...], ...]:
    """change^T diag(diagonal) change, symmetric to the last bit."""
    full = change.T @ (diagonal[:, None] * change)
    return tuple(tuple(float(x) for x in row) for row in 0.5 * (full + full.T))
