"""The main job."""

from __future__ import annotations

import json
import os
import tempfile
from functools import cached_property
from pathlib import Path
from typing import Any, Callable, Dict, List, Mapping, Optional, Sequence, Union

from . import _glint
from ._config import settings
from ._mesh import LevelSet, Mesh, MeshLike, PathLike, read_level_set, read_mesh, write_mesh
from ._progress import Event, teller
from ._project import FoundLight, Highlights, Light, Project, read_lights, write_lights


class RunResult:
    """What a run left in its folder, read when it is asked for.

    Attributes:
        out: the folder.
        outcome: "done", "nothing to do", "stopped after STAGE"; of a folder that is opened later, as its report says.
    """

    def __init__(self, out: PathLike, outcome: str = ""):
        self.out = Path(out)
        self.outcome = outcome or self.report["outcome"]

    @cached_property
    def report(self) -> Dict[str, Any]:
        """report.json: what was done and found."""
        return json.loads((self.out / "report.json").read_text(encoding="utf-8"))

    @cached_property
    def mesh(self) -> Mesh:
        """The refined surface in COLMAP's frame, with normals and confidence."""
        return read_mesh(self.out / "mesh.ply")

    @cached_property
    def seed(self) -> Mesh:
        """The sparse surface that it started from."""
        return read_mesh(self.out / "seed.ply")

    @cached_property
    def level_set(self) -> LevelSet:
        """The signed distance field of the mesh."""
        return read_level_set(self.out / "sdf.vdb")

    @cached_property
    def lights(self) -> List[FoundLight]:
        """The lights as refined, and those that could not be determined."""
        return read_lights(self.out / "lights.json")

    @cached_property
    def highlights(self) -> Highlights:
        """Every candidate in the photographs, and what came of it in the end."""
        file = self.out / "stages" / "refined_highlights.json"
        return Highlights(**_glint.read_highlights(os.fspath(file), self.report["project"]["model"]))

    def __repr__(self) -> str:
        return f"RunResult({str(self.out)!r})"


def run(
    project: Union[Project, PathLike],
    out: PathLike,
    *,
    config: Optional[Mapping[str, Any]] = None,
    config_file: Optional[PathLike] = None,
    lights: Union[None, PathLike, Sequence[Light]] = None,
    mesh: Union[None, PathLike, MeshLike] = None,
    images: Optional[PathLike] = None,
    masks: Optional[PathLike] = None,
    normals: Optional[PathLike] = None,
    from_stage: str = "",
    until: str = "",
    progress: Optional[Callable[[Event], None]] = None,
) -> RunResult:
    """A COLMAP project in, a better mesh out: what `glint run PROJECT -o OUT` does.

    Args:
        project: as read, or its folder; the files on the disk count.
        out: folder for the results, made if need be.
        config: options to change: {"refine": {"voxel_rel": 0.01}}; see config_yaml().
        config_file: YAML file with options, applied before `config`.
        lights: the lights, or a lights file; None: found from the highlights.
        mesh: start from this mesh in the project's frame, not from the sparse points.
        images: folder of the images, if not in the project.
        masks: folder of masks, if not in the project.
        normals: folder of normal maps of the photographs, IMAGE.png or COLMAP's.
        from_stage: do this stage ("photos", "seed", "detect", "lights", "gate", "refine",
            "report") and those after it in any case;
            without it, only what is not done yet.
        until: stop after this stage.
        progress: called with every Event, on the calling thread; what it raises ends the run.

    Raises:
        InputError: bad project, file or option.
        NoResultError: no honest result, for example no highlights; what was found is in `out`.
        KeyboardInterrupt: Ctrl-C; finished stages are kept.
    """
    if isinstance(project, Project):
        images = images or project.image_path
        masks = masks or project.mask_path
        project = project.path
    with tempfile.TemporaryDirectory(prefix="glint-") as folder:
        if lights is not None and not isinstance(lights, (str, os.PathLike)):
            write_lights(Path(folder) / "lights.json", lights)
            lights = Path(folder) / "lights.json"
        if mesh is not None and not isinstance(mesh, (str, os.PathLike)):
            write_mesh(Path(folder) / "mesh.ply", mesh)
            mesh = Path(folder) / "mesh.ply"
        given = {"project": project, "out": out, "config": config_file, "lights": lights, "mesh": mesh}
        given.update(images=images, masks=masks, normals=normals)
        paths = {name: os.fspath(path or "") for name, path in given.items()}
        outcome = _glint.run(paths, settings(config), from_stage, until, teller(progress))
    return RunResult(out, outcome)
