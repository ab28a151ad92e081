"""Reports: one HTML file for a cross-check that needs nothing else, and an overview of many."""

import base64
import json
import math
from collections import Counter
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..core.errors import TlismniError
from ..models import catalogue
from .comparisons.common import Row, reasons_of
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
        environment()
        .get_template(TEMPLATE)
        .render(
            found=found,
            c=found.comparison,
            decisive=[row for row in found.rows if row.required],
            informing=[row for row in found.rows if not row.required],
            units=_units(found),
            images=images,
            plots=figures(found.comparison.panels) if library else [],
            library=_script(library or ""),
            drawing=json.dumps(motion) if motion else None,
            third=", ".join(sources),
            reasons=sorted(reasons_of(found.rows)),
            machine=found.machine,
        )
    )


def write_overview(found: "CatalogueCheck", folder: Path) -> Path:
    """Write overview.html and overview.json; returns the page. Raises TlismniError if jinja2 cannot be imported."""
    page, machine = folder / "overview.html", provenance()
    folder.mkdir(parents=True, exist_ok=True)
    text = (
        environment()
        .get_template(OVERVIEW)
        .render(
            found=found,
            outcomes=sorted(found.outcomes, key=lambda o: (SEVERITY.index(o.verdict), o.case.name)),
            scenarios=len({outcome.case.scenario for outcome in found.outcomes}),
            counts=dict(Counter(outcome.verdict for outcome in found.outcomes)),
            machine=machine,
        )
    )
    _write(page, text)
    numbers = {"machine": machine, **found.to_dict(), "cases": [outcome.to_dict() for outcome in found.outcomes]}
    _write(folder / "overview.json", json.dumps(numbers, indent=2))
    return page


def _write(path: Path, text: str) -> None:
    """As a whole or not at all: an interruption must not leave half a file where a whole one was."""
    part = path.with_name(f".{path.name}.part")
    part.write_text(text, encoding="utf-8")
    part.replace(path)


def environment() -> Any:
    """The templates of the pages, and their filters. Raises TlismniError if jinja2 cannot be imported."""
    try:
        from jinja2 import Environment, PackageLoader
    except ImportError as error:
        raise TlismniError(
            f"reports need jinja2, which cannot be imported ({error}). "
            "Install it with: pip install 'tlismni[validation]'"
        ) from error
    found = Environment(
        loader=PackageLoader(__package__ or "tlismni.validation"), autoescape=True, trim_blocks=True, lstrip_blocks=True
    )
    found.filters |= {
        "shown": shown, "part": part, "small": small, "seconds": seconds, "setting": setting, "verdict": verdict,
        "figure": figure, "script": _script, "agreeing": _agreeing, "worst": _worst, "sentence": _sentence,
    }  # fmt: skip
    return found


def _script(text: str) -> Any:
    """Text that goes into a script element as it is; nothing in it can end the element."""
    from markupsafe import Markup

    return Markup(text.replace("</", "<\\/"))


def _agreeing(outcome: "Outcome") -> str:
    rows = [] if outcome.found is None else [row for row in outcome.found.rows if row.required]
    return f"{sum(row.verdict == 'agree' for row in rows)} of {len(rows)}"


def _worst(outcome: "Outcome") -> str:
    """Of its rows the one that comes nearest to its tolerance, or is farthest beyond."""
    rows = () if outcome.found is None else outcome.found.rows
    parts = [row.difference / row.allowed for row in rows if row.required and row.allowed > 0.0]
    return f"{max(parts):.2g}" if parts else ""


NAMES = ("exudyn", "tlismni", "scipy")
"""That are written small."""


def _sentence(text: str) -> str:
    """With a capital, unless it begins with a name ("disk.z", exudyn), and a full stop."""
    if not text:
        return ""
    first = text.split()[0].rstrip(":,")
    begun = text if first in NAMES or "." in first or "_" in first else text[:1].upper() + text[1:]
    return begun if begun.endswith(".") else f"{begun}."


def _units(found: "CrossCheck") -> dict[str, tuple[str, str]]:
    """Unit and meaning of the parameters of a scenario in the catalogue."""
    entry = next((e for e in catalogue() if e.name == found.scenario), None)
    return {} if entry is None else {p.name: (p.unit, p.description) for p in entry.parameters}


def shown(row: Row, value: float) -> str:
    """A value with the digits in which the two sides differ (four to eight); noise around zero as 0."""
    if not math.isfinite(value):
        return str(value)
    size = max(row.size, abs(row.ours), abs(row.exudyn))
    if size == 0.0:
        return "0"
    apart = row.difference / size
    digits = 8 if apart < 1e-7 else min(max(math.ceil(-math.log10(apart)) + 1, 4), 8)
    text = f"{round(value, digits - 1 - math.floor(math.log10(size))) + 0.0:.{digits}g}"
    mantissa, _, exponent = text.partition("e")
    return f"{mantissa}e{int(exponent)}" if exponent else mantissa


def part(row: Row, value: float) -> str:
    """A difference, error bar or tolerance in parts of the row's size; in its unit for rows with an absolute one."""
    if row.tolerance_kind == "absolute" or row.size == 0.0:
        return f"{small(value)} {row.unit}"
    return small(value / row.size)


def small(value: float) -> str:
    """A difference or tolerance: two digits."""
    if value == 0.0:
        return "0"
    mantissa, exponent = f"{value:.1e}".split("e")
    return f"{mantissa.removesuffix('.0')}e{int(exponent)}"


def figure(value: Any) -> str:
    """Two digits of a number; nothing of what does not exist."""
    return f"{value:.2g}" if isinstance(value, int | float) else str(value or "")


def seconds(value: float) -> str:
    """A time of minutes or less."""
    return f"{value:.0f} s" if value < 100.0 else f"{value / 60.0:.1f} min"


SIGNS = {"agree": "✓", "undecided": "≈", "differ": "✗", "failed": "✗", "not comparable": "–"}
"""Beside the verdict's word, so that colour is not all that carries it."""
SEVERITY = ("failed", "differ", "undecided", "agree", "not comparable")


def verdict(text: str) -> str:
    """The word with its sign."""
    return f"{SIGNS[text]} {text}"


def setting(value: Any) -> str:
    """A parameter's value: a number with six digits, none where it is left out."""
    if isinstance(value, bool) or not isinstance(value, float):
        return "–" if value is None else str(value)
    return f"{value:.6g}"
