"""Ctrl-C ends each long call of one part soon, not only those that report progress."""

import signal
import subprocess
import sys
import time


# One call after the other, each far longer than the wait, until SIGINT comes. What is measured is the time that the
# processors still worked from the moment that the interpreter heard of it: a busy machine does not change that.
CHILD = """
import signal, time
import numpy as np
import glint

def torus(nu, nv):
    u, v = np.meshgrid(np.arange(nu) * 2 * np.pi / nu, np.arange(nv) * 2 * np.pi / nv, indexing="ij")
    ring = 1 + 0.4 * np.cos(v)
    V = np.stack([ring * np.cos(u), ring * np.sin(u), 0.4 * np.sin(v)], -1).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(nu), np.arange(nv), indexing="ij")
    at = lambda a, b: (a % nu) * nv + b % nv
    a, b, c, d = at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)
    return V, np.stack([a, b, c, a, c, d], -1).reshape(-1, 3)

heard = None

def hear(number, frame):
    global heard
    heard = time.process_time()
    raise KeyboardInterrupt

signal.signal(signal.SIGINT, hear)
glint.set_num_threads(2)
random = np.random.default_rng(1)
V, F = torus(1000, 400)
points = random.uniform(-1, 1, (4_000_000, 3))
picture = random.integers(0, 256, (2000, 3000, 3), dtype=np.uint8)
calls = {
    "signed_distance": lambda: glint.signed_distance(V, F, points),
    "by winding number": lambda: glint.signed_distance(V, F, points, sign="winding"),
    "closest_points": lambda: glint.closest_points(V, F, points),
    "mesh_to_level_set": lambda: glint.mesh_to_level_set(V, F, 0.001),
    "its winding numbers": lambda: glint.mesh_to_level_set(V, F, 0.002, sign="winding"),
    "compare": lambda: glint.compare((V, F), (V + 0.01, F), num_samples=3_000_000),
    "detect_highlights": lambda: glint.detect_highlights(picture),
}
for name, call in calls.items():
    print(name, flush=True)
    try:
        while True:
            call()
    except KeyboardInterrupt:
        print(time.process_time() - heard, flush=True)
"""


def test_every_long_call_ends_soon():
    child = subprocess.Popen([sys.executable, "-c", CHILD], stdout=subprocess.PIPE, text=True)
    seconds = {}
    try:
        for line in child.stdout:
            time.sleep(0.3)
            child.send_signal(signal.SIGINT)
            seconds[line.strip()] = float(child.stdout.readline())
        child.wait(timeout=60)
    finally:
        child.kill()
    assert child.returncode == 0 and len(seconds) == 7
    assert max(seconds.values()) < 2, f"seconds of two processors: {seconds}"
