# SPDX-License-Identifier: Apache-2.0
"""What works: voxelize, info and compare of volumes as in the guide, and their reports."""

import json
import re
import unittest

from program import (DATA, WRITERS, CommandLineTest, box_faces, gmsh, joined, lattice, medit, off, opened, vtu)


def two_blocks():
    """Two unit cubes side by side in x, regions 3 and 7."""
    points, tets = lattice(2)
    more, other = lattice(2, origin=(1.0, 0.0, 0.0))
    shifted = [[c + len(points) for c in tet] for tet in other]
    return points + more, tets + shifted, [3] * len(tets) + [7] * len(other)


class Formats(CommandLineTest):
    def test_every_format_is_listed(self):
        rows = self.report_of("formats")["formats"]
        text = self.succeed("formats").out
        for row in rows:
            self.assertIn(row["name"], text)
            for ending in row["endings"]:
                self.assertIn(ending, text)
        held = {row["name"]: row["holds"] for row in rows}
        self.assertEqual(held["STL"], ["triangles"])
        self.assertEqual(held["Exodus"], ["tets", "triangles", "arrays", "steps"])
        self.assertEqual(held["OpenVDB .vdb"], ["volume", "arrays"])

    def test_messages_name_every_mesh_format(self):
        path = self.write("a.unknown", "hello")
        error = self.refuse(3, "voxelize", path, "-o", "a.vdb").err
        for row in self.report_of("formats")["formats"]:
            if row["read"] and "volume" not in row["holds"]:
                for ending in row["endings"]:
                    self.assertIn(ending, error)

    def test_help_names_every_mesh_format(self):
        text = self.succeed("voxelize", "--help").out
        for row in self.report_of("formats")["formats"]:
            if row["read"] and "volume" not in row["holds"]:
                for ending in row["endings"]:
                    self.assertIn(ending, text)


