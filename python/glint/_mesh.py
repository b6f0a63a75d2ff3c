"""Meshes, signed distance, level sets, comparison."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from typing import Any, Callable, Dict, NamedTuple, Optional, Sequence, Tuple, Union

import numpy as np

from . import _arrays, _glint
from ._errors import InputError
from ._glint import LevelSet
from ._progress import Event, teller

PathLike = Union[str, "os.PathLike[str]"]


@dataclass
class Mesh:
    """A triangle mesh.

    Attributes:
        vertices: (n, 3) float64, world units.
        faces: (m, 3) int32, indices of vertices, counter-clockwise seen from outside.
        normals: (n, 3) float64, unit and outward, or None.
        colors: (n, 3) uint8, sRGB, or None.
        attributes: further values a vertex by name, each (n,) float32; of a refined mesh `confidence` (in [0, 1]),
            `sigma_position_rel` (fraction of the diagonal) and `sigma_normal_deg`.
    """

    vertices: np.ndarray
    faces: np.ndarray
    normals: Optional[np.ndarray] = None
    colors: Optional[np.ndarray] = None
    attributes: Dict[str, np.ndarray] = field(default_factory=dict)

    @property
    def diagonal(self) -> float:
        """Length of the bounding box's diagonal, the unit of every length called `_rel`."""
        if len(self.vertices) == 0:
            return 0.0
        return float(np.linalg.norm(np.ptp(np.asarray(self.vertices), axis=0)))

    def __repr__(self) -> str:
        has = [name for name in ("normals", "colors") if getattr(self, name) is not None] + list(self.attributes)
        return f"Mesh(num_vertices={len(self.vertices)}, num_faces={len(self.faces)}, has={has})"


MeshLike = Union[Mesh, Tuple[Any, Any]]


def fields(name: str, mesh: Any) -> Dict[str, Any]:
    """What C++ gets of a mesh or a pair (V, F); checked."""
    if not isinstance(mesh, Mesh):
        if not isinstance(mesh, (tuple, list)) or len(mesh) != 2:
            raise InputError(f"{name}: expected a glint.Mesh or a pair (V, F), found {type(mesh).__name__}", record=name)
        mesh = Mesh(*mesh)
    vertices = _arrays.floats(f"{name}.vertices", mesh.vertices, (None, 3))
    count = len(vertices)
    return {
        "vertices": vertices,
        "faces": _arrays.integers(f"{name}.faces", mesh.faces, (None, 3), np.int32, below=count),
        "normals": None if mesh.normals is None else _arrays.floats(f"{name}.normals", mesh.normals, (count, 3)),
        "colors": None if mesh.colors is None else _arrays.integers(f"{name}.colors", mesh.colors, (count, 3), np.uint8),
        "attributes": {
            key: _arrays.floats(f"{name}.attributes[{key!r}]", values, (count,), np.float32)
            for key, values in mesh.attributes.items()
        },
    }


def _pair(V: Any, F: Any) -> Dict[str, Any]:
    vertices = _arrays.floats("V", V, (None, 3))
    faces = _arrays.integers("F", F, (None, 3), np.int32, below=len(vertices))
    return {"vertices": vertices, "faces": faces, "normals": None, "colors": None, "attributes": {}}


def read_mesh(path: PathLike) -> Mesh:
    """Reads the file `path`: PLY, OBJ, OFF or STL; polygons become triangles.

    Raises InputError naming file and record.
    """
    return Mesh(**_glint.read_mesh(os.fspath(path)))


def write_mesh(path: PathLike, mesh: MeshLike) -> None:
    """Writes .ply, .obj or .glb, whole or not at all.

    Args:
        path: the file; its extension is the format.
        mesh: a Mesh, or a pair (V, F).
    """
    _glint.write_mesh(os.fspath(path), fields("mesh", mesh))


class SignedDistance(NamedTuple):
    """Signed distances, and what each point is closest to.

    Attributes:
        distance: (k,) float64, world units, negative inside.
        face: (k,) int64, the closest face.
        point: (k, 3) float64, the closest point, world units.
        barycentric: (k, 3) float64, its weights of the face's vertices.
        sign: how the sign was found: "pseudonormal" or "winding".
    """

    distance: np.ndarray
    face: np.ndarray
    point: np.ndarray
    barycentric: np.ndarray
    sign: str


def signed_distance(V: Any, F: Any, points: Any, *, sign: str = "auto") -> np.ndarray:
    """Exact signed distance of points to a triangle mesh, with angle-weighted pseudo-normals.

    Args:
        V: (n, 3) vertices, world units.
        F: (m, 3) whole numbers, counter-clockwise seen from outside.
        points: (k, 3), world units.
        sign: "pseudonormal" (exact for closed, oriented meshes without self-intersections), "winding" (generalised
            winding number, for the rest) or "auto" (the first, unless the mesh is not of that kind).

    Returns:
        (k,) float64, world units, negative inside. A mesh that is inside out is turned.
    """
    _check_sign(sign)
    return _glint.signed_distance(_pair(V, F), _arrays.floats("points", points, (None, 3)), sign)


