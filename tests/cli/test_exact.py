# SPDX-License-Identifier: Apache-2.0
"""What default options give is exact; grids in a cube of N^3 voxels; volumes in the report."""

import math
import unittest

from program import DATA, CommandLineTest, box_faces, lattice, medit, off
from test_fields import vtu_with


def icosphere(cuts):
    """A closed sphere of radius 1: points, faces that look outward."""
    g = (1 + 5 ** 0.5) / 2
    points = [(-1, g, 0), (1, g, 0), (-1, -g, 0), (1, -g, 0), (0, -1, g), (0, 1, g), (0, -1, -g),
              (0, 1, -g), (g, 0, -1), (g, 0, 1), (-g, 0, -1), (-g, 0, 1)]
    points = [tuple(c / math.hypot(1, g) for c in p) for p in points]
    faces = [(0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4),
             (11, 10, 2), (10, 7, 6), (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8),
             (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10), (8, 6, 7), (9, 8, 1)]
    for _ in range(cuts):
        middles, cut = {}, []

        def middle(a, b):
            key = min(a, b), max(a, b)
            if key not in middles:
                m = [(u + v) / 2 for u, v in zip(points[a], points[b])]
                length = math.hypot(*m)
                middles[key] = len(points)
                points.append(tuple(c / length for c in m))
            return middles[key]

        for a, b, c in faces:
            ab, bc, ca = middle(a, b), middle(b, c), middle(c, a)
            cut += [(a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)]
        faces = cut
    return points, [list(face) for face in faces]


def volume_of(points, faces):
    """By the divergence theorem."""
    total = []
    for a, b, c in ((points[i] for i in face) for face in faces):
        total.append((a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
                      a[2] * (b[0] * c[1] - b[1] * c[0])) / 6)
    return math.fsum(total)


class Exact(CommandLineTest):
    def test_no_voxel_of_a_cube_is_lost(self):
        self.write("cube.off", off(*box_faces((-5.0,) * 3, (5.0,) * 3)))
        for resolution in (128, 256):
            report = self.report_of("voxelize", "cube.off", "-o", "cube.vdb", "--resolution",
                                    resolution)
            [grid] = report["grids"]
            self.assertEqual(grid["active_voxels"], resolution ** 3)
            self.assertEqual(grid["volume"], 1000)
            self.assertEqual(report["warnings"], [])

    def test_volumes_are_the_solids(self):
        points, faces = icosphere(3)
        self.write("ball.off", off(points, faces))
        true = volume_of(points, faces)
        report = self.report_of("voxelize", "ball.off", "-o", "ball.vdb", "--resolution", 100,
                                "--grid", "density,mask,surface,fog,coverage", "--half-width", 5)
        grids = {g["name"]: g for g in report["grids"]}
        self.assertAlmostEqual(grids["coverage"]["volume"] / true, 1, delta=1e-9) # floats
        self.assertAlmostEqual(grids["coverage"]["filled"] / true, 1, delta=1e-10)
        for name in ("density", "surface", "fog"): # the same voxels
            self.assertEqual(grids[name]["volume"], grids["mask"]["volume"])
        self.assertAlmostEqual(grids["surface"]["volume"] / true, 1, delta=2e-3)
        shown = {g["name"]: g for g in self.report_of("info", "ball.vdb")["input"][0]["grids"]}
        for name, grid in grids.items():
            self.assertEqual(shown[name]["volume"], grid["volume"])

    def test_volume_of_large_tiles(self):
        # 4096^3 and 128^3 voxels are tiles; negative ones are not active in a level set.
        self.write("cube.off", off(*box_faces((0.0,) * 3, (300.0,) * 3)))
        report = self.report_of("voxelize", "cube.off", "-o", "cube.vdb", "--voxel-size", 1,
                                "--grid", "surface,coverage,density")
        for grid in report["grids"]:
            self.assertAlmostEqual(grid["volume"] / 300 ** 3, 1, delta=1e-12)


