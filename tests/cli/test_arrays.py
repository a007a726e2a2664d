# SPDX-License-Identifier: Apache-2.0
"""Volumes as arrays, read back by programs that know nothing of OpenVDB and compared, voxel by
voxel, with the .vdb file as OpenVDB's Python module reads it.

Skipped (77) without NumPy or OpenVDB's module; single tests without VTK, SimpleITK, h5py, tifffile.
"""

import importlib
import json
import math
import os
import resource
import sys
import unittest

import program
from program import ball, box_faces, lattice, off
from test_fields import simulation

try:
    import numpy as np
    try:
        import openvdb as vdb
    except ImportError:
        import pyopenvdb as vdb
except ImportError as error:
    print("skipped: %s" % error)
    sys.exit(77)


def optional(name):
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


h5py, tifffile, sitk = optional("h5py"), optional("tifffile"), optional("SimpleITK")
vtk_io, vtk_numpy = optional("vtkmodules.vtkIOXML"), optional("vtkmodules.util.numpy_support")

ORIGIN = (0.3, -1.25, 7.5)
GRIDS = "density,surface,mask"


# Off the axes' origin and longer along z.
BALL = ball(12, 1.0, (0.4, 0.2, 8.0), stretch=1.7)


def read_binvox(path):
    """By the format's description: array [x][y][z], translate, scale."""
    data = path.read_bytes()
    lines = []
    while not lines or lines[-1] != b"data":
        line, data = data.split(b"\n", 1)
        lines.append(line)
    assert lines[0].startswith(b"#binvox")
    fields = {l.split()[0]: [float(n) for n in l.split()[1:]] for l in lines[1:-1]}
    size = [int(n) for n in fields[b"dim"]]
    pairs = np.frombuffer(data, np.uint8).reshape(-1, 2)
    assert pairs[:, 0].max() <= 1 and pairs[:, 1].min() >= 1
    flat = np.repeat(pairs[:, 0], pairs[:, 1])
    assert flat.size == size[0] * size[1] * size[2]
    # x slowest, then z, y fastest
    return flat.reshape(size[0], size[2], size[1]).transpose(0, 2, 1), fields[b"translate"], \
        fields[b"scale"][0]


