# SPDX-License-Identifier: Apache-2.0
"""Surfaces: compare of meshes, and repair."""

import math
import unittest
import zipfile
from itertools import product
from random import Random
from xml.etree import ElementTree

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


def ball(n, noise=0.0):
    """An octahedron whose edges are cut in n, drawn onto the sphere: 8 n^2 faces."""
    points, numbers, faces = [], {}, []

    def at(*key):
        if key not in numbers:
            numbers[key] = len(points)
            length = sum(c * c for c in key)**0.5 / (1 + noise * math.sin(1000 * len(points)))
            points.append([c / length for c in key])
        return numbers[key]

    for sx in (1, -1):
        for sy in (1, -1):
            for sz in (1, -1):
                def corner(i, j):
                    return at(sx * (n - i - j), sy * i, sz * j)

                def add(a, b, c):
                    faces.append([a, b, c] if sx * sy * sz > 0 else [a, c, b])

                for i in range(n):
                    for j in range(n - i):
                        add(corner(i, j), corner(i + 1, j), corner(i, j + 1))
                        if i + j + 1 < n:
                            add(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1))
    return off(points, faces)


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
        report = self.report_of("repair", "open.off", "-o", "out.off")
        section = report["repair"]
        self.assertFalse(section["remeshed"])
        self.assertEqual(section["source"], "triangles")
        self.assertEqual(section["defects"]["boundary_edges"], 3)
        self.assertIn("not watertight", section["verdict"])
        self.assertEqual(section["cleaned"]["welded_points"], 0)
        self.assertEqual(section["triangles_before"], 11)
        self.assertEqual(section["triangles"], 12)
        self.assertEqual(section["local"]["holes"], [{"edges": 3, "faces": 1, "points": 0}])
        self.assertEqual([section["changes"][k] for k in ("kept", "added", "removed")], [11, 1, 0])
        self.assertAlmostEqual(section["changes"]["distance_from_input"], 0)
        self.assertAlmostEqual(section["volume"], 1)
        self.assertEqual([s["name"] for s in report["stages"]],
                         ["read", "clean", "check", "repair", "compare", "write"])
        self.assertEqual(report["warnings"], [])
        self.assert_closed("out.off")
        text = self.succeed("repair", "open.off", "-o", "out.off").out
        self.assertIn("holes filled: 1, of 3 edges", text)
        self.assertIn("faces: 11 kept, 1 added, 0 removed", text)

    def test_remeshed(self):
        points, faces = box_faces()
        self.write("open.off", off(points, faces[1:]))
        report = self.report_of("repair", "open.off", "-o", "out.off", "--resolution", 40,
                                "--remesh")
        section = report["repair"]
        self.assertTrue(section["remeshed"])
        self.assertLess(section["triangles"], section["triangles_extracted"])
        self.assertAlmostEqual(section["volume"], 1, delta=0.15)
        self.assertEqual([s["name"] for s in report["stages"]],
                         ["read", "clean", "voxelize", "extract", "compare", "compare", "write"])
        self.assert_closed("out.off")

    def test_floats(self):
        """What STL rounds crosses nothing."""
        points, faces = box_faces()
        more, others = box_faces((0.3, 0.4, 0.2), (1.6, 1.5, 1.7))
        faces += [[c + len(points) for c in face] for face in others]
        turned = [(1000 + (0.8 * x - 0.6 * y + 0.01 * z) / 99, (0.6 * x + 0.8 * y) / 99, z / 99)
                  for x, y, z in points + more]
        self.write("two.off", off(turned, faces))
        self.assertIsNone(
            self.report_of("repair", "two.off", "-o", "out.off")["repair"]["rounded"])
        for options in [], ["--units", "in"], ["--scale", 0.3]:
            report = self.report_of("repair", "two.off", "-o", "out.stl", *options)
            self.assertGreater(report["repair"]["rounded"]["points"], 8)
            self.assertEqual(report["repair"]["rounded"]["crossings"], 0)
            mesh = self.report_of("info", "out.stl")["input"][0]
            self.assertEqual(mesh["verdict"], "watertight")
            self.assertEqual(mesh["defects"]["self_intersections"], 0)
            self.assertEqual(mesh["triangles"], report["repair"]["triangles"])

    def test_walls_thinner_than_floats_resolve(self):
        """Two triangulations of a tilted square, 1e-9 apart, with a common outline; and a box."""
        fewest = 1000
        n = 12
        for seed in 4, 5, 12:
            random = Random(seed)
            points, faces = box_faces((0, 0, -2), (1, 1, -1))
            sides = {}, {}
            for side, offset in zip(sides, (0, -1e-9)):
                for i, j in product(range(n + 1), repeat=2):
                    if {i, j} & {0, n} and side is sides[1]:
                        side[i, j] = sides[0][i, j]
                        continue
                    reach = 0 if {i, j} & {0, n} else 0.3
                    x = (i + random.uniform(-reach, reach)) / n
                    y = (j + random.uniform(-reach, reach)) / n
                    side[i, j] = len(points)
                    points.append((x, y, 0.37 * x + 0.23 * y + offset))
            for i, j in product(range(n), repeat=2):
                (a, e), (b, f), (c, g), (d, h) = (
                    [side[corner] for side in sides]
                    for corner in ((i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)))
                faces += [[a, b, c], [a, c, d], [e, h, f], [f, h, g]]
            self.write("wall.off", off(points, faces))
            rounded = self.report_of("repair", "wall.off", "-o", "wall.stl")["repair"]["rounded"]
            self.assertGreater(rounded["crossing_faces"], 100)
            mesh = self.report_of("info", "wall.stl")["input"][0]
            self.assertEqual(mesh["verdict"], "watertight")
            fewest = min(fewest, mesh["triangles"])
        self.assertLess(fewest, 200)  # holes where one side crossed the other

    def test_overlapping(self):
        points, faces = box_faces()
        more, others = box_faces((0.5, 0.5, 0.5), (1.5, 1.5, 1.5))
        faces += [[c + len(points) for c in face] for face in others]
        self.write("two.off", off(points + more, faces))
        report = self.report_of("repair", "two.off", "-o", "out.off")
        self.assertFalse(report["repair"]["remeshed"])
        self.assertGreater(report["repair"]["local"]["cut_faces"], 0)
        self.assertAlmostEqual(report["repair"]["volume_before"], 2)
        self.assertAlmostEqual(report["repair"]["volume"], 1.875)
        self.assert_closed("out.off")
        all_faces = self.report_of("repair", "two.off", "-o", "all.off", "--resolution", 60,
                                   "--remesh", "--simplify", 0)["repair"]
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

    def test_faces_and_error(self):
        self.write("ball.off", ball(16))
        report = self.report_of("repair", "ball.off", "-o", "out.off", "--faces", 300)
        section = report["repair"]
        self.assertLessEqual(section["triangles"], 300)
        self.assertGreater(section["triangles"], 290)
        self.assertEqual(section["finished"]["triangles_before"], 2048)
        self.assertEqual([s["name"] for s in report["stages"]][-2:], ["simplify", "write"])
        self.assert_closed("out.off")
        compared = self.report_of("compare", "ball.off", "out.off", status=8)["compare"]
        self.assertAlmostEqual(section["finished"]["distance"], compared["hausdorff"],
                               delta=0.02 * compared["hausdorff"])
        for error, length in ("0.02", 0.02), ("1e-2d", 0.02 * 3**0.5):
            section = self.report_of("repair", "ball.off", "-o", "out.off", "--error",
                                     error)["repair"]
            self.assertLess(section["triangles"], 1000)
            self.assertLess(section["finished"]["distance"], length)
            self.assert_closed("out.off")
        self.assertIn("simplified from 2048 triangles",
                      self.succeed("repair", "ball.off", "-o", "out.off", "--error", 0.02).out)
        # Both: the error keeps the number from being reached.
        report = self.report_of("repair", "ball.off", "-o", "out.off", "--faces", 8, "--error",
                                0.01, status=1)
        self.assertEqual([w["code"] for w in report["warnings"]], ["faces-not-reached"])

    def test_smooth(self):
        self.write("ball.off", ball(16, noise=0.01))
        section = self.report_of("repair", "ball.off", "-o", "out.off", "--smooth",
                                 0.005)["repair"]
        self.assertGreater(section["finished"]["smoothed"]["moved"], 1000)
        self.assertLessEqual(section["finished"]["smoothed"]["largest_move"], 0.005 * (1 + 1e-9))
        self.assertLess(abs(section["volume"] / section["volume_before"] - 1), 1.001e-3)
        self.assertIsNone(section["finished"]["triangles_before"])
        self.assert_closed("out.off")

    def objects_of(self, name):
        """Names, numbers of triangles and the unit of a .3mf file's objects."""
        with zipfile.ZipFile(self.path(name)) as archive:
            model = ElementTree.fromstring(archive.read("3D/3dmodel.model"))
        space = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
        return ([(o.get("name"), len(list(o.iter(space + "triangle"))),
                  len(list(o.iter(space + "component")))) for o in model.iter(space + "object")],
                len(list(model.iter(space + "item"))), model.get("unit"))

    def test_several_inputs_are_objects(self):
        points, faces = box_faces()
        self.write("lid & co.off", off(points, faces[1:]))
        self.write("box.off", box((0.5, 0, 0), (2, 1, 1)))  # overlaps the other one
        report = self.report_of("repair", "lid & co.off", "box.off", "-o", "out.3mf", "--units",
                                "cm")
        section = report["repair"]
        self.assertEqual(report["warnings"], [])
        self.assertEqual([(o["name"], o["triangles"]) for o in section["objects"]],
                         [("lid & co", 12), ("box", 12)])
        self.assertEqual(section["changes"]["added"], 1)
        self.assertAlmostEqual(section["volume"], 2.5)
        self.assertEqual(self.objects_of("out.3mf"),
                         ([("lid & co", 12, 0), ("box", 12, 0)], 2, "centimeter"))
        # Objects and their names stay, whether they are repaired again or not.
        section = self.report_of("repair", "out.3mf", "-o", "again.3mf")["repair"]
        self.assertEqual([o["name"] for o in section["objects"]], ["lid & co", "box"])
        self.assertEqual(self.objects_of("again.3mf"), self.objects_of("out.3mf"))
        # Formats without objects: one solid.
        report = self.report_of("repair", "out.3mf", "-o", "one.off", "--resolution", 40)
        self.assertIn("objects-joined", [w["code"] for w in report["warnings"]])
        self.assertAlmostEqual(report["repair"]["volume"], 2, delta=0.01)
        self.assert_closed("one.off")

    def test_units_and_scale(self):
        self.write("box.off", box((0, 0, 0), (1, 2, 3)))
        report = self.report_of("repair", "box.off", "-o", "box.3mf")
        self.assertIn("unit-guessed", [w["code"] for w in report["warnings"]])
        report = self.report_of("repair", "box.off", "-o", "inch.3mf", "--units", "in")
        self.assertEqual(report["warnings"], [])
        self.assertEqual(report["repair"]["units"], "inch")
        self.assertEqual(self.objects_of("inch.3mf")[2], "inch")
        for options, factor in ((("--units", "mm"), 25.4), (("--scale", 2), 2),
                                (("--scale", 2, "--units", "mm"), 50.8)):
            self.succeed("repair", "inch.3mf", "-o", "out.off", *options)
            lines = [line for line in self.path("out.off").read_text().splitlines()
                     if line and not line.startswith("#")]
            points = lines[2:2 + int(lines[1].split()[0])]
            self.assertAlmostEqual(max(float(c) for line in points for c in line.split()),
                                   3 * factor, places=9)
        self.refuse(2, "repair", "box.off", "-o", "x.3mf", "--units", "parsec", says="--units")
        self.refuse(2, "repair", "box.off", "-o", "x.3mf", "--scale", 0, says="--scale")
        self.refuse(2, "repair", "box.off", "box.off", "-o", "box.off", says="box.off")

    def test_creases_of_what_is_remeshed(self):
        points, faces = box_faces()
        inner, others = box_faces((0.2, 0.2, 0.3), (0.8, 0.8, 0.31))
        faces += [[c + len(points) for c in face] for face in others]
        self.write("wall.off", off(points + inner, faces))
        section = self.report_of("repair", "wall.off", "-o", "out.off", "--remesh",
                                 "--resolution", 50)["repair"]
        self.assertTrue(section["remeshed"])
        self.assertEqual(section["triangles"], 12)
        self.assertAlmostEqual(section["volume"], 1, delta=1e-6)
        self.assert_closed("out.off")

    def test_bad_options(self):
        self.write("box.off", box((0, 0, 0), (1, 1, 1)))
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--faces", 3, says="--faces")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--faces", -9, says="--faces")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--error", 0, says="--error")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--error", "2v", says="--error")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--smooth", "nan", says="--smooth")
        self.refuse(2, "repair", "box.off", says="-o")
        self.refuse(2, "repair", "box.off", "-o", "out.vdb", says=".3mf")
        self.refuse(2, "repair", "box.off", "-o", "box.off", says="box.off")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--simplify", -1, says="--simplify")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--simplify", "nan", says="--simplify")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--resolution", 0, says="--resolution")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--shell", "-1", says="--shell")
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--shell", "1e9",
                    says=("--shell", "diagonal"))
        self.refuse(2, "repair", "box.off", "-o", "out.off", "--inside", "all", says="--inside")
        self.refuse(3, "repair", "none.off", "-o", "out.off", says="none.off")
        self.refuse(5, "repair", "box.off", "-o", "out.off", "--remesh", "--resolution", 2000,
                    "--max-time", 0.2, says="time limit")
        self.refuse(7, "repair", "box.off", "-o", "none/out.off", says="none")


if __name__ == "__main__":
    unittest.main(verbosity=2)
