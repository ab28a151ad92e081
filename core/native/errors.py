"""What keeps a model from running without Python."""

from ..errors import TlismniError


class NativeError(TlismniError):
    """A model, or a part of it, needs Python when it runs."""
