"""Scenes as JSON data; arrays as base64 text of their little-endian numbers, which a browser reads without parsing."""

import base64
import math
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

SINGLE, DOUBLE = "f4", "f8"


def pack(values: NDArray[np.float64], kind: str = SINGLE) -> dict[str, Any]:
    """An array as data: kind of number, shape, base64 text."""
    numbers = np.ascontiguousarray(values, dtype=f"<{kind}")
    return {"kind": kind, "shape": list(numbers.shape), "data": base64.b64encode(numbers.tobytes()).decode("ascii")}


def unpack(data: dict[str, Any]) -> NDArray[np.float64]:
    """The array that `pack` was given, in its precision."""
    found = np.frombuffer(base64.b64decode(data["data"]), dtype=f"<{data['kind']}").reshape(data["shape"])
    return found.astype(np.float64)


def plain(value: Any) -> Any:
    """Records, arrays and containers as JSON data; times keep double precision. Numbers that are none become None."""
    if is_dataclass(value) and not isinstance(value, type):
        return {
            f.name: pack(getattr(value, f.name), DOUBLE) if f.metadata.get("double") else plain(getattr(value, f.name))
            for f in fields(value)
        }
    if isinstance(value, np.ndarray):
        return pack(value)
    if isinstance(value, dict):
        return {str(key): plain(x) for key, x in value.items()}
    if isinstance(value, list | tuple):
        return [plain(x) for x in value]
    if isinstance(value, float | np.floating):
        return float(value) if math.isfinite(value) else None
    return value
