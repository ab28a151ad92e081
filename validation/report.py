"""The report of a cross-check: one HTML file that needs nothing else."""

import base64
import math
from importlib import resources
from pathlib import Path
from typing import TYPE_CHECKING

from ..core.errors import TlismniError

if TYPE_CHECKING:
    from .crosscheck import CrossCheck

TEMPLATE = "crosscheck.html.j2"


def write_report(found: "CrossCheck") -> Path:
    """Write `found.report`; returns it. Raises TlismniError if jinja2 cannot be imported."""
    if found.report is None:
        raise ValueError("this cross-check has no report file: give crosscheck a report_dir")
    found.report.write_text(render(found), encoding="utf-8")
    return found.report


def render(found: "CrossCheck") -> str:
    """The report as HTML text, figures included."""
    try:
        from jinja2 import Environment
    except ImportError as error:
        raise TlismniError(
            f"reports need jinja2, which cannot be imported ({error}). "
            "Install it with: pip install 'tlismni[validation]'"
        ) from error
    environment = Environment(autoescape=True, trim_blocks=True, lstrip_blocks=True)
    environment.filters["number"] = number
    environment.filters["small"] = small
    source = (resources.files(__package__) / "templates" / TEMPLATE).read_text(encoding="utf-8")
    images = [base64.b64encode(path.read_bytes()).decode("ascii") for path in found.figures]
    return environment.from_string(source).render(found=found, c=found.comparison, images=images)


def number(value: float) -> str:
    """Nine significant digits: enough to see a relative difference of 1e-8."""
    return f"{value:.9g}" if math.isfinite(value) else str(value)


def small(value: float) -> str:
    """A difference or tolerance: two digits."""
    return "0" if value == 0.0 else f"{value:.1e}"
