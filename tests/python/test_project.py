import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest

import glint

QUICK = {
    "refine": {"voxel_rel": 0.03, "levels": 1, "max_iterations": 2},
    "seed": {"open_hollows": False, "outlines": {"use": "none"}, "smooth": {"edge_rel": 0.03}},
    "output.overlays": False,
}


def project_pinhole(camera, image, points):
    """Pixels of world points, by hand: the convention that read_project() promises."""
    fx, fy, cx, cy = camera.params
    x = image.cam_from_world * points
    return np.column_stack([fx * x[:, 0] / x[:, 2] + cx, fy * x[:, 1] / x[:, 2] + cy])


def test_read_project(project):
    found = glint.read_project(project)
    assert len(found.images) == 12 and len(found.cameras) == 1 and found.image_path is not None
    points = found.points3D
    assert points.xyz.shape == (len(points), 3) and points.color.dtype == np.uint8
    assert points.track_offsets[-1] == len(points.track_image_ids) == len(points.track_point2D_idxs)
    where = {int(point_id): i for i, point_id in enumerate(points.ids)}
    errors = []
    for image in found.images.values():
        camera = found.cameras[image.camera_id]
        assert camera.model == "PINHOLE" and (camera.width, camera.height) == (240, 180)
        seen = image.point3D_ids >= 0
        xyz = points.xyz[[where[int(i)] for i in image.point3D_ids[seen]]]
        errors.append(np.linalg.norm(project_pinhole(camera, image, xyz) - image.points2D[seen], axis=1))
    errors = np.concatenate(errors)
    assert len(errors) == points.track_offsets[-1] and np.median(errors) < 1.5


