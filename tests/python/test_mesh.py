import threading
import time

import numpy as np
import pytest

import glint
from conftest import icosphere

CUBE_V = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], dtype=float)
CUBE_F = np.array(
    [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3]]
)


def distance_to_cube(points):
    q = np.abs(points) - 1
    return np.linalg.norm(np.maximum(q, 0), axis=1) + np.minimum(q.max(axis=1), 0)


def test_signed_distance_of_a_cube_is_exact():
    points = np.random.default_rng(1).uniform(-2, 2, (5000, 3))
    found = glint.signed_distance(CUBE_V, CUBE_F, points)
    assert found.shape == (5000,) and found.dtype == np.float64
    np.testing.assert_allclose(found, distance_to_cube(points), atol=1e-12)
    assert (found < 0).any() and (found > 0).any()


def test_winding_number_agrees_on_a_closed_mesh():
    points = np.random.default_rng(2).uniform(-2, 2, (500, 3))
    np.testing.assert_allclose(
        glint.signed_distance(CUBE_V, CUBE_F, points, sign="winding"), distance_to_cube(points), atol=1e-12
    )


def test_a_mesh_is_shown_by_its_counts():
    mesh = glint.Mesh(np.zeros((4, 3)), np.zeros((2, 3), np.int32), attributes={"confidence": np.zeros(4, np.float32)})
    assert repr(mesh) == "Mesh(num_vertices=4, num_faces=2, has=['confidence'])"


def test_closest_points_reproduce_the_distance():
    points = np.random.default_rng(3).uniform(-2, 2, (300, 3))
    found = glint.closest_points(CUBE_V, CUBE_F, points)
    np.testing.assert_allclose(np.linalg.norm(points - found.point, axis=1), np.abs(found.distance), atol=1e-12)
    np.testing.assert_allclose(glint.signed_distance(CUBE_V, CUBE_F, points), found.distance, atol=1e-12)
    corners = CUBE_V[CUBE_F[found.face]]
    np.testing.assert_allclose(np.einsum("kc,kcd->kd", found.barycentric, corners), found.point, atol=1e-12)
    assert found.sign == "pseudonormal"


@pytest.mark.parametrize("convert", [
    lambda a: a.astype(np.float32), np.asfortranarray, np.ndarray.tolist, lambda a: np.repeat(a, 2, axis=0)[::2],
])
def test_any_array_of_numbers_will_do(convert):
    points = np.round(np.random.default_rng(4).uniform(-2, 2, (50, 3)), 2)
    for faces in (CUBE_F.astype(np.uint16), CUBE_F[:, [1, 2, 0]].astype(np.int64), CUBE_F.tolist()):
        found = glint.signed_distance(convert(CUBE_V), faces, convert(points))
        np.testing.assert_allclose(found, distance_to_cube(points), atol=1e-6)


@pytest.mark.parametrize("V, F, points, message", [
    (CUBE_V.T, CUBE_F, [[0, 0, 0]], r"V: expected an array of shape \(n, 3\), found \(3, 8\)"),
    (CUBE_V, CUBE_F.astype(float), [[0, 0, 0]], "F: expected whole numbers, found dtype float64"),
    (CUBE_V, CUBE_F + 1, [[0, 0, 0]], r"F: expected values from 0 to 7, found 8 at \(\d+, \d\)"),
    (CUBE_V, CUBE_F - 1, [[0, 0, 0]], "F: expected values from 0 to 7, found -1"),
    (CUBE_V, CUBE_F, [0, 0, 0], r"points: expected an array of shape \(n, 3\), found \(3,\)"),
    (CUBE_V, CUBE_F, [[0, 0, np.nan]], r"points: expected finite numbers, found nan at \(0, 2\)"),
    (CUBE_V, CUBE_F, [["a", "b", "c"]], "points: expected numbers, found dtype <U1"),
    (CUBE_V, CUBE_F, [[0, 0, 0], [0, 0]], r"points: expected an array of shape \(n, 3\)"),
    (CUBE_V.astype(complex), CUBE_F, [[0, 0, 0]], "V: expected numbers, found dtype complex128"),
])
def test_bad_arrays_are_named(V, F, points, message):
    with pytest.raises(glint.InputError, match=message) as raised:
        glint.signed_distance(V, F, points)
    assert isinstance(raised.value, (ValueError, glint.Error))
    assert raised.value.record == message.split(":")[0]


