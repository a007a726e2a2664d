# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

import tetvdb
from conftest import (cube_tets, cube_triangles, distance_to_triangles, sphere_triangles,
                      winding_number)


def test_winding_number_of_a_closed_mesh(sphere):
    queries = np.random.default_rng(1).uniform(-1.3, 1.3, (3000, 3))
    occupancy, distance = tetvdb.query(*sphere[:1], queries, sphere[1])
    assert distance is None and occupancy.dtype == bool
    assert (occupancy == (winding_number(*sphere, queries) > 0.5)).all()


def test_winding_number_of_an_open_mesh():
    points, faces = sphere_triangles(rings=12, sectors=16)
    faces = faces[:-40]
    queries = np.random.default_rng(2).uniform(-1.3, 1.3, (4000, 3))
    winding = winding_number(points, faces, queries)
    sure = abs(winding - 0.5) > 2e-3
    occupancy = tetvdb.query(points, queries, faces).occupancy
    assert sure.sum() > 3900
    assert (occupancy == (winding > 0.5))[sure].all()


def test_signed_distance():
    points, faces = sphere_triangles(rings=8, sectors=12)
    queries = np.random.default_rng(3).uniform(-1.6, 1.6, (300, 3))
    occupancy, distance = tetvdb.query(points, queries, faces, distance=True)
    assert np.allclose(abs(distance), distance_to_triangles(points, faces, queries), rtol=1e-12,
                       atol=1e-14)
    assert ((distance < 0) == occupancy).all()


def test_points_on_faces_belong_to_one_side():
    """Of boxes that fill space every lattice point is in one, wherever it lies."""
    queries = np.stack(np.meshgrid(*(np.arange(0, 5),) * 3, indexing="ij"), -1).reshape(-1, 3)
    count = np.zeros(len(queries), int)
    for low in np.ndindex(3, 3, 3):
        low = np.array(low) * 2 - 1
        points, faces = cube_triangles(low, low + 2)
        count += tetvdb.query(points, queries, faces).occupancy
    assert (count == 1).all()


def test_same_as_voxelize_at_centres():
    points, faces = sphere_triangles()
    grid = tetvdb.voxelize(points, faces, voxel_size=0.057, grid="mask")["mask"]
    array = grid.to_numpy(box=((-20, -20, -20), (20, 20, 20)))
    index = np.stack(np.meshgrid(*(np.arange(-20, 21),) * 3, indexing="ij"), -1).reshape(-1, 3)
    occupancy = tetvdb.query(points, index * 0.057, faces).occupancy
    assert (occupancy == array.ravel()).all()


def test_tets():
    points, tets = cube_tets((0, 0, 0), (2, 2, 2))
    queries = np.random.default_rng(4).uniform(-1, 3, (2000, 3))
    occupancy, distance = tetvdb.query(points, queries, tets, distance=True)
    assert (occupancy == ((queries > 0) & (queries < 2)).all(axis=1)).all()
    outside = np.maximum(np.maximum(-queries, queries - 2), 0)
    inside = np.minimum(queries, 2 - queries).min(axis=1)
    expected = np.where(occupancy, -inside, np.linalg.norm(outside, axis=1))
    assert np.allclose(distance, expected, atol=1e-14)


def test_one_solid_many_times(sphere):
    solid = tetvdb.Solid(*sphere)
    assert solid.open_edges == 0
    queries = np.random.default_rng(5).uniform(-1.3, 1.3, (1000, 3))
    whole = solid.query(queries, distance=True)
    parts = [solid.query(part, distance=True) for part in np.split(queries, 10)]
    assert (np.concatenate([p.occupancy for p in parts]) == whole.occupancy).all()
    assert (np.concatenate([p.distance for p in parts]) == whole.distance).all()
    assert solid.query(queries, occupancy=False, distance=True).occupancy is None


def test_threads_do_not_matter(sphere):
    queries = np.random.default_rng(6).uniform(-1.3, 1.3, (20000, 3))
    one = tetvdb.query(sphere[0], queries, sphere[1], distance=True, threads=1)
    two = tetvdb.query(sphere[0], queries, sphere[1], distance=True, threads=2)
    assert (one.occupancy == two.occupancy).all() and (one.distance == two.distance).all()


def test_far_points_and_none(sphere):
    far = np.array([[1e300, 0, 0], [0, 0, -1e9], [5, 5, 5]])
    assert not tetvdb.query(sphere[0], far, sphere[1]).occupancy.any()
    assert tetvdb.query(sphere[0], np.zeros((0, 3)), sphere[1]).occupancy.shape == (0,)


def test_float32_points(sphere):
    queries = np.random.default_rng(7).uniform(-1.3, 1.3, (500, 3)).astype(np.float32)
    assert (tetvdb.query(sphere[0], queries, sphere[1]).occupancy
            == tetvdb.query(sphere[0], queries.astype(float), sphere[1]).occupancy).all()


@pytest.mark.parametrize("bad", [np.array([[0, 0, np.nan]]), np.array([[0, np.inf, 0]])])
def test_points_that_are_not_finite(sphere, bad):
    with pytest.raises(tetvdb.Error, match="point 0 is not finite"):
        tetvdb.query(sphere[0], bad, sphere[1])


def test_trimesh_agrees():
    trimesh = pytest.importorskip("trimesh")
    mesh = trimesh.creation.icosphere(subdivisions=2)
    queries = np.random.default_rng(8).uniform(-1.2, 1.2, (300, 3))
    distance = tetvdb.query(mesh, queries, distance=True).distance
    _, theirs, _ = trimesh.proximity.closest_point_naive(mesh, queries)
    assert np.allclose(abs(distance), theirs, atol=1e-9)
