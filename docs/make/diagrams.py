"""The pictures of the concepts that need no reconstruction."""
import numpy as np

import glint
from drawing import BLUE, Canvas, GREEN, GREY, INK, ORANGE, RED
from PIL import Image


def signed_distance():
    """A slice through a star of sharp tips, coloured by its exact signed distance."""
    # Each face of an octahedron carries a tall pyramid: edges and vertices with very different angles.
    corners = np.array([[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]], float)
    V, F = list(0.55 * corners), []
    for x in (0, 1):
        for y in (2, 3):
            for z in (4, 5):
                face = [x, y, z] if (x + y + z) % 2 == 0 else [y, x, z]
                V.append(0.95 * corners[face].sum(axis=0) / np.sqrt(3))
                F += [[face[k], face[(k + 1) % 3], len(V) - 1] for k in range(3)]
    width, height = 620, 400
    u, v = np.meshgrid(np.linspace(-1.55, 1.55, width), np.linspace(1.0, -1.0, height))
    # The plane holds the z axis and the direction (1, 1, 0): it cuts four tips along their length.
    points = np.column_stack([u.ravel() / np.sqrt(2), u.ravel() / np.sqrt(2), v.ravel()])
    d = glint.signed_distance(np.array(V), np.array(F), points).reshape(height, width)
    steps = np.floor(np.abs(d) / 0.05)
    light = np.clip(0.35 + 0.09 * steps, 0, 0.93)[..., None]
    color = np.where((d < 0)[..., None], np.array(ORANGE), np.array(BLUE))
    color = color + (255 - color) * light
    edge = np.clip(1.6 - np.abs(d) / (3.1 / width), 0, 1)[..., None]
    return Image.fromarray((color * (1 - edge) + np.array(INK) * edge).astype(np.uint8))


def highlight():
    canvas = Canvas(720, 380)
    camera, far = np.array([70.0, 70.0]), np.array([650.0, 300.0])
    ray = (far - camera) / np.linalg.norm(far - camera)
    to_light = np.array([0.42, -0.907])
    half = -ray + to_light
    half /= np.linalg.norm(half)
    canvas.dashes(camera, camera + ray * 640, GREY)
    for t, main in ((250, False), (400, True), (550, False)):
        x = camera + ray * t
        along = np.array([-half[1], half[0]])
        bend = [x + along * s - half * s * s / 220 for s in np.linspace(-75, 75, 40)]
        canvas.line(bend, INK if main else GREY, 3 if main else 1.5)
        canvas.arrow(x, x + half * 80, GREEN if main else (150, 200, 170), 3 if main else 2)
        canvas.dot(x, 5 if main else 4, ORANGE)
        if main:
            canvas.arrow(x, x - ray * 95, BLUE, 2.5)
            canvas.arrow(x, x + to_light * 95, RED, 2.5)
            canvas.text(x - ray * 108 + [0, 16], "v", BLUE, 18, "mm")
            canvas.text(x + to_light * 108, "l", RED, 18, "mm")
            canvas.text(x + half * 94, "n", GREEN, 18, "mm")
    canvas.polygon([camera + [-24, -16], camera + [6, -16], camera + [6, 16], camera + [-24, 16]], INK)
    canvas.polygon([camera + [6, -6], camera + [18, -12], camera + [18, 12], camera + [6, 6]], INK)
    canvas.text([40, 30], "camera", INK)
    canvas.text([590, 30], "to the lamp", RED, 15, "mm")
    canvas.arrow([650, 60], np.array([650, 60]) + to_light * 45, RED)
    canvas.text([70, 350], "the highlight fixes n, the same at every depth: which of the surfaces is it?", INK, 15)
    return canvas.finished()


