"""What the shell offers when Tab is pressed: scenarios, model files, methods."""

from pathlib import Path


def sources(incomplete: str) -> list[str]:
    """Scenarios and model files that begin so."""
    from ..models import names

    folder = Path(incomplete).parent if "/" in incomplete else Path()
    files = sorted(str(path) for path in folder.glob("*.json")) if folder.is_dir() else []
    return [name for name in (*names(), *files) if name.startswith(incomplete)]


def methods(incomplete: str) -> list[str]:
    """Methods that begin so."""
    from ..core.methods.automatic import METHOD_NAMES

    return [name for name in METHOD_NAMES if name.startswith(incomplete)]
