"""Random scenes of rigid bodies on more contacts than statics can tell the forces of, in the plane and in space.

A scene is drawn about the size of a metre on a horizontal floor. `turned` puts it into another attitude, `permuted`
lists its records in another order, and `units.Units` makes it smaller or larger.
"""

import json
from dataclasses import dataclass

import numpy as np
from dense_contacts import is_planar
from scene_kinds import PLANE, SPACE
from scipy.spatial.transform import Rotation
from tlismni.core import Model

METHODS = {"ebdf": 0.35, "irk": 0.25, "bdf": 0.15, "hht": 0.15, "adams": 0.1}


@dataclass
class Scene:
    """A model and how to run it."""

    seed: int
    kind: str
    model: Model
    method: str
    end: float
    """s."""


def scene(seed: int, dimension: int | None = None) -> Scene:
    """The scene of a seed, in the plane (`dimension` 2), in space (3), or in either."""
    rng = np.random.default_rng(seed)
    if dimension is None:
        dimension = int(rng.choice([2, 3]))
    kinds = PLANE if dimension == 2 else SPACE
    kind = str(rng.choice(list(kinds)))
    model = kinds[kind](rng)
    method = str(rng.choice(list(METHODS), p=list(METHODS.values())))
    return Scene(seed, f"{kind}{dimension}", model, method, float(rng.uniform(0.1, 0.3)))


def permuted(model: Model, rng: np.random.Generator) -> Model:
    """The model with its records in another order."""

    def mixed(records):
        return [records[int(i)] for i in rng.permutation(len(records))]

    return Model(
        gravity=model.gravity, bodies=mixed(model.bodies), joints=mixed(model.joints), forces=mixed(model.forces),
        contacts=mixed(model.contacts),
    )  # fmt: skip


def turned(model: Model, rng: np.random.Generator) -> Model:
    """The model with all of it, gravity and ground too, turned and moved."""
    data = json.loads(model.to_json())
    if is_planar(model):
        return Model.from_json(json.dumps(_Turned2D(rng).of(data)))
    return Model.from_json(json.dumps(_Turned3D(rng).of(data)))


class _Turned2D:
    def __init__(self, rng):
        self.angle, self.away = float(rng.uniform(-np.pi, np.pi)), rng.uniform(-1.0, 1.0, 2)

    def vector(self, value):
        c, s = np.cos(self.angle), np.sin(self.angle)
        return [c * value[0] - s * value[1], s * value[0] + c * value[1], *value[2:]]

    def place(self, value):
        return (self.away + np.array(self.vector(value))).tolist()

    def turn(self, found, key):
        found[key] += self.angle

    def of(self, data):
        data["gravity"] = self.vector(data["gravity"])
        for body in data["bodies"]:
            body["position"], body["velocity"] = self.place(body["position"]), self.vector(body["velocity"])
            self.turn(body, "angle" if "angle" in body else "attitude")
        for load in data["forces"]:
            if "force_x" in load:
                self._load(load, "force")
            elif "torque_x" in load:
                self._load(load, "torque")
        for record in data["joints"] + data["contacts"]:
            self._markers(record)
        return data

    def _load(self, load, what):
        names = [f"{what}_{axis}" for axis in "xyz" if f"{what}_{axis}" in load]
        for name, value in zip(names, self.vector([load[name]["value"] for name in names]), strict=True):
            load[name]["value"] = value

    def _markers(self, value):
        if isinstance(value, dict):
            if value.get("body") == "ground" and "point" in value:
                value["point"] = self.place(value["point"])
                self.turn(value, "angle" if "angle" in value else "attitude")
            else:
                for part in value.values():
                    self._markers(part)


class _Turned3D(_Turned2D):
    def __init__(self, rng):
        self.rotation, self.away = Rotation.random(random_state=int(rng.integers(2**31))), rng.uniform(-1.0, 1.0, 3)

    def vector(self, value):
        return self.rotation.apply(value).tolist()

    def turn(self, found, key):
        """Attitudes are Euler parameters (e0, e) in what a model writes, or axes."""
        given = found[key]
        if given["type"] == "Axes":
            found[key] = {**given, "z": self.vector(given["z"]), "x": self.vector(given["x"])}
            return
        e0, *e = given["values"]
        x, y, z, w = (self.rotation * Rotation.from_quat([*e, e0])).as_quat()
        found[key] = {"type": "EulerParameters", "values": [w, x, y, z]}
