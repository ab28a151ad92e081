"""Models and a log for the tests of the FMU wrapper."""

from tlismni.core.contacts.contact2d import Disk2D, DiskOnHalfPlane2D, HalfPlane2D
from tlismni.core.elements import AppliedForce2D, PointMass2D
from tlismni.core.laws import LAWS, NewtonImpact
from tlismni.core.methods.automatic import METHOD_NAMES
from tlismni.core.model.channels import Input, Parameter
from tlismni.core.model.markers import Marker2D
from tlismni.core.model.signals import InputSignal
from tlismni.core.multibody_model import Model

METHODS = list(METHOD_NAMES)
"""Items of `solver.method`: its values are 0, 1, ..."""

LAW_NAMES = [law.__name__ for law in LAWS.values()]
"""Items of `CONTACT.law`."""


def ball_model(name: str = "driven_ball", height: float = 1.0) -> Model:
    """A ball over a floor, with a vertical force as input."""
    marker = Marker2D(body="ball")
    return Model(
        name=name,
        bodies=[PointMass2D(name="ball", mass=2.0, position=(0.0, height))],
        forces=[AppliedForce2D(name="drive", marker=marker, force_y=InputSignal(channel="push"))],
        contacts=[
            DiskOnHalfPlane2D(
                name="floor", plane=HalfPlane2D(), disk=Disk2D(marker=marker, radius=0.0),
                law=NewtonImpact(restitution=0.7),
            )
        ],
        inputs=[Input(name="push", unit="N", start=1.0, description="force on the ball, upwards")],
        parameters=[
            Parameter(name="restitution", minimum=0.0, maximum=1.0, targets=["floor.law.restitution"]),
            Parameter(name="mass", unit="kg", minimum=0.0, targets=["ball.mass"]),
        ],
    )  # fmt: skip


class Messages(list[tuple[int, str, str]]):
    """A log that can be asked."""

    def __call__(self, status: int, category: str, message: str) -> None:
        self.append((status, category, message))

    @property
    def errors(self) -> list[str]:
        return [message for _, category, message in self if category == "logStatusError"]
