# SPDX-License-Identifier: Apache-2.0
import os
import pickle
import subprocess

import numpy as np
import pytest

import tetvdb
from conftest import cube_tets, cube_triangles, sphere_triangles


def program():
    path = os.environ.get("TETVDB_PROGRAM")
    if not path:
        pytest.skip("TETVDB_PROGRAM names no program")
    return path


def hash_of_program(source, folder, *options):
    out = folder / "program.vdb"
    subprocess.run([program(), "voxelize", source, "-o", out, "-q", *options], check=True)
    text = subprocess.run([program(), "info", out, "--hash"], check=True, capture_output=True,
                          text=True).stdout
    return text.split("hash")[-1].split()[0]


def test_cube_of_triangles_has_its_centres():
    points, faces = cube_triangles((0.5, 0.5, 0.5), (10.5, 7.5, 4.5))
    v = tetvdb.voxelize(points, faces, voxel_size=1, grid="mask")
    assert v["mask"].active_voxels == 10 * 7 * 4
    assert v["mask"].box == ((1, 1, 1), (10, 7, 4))


def test_cube_of_tets_has_its_centres_once_where_all_are_ties():
    points, tets = cube_tets((0, 0, 0), (8, 8, 8))
    v = tetvdb.voxelize(points, tets, voxel_size=1)
    assert v["density"].active_voxels == 8 ** 3


def test_sphere_is_its_polyhedron_by_half_spaces():
    points, faces = sphere_triangles()
    v = tetvdb.voxelize(points, faces, voxel_size=0.093, grid="mask")
    array = v["mask"].to_numpy()
    low = np.array(v["mask"].origin)
    index = np.stack(np.meshgrid(*(np.arange(n) for n in array.shape), indexing="ij"), -1) + low
    centres = index * 0.093
    a, b, c = (points[faces[:, i]] for i in range(3))
    normals = np.cross(b - a, c - a)
    # The polyhedron is convex.
    inside = (np.einsum("xyzi,fi->xyzf", centres, normals)
              < np.einsum("fi,fi->f", a, normals)).all(axis=-1)
    assert (array == inside).all()


def test_tets_against_barycentric_coordinates():
    generator = np.random.default_rng(5)
    points = generator.random((4, 3)) * 20
    v = tetvdb.voxelize(points, [[0, 1, 2, 3]], voxel_size=0.7, grid="mask")
    array = v["mask"].to_numpy(box=((-1, -1, -1), (30, 30, 30)))
    index = np.stack(np.meshgrid(*(np.arange(-1, 31),) * 3, indexing="ij"), -1)
    edges = (points[1:] - points[0]).T
    weights = np.einsum("ij,xyzj->xyzi", np.linalg.inv(edges), index * 0.7 - points[0])
    inside = (weights > 0).all(-1) & (weights.sum(-1) < 1)
    assert inside.sum() > 100
    assert (array == inside).all()


def test_one_volume_of_several_meshes():
    v = tetvdb.voxelize([cube_triangles((0, 0, 0), (4, 4, 4)),
                         cube_triangles((6, 0, 0), (8, 4, 4))], voxel_size=1,
                        grid=["mask", "material"])
    assert v["mask"].active_voxels == 64 + 32
    coordinates, materials = v["material"].sparse()
    assert (materials == np.where(coordinates[:, 0] <= 4, 1, 2)).all()


@pytest.mark.parametrize("kind", [np.float64, np.float32])
@pytest.mark.parametrize("integers", [np.int32, np.int64, np.uint32, np.uint16])
def test_any_number_type_and_layout(kind, integers):
    points, faces = cube_triangles((0, 0, 0), (4, 4, 4))
    plain = tetvdb.voxelize(points, faces, resolution=16).hash()
    assert tetvdb.voxelize(points.astype(kind), faces.astype(integers), resolution=16).hash() == plain
    turned = np.asfortranarray(points.astype(kind)), np.asfortranarray(faces.astype(integers))
    assert tetvdb.voxelize(*turned, resolution=16).hash() == plain
    wide = np.zeros((len(points), 6), kind)
    wide[:, ::2] = points
    assert tetvdb.voxelize(wide[:, ::2], faces[::1], resolution=16).hash() == plain


def test_lists_are_arrays(cube):
    points, faces = cube
    assert (tetvdb.voxelize(points.tolist(), faces.tolist(), resolution=8).hash()
            == tetvdb.voxelize(points, faces, resolution=8).hash())


