# SPDX-License-Identifier: Apache-2.0
import warnings

import numpy as np
import pytest

import tetvdb
from conftest import cube_triangles


def failure(*arguments, **settings):
    with pytest.raises(tetvdb.Error) as caught:
        tetvdb.voxelize(*arguments, **settings)
    return caught.value


def test_status_and_code(cube, tmp_path):
    missing = failure(tmp_path / "missing.stl")
    assert (missing.status, missing.code) == (3, "invalid")
    assert "missing.stl" in str(missing)
    rule = failure(*cube, rule="some")
    assert (rule.status, rule.code) == (2, "usage")
    assert "`rule`" in str(rule) and "centre" in str(rule)
    memory = failure(*cube, resolution=4000, max_memory="1M")
    assert (memory.status, memory.code) == (4, "limit")
    assert "`max_memory`" in str(memory)


@pytest.mark.parametrize("settings", [
    {"resolution": 0}, {"resolution": 1.5}, {"resolution": "many"}, {"voxel_size": -1},
    {"voxel_size": (1, 2)}, {"voxel_size": float("nan")}, {"origin": (1, 2)}, {"epsilon": "3x"},
    {"epsilon": 0}, {"threads": 0}, {"max_memory": "big"}, {"max_time": 0}, {"weld": -1},
    {"shell": 0}, {"half_width": "most"}, {"bbox": (1, 2, 3)}, {"grid": "densty"},
    {"resolution": 8, "voxel_size": 1}, {"fit": 8, "resolution": 9}, {"device": "gpu"},
])
def test_settings_that_cannot_be_used(cube, settings):
    error = failure(*cube, **settings)
    assert error.status == 2
    assert "--" not in str(error)


def test_settings_that_are_unknown(cube):
    with pytest.raises(TypeError):
        tetvdb.voxelize(*cube, resolutoin=3)


@pytest.mark.parametrize("points,faces,status", [
    (np.zeros((3, 2)), [[0, 1, 2]], 2),
    (np.zeros((3, 3)), np.zeros((1, 3)), 2),
    (np.zeros((3, 3), complex), [[0, 1, 2]], 2),
    (np.zeros((3, 3)), [[0, 1, 3]], 3),
    (np.zeros((3, 3)), [[0, 1, -1]], 3),
    (np.full((3, 3), np.nan), [[0, 1, 2]], 3),
    (np.zeros((3, 3)), np.zeros((0, 3), int), 3),
    (np.zeros((0, 3)), np.zeros((0, 3), int), 3),
    (np.zeros((4, 3)), [[0, 1, 2, 4]], 3),
    (np.zeros((4, 3)), [[0, 1, 2, 2 ** 40]], 3),
])
def test_arrays_that_are_no_mesh(points, faces, status):
    assert failure(points, faces).status == status


@pytest.mark.parametrize("thing", [3, object(), [], (np.zeros((3, 3)), np.zeros((3, 5), int))])
def test_things_that_are_no_mesh(thing):
    with pytest.raises(TypeError):
        tetvdb.voxelize(thing)


def test_grids_that_are_not_there(cube):
    v = tetvdb.voxelize(*cube, resolution=8)
    with pytest.raises(KeyError, match="density"):
        v["mask"]
    assert "mask" not in v and "density" in v and list(v) == ["density"]


def test_warnings_are_those_of_python():
    points, faces = cube_triangles()
    with pytest.warns(tetvdb.MeshWarning) as caught:
        v = tetvdb.voxelize(points, faces[:, ::-1], resolution=8)
    assert [w["text"] for w in v.report["warnings"]] == [str(w.message) for w in caught]
    assert v.report["warnings"][0]["code"] == "inside-out"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(tetvdb.MeshWarning):
            tetvdb.voxelize(points, faces[:, ::-1], resolution=8)


def test_nothing_is_left_of_a_file_that_cannot_be_written(cube, tmp_path):
    v = tetvdb.voxelize(*cube, resolution=8)
    with pytest.raises(tetvdb.Error) as caught:
        v.write(tmp_path / "no" / "such.vdb")
    assert caught.value.status == 7
    with pytest.raises(tetvdb.Error) as caught:
        v.write(tmp_path / "cube.doc")
    assert caught.value.status == 2
    assert list(tmp_path.iterdir()) == []


def test_time_limit(cube):
    error = failure(*cube, voxel_size=1 / 4096, grid="surface", max_time=0.05)
    assert (error.status, error.code) == (5, "cancelled")


def test_references_outside(tmp_path):
    tetvdb.tetrahedralize(*cube_triangles()).write(tmp_path / "piece.vtu")
    folder = tmp_path / "run"
    folder.mkdir()
    whole = folder / "whole.pvtu"
    whole.write_text('<VTKFile type="PUnstructuredGrid"><PUnstructuredGrid>'
                     '<Piece Source="../piece.vtu"/></PUnstructuredGrid></VTKFile>')
    with pytest.raises(tetvdb.Error, match="outside its folder"):
        tetvdb.voxelize(str(whole), resolution=8)
    tetvdb.allow_outside()
    try:
        assert tetvdb.voxelize(str(whole), resolution=8)["density"].active_voxels > 400
    finally:
        tetvdb.allow_outside(False)