def test_no_mesh_and_no_points():
    assert glint.signed_distance(CUBE_V, CUBE_F, np.zeros((0, 3))).shape == (0,)
    with pytest.raises(glint.InputError):
        glint.signed_distance(np.zeros((0, 3)), np.zeros((0, 3), int), [[0, 0, 0]])
    with pytest.raises(glint.InputError, match="sign: expected one of auto, pseudonormal, winding, found 'guess'"):
        glint.signed_distance(CUBE_V, CUBE_F, [[0, 0, 0]], sign="guess")


def test_level_set_of_a_sphere(sphere):
    field = glint.mesh_to_level_set(*sphere, 0.05)
    assert field.voxel_size == pytest.approx(0.05) and field.num_active_voxels > 1000
    radii = np.array([0.9, 0.97, 1.0, 1.05, 1.1])
    points = radii[:, None] * np.array([[0.6, 0.0, 0.8]])
    np.testing.assert_allclose(glint.sample_level_set(field, points), radii - 1, atol=0.01)
    np.testing.assert_allclose(glint.level_set_gradient(field, points[2:3]), [[0.6, 0, 0.8]], atol=0.05)
    mesh = glint.level_set_to_mesh(field, iso=0.05)
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 1.05, atol=0.01)
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1, atol=1e-6)
    with pytest.raises(glint.InputError):
        glint.level_set_to_mesh(field, iso=0.5)  # beyond the band


def test_dense_arrays_go_both_ways(sphere):
    field = glint.mesh_to_level_set(*sphere, 0.1)
    values, world_from_index = glint.level_set_to_dense(field)
    i = np.unravel_index(np.argmin(np.abs(values)), values.shape)
    x = (world_from_index @ [*i, 1])[:3]
    assert glint.signed_distance(*sphere, [x])[0] == pytest.approx(values[i], abs=1e-6)
    again = glint.level_set_to_mesh(values, voxel_size=0.1, origin=world_from_index[:3, 3])
    straight = glint.level_set_to_mesh(field)
    np.testing.assert_allclose(np.sort(again.vertices, axis=0), np.sort(straight.vertices, axis=0), atol=1e-5)
    np.testing.assert_array_equal(again.faces.shape, straight.faces.shape)


def test_dense_array_of_an_analytic_field():
    x = np.linspace(-1.5, 1.5, 61)
    values = np.linalg.norm(np.stack(np.meshgrid(x, x, 0.5 * x, indexing="ij"), -1) * [1, 1, 2], axis=-1) - 1
    with pytest.raises(glint.InputError, match="voxel_size"):
        glint.level_set_to_mesh(values)
    mesh = glint.level_set_to_mesh(values, voxel_size=0.05, origin=(-1.5, -1.5, -1.5))
    np.testing.assert_allclose(np.linalg.norm(mesh.vertices, axis=1), 1, atol=1e-3)
    with pytest.raises(glint.InputError, match="rim is not outside"):
        glint.dense_to_level_set(values[30:], 0.05)
    with pytest.raises(glint.InputError, match=r"values: expected an array of shape \(n, m, k\)"):
        glint.dense_to_level_set(values[0], 0.05)


