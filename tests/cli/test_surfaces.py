# SPDX-License-Identifier: Apache-2.0
"""Surfaces: compare of meshes, and repair."""

import unittest

from program import CommandLineTest, box_faces, lattice, medit, off


def edges_of(text):
    """Directed edges of an OFF file, with how often each comes."""
    lines = [line for line in text.splitlines() if line and not line.startswith("#")]
    vertices, faces = map(int, lines[1].split()[:2])
    counts = {}
    for line in lines[2 + vertices:2 + vertices + faces]:
        corners = line.split()[1:4]
        for k in range(3):
            edge = (corners[k], corners[(k + 1) % 3])
            counts[edge] = counts.get(edge, 0) + 1
    return counts


def box(low, high):
    return off(*box_faces(low, high))


class CompareMeshes(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("box.off", box((0, 0, 0), (1, 1, 1)))
        self.write("larger.off", box((-0.25, -0.25, -0.25), (1.25, 1.25, 1.25)))
        self.write("box.mesh", medit(*lattice(3)))

    def test_same(self):
        report = self.report_of("compare", "box.off", "box.off")
        self.assertTrue(report["compare"]["same"])
        self.assertLess(report["compare"]["hausdorff"], 1e-15)
        self.assertAlmostEqual(report["compare"]["diagonal"], 3**0.5)
        self.assertIn("same", self.succeed("compare", "box.off", "box.off").out)

    def test_tets_are_their_surface(self):
        report = self.report_of("compare", "box.off", "box.mesh")
        self.assertEqual([i["kind"] for i in report["input"]], ["triangles", "tets"])
        self.assertEqual(report["input"][1]["surface_triangles"], 108)

    def test_different(self):
        report = self.report_of("compare", "box.off", "larger.off", status=8)
        section = report["compare"]
        self.assertFalse(section["same"])
        self.assertAlmostEqual(section["a_to_b"]["largest"], 0.25)
        self.assertAlmostEqual(section["a_to_b"]["mean"], 0.25)
        self.assertAlmostEqual(section["a_to_b"]["rms"], 0.25)
        self.assertAlmostEqual(section["b_to_a"]["largest"], 0.25 * 3**0.5)
        self.assertEqual(section["hausdorff"], section["b_to_a"]["largest"])
        self.assertEqual([abs(c - 0.5) for c in section["b_to_a"]["where"]], [0.75] * 3)
        self.assertGreater(section["samples"], 100000)
        quiet = self.succeed("compare", "box.off", "larger.off", "-q", status=8)
        self.assertEqual((quiet.out, quiet.err), ("", ""))

    def test_tolerance(self):
        self.succeed("compare", "box.off", "larger.off", "--tolerance", 0.43, status=8)
        self.succeed("compare", "box.off", "larger.off", "--tolerance", 0.44)

    def test_a_mesh_and_a_volume(self):
        self.succeed("voxelize", "box.off", "-o", "box.vdb", "--resolution", 16)
        self.refuse(2, "compare", "box.off", "box.vdb", says=("volume", "mesh"))
        self.refuse(2, "compare", "box.vdb", "box.off", says=("volume", "mesh"))


class Repair(CommandLineTest):
    def assert_closed(self, name):
        counts = edges_of(self.path(name).read_text())
        self.assertGreater(len(counts), 0)
        for (a, b), count in counts.items():
            self.assertEqual((count, counts.get((b, a))), (1, 1))

    def test_in_order(self):
        self.write("box.off", box((0, 0, 0), (1, 1, 1)))
        report = self.report_of("repair", "box.off", "-o", "out.off")
        self.assertEqual(
            list(report), ["version", "command", "status", "device", "threads", "input", "repair",
                           "stages", "output", "warnings"])
        self.assertFalse(report["repair"]["remeshed"])
        self.assertEqual(report["repair"]["triangles"], 12)
        self.assertIn("no remeshing was needed",
                      self.succeed("repair", "box.off", "-o", "out.off").out)
        self.succeed("compare", "box.off", "out.off")

    def test_open(self):
        points, faces = box_faces()
        self.write("open.off", off(points, faces[1:]))
        report = self.report_of("repair", "open.off", "-o", "out.off", "--resolution", 40)
        section = report["repair"]
        self.assertTrue(section["remeshed"])
        self.assertEqual(section["source"], "triangles")
        self.assertEqual(section["defects"]["boundary_edges"], 3)
        self.assertIn("not watertight", section["verdict"])
        self.assertEqual(section["cleaned"]["welded_points"], 0)
        self.assertEqual(section["triangles_before"], 11)
        self.assertLess(section["triangles"], section["triangles_extracted"])
        self.assertAlmostEqual(section["volume"], 1, delta=0.15)
        self.assertEqual([s["name"] for s in report["stages"]],
                         ["read", "clean", "check", "voxelize", "extract", "write"])
        self.assert_closed("out.off")

    def test_overlapping(self):
        points, faces = box_faces()
        more, others = box_faces((0.5, 0.5, 0.5), (1.5, 1.5, 1.5))
        faces += [[c + len(points) for c in face] for face in others]
        self.write("two.off", off(points + more, faces))
        report = self.report_of("repair", "two.off", "-o", "out.off", "--resolution", 60)
        self.assertTrue(report["repair"]["remeshed"])
        self.assertAlmostEqual(report["repair"]["volume_before"], 2)
        self.assertAlmostEqual(report["repair"]["volume"], 1.875, delta=0.02)
        self.assert_closed("out.off")
        all_faces = self.report_of("repair", "two.off", "-o", "all.off", "--resolution", 60,
                                   "--simplify", 0)["repair"]
        self.assertEqual(all_faces["triangles"], all_faces["triangles_extracted"])
        self.assert_closed("all.off")

    def test_sheet(self):
        self.write("sheet.off", off([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)],
                                    [[0, 1, 2], [0, 2, 3]]))
        self.refuse(3, "repair", "sheet.off", "-o", "out.off", says="--shell")
        report = self.report_of("repair", "sheet.off", "-o", "out.off", "--shell", 0.1,
                                "--resolution", 64)
        self.assertAlmostEqual(report["repair"]["volume"], 0.1 + 0.0157 + 0.0005, delta=0.003)
        self.assert_closed("out.off")

    def test_tets_and_volumes(self):
        self.write("box.mesh", medit(*lattice(2, inverted=True)))
        report = self.report_of("repair", "box.mesh", "-o", "out.off")
        self.assertEqual(report["repair"]["source"], "tets")
        self.assertAlmostEqual(report["repair"]["volume"], 1)
        self.assert_closed("out.off")
        self.succeed("voxelize", "box.mesh", "-o", "box.vdb", "--resolution", 20, "--grid",
                     "density,mask,tet_id")
        for options in ((), ("--grid", "mask")):
            report = self.report_of("repair", "box.vdb", "-o", "volume.off", *options)
            self.assertEqual(report["repair"]["source"], "volume")
            self.assertIsNone(report["repair"]["defects"])
            self.assertAlmostEqual(report["repair"]["volume"], 1, delta=0.03)
            self.assert_closed("volume.off")
        self.refuse(3, "repair", "box.vdb", "-o", "x.off", "--grid", "tet_id", says="int32")
        self.refuse(3, "repair", "box.vdb", "-o", "x.off", "--grid", "none", says="tet_id")
        self.refuse(2, "repair", "box.vdb", "-o", "x.off", "--resolution", 9, says="--resolution")
        self.refuse(2, "repair", "box.mesh", "-o", "x.off", "--grid", "mask", says="--grid")

    def test_bad_options(self):
        self.write("box.off", box((0, 0, 0), (1, 1, 1)))
        self.refuse(2, "repair", "box.off", says="-o")
        self.refuse(2, "repair", "box.off", "-o", "out.vdb", says=".3mf")
        self.refuse(2, "repair", "box.off", "-o", "box.off", says="box.off")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--simplify", -1, says="--simplify")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--simplify", "nan", says="--simplify")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--resolution", 0, says="--resolution")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--shell", "-1", says="--shell")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--inside", "all", says="--inside")
        self.refuse(3, "repair", "none.off", "-o", "out.off", says="none.off")
        self.refuse(5, "repair", "box.off", "-o", "out.off", "--remesh", "--resolution", 2000,
                    "--max-time", 0.2, says="time limit")
        self.refuse(7, "repair", "box.off", "-o", "none/out.off", says="none")


if __name__ == "__main__":
    unittest.main(verbosity=2)
