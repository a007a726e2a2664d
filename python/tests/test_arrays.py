# SPDX-License-Identifier: Apache-2.0
"""Volumes of arrays, in memory and from files."""

import numpy as np
import pytest

import tetvdb


def cube():
    points = np.array([(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)], float)
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1), (2, 3, 7), (2, 7, 6), (0, 2, 6),
             (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    return points, np.array(faces)


@pytest.mark.parametrize("thickness", [1, 0.05])  # of which the thin one has no voxel at minus the half-width
def test_a_volume_comes_back_from_its_arrays(thickness):
    points, faces = cube()
    whole = tetvdb.voxelize(points * (1, 1, thickness), faces, resolution=37, origin=(0.1, 0.2, 0.3), grid=["density", "surface", "mask"])
    for name in whole:
        grid = whole[name]
        back = tetvdb.from_arrays({name: grid.to_numpy()}, transform=grid.transform, first=grid.origin)
        assert np.allclose(back[name].transform, grid.transform, rtol=0, atol=0)
        assert back[name].grid_class == grid.grid_class or name == "mask"
        at, values = grid.sparse()
        at2, values2 = back[name].sparse()
        assert np.array_equal(at, at2) and np.array_equal(values, values2)


@pytest.mark.parametrize("kind", ["bool", "int8", "uint8", "int16", "uint16", "int32", "int64", "uint32", "uint64",
                                  "float16", "float32", "float64"])
@pytest.mark.parametrize("order", ["C", "F"])
def test_arrays_of_every_type(kind, order):
    random = np.random.default_rng(5)
    values = np.array(random.integers(0, 2 if kind == "bool" else 100, (9, 17, 21)), dtype=kind, order=order)
    volume = tetvdb.from_arrays({"a": values, "b": values[::2, ::-1]}, voxel_size=(0.5, 1, 2), origin=(1, 2, 3),
                                first=(-3, 0, 4))
    grid = volume["a"]
    assert grid.type == {"bool": "bool", "int32": "int32", "uint32": "int32", "int64": "int64", "uint64": "int64"}.get(
        kind, "float")
    dense = grid.to_numpy(box=((-3, 0, 4), (5, 16, 24)))
    assert np.array_equal(dense, values.astype(dense.dtype))
    assert grid.active_voxels == np.count_nonzero(values)
    assert np.array_equal(grid.transform, [[0.5, 0, 0, 1], [0, 1, 0, 2], [0, 0, 2, 3], [0, 0, 0, 1]])
    dense = volume["b"].to_numpy(box=((-3, 0, 4), (1, 16, 24)))
    assert np.array_equal(dense, values[::2, ::-1].astype(dense.dtype))


def test_vectors_names_and_refusals():
    vectors = np.ones((4, 4, 4, 3), np.float32)
    assert list(tetvdb.from_arrays(vectors)) == ["vector"]
    assert tetvdb.from_arrays(vectors)["vector"].type == "vec3s"
    assert list(tetvdb.from_arrays(np.ones((4, 4, 4)))) == ["density"]
    assert tetvdb.from_arrays(np.ones((4, 4, 4)), background=1)["density"].active_voxels == 0
    with pytest.warns(tetvdb.MeshWarning, match="NaN"):
        volume = tetvdb.from_arrays(np.array([[[1, np.nan, 2]]]))
    assert volume["density"].active_voxels == 2
    for bad in (np.ones((4, 4)), np.array([[["a"]]]), np.ones((4, 4, 4), complex), np.ones((0, 4, 4))):
        with pytest.raises((tetvdb.Error, TypeError)):
            tetvdb.from_arrays(bad)
    with pytest.raises(tetvdb.Error):
        tetvdb.from_arrays(np.ones((4, 4, 4)), voxel_size=-1)


def test_files_of_arrays(tmp_path):
    values = np.arange(2 * 3 * 4, dtype=np.float32).reshape(2, 3, 4)
    np.save(tmp_path / "a.npy", values)
    volume = tetvdb.read(tmp_path / "a.npy", voxel_size=(2, 2, 2), axes="zyx")
    dense = volume["density"].to_numpy(box=((0, 0, 0), (3, 2, 1)))
    assert np.array_equal(dense, values.transpose(2, 1, 0))
    assert volume["density"].voxel_size == (2, 2, 2)
    volume.write(tmp_path / "a.nrrd")
    volume.write(tmp_path / "a.vdb")
    assert tetvdb.read(tmp_path / "a.nrrd", background=0)["density"].active_voxels == 23
    with pytest.raises(tetvdb.Error):
        tetvdb.read(tmp_path / "a.vdb", voxel_size=(1, 1, 1))
