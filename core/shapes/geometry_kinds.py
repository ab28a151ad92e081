"""What is known of a contact's geometry beyond its kernel: enough to bound how far its gap can move within a step."""

from typing import Any

from .bristle2d import bristle_disk_on_disk_kernel, bristle_disk_on_half_plane_kernel
from .cable_line import disk_on_cable_kernel
from .coordinate_contact import (
    bristle_coordinate_contact_kernel,
    coordinate_contact_kernel,
    sliding_coordinate_contact_kernel,
)
from .friction3d import rubbing_sphere3d_kernel
from .frictionless3d import sphere3d_kernel
from .gripping3d import gripping_sphere3d_kernel
from .line2d import bristle_disk_on_line_kernel, disk_on_line_kernel, sliding_disk_on_line_kernel
from .mesh_contact3d import gripping_mesh3d_kernel, mesh3d_kernel, rubbing_mesh3d_kernel
from .normal2d import disk_on_disk_kernel, disk_on_half_plane_kernel
from .segment2d import bristle_disk_on_segment_kernel, disk_on_segment_kernel, sliding_disk_on_segment_kernel
from .sliding2d import sliding_disk_on_disk_kernel, sliding_disk_on_half_plane_kernel

OWN, DISKS, PLANE, SEGMENT, LINEAR, LINE, CABLE, EQUATIONS, SPHERE = range(9)
"""OWN: a kernel of which nothing is known; LINEAR: a gap that is linear in the coordinates; EQUATIONS: a gap function
of an `EquationSystem`, which is asked for through the whole system; SPHERE: a sphere in space, on another, on a
half-space or a mesh."""

_KINDS: dict[Any, int] = {
    disk_on_disk_kernel: DISKS,
    sliding_disk_on_disk_kernel: DISKS,
    bristle_disk_on_disk_kernel: DISKS,
    disk_on_half_plane_kernel: PLANE,
    sliding_disk_on_half_plane_kernel: PLANE,
    bristle_disk_on_half_plane_kernel: PLANE,
    disk_on_segment_kernel: SEGMENT,
    sliding_disk_on_segment_kernel: SEGMENT,
    bristle_disk_on_segment_kernel: SEGMENT,
    coordinate_contact_kernel: LINEAR,
    sliding_coordinate_contact_kernel: LINEAR,
    bristle_coordinate_contact_kernel: LINEAR,
    disk_on_line_kernel: LINE,
    sliding_disk_on_line_kernel: LINE,
    bristle_disk_on_line_kernel: LINE,
    disk_on_cable_kernel: CABLE,
    sphere3d_kernel: SPHERE,
    rubbing_sphere3d_kernel: SPHERE,
    gripping_sphere3d_kernel: SPHERE,
    mesh3d_kernel: SPHERE,
    rubbing_mesh3d_kernel: SPHERE,
    gripping_mesh3d_kernel: SPHERE,
}
MAY_SLEEP = (DISKS, PLANE, SEGMENT, SPHERE)
"""Kinds whose kernels leave out contacts that sleep (`location/asleep.py`), but those with bristles."""


def kind_of(kernel: Any) -> int:
    """The kind of a contact with this kernel (not of the record's class, whose heirs may bring a kernel of theirs)."""
    return _KINDS.get(kernel, OWN)