class Shells(CommandLineTest):
    def test_where_a_shell_lies(self):
        self.write("cube.off", off(*box_faces((0.0,) * 3, (10.0,) * 3)))
        shells = {}
        for side in ("both", "outward", "inward"):
            report = self.report_of("voxelize", "cube.off", "-o", side + ".vdb", "--voxel-size",
                                    "0.25", "--shell", 2, "--shell-side", side, "--grid",
                                    "density,surface,mask")
            shells[side] = {g["name"]: g for g in report["grids"]}
            self.assertEqual(shells[side]["surface"]["volume"], shells[side]["mask"]["volume"])
        # The voxels 9 to 31 along each axis are farther than 2 from every face.
        self.assertEqual(shells["inward"]["mask"]["active_voxels"], 40 ** 3 - 23 ** 3)
        self.assertEqual(shells["outward"]["mask"]["box"], {"min": [-8] * 3, "max": [48] * 3})
        self.assertEqual(shells["both"]["mask"]["box"], {"min": [-4] * 3, "max": [44] * 3})
        self.succeed("voxelize", "cube.off", "-o", "default.vdb", "--voxel-size", "0.25",
                     "--shell", 2, "--grid", "density,surface,mask")
        self.assertEqual(self.hash_of("default.vdb"), self.hash_of("both.vdb"))

    def test_open_meshes(self):
        points, faces = box_faces((0.0,) * 3, (10.0,) * 3)
        self.write("open.off", off(points, faces[2:]))
        for side in ("outward", "inward"):
            report = self.report_of("voxelize", "open.off", "-o", "o.vdb", "--voxel-size", 0.5,
                                    "--shell", 2, "--shell-side", side)
            self.assertGreater(report["grids"][0]["active_voxels"], 1000)
        self.refuse(3, "voxelize", "open.off", "-o", "no.vdb", "--shell", 2, "--shell-side",
                    "inward", "--grid", "surface", says=("open edges", "--shell-side"))

    def test_needs_a_shell(self):
        self.write("cube.off", off(*box_faces()))
        self.refuse(2, "voxelize", "cube.off", "-o", "no.vdb", "--shell-side", "inward",
                    says="--shell")
        self.refuse(2, "voxelize", "cube.off", "-o", "no.vdb", "--shell", 1, "--shell-side", "up",
                    says="--shell-side")
        self.refuse(2, "voxelize", "cube.off", "-o", "no.vdb", "--shell", 1, "--shell-side",
                    "inward", "--inside", "flood", says="--shell-side")


