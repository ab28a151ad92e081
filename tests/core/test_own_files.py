"""Models with own elements (`own_parts.py`) as files: what is written, and what may be imported when they are read."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from helpers import on
from own_parts import CrankRotor, Drag, HardeningSpring, OnParabola, WheelOnFloor
from tlismni.core import (
    Marker2D,
    Model,
    ModelError,
    NewtonImpact,
    Parameter,
    PointMass2D,
    ScalarJoint2D,
    scalar_constraint,
)

C = 1.6
BEAD = Model(bodies=[PointMass2D(name="bead", mass=0.7)])


def everything():
    return Model(
        bodies=[PointMass2D(name="bead", mass=0.7, position=(0.8, 0.512)), CrankRotor(name="crank", mean=1.0)],
        joints=[OnParabola(name="wire", b=on("bead"), curvature=C)],
        forces=[Drag(name="air", marker=on("bead"), coefficient=0.1),
                HardeningSpring(name="spring", b=on("bead"), natural_length=0.4, stiffness=3.0)],
        contacts=[WheelOnFloor(name="floor", b=on("bead"), radius=0.0, law=NewtonImpact(restitution=0.5))],
        parameters=[Parameter(name="drag", targets=["air.coefficient"])],
    )  # fmt: skip


def test_model_with_own_elements_is_data():
    model = everything()
    again = Model.from_json(model.to_json())
    assert again == model and again.to_json() == model.to_json()
    assert '"CrankRotor": "own_parts:CrankRotor"' in model.to_json()
    for kind in ("bodies", "joints", "forces", "contacts"):
        assert [type(x) for x in getattr(again, kind)] == [type(x) for x in getattr(model, kind)]
    changed = model.with_parameters({"drag": 0.5})
    assert type(changed.forces[0]) is Drag and changed.forces[0].coefficient == 0.5
    assert Model.model_validate(model.model_dump()) == model
    with pytest.raises(ModelError, match="coefficient"):
        model.with_parameters({"drag": -1.0})


def read_elsewhere(path, *, allow="False", before="", **environment):
    """What another process says that reads a model file; it prints the last place of the bead."""
    code = f"""
import sys
sys.path.insert(0, {str(Path(__file__).parent)!r})
{before}
from tlismni.core import Model, ModelError, simulate
try:
    model = Model.load({str(path)!r}, allow_imports={allow})
except ModelError as error:
    print("refused", "own_parts" in sys.modules, error)
else:
    print([type(x).__module__ for x in model.joints])
"""
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, env={**os.environ, **environment}
    )
    return done.stdout


def test_model_file_imports_no_own_classes_without_leave(tmp_path):
    path = tmp_path / "model.json"
    everything().save(path)
    said = read_elsewhere(path)
    # nothing of the module has run
    assert said.startswith("refused False")
    assert "allow_imports=['own_parts']" in said and "TLISMNI_ALLOW_IMPORTS=own_parts" in said
    assert read_elsewhere(path, allow="['another']").startswith("refused False")


@pytest.mark.sampled(2)
@pytest.mark.parametrize(
    "leave",
    [
        {"allow": "True"},
        {"allow": "['own_parts']"},
        {"before": "import own_parts"},
        {"TLISMNI_ALLOW_IMPORTS": "a, own_parts"},
        {"TLISMNI_ALLOW_IMPORTS": "*"},
    ],
)
def test_model_file_imports_own_classes_with_leave(leave, tmp_path):
    path = tmp_path / "model.json"
    everything().save(path)
    assert "own_parts" in read_elsewhere(path, **leave)


@pytest.mark.parametrize(
    "imports, text",
    [
        ([], "an object"),
        ({"CrankRotor": 3}, "'module:Class' is needed"),
        ({"CrankRotor": "os.system('x')"}, "'module:Class' is needed"),
        ({"NoSuchOne": "no_such_module:NoSuchOne"}, "cannot be imported from no_such_module"),
        ({"NoSuchOne": "this:NoSuchOne"}, "no record class NoSuchOne in module this"),
    ],
)
def test_imports_that_lead_nowhere_are_refused(imports, text):
    data = json.loads(BEAD.to_json())
    with pytest.raises(ModelError, match=text):
        Model.from_json(json.dumps({**data, "imports": imports}), allow_imports=True)


def test_classes_of_one_name_are_told_apart():
    def made(slope):
        class Slide(ScalarJoint2D):
            formula = scalar_constraint(lambda a, b: b.y - a.y)
            a: Marker2D = Marker2D()
            b: Marker2D
            steepness: float = slope

        return Slide

    first, second = made(1.0), made(2.0)
    bodies = [PointMass2D(name="p", mass=1.0), PointMass2D(name="q", mass=1.0)]
    model = Model(bodies=bodies, joints=[first(name="j", b=on("p"))],
                  parameters=[Parameter(name="mass", targets=["p.mass"])])  # fmt: skip
    # the last definition of the name is not what this model means
    assert type(model.with_parameters({"mass": 2.0}).joints[0]) is first
    both = Model(bodies=bodies, joints=[first(name="j", b=on("p")), second(name="k", b=on("q"))])
    with pytest.raises(ModelError, match="two own classes of the model have the type 'Slide'"):
        both.to_json()