def _contacts():
    """Rays from cameras on an arc to a curve in the plane, with its true normals where they meet."""
    angles = np.radians(np.linspace(205, 335, 14))
    radius = 1 + 0.08 * np.cos(3 * angles)
    x = radius[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    slope = -0.24 * np.sin(3 * angles)
    tangent = slope[:, None] * np.column_stack([np.cos(angles), np.sin(angles)])
    tangent += radius[:, None] * np.column_stack([-np.sin(angles), np.cos(angles)])
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    centers = 2.4 * np.column_stack([np.cos(angles * 0.7 + 1.42), np.sin(angles * 0.7 + 1.42)])
    rays = x - centers
    depth = np.linalg.norm(rays, axis=1)
    return centers, rays / depth[:, None], depth, normal


def _solve(centers, rays, depth, normal, known):
    """All depths at once: chords orthogonal to the mean normals, and one place that is known."""
    rows, right = [], []
    for i in range(len(depth) - 1):
        mean = normal[i] + normal[i + 1]
        mean /= np.linalg.norm(mean)
        row = np.zeros(len(depth))
        row[i], row[i + 1] = -mean @ rays[i], mean @ rays[i + 1]
        rows.append(row)
        right.append(-mean @ (centers[i + 1] - centers[i]))
    for i in known:
        rows.append(np.eye(len(depth))[i])
        right.append(depth[i])
    return np.linalg.lstsq(np.array(rows), np.array(right), rcond=None)[0]


def specular_bundle():
    centers, rays, truth, normal = _contacts()
    rough = truth + 0.13 * np.sin(np.arange(len(truth)) * 2.3)
    rough[-1] = truth[-1]
    solved = _solve(centers, rays, truth, normal, known=[0, len(truth) - 1])
    error = np.abs(solved - truth).max()
    canvas = Canvas(860, 330)
    for left, depth, title in ((0, rough, "depths from the rough seed"), (430, solved, "depths that agree with the normals")):
        at = lambda p: np.array([left + 215 + 150 * p[0], 20 - 175 * p[1]])
        for c, d, t, n in zip(centers, rays, depth, normal):
            x = c + t * d
            canvas.line([at(x), at(x - 0.45 * d)], (215, 215, 215), 1)
            canvas.arrow(at(x), at(x + 0.2 * n), GREEN, 1.6, 6)
        canvas.line([at(c + t * d) for c, d, t in zip(centers, rays, depth)], ORANGE if left == 0 else BLUE, 2.2)
        canvas.line([at(c + t * d) for c, d, t in zip(centers, rays, truth)], INK, 0.8)
        for c, d, t in zip(centers, rays, depth):
            canvas.dot(at(c + t * d), 3.2, ORANGE if left == 0 else BLUE)
        canvas.text([left + 215, 22], title, INK, 15, "mm")
    canvas.text([430, 310], f"thin: the truth. Two places are known; the largest error of the others is {100 * error:.1f} % of the radius.", INK, 13, "mm")
    return canvas.finished()


def shading():
    """A matte ball in one light, lines of equal brightness on it, and what one brightness says of a normal."""
    radius, size = 150, 380
    center = np.array([190.0, 190.0])
    light = np.array([-0.5, 0.55, 0.67])
    light /= np.linalg.norm(light)
    x, y = np.meshgrid((np.arange(size) + 0.5 - center[0]) / radius, (center[1] - np.arange(size) - 0.5) / radius)
    inside = x * x + y * y < 1
    z = np.sqrt(np.clip(1 - x * x - y * y, 0, 1))
    cosine = np.clip(x * light[0] + y * light[1] + z * light[2], 0, 1)
    line = np.abs((cosine * 8 + 0.5) % 1 - 0.5) < 0.035
    grey = np.where(line & (cosine > 0.05), 250, 40 + 175 * cosine)
    ball = np.where(inside[..., None], grey[..., None] * np.array([1.0, 0.62, 0.45]), 255).astype(np.uint8)
    canvas = Canvas(720, 380)
    canvas.paste(Image.fromarray(ball), (0, 0))
    canvas.arrow(center + [-95, -105], center + [-160, -175], RED)
    canvas.text(center + [-160, -182], "l", RED, 18, "mm")
    foot, axis = np.array([540.0, 260.0]), np.array([-0.45, -0.893])
    for turn in np.linspace(0, 2 * np.pi, 24, endpoint=False):
        side = np.array([-axis[1], axis[0]]) * 62 * np.cos(turn) + axis * 14 * np.sin(turn)
        canvas.line([foot, foot + axis * 120 + side], GREEN if abs(turn - np.pi) < 0.2 else (150, 200, 170), 1.5)
    canvas.arrow(foot, foot + axis * 165, RED, 2.5)
    canvas.text(foot + axis * 180, "l", RED, 18, "mm")
    canvas.dot(foot, 5, ORANGE)
    canvas.text([540, 300], "b = a0 + e n.l: of the normal", INK, 15, "mm")
    canvas.text([540, 322], "one component, not the other", INK, 15, "mm")
    canvas.text([190, 360], "lines of equal brightness are lines of equal n.l", INK, 15, "mm")
    return canvas.finished()