def test_tracks_and_images_refer_to_each_other(project):
    found = glint.read_project(project)
    points = found.points3D
    for i in (0, len(points) // 2, len(points) - 1):
        for t in range(points.track_offsets[i], points.track_offsets[i + 1]):
            image = found.images[int(points.track_image_ids[t])]
            assert image.point3D_ids[points.track_point2D_idxs[t]] == points.ids[i]


def test_poses(project):
    image = next(iter(glint.read_project(project).images.values()))
    pose = image.cam_from_world
    np.testing.assert_allclose(pose * image.projection_center(), 0, atol=1e-9)
    np.testing.assert_allclose(pose.inverse() * (pose * np.eye(3)), np.eye(3), atol=1e-9)
    assert pose.matrix().shape == (3, 4) and np.linalg.det(pose.rotation) == pytest.approx(1)


def test_read_project_errors(tmp_path):
    with pytest.raises(glint.InputError, match="no-such-folder") as raised:
        glint.read_project(tmp_path / "no-such-folder")
    assert "no-such-folder" in raised.value.path


def test_real_project():
    vase = Path(os.environ["GLINT_SOURCE_DIR"]).resolve().parent / "shared" / "data" / "vase" / "project"
    if not vase.is_dir():
        pytest.skip(f"{vase} is not there")
    found = glint.read_project(vase)
    assert len(found.images) >= 8 and len(found.points3D) > 100


def spot(shift=0.0):
    """A grey image with one round highlight; its peak is at (60.5 + shift, 40.5) in COLMAP's frame."""
    y, x = np.mgrid[0:80, 0:120].astype(float)
    lobe = np.exp(-((x - 60 - shift) ** 2 + (y - 40) ** 2) / (2 * 4.0**2))
    image = np.full((80, 120, 3), [40, 50, 90], dtype=float)
    return np.clip(image + 150 * lobe[:, :, None], 0, 255).astype(np.uint8)


def test_detect_highlights():
    found = glint.detect_highlights(spot(0.25))
    assert len(found) >= 1 and found.status[0] == "accepted" and found.accepted[0]
    np.testing.assert_allclose(found.px[0], [60.75, 40.5], atol=0.15)
    assert found.covariance_px.shape == found.moments_px.shape == (len(found), 2, 2)
    assert found.image_id[0] == -1 and found.light[0] == -1


def test_detect_highlights_input():
    image = spot()
    there = glint.detect_highlights(image).px[0]
    np.testing.assert_array_equal(glint.detect_highlights(image[:, :, ::-1], order="bgr").px[0], there)
    np.testing.assert_allclose(glint.detect_highlights(image.astype(np.uint16) * 257).px[0], there, atol=0.05)
    keep = np.ones(image.shape[:2], bool)
    keep[20:60, 40:80] = False
    masked = glint.detect_highlights(image, keep)
    assert not masked.accepted.any()
    assert not glint.detect_highlights(image, config={"detect": {"min_strength": 0.99}}).accepted.any()
    with pytest.raises(glint.InputError, match="image: expected dtype uint8 or uint16, found float64"):
        glint.detect_highlights(image / 255)
    with pytest.raises(glint.InputError, match=r"image: expected an array of shape \(h, w, 3\)"):
        glint.detect_highlights(image[:, :, :2])
    with pytest.raises(glint.InputError, match="mask: expected an array of shape"):
        glint.detect_highlights(image, keep[1:])
    with pytest.raises(glint.InputError, match="order"):
        glint.detect_highlights(image, order="hsv")


def test_config():
    assert "voxel_rel: 0.02" in glint.config_yaml({"refine": {"voxel_rel": 0.02}})
    assert glint.config_yaml({"refine.voxel_rel": 0.02}) == glint.config_yaml({"refine": {"voxel_rel": 0.02}})
    with pytest.raises(glint.InputError) as raised:
        glint.config_yaml({"refine": {"voxel_rl": 0.02, "levels": -3}, "output": {"overlays": "perhaps"}})
    for part in ("refine.voxel_rl", "refine.voxel_rel", "refine.levels", "output.overlays"):
        assert part in str(raised.value)
    assert "--set" not in str(raised.value)
    with pytest.raises(glint.InputError, match="config: expected a dictionary"):
        glint.config_yaml(["refine.levels=2"])


def test_lights_file(tmp_path):
    lights = [glint.Light("distant", "world", [0, 0, 2], 0.5), glint.Light("point", "camera", [0.1, 0, 0])]
    glint.write_lights(tmp_path / "lights.json", lights)
    again = glint.read_lights(tmp_path / "lights.json")
    assert [(l.type, l.frame, l.sigma) for l in again] == [("distant", "world", 0.5), ("point", "camera", 0.0)]
    np.testing.assert_allclose(again[0].vector, [0, 0, 1])
    with pytest.raises(glint.InputError, match=r"lights\[0\].type"):
        glint.write_lights(tmp_path / "lights.json", [glint.Light("sun", "world", [0, 0, 1])])
    with pytest.raises(glint.InputError, match=r"lights\[0\].vector"):
        glint.write_lights(tmp_path / "lights.json", [glint.Light("distant", "world", [0, 0, 0])])


def test_find_lights(project):
    truth = glint.read_lights(project / "truth" / "lights.json")[0]
    events = []
    found = glint.find_lights(project, glint.read_mesh(project / "truth" / "mesh.ply"), progress=events.append)
    assert found and found[0].determined
    cosine = np.dot(found[0].vector, truth.vector) / np.linalg.norm(found[0].vector) / np.linalg.norm(truth.vector)
    assert np.degrees(np.arccos(min(cosine, 1))) < 5
    assert any(e.kind == "begin" and e.total == 12 for e in events)


def test_run(project, tmp_path):
    events = []
    lights = glint.read_lights(project / "truth" / "lights.json")
    result = glint.run(glint.read_project(project), tmp_path / "out", lights=lights, config=QUICK, progress=events.append)
    assert {"begin", "end", "info"} <= {e.kind for e in events}
    assert result.report["outcome"] == "done" and result.report["command"] == "glint.run"
    assert len(result.mesh.faces) == result.report["mesh"]["faces"] > 100
    assert set(result.mesh.attributes) >= {"confidence", "sigma_position_rel", "sigma_normal_deg"}
    assert result.level_set.num_active_voxels > 100 and len(result.seed.faces) > 10
    assert result.lights[0].type == "distant"
    assert len(result.highlights) > 5 and result.highlights.accepted.any()
    assert set(result.highlights.image_id) <= set(glint.read_project(project).images)
    again = glint.run(project, tmp_path / "out", lights=lights, config=QUICK)
    assert again.outcome == "nothing to do" and len(again.mesh.faces) == len(result.mesh.faces)
    assert glint.RunResult(tmp_path / "out").outcome == "done"
    truth = glint.read_mesh(project / "truth" / "mesh.ply")
    assert glint.compare(result.mesh, truth, num_samples=5000).accuracy.mean < 0.02 * truth.diagonal


def test_run_until(project, tmp_path):
    result = glint.run(project, tmp_path / "out", config=QUICK, until="seed")
    assert result.outcome == "stopped after seed" and len(result.seed.faces) > 10


def test_run_errors(project, tmp_path):
    with pytest.raises(glint.InputError, match="refine.voxel_rel"):
        glint.run(project, tmp_path / "out", config={"refine.voxel_rel": 7})
    with pytest.raises(glint.InputError, match="expected one of photos, seed, detect, lights, gate, refine, report"):
        glint.run(project, tmp_path / "out", until="sed")
    with pytest.raises(glint.InputError, match="nothing-here"):
        glint.run(tmp_path / "nothing-here", tmp_path / "out")
    with pytest.raises(glint.NoResultError):
        glint.run(project, tmp_path / "dark", config={**QUICK, "detect.min_strength": 0.99})


def test_what_the_listener_raises_ends_the_run(project, tmp_path):
    class Enough(Exception):
        pass

    def listener(event):
        if event.kind == "begin" and "highlights" in event.text:
            raise Enough

    with pytest.raises(Enough):
        glint.run(project, tmp_path / "out", config=QUICK, progress=listener)
    assert not (tmp_path / "out" / "mesh.ply").exists()


CTRL_C = """
import sys, glint
try:
    glint.run(sys.argv[1], sys.argv[2], config={"refine.voxel_rel": 0.004}, progress=lambda e: print(e, flush=True))
except KeyboardInterrupt:
    print("interrupted", flush=True)
    sys.exit(7)
"""


def test_ctrl_c(project, tmp_path):
    child = subprocess.Popen([sys.executable, "-c", CTRL_C, project, tmp_path / "out"], stdout=subprocess.PIPE, text=True)
    try:
        assert "Event" in child.stdout.readline()
        child.send_signal(signal.SIGINT)
        sent = time.monotonic()
        said, _ = child.communicate(timeout=60)
    finally:
        child.kill()
    assert child.returncode == 7 and "interrupted" in said
    assert time.monotonic() - sent < 20
    assert not (tmp_path / "out" / "mesh.ply").exists()