def closest_points(V: Any, F: Any, points: Any, *, sign: str = "auto") -> SignedDistance:
    """As signed_distance(), with the closest face, point and barycentric weights.

    Args:
        V: (n, 3) vertices, world units.
        F: (m, 3) whole numbers.
        points: (k, 3), world units.
        sign: "auto", "pseudonormal" or "winding".
    """
    _check_sign(sign)
    return SignedDistance(**_glint.closest_points(_pair(V, F), _arrays.floats("points", points, (None, 3)), sign))


def _check_sign(sign: str, *more: str) -> None:
    known = ("auto", "pseudonormal", "winding", *more)
    if sign not in known:
        raise InputError(f"sign: expected one of {', '.join(known)}, found {sign!r}", record="sign")


def mesh_to_level_set(
    V: Any, F: Any, voxel_size: float, *, sign: str = "auto", half_width_voxels: float = 3.0
) -> LevelSet:
    """A mesh as an exact narrow-band signed distance field.

    Args:
        V: (n, 3) vertices, world units.
        F: (m, 3) whole numbers, counter-clockwise seen from outside.
        voxel_size: edge of a voxel, world units.
        sign: as for signed_distance(), or "unsigned".
        half_width_voxels: half width of the band, voxels.
    """
    _check_sign(sign, "unsigned")
    return _glint.mesh_to_level_set(
        _pair(V, F), _arrays.positive("voxel_size", voxel_size), sign,
        _arrays.positive("half_width_voxels", half_width_voxels),
    )


def level_set_to_mesh(
    level_set: Any, iso: float = 0.0, *, voxel_size: Optional[float] = None, origin: Sequence[float] = (0.0, 0.0, 0.0)
) -> Mesh:
    """The surface of a field where it is `iso`, oriented towards larger values, with unit normals.

    Args:
        level_set: a LevelSet, the path of a .vdb file, or a dense (nx, ny, nz) array of signed distances in world
            units, negative inside.
        iso: level, world units; its absolute value must be below the half width of the band.
        voxel_size: of a dense array: distance of neighbouring values, world units.
        origin: of a dense array: world position of its value [0, 0, 0].
    """
    if isinstance(level_set, (str, os.PathLike)):
        level_set = read_level_set(level_set)
    elif not isinstance(level_set, LevelSet):
        if voxel_size is None:
            raise InputError("voxel_size: expected the distance of a dense array's values", record="voxel_size")
        level_set = dense_to_level_set(level_set, voxel_size, origin=origin)
    return Mesh(**_glint.level_set_to_mesh(level_set, float(iso)))


def dense_to_level_set(
    values: Any, voxel_size: float, *, origin: Sequence[float] = (0.0, 0.0, 0.0), half_width_voxels: float = 3.0
) -> LevelSet:
    """A dense array of signed distances as a narrow-band level set.

    Args:
        values: (nx, ny, nz) numbers, world units, negative inside; values[i, j, k] lies at
            origin + voxel_size * (i, j, k). The rim of the array must be outside.
        voxel_size: world units.
        origin: (3,), world units.
        half_width_voxels: values beyond this many voxels are cut off.
    """
    dense = _arrays.floats("values", values, (None, None, None), np.float32)
    if 0 in dense.shape:
        raise InputError(f"values: expected at least one value, found shape {dense.shape}", record="values")
    return _glint.dense_to_level_set(
        dense, _arrays.floats("origin", origin, (3,)).tolist(), _arrays.positive("voxel_size", voxel_size),
        _arrays.positive("half_width_voxels", half_width_voxels),
    )


def level_set_to_dense(level_set: LevelSet) -> Tuple[np.ndarray, np.ndarray]:
    """The bounding box of the band of `level_set` as an array.

    Returns:
        values: (nx, ny, nz) float32, world units; beyond the band plus or minus its half width.
        world_from_index: (4, 4) float64: values[i, j, k] lies at (world_from_index @ [i, j, k, 1])[:3].
    """
    return level_set._to_dense()


def sample_level_set(level_set: LevelSet, points: Any) -> np.ndarray:
    """Trilinear values of a level set.

    Args:
        level_set: the field.
        points: (k, 3), world units.

    Returns:
        (k,) float64, world units; off the band plus or minus its half width.
    """
    return level_set._values(_arrays.floats("points", points, (None, 3)))[:, 0]