def test_files(sphere, tmp_path):
    field = glint.mesh_to_level_set(*sphere, 0.1)
    glint.write_level_set(tmp_path / "field.vdb", field)
    assert glint.read_level_set(tmp_path / "field.vdb").num_active_voxels == field.num_active_voxels
    mesh = glint.level_set_to_mesh(tmp_path / "field.vdb")
    mesh.attributes["confidence"] = np.linspace(0, 1, len(mesh.vertices))
    mesh.attributes["heat"] = np.arange(len(mesh.vertices))
    mesh.colors = np.full((len(mesh.vertices), 3), 128)
    glint.write_mesh(tmp_path / "mesh.ply", mesh)
    again = glint.read_mesh(tmp_path / "mesh.ply")
    np.testing.assert_array_equal(again.faces, mesh.faces)
    np.testing.assert_allclose(again.vertices, mesh.vertices, atol=1e-6)
    np.testing.assert_array_equal(again.attributes["heat"], np.arange(len(mesh.vertices), dtype=np.float32))
    assert set(again.attributes) == {"confidence", "heat"} and (again.colors == 128).all()
    with pytest.raises(glint.InputError, match="none.ply") as raised:
        glint.read_mesh(tmp_path / "none.ply")
    assert raised.value.path == str(tmp_path / "none.ply")
    with pytest.raises(glint.InputError, match="mesh.attributes"):
        glint.write_mesh(tmp_path / "mesh.ply", glint.Mesh(mesh.vertices, mesh.faces, attributes={"short": [1.0]}))


def test_compare_spheres():
    mesh, reference = icosphere(4, 1.02), icosphere(4)
    found = glint.compare(mesh, reference, num_samples=20000, f_thresholds_rel=[0.001, 0.1])
    assert found.accuracy.mean == pytest.approx(0.02, abs=1e-3)
    assert found.completeness.count == 20000
    assert [s.f for s in found.f_scores] == [0, 1]
    assert found.normal_deg.max < 3
    np.testing.assert_allclose(found.reference_distance, 0.02, atol=1e-3)
    half = reference[0][:, 2] > 0
    assert glint.compare(mesh, reference, num_samples=2000, reference_mask=half).normal_deg.count == half.sum()
    with pytest.raises(glint.InputError, match="reference_mask"):
        glint.compare(mesh, reference, reference_mask=half[:-1])
    with pytest.raises(glint.InputError, match="mesh: expected a glint.Mesh or a pair"):
        glint.compare(3, reference)


def test_align_finds_the_frame():
    v, f = icosphere(3)
    v = v * [1.0, 1.4, 2.0] + 0.3 * v[:, [1]] ** 2  # no turn takes it to itself
    turn = np.array([[0.36, 0.48, -0.8], [-0.8, 0.6, 0.0], [0.48, 0.64, 0.6]])
    found = glint.align((v, f), (7 * v @ turn.T + [10.0, 0.0, -3.0], f))
    assert found.scale == pytest.approx(7, rel=1e-3) and found.mean_rel < 1e-4
    moved = v @ found.reference_from_mesh[:3, :3].T + found.reference_from_mesh[:3, 3]
    np.testing.assert_allclose(moved, 7 * v @ turn.T + [10.0, 0.0, -3.0], atol=0.05)
    with pytest.raises(glint.InputError, match="reference"):
        glint.align((v, f), (np.zeros((3, 3)), [[0, 1, 2]]))


def test_the_interpreter_runs_on_meanwhile():
    """While C++ works, another Python thread must get its turns."""
    mesh = icosphere(4)
    points = np.random.default_rng(5).uniform(-1, 1, (60000, 3))
    turns = 0
    done = threading.Event()

    def count():
        nonlocal turns
        while not done.is_set():
            turns += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    glint.signed_distance(*mesh, points)
    seconds = time.monotonic() - start
    done.set()
    thread.join()
    assert turns > 20 * seconds, f"{turns} turns in {seconds:.2f} s"


def test_threads_do_not_change_results(sphere):
    points = np.random.default_rng(6).uniform(-1, 1, (1000, 3))
    many = glint.signed_distance(*sphere, points)
    glint.set_num_threads(1)
    try:
        np.testing.assert_array_equal(glint.signed_distance(*sphere, points), many)
    finally:
        glint.set_num_threads(0)
    with pytest.raises(glint.InputError):
        glint.set_num_threads(-1)
