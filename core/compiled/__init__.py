"""What lets the time loop be one compiled program: array views on addresses, kernels called by address."""

from .kernels import KERNEL_SIGNATURE, call_kernel, kernel_address
from .records import ArrayRecord
from .views import imat, ivec, mat, vec

__all__ = [
    "KERNEL_SIGNATURE",
    "ArrayRecord",
    "call_kernel",
    "imat",
    "ivec",
    "kernel_address",
    "mat",
    "vec",
]
