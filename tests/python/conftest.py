import os
import subprocess
from pathlib import Path

import numpy as np
import pytest


def icosphere(subdivisions=3, radius=1.0):
    """(V, F) of a sphere, closed and oriented outward."""
    g = (1 + 5**0.5) / 2
    V = [[-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g]]
    V += [[0, -1, -g], [0, 1, -g], [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1]]
    F = [[0, 11, 5], [0, 5, 1], [0, 1, 7], [0, 7, 10], [0, 10, 11], [1, 5, 9], [5, 11, 4], [11, 10, 2], [10, 7, 6]]
    F += [[7, 1, 8], [3, 9, 4], [3, 4, 2], [3, 2, 6], [3, 6, 8], [3, 8, 9], [4, 9, 5], [2, 4, 11], [6, 2, 10], [8, 6, 7]]
    F += [[9, 8, 1]]
    V = [np.array(v) / np.linalg.norm(v) for v in V]
    for _ in range(subdivisions):
        middle, faces = {}, []

        def between(a, b):
            key = (min(a, b), max(a, b))
            if key not in middle:
                m = V[a] + V[b]
                V.append(m / np.linalg.norm(m))
                middle[key] = len(V) - 1
            return middle[key]

        for a, b, c in F:
            ab, bc, ca = between(a, b), between(b, c), between(c, a)
            faces += [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        F = faces
    return radius * np.array(V), np.array(F)


@pytest.fixture(scope="session")
def sphere():
    return icosphere()


@pytest.fixture(scope="session")
def project(tmp_path_factory):
    """A small synthetic project with its truth."""
    folder = tmp_path_factory.mktemp("synth") / "project"
    command = [os.environ["GLINT_PROGRAM"], "synth", "ellipsoid", "-o", folder, "--views", "12", "--size", "240x180", "-q"]
    subprocess.run(command, check=True, timeout=120)
    return Path(folder)