class Voxelize(CommandLineTest):
    def voxels(self, *arguments, grid=0):
        return self.report_of("voxelize", *arguments, "-o", "out.vdb")["grids"][grid]["active_voxels"]

    def test_every_tie_is_decided_once(self):
        for cells in (1, 2, 4):
            for ending, writer in WRITERS.items():
                self.write("box." + ending, writer(*lattice(cells)))
                self.assertEqual(self.voxels("box." + ending, "--resolution", 16), 16**3)

    def test_level_set(self):
        self.write("box.mesh", medit(*lattice(2)))
        report = self.report_of("voxelize", "box.mesh", "-o", "out.vdb", "--resolution", 16,
                                "--grid", "density,surface,fog", "--half-width", 4)
        self.assertEqual([g["name"] for g in report["grids"]], ["density", "surface", "fog"])
        self.assertEqual([g["class"] for g in report["grids"]],
                         ["fog volume", "level set", "fog volume"])
        self.assertEqual([s["name"] for s in report["stages"]],
                         ["read", "voxelize", "fields", "write"])
        self.assertEqual(report["grids"][0]["active_voxels"], 16**3)
        alone = self.report_of("voxelize", "box.mesh", "-o", "alone.nvdb", "--resolution", 16,
                               "--grid", "surface", "--half-width", 4)
        self.assertEqual(alone["grids"], report["grids"][1:2])
        for arguments in (["--half-width", 0.5], ["--voxel-size", "1,1,2"]):
            self.refuse(2, "voxelize", "box.mesh", "-o", "no.vdb", "--grid", "surface", *arguments)

    def test_open_components_are_closed(self):
        house, plate = box_faces((2.0, 2.0, 0.25), (8.0, 8.0, 3.0)), box_faces((0.0, 0.0, 0.0), (10.0, 10.0, 0.2))

        def bottomless(mesh):
            points, faces = mesh
            low = min(z for x, y, z in points)
            return points, [face for face in faces if any(points[c][2] > low for c in face)]

        made = {}
        for name, mesh in (("closed", joined(house, plate)), ("open", joined(bottomless(house), bottomless(plate)))):
            self.write("open.off", off(*mesh))  # one name, which the volume's metadata has
            made[name] = self.report_of("voxelize", "open.off", "-o", name + ".vdb", "--resolution", 50,
                                        "--grid", "density,coverage")
            self.assertEqual(made[name]["warnings"], [])
        self.assertEqual(made["open"]["mesh"]["open_edges"], 0)
        cleaned = made["open"]["mesh"]["cleaned"]
        self.assertEqual((cleaned["closed_holes"], cleaned["closing_faces"]), (2, 4))
        self.assertEqual(self.hash_of("open.vdb"), self.hash_of("closed.vdb"))
        self.assertIn("2 holes of components that bound a volume: closed by 4 faces",
                      self.succeed("voxelize", "open.off", "-o", "out.vdb", "--resolution", 50).out)
        for inside in ((), ("--inside", "nonzero")):
            report = self.report_of("tetrahedralize" if not inside else "voxelize", "open.off", "-o",
                                    "out.vdb" if inside else "out.msh", *inside)
            cleaned = (report["mesh"] if inside else report["input"][0])["cleaned"]
            self.assertEqual(cleaned["closed_holes"], 2)
        # A shell has the holes too, and other rules do not ask the winding number.
        for options in (("--shell", 0.5), ("--inside", "flood")):
            report = self.report_of("voxelize", "open.off", "-o", "out.vdb", "--resolution", 50, *options)
            self.assertEqual(report["mesh"]["cleaned"]["closed_holes"], 0)

    def test_faces_within_a_solid_are_trimmed(self):
        def boxes(*all_of_them, missing=0):
            points, faces = [], []
            for low, high in all_of_them:
                more, others = box_faces(low, high)
                faces += [[c + len(points) for c in face] for face in others]
                points += more
            return off(points, faces[:len(faces) - missing])

        one = ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0))
        crossing = ((0.5, 0.25, 0.25), (1.5, 0.75, 0.75))
        for name, second, counts in (("apart", ((3.0, 0.0, 0.0), (4.0, 1.0, 1.0)), (0, 0, False)),
                                     ("within", ((0.2, 0.2, 0.2), (0.4, 0.4, 0.4)), (0, 12, False)),
                                     ("crossing", crossing, (10, 2, True))):
            self.write(name + ".off", boxes(one, second))
            report = self.report_of("voxelize", name + ".off", "-o", "out.vdb", "--mesher",
                                    "winding", "--resolution", 32, "--grid", "surface,fog")
            self.assertEqual(report["warnings"], [])
            for grid in report["grids"]:
                trim = grid["trim"]
                self.assertEqual((trim["met"], trim["removed"], trim["cut"] > 0), counts)
        self.write("open.off", boxes(one, crossing, missing=6))
        report = self.report_of("voxelize", "open.off", "-o", "out.vdb", "--mesher", "winding",
                                "--resolution", 32, "--grid", "surface")
        self.assertIn("untrimmed", [w["code"] for w in report["warnings"]])
        self.assertEqual(report["grids"][0]["trim"]["cut"], 0)

    def test_rules(self):
        self.write("box.mesh", medit(*lattice(2)))
        arguments = ("box.mesh", "--voxel-size", 0.25, "--rule")
        self.assertEqual(self.voxels(*arguments, "any"), 5**3)
        self.assertEqual(self.voxels(*arguments, "centre"), 4**3)
        self.assertEqual(self.voxels(*arguments, "all", "--grid", "density,mask", grid=1), 3**3)
        for grid in ("tet_id", "surface", "coverage"):
            self.refuse(2, "voxelize", *arguments, "any", "-o", "no.vdb", "--grid", grid)

    def test_coverage(self):
        self.write("box.mesh", medit(*lattice(2)))
        for size, voxels in (("0.25", 5**3), ("0.25,0.5,0.125", 5 * 3 * 9)):
            report = self.report_of("voxelize", "box.mesh", "-o", "out.vdb", "--voxel-size", size,
                                    "--grid", "coverage")
            [grid] = report["grids"]
            self.assertEqual(grid["name"], "coverage")
            self.assertEqual(grid["active_voxels"], voxels)
            self.assertAlmostEqual(grid["filled"], 1.0, places=12)
            self.assertEqual(grid["overlap"], 0)
        # Between the centres of voxels there is volume, too.
        points, tets = lattice(1, side=0.25)
        self.write("small.mesh", medit([[c + 0.3 for c in p] for p in points], tets))
        arguments = ("voxelize", "small.mesh", "-o", "small.vdb", "--voxel-size", 1, "--grid")
        [grid] = self.report_of(*arguments, "coverage")["grids"]
        self.assertAlmostEqual(grid["filled"], 0.25**3, places=12)
        self.refuse(3, "voxelize", "small.mesh", "-o", "no.vdb", "--voxel-size", 1)
        self.write("open.off", off(*opened(box_faces())))
        self.refuse(3, "voxelize", "open.off", "-o", "no.vdb", "--grid", "coverage", "--mesher",
                    "winding", says=("envelope",))

    def test_report(self):
        self.write("box.mesh", medit(*lattice(2, inverted=True)))
        report = self.report_of("voxelize", "box.mesh", "-o", "out.vdb", "--resolution", 16,
                                "--grid", "density,mask,tet_id,material", "--threads", 2)
        self.assertEqual(
            list(report), ["version", "command", "status", "device", "threads", "input", "mesh",
                           "stages", "transform", "fit", "grids", "output", "warnings"])
        self.assertEqual(report["command"], "voxelize")
        self.assertEqual(report["status"], 0)
        self.assertEqual(report["device"], "cpu")
        self.assertEqual(report["threads"], 2)
        [source] = report["input"]
        self.assertEqual(source["kind"], "tets")
        self.assertEqual(source["vertices"], 27)
        self.assertEqual(source["tets"], 48)
        self.assertEqual(sum(source["cells"].values()), 48)
        self.assertIn("Medit", source["format"])
        self.assertEqual(report["mesh"]["tets"], 48)
        self.assertEqual(report["mesh"]["flipped"], 24)
        self.assertEqual(report["mesh"]["dropped"], 0)
        self.assertAlmostEqual(report["mesh"]["volume"], 1.0)
        self.assertEqual([w["code"] for w in report["warnings"]], ["flipped-tets"])
        self.assertEqual([s["name"] for s in report["stages"]], ["read", "voxelize", "write"])
        for stage in report["stages"]:
            self.assertGreaterEqual(stage["seconds"], 0)
            self.assertGreater(stage["peak_bytes"], 0)
        self.assertEqual([g["name"] for g in report["grids"]],
                         ["density", "mask", "tet_id", "material"])
        self.assertEqual([g["type"] for g in report["grids"]], ["float", "bool", "int32", "int32"])
        for grid in report["grids"]:
            self.assertEqual(grid["active_voxels"], 16**3)
            self.assertAlmostEqual(grid["volume"], 1.0)
        [output] = report["output"]
        self.assertEqual(output["bytes"], self.path("out.vdb").stat().st_size)

    def test_summary_and_quiet(self):
        self.write("box.mesh", medit(*lattice(2)))
        loud = self.succeed("voxelize", "box.mesh", "-o", "out.vdb", "--resolution", 8)
        self.assertIn("out.vdb", loud.out)
        self.assertEqual(loud.err, "")
        quiet = self.succeed("voxelize", "box.mesh", "-o", "out.vdb", "--resolution", 8, "-q")
        self.assertEqual((quiet.out, quiet.err), ("", ""))
        verbose = self.succeed("voxelize", "box.mesh", "-o", "out.vdb", "--resolution", 8, "-v")
        for stage in ("read", "voxelize", "write"):
            self.assertIn(stage, verbose.err)

    def test_progress_in_lines(self):
        # Programs follow these: the stages in order, and percents of the whole that rise.
        self.write("a.mesh", medit(*lattice(3)))
        # There is a line in a tenth of a second at most: fine voxels, for a machine that is fast.
        for resolution in (400, 800, 1600):
            lines = self.succeed("voxelize", "a.mesh", "-o", "a.vdb", "--grid", "coverage", "-v",
                                 "--resolution", resolution).lines
            steps = [m.groups() for line in lines
                     for m in [re.fullmatch(
                         r"tetvdb: ([a-z ]+?)(?: (\d+) %(?:, about \d+ (?:s|min|h) left)?)?", line)]
                     if m]
            if any(percent for _, percent in steps):
                break
        stages = [stage for stage, percent in steps if percent is None]
        self.assertEqual(stages[0], "read")
        self.assertEqual(stages[-1], "write")
        seen, last = set(), 0
        for stage, percent in steps:
            if percent is not None:
                self.assertEqual(stage, stages[len(seen) - 1])
                self.assertGreater(int(percent), last)
                self.assertLessEqual(int(percent), 100)
                last = int(percent)
            else:
                seen.add((stage, len(seen)))
        self.assertTrue(any(percent for _, percent in steps))

    def test_report_into_a_file(self):
        self.write("box.mesh", medit(*lattice(2)))
        result = self.succeed("voxelize", "box.mesh", "-o", "out.vdb", "--json", "report.json")
        self.assertIn("out.vdb", result.out)
        self.assertEqual(json.loads(self.path("report.json").read_text())["status"], 0)

    def test_voxel_sizes(self):
        self.write("box.mesh", medit(*lattice(2)))
        self.assertEqual(self.voxels("box.mesh", "--voxel-size", "0.125"), 8**3)
        self.assertEqual(self.voxels("box.mesh", "--voxel-size", "0.125,0.25,0.5"), 8 * 4 * 2)
        self.assertEqual(self.voxels("box.mesh", "--voxel-size", "0.125", "--origin", "10,-3.5,0.06"),
                         8**3)

    def test_regions(self):
        points, tets, regions = two_blocks()
        names = {3: "steel", 7: "air box"}
        self.write("two.msh", gmsh(points, tets, regions, names))
        size = ("--voxel-size", "0.125")
        self.assertEqual(self.voxels("two.msh", *size), 2 * 8**3)
        for options in (("--region", "3"), ("--region", "steel"), ("--exclude", "7"),
                        ("--exclude", "air box"), ("--region", "3,7", "--exclude", "air box"),
                        ("--bbox", "-1,-1,-1,0.75,2,2"), ("--bbox", "-inf,-inf,-inf,0.5,inf,inf")):
            with self.subTest(options=options):
                self.assertEqual(self.voxels("two.msh", *size, *options), 8**3)
        self.assertEqual(self.voxels("two.msh", *size, "--region", "3", "--region", "7"), 2 * 8**3)
        self.succeed("voxelize", "two.msh", "-o", "out.vdb", *size, "--grid", "material")
        [grid] = self.report_of("info", "out.vdb")["input"][0]["grids"]
        self.assertEqual((grid["min"], grid["max"]), (3, 7))

    def test_several_inputs_become_one_volume(self):
        self.write("a.mesh", medit(*lattice(2)))
        self.write("b.vtu", vtu(*lattice(3, origin=(1.0, 0.0, 0.0))))
        report = self.report_of("voxelize", "a.mesh", "b.vtu", "-o", "both.vdb", "--voxel-size",
                                "0.125", "--grid", "mask,tet_id")
        self.assertEqual(report["grids"][0]["active_voxels"], 2 * 8**3)
        self.assertEqual([s["tets"] for s in report["input"]], [48, 162])
        grids = self.report_of("info", "both.vdb")["input"][0]["grids"]
        self.assertGreater(next(g for g in grids if g["name"] == "tet_id")["max"], 48)

    def test_threads_give_the_same_volume(self):
        points, tets = lattice(5)
        turned = [(x + 0.3 * y, y - 0.2 * z, z + 0.1 * x) for x, y, z in points]
        self.write("box.mesh", medit(turned, tets))
        hashes = set()
        for options in (("--threads", 1), ("--threads", 2), ("--threads", 5)):
            self.succeed("voxelize", "box.mesh", "-o", "out.vdb", "--resolution", 150, "--grid",
                         "density,mask,tet_id", *options)
            hashes.add(self.hash_of("out.vdb"))
        self.assertEqual(len(hashes), 1)

    def test_both_file_formats_hold_the_same(self):
        self.write("box.mesh", medit(*lattice(3)))
        for name in ("out.vdb", "out.nvdb"):
            self.succeed("voxelize", "box.mesh", "-o", name, "--resolution", 50, "--grid",
                         "density,mask,tet_id")
        self.assertEqual(self.hash_of("out.vdb"), self.hash_of("out.nvdb"))
        self.succeed("compare", "out.vdb", "out.nvdb")

    def test_half_and_metadata(self):
        self.write("box.mesh", medit(*lattice(2)))
        self.succeed("voxelize", "box.mesh", "-o", "out.vdb", "--resolution", 20, "--half",
                     "--units", "millimetre")
        [volume] = self.report_of("info", "out.vdb")["input"]
        self.assertEqual(volume["metadata"]["units"], "millimetre")
        self.assertEqual(volume["metadata"]["source"], "box.mesh")
        self.assertIn("TetVDB", volume["metadata"]["creator"])
        [grid] = volume["grids"]
        self.assertEqual(grid["class"], "fog volume")
        self.assertIn("true", grid["metadata"]["is_saved_as_half_float"].lower())

    def test_up_axis(self):
        points, tets = lattice(1)
        tall = [(x, y, 3 * z) for x, y, z in points]
        self.write("tall.mesh", medit(tall, tets))
        self.succeed("voxelize", "tall.mesh", "-o", "out.vdb", "--voxel-size", "0.5", "--up-axis", "y")
        [grid] = self.report_of("info", "out.vdb")["input"][0]["grids"]
        extent = [b - a + 1 for a, b in zip(grid["box"]["min"], grid["box"]["max"])]
        self.assertEqual(extent, [2, 6, 2])
        self.assertLess(grid["box"]["max"][2], 1)

    def test_mesh_is_converted(self):
        points, tets, regions = two_blocks()
        self.write("two.msh", gmsh(points, tets, regions))
        for name in ("copy.msh", "copy.mesh", "copy.vtu"):
            self.succeed("voxelize", "two.msh", "--write-mesh", name)
            [mesh] = self.report_of("info", name)["input"]
            self.assertEqual(mesh["tets"], len(tets))
            self.assertEqual([(r["number"], r["cells"]) for r in mesh["regions"]],
                             [(3, 48), (7, 48)])
            self.assertAlmostEqual(mesh["volume"], 2.0)

    def test_mesh_of_the_repository(self):
        report = self.report_of("voxelize", DATA / "quadcopter_frame.mesh", "-o", "out.vdb",
                                "--resolution", 128)
        self.assertGreater(report["grids"][0]["active_voxels"], 1000)
        self.assertAlmostEqual(report["grids"][0]["volume"] / report["mesh"]["volume"], 1, delta=0.05)