class Fit(CommandLineTest):
    def test_a_cube_of_voxels_around_the_model(self):
        self.write("slab.off", off(*box_faces((10.0, -3.0, 7.0), (14.0, -1.0, 8.0))))
        report = self.report_of("voxelize", "slab.off", "-o", "slab.vdb", "--fit", 36, "--padding",
                                2, "--grid", "density,mask,coverage")
        size = 4.0 / 32
        self.assertEqual(report["fit"], {"voxels": 36, "padding": 2})
        for row, (scale, middle) in enumerate(zip((size,) * 3, (12.0, -2.0, 7.5))):
            expected = [0.0] * 4
            expected[row], expected[3] = scale, middle - 17.5 * size
            self.assertEqual(report["transform"][row], expected)
        self.assertEqual(report["transform"][3], [0, 0, 0, 1])
        for grid in report["grids"]:
            self.assertEqual(grid["box"], {"min": [2, 10, 14], "max": [33, 25, 21]})
            self.assertAlmostEqual(grid["volume"], 8)
        info = self.report_of("info", "slab.vdb")["input"][0]
        metadata = info["metadata"]
        self.assertEqual((metadata["fit"], metadata["padding"]), ("36", "2"))
        self.assertEqual([float(n) for n in metadata["world_from_index"].split()],
                         [n for row in report["transform"] for n in row])
        self.assertEqual(info["grids"][0]["origin"], [row[3] for row in report["transform"][:3]])

    def test_y_up_and_tets(self):
        self.write("box.mesh", medit(*lattice(2, origin=(5.0, 6.0, 7.0))))
        report = self.report_of("voxelize", "box.mesh", "-o", "box.vdb", "--fit", 20, "--padding",
                                3, "--grid", "density,tet_id,surface", "--up-axis", "y")
        for grid in report["grids"]:
            low, high = (0, 19) if grid["name"] == "surface" else (3, 16)
            self.assertEqual(grid["box"], {"min": [low] * 3, "max": [high] * 3})
        self.assertEqual(report["warnings"], [])
        # The middle (5.5, 6.5, 7.5) has become (5.5, 7.5, -6.5).
        self.assertAlmostEqual(report["transform"][2][3] + 9.5 / 14, -6.5)

    def test_bands_end_at_the_cube(self):
        self.write("cube.off", off(*box_faces()))
        report = self.report_of("voxelize", "cube.off", "-o", "cube.vdb", "--fit", 16, "--grid",
                                "surface,mask")
        self.assertEqual([w["code"] for w in report["warnings"]], ["cut-band"])
        for grid in report["grids"]:
            self.assertEqual(grid["box"], {"min": [0] * 3, "max": [15] * 3})
        self.assertEqual(report["grids"][0]["volume"], 1)

    def test_sequences_share_a_cube(self):
        for i in range(3):
            points, tets = lattice(1, origin=(float(i), 0.0, 0.0))
            self.write(f"f_{i}.vtu", vtu_with(points, tets, [("T", [p[0] for p in points])]))
        report = self.report_of("voxelize", "f_*.vtu", "-o", "out.vdb", "--fit", 34, "--padding",
                                2, "--grid", "density,T")
        self.assertEqual(report["fit"], {"voxels": 34, "padding": 2})
        for i in range(3):
            for grid in self.report_of("info", f"out.{i + 1:04}.vdb")["input"][0]["grids"]:
                self.assertEqual(grid["box"], {"min": [2 + 10 * i, 12, 12],
                                               "max": [11 + 10 * i, 21, 21]})
        again = self.report_of("voxelize", "f_*.vtu", "-o", "out.vdb", "--fit", 34, "--padding",
                               2, "--grid", "density,T")
        self.assertTrue(all(frame["skipped"] for frame in again["frames"]))

    def test_options_that_exclude_each_other(self):
        self.write("cube.off", off(*box_faces()))
        for options in (("--fit", 8, "--resolution", 8), ("--fit", 8, "--voxel-size", 1),
                        ("--fit", 8, "--origin", "0,0,0"), ("--padding", 1), ("--fit", 0),
                        ("--fit", 8, "--padding", -1)):
            self.refuse(2, "voxelize", "cube.off", "-o", "out.vdb", *options, says="--")
        self.refuse(2, "voxelize", "cube.off", "-o", "out.vdb", "--fit", 8, "--padding", 4,
                    says="--padding")


class StoredVolumes(CommandLineTest):
    def test_the_same_options_give_what_they_gave(self):
        # docs/stability.md promises it. The files are of version 0.1.0.
        folder = DATA / "volumes"
        volumes = {"occupancy.vdb": ("1", "density,mask,tet_id"), "fields.vdb": ("1", "v,T"),
                   "half.vdb": ("1", "density", "--half"), "mask.vdb": ("1", "mask", "--mask-type", "mask"),
                   "tiles.vdb": ("0.1", "mask", "--mask-type", "mask"), "fields.nvdb": ("1", "T,v"),
                   "tiles.nvdb": ("0.1", "mask")}
        self.assertEqual(sorted(volumes), sorted(p.name for p in folder.iterdir() if "vdb" in p.suffix))
        for name, (size, grids, *options) in volumes.items():
            with self.subTest(name):
                self.succeed("voxelize", str(folder / "tetrahedron.vtk"), "--voxel-size", size, "--grid", grids,
                             "-o", name, "-q", *options)
                self.assertEqual(self.hash_of(name), self.hash_of(str(folder / name)))

    def test_the_file_version_of_openvdb_13(self):
        # It adds a type of grid to the version before.
        stored = (DATA / "volumes" / "occupancy.vdb").read_bytes()
        self.path("new.vdb").write_bytes(stored[:8] + bytes([225]) + stored[9:])
        self.assertEqual(self.hash_of("new.vdb"), self.hash_of(str(DATA / "volumes" / "occupancy.vdb")))
        done = self.succeed("info", "new.vdb")
        # Where OpenVDB is built without log4cplus, versions before 13 warn by themselves.
        own = "WARNING: unsupported VDB file format (expected version 224 or earlier, got version 225)\n"
        self.assertNotIn("WARN", done.out)
        self.assertIn(done.err, ("", own))


if __name__ == "__main__":
    unittest.main(verbosity=2)
