"""Glint: highlights in photographs of glossy objects as measurements of their surface.

Lengths are in world units (COLMAP's scale) unless a name says otherwise: `_rel` is a fraction of the bounding box's
diagonal, `_px` pixels, `_deg` degrees, `_voxels` voxels. Distances are negative inside. Arrays may be anything that
NumPy makes an array of; they are copied. Long calls free the interpreter. Those of many
parts (run, find_lights, compare, align, signed_distance, closest_points) stop on Ctrl-C; those of one (mesh_to_level_set,
level_set_to_mesh, detect_highlights, reading a file) end first. Some take `progress=callable`.
"""

from __future__ import annotations

from . import _glint
from ._config import config_yaml
from ._errors import CancelledError, Error, InputError, NoResultError
from ._glint import LevelSet, __version__
from ._mesh import (
    Alignment,
    Comparison,
    ErrorStats,
    FScore,
    Mesh,
    SignedDistance,
    align,
    closest_points,
    compare,
    dense_to_level_set,
    level_set_gradient,
    level_set_to_dense,
    level_set_to_mesh,
    mesh_to_level_set,
    read_level_set,
    read_mesh,
    sample_level_set,
    signed_distance,
    write_level_set,
    write_mesh,
)
from ._progress import Event
from ._project import (
    Camera,
    FoundLight,
    Highlights,
    Image,
    Light,
    Points3D,
    Project,
    Rigid3d,
    detect_highlights,
    find_lights,
    read_lights,
    read_project,
    write_lights,
)
from ._run import RunResult, run


def set_num_threads(count: int) -> None:
    """Limits the threads of all parallel work to `count`; 0: as many as the machine has. Results do not depend on it."""
    if count < 0:
        raise InputError(f"count: expected 0 or more threads, found {count}", record="count")
    _glint.set_num_threads(count)


__all__ = [
    "Alignment",
    "Camera",
    "CancelledError",
    "Comparison",
    "Error",
    "ErrorStats",
    "Event",
    "FScore",
    "FoundLight",
    "Highlights",
    "Image",
    "InputError",
    "LevelSet",
    "Light",
    "Mesh",
    "NoResultError",
    "Points3D",
    "Project",
    "Rigid3d",
    "RunResult",
    "SignedDistance",
    "align",
    "closest_points",
    "compare",
    "config_yaml",
    "dense_to_level_set",
    "detect_highlights",
    "find_lights",
    "level_set_gradient",
    "level_set_to_dense",
    "level_set_to_mesh",
    "mesh_to_level_set",
    "read_level_set",
    "read_lights",
    "read_mesh",
    "read_project",
    "run",
    "sample_level_set",
    "set_num_threads",
    "signed_distance",
    "write_level_set",
    "write_lights",
    "write_mesh",
]