class Info(CommandLineTest):
    def test_mesh(self):
        points, tets, regions = two_blocks()
        self.write("two.msh", gmsh(points, tets, regions, {3: "steel"}))
        [mesh] = self.report_of("info", "two.msh")["input"]
        self.assertEqual(mesh["kind"], "tets")
        self.assertEqual((mesh["vertices"], mesh["tets"]), (54, 96))
        self.assertEqual(mesh["box"], {"min": [0, 0, 0], "max": [2, 1, 1]})
        self.assertAlmostEqual(mesh["volume"], 2.0)
        self.assertEqual(mesh["defects"], {"inverted": 0, "flat": 0})
        self.assertEqual(mesh["regions"], [{"number": 3, "name": "steel", "cells": 48},
                                           {"number": 7, "name": "", "cells": 48}])
        text = self.succeed("info", "two.msh").out
        for part in ("two.msh", "Gmsh", "54", "96", "steel"):
            self.assertIn(part, text)

    def test_inverted_tets_are_counted(self):
        self.write("box.mesh", medit(*lattice(2, inverted=True)))
        [mesh] = self.report_of("info", "box.mesh")["input"]
        self.assertEqual(mesh["defects"], {"inverted": 24, "flat": 0})
        self.assertAlmostEqual(mesh["volume"], 1.0)

    def test_flat_tets_are_counted(self):
        points = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (0.3, 0.3, 1)]
        self.write("flat.mesh", medit([tuple(map(float, p)) for p in points],
                                      [[0, 1, 2, 3], [0, 1, 2, 4]]))
        [mesh] = self.report_of("info", "flat.mesh")["input"]
        self.assertEqual(mesh["defects"], {"inverted": 0, "flat": 1})

    def test_volume(self):
        self.write("box.mesh", medit(*lattice(2)))
        self.succeed("voxelize", "box.mesh", "-o", "out.vdb", "--voxel-size", "0.125", "--grid",
                     "density,tet_id")
        [volume] = self.report_of("info", "out.vdb", "--hash")["input"]
        self.assertEqual(volume["kind"], "volume")
        self.assertRegex(volume["hash"], "^[0-9a-f]{32}$")
        density = next(g for g in volume["grids"] if g["name"] == "density")
        self.assertEqual(density["active_voxels"], 512)
        self.assertEqual(density["voxel_size"], [0.125] * 3)
        self.assertEqual((density["min"], density["max"]), (1, 1))
        text = self.succeed("info", "out.vdb", "--hash").out
        self.assertIn(volume["hash"], text)

    def test_help(self):
        for arguments in (("--help",), ("voxelize", "--help"), ("info", "--help"),
                          ("compare", "--help"), ("--version",)):
            result = self.succeed(*arguments)
            self.assertIn("tetvdb", result.out)
            self.assertEqual(result.err, "")
            if arguments != ("--version",):
                self.assertIn("Examples", result.out)


