# SPDX-License-Identifier: Apache-2.0
"""Arrays of meshes into grids, by the program."""

import math
import unittest

import program
from program import lattice, vtu


def array(name, rows, kind="Float64"):
    rows = [row if isinstance(row, (tuple, list)) else (row,) for row in rows]
    numbers = " ".join(str(v) for row in rows for v in row)
    return (f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{len(rows[0])}" '
            f'format="ascii">{numbers}</DataArray>')


def vtu_with(points, tets, point_arrays=(), cell_arrays=()):
    data = (f"<PointData>{''.join(array(*a) for a in point_arrays)}</PointData>"
            f"<CellData>{''.join(array(*a) for a in cell_arrays)}</CellData>")
    return vtu(points, tets).replace("</Piece>", data + "</Piece>")


def simulation(scale=1.0, offset=0.0, side=1.0):
    """A block with temperature 300..301, velocity, stress and cell numbers."""
    points, tets = lattice(2, side=side)
    return vtu_with(
        points, tets,
        [("temperature", [300 + offset + scale * p[0] for p in points]),
         ("vel", [(p[1], -p[0], 0.5) for p in points]),
         ("disp", [(1.0, 0.0, 0.0)] * len(points))],
        [("stress", [(i, 0, 0, 0, 0, 0) for i in range(len(tets))]),
         ("part", [i % 3 for i in range(len(tets))], "Int32")])


