"""The model: bodies, joints, forces, contacts, inputs and parameters as frozen data, with a JSON round trip."""

import json
from collections import Counter
from collections.abc import Collection, Iterator, Mapping
from numbers import Real
from pathlib import Path
from typing import Any, Literal

from pydantic import ConfigDict, model_validator

from .elements import Body, BodyElement, Element, Force, Joint
from .errors import ModelError
from .model.base import Gravity, Record
from .model.channels import Input, Parameter
from .model.markers import GROUND, Marker
from .model.open_union import meaning
from .model.outputs import MarkerOutput
from .model.own_types import find_classes, import_paths, own_classes
from .model.signals import InputSignal
from .shapes import Contact


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
    name: str = "model"
    description: str = ""
    gravity: Gravity = (0.0, -9.81, 0.0)
    """m/s^2; of two components, the third is zero."""
    bodies: tuple[Body, ...] = ()
    joints: tuple[Joint, ...] = ()
    forces: tuple[Force, ...] = ()
    contacts: tuple[Contact, ...] = ()
    inputs: tuple[Input, ...] = ()
    outputs: tuple[MarkerOutput, ...] = ()
    """Markers whose motion is shown beside what bodies, joints and contacts show by themselves."""
    parameters: tuple[Parameter, ...] = ()

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
            parameter.refuse_outside(self._number_at(parameter, parameter.targets[0]))
            for target in parameter.targets[1:]:
                self._number_at(parameter, target)
        return self

    def _number_at(self, parameter: Parameter, target: str) -> float:
        value = self._value_at(target)
        if isinstance(value, bool) or not isinstance(value, int | float):
            raise ValueError(f"parameter '{parameter.name}': '{target}' holds {value!r}, which is no number")
        return value

    @classmethod
    def _check_marker(cls, user: str, marker: Marker, bodies: Mapping[str, BodyElement]) -> None:
        body = cls._find(user, marker.body, bodies)
        if body is not None:
            body.check_marker(user, marker)

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
                f"'{element.name}' acts on coordinate '{coordinate}' of '{body.name}', but a {type(body).__name__} has "
                f"only {list(body.coordinate_names[:12])}: use a RigidBody2D, or another coordinate"
            )

    def elements(self) -> Iterator[Element]:
        """All elements in the order bodies, joints, forces, contacts."""
        yield from self.bodies
        yield from self.joints
        yield from self.forces
        yield from self.contacts

    def _value_at(self, target: str) -> Any:
        name, *fields = target.split(".")
        found = {e.name: e for e in self.elements()}.get(name)
        if found is None or not fields:
            raise ValueError(f"parameter target '{target}' must be 'element.field', with the name of an element")
        value: Any = found
        for field in fields:
            if not isinstance(value, Record) or field not in type(value).model_fields:
                raise ValueError(f"parameter target '{target}': there is no field '{field}' in {type(value).__name__}")
            value = getattr(value, field)
        return value

    def parameter_value(self, name: str) -> float:
        """Present value of the parameter `name`. Raises ModelError for an unknown name."""
        return float(self._value_at(self._parameter(name).targets[0]))

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
        parameter = Parameter.model_construct(name=target, targets=(target,))
        try:
            self._number_at(parameter, target)
        except ValueError as error:
            raise ModelError(str(error)) from None
        return parameter

    def with_parameters(self, values: Mapping[str, float]) -> "Model":
        """The same model with other parameter values. Numbers that no parameter stands for go by their place, as in
        `Parameter.targets` ("ball.mass").

        Raises
        ------
        ModelError : for an unknown name, or a value outside the parameter's or the field's range.
        """
        data = self.model_dump(mode="json")
        elements = {e["name"]: e for kind in ("bodies", "joints", "forces", "contacts") for e in data[kind]}
        for name, value in values.items():
            parameter = self._place(name) if "." in name else self._parameter(name)
            if isinstance(value, bool) or not isinstance(value, Real):
                raise ModelError(f"parameter '{name}' = {value!r}: a number is needed")
            try:
                parameter.refuse_outside(value)
            except ValueError as error:
                raise ModelError(str(error)) from None
            for target in parameter.targets:
                element, *path, last = target.split(".")
                record = elements[element]
                for field in path:
                    record = record[field]
                record[last] = float(value)
        with meaning(own_classes(self)):
            return Model(**data)

    def to_json(self) -> str:
        """The model as JSON text. Own classes are named under `imports`, where they can be imported from."""
        text, imports = self.model_dump_json(indent=2), import_paths(self)
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
        try:
            data = json.loads(text)
        except (ValueError, UnicodeDecodeError) as error:
            raise ModelError(f"this is not JSON: {error}") from None
        if not isinstance(data, dict):
            raise ModelError(f"a model file holds one JSON object, not {type(data).__name__}")
        with meaning(find_classes(data.pop("imports", {}), allow_imports)):
            return cls(**data)

    def save(self, path: str | Path) -> None:
        """Write the model file."""
        Path(path).write_text(self.to_json(), encoding="utf-8")

    @classmethod
    def load(cls, path: str | Path, *, allow_imports: bool | Collection[str] = False) -> "Model":
        """Read a model file; `allow_imports` as in `from_json`. Raises ModelError if it cannot be read or is no
        model."""
        try:
            text = Path(path).read_bytes()
        except OSError as error:
            raise ModelError(f"model file '{path}' cannot be read: {error.strerror or error}") from None
        try:
            return cls.from_json(text, allow_imports=allow_imports)
        except ModelError as error:
            raise ModelError(f"model file '{path}': {error}") from None

    def assemble(self) -> Any:
        """The model as flat tables (`Assembly`)."""
        from .tables.assembly import assemble

        return assemble(self)

    def identity(self) -> str:
        """What makes this model the same as another: its JSON."""
        return self.model_dump_json()

    def coordinate_channels(self, assembly: Any, layout: Any) -> Any:
        """Channels of the bodies' coordinates."""
        from .tables.sample_layout import body_coordinate_channels

        return body_coordinate_channels(assembly, layout)