class ArraysTest(program.CommandLineTest):
    maxDiff = None

    def setUp(self):
        super().setUp()
        self.write("a.off", off(*BALL))
        self.size = ["--resolution", 37, "--origin", ",".join(map(str, ORIGIN))]

    def make(self, name, *more, grids=GRIDS, source="a.off"):
        self.succeed("voxelize", source, "-o", name, *self.size, "--grid", grids, *more)
        return self.path(name)

    def truth(self, grids=GRIDS, source="a.off", box=None):
        """Arrays [x][y][z] by OpenVDB's module, the first voxel, the voxel size."""
        path = self.make("truth.vdb", grids=grids, source=source)
        read, _ = vdb.readAll(str(path))
        by_name = {g.name: g for g in read}
        boxes = [g.evalActiveVoxelBoundingBox() for g in read]
        low = np.min([b[0] for b in boxes], 0) if box is None else np.array(box[:3])
        high = np.max([b[1] for b in boxes], 0) if box is None else np.array(box[3:])
        arrays = {}
        for name, grid in by_name.items():
            shape = tuple(high - low + 1)
            if isinstance(grid, vdb.Vec3SGrid):
                array = np.zeros(shape + (3,), np.float32)
            else:
                array = np.zeros(shape, bool if isinstance(grid, vdb.BoolGrid) else np.float32)
            grid.copyToArray(array, ijk=tuple(int(v) for v in low))
            arrays[name] = array
        self.grid = read[0]
        return arrays, low, read[0].transform.voxelSize()[0]

    def same(self, array, expected):
        self.assertEqual(array.shape, expected.shape)
        self.assertTrue(np.array_equal(array, expected))

    def test_npy(self):
        arrays, _, _ = self.truth("surface")
        array = np.load(self.make("a.npy", grids="surface"))
        self.assertEqual(array.dtype, np.float32)
        self.same(array, arrays["surface"])
        arrays, _, _ = self.truth("mask")
        array = np.load(self.make("b.npy", grids="mask"))
        self.assertEqual(array.dtype, bool)
        self.same(array, arrays["mask"])

    def check_npz(self, path, arrays, low, h):
        with np.load(path) as read:
            self.assertEqual(sorted(read.files),
                             sorted([*arrays, "origin", "transform", "voxel_size"]))
            for name, array in arrays.items():
                self.same(read[name], array)
            self.assertEqual(read["origin"].tolist(), low.tolist())
            self.assertEqual(read["voxel_size"].tolist(), [h] * 3)
            for index in (low, low + 5):
                world = read["transform"] @ np.append(index, 1.0)
                self.assertEqual(world[3], 1)
                # The module's transform adds and multiplies in its own order.
                np.testing.assert_allclose(
                    world[:3], self.grid.transform.indexToWorld(tuple(map(int, index))),
                    rtol=1e-15)

    def test_npz(self):
        truth = self.truth()
        self.check_npz(self.make("a.npz"), *truth)
        path = self.make("b.npz", "--compress")
        self.check_npz(path, *truth)
        self.assertLess(path.stat().st_size, self.path("a.npz").stat().st_size / 2)
        self.succeed("convert", "truth.vdb", "-o", "c.npz")
        self.check_npz(self.path("c.npz"), *truth)
        self.assertEqual(self.path("c.npz").read_bytes(), self.path("a.npz").read_bytes())

    def test_the_same_bytes_for_any_number_of_threads(self):
        for name in ("a.npz", "a.vti"):
            one = self.make(name, "--compress", "--threads", 1).read_bytes()
            self.assertEqual(self.make(name, "--compress", "--threads", 3).read_bytes(), one)

    def test_boxes_that_cut_leaves_and_tiles(self):
        for box in [(-3, -2, -1, 4, 5, 6), (1, 1, 1, 1, 1, 1), (-20, 3, -9, 17, 3, 40)]:
            arrays, low, h = self.truth(box=box)
            text = ",".join(map(str, box))
            self.check_npz(self.make("a.npz", "--box", text), arrays, low, h)
            with np.load(self.make("s.npz", "--box", text, "--sparse")) as read:
                self.assertEqual(read["box"].tolist(), [list(box[:3]), list(box[3:])])
                at = np.argwhere(arrays["mask"]) + low
                self.same(read["mask.coordinates"], at.astype(np.int32))

    def test_sparse(self):
        arrays, low, _ = self.truth()
        with np.load(self.make("a.npz", "--sparse", "--compress")) as read:
            for name, array in arrays.items():
                at, values = read[name + ".coordinates"], read[name + ".values"]
                self.assertEqual((at.dtype, at.shape), (np.int32, (len(values), 3)))
                self.assertEqual(at.tolist(), sorted(at.tolist()))
                dense = np.full(array.shape, read[name + ".background"], array.dtype)
                dense[tuple((at - low).T)] = values
                if name == "surface":  # inactive inside: below the background
                    inside = array <= -read[name + ".background"]
                    self.assertGreater(inside.sum(), 0)
                    self.same(np.where(inside, array, dense), array)
                else:
                    self.same(dense, array)
                    self.assertEqual(len(at), (array != 0).sum())

    def test_tiles_are_expanded(self):
        self.write("cube.off", off(*box_faces((0, 0, 0), (4, 4, 4))))
        self.size = ["--resolution", 64]
        report = self.report_of("voxelize", "cube.off", "-o", "cube.vdb", *self.size)
        self.assertGreater(report["grids"][0]["active_tiles"], 100)
        with np.load(self.make("a.npz", "--sparse", grids="density", source="cube.off")) as read:
            at = read["density.coordinates"]
            self.same(at, np.argwhere(np.ones((64,) * 3)).astype(np.int32) + at[0])

    def test_arrays_of_a_mesh_and_their_owners(self):
        self.write("a.vtu", simulation())
        self.size = ["--resolution", 21]
        arrays, _, _ = self.truth("temperature,vel", source="a.vtu")
        with np.load(self.make("a.npz", grids="temperature,vel,tet_id,material",
                               source="a.vtu")) as read:
            self.same(read["temperature"], arrays["temperature"])
            self.same(read["vel"], arrays["vel"])
            self.assertEqual(read["tet_id"].dtype, np.int32)
            ids, transform = read["tet_id"], read["transform"]
            origin = read["origin"]
        points, tets = (np.array(a) for a in lattice(2))
        # Every owner holds its voxel's centre: barycentric coordinates of no less than 0.
        index = np.argwhere(ids >= 0)
        self.assertEqual(len(index), 21 ** 3)
        world = (index + origin) @ transform[:3, :3].T + transform[:3, 3]
        corners = points[tets[ids[tuple(index.T)]]]
        edges = (corners[:, 1:] - corners[:, :1]).transpose(0, 2, 1)
        share = np.linalg.solve(edges, (world - corners[:, 0])[:, :, None])[:, :, 0]
        self.assertGreaterEqual(min(share.min(), (1 - share.sum(1)).min()), -1e-5)
        raw = self.make("a.raw", grids="vel,tet_id", source="a.vtu")
        header = json.loads(self.path("a.raw.json").read_text())
        self.assertEqual([a["name"] for a in header["arrays"]], ["tet_id", "vel"])
        data = raw.read_bytes()
        for entry, expected in zip(header["arrays"], (ids, arrays["vel"])):
            part = np.frombuffer(data[entry["offset"]:entry["offset"] + entry["bytes"]],
                                 entry["type"])
            part = part.reshape(*header["size"][::-1], -1)[..., :entry["components"]]
            self.same(np.squeeze(part.transpose(2, 1, 0, 3)), expected)
        self.assertEqual(header["transform"], transform.tolist())
        self.assertEqual(header["origin"], origin.tolist())

    @unittest.skipUnless(vtk_io, "VTK is not there")
    def test_vti(self):
        arrays, low, h = self.truth()
        for more in ([], ["--compress"]):
            reader = vtk_io.vtkXMLImageDataReader()
            reader.SetFileName(str(self.make("a.vti", *more)))
            reader.Update()
            image = reader.GetOutput()
            size = arrays["mask"].shape
            for name, array in arrays.items():
                read = vtk_numpy.vtk_to_numpy(image.GetPointData().GetArray(name))
                self.same(read.reshape(size[::-1]).transpose(2, 1, 0), array)
            self.assertEqual(image.GetExtent()[::2], tuple(low))
            for index in (low, low + [3, 2, 1]):
                point = image.GetPoint(image.ComputePointId([int(v) for v in index]))
                np.testing.assert_allclose(
                    point, self.grid.transform.indexToWorld(tuple(map(int, index))), rtol=1e-14)
        self.write("a.vtu", simulation())
        self.size = ["--resolution", 11]
        arrays, _, _ = self.truth("vel", source="a.vtu")
        reader.SetFileName(str(self.make("v.vti", grids="vel", source="a.vtu")))
        reader.Update()
        read = vtk_numpy.vtk_to_numpy(reader.GetOutput().GetPointData().GetVectors())
        self.same(read.reshape(11, 11, 11, 3).transpose(2, 1, 0, 3), arrays["vel"])

    @unittest.skipUnless(sitk, "SimpleITK is not there")
    def test_nrrd(self):
        for name in GRIDS.split(","):
            arrays, low, h = self.truth(name)
            for more in ([], ["--compress"]):
                image = sitk.ReadImage(str(self.make("a.nrrd", *more, grids=name)))
                self.same(sitk.GetArrayFromImage(image).transpose(2, 1, 0), arrays[name])
                self.assertEqual(image.GetSpacing(), (h,) * 3)
                world = image.TransformIndexToPhysicalPoint((3, 2, 1))
                np.testing.assert_allclose(
                    world, self.grid.transform.indexToWorld(tuple(map(int, low + [3, 2, 1]))),
                    rtol=1e-12)
        self.write("a.vtu", simulation())
        self.size = ["--resolution", 11]
        arrays, _, _ = self.truth("vel", source="a.vtu")
        image = sitk.ReadImage(str(self.make("v.nrrd", grids="vel", source="a.vtu")))
        self.same(sitk.GetArrayFromImage(image).transpose(2, 1, 0, 3), arrays["vel"])

    @unittest.skipUnless(h5py, "h5py is not there")
    def test_hdf5(self):
        arrays, low, h = self.truth()
        for more in ([], ["--compress"]):
            with h5py.File(self.make("a.h5", *more, "--units", "mm")) as read:
                self.assertEqual(sorted(read), sorted(arrays))
                for name, array in arrays.items():
                    self.same(read[name][()], array.astype(read[name].dtype))
                self.assertEqual(read.attrs["origin"].tolist(), low.tolist())
                self.assertEqual(read.attrs["voxel_size"].tolist(), [h] * 3)
                self.assertEqual(read.attrs["units"], b"mm")
                world = read.attrs["transform"] @ np.append(low, 1)
                np.testing.assert_allclose(
                    world[:3], self.grid.transform.indexToWorld(tuple(map(int, low))), rtol=1e-14)

    @unittest.skipUnless(tifffile, "tifffile is not there")
    def test_tiff(self):
        for name in GRIDS.split(","):
            arrays, _, h = self.truth(name)
            for more in ([], ["--compress"]):
                with tifffile.TiffFile(self.make("a.tif", *more, "--units", "mm",
                                                 grids=name)) as read:
                    self.same(read.asarray().transpose(2, 1, 0),
                              arrays[name].astype(read.pages[0].dtype))
                    self.assertEqual(read.imagej_metadata["slices"], arrays[name].shape[2])
                    self.assertEqual(read.imagej_metadata["spacing"], h)
                    self.assertEqual(read.imagej_metadata["unit"], "mm")
                    over, under = read.pages[0].tags["XResolution"].value
                    self.assertAlmostEqual(under / over / h, 1, 9)
        self.write("a.vtu", simulation())
        self.size = ["--resolution", 11]
        arrays, _, _ = self.truth("vel", source="a.vtu")
        read = tifffile.imread(self.make("v.tif", grids="vel", source="a.vtu"))
        self.same(read.transpose(3, 2, 0, 1), arrays["vel"])

    def test_binvox(self):
        arrays, low, h = self.truth("mask")
        mask = arrays["mask"]
        cube, translate, scale = read_binvox(self.make("a.binvox", grids="mask"))
        side = max(mask.shape)
        self.assertEqual(cube.shape, (side,) * 3)
        self.same(cube[tuple(slice(n) for n in mask.shape)].astype(bool), mask)
        self.assertEqual(cube.sum(), mask.sum())
        self.assertAlmostEqual(scale, side * h, 12)
        corner = self.grid.transform.indexToWorld(tuple(float(v) - 0.5 for v in low))
        np.testing.assert_allclose(translate, corner, rtol=1e-14)
        # Without --grid a .binvox file is made of the mask.
        self.succeed("voxelize", "a.off", "-o", "b.binvox", *self.size)
        self.assertEqual(self.path("b.binvox").read_bytes(), self.path("a.binvox").read_bytes())
        self.refuse(2, "voxelize", "a.off", "-o", "c.binvox", "--grid", "density",
                    says=("holds a mask", "density"))

    def test_arrays_become_the_same_volume(self):
        self.make("all.vdb")
        for name in ("density", "surface", "mask"):
            self.make(name + ".vdb", grids=name)
        self.write("a.vtu", simulation())
        self.make("vel.vdb", grids="vel,temperature,tet_id", source="a.vtu")
        several = [("x.npz",), ("x.npz", "--compress"), ("x.npz", "--sparse"), ("x.vti",), ("x.vti", "--compress"),
                   ("x.raw",), ("x.h5",), ("x.h5", "--compress")]
        one = [("x.nrrd",), ("x.nrrd", "--compress")]
        cases = [("all", case) for case in several] + [("mask", ("x.binvox",))]
        cases += [(name, case) for name in ("density", "surface", "mask") for case in several + one]
        for name, (output, *more) in cases:
            self.succeed("convert", name + ".vdb", "-o", output, *more)
            self.succeed("convert", output, "-o", "back.vdb")
            if output == "x.binvox":  # which has no room for the origin within a voxel
                self.assertEqual(self.report_of("info", output)["input"][0]["grids"][0]["active_voxels"],
                                 self.report_of("info", "mask.vdb")["input"][0]["grids"][0]["active_voxels"])
            else:
                self.assertEqual(self.hash_of("back.vdb"), self.hash_of(name + ".vdb"), (name, output, more))
                self.assertEqual(self.hash_of(output), self.hash_of("back.vdb"))
        # tet_id: its background, -1, is given by lists alone.
        self.succeed("convert", "vel.vdb", "-o", "x.npz", "--sparse")
        self.succeed("convert", "x.npz", "-o", "back.vdb")
        self.assertEqual(self.hash_of("back.vdb"), self.hash_of("vel.vdb"))
        self.succeed("convert", "vel.vdb", "-o", "x.vti", "--grid", "vel")
        self.succeed("compare", "vel.vdb", "x.vti", status=8)  # which has one of three grids
        self.succeed("convert", "vel.vdb", "-o", "id.npy", "--grid", "tet_id")
        self.succeed("convert", "id.npy", "-o", "id.vdb", "--background", -1)
        self.assertEqual(self.report_of("info", "id.vdb")["input"][0]["grids"][0]["active_voxels"],
                         (np.load(self.path("id.npy")) != -1).sum())

    def test_arrays_of_others(self):
        values = np.zeros((20, 30, 40), np.float64)
        values[3:9, 4:20, 5:30] = 0.75
        values[4, 4, 5] = math.nan
        np.savez_compressed(self.path("a.npz"), field=values, names=np.array(["a"]), table=np.eye(2))
        report = self.report_of("convert", "a.npz", "-o", "a.vdb", "--voxel-size", "0.5,1,2", "--origin", "1,2,3")
        self.assertEqual(sorted(w["code"] for w in report["warnings"]), ["not-numbers", "unread-grid", "unread-grid"])
        grid, = vdb.readAll(str(self.path("a.vdb")))[0]
        self.assertEqual((grid.name, grid.gridClass, grid.background), ("field", "fog volume", 0.0))
        self.assertEqual(grid.activeVoxelCount(), 6 * 16 * 25 - 1)
        read = np.zeros(values.shape, np.float32)
        grid.copyToArray(read)
        self.same(read, np.nan_to_num(values).astype(np.float32))
        self.assertEqual(grid.transform.indexToWorld((1, 1, 1)), (1.5, 3.0, 5.0))
        np.save(self.path("z.npy"), values.transpose(2, 1, 0))
        self.succeed("convert", "z.npy", "-o", "z.vdb", "--axes", "zyx")
        vdb.readAll(str(self.path("z.vdb")))[0][0].copyToArray(read)
        self.same(read, np.nan_to_num(values).astype(np.float32))
        self.succeed("render", "z.npy", "-o", "z.png")
        self.succeed("convert", "z.npy", "-o", "z.stl")
        self.assertEqual(self.report_of("info", "z.npy", "z.npy")["input"][1]["format"], "NumPy .npy")
        if tifffile:
            for z in range(40):  # whose names are not in the order of their numbers
                tifffile.imwrite(self.path("s_%d.tif" % z), np.nan_to_num(values[:, :, z]).T.astype(np.float32))
            self.succeed("convert", str(self.path("s_*.tif")), "-o", "s.vdb")
            vdb.readAll(str(self.path("s.vdb")))[0][0].copyToArray(read)
            self.same(read, np.nan_to_num(values).astype(np.float32))
            self.succeed("convert", *sorted("s_%d.tif" % z for z in range(40)), "-o", "t.vdb")
            self.assertEqual(self.hash_of("t.vdb"), self.hash_of("s.vdb"))
            self.refuse(2, "convert", "s_1.tif", "z.npy", "-o", "0.vdb", says=("z.npy", ".tif"))
            self.refuse(2, "convert", "z.npy", "s_1.tif", "-o", "0.vdb", says=("second file",))
        for kind in "i1 u1 i2 u2 i4 u4 f2 f4 f8".split():  # a list of voxels
            for order in "<>":
                one = np.array([[1, 2, 3]], np.int32)
                np.savez(self.path("l.npz"), **{"d.coordinates": one, "d.values": np.full(1, 3, order + kind),
                                                "d.background": np.array(2.5 if kind[0] == "f" else 7, order + kind)})
                self.succeed("convert", "l.npz", "-o", "l.vdb")
                self.succeed("convert", "l.vdb", "-o", "k.npz", "--sparse")
                with np.load(self.path("k.npz")) as read:
                    self.assertEqual(read["d.background"], 2.5 if kind[0] == "f" else 7, kind)
        np.save(self.path("0.npy"), np.zeros((4, 4, 4)))
        self.refuse(3, "convert", "0.npy", "-o", "0.vdb", says=("background",))
        self.refuse(3, "voxelize", "z.npy", "-o", "0.vdb", says=("is a volume", "tetvdb convert"))
        self.refuse(2, "convert", "z.vdb", "-o", "0.vdb", "--background", 1, says=("--background",))
        self.refuse(2, "convert", "z.npy", "-o", "0.vdb", "--axes", "yxz")
        self.refuse(2, "convert", "z.npy", "-o", "0.nhdr")
        self.refuse(2, "convert", "z.npy", "-o", "0.vdb", "--background", "nan")
        self.write("b.raw", "numbers")
        self.refuse(3, "info", "b.raw", says=("b.raw.json",))
        self.assertFalse(self.path("0.vdb").exists())

    def test_distances_in_the_whole_box(self):
        points, faces = box_faces((0, 0, 0), (3, 2, 1))
        self.write("box.off", off(points, faces))
        self.size = ["--voxel-size", 0.125]
        with np.load(self.make("a.npz", "--half-width", "all", grids="surface",
                               source="box.off")) as read:
            values = read["surface"]
            self.assertEqual(values.shape, (24 + 7, 16 + 7, 8 + 7))
            at = np.stack(np.indices(values.shape), -1) + read["origin"]
            world = at @ read["transform"][:3, :3] + read["transform"][:3, 3]
        beyond = np.abs(world - [1.5, 1, 0.5]) - [1.5, 1, 0.5]
        truth = np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(-1), 0)
        np.testing.assert_allclose(values, truth, rtol=0, atol=1.25e-6)
        self.succeed("voxelize", "box.off", "-o", "a.vdb", *self.size, "--grid", "surface",
                     "--half-width", "all")
        self.assertEqual(self.report_of("info", "a.vdb")["input"][0]["grids"][0]["active_voxels"],
                         values.size)
        self.size = ["--fit", 32]
        with np.load(self.make("f.npz", "--half-width", "all", grids="surface",
                               source="box.off")) as read:
            values = read["surface"]
            self.assertEqual(values.shape, (32, 32, 32))
            at = np.stack(np.indices(values.shape), -1) + read["origin"]
            world = at @ read["transform"][:3, :3] + read["transform"][:3, 3]
            h = read["voxel_size"][0]
        beyond = np.abs(world - [1.5, 1, 0.5]) - [1.5, 1, 0.5]
        truth = np.linalg.norm(np.maximum(beyond, 0), axis=-1) + np.minimum(beyond.max(-1), 0)
        np.testing.assert_allclose(values, truth, rtol=0, atol=1e-5 * h)
        self.refuse(2, "voxelize", "box.off", "-o", "b.vdb", "--grid", "fog", "--half-width",
                    "all", says="fog")
        self.refuse(2, "voxelize", "box.off", "-o", "b.vdb", "--grid", "surface", "--half-width",
                    "most", says="--half-width")

    def test_what_a_format_has_no_place_for(self):
        for name in ("a.npy", "a.nrrd", "a.tif", "a.binvox"):
            self.refuse(2, "voxelize", "a.off", "-o", name, "--grid", "mask,density",
                        says=("one grid", ".npz", ".vti"))
        self.refuse(2, "voxelize", "a.off", "-o", "a.vti", "--sparse", says=(".npz", "--sparse"))
        self.refuse(2, "voxelize", "a.off", "-o", "a.npy", "--compress", says=(".npz", ".nrrd"))
        self.refuse(2, "voxelize", "a.off", "-o", "a.vdb", "--box", "0,0,0,1,1,1", says="arrays")
        self.refuse(2, "voxelize", "a.off", "-o", "a.npz", "--half", says="--half")
        self.refuse(2, "voxelize", "a.off", "-o", "a.npz", "--box", "0,0,0,1,1,1.5", says="--box")
        self.refuse(2, "voxelize", "a.off", "-o", "a.xyz", says=(".vdb", ".npz"))

    def test_an_array_larger_than_the_disk_is_refused_before_any_work(self):
        wide = "--box", "0,0,0,99999,99999,99999"
        self.refuse(4, "voxelize", "a.off", "-o", "a.npz", *wide, says=("4000000.0 GB", "free"))
        self.refuse(4, "voxelize", "a.off", "-o", "a.npy", "--resolution", 100000,
                    says=("GB", "free"))

    def test_a_full_disk_leaves_nothing(self):
        def small():
            resource.setrlimit(resource.RLIMIT_FSIZE, (60000, 60000))
        for name in ("a.npz", "a.vti", "a.nrrd", "a.h5", "a.tif", "a.raw", "a.npy"):
            result = self.refuse(7, "voxelize", "a.off", "-o", name, *self.size,
                                 says="cannot write", preexec_fn=small)
            self.assertIn(name, result.lines[0])

    def test_frames_of_a_sequence_have_one_size(self):
        points, faces = box_faces()
        for i in range(3):
            moved = [tuple(c * (1 + i) for c in p) for p in points]
            self.write(f"f.{i}.off", off(moved, faces))
        self.succeed("voxelize", "f.0.off", "f.1.off", "f.2.off", "-o", "f.npz", "--resolution", 12)
        sizes = {np.load(self.path(f"f.000{i}.npz"))["density"].shape for i in (1, 2, 3)}
        self.assertEqual(len(sizes), 1)
        sums = [np.load(self.path(f"f.000{i}.npz"))["density"].sum() for i in (1, 2, 3)]
        self.assertEqual(sums, [64, 512, 1728])


