"""Writes the image that control.c runs: python make_image.py control.image"""

import sys
from pathlib import Path

from tlismni.core.native import image_of
from tlismni.models import load


def make(path: Path) -> Path:
    """The slider-crank with a stop, whose crank takes a torque, as an image."""
    scenario = load("slider_crank_stop")
    settings = {"method": scenario.method, "rtol": scenario.rtol, "atol": scenario.atol, **scenario.options}
    path.write_bytes(image_of(scenario.model, scenario.t_end, **settings))
    return path


if __name__ == "__main__":
    make(Path(sys.argv[1]))
