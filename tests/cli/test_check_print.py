# SPDX-License-Identifier: Apache-2.0
"""`tetvdb check --target sla|lpbf|fdm`: findings against scipy on the very images that `tetvdb slice`
writes, on made models and, where TETVDB_CORPUS names the corpus, on models of the wild."""

import importlib.util
import math
import os
import pathlib
import unittest

import layer_readers as readers
import program
from program import SCALE, ball, box_faces, inverted, joined, off
from test_pictures import is_blue, is_red
from test_render import read_png

SCIPY = importlib.util.find_spec("scipy") is not None
if SCIPY:
    import numpy as np
    from scipy import ndimage

PRINTER = ["--pixels", "160,120", "--display", "16,12", "--layer-height", "0.1"]
PIXEL = 0.1  # mm, and the layers' height
ALL = ["--min-area", 0, "--min-volume", 0]
# Neighbours of the solid: eight in a layer, and the pixels below and above. The void's: four.
SOLID = [[[0, 0, 0], [0, 1, 0], [0, 0, 0]], [[1, 1, 1]] * 3, [[0, 0, 0], [0, 1, 0], [0, 0, 0]]]

# A hollow ball on legs, a beam that hangs from a post, a block that floats, an open cup.
MODEL = joined(
    ball(12, 2.0, (-4.2, 0.1, 3.0)), inverted(ball(8, 1.2, (-4.1, 0.2, 3.0))),
    box_faces((-4.6, -0.4, 0.0), (-3.8, 0.6, 1.3)),
    box_faces((0.0, -3.0, 0.0), (0.8, 3.0, 5.0)), box_faces((0.7, -0.5, 4.0), (3.4, 0.5, 4.6)),
    box_faces((2.8, -0.5, 2.1), (3.4, 0.5, 4.1)),
    box_faces((4.5, -2.0, 3.0), (5.5, -1.0, 4.0)),
    box_faces((4.0, 1.0, 0.0), (7.0, 4.0, 0.5)), box_faces((4.0, 1.0, 0.4), (4.4, 4.0, 2.0)),
    box_faces((6.6, 1.0, 0.4), (7.0, 4.0, 2.0)), box_faces((4.2, 1.0, 0.4), (6.8, 1.4, 2.0)),
    box_faces((4.2, 3.6, 0.4), (6.8, 4.0, 2.0)))


