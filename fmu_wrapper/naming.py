"""Who, when, and under which name: what an FMU says of its making."""

import getpass
import json
import os
import re
from datetime import UTC, datetime
from typing import Any

from .errors import ExportError


def user_name() -> str | None:
    """Who is logged in; None where nobody is known."""
    try:
        return getpass.getuser()
    except (OSError, KeyError, ImportError):  # a container's user may have no name
        return None


def date_of_export() -> str:
    """Now, as FMI writes it, or the time (s) in SOURCE_DATE_EPOCH, for files that can be made again byte by byte.

    Raises
    ------
    ExportError : if that is no time.
    """
    given = os.environ.get("SOURCE_DATE_EPOCH")
    try:
        now = datetime.now(UTC) if not given else datetime.fromtimestamp(int(given), UTC)
    except (ValueError, OverflowError, OSError):
        raise ExportError(f"SOURCE_DATE_EPOCH = '{given}' is no time: give seconds since 1970, or unset it") from None
    return now.strftime("%Y-%m-%dT%H:%M:%SZ")


def c_identifier(name: str) -> str:
    """`name` as a C identifier."""
    text = re.sub(r"\W", "_", name, flags=re.ASCII) or "model"
    return f"_{text}" if text[0].isdigit() else text


def json_bytes(data: Any) -> bytes:
    """`data` as JSON text. Raises ExportError for what is none."""
    try:
        return json.dumps(data, indent=1, allow_nan=False).encode()
    except (TypeError, ValueError) as error:
        raise ExportError(f"the solver settings are no JSON data: {error}; use numbers and strings") from None
