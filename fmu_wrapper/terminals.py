"""terminalsAndIcons.xml of FMI 3.0: the icon, and where forces and motions go in and come out.

A flange is where one load or driver of the model is an input: its members are that input, and what belongs to it of
the body's motion and forces. The members of a flange that takes a force and gives the motion have the same names as
those of one that takes the motion and gives the force, so that the rule "bus" (members of one name are connected)
couples the two; both are of the kind `tlismni.flange`.

Motions are signals: equal on both sides. Forces are flows, whose sum at a connection is zero: a force that the flange
takes flows in (`inflow`), the force that it gives is that which leaves through it (`outflow`), so that the two numbers
are equal, too.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, TypeGuard

import numpy as np

from ..core.elements import (
    AngleDriver3D,
    AppliedForce2D,
    AppliedForce3D,
    AppliedTorque2D,
    AppliedTorque3D,
    CoordinateDriver,
    CoordinateLoad,
    MovingFrame2D,
    PositionDriver3D,
)
from ..core.model.signals import InputSignal
from ..core.multibody_model import Model
from .description_parts import add
from .variables import VariableTable

KIND = "tlismni.flange"
FORCES = {"x": "force_x", "y": "force_y", "angle": "torque"}
"""Name of the force on a coordinate."""


@dataclass(frozen=True)
class Terminal:
    """A flange: its kind, its members with the names of their variables, and those among them that are forces, with
    "inflow" or "outflow"."""

    name: str
    kind: str
    description: str
    members: dict[str, str]
    flows: dict[str, str]


def terminals(model: Model, table: VariableTable) -> list[Terminal]:
    """The flanges of an FMU, in the order of the model's elements."""
    found = []
    for element in model.elements():
        flange = _flange(model, element)
        if flange is None:
            continue
        members = flange.members | dict(_motion(model, flange))
        members = {member: variable for member, variable in members.items() if variable in table.by_name}
        what = "takes the motion, gives the force" if flange.takes == "motion" else "takes the force, gives the motion"
        text = f"{element.name} on {flange.body}: {what}"
        way = "outflow" if flange.takes == "motion" else "inflow"
        flows = {member: way for member in members if _is_force(member)}
        found.append(Terminal(element.name, KIND, text, members, flows))
    return found


def _is_force(member: str) -> bool:
    """Whether a member is a force or a torque: the names that `FORCES` and `_flange` give them."""
    return member.startswith(("torque", "force_"))


@dataclass(frozen=True)
class Flange:
    """What it takes, "force" or "motion", its body, members of its own, and the coordinates that move with it."""

    takes: str
    body: str
    members: dict[str, str]
    coordinates: tuple[str, ...]


def _plain(signal: Any) -> TypeGuard[InputSignal]:
    """Whether a signal is an input as it is: with a gain its variable is no force or motion of a flange."""
    return isinstance(signal, InputSignal) and signal.gain == 1.0


def _flange(model: Model, element: Any) -> Flange | None:
    """The flange of an element; None if no input acts there."""
    if isinstance(element, AppliedForce2D | AppliedForce3D | AppliedTorque3D):
        return _load(element)
    if isinstance(element, AngleDriver3D | PositionDriver3D):
        return _driver(element)
    if isinstance(element, AppliedTorque2D) and _plain(element.torque):
        return Flange("force", element.body, {"torque": element.torque.channel}, ("angle",))
    if isinstance(element, CoordinateLoad) and _plain(element.load):
        # a generalised force is named like its coordinate, so that the two are told apart
        force = FORCES.get(element.coordinate, f"force_{element.coordinate}")
        return Flange("force", element.body, {force: element.load.channel}, (element.coordinate,))
    if isinstance(element, CoordinateDriver) and _plain(element.motion):
        force = FORCES.get(element.coordinate, f"force_{element.coordinate}")
        members = {element.coordinate: element.motion.channel, force: f"{element.name}.reaction"}
        if element.motion.rate is not None:
            members |= dict(_rates(model, element.body, element.coordinate, element.motion.rate))
        return Flange("motion", element.body, members, ())
    if isinstance(element, MovingFrame2D):
        return _frame(element)
    return None


