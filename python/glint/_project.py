"""COLMAP projects, highlights and lights."""

from __future__ import annotations

import os
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Union

import numpy as np

from . import _arrays, _glint
from ._config import settings
from ._errors import InputError
from ._mesh import MeshLike, PathLike, fields
from ._progress import Event, teller


@dataclass
class Rigid3d:
    """x_in_b = rotation @ x_in_a + translation, as pycolmap.Rigid3d.

    Attributes:
        rotation: (3, 3) float64. (pycolmap: `rotation.matrix()`.)
        translation: (3,) float64, world units.
    """

    rotation: np.ndarray
    translation: np.ndarray

    def matrix(self) -> np.ndarray:
        """[rotation | translation], (3, 4)."""
        return np.column_stack([self.rotation, self.translation])

    def inverse(self) -> "Rigid3d":
        """a_from_b of b_from_a."""
        return Rigid3d(self.rotation.T, -self.rotation.T @ self.translation)

    def __mul__(self, points: Any) -> np.ndarray:
        """Points (k, 3) or (3,) in the other frame."""
        return np.asarray(points) @ self.rotation.T + self.translation


@dataclass
class Camera:
    """As pycolmap.Camera.

    Attributes:
        camera_id: COLMAP's.
        model: COLMAP's name, for example "PINHOLE".
        width, height: pixels.
        params: float64 in COLMAP's order. The centre of the first pixel is (0.5, 0.5).
    """

    camera_id: int
    model: str
    width: int
    height: int
    params: np.ndarray


@dataclass
class Image:
    """A registered image, as pycolmap.Image.

    Attributes:
        image_id: COLMAP's.
        name: relative to the image folder.
        camera_id: its camera's.
        cam_from_world: the pose.
        points2D: (n, 2) float64, pixels.
        point3D_ids: (n,) int64, the 3D point that each belongs to, -1: none.
    """

    image_id: int
    name: str
    camera_id: int
    cam_from_world: Rigid3d
    points2D: np.ndarray
    point3D_ids: np.ndarray

    def projection_center(self) -> np.ndarray:
        """(3,) centre of the camera in the world."""
        return self.cam_from_world.inverse().translation


@dataclass
class Points3D:
    """All sparse points at once. The track of point i is [track_offsets[i], track_offsets[i + 1]) of the track arrays.

    Attributes:
        ids: (n,) int64, COLMAP's.
        xyz: (n, 3) float64, world units.
        color: (n, 3) uint8.
        error: (n,) float64, mean reprojection error in pixels, -1: unknown.
        track_offsets: (n + 1,) int64.
        track_image_ids: (t,) int64.
        track_point2D_idxs: (t,) int64.
    """

    ids: np.ndarray
    xyz: np.ndarray
    color: np.ndarray
    error: np.ndarray
    track_offsets: np.ndarray
    track_image_ids: np.ndarray
    track_point2D_idxs: np.ndarray

    def __len__(self) -> int:
        return len(self.ids)


@dataclass
class Project:
    """A COLMAP project as its files say it.

    Attributes:
        path: as given.
        model_path: the folder of the model.
        image_path, mask_path: folders, or None where there are none.
        cameras: by camera_id.
        images: by image_id; registered ones only.
        points3D: the sparse points.
        warnings: what was chosen or repaired in reading.
    """

    path: Path
    model_path: Path
    image_path: Optional[Path]
    mask_path: Optional[Path]
    cameras: Dict[int, Camera]
    images: Dict[int, Image]
    points3D: Points3D
    warnings: List[str]


def read_project(path: PathLike, *, images: Optional[PathLike] = None, masks: Optional[PathLike] = None) -> Project:
    """Reads a COLMAP 3.x or 4.x project, binary or text, of any usual layout.

    Args:
        path: the project's folder, or the model's.
        images: folder of the images, if not in the project.
        masks: folder of masks (IMAGE.png, 0 is ignored), if not in the project.

    Raises InputError naming file and record.
    """
    found = _glint.read_project(os.fspath(path), os.fspath(images or ""), os.fspath(masks or ""))
    found["cameras"] = {key: Camera(**camera) for key, camera in found["cameras"].items()}
    for image in found["images"].values():
        matrix = image["cam_from_world"]
        image["cam_from_world"] = Rigid3d(matrix[:, :3].copy(), matrix[:, 3].copy())
    found["images"] = {key: Image(**image) for key, image in found["images"].items()}
    found["points3D"] = Points3D(**found["points3D"])
    return Project(**found)


