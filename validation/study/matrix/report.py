"""The matrix as files: one HTML page that needs nothing else, a JSON file."""

import base64
import json
from pathlib import Path

from ...provenance import provenance
from ...report import environment
from .plots import plot_matrix
from .runner import MethodMatrix
from .summary import reasons, summary_rows
from .tables import write_csv

TEMPLATE = "methods.html.j2"
COSTS_SHOWN = (("cpu_time", "CPU"), ("evaluations", "evaluations"))


def write_report(matrix: MethodMatrix, folder: Path) -> tuple[Path, ...]:
    """Write methods.html, methods.json, methods.csv and the heat maps.

    Raises TlismniError if jinja2 or matplotlib cannot be imported.
    """
    folder.mkdir(parents=True, exist_ok=True)
    figures = [plot_matrix(matrix, folder / f"methods_{name}.png", name) for name, _ in COSTS_SHOWN]
    data, page = folder / "methods.json", folder / "methods.html"
    data.write_text(json.dumps(matrix.to_dict(), indent=1, default=str), encoding="utf-8")
    page.write_text(render(matrix, figures), encoding="utf-8")
    return page, data, write_csv(matrix, folder / "methods.csv"), *figures


def render(matrix: MethodMatrix, figures: list[Path]) -> str:
    """The page as text, figures included."""
    level = matrix.sweep.levels[0]
    return str(
        environment()
        .get_template(TEMPLATE)
        .render(
            matrix=matrix,
            images=[base64.b64encode(path.read_bytes()).decode("ascii") for path in figures],
            summary=summary_rows(matrix),
            rows=matrix.rows(),
            reasons=reasons(matrix, level),
            level=level,
            machine=provenance(),
        )
    )