class CheckPrintTest(program.CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("part.off", off(*MODEL))

    def check(self, *options, model="part.off", target="sla", status=8, printer=PRINTER):
        return self.report_of("check", model, "--target", target, *printer, *options, status=status)

    def found(self, code, *options, **more):
        report = self.check(*options, **more)
        return [f for f in report["findings"] if f["code"] == code]

    def stack(self, *options, model="part.off", printer=PRINTER):
        """Which pixels `tetvdb slice` makes half white and more."""
        self.succeed("slice", model, "-o", "layers", *printer, "--aa", "area", *options)
        layers, _ = readers.png_folder(self.path("layers"))
        return np.stack([np.frombuffer(b"".join(layer), np.uint8).reshape(len(layer), -1)
                         for layer in layers]) >= 128

    # --- against scipy ---

    def islands_by_scipy(self, stack):
        islands = []
        for k in range(1, len(stack)):
            labels, count = ndimage.label(stack[k], np.ones((3, 3)))
            held = set(np.unique(labels[stack[k - 1]]))
            for i, box in enumerate(ndimage.find_objects(labels), 1):
                if i not in held:
                    islands.append((k, int((labels[box] == i).sum()), box[1].start, box[0].start,
                                    box[1].stop - 1, box[0].stop - 1))
        return sorted(islands)

    def judge_islands(self, stack, findings):
        self.assertEqual(sorted((f["layer"], f["pixels"], *f["box_px"]["min"], *f["box_px"]["max"])
                                for f in findings), self.islands_by_scipy(stack))
        bodies, _ = ndimage.label(stack, SOLID)
        standing = set(np.unique(bodies[0])) - {0}
        for f in findings:
            x, y = (math.floor(c) for c in f["pixel"])
            self.assertTrue(stack[f["layer"], y, x])
            self.assertEqual(f["joins_layer"] is not None, bodies[f["layer"], y, x] in standing)
            if f["joins_layer"] is not None:  # with the layers up to that one, and not below it
                for top, joined_ in ((f["joins_layer"], True), (f["joins_layer"] - 1, False)):
                    some, _ = ndimage.label(stack[:top + 1], SOLID)
                    self.assertEqual(some[f["layer"], y, x] in set(some[0][stack[0]]), joined_)

    def judge_traps(self, stack, report, layer_volume):
        void = np.pad(~stack, ((0, 1), (1, 1), (1, 1)), constant_values=True)
        labels, count = ndimage.label(void)
        sizes = np.bincount(labels.ravel(), minlength=count + 1)
        outside, plate = labels[-1, 0, 0], set(np.unique(labels[0]))
        traps = sorted(int(sizes[i]) for i in range(1, count + 1) if i != outside and i not in plate)
        standing = sorted(int(sizes[i]) for i in range(1, count + 1)
                          if i != outside and i in plate)
        volumes = lambda some: sorted(round(f["volume_mm3"] / layer_volume) for f in some)
        self.assertEqual(volumes(f for f in report["findings"] if f["code"] == "trap"), traps)
        cups = [f for f in report["findings"] if f["code"] == "cup"]
        self.assertEqual(volumes(f for f in cups if f["on_plate"]), standing)
        # A cup is void of the layers up to each of its own that nothing connects with the outside.
        for f in cups:
            x, y = (math.floor(c) for c in f["pixel"])
            for top, closed in ((f["last_layer"], True), (f["last_layer"] + 1, f["on_plate"])):
                some = np.pad(~stack[:top + 1], ((0, 0), (1, 1), (1, 1)), constant_values=True)
                if top == len(stack):
                    some = np.concatenate([some, np.ones_like(some[:1])])
                some, _ = ndimage.label(some)
                self.assertEqual(some[f["layer"], y + 1, x + 1] != some[0, 0, 0], closed)
        return len(traps) + len(cups)

    @unittest.skipUnless(SCIPY, "needs scipy")
    def test_islands_are_those_of_scipy(self):
        findings = self.found("island", "--checks", "islands", *ALL)
        self.assertEqual(len(findings), 2)  # the ball stands on a leg
        self.judge_islands(self.stack(), findings)

    @unittest.skipUnless(SCIPY, "needs scipy")
    def test_traps_and_cups_are_those_of_scipy(self):
        report = self.check("--checks", "traps,cups", *ALL)
        self.assertEqual(self.judge_traps(self.stack(), report, PIXEL ** 3), 2)

    @unittest.skipUnless(SCIPY, "needs scipy")
    def test_thin_walls_and_gaps_are_those_of_distance_transforms(self):
        # Plates of 0.1 to 1.2 mm and slots as wide, turned so that nothing is on pixels.
        boxes, x = [], -6.0
        sine, cosine = math.sin(0.3), math.cos(0.3)
        turn = lambda p: (p[0] * cosine - p[1] * sine, p[0] * sine + p[1] * cosine, p[2])
        for width in (0.12, 0.25, 0.38, 0.52, 0.66, 0.8, 1.2, 1.5):
            points, faces = box_faces((x, -2.0, 0.0), (x + width, 2.0, 2.0))
            boxes.append(([turn(p) for p in points], faces))
            x += width + 0.1 + width
        self.write("plates.off", off(*joined(*boxes)))
        report = self.check("--checks", "walls,gaps", "--min-wall", 0.75, "--min-gap", 0.55,
                            "--min-area", 0, model="plates.off")
        stack = self.stack(model="plates.off")
        self.assertTrue((stack == stack[0]).all())
        solid = np.pad(stack[0], 30)
        for code, region, limit in (("thin-wall", solid, 0.75), ("thin-gap", ~solid, 0.55)):
            core = ndimage.distance_transform_edt(region, PIXEL) >= limit / 2 - 1e-9
            thin = region & (ndimage.distance_transform_edt(~core, PIXEL) > limit + 1e-9)
            found = [f for f in report["findings"] if f["code"] == code]
            self.assertGreater(thin.sum(), 100)
            self.assertEqual(sum(f["pixels"] for f in found), thin.sum())
            for f in found:
                x, y = (math.floor(c) + 30 for c in f["pixel"])
                self.assertTrue(thin[y, x])
                self.assertEqual((f["first_layer"], f["last_layer"]), (0, 19))
                self.assertLess(f["width_mm"], limit)

    @unittest.skipUnless(SCIPY, "needs scipy")
    def test_overhangs_are_far_from_the_layer_below(self):
        for angle in (30, 60, 75):
            report = self.check("--checks", "overhangs", "--overhang-angle", angle, "--min-area", 0)
            reach = PIXEL * math.tan(math.radians(angle)) + PIXEL * math.sqrt(0.5)
            stack, pixels = self.stack(), 0
            for k in range(1, len(stack)):
                labels, _ = ndimage.label(stack[k], np.ones((3, 3)))
                held = np.isin(labels, np.unique(labels[stack[k - 1]])) & stack[k]
                far = ndimage.distance_transform_edt(~stack[k - 1], PIXEL) > reach
                pixels += int((held & far).sum())
            self.assertGreater(pixels, 0)
            self.assertAlmostEqual(sum(f["total_area_mm2"] for f in report["findings"]),
                                   pixels * PIXEL ** 2, 6)

    @unittest.skipUnless(SCIPY and "TETVDB_CORPUS" in os.environ, "needs scipy and the corpus")
    def test_models_of_the_wild(self):
        names = ("Fisher__1247-nozzle-duct.STL", "Slic3r__spikey_top.stl", "geogram.data__armabunny.obj",
                 "cgal__turbine.off", "cgal__pig.stl", "PrusaSlicer__two_hollow_squares.obj",
                 "franka_ros__link0.stl", "geogram.data__violin.obj")
        for name in names if SCALE > 1 else names[:4]:
            model = pathlib.Path(os.environ["TETVDB_CORPUS"]) / "tri" / name
            box = self.report_of("info", model)["input"][0]["box"]
            sides = [b - a for a, b in zip(box["min"], box["max"])]
            printer = ["--pixels", "240,200", "--display", "24,20", "--layer-height", "0.13",
                       "--scale", 18 / max(sides)]
            with self.subTest(name):
                report = self.run_program("check", model, "--target", "sla", *printer, "--checks",
                                          "islands,traps,cups", *ALL, "--json", "-")
                self.assertIn(report.status, (0, 8), report.err)
                report = report.report()
                stack = self.stack(model=model, printer=printer)
                self.judge_islands(stack, [f for f in report["findings"] if f["code"] == "island"])
                self.judge_traps(stack, report, PIXEL * PIXEL * 0.13)

    # --- places ---

    def test_places_in_the_model_and_on_the_plate(self):
        block, = [f for f in self.found("island") if f["joins_layer"] is None]
        for value, low, high in zip(block["model"], (4.5, -2.0, 3.0), (5.5, -1.0, 4.0)):
            self.assertTrue(low < value < high, block["model"])
        for axis, (low, high) in enumerate(((4.5, 5.5), (-2.0, -1.0), (3.0, 4.0))):
            self.assertAlmostEqual(block["model_box"]["min"][axis], low, delta=PIXEL)
            self.assertAlmostEqual(block["model_box"]["max"][axis], high, delta=PIXEL)
        moved, = [f for f in self.found("island", "--place", "7.5,5.5")
                  if f["joins_layer"] is None]
        self.assertAlmostEqual(moved["plate_mm"][0], block["plate_mm"][0] - 0.5, 6)
        self.assertAlmostEqual(moved["model"][0], block["model"][0], 6)

    @unittest.skipUnless(SCIPY, "needs scipy")
    def test_pixels_are_those_of_the_images(self):
        for turn in (["--orientation", "portrait"], ["--mirror", "x"],
                     ["--orientation", "portrait", "--mirror", "xy"]):
            findings = self.found("island", "--checks", "islands", *ALL, *turn)
            self.assertEqual(len(findings), 2)
            self.judge_islands(self.stack(*turn), findings)
            self.assertTrue(all(4.5 < f["model"][0] < 5.5 for f in findings
                                if f["joins_layer"] is None))

    def test_outside_of_the_printer(self):
        report = self.check("--scale", 2, "--max-height", 9)
        first = report["findings"][0]
        self.assertEqual(first["code"], "outside")
        for axis, beyond in ((0, (2 * (7.0 + 6.2) - 16) / 2), (1, (2 * (4.0 + 3.0) - 12) / 2)):
            for side in (0, 1):
                self.assertAlmostEqual(first["beyond_mm"][axis][side], beyond, 2)
        self.assertAlmostEqual(first["beyond_mm"][2][1], 1.0, 6)
        # The rest is looked at all the same, in the printer's own coordinates.
        block, = [f for f in report["findings"]
                  if f["code"] == "island" and f["joins_layer"] is None]
        self.assertTrue(4.5 < block["model"][0] < 5.5)
        self.assertAlmostEqual(block["plate_mm"][0] - 8, 2 * (block["model"][0] - 0.4), 1)
        self.assertAlmostEqual(block["pixel"][0], block["plate_mm"][0] / PIXEL, 6)
        text = self.succeed("check", "part.off", "--target", "sla", *PRINTER, "--place", "2,6",
                            status=8).out
        self.assertIn("beyond x = 0", text)

    # --- the command ---

    def test_a_block_has_nothing(self):
        self.write("block.off", off(*box_faces((0, 0, 0), (6, 5, 4))))
        for target in ("sla", "lpbf", "fdm"):
            out = self.succeed("check", "block.off", "--target", target).out
            self.assertIn("nothing found", out)
            self.assertIn("no printer is named", out)

    def test_cones_by_their_angle(self):
        around, low, high = 200, 3.0, 5.0
        for target, limit in (("sla", 60), ("lpbf", 45), ("fdm", 45)):
            for angle, expected in ((limit, 0), (limit + 8, 1)):
                wide = low + high * math.tan(math.radians(angle))
                points = [(0, 0, 0), (0, 0, high)]
                for radius, z in ((low, 0), (wide, high)):
                    points += [(radius * math.cos(2 * math.pi * i / around),
                                radius * math.sin(2 * math.pi * i / around), z)
                               for i in range(around)]
                faces = []
                for i in range(around):
                    a, b = 2 + i, 2 + (i + 1) % around
                    faces += [(0, b, a), (1, a + around, b + around), (a, b, b + around),
                              (a, b + around, a + around)]
                self.write("cone.off", off(points, faces))
                found = self.found("overhang", "--checks", "overhangs", "--min-area", 0,
                                   model="cone.off", target=target, printer=[],
                                   status=8 if expected else 0)
                self.assertEqual(len(found), expected, (target, angle))

    def test_the_bed_of_a_filament_printer(self):
        self.write("block.off", off(*box_faces((0, 0, 0), (60, 50, 40))))
        config = "bed_shape = -25x-35,35x-35,35x35,-25x35\nmax_print_height = 45\n" \
                 "layer_height = 0.2\nfirst_layer_height = 150%\nnozzle_diameter = 0.4\n"
        self.write("bed.ini", config)
        known = ["--printer", "bed.ini"]
        report = self.check(model="block.off", target="fdm", printer=known, status=0)["print"]
        self.assertTrue(report["plate_known"])
        self.assertEqual(report["pixels"], [1200, 1400])
        self.assertAlmostEqual(report["first_layer_height_mm"], 0.3)
        found = self.found("outside", "--scale", 1.2, model="block.off", target="fdm",
                           printer=known)
        self.assertAlmostEqual(found[0]["beyond_mm"][0][1], 6, 6)
        self.assertAlmostEqual(found[0]["beyond_mm"][2][1], 3, 6)
        for bad in ("0x0,1", "0x0,1x", "0x0", "nan", "0x0,9x0;9x9", ""):
            self.write("bed.ini", "bed_shape = %s\n" % bad)
            self.refuse(3, "check", "block.off", "--target", "fdm", *known, says="bed_shape")

    def test_a_model_in_metres(self):
        self.write("block.off", off(*box_faces((0, 0, 0), (0.06, 0.05, 0.04))))
        small = self.succeed("check", "block.off", "--target", "fdm", status=8)  # no layer has any
        self.assertIn("0.06 mm long", small.err)
        self.assertIn("--units", small.err)
        right = self.succeed("check", "block.off", "--target", "fdm", "--units", "m")
        self.assertEqual(right.err, "")
        self.assertIn("200 layers", right.out)

    def test_targets_and_chosen_checks(self):
        codes = lambda *a, **k: {f["code"] for f in self.check(*a, **k)["findings"]}
        self.assertLessEqual({"island", "trap", "cup", "overhang"}, codes())
        self.assertEqual(codes("--checks", "traps"), {"trap"})
        lpbf = codes(target="lpbf")
        self.assertIn("trap", lpbf)
        self.assertNotIn("cup", lpbf)
        self.assertTrue({"trap", "cup", "drain"}.isdisjoint(codes(target="fdm")))
        report = self.check("--checks", "traps", "--min-volume", 100, status=0)
        self.assertEqual(report["print"]["left_out"], {"trap": 1})

    def test_a_thin_floor(self):
        self.write("shelf.off", off(*joined(box_faces((0, 0, 0), (2, 6, 6)),
                                            box_faces((1.9, 0, 3.02), (9, 6, 3.34)))))
        floor, = self.found("thin-floor", "--checks", "floors", model="shelf.off", printer=[])
        self.assertEqual((floor["first_layer"], floor["last_layer"]), (60, 66))
        self.assertAlmostEqual(floor["area_mm2"], (9 - 3) * 6, delta=0.2)  # but for 1 mm
        self.assertIn("less than 0.5 mm", floor["text"])
        self.check("--checks", "floors", "--min-floor", 0.3, model="shelf.off", printer=[],
                   status=0)

    def test_a_narrow_drain(self):
        tank = joined(box_faces((0, 0, 0), (8, 8, 8)), inverted(box_faces((1, 1, 1), (7, 7, 7))))
        self.write("tank.off", off(*tank))
        self.write("plug.off", off(*box_faces((3.5, 3.5, -1), (4.5, 4.5, 2))))
        codes = lambda *a: [f["code"] for f in self.check(*a, model="tank.off", printer=[])
                            ["findings"]]
        self.assertEqual(codes("--checks", "traps,drains"), ["trap"])
        # The same with a hole of 1 mm in its bottom.
        frame = [box_faces((0, 0, 1), (1, 8, 8)), box_faces((7, 0, 1), (8, 8, 8)),
                 box_faces((1, 0, 1), (7, 1, 8)), box_faces((1, 7, 1), (7, 8, 8)),
                 box_faces((1, 1, 7), (7, 7, 8)),
                 box_faces((0, 0, 0), (3.5, 8, 1)), box_faces((4.5, 0, 0), (8, 8, 1)),
                 box_faces((3.5, 0, 0), (4.5, 3.5, 1)), box_faces((3.5, 4.5, 0), (4.5, 8, 1))]
        self.write("tank.off", off(*joined(*frame)))
        self.assertEqual(codes("--checks", "traps,drains"), ["drain"])
        report = self.check("--checks", "traps,drains", "--drain", 0.7, model="tank.off",
                            printer=[], status=0)
        self.assertEqual(report["findings"], [])

    def test_a_picture(self):
        result = self.succeed("check", "part.off", "--target", "sla", *PRINTER, "--picture",
                              "found.png", status=8)
        self.assertIn("island: ", result.out)
        width, height, rows = read_png(self.path("found.png"))
        self.assertEqual((width, height), (1520, 760))
        for half in (slice(0, 760), slice(760, 1520)):  # from above, and from below
            colors = {p for row in rows[:700] for p in row[half]}
            self.assertTrue(any(map(is_blue, colors)))  # around the cup
            self.assertTrue(any(map(is_red, colors)))  # around the islands
        self.refuse(2, "check", "part.off", "--target", "sla", "--picture", "found.jpg", says=".png")

    def test_threads_do_not_matter(self):
        one, two = (self.check("--threads", n)["findings"] for n in (1, 2))
        self.assertEqual(one, two)

    def test_voxels_that_are_the_printers(self):
        self.succeed("voxelize", "part.off", "-o", "part.vdb", "--grid", "mask", "--voxel-size",
                     PIXEL)
        report = self.check("--checks", "islands", *ALL, model="part.vdb")
        self.assertEqual(len(report["findings"]), 2)
        block, = [f for f in report["findings"] if f["joins_layer"] is None]
        for value, low, high in zip(block["model"], (4.5, -2.0, 3.0), (5.5, -1.0, 4.0)):
            self.assertTrue(low - PIXEL < value < high + PIXEL, block["model"])

    def test_bad_arguments(self):
        self.refuse(2, "check", "part.off", "--target", "sla", "--checks", "island",
                    says="is no check")
        self.refuse(2, "check", "part.off", "--target", "sla", "--overhang-angle", 90,
                    says="--overhang-angle")
        self.refuse(2, "check", "part.off", "--target", "sla", "--min-wall", -1, says="--min-wall")
        for option, value in (("--drain", 1e9), ("--min-wall", 1e9), ("--min-floor", 1e9),
                              ("--min-gap", 1e9), ("--overhang-angle", 89.9999)):
            self.refuse(2, "check", "part.off", "--target", "sla", option, value, says=option)
        self.refuse(2, "check", "part.off", "--target", "sla", "--place", "keep", says="plate")
        self.refuse(2, "check", "part.off", "--target", "sla", "--pixels", "100,100",
                    says="display")
        self.refuse(2, "check", "part.off", "--target", "blender", "--drain", 2, says="--drain")
        self.refuse(3, "check", "none.stl", "--target", "fdm", says="none.stl")


if __name__ == "__main__":
    unittest.main()