class InfoOnTriangles(CommandLineTest):
    def look(self, points, faces, *options):
        self.write("a.off", off(points, faces))
        return self.report_of("info", "a.off", *options)["input"][0]

    def test_box(self):
        mesh = self.look(*box_faces(high=(80.0, 40.0, 20.0)))
        self.assertEqual((mesh["kind"], mesh["vertices"], mesh["triangles"]), ("triangles", 8, 12))
        self.assertEqual(mesh["box"], {"min": [0, 0, 0], "max": [80, 40, 20]})
        self.assertAlmostEqual(mesh["volume"], 64000)
        self.assertAlmostEqual(mesh["area"], 11200)
        self.assertEqual(mesh["winding"], {"inside_out": 0, "outside": 0, "inside": 1,
                                           "inside_more_than_once": 0})
        self.assertEqual((mesh["units"], mesh["likely_units"]), ("", "millimetres"))
        self.assertEqual(mesh["verdict"], "watertight")
        defects = mesh["defects"]
        self.assertEqual([key for key, count in defects.items() if count],
                         ["components", "orientable", "watertight", "self_intersections_complete"])
        self.assertEqual(defects["genus"], 0)
        text = self.succeed("info", "a.off").out
        for part in ("a.off", "OFF", "12", "watertight", "millimetres, to judge by the size"):
            self.assertIn(part, text)

    def test_defects_are_counted(self):
        points, faces = box_faces()
        mesh = self.look(points, faces[2:])
        self.assertEqual((mesh["defects"]["boundary_edges"], mesh["defects"]["holes"]), (4, 1))
        self.assertIn("4 open edges in 1 hole", mesh["verdict"])
        mesh = self.look(points, [face[::-1] for face in faces])
        self.assertIn("inside out", mesh["verdict"])
        self.assertAlmostEqual(mesh["volume"], -1)
        mesh = self.look(points, faces + faces[3:5] + [[0, 1, 0]])
        self.assertEqual(mesh["defects"]["duplicate_faces"], 2)
        self.assertEqual(mesh["defects"]["degenerate_faces"], 1)
        self.assertIn("sheet", self.look(points, faces[:2])["verdict"])

    def test_intersections_have_a_limit(self):
        points, faces = box_faces()
        more, other = box_faces((0.5, 0.5, 0.5), (1.5, 1.5, 1.5))
        both = points + more, faces + [[c + 8 for c in face] for face in other]
        count = self.look(*both)["defects"]["self_intersections"]
        self.assertGreater(count, 5)
        limited = self.look(*both, "--max-intersections", count - 1)["defects"]
        self.assertEqual(limited["self_intersections"], count - 1)
        self.assertFalse(limited["self_intersections_complete"])
        none = self.look(*both, "--max-intersections", 0)
        self.assertIsNone(none["defects"]["self_intersections"])
        self.assertEqual(none["verdict"], "watertight")
        self.assertNotIn("crossings", self.succeed("info", "a.off", "--max-intersections", 0).out)
        self.refuse(2, "info", "a.off", "--max-intersections", "-1", says="--max-intersections")