class FieldsTest(program.CommandLineTest):
    def grids(self, *arguments, status=0):
        report = self.report_of("voxelize", *arguments, status=status)
        return {grid["name"]: grid for grid in report["grids"]}, report

    def test_arrays_by_name_beside_density(self):
        self.write("a.vtu", simulation())
        grids, _ = self.grids("a.vtu", "-o", "a.vdb", "--resolution", 16, "--grid",
                              "density,temperature,vel,part", "--derive",
                              "mises=stress:mises,speed=vel:magnitude")
        self.assertEqual(list(grids), ["density", "temperature", "vel", "part", "mises", "speed"])
        self.assertEqual([g["type"] for g in grids.values()],
                         ["float", "float", "vec3s", "int32", "float", "float"])
        self.assertEqual({g["active_voxels"] for g in grids.values()}, {16 ** 3})
        self.assertAlmostEqual(grids["temperature"]["min"], 300, 4)
        self.assertAlmostEqual(grids["temperature"]["max"], 300 + 15 / 16, 4)
        self.assertAlmostEqual(grids["mises"]["max"], 47, 4)
        self.assertAlmostEqual(grids["speed"]["max"], math.sqrt(2 * (15 / 16) ** 2 + 0.25), 5)
        self.assertEqual(self.hash_of("a.vdb"), self.hash_of("a.vdb"))

    def test_parts_by_name(self):
        self.write("a.vtu", simulation())
        grids, _ = self.grids("a.vtu", "-o", "a.vdb", "--resolution", 16, "--grid",
                              "stress.xx,stress:mises,vel.y,cells:stress:trace,vel:magnitude")
        self.assertEqual(list(grids), ["stress.xx", "stress.mises", "vel.y", "stress.trace",
                                       "vel.magnitude"])
        derived, _ = self.grids("a.vtu", "-o", "b.vdb", "--resolution", 16, "--grid", "", "--derive",
                                "stress.xx=stress:xx,stress.mises=stress:mises,vel.y=vel:y,"
                                "stress.trace=stress:trace,vel.magnitude=vel:magnitude")
        self.assertEqual(self.hash_of("a.vdb"), self.hash_of("b.vdb"))
        self.assertEqual((grids["stress.xx"]["max"], grids["stress.mises"]["max"]), (47, 47))
        self.refuse(2, "voxelize", "a.vtu", "-o", "no.vdb", "--grid", "stress.up",
                    says=("up", "stress", "mises"))
        self.refuse(2, "voxelize", "a.vtu", "-o", "no.vdb", "--grid", "heat.x",
                    says=("heat.x", "stress"))
        # An array of that very name comes first.
        points, tets = lattice(1)
        self.write("b.vtu", vtu_with(points, tets, [("u.x", [5.0] * 8),
                                                    ("u", [(1.0, 2.0, 3.0)] * 8)]))
        grids, _ = self.grids("b.vtu", "-o", "b.vdb", "--resolution", 4, "--grid", "u.x,u.y")
        self.assertEqual((grids["u.x"]["max"], grids["u.y"]["max"]), (5, 2))

    def test_render_takes_the_same_names(self):
        self.write("a.vtu", simulation())
        for name, title, low, high in (("temperature", "temperature", 300, 301),
                                       ("stress:mises", "stress:mises", 0, 47),
                                       ("stress.xx", "stress.xx", 0, 47),
                                       ("cells:part", "cells:part", 0, 2),
                                       ("vel", "|vel|", 0.5, 1.5), ("stress", "|stress|", 0, 47)):
            colors = self.report_of("render", "a.vtu", "-o", "a.png", "--color", name,
                                    "--size", "320x240")["picture"]["colors"]
            self.assertEqual(colors["title"], title)
            self.assertAlmostEqual(colors["low"], low, 5)
            self.assertAlmostEqual(colors["high"], high, 5)
        self.refuse(2, "render", "a.vtu", "-o", "no.png", "--color", "stress:up",
                    says=("up", "stress"))
        self.succeed("voxelize", "a.vtu", "-o", "a.vdb", "--resolution", 8, "--grid",
                     "density,stress:mises")
        colors = self.report_of("render", "a.vdb", "-o", "a.png", "--color", "stress:mises",
                                "--size", "320x240")["picture"]["colors"]
        self.assertEqual((colors["title"], colors["high"]), ("stress.mises", 47))

    def test_preview_shows_the_arrays(self):
        self.write("a.vtu", simulation())
        preview = self.report_of("voxelize", "a.vtu", "-o", "a.vdb", "--resolution", 8, "--grid",
                                 "density,temperature,stress:mises", "--preview",
                                 "a.png")["preview"]
        self.assertEqual(preview["panels"], ["tets", "volume", "slice", "temperature",
                                             "stress.mises"])
        report = self.report_of("voxelize", "a.vtu", "-o", "a.vdb", "--resolution", 8, "--grid",
                                "all", "--preview", "a.png")
        # Nine grids: the first is the volume that is drawn.
        self.assertEqual(len(report["preview"]["panels"]), 3 + 6)
        self.assertIn("preview-arrays", [w["code"] for w in report["warnings"]])

    def test_all_arrays_and_nothing_else(self):
        self.write("a.vtu", simulation())
        grids, _ = self.grids("a.vtu", "-o", "a.vdb", "--resolution", 8, "--grid", "all")
        self.assertEqual(list(grids), ["temperature", "vel", "disp"]
                         + ["stress." + c for c in ("xx", "yy", "zz", "xy", "yz", "xz")] + ["part"])

    def test_nvdb_too(self):
        self.write("a.vtu", simulation())
        for name in ("a.vdb", "a.nvdb"):
            self.succeed("voxelize", "a.vtu", "-o", name, "--resolution", 16, "--grid",
                         "temperature,vel,part")
        self.succeed("compare", "a.vdb", "a.nvdb")

    def test_same_bits_for_any_number_of_threads(self):
        self.write("a.vtu", simulation())
        for n in (1, 2, 5):
            self.succeed("voxelize", "a.vtu", "-o", f"{n}.vdb", "--resolution", 40, "--grid",
                         "all", "--threads", n)
        self.assertEqual(len({self.hash_of(f"{n}.vdb") for n in (1, 2, 5)}), 1)

    def test_values_that_would_not_show_are_warned_of(self):
        self.write("a.vtu", simulation(scale=2e5))
        grids, report = self.grids("a.vtu", "-o", "a.vdb", "--grid", "temperature",
                                   "--resolution", 8)
        self.assertGreater(grids["temperature"]["max"], 1e5)
        self.assertEqual([w["code"] for w in report["warnings"]], ["hidden-values"])
        self.assertIn("--remap temperature=0:1", report["warnings"][0]["text"])
        grids, report = self.grids("a.vtu", "-o", "a.vdb", "--grid", "temperature",
                                   "--resolution", 8, "--remap", "0:1")
        self.assertLessEqual(grids["temperature"]["max"], 1)
        self.assertEqual(report["warnings"], [])
        metadata = self.report_of("info", "a.vdb")["input"][0]["grids"][0]["metadata"]
        self.assertEqual(float(metadata["original_min"]), 300)
        self.assertEqual(metadata["source_array"], "temperature")

    def test_halves_that_do_not_hold_the_values(self):
        self.write("a.vtu", simulation(scale=2e5))
        self.refuse(3, "voxelize", "a.vtu", "-o", "a.vdb", "--grid", "temperature", "--half",
                    says=("65504", "--remap temperature=0:1"))
        for name, half in (("a.vdb", ["--half"]), ("b.vdb", [])):
            self.succeed("voxelize", "a.vtu", "-o", name, "--grid", "temperature,vel", "--remap",
                         "0:1", "--resolution", 19, *half)
        self.succeed("compare", "a.vdb", "b.vdb", "--tolerance", "1e-3")
        self.succeed("compare", "a.vdb", "b.vdb", status=8)

    def test_warp_moves_the_voxels(self):
        self.write("a.vtu", simulation())
        for name, options in (("still", ()), ("moved", ("--warp", "disp*0.5"))):
            self.succeed("voxelize", "a.vtu", "-o", name + ".vdb", "--voxel-size", 0.125, *options)
        boxes = [self.report_of("info", n + ".vdb")["input"][0]["grids"][0]["box"]["min"]
                 for n in ("still", "moved")]
        self.assertEqual([b - a for a, b in zip(*boxes)], [4, 0, 0])

    def test_smooth_interpolates_what_is_over_cells(self):
        self.write("a.vtu", simulation())
        job = ("a.vtu", "-o", "a.vdb", "--derive", "s=stress:xx", "--grid", "temperature", "--resolution", 40)
        of_cells, _ = self.grids(*job)
        smooth, _ = self.grids(*job, "--smooth")
        self.assertEqual((of_cells["s"]["min"], of_cells["s"]["max"]), (0, 47))
        # Between the least and the largest mean: corners of the block are in one cell or more.
        self.assertGreater(smooth["s"]["min"], 0)
        self.assertLess(smooth["s"]["max"], 47)
        for key in ("min", "max", "active_voxels"):
            self.assertEqual(of_cells["temperature"][key], smooth["temperature"][key])

    def test_bad_requests(self):
        self.write("a.vtu", simulation())
        ask = lambda *options, status=2, says: self.refuse(
            status, "voxelize", "a.vtu", "-o", "a.vdb", *options, says=says)
        ask("--grid", "pressure", says=("no array 'pressure'", "'temperature' (points)",
                                        "'stress' (cells, 6 components)"))
        ask("--grid", "vel,vel", says="twice")
        ask("--derive", "vel", says="NAME=ARRAY:PART")
        ask("--grid", "temperature,nope", says=("no array 'nope'", "'temperature' (points)",
                                                "'stress' (cells, 6 components)"))
        ask("--derive", "a=vel:mises", says=("vel", "3 components"))
        ask("--derive", "a=vel:foo", says=("foo", "magnitude"))
        ask("--derive", "a=vel:x,a=vel:y", says="two grids would be named 'a'")
        ask("--grid", "vel", "--remap", "1", says="0:1")
        ask("--grid", "vel", "--remap", "nope=0:1", says="'nope'")
        ask("--remap", "0:1", says="none is asked for")
        ask("--grid", "vel", "--clamp", "2:1", says="lower number first")
        ask("--grid", "vel", "--background", "x", says="finite number")
        ask("--warp", "stress", says="vector for every point")
        ask("--warp", "nope", says="no array 'nope'")
        ask("--warp", "disp*", says="factor")

    def test_triangles_have_no_arrays(self):
        points, faces = program.box_faces()
        self.write("a.off", program.off(points, faces))
        self.refuse(2, "voxelize", "a.off", "-o", "a.vdb", "--grid", "temperature",
                    says="array of a solid mesh")
        self.refuse(2, "voxelize", "a.off", "-o", "a.vdb", "--warp", "disp", says="solid mesh")
        self.refuse(2, "voxelize", "a.off", "-o", "a.vdb", "--smooth", says="arrays over cells")

    def test_values_that_are_not_finite(self):
        points, tets = lattice(2)
        values = ["nan" if i == 0 else "1" for i in range(len(points))]
        self.write("a.vtu", vtu_with(points, tets, [("T", values)]))
        grids, report = self.grids("a.vtu", "-o", "a.vdb", "--resolution", 16, "--grid",
                                   "density,T")
        self.assertEqual(sorted(w["code"] for w in report["warnings"]),
                         ["not-finite", "voxels-left-out"])
        # The six tets at the corner, an eighth of the block, need its value.
        self.assertEqual(grids["density"]["active_voxels"] - grids["T"]["active_voxels"], 8 ** 3)


if __name__ == "__main__":
    unittest.main()