@pytest.mark.parametrize("make,ending", [(sphere_triangles, ".off"), (cube_tets, ".mesh")])
@pytest.mark.parametrize("settings,options", [
    ({}, []),
    ({"resolution": 64, "grid": "density,surface"},
     ["--resolution", "64", "--grid", "density,surface"]),
    ({"voxel_size": 0.031, "origin": (0.01, 0, 0), "grid": ["coverage"]},
     ["--voxel-size", "0.031", "--origin", "0.01,0,0", "--grid", "coverage"]),
    ({"fit": 32, "padding": 2, "grid": "mask"},
     ["--fit", "32", "--padding", "2", "--grid", "mask"]),
])
def test_same_volume_as_the_program(make, ending, settings, options, tmp_path):
    points, cells = make()
    source = tmp_path / f"mesh{ending}"
    lines = []
    if ending == ".off":
        lines = ["OFF", f"{len(points)} {len(cells)} 0"]
        lines += [" ".join(repr(float(x)) for x in p) for p in points]
        lines += ["3 " + " ".join(map(str, f)) for f in cells]
    else:
        lines = ["MeshVersionFormatted 2", "Dimension 3", "Vertices", str(len(points))]
        lines += [" ".join(repr(float(x)) for x in p) + " 0" for p in points]
        lines += ["Tetrahedra", str(len(cells))]
        lines += [" ".join(str(i + 1) for i in t) + " 0" for t in cells] + ["End"]
    source.write_text("\n".join(lines) + "\n")
    expected = hash_of_program(source, tmp_path, *options)
    assert tetvdb.voxelize(points, cells, **settings).hash() == expected
    assert tetvdb.voxelize(source, **settings).hash() == expected
    written = tmp_path / "module.vdb"
    tetvdb.voxelize(str(source), **settings).write(written)
    assert tetvdb.read(written).hash() == expected


def test_report_is_that_of_the_program(tmp_path):
    import json

    points, faces = cube_triangles()
    source = tmp_path / "cube.off"
    source.write_text("\n".join(["OFF", "8 12 0"] + [" ".join(map(str, p)) for p in points]
                                + ["3 " + " ".join(map(str, f)) for f in faces]) + "\n")
    text = subprocess.run([program(), "voxelize", source, "-o", tmp_path / "cube.vdb", "-q",
                           "--json", "-"], check=True, capture_output=True, text=True).stdout
    theirs = json.loads(text)
    ours = tetvdb.voxelize(source).report
    assert list(ours) == list(theirs)
    for key in ("version", "command", "status", "input", "mesh", "transform", "grids", "warnings"):
        assert ours[key] == theirs[key], key


def test_dense_and_sparse_agree(sphere):
    v = tetvdb.voxelize(*sphere, resolution=40, grid=["surface", "mask", "density"])
    for name in v:
        grid = v[name]
        dense = grid.to_numpy()
        coordinates, values = grid.sparse()
        assert coordinates.dtype == np.int32 and coordinates.shape == (grid.active_voxels, 3)
        order = np.lexsort((coordinates[:, 2], coordinates[:, 1], coordinates[:, 0]))
        assert (order == np.arange(len(coordinates))).all()
        at = tuple((coordinates - grid.origin).T)
        assert (dense[at] == values).all()
        if name != "surface":
            assert (dense != 0).sum() == len(values)


def test_tiles_are_expanded():
    points, faces = cube_triangles((0, 0, 0), (40, 40, 40))
    grid = tetvdb.voxelize(points, faces, voxel_size=1, grid="mask")["mask"]
    coordinates, values = grid.sparse()
    expected = np.stack(np.meshgrid(*(np.arange(1, 41),) * 3, indexing="ij"), -1).reshape(-1, 3)
    low = np.array(grid.origin) - 1
    assert (coordinates == expected + low).all() and values.all()


def test_box_of_an_array():
    points, faces = cube_triangles((0.5, 0.5, 0.5), (3.5, 3.5, 3.5))
    grid = tetvdb.voxelize(points, faces, voxel_size=1)["density"]
    array = grid.to_numpy(box=((0, 0, 0), (5, 6, 7)))
    assert array.shape == (6, 7, 8)
    expected = np.zeros((6, 7, 8), np.float32)
    expected[1:4, 1:4, 1:4] = 1
    assert (array == expected).all() and array.dtype == np.float32


def test_transforms():
    points, faces = cube_triangles((3, 5, 7), (4, 6, 8))
    grid = tetvdb.voxelize(points, faces, voxel_size=0.125, origin=(0.5, 0.25, 0))["density"]
    world = grid.transform @ np.array([2, 3, 4, 1])
    assert (world == [0.75, 0.625, 0.5, 1]).all()
    assert grid.voxel_size == (0.125, 0.125, 0.125)
    first = grid.array_transform @ np.array([0, 0, 0, 1])
    assert (first == grid.transform @ np.array([*grid.origin, 1])).all()
    size = np.array(grid.to_numpy().shape)
    assert (size == 8).all()


def test_arrays_outlive_the_volume(sphere):
    array = tetvdb.voxelize(*sphere, resolution=16)["density"].to_numpy()
    assert set(np.unique(array)) == {0, 1}


def test_pickle(sphere):
    v = tetvdb.voxelize(*sphere, resolution=24, grid="density,surface")
    assert pickle.loads(pickle.dumps(v)).hash() == v.hash()


