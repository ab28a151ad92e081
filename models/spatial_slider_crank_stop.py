"""The slider-crank in space whose slider strikes a stop."""

from typing import Any

from ..core.contacts.contact3d import HalfSpace3D, Sphere3D, SphereOnHalfSpace3D
from ..core.model.attitude import Axes
from ..core.model.markers import Marker3D
from .laws import contact_law, law_model_parameters, law_parameters
from .parameters import ScenarioError, ScenarioParameter
from .registry import scenario
from .scenario import Scenario
from .spatial_slider_crank import PARAMETERS as OF_MECHANISM
from .spatial_slider_crank import spatial_slider_crank

PARAMETERS = (
    *OF_MECHANISM,
    ScenarioParameter("stop", 0.26, "m", "place of the stop along x: the slider is below it"),
    *law_parameters(restitution=0.6, stiffness=1e7),
)


@scenario("spatial_slider_crank_stop", "a slider-crank in space (A03) whose slider strikes a stop", PARAMETERS)
def spatial_slider_crank_stop(
    *, stop: float, law: str, restitution: float, stiffness: float, exponent: float, damping: float | None,
    relaxation_time: float | None, **mechanism: Any,
) -> Scenario:  # fmt: skip
    """As `spatial_slider_crank`, with the contact `stop` of the slider's middle with a plane across x.

    Raises
    ------
    ScenarioError : if the slider starts behind the stop.
    """
    base = spatial_slider_crank(**mechanism)
    slider = next(body for body in base.model.bodies if body.name == "slider")
    start = slider.initial_state()[0][0]
    if not start < stop:
        raise ScenarioError(f"the slider starts at x = {start:.6g} m, behind the stop at {stop:g} m: move the stop")
    contact = contact_law(
        law, restitution=restitution, stiffness=stiffness, exponent=exponent, damping=damping,
        relaxation_time=relaxation_time, mass=mechanism["slider_mass"],
    )  # fmt: skip
    plane = HalfSpace3D(marker=Marker3D(point=(stop, 0.0, 0.0), attitude=Axes(z=(-1.0, 0.0, 0.0))))
    model = base.model.model_copy(
        update={
            "name": "spatial_slider_crank_stop",
            "contacts": (
                SphereOnHalfSpace3D(
                    name="stop", plane=plane, sphere=Sphere3D(marker=Marker3D(body="slider")), law=contact
                ),
            ),
            "parameters": (*base.model.parameters, *law_model_parameters("stop", contact)),
        }
    )
    return Scenario(
        name=model.name,
        description="",
        model=model,
        t_end=2.0,
        parameters={"damping": getattr(contact, "damping", None)},
        compare=("slider.x", "crank.angle", "slider.vx", "stop.normal_force", "stop.gap"),
    )
