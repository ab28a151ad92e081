"""The model: bodies, joints, forces, contacts, inputs and parameters as frozen data, with a JSON round trip."""

import json
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from numbers import Real
from pathlib import Path
from typing import Any, Literal

from pydantic import ConfigDict, model_validator

from .contacts import Contact
from .contacts.groups import Group, with_groups
from .elements import Body, BodyElement, Element, Force, Joint
from .errors import ModelError
from .model.array_files import beside
from .model.base import Gravity, Record
from .model.channels import Formula, Input, Parameter
from .model.files import is_yaml, read_json, read_yaml, with_lines, write_yaml
from .model.given_numbers import GRAVITY, RECORD_LISTS, STANDARD_GRAVITY, with_given_numbers
from .model.markers import GROUND, Marker
from .model.open_union import meaning
from .model.outputs import MarkerOutput
from .model.own_types import find_classes, import_paths, own_classes
from .model.places import inside
from .model.signals import InputSignal
from .model.words import an


def _with_imports(schema: dict[str, Any]) -> None:
    schema["properties"]["imports"] = {
        "type": "object",
        "additionalProperties": {"type": "string"},
        "description": "Where own classes of the model can be imported from: type to 'module:Class'",
    }


class Model(Record):
    """A multibody model: pure data.

    Examples
    --------
    >>> from tlismni.core import Model, PointMass2D
    >>> ball = Model(name="ball", bodies=[PointMass2D(name="ball", mass=1.0, position=(0.0, 1.0))])
    >>> Model.from_json(ball.to_json()) == ball
    True
    """

    model_config = ConfigDict(json_schema_extra=_with_imports)

    format: Literal["tlismni-model-1"] = "tlismni-model-1"
    """Which edition of this format the file is in."""
    name: str = "model"
    """Name of the model."""
    description: str = ""
    """What it is, in words."""
    gravity: Gravity = STANDARD_GRAVITY
    """Of two components, the third is zero; m/s^2."""
    bodies: tuple[Body, ...] = ()
    """What has mass, and frames without."""
    joints: tuple[Joint, ...] = ()
    """What holds or drives them."""
    forces: tuple[Force, ...] = ()
    """What acts on them."""
    contacts: tuple[Contact, ...] = ()
    """Where they may touch."""
    groups: tuple[Group, ...] = ()
    """Shapes of which each may touch each other; their contacts are made of them."""
    inputs: tuple[Input, ...] = ()
    """Numbers that come from outside during a run."""
    outputs: tuple[MarkerOutput, ...] = ()
    """Markers whose motion is shown beside what bodies, joints and contacts show by themselves."""
    parameters: tuple[Parameter, ...] = ()
    """Numbers that may be set before a run, by name."""
    formulas: tuple[Formula, ...] = ()
    """Numbers that follow from parameters."""

    @model_validator(mode="before")
    @classmethod
    def _give_numbers(cls, data: Any) -> Any:
        return with_groups(with_given_numbers(data)) if isinstance(data, Mapping) else data

    @model_validator(mode="after")
    def _check(self) -> "Model":
        names = [e.name for e in self.elements()] + [i.name for i in self.inputs] + [o.name for o in self.outputs]
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise ValueError(f"names must be unique in a model; used more than once: {twice}")
        reserved = {GROUND, "energy", "residual", "time"} & set(names)
        if reserved:
            raise ValueError(f"{sorted(reserved)} are reserved names: choose others")
        bodies = {body.name: body for body in self.bodies}
        inputs = {i.name for i in self.inputs}
        for element in self.elements():
            element.check_in(bodies)
            for marker in element.markers():
                self._check_marker(element.name, marker, bodies)
            for name in element.felt_joints():
                self._check_joint(element, name)
            for name, coordinate in element.moved_coordinates():
                self._check_coordinate(element, self._find(element.name, name, bodies), coordinate)
            for signal in element.signals():
                for channel in signal.channels():
                    if channel not in inputs:
                        raise ValueError(
                            f"'{element.name}' uses input channel '{channel}', which is not declared in inputs; "
                            f"declared are {sorted(inputs)}"
                        )
                if isinstance(signal, InputSignal) and signal.rate is not None and not element.motions():
                    raise ValueError(
                        f"'{element.name}' names a rate channel '{signal.rate}' for its input '{signal.channel}', but "
                        "only motions have a velocity: leave `rate` out"
                    )
        for output in self.outputs:
            self._check_marker(output.name, output.marker, bodies)
        for parameter in self.parameters:
            for target in parameter.targets:
                self._number_at(f"parameter '{parameter.name}'", target)
            parameter.refuse_outside(self.parameter_value(parameter.name))
        for formula in self.formulas:
            self._number_at(f"formula '{formula.formula}'", formula.target)
        return self

    def _number_at(self, who: str, target: str) -> float:
        value, name = self._value_at(target), target.partition(".")[0]
        owner = next((g.name for g in self.groups if name in {c.name for c in g.contacts()}), None)
        if owner is not None:
            raise ValueError(f"{who}: '{name}' is a contact of group '{owner}': set the number in the group")
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"{who}: '{target}' holds {value!r}, which is no number")
        return value

    @classmethod
    def _check_marker(cls, user: str, marker: Marker, bodies: Mapping[str, BodyElement]) -> None:
        body = cls._find(user, marker.body, bodies)
        if body is not None:
            body.check_marker(user, marker)

    def _check_joint(self, element: Element, name: str) -> None:
        joint = next((joint for joint in self.joints if joint.name == name), None)
        if joint is None:
            raise ValueError(
                f"'{element.name}' feels the force of joint '{name}', which does not exist; joints are "
                f"{sorted(joint.name for joint in self.joints)}"
            )
        if not joint.force_rows():
            raise ValueError(
                f"'{element.name}' feels the force of '{name}', but {an(type(joint).__name__)} says no force between "
                "its bodies: name a revolute, spherical, cylindrical or prismatic joint"
            )

    @staticmethod
    def _find(user: str, name: str, bodies: Mapping[str, BodyElement]) -> BodyElement | None:
        """The body `name`, None for the ground."""
        if name != GROUND and name not in bodies:
            raise ValueError(
                f"'{user}' refers to body '{name}', which does not exist; bodies are {sorted(bodies)} and '{GROUND}'"
            )
        return bodies.get(name)

    @staticmethod
    def _check_coordinate(element: Element, body: BodyElement | None, coordinate: str) -> None:
        if body is None:
            raise ValueError(f"'{element.name}' acts on coordinate '{coordinate}' of the ground, which does not move")
        if coordinate not in body.coordinate_names:
            raise ValueError(
                f"'{element.name}' acts on coordinate '{coordinate}' of '{body.name}', but {an(type(body).__name__)} "
                f"has only {list(body.coordinate_names[:12])}: use a RigidBody2D, or another coordinate"
            )

    def elements(self) -> Iterator[Element]:
        """All elements in the order bodies, joints, forces, contacts."""
        yield from self.bodies
        yield from self.joints
        yield from self.forces
        yield from self.contacts

    def _value_at(self, target: str) -> Any:
        name, *fields = target.split(".")
        named: dict[str, Any] = {group.name: group for group in self.groups} | {e.name: e for e in self.elements()}
        found: Any = named.get(name, self.gravity if name == GRAVITY else None)
        if found is None or not fields:
            raise ValueError(f"parameter target '{target}' must be 'element.field', with the name of an element")
        for field in fields:
            found = inside(found, field, target)
        return found

    def parameter_value(self, name: str) -> float:
        """Present value of the parameter `name`. Raises ModelError for an unknown name."""
        parameter = self._parameter(name)
        return float(self._value_at(parameter.targets[0]) if parameter.value is None else parameter.value)

    def _parameter(self, name: str) -> Parameter:
        for parameter in self.parameters:
            if parameter.name == name:
                return parameter
        if name in {record.name for record in self.inputs}:
            raise ModelError(
                f"'{name}' is an input of model '{self.name}', not a parameter: give it in `inputs` of simulate, or "
                f"--input {name}=VALUE"
            )
        raise ModelError(f"model '{self.name}' has no parameter '{name}'; it has {[p.name for p in self.parameters]}")

    def _place(self, target: str) -> Parameter:
        """What stands for the number at `target`."""
        try:
            self._number_at(f"parameter '{target}'", target)
        except ValueError as error:
            raise ModelError(str(error)) from None
        for formula in self.formulas:
            if formula.target == target:
                raise ModelError(
                    f"'{target}' follows from the formula '{formula.formula}': set the parameters in it, or take the "
                    "formula out of the model"
                )
        for parameter in self.parameters:
            if parameter.value is not None and target in parameter.targets:
                return parameter
        return Parameter.model_construct(name=target, targets=(target,))

    def with_parameters(self, values: Mapping[str, float]) -> "Model":
        """The same model with other parameter values; what follows from them by formulas follows. Numbers that no
        parameter stands for go by their place, as in `Parameter.targets` ("ball.mass").

        Raises
        ------
        ModelError : for an unknown name, a value outside the parameter's or the field's range, a place that a formula
            sets.
        """
        data = self.model_dump(mode="json")
        elements = {e["name"]: e for kind in RECORD_LISTS for e in data[kind]}
        declared = {p["name"]: p for p in data["parameters"]}
        for name, value in values.items():
            parameter = self._place(name) if "." in name else self._parameter(name)
            if isinstance(value, bool) or not isinstance(value, Real):
                raise ModelError(f"parameter '{name}' = {value!r}: a number is needed")
            try:
                parameter.refuse_outside(value)
            except ValueError as error:
                raise ModelError(str(error)) from None
            if parameter.value is not None:
                declared[parameter.name]["value"] = float(value)
            for target in parameter.targets:
                element, *path, last = target.split(".")
                record = elements.get(element, data[GRAVITY] if element == GRAVITY else None)
                for field in path:
                    record = record[int(field) if isinstance(record, list) else field]
                record[int(last) if isinstance(record, list) else last] = float(value)
        with meaning(own_classes(self)):
            return Model(**data)

    def to_json(self) -> str:
        """The model as JSON text. Own classes are named under `imports`, where they can be imported from."""
        made = {contact.name for group in self.groups for contact in group.contacts()}
        kept = tuple(contact for contact in self.contacts if contact.name not in made)  # groups make theirs anew
        bare = self.model_copy(update={"contacts": kept}) if made else self
        text, imports = bare.model_dump_json(indent=2), import_paths(self)
        if not imports:
            return text
        return f'{{\n  "imports": {json.dumps(imports)},{text[1:]}'

    @classmethod
    def from_json(cls, text: str | bytes, *, allow_imports: bool | Collection[str] = False) -> "Model":
        """The model in a JSON text.

        Parameters
        ----------
        allow_imports : names of modules that may be imported for own classes in it, with all that is in these
            packages; True for any. To import a module runs its code.

        Raises
        ------
        ModelError : with the place and the cause if it is none, or needs what may not be imported.
        """
        return cls._from_data(read_json(text), "JSON object", allow_imports)

    @classmethod
    def from_yaml(cls, text: str | bytes, *, allow_imports: bool | Collection[str] = False) -> "Model":
        """The model in a YAML text, which may hold comments. The rest is as for `from_json`."""
        return cls._from_data(read_yaml(text), "YAML mapping", allow_imports)

    @classmethod
    def _from_data(cls, data: Any, kind: str, allow_imports: bool | Collection[str]) -> "Model":
        if not isinstance(data, dict):
            raise ModelError(f"a model file holds one {kind}, not {type(data).__name__}")
        with meaning(find_classes(data.pop("imports", {}), allow_imports)):
            return cls(**data)

    def save(self, path: str | Path) -> None:
        """Write the model file: YAML if its name ends with .yaml or .yml, else JSON."""
        text = write_yaml(json.loads(self.to_json())) if is_yaml(path) else self.to_json()
        Path(path).write_text(text, encoding="utf-8")

    @classmethod
    def load(cls, path: str | Path, *, allow_imports: bool | Collection[str] = False) -> "Model":
        """Read a model file, JSON or (.yaml, .yml) YAML; `allow_imports` as in `from_json`. Raises ModelError if it
        cannot be read or is no model, with the lines."""
        try:
            text = Path(path).read_bytes()
        except OSError as error:
            raise ModelError(f"model file '{path}' cannot be read: {error.strerror or error}") from None
        try:
            with beside(path):
                return (cls.from_yaml if is_yaml(path) else cls.from_json)(text, allow_imports=allow_imports)
        except ModelError as error:
            raise ModelError(f"model file '{path}': {with_lines(error, text)}", error.problems) from None

    def assemble(self, start: Mapping[str, float] | None = None, t0: float = 0.0) -> Any:
        """The model as flat tables (`Assembly`); `start` are other values at the start t0, s, see there."""
        from .assembly.assembly import assemble

        return assemble(self, start or {}, t0)

    def identity(self) -> str:
        """What makes this model the same as another: its JSON."""
        return self.model_dump_json()

    def coordinate_channels(self, assembly: Any, layout: Any) -> Any:
        """Channels of the bodies' coordinates."""
        from .assembly.sample_layout import body_coordinate_channels

        return body_coordinate_channels(assembly, layout)
