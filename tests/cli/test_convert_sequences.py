# SPDX-License-Identifier: Apache-2.0
"""Sequences of files in another format."""

import unittest

import numpy as np

import program
from test_fields import vtu_with
from program import lattice


class ConvertSequences(program.CommandLineTest):
    def arrays(self):
        """Frames 8 to 11, the first of zeros, with a block that grows."""
        for i in range(4):
            values = np.zeros((20, 20, 20), np.float32)
            values[2:4 + 3 * i, 3:9, 4:12] = 0.5 * i
            np.save(self.path("f_%d.npy" % (i + 8)), values)

    def test_arrays_to_volumes_and_back(self):
        self.arrays()
        report = self.report_of("convert", "f_*.npy", "-o", "f.vdb", "--voxel-size", 0.5)
        self.assertEqual([f["input"] for f in report["frames"]], [["f_%d.npy" % i] for i in (8, 9, 10, 11)])
        self.assertEqual([f["output"] for f in report["frames"]], [f"f.000{i}.vdb" for i in (1, 2, 3, 4)])
        self.assertEqual([o["bytes"] for o in report["output"]],
                         [self.path(f"f.000{i}.vdb").stat().st_size for i in (1, 2, 3, 4)])
        self.assertEqual([f["grids"][0]["active_voxels"] for f in report["frames"]], [0, 5 * 48, 8 * 48, 11 * 48])
        self.assertEqual(report["warnings"], [])
        for i in (9, 11):
            self.succeed("convert", "f_%d.npy" % i, "-o", "one.vdb", "--voxel-size", 0.5)
            self.assertEqual(self.hash_of("one.vdb"), self.hash_of(f"f.000{i - 7}.vdb"))
        # One size for all, so that the arrays can be stacked.
        self.succeed("convert", *(f"f.000{i}.vdb" for i in (1, 2, 3, 4)), "-o", "g.npz")
        for i in range(4):
            with np.load(self.path(f"g.000{i + 1}.npz")) as read:
                self.assertEqual(read["origin"].tolist(), [2, 3, 4])
                expected = np.zeros((11, 6, 8), np.float32)
                expected[:2 + 3 * i] = 0.5 * i
                np.testing.assert_array_equal(read["density"], expected)
        self.succeed("convert", "f.*.vdb", "-o", "h.npy", "--frames", "2:4:2")
        self.assertEqual([np.load(self.path(f"h.000{i}.npy")).shape for i in (1, 2)], [(11, 6, 8)] * 2)
        self.assertFalse(self.path("h.0003.npy").exists())
        self.succeed("convert", "f.*.vdb", "-o", "s.npz", "--sparse")
        with np.load(self.path("s.0001.npz")) as read:
            self.assertEqual(read["density.coordinates"].shape, (0, 3))
        self.succeed("convert", "f.*.vdb", "-o", "f.nvdb")
        for i in (1, 4):
            self.assertEqual(self.hash_of(f"f.000{i}.nvdb"), self.hash_of(f"f.000{i}.vdb"))

    def test_collection_of_images(self):
        self.arrays()
        self.succeed("convert", "f_*.npy", "-o", "v.vdb", "--frames", "2:3")
        self.succeed("convert", "v.*.vdb", "-o", "v.vti", "--box", "0,0,0,19,19,19")
        self.write("run.pvd", """<VTKFile type="Collection"><Collection>
            <DataSet timestep="2.5" file="v.0002.vti"/><DataSet timestep="1" file="v.0001.vti"/>
            </Collection></VTKFile>""")
        report = self.report_of("convert", "run.pvd", "-o", "r.vdb")
        self.assertEqual([f["time"] for f in report["frames"]], [1, 2.5])
        for i in (1, 2):
            self.assertEqual(self.hash_of(f"r.000{i}.vdb"), self.hash_of(f"v.000{i}.vdb"))

    def test_meshes(self):
        for i in range(3):
            points, tets = lattice(1 + i)
            self.write("m_%d.vtu" % i, vtu_with(points, tets, [("T", [p[0] for p in points])]))
        self.succeed("convert", "m_*.vtu", "-o", "m.msh")
        self.assertEqual([self.report_of("info", f"m.000{i + 1}.msh")["input"][0]["tets"] for i in range(3)],
                         [self.report_of("info", f"m_{i}.vtu")["input"][0]["tets"] for i in range(3)])
        self.succeed("convert", "m_*.vtu", "-o", "m.stl")
        self.assertTrue(self.path("m.0003.stl").exists())

    def test_what_differs_is_said(self):
        np.save(self.path("d_1.npy"), np.ones((3, 3, 3), np.uint8))
        np.save(self.path("d_2.npy"), np.full((3, 3, 3), 7, np.uint8))
        warning, = self.report_of("convert", "d_*.npy", "-o", "d.vdb")["warnings"]
        self.assertEqual(warning["code"], "sequence-grids")
        self.assertIn("d_2.npy", warning["text"])
        self.succeed("convert", "d_2.npy", "-o", "e_1.vdb")
        self.succeed("convert", "d_2.npy", "-o", "e_2.vdb", "--voxel-size", 2)
        warning, = self.report_of("convert", "e_*.vdb", "-o", "e.npz")["warnings"]
        self.assertEqual(warning["code"], "sequence-transform")

    def test_refusals(self):
        self.arrays()
        self.path("f_9.npy").unlink()
        self.refuse(3, "convert", "f_*.npy", "-o", "f.vdb", says=("number 9 is missing", "--allow-gaps"))
        self.succeed("convert", "f_*.npy", "-o", "f.vdb", "--allow-gaps")
        self.refuse(2, "convert", "f.*.vdb", "--tiles", "tiles", says=("--tiles", "sequence"))
        self.refuse(2, "convert", "f.*.vdb", "-o", "f.vdb", says=("f.0001.vdb", "input"))
        self.refuse(3, "convert", "f.*.vdb", "-o", "g.stl", says=("frame 1",))
        self.write("parts.pvd", """<VTKFile type="Collection"><Collection>
            <DataSet timestep="0" part="0" file="f.0001.vdb"/><DataSet timestep="0" part="1" file="f.0002.vdb"/>
            </Collection></VTKFile>""")
        self.refuse(2, "convert", "parts.pvd", "-o", "g.vdb", says=("2 files", "voxelize"))
        self.write("f_10.npy", "no array")
        self.path("f.0002.vdb").unlink()
        self.refuse(3, "convert", "f_*.npy", "-o", "f.vdb", "--allow-gaps", says=("frame 2 (f_10.npy)",))
        self.assertTrue(self.path("f.0001.vdb").exists())
        self.assertFalse(self.path("f.0002.vdb").exists())


if __name__ == "__main__":
    unittest.main()