def _load(load: AppliedForce2D | AppliedForce3D | AppliedTorque3D) -> Flange | None:
    """The flange of a force or of a torque in space, along its components that are inputs.

    Its motion is that of the body's centre of mass, of a force elsewhere or one that turns with the body there is none.
    A torque's angular velocity is along the axes that the torque is along.
    """
    what = "torque" if isinstance(load, AppliedTorque3D) else "force"
    signals = {axis: getattr(load, f"{what}_{axis}", None) for axis in "xyz"}
    inputs = {axis: signal.channel for axis, signal in signals.items() if _plain(signal)}
    members = {f"{what}_{axis}": channel for axis, channel in inputs.items()}
    body = load.marker.body
    if not inputs:
        return None
    if isinstance(load, AppliedTorque3D):
        rate = "body_angular_velocity" if load.follower else "angular_velocity"
        if not load.follower or np.array_equal(load.marker.axes(), np.eye(3)):
            members |= {f"angular_velocity_{axis}": f"{body}.{rate}_{axis}" for axis in inputs}
        return Flange("force", body, members, ())
    at_origin = not any(load.marker.point) and not load.follower
    return Flange("force", body, members, tuple(inputs) if at_origin else ())


def _driver(driver: AngleDriver3D | PositionDriver3D) -> Flange | None:
    """The flange of a joint in space that an input leads: the motion, its rate, and what it takes to make it."""
    turns = isinstance(driver, AngleDriver3D)
    motion = driver.angle if isinstance(driver, AngleDriver3D) else driver.position
    if not _plain(motion):
        return None
    members = {"angle" if turns else "z": motion.channel}
    if motion.rate is not None:
        members["angular_velocity" if turns else "vz"] = motion.rate
    members["torque" if turns else "force_z"] = f"{driver.name}.{'torque_z' if turns else 'force_z'}"
    return Flange("motion", driver.b.body, members, ())


def _frame(frame: MovingFrame2D) -> Flange | None:
    """The flange of a frame that inputs move: motion and reaction along the coordinates that they lead."""
    members: dict[str, str] = {}
    for c, motion in zip(frame.coordinate_records(), frame.motions(), strict=True):
        if _plain(motion):
            members[c.name] = motion.channel
            if motion.rate is not None:
                members[c.rate] = motion.rate
            members[FORCES[c.name]] = f"{frame.name}.reaction_{'torque' if c.name == 'angle' else c.name}"
    return Flange("motion", frame.name, members, ()) if members else None


def _rates(model: Model, body: str, coordinate: str, channel: str) -> Iterator[tuple[str, str]]:
    """Member and variable of the velocity of a coordinate that an input leads."""
    for record in (b for b in model.bodies if b.name == body):
        yield from ((c.rate, channel) for c in record.coordinate_records() if c.name == coordinate)


def _motion(model: Model, flange: Flange) -> Iterator[tuple[str, str]]:
    """Members and variables of the motion at a flange."""
    for body in (b for b in model.bodies if b.name == flange.body):
        for c in body.coordinate_records():
            if c.name in flange.coordinates:
                yield c.name, f"{body.name}.{c.name}"
                yield c.rate, f"{body.name}.{c.rate}"


def terminals_and_icons(model: Model, table: VariableTable, icon: bool) -> bytes:
    """The file's bytes; `icon` says whether there is an icon beside it."""
    from lxml import etree

    root = etree.Element("fmiTerminalsAndIcons", fmiVersion="3.0")
    if icon:
        graphics = add(root, "GraphicalRepresentation")
        square = {"x1": -100.0, "y1": -100.0, "x2": 100.0, "y2": 100.0}
        add(graphics, "CoordinateSystem", **square, suggestedScalingFactorTo_mm=0.1)
        add(graphics, "Icon", **square)
    flanges = terminals(model, table)
    if flanges:
        parent = add(root, "Terminals")
        for flange in flanges:
            terminal = add(parent, "Terminal", name=flange.name, matchingRule="bus", terminalKind=flange.kind,
                           description=flange.description)  # fmt: skip
            for member, variable in flange.members.items():
                kind = flange.flows.get(member, "signal")
                add(terminal, "TerminalMemberVariable", variableName=variable, memberName=member, variableKind=kind)
    data: bytes = etree.tostring(root, xml_declaration=True, encoding="UTF-8", pretty_print=True)
    return data