def level_set_gradient(level_set: LevelSet, points: Any) -> np.ndarray:
    """Gradients of a level set, about unit within the band, outward.

    Args:
        level_set: the field.
        points: (k, 3), world units.

    Returns:
        (k, 3) float64.
    """
    return level_set._gradients(_arrays.floats("points", points, (None, 3)))


def read_level_set(path: PathLike) -> LevelSet:
    """Reads the level set of the .vdb file `path`: the grid "surface", else the only one."""
    return _glint.read_level_set(os.fspath(path))


def write_level_set(path: PathLike, level_set: LevelSet) -> None:
    """Writes `level_set` as the .vdb file `path`, whole or not at all; it opens in Blender and Houdini."""
    _glint.write_level_set(os.fspath(path), level_set)


class ErrorStats(NamedTuple):
    """Of distances in world units, or angles in degrees."""

    count: int
    mean: float
    rms: float
    median: float
    p95: float
    max: float


class FScore(NamedTuple):
    """Shares of the samples closer than a threshold, a fraction of the reference's diagonal."""

    threshold_rel: float
    precision: float
    recall: float
    f: float


@dataclass
class Comparison:
    """How far a mesh is from a reference.

    Attributes:
        reference_diagonal: world units, the unit of every `_rel`.
        accuracy: distances from the mesh to the reference, world units.
        completeness: distances from the reference to the mesh, world units.
        chamfer: mean of the two means, world units.
        normal_deg: angles between the normals at the reference's vertices, degrees.
        f_scores: one for each threshold.
        mesh_distance: (n,) float32, of the mesh's vertices to the reference, world units.
        reference_distance: (m,) float32, of the reference's vertices to the mesh, world units.
        reference_normal_deg: (m,) float32, degrees, -1 where a normal is undefined.
    """

    reference_diagonal: float
    accuracy: ErrorStats
    completeness: ErrorStats
    chamfer: float
    normal_deg: ErrorStats
    f_scores: Sequence[FScore]
    mesh_distance: np.ndarray
    reference_distance: np.ndarray
    reference_normal_deg: np.ndarray


def compare(
    mesh: MeshLike,
    reference: MeshLike,
    *,
    num_samples: int = 100000,
    f_thresholds_rel: Sequence[float] = (0.005, 0.01),
    reference_mask: Any = None,
    progress: Optional[Callable[[Event], None]] = None,
) -> Comparison:
    """Measures a mesh against a reference, both in one frame.

    Args:
        mesh: a Mesh, or a pair (V, F).
        reference: the same.
        num_samples: on each surface.
        f_thresholds_rel: fractions of the reference's diagonal.
        reference_mask: (m,) flags of the reference's vertices: where to measure; None: everywhere.
        progress: called with every Event.
    """
    theirs = fields("reference", reference)
    flags = _arrays.mask("reference_mask", reference_mask, (len(theirs["vertices"]),))
    ours = fields("mesh", mesh)
    for name, given in (("mesh", ours), ("reference", theirs)):
        if len(given["faces"]) == 0:
            raise InputError(f"{name}: expected at least one face, found none", record=name)
    if num_samples < 1:
        raise InputError(f"num_samples: expected at least 1, found {num_samples}", record="num_samples")
    thresholds = [_arrays.positive("f_thresholds_rel", t) for t in f_thresholds_rel]
    found = _glint.compare(ours, theirs, num_samples, thresholds, flags, teller(progress))
    for name in ("accuracy", "completeness", "normal_deg"):
        found[name] = ErrorStats(**found[name])
    found["f_scores"] = [FScore(*(float(v) for v in row)) for row in found["f_scores"]]
    return Comparison(**found)


@dataclass
class Alignment:
    """How a mesh is laid on a reference.

    Attributes:
        reference_from_mesh: (4, 4) float64; x_in_reference = reference_from_mesh[:3, :3] @ x + reference_from_mesh[:3, 3].
        scale: of it; 1 if sizes were to stay.
        mean_rel: mean distance of the surfaces then, both ways, over the nine tenths that are closest; fraction of
            the reference's diagonal.
    """

    reference_from_mesh: np.ndarray
    scale: float
    mean_rel: float


def align(
    mesh: MeshLike,
    reference: MeshLike,
    *,
    with_scale: bool = True,
    progress: Optional[Callable[[Event], None]] = None,
) -> Alignment:
    """Finds the turn, move and scale that lay a mesh on a reference in any other frame.

    Surfaces of which less than about half is common to both are not found.

    Args:
        mesh: a Mesh, or a pair (V, F).
        reference: the same.
        with_scale: False: sizes stay.
        progress: called with every Event.
    """
    return Alignment(**_glint.align(fields("mesh", mesh), fields("reference", reference), with_scale, teller(progress)))
