# SPDX-License-Identifier: Apache-2.0
import numpy as np
import pytest

import tetvdb
from conftest import cube_triangles, sphere_triangles


def volumes(mesh):
    a, b, c, d = (mesh.points[mesh.tets[:, i]] for i in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


def test_cube(cube):
    mesh = tetvdb.tetrahedralize(*cube, epsilon="1e-3d")
    assert mesh.points.dtype == np.float64 and mesh.tets.dtype == np.int32
    assert (volumes(mesh) > 0).all()
    assert abs(volumes(mesh).sum() - 1) < 0.01
    assert mesh.points.min() > -0.002 and mesh.points.max() < 1.002
    assert mesh.report["mesh"]["tets"] == len(mesh.tets)
    assert mesh.report["command"] == "tetrahedralize"


def test_epsilon_as_a_length(sphere):
    mesh = tetvdb.tetrahedralize(*sphere, epsilon=0.02)
    assert mesh.report["mesh"]["epsilon_asked"] == 0.02
    assert np.linalg.norm(mesh.points, axis=1).max() < 1.02


def test_regions_and_booleans():
    meshes = [cube_triangles(), cube_triangles((0.5, 0, 0), (1.5, 1, 1))]
    both = tetvdb.tetrahedralize(meshes)
    assert set(both.regions) == {1, 2}
    assert abs(volumes(both)[both.regions == 1].sum() - 1) < 0.01
    assert abs(volumes(both)[both.regions == 2].sum() - 0.5) < 0.01
    rest = tetvdb.tetrahedralize(meshes, boolean="difference")
    assert abs(volumes(rest).sum() - 0.5) < 0.01


def test_views_keep_the_mesh_alive(cube):
    points = tetvdb.tetrahedralize(*cube).points
    assert np.isfinite(points).all()
    with pytest.raises(ValueError):
        points[0] = 0


def test_its_tets_are_an_input(sphere, tmp_path):
    mesh = tetvdb.tetrahedralize(*sphere)
    path = tmp_path / "sphere.mesh"
    mesh.write(path)
    assert (tetvdb.voxelize(mesh, resolution=32).hash()
            == tetvdb.voxelize(mesh.points, mesh.tets, resolution=32).hash()
            == tetvdb.voxelize(path, resolution=32).hash())


def test_errors(cube):
    for settings in ({"stop_energy": 2}, {"boolean": "union"}, {"epsilon": "0.5v"}):
        with pytest.raises(tetvdb.Error) as caught:
            tetvdb.tetrahedralize(*cube, **settings)
        assert caught.value.status == 2