def test_openvdb_of_python(sphere):
    vdb = pytest.importorskip("pyopenvdb")
    v = tetvdb.voxelize(*sphere, resolution=24, grid="surface,mask")
    theirs = v["surface"].to_openvdb()
    assert isinstance(theirs, vdb.FloatGrid) and theirs.name == "surface"
    assert theirs.activeVoxelCount() == v["surface"].active_voxels
    box = theirs.evalActiveVoxelBoundingBox()
    array = np.zeros([b - a + 1 for a, b in zip(*box)], np.float32)
    theirs.copyToArray(array, ijk=box[0])
    assert (array == v["surface"].to_numpy()).all()
    assert v["mask"].to_openvdb().activeVoxelCount() == v["mask"].active_voxels


def test_point_data_become_grids():
    class Mesh:
        points, tets = cube_tets((0, 0, 0), (8, 8, 8))
        celltypes = np.full(6, 10, np.uint8)
        cells = np.insert(tets, 0, 4, axis=1).ravel()
        point_data = {"height": points[:, 2] * 2.0}
        cell_data = {"number": np.arange(6)}

    del Mesh.tets
    v = tetvdb.voxelize(Mesh(), voxel_size=1, grid=["height", "number"])
    coordinates, values = v["height"].sparse()
    assert len(values) == 512
    assert np.allclose(values, coordinates[:, 2] * 2.0, atol=1e-5)
    assert set(v["number"].sparse()[1]) == set(range(6))


def two_cubes_with(**cell_data):
    class Mesh:
        points, first = cube_tets((0, 0, 0), (4, 4, 4))
        more, second = cube_tets((6, 0, 0), (8, 4, 4))

    Mesh.points = np.concatenate((Mesh.points, Mesh.more))
    tets = np.concatenate((Mesh.first, Mesh.second + 8))
    Mesh.celltypes = np.full(12, 10, np.uint8)
    Mesh.cells = np.insert(tets, 0, 4, axis=1).ravel()
    Mesh.point_data, Mesh.cell_data = {}, cell_data
    return Mesh()


def test_regions_of_cell_data():
    numbers = np.repeat([7, 9], 6)
    v = tetvdb.voxelize(two_cubes_with(material=numbers), voxel_size=1, grid="material")
    coordinates, materials = v["material"].sparse()
    assert (materials == np.where(coordinates[:, 0] < 5, 7, 9)).all() and len(materials) == 96
    mesh = two_cubes_with(kind=numbers)
    second = tetvdb.voxelize(mesh, voxel_size=1, region_array="kind", region=9)
    assert second["density"].active_voxels == 32
    both = tetvdb.voxelize(mesh, voxel_size=1, region_array="kind", exclude=[9], grid="mask")
    assert both["mask"].active_voxels == 64
    with pytest.raises(tetvdb.Error, match="'sort'.*'kind'"):
        tetvdb.voxelize(mesh, voxel_size=1, region_array="sort")


def test_flat_cells_alone_are_no_solid():
    class Mesh:
        points = np.zeros((3, 3))
        celltypes = np.array([68], np.uint8)
        cells = np.array([3, 0, 1, 2])

    with pytest.raises(tetvdb.Error) as caught:
        tetvdb.voxelize(Mesh())
    assert caught.value.status == 3


def test_objects_of_other_libraries(cube):
    points, faces = cube

    class Trimesh:
        vertices, faces = cube

    class Open3d:
        vertices, triangles = cube

    class PolyData:
        pass

    PolyData.points = points
    PolyData.faces = np.insert(faces, 0, 3, axis=1).ravel()

    class Quads:
        pass

    Quads.points = points
    Quads.faces = np.array([[4, 0, 1, 3, 2], [4, 4, 6, 7, 5], [4, 0, 4, 5, 1], [4, 2, 3, 7, 6],
                            [4, 0, 2, 6, 4], [4, 1, 5, 7, 3]]).ravel()

    expected = tetvdb.voxelize(points, faces, resolution=20).hash()
    for mesh in (Trimesh(), Open3d(), PolyData(), Quads()):
        assert tetvdb.voxelize(mesh, resolution=20).hash() == expected, type(mesh)


def test_meshio():
    meshio = pytest.importorskip("meshio")
    points, tets = cube_tets((0, 0, 0), (8, 8, 8))
    mesh = meshio.Mesh(points, [("tetra", tets)], point_data={"x": points[:, 0]})
    assert tetvdb.voxelize(mesh, voxel_size=1)["density"].active_voxels == 512
    assert np.allclose(*(f(tetvdb.voxelize(mesh, voxel_size=1, grid="x")["x"].sparse())
                         for f in (lambda s: s[0][:, 0], lambda s: s[1])), atol=1e-5)


def test_trimesh():
    trimesh = pytest.importorskip("trimesh")
    box = trimesh.creation.box((1, 1, 1))
    v = tetvdb.voxelize(box, voxel_size=0.1, origin=(0.05, 0.05, 0.05))
    assert v["density"].active_voxels == 1000
