"""The runs of the matrix as a CSV table."""

import csv
from pathlib import Path
from typing import Any

from .records import Pair
from .runner import MethodMatrix


def write_csv(matrix: MethodMatrix, path: Path) -> Path:
    """Every run of every pair as a line."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with path.open("w", newline="", encoding="utf-8") as stream:
        lines = [line for pair in matrix.pairs for line in _lines(pair)]
        writer = csv.DictWriter(stream, list(lines[0]) if lines else [])
        writer.writeheader()
        writer.writerows(lines)
    return path


def _lines(pair: Pair) -> list[dict[str, Any]]:
    found = []
    for run in pair.runs:
        line = {"scenario": pair.scenario, "method": pair.setting.label, **run.model_dump(exclude={"residuals"})}
        residuals = run.residuals or (None, None, None)
        names = ("residual_position", "residual_velocity", "residual_acceleration")
        found.append(line | dict(zip(names, residuals, strict=True)))
    return found