class ConvertTest(program.CommandLineTest):
    def test_triangles_as_they_stand(self):
        points, faces = box_faces()
        self.write("a.off", off(points, faces + [faces[0]]))
        report = self.report_of("convert", "a.off", "-o", "a.ply")
        self.assertEqual(report["output"][0]["triangles"], 13)
        report = self.report_of("info", "a.ply")
        self.assertEqual(report["input"][0]["triangles"], 13)
        self.refuse(2, "convert", "a.off", "-o", "a.msh", says="tetrahedralize")
        self.refuse(2, "convert", "a.off", "-o", "a.vdb", says="voxelize")
        self.refuse(2, "convert", "a.off", "-o", "a.npz", says="voxelize")
        self.refuse(2, "convert", "a.off", "-o", "a.xyz", says=(".stl", ".vdb", ".npz"))
        self.refuse(2, "convert", "a.off", "-o", "a.off", says="input")
        self.refuse(3, "convert", "none.off", "-o", "a.stl", says="none.off")

    def test_tets_with_arrays_and_their_surface(self):
        self.write("a.vtu", simulation())
        report = self.report_of("convert", "a.vtu", "-o", "a.msh")
        self.assertEqual(report["output"][0]["tets"], 48)
        self.succeed("convert", "a.msh", "-o", "b.vtu")
        for name in ("a.vtu", "a.msh", "b.vtu"):
            self.succeed("voxelize", name, "-o", name + ".vdb", "--resolution", 9, "--grid",
                         "temperature,vel,tet_id")
        self.assertEqual(len({self.hash_of(n + ".vdb") for n in ("a.vtu", "a.msh", "b.vtu")}), 1)
        report = self.report_of("convert", "a.vtu", "-o", "a.stl")
        self.assertEqual(report["output"][0]["triangles"], 48)

    def test_volumes_to_volumes_and_surfaces(self):
        self.write("a.off", off(*BALL))
        self.succeed("voxelize", "a.off", "-o", "a.vdb", "--resolution", 24, "--grid",
                     "surface,density,mask")
        self.succeed("convert", "a.vdb", "-o", "a.nvdb")
        self.succeed("convert", "a.nvdb", "-o", "b.vdb")
        self.assertEqual(self.hash_of("a.vdb"), self.hash_of("b.vdb"))
        report = self.report_of("convert", "a.vdb", "-o", "c.vdb", "--grid", "mask,density")
        self.assertEqual([g["name"] for g in report["grids"]], ["mask", "density"])
        for grid, off_by in (("surface", 0.01), ("density", 0.25), ("mask", 0.25)):
            report = self.report_of("convert", "a.vdb", "-o", "s.stl", "--grid", grid)
            info = self.report_of("info", "s.stl")["input"][0]
            self.assertAlmostEqual(info["volume"] / (4 / 3 * math.pi * 1.7 * 0.97), 1, delta=off_by)
        self.refuse(2, "convert", "a.vdb", "-o", "s.stl", "--grid", "mask,density", says="--grid")
        self.refuse(2, "convert", "a.vdb", "-o", "s.npz", "--grid", "none",
                    says=("none", "density, mask, surface"))
        self.refuse(2, "convert", "a.vdb", "-o", "s.msh", says=".stl")


if __name__ == "__main__":
    unittest.main()
