"""Runs without Python: a run as a file of numbers, and the C code that goes on from it (`tlismni.h`)."""

from .errors import NativeError
from .export import image_of
from .image_file import native_image

__all__ = ["NativeError", "image_of", "native_image"]
