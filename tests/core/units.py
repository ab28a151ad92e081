"""A model in other units: every number of its data times what its dimension makes of other units of length, mass, time.

`length` is how many new units of length a metre has (1e3: mm), and so on; `Units(length=1e-9)` makes a mechanism of a
metre one of a nanometre, as numbers in m: to the solver that is the same.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from tlismni.core import Model

POSITION, SPEED, FORCE = (1, 0, 0), (1, 0, -1), (1, 1, -2)
# (length, mass, time) of fields that mean the same everywhere
DIMENSIONS: dict[str, tuple[float, float, float]] = {
    "width": POSITION, "vertices": POSITION,
    "gravity": (1, 0, -2), "point": POSITION, "radius": POSITION, "length": POSITION, "natural_length": POSITION,
    "thickness": POSITION, "height": POSITION, "angular_velocity": (0, 0, -1), "mass": (0, 1, 0), "inertia": (2, 1, 0),
    "stiffness": (0, 1, -2), "damping": (0, 1, -1), "rotational_stiffness": (2, 1, -2),
    "rotational_damping": (2, 1, -1), "mass_per_length": (-1, 1, 0), "axial_stiffness": FORCE,
    "bending_stiffness": (3, 1, -2), "bending_damping": (3, 1, -1), "axial_damping": (1, 1, -1),
    "reference_curvature": (-1, 0, 0), "rotary_inertia": (1, 1, 0), "damping_time": (0, 0, 1),
    "minimum_approach_speed": SPEED, "stribeck_speed": SPEED, "transition_speed": SPEED, "lower_speed": SPEED,
    "surface_speed": SPEED, "upper_speed": SPEED, "stiction_speed": SPEED, "sliding_speed": SPEED,
    "bristle_stiffness": (0, 1, -2), "bristle_damping": (0, 1, -1), "viscous_damping": (0, 1, -1),
}  # fmt: skip
# of those that need the record's type
OWN: dict[tuple[str, str], tuple[float, float, float]] = {
    ("attachment", "position"): POSITION,
}  # fmt: skip
BODIES = ("PointMass2D", "RigidBody2D", "RigidBody3D", "MovingFrame2D", "Cable2D", "FloatingBeam2D", "AxialRod")
SIGNALS = ("force_x", "force_y", "force_z", "torque", "torque_x", "torque_y", "torque_z", "motion", "load")
LOADS = {
    "AppliedForce2D": FORCE, "AppliedForce3D": FORCE, "AppliedTorque2D": (2, 1, -2), "AppliedTorque3D": (2, 1, -2),
}  # fmt: skip
COORDINATES = {"angle": (0, 0, 0), "rotation": (0, 0, 0)}


@dataclass(frozen=True)
class Units:
    """New units in an old one."""

    length: float = 1.0
    mass: float = 1.0
    time: float = 1.0

    def factor(self, dimension: tuple[float, float, float]) -> float:
        l, m, t = dimension
        return self.length**l * self.mass**m * self.time**t

    def of(self, unit: str) -> float:
        """Factor of a channel's unit."""
        parts = {"m": POSITION, "rad": (0, 0, 0), "1": (0, 0, 0), "-": (0, 0, 0), "N": FORCE, "J": (2, 1, -2),
                 "W": (2, 1, -3), "s": (0, 0, 1), "kg": (0, 1, 0)}  # fmt: skip
        found = 1.0
        numerator, _, denominator = unit.partition("/")
        for part in numerator.split("."):
            found *= self.factor(parts[part])
        if denominator:
            power = int(denominator[-1]) if denominator[-1].isdigit() else 1
            found /= self.factor(parts[denominator.rstrip("0123456789")]) ** power
        return found

    def model(self, model: Model) -> Model:
        """The model in the new units."""
        data = json.loads(model.to_json())
        data["parameters"] = []
        units: dict[str, dict[str, tuple[float, float, float]]] = {}
        for body in data["bodies"]:
            if body["type"] == "LinearSystem":
                names = body["coordinates"]
                known = {"x": "m", "y": "m", "angle": "rad"}
                given = body.get("units") or [known.get(name, "-") for name in names]
                units[body["name"]] = {
                    n: (0, 0, 0) if u in ("rad", "1") else POSITION for n, u in zip(names, given, strict=True)
                }
        return Model.from_json(json.dumps({k: self._scaled(k, v, units, data) for k, v in data.items()}))

    def _scaled(self, key: str, value: Any, units: Mapping[str, Any], data: Any) -> Any:
        if key == "gravity":
            return self._times(value, (1, 0, -2))
        if key == "inputs":
            return [{**one, "start": one["start"] * self.of(one["unit"])} for one in value]
        if key in ("bodies", "joints", "forces", "contacts", "outputs"):
            return [self._element(element, units) for element in value]
        return value

    def _element(self, element: dict[str, Any], units: Mapping[str, Any]) -> dict[str, Any]:
        kind = element["type"] if "type" in element else ""
        if kind == "LinearSystem":
            return self._linear_system(element, units[element["name"]])
        if kind == "CoordinateContact":
            return self._coordinate_contact(element, units)
        signal = LOADS.get(kind, POSITION)
        if kind in ("CoordinateDriver", "CoordinateLoad"):
            own = units.get(element["body"], {}).get(element["coordinate"], COORDINATES.get(element["coordinate"]))
            own = POSITION if own is None else own
            signal = own if kind == "CoordinateDriver" else (2 - own[0], 1, -2)
        return {k: self._field(kind, k, v, signal) for k, v in element.items()}

    def _field(self, kind: str, key: str, value: Any, signal: tuple[float, float, float]) -> Any:
        if isinstance(value, dict):
            if "type" in value and key in SIGNALS:
                return self._signal(value, signal)
            if key == "surface_speed":
                return self._signal(value, SPEED)
            inner = value.get("type", key)
            if key == "law":
                return self._law(value)
            return {k: self._field(inner, k, v, signal) for k, v in value.items()}
        if isinstance(value, list) and value and isinstance(value[0], dict):
            inner = "attachment" if key == "attachments" else key
            return [{k: self._field(inner, k, v, signal) for k, v in item.items()} for item in value]
        if key == "velocity" or (key == "position" and kind in (*BODIES, "attachment")):
            return self._times(value, SPEED if key == "velocity" else POSITION)
        dimension = OWN.get((kind, key), DIMENSIONS.get(key))
        return value if dimension is None else self._times(value, dimension)

    def _times(self, value: Any, dimension: tuple[float, float, float]) -> Any:
        if value is None or isinstance(value, str):
            return value
        if isinstance(value, list):
            return [self._times(v, dimension) for v in value]
        return value * self.factor(dimension)

    def _law(self, law: dict[str, Any]) -> dict[str, Any]:
        found = {k: self._field(law["type"], k, v, FORCE) for k, v in law.items()}
        if "exponent" in law and "stiffness" in law:
            found["stiffness"] = self._times(law["stiffness"], (1 - law["exponent"], 1, -2))
        return found

    def _signal(self, signal: dict[str, Any], dimension: tuple[float, float, float]) -> dict[str, Any]:
        found = dict(signal)
        for key in ("value", "before", "after", "amplitude", "offset", "values"):
            if key in found:
                found[key] = self._times(found[key], dimension)
        for key in ("start", "duration", "time", "times"):
            if key in found:
                found[key] = self._times(found[key], (0, 0, 1))
        if "angular_frequency" in found:
            found["angular_frequency"] = self._times(found["angular_frequency"], (0, 0, -1))
        if "coefficients" in found:
            l, m, t = dimension
            found["coefficients"] = [self._times(c, (l, m, t - k)) for k, c in enumerate(found["coefficients"])]
        return found

    def _linear_system(self, element: dict[str, Any], own: dict[str, tuple[float, float, float]]) -> dict[str, Any]:
        """M, C, K make energies with the coordinates, whatever these are."""
        found, lengths = dict(element), [own[name][0] for name in element["coordinates"]]
        found["scales"] = [
            self.factor((l, 0, 0)) * s for l, s in zip(lengths, element["scales"] or [1.0] * len(lengths), strict=True)
        ]
        for key, time in (("mass", 0), ("damping", -1), ("stiffness", -2)):
            if element[key] is not None:
                found[key] = [
                    [self._times(x, (2 - a - b, 1, time)) for x, b in zip(row, lengths, strict=True)]
                    for row, a in zip(element[key], lengths, strict=True)
                ]
        for key, of in (("position", (1, 0, 0)), ("velocity", (1, 0, -1)), ("force", (-1, 1, -2))):
            if element[key] is not None:
                extra = 2 if key == "force" else 0
                found[key] = [
                    self._times(x, (extra + of[0] * a, of[1], of[2]))
                    for x, a in zip(element[key], lengths, strict=True)
                ]
        return found

    def _coordinate_contact(self, element: dict[str, Any], units: Mapping[str, Any]) -> dict[str, Any]:
        """Its gap is a length if any of its coordinates is one, or has factors that make it one."""
        found = {k: self._field("CoordinateContact", k, v, FORCE) for k, v in element.items()}
        found["offset"] = self._times(element["offset"], POSITION)

        def scaled(term: dict[str, Any]) -> dict[str, Any]:
            own = units.get(term["body"], {}).get(term["coordinate"], COORDINATES.get(term["coordinate"], POSITION))
            return {**term, "factor": self._times(term["factor"], (1 - own[0], 0, 0))}

        found["terms"] = [scaled(term) for term in element["terms"]]
        found["slide"] = [scaled(term) for term in element["slide"]]
        return found