class Compare(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("box.mesh", medit(*lattice(2)))
        half = [(x / 2, y, z) for x, y, z in lattice(2)[0]]
        self.write("half.mesh", medit(half, lattice(2)[1]))
        for name in ("box", "half"):
            self.succeed("voxelize", name + ".mesh", "-o", name + ".vdb", "--voxel-size", "0.125")

    def test_same(self):
        report = self.report_of("compare", "box.vdb", "box.vdb")
        self.assertTrue(report["compare"]["same"])
        self.assertEqual(report["compare"]["grids"][0]["iou"], 1)
        self.assertIn("same", self.succeed("compare", "box.vdb", "box.vdb").out)

    def test_different(self):
        report = self.report_of("compare", "box.vdb", "half.vdb", status=8)
        self.assertEqual(report["status"], 8)
        [grid] = report["compare"]["grids"]
        self.assertAlmostEqual(grid["iou"], 0.5)
        self.assertEqual(grid["state_differs"], 256)
        self.assertEqual(grid["largest_difference"], 1)
        quiet = self.succeed("compare", "box.vdb", "half.vdb", "-q", status=8)
        self.assertEqual((quiet.out, quiet.err), ("", ""))

    def test_tolerance(self):
        self.succeed("compare", "box.vdb", "half.vdb", "--tolerance", 0.5, status=8)
        self.succeed("compare", "box.vdb", "half.vdb", "--tolerance", 1)
        self.refuse(2, "compare", "box.vdb", "half.vdb", "--tolerance", -1, says="--tolerance")

    def test_other_grids_and_transforms(self):
        self.succeed("voxelize", "box.mesh", "-o", "mask.vdb", "--voxel-size", "0.125", "--grid",
                     "mask")
        report = self.report_of("compare", "box.vdb", "mask.vdb", status=8)
        self.assertEqual(report["compare"]["only_a"], ["density"])
        self.assertEqual(report["compare"]["only_b"], ["mask"])
        self.succeed("voxelize", "box.mesh", "-o", "fine.vdb", "--voxel-size", "0.0625")
        report = self.report_of("compare", "box.vdb", "fine.vdb", status=8)
        self.assertFalse(report["compare"]["same_transform"])


if __name__ == "__main__":
    unittest.main(verbosity=2)
