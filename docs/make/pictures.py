#!/usr/bin/env python3
"""pictures.py GLINT DOCS WORK: draws every picture below DOCS anew that the project can make, and writes the table of
the gallery. WORK keeps the reconstructions that they show."""
import shutil
import sys
from pathlib import Path

import numpy as np
from PIL import Image

import diagrams
import gallery
import glint
from drawing import BLUE, Canvas, GREEN, GREY, INK, ORANGE, RED, save


def photographs(project, result):
    """Photographs from all around, with a ring around each highlight that was accepted."""
    found = glint.read_project(project)
    accepted = result.highlights.accepted
    ids, px = result.highlights.image_id[accepted], result.highlights.px[accepted]
    seen = sorted(set(int(i) for i in ids), key=lambda i: found.images[i].name)
    canvas = Canvas(4 * 240 + 3 * 6, 180)
    for k, image_id in enumerate(seen[:: max(1, len(seen) // 4)][:4]):
        shown = Image.open(found.image_path / found.images[image_id].name).convert("RGB")
        canvas.paste(shown.resize((240, 180), Image.LANCZOS), (k * 246, 0))
        for at in px[ids == image_id] * 240 / shown.width:
            canvas.ring(at + [k * 246, 0], 14, (90, 220, 120), 2)
    return canvas.finished()


def level_set(project, result):
    """Where a plane through the middle cuts the seed, the refined surface and the truth."""
    truth = glint.read_mesh(project / "truth/mesh.ply")
    low, high = truth.vertices.min(axis=0), truth.vertices.max(axis=0)
    middle, half = (low + high) / 2, 0.56 * (high - low).max()
    width = height = 460
    u, v = np.meshgrid(np.linspace(-half, half, width), np.linspace(-half, half, height))
    points = middle + np.column_stack([u.ravel(), v.ravel(), np.zeros(u.size)])
    picture = np.full((height, width, 3), 255.0)
    for mesh, color, thick in ((truth, (205, 205, 205), 5.0), (result.seed, ORANGE, 1.2), (result.mesh, BLUE, 1.2)):
        d = glint.signed_distance(mesh.vertices, mesh.faces, points).reshape(height, width) / (2 * half / width)
        cover = np.clip(thick / 2 + 0.5 - np.abs(d), 0, 1)[..., None]
        picture = picture * (1 - cover) + np.array(color) * cover
    canvas = Canvas(width + 200, height)
    canvas.paste(Image.fromarray(picture.astype(np.uint8)), (0, 0))
    for k, (name, color) in enumerate((("truth", (190, 190, 190)), ("seed", ORANGE), ("refined", BLUE))):
        canvas.line([[width + 20, 60 + 30 * k], [width + 60, 60 + 30 * k]], color, 5 if k == 0 else 2)
        canvas.text([width + 72, 60 + 30 * k], name)
    return canvas.finished()


def votes(project, result):
    """What each accepted highlight says of the light, with the seed's normal where its ray meets it."""
    images = glint.read_project(project).images
    cameras = glint.read_project(project).cameras
    seed = result.seed
    origins, rays = [], []
    for image_id, px in zip(result.highlights.image_id[result.highlights.accepted], result.highlights.px[result.highlights.accepted]):
        image = images[int(image_id)]
        fx, fy, cx, cy = cameras[image.camera_id].params
        ray = np.array([(px[0] - cx) / fx, (px[1] - cy) / fy, 1.0])
        rays.append(image.cam_from_world.rotation.T @ (ray / np.linalg.norm(ray)))
        origins.append(image.projection_center())
    x, rays = np.array(origins), np.array(rays)
    for _ in range(60):  # step forward by the distance: it cannot pass the surface
        found = glint.closest_points(seed.vertices, seed.faces, x)
        x = x + np.maximum(found.distance, 0)[:, None] * rays
    hit = found.distance < 0.01 * seed.diagonal
    corners = seed.vertices[seed.faces]
    area = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    normals = np.zeros_like(seed.vertices)
    for k in range(3):
        np.add.at(normals, seed.faces[:, k], area)
    n = np.einsum("kc,kcd->kd", found.barycentric, normals[seed.faces[found.face]])
    n /= np.linalg.norm(n, axis=1)[:, None]
    return (2 * np.sum(n * -rays, axis=1)[:, None] * n + rays)[hit]


def lights(project, result):
    truth = np.asarray(glint.read_lights(project / "truth/lights.json")[0].vector)
    found = np.asarray(result.lights[0].vector)
    across = np.linalg.svd(truth[None])[2][1:]
    at = lambda l: np.array([230, 230]) + 5 * np.degrees(np.arccos(np.clip(l @ truth, -1, 1))) * (across @ l) / max(1e-12, np.linalg.norm(across @ l))
    canvas = Canvas(720, 460)
    for degrees in (10, 20, 30, 40):
        canvas.ring([230, 230], 5 * degrees, (215, 215, 215))
        canvas.text([230 + 5 * degrees * 0.707 + 4, 230 + 5 * degrees * 0.707 + 4], f"{degrees}°", GREY, 12)
    all_votes = votes(project, result)
    for l in all_votes:
        canvas.dot(at(l), 2.2, BLUE)
    for direction, color in ((truth, INK), (found, RED)):
        p = at(direction)
        canvas.line([p - [9, 0], p + [9, 0]], color, 2.2)
        canvas.line([p - [0, 9], p + [0, 9]], color, 2.2)
    error = np.degrees(np.arccos(np.clip(found @ truth / np.linalg.norm(found), -1, 1)))
    canvas.dot([480, 100], 3, BLUE)
    canvas.text([495, 100], f"{len(all_votes)} highlights' guesses", BLUE)
    canvas.text([480, 130], "+  the true light", INK)
    canvas.text([480, 160], "+  found and refined:", RED)
    canvas.text([500, 185], f"{error:.1f}° off", RED)
    return canvas.finished()


def confidence(project, result):
    """The refined surface in colours from unknown (dark) to measured (bright), from the view in which it differs most."""
    mesh = result.mesh
    sure = mesh.attributes["confidence"]

    def contrast(image):
        to_camera = image.projection_center() - mesh.vertices
        return np.std(sure[np.sum(mesh.normals * to_camera, axis=1) > 0])

    image = max(glint.read_project(project).images.values(), key=contrast)
    x = image.cam_from_world * mesh.vertices
    normals = mesh.normals @ image.cam_from_world.rotation.T
    uv = x[:, :2] / x[:, 2:]
    low, high = uv.min(axis=0), uv.max(axis=0)
    scale = 430 / (high - low).max()
    uv = (uv - (low + high) / 2) * scale + [230, 230]
    dark, bright = np.array([48, 36, 92]), np.array([250, 220, 70])
    c = sure[:, None]
    color = (dark + (bright - dark) * c) * (0.45 + 0.55 * np.clip(-normals[:, 2:], 0, 1))
    canvas = Canvas(620, 460)
    order = np.argsort(-x[mesh.faces, 2].mean(axis=1))
    for face in mesh.faces[order]:
        if normals[face, 2].mean() < 0:
            canvas.polygon(uv[face], tuple(int(v) for v in color[face].mean(axis=0)))
    for k in range(200):
        canvas.line([[520, 350 - k], [550, 350 - k]], tuple(int(v) for v in dark + (bright - dark) * k / 199), 1.4)
    canvas.text([535, 132], "1  measured", anchor="mm", size=13)
    canvas.text([535, 368], "0  inferred", anchor="mm", size=13)
    return canvas.finished()


def main():
    program, docs, work = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), Path(sys.argv[3]).resolve()
    out = docs / "images"
    work.mkdir(parents=True, exist_ok=True)
    save(diagrams.signed_distance(), out / "signed_distance.png", 64)
    save(diagrams.highlight(), out / "highlight.png", 64)
    save(diagrams.specular_bundle(), out / "specular_bundle.png", 64)
    save(diagrams.shading(), out / "shading.png", 64)
    shutil.copytree(docs.parent / "configs", work / "configs", dirs_exist_ok=True)  # named by the gallery's commands
    gallery.make(program, docs / "gallery.md", work)
    project, result = work / "blob", glint.RunResult(work / "blob-out")
    save(photographs(project, result), out / "photographs.png", 256)
    save(level_set(project, result), out / "level_set.png", 64)
    save(lights(project, result), out / "lights.png", 32)
    save(confidence(project, result), out / "confidence.png", 256)


main()
