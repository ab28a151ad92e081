"""Events: what happens at an instant at which contacts close, strike, open, slide or stick."""

from .event import Event, Fallback

__all__ = ["Event", "Fallback"]