@dataclass
class Highlights:
    """Specular highlights, an entry each.

    Attributes:
        image_id: (n,) int64, COLMAP's; -1 where they come from a single array.
        px: (n, 2) float64, sub-pixel peak (x, y) in COLMAP's frame: the centre of the first pixel is (0.5, 0.5).
        covariance_px: (n, 2, 2) float64, of the peak, pixels squared.
        moments_px: (n, 2, 2) float64, second central moments of the blob, pixels squared.
        area_px: (n,) float64, pixels.
        strength: (n,) float64, peak specular residual, 1 is sensor white.
        saturated_fraction: (n,) float64, of the blob's pixels.
        light: (n,) int64, the light that it mirrors, -1: none assigned.
        status: n names: "accepted", or why it is not used.
    """

    image_id: np.ndarray
    px: np.ndarray
    covariance_px: np.ndarray
    moments_px: np.ndarray
    area_px: np.ndarray
    strength: np.ndarray
    saturated_fraction: np.ndarray
    light: np.ndarray
    status: List[str]

    def __len__(self) -> int:
        return len(self.px)

    @property
    def accepted(self) -> np.ndarray:
        """(n,) bool."""
        return np.array([s == "accepted" for s in self.status], dtype=bool)


def detect_highlights(
    image: Any, mask: Any = None, *, order: str = "rgb", config: Optional[Mapping[str, Any]] = None
) -> Highlights:
    """Candidate highlights of one image, strongest first.

    Args:
        image: (h, w, 3) or (h, w), uint8 or uint16, sRGB encoded.
        mask: (h, w) flags, 0 where the image is to be ignored.
        order: of the channels, "rgb" or (OpenCV's) "bgr".
        config: options to change, for example {"detect": {"min_strength": 0.1}}.

    Surface, lights and paint that stays put are judged later, over all views; see run().
    """
    pixels = _arrays.image("image", image, order)
    flags = _arrays.mask("mask", mask, pixels.shape[:2])
    return Highlights(**_glint.detect_highlights(pixels, flags, settings(config)))


@dataclass
class Light:
    """A light source.

    Attributes:
        type: "distant" or "point".
        frame: "world" (hand-held camera) or "camera" (flash, turntable).
        vector: (3,) unit direction to the light, or its position (world units), in the frame's axes.
        sigma: standard deviation, degrees (distant) or world units (point); 0: taken as exact.
    """

    type: str
    frame: str
    vector: np.ndarray
    sigma: float = 0.0


@dataclass
class FoundLight(Light):
    """A light that was found from highlights.

    Attributes:
        covariance: (3, 3) float64 of the vector, radians squared or world units squared.
        support: highlights that it explains (expected number).
        conditioning: least over largest eigenvalue of its normal equations, in [0, 1].
        determined: False: not to be used.
        why: it is not determined.
    """

    covariance: np.ndarray = field(default_factory=lambda: np.zeros((3, 3)))
    support: float = 0.0
    conditioning: float = 0.0
    determined: bool = True
    why: str = ""


def find_lights(
    project: Union[Project, PathLike],
    mesh: MeshLike,
    *,
    config: Optional[Mapping[str, Any]] = None,
    progress: Optional[Callable[[Event], None]] = None,
) -> List[FoundLight]:
    """Lights from the highlights in a project's photographs and the normals of a mesh that is about right.

    Args:
        project: as read, or its folder; the files on the disk count.
        mesh: the surface in the project's frame: a Mesh, or a pair (V, F).
        config: options to change; of interest are the sections "detect", "gate" and "lights".
        progress: called with every Event.

    Returns:
        Those that are determined first. An empty list is an honest answer.
    """
    images = masks = ""
    if isinstance(project, Project):
        images, masks = os.fspath(project.image_path or ""), os.fspath(project.mask_path or "")
        project = project.path
    found = _glint.find_lights(
        os.fspath(project), images, masks, fields("mesh", mesh), settings(config), teller(progress)
    )
    return [FoundLight(**light) for light in found]


def read_lights(path: PathLike) -> List[FoundLight]:
    """Reads the lights file `path` (JSON), also those that could not be determined."""
    return [FoundLight(**light) for light in _glint.read_lights(os.fspath(path))]


def write_lights(path: PathLike, lights: Sequence[Light]) -> None:
    """Writes `lights` as the file `path` (JSON) that `glint run --lights` reads."""
    checked = []
    for k, light in enumerate(lights):
        for name, known in (("type", ("distant", "point")), ("frame", ("world", "camera"))):
            if getattr(light, name) not in known:
                raise InputError(
                    f"lights[{k}].{name}: expected one of {', '.join(known)}, found {getattr(light, name)!r}",
                    record=f"lights[{k}]",
                )
        vector = _arrays.floats(f"lights[{k}].vector", light.vector, (3,))
        if not vector.any():
            raise InputError(f"lights[{k}].vector: expected a direction or position, found zero", record=f"lights[{k}]")
        if light.type == "distant":
            vector = vector / np.linalg.norm(vector)
        checked.append({"type": light.type, "frame": light.frame, "vector": vector.tolist(), "sigma": float(light.sigma)})
    if not checked:
        raise InputError("lights: expected at least one, found none", record="lights")
    _glint.write_lights(os.fspath(path), checked)
