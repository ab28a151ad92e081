"""Reports: one HTML file for a cross-check that needs nothing else, and an overview of many."""

import base64
import json
import math
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..core.errors import TlismniError
from .drawing import drawing
from .interactive import figures, plotly_library
from .provenance import provenance

if TYPE_CHECKING:
    from .catalogue import CatalogueCheck, Outcome
    from .crosscheck import CrossCheck

TEMPLATE, OVERVIEW = "crosscheck.html.j2", "overview.html.j2"


def write_report(found: "CrossCheck") -> Path:
    """Write `found.report`; returns it. Raises TlismniError if jinja2 cannot be imported."""
    if found.report is None:
        raise ValueError("this cross-check has no report file: give crosscheck a report_dir")
    found.report.write_text(render(found), encoding="utf-8")
    return found.report


def render(found: "CrossCheck") -> str:
    """The report as HTML text: figures included, interactive ones if plotly is installed."""
    images = [base64.b64encode(path.read_bytes()).decode("ascii") for path in found.figures]
    library, result = plotly_library(), found.comparison.result
    motion = None if result is None or found.model is None else drawing(found.model, result)
    sources = sorted({row.third_source for row in found.rows if row.third is not None})
    return str(
        _environment()
        .get_template(TEMPLATE)
        .render(
            found=found,
            c=found.comparison,
            images=images,
            plots=figures(found.comparison.panels) if library else [],
            library=_script(library or ""),
            drawing=json.dumps(motion) if motion else None,
            third=", ".join(sources),
            reasons=sorted({row.reason for row in found.rows if row.verdict == "not comparable"}),
            machine=provenance(),
        )
    )


def write_overview(found: "CatalogueCheck", folder: Path) -> Path:
    """Write overview.html and overview.json; returns the page. Raises TlismniError if jinja2 cannot be imported."""
    page = folder / "overview.html"
    folder.mkdir(parents=True, exist_ok=True)
    text = (
        _environment()
        .get_template(OVERVIEW)
        .render(
            outcomes=found.outcomes,
            scenarios=len({outcome.case.scenario for outcome in found.outcomes}),
            counts=dict(Counter(outcome.verdict for outcome in found.outcomes)),
            machine=provenance(),
        )
    )
    page.write_text(text, encoding="utf-8")
    numbers = {"machine": provenance(), "cases": [outcome.to_dict() for outcome in found.outcomes]}
    (folder / "overview.json").write_text(json.dumps(numbers, indent=2), encoding="utf-8")
    return page


def _environment() -> Any:
    try:
        from jinja2 import Environment, PackageLoader
    except ImportError as error:
        raise TlismniError(
            f"reports need jinja2, which cannot be imported ({error}). "
            "Install it with: pip install 'tlismni[validation]'"
        ) from error
    environment = Environment(
        loader=PackageLoader(__package__ or "tlismni.validation"), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    environment.filters |= {
        "number": number, "small": small, "figure": figure, "script": _script, "agreeing": _agreeing,
        "largest": _largest,
    }  # fmt: skip
    return environment


def _script(text: str) -> Any:
    """Text that goes into a script element as it is; nothing in it can end the element."""
    from markupsafe import Markup

    return Markup(text.replace("</", "<\\/"))


def _agreeing(outcome: "Outcome") -> str:
    rows = [] if outcome.found is None else [row for row in outcome.found.rows if row.required]
    return f"{sum(row.verdict == 'agree' for row in rows)} of {len(rows)}"


def _largest(outcome: "Outcome") -> str:
    rows = () if outcome.found is None else outcome.found.rows
    return small(max((row.relative for row in rows if row.required), default=0.0))


def number(value: float) -> str:
    """Nine significant digits: enough to see a relative difference of 1e-8."""
    return f"{value:.9g}" if math.isfinite(value) else str(value)


def small(value: float) -> str:
    """A difference or tolerance: two digits."""
    return "0" if value == 0.0 else f"{value:.1e}"


def figure(value: Any) -> str:
    """Two digits of a number; nothing of what does not exist."""
    return f"{value:.2g}" if isinstance(value, int | float) else str(value or "")
