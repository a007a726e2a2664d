# SPDX-License-Identifier: Apache-2.0
"""`tetvdb slice`: every container decoded by a second reader to the same pixels, grey levels
against clipping, places and turns of images, and PrusaSlicer's own layers of the same meshes where
it is installed."""

import hashlib
import importlib.util
import math
import shutil
import subprocess
import unittest

import layer_readers as readers
import program
from program import ball, box_faces, gmsh, inverted, joined, lattice, off, volume

WIDTH, HEIGHT = 80, 60
PLATE = (16.0, 12.0)
LAYER = 0.25
PRINTER = ["--pixels", "80,60", "--display", "16,12", "--layer-height", "0.25"]


# No two of its turns and mirror images are the same, it has a cavity, and nothing is on pixels.
MODEL = joined(ball(10, 1.7, (0, 0, 1.7)), inverted(ball(6, 0.8, (0.2, 0.1, 1.6))),
               box_faces((2.03, -1.9, 0.0), (6.77, -1.03, 2.11)),
               box_faces((5.2, 0.31, 0.0), (6.1, 3.4, 3.07)))


def flat(layers):
    return [b"".join(layer) for layer in layers]


class SliceTest(program.CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("part.off", off(*MODEL))

    def slice(self, output, *options, model="part.off", **more):
        return self.succeed("slice", model, "-o", output, *PRINTER, *options, **more)

    def layers(self, *options, model="part.off"):
        self.slice("reference", *options, model=model)
        layers, manifest = readers.png_folder(self.path("reference"))
        for layer in layers:
            self.assertEqual([len(row) for row in layer], [manifest["width_px"]] * len(layer))
        return layers

    # --- containers ---

    def test_every_container_has_the_same_pixels(self):
        expected = flat(self.layers())
        self.assertEqual(len(expected), 14)  # 3.4 mm
        self.assertGreater(len(set(b"".join(expected))), 100)
        self.slice("part.sl1", "--exposure", "8", "--bottom-exposure", "35")
        layers, config, printer = readers.sl1(self.path("part.sl1"))
        self.assertEqual(flat(layers), expected)
        self.assertEqual((config["expTime"], config["expTimeFirst"]), ("8", "35"))
        self.assertEqual(float(config["layerHeight"]), LAYER)
        self.assertAlmostEqual(float(config["usedMaterial"]), volume(MODEL) / 1000, 6)
        for key, value in {"layer_height": 0.25, "initial_layer_height": 0.25, "display_width": 16,
                           "display_height": 12, "display_pixels_x": 80, "display_pixels_y": 60,
                           "display_mirror_x": 0, "display_mirror_y": 0}.items():
            self.assertEqual(float(printer[key]), value, key)
        self.assertEqual(printer["display_orientation"], "landscape")
        self.slice("part.zip")
        layers, manifest = readers.uvtools_zip(self.path("part.zip"))
        self.assertEqual(flat(layers), expected)
        self.assertEqual((manifest["ResolutionX"], manifest["ResolutionY"]), ("80", "60"))
        self.assertEqual(float(manifest["LayerHeight"]), LAYER)
        self.slice("part.nanodlp")
        layers, plate, info = readers.nanodlp(self.path("part.nanodlp"))
        self.assertEqual(flat(layers), expected)
        self.assertEqual((plate["XRes"], plate["YRes"]), (80, 60))
        for layer, entry in zip(layers, info):
            lit = [(x, y) for y, row in enumerate(layer) for x, v in enumerate(row) if v]
            self.assertEqual(entry["AreaCount"], islands(lit))
            self.assertEqual((entry["MinX"], entry["MaxX"]),
                             (min(p[0] for p in lit), max(p[0] for p in lit)))
            self.assertEqual((entry["MinY"], entry["MaxY"]),
                             (min(p[1] for p in lit), max(p[1] for p in lit)))
        self.slice("part.goo", "--exposure", "2.5", "--bottom-exposure", "30", "--bottom-layers",
                   "3", "--transition-layers", "4")
        layers, header, definitions = readers.goo(self.path("part.goo"))
        self.assertEqual(flat(layers), expected)
        self.assertEqual((header["exposure"], header["bottom_exposure"]), (2.5, 30))
        self.assertAlmostEqual(header["volume"], volume(MODEL), 4)
        self.assertEqual([d["z"] for d in definitions], [LAYER * (k + 1) for k in range(14)])
        self.assertEqual([d["exposure"] for d in definitions[:9]],
                         [30, 30, 30, 24.5, 19, 13.5, 8, 2.5, 2.5])

    def test_one_bit_stacks_have_the_pixels_above_half(self):
        white = [bytes(255 if v >= 128 else 0 for v in layer) for layer in flat(self.layers())]
        self.slice("part.tif")
        layers, per_centimetre = readers.tiff(self.path("part.tif"))
        self.assertEqual(flat(layers), white)
        self.assertEqual(per_centimetre, 50)
        self.slice("bits", "--format", "bmp")
        self.assertEqual(flat(readers.bmp_folder(self.path("bits"))), white)

    def test_contours_are_the_same_in_every_format(self):
        self.slice("part.cli")
        expected, header = readers.cli(self.path("part.cli"))
        self.assertEqual([z for z, _ in expected], [LAYER * (k + 1) for k in range(len(expected))])
        self.slice("part.svg")
        for (z, contours), (top, others) in zip(readers.svg(self.path("part.svg")), expected):
            self.assertEqual(z, top)
            self.near(contours, others, 1e-12)
        self.slice("binary.cli", "--format", "cli-binary")
        layers, _ = readers.cli(self.path("binary.cli"))
        self.assertEqual(len(layers), len(expected))
        for (z, contours), (top, others) in zip(layers, expected):
            self.near(contours, others, 1e-6)
        self.slice("part.3mf")
        layers, points, faces = readers.three_mf(self.path("part.3mf"))
        self.assertEqual(len(layers), len(expected))
        for (z, contours), (top, others) in zip(layers, expected):
            self.assertEqual((z, contours), (top, others))
        self.assertAlmostEqual(volume((points, faces)), volume(MODEL), 9)

    def near(self, contours, others, by):
        self.assertEqual([len(c) for c in contours], [len(c) for c in others])
        for contour, other in zip(contours, others):
            for p, q in zip(contour, other):
                self.assertLess(max(abs(p[0] - q[0]), abs(p[1] - q[1])), by)

    # --- grey levels ---

    def test_area_is_that_of_the_contours(self):
        layers = self.layers("--aa", "area")
        self.slice("part.cli")
        lines, _ = readers.cli(self.path("part.cli"))
        self.assertEqual(len(layers), len(lines))
        for layer, (_, contours) in list(zip(layers, lines))[::3]:
            pixels = [[(x / PLATE[0] * WIDTH, HEIGHT - y / PLATE[1] * HEIGHT) for x, y in contour]
                      for contour in contours]
            image = readers.shares(pixels, WIDTH, HEIGHT)
            for y in range(HEIGHT):
                for x in range(WIDTH):
                    self.assertLess(abs(layer[y][x] - 255 * -image[y][x]), 0.5 + 1e-6)

    def test_sum_of_shares_is_the_volume(self):
        slices = self.report_of("slice", "part.off", "-o", "sum", *PRINTER)["slices"]
        self.assertLess(abs(slices["volume_mm3"] / volume(MODEL) - 1), 1e-10)
        self.assertLess(abs(slices["mesh_volume_mm3"] / volume(MODEL) - 1), 1e-12)
        layers, _ = readers.png_folder(self.path("sum"))
        pixels = b"".join(flat(layers))
        grey = 2 * sum(0 < v < 255 for v in pixels)  # as many more round to black or white
        voxel = 0.2 * 0.2 * LAYER
        self.assertLess(abs(sum(pixels) / 255 * voxel - volume(MODEL)), 0.5 / 255 * voxel * grey)

    def test_none_is_white_where_the_middle_is_solid(self):
        self.write("box.off", off(*box_faces((0, 0, 0), (4.0, 2.0, 1.0))))
        layers = self.layers("--aa", "none", "--place", "6.1,5.1", model="box.off")
        self.assertEqual(len(layers), 4)
        for layer in layers:  # its sides run through the middles of pixels
            self.assertEqual({v for row in layer for v in row}, {0, 255})
            self.assertEqual(sum(v == 255 for row in layer for v in row), 20 * 10)

    def test_levels_gamma_and_table(self):
        plain = flat(self.layers())
        self.assertEqual(flat(self.layers("--levels", "2")),
                         [bytes(255 if v >= 128 else 0 for v in layer) for layer in plain])
        nine = b"".join(flat(self.layers("--levels", "9")))
        self.assertEqual(set(nine), {round(255 * i / 8 + 1e-9) for i in range(9)})
        self.assertEqual(flat(self.layers("--gamma", "0")),
                         [bytes(255 if v >= 128 else 0 for v in layer) for layer in plain])
        self.write("table.txt", "# inverse\n" + " ".join(str(255 - i) for i in range(256)))
        self.refuse(2, "slice", "part.off", "-o", "x", *PRINTER, "--levels", "1")
        self.write("short.txt", "1 2 3")
        self.refuse(3, "slice", "part.off", "-o", "x", *PRINTER, "--lut", "short.txt")
        self.write("half.txt", ", ".join(str(i // 2) for i in range(256)))
        self.assertEqual(flat(self.layers("--lut", "half.txt")),
                         [bytes(v // 2 for v in layer) for layer in plain])

    def test_errors_are_diffused(self):
        plain = flat(self.layers())
        for layer, bits in zip(plain, flat(self.layers("--levels", "2", "--dither"))):
            self.assertEqual(set(bits), {0, 255})
            self.assertLessEqual(abs(sum(layer) - sum(bits)), 255)
        self.slice("dithered.tif", "--dither")
        layers, _ = readers.tiff(self.path("dithered.tif"))
        self.assertEqual(flat(layers), flat(self.layers("--levels", "2", "--dither")))
        self.refuse(2, "slice", "part.off", "-o", "x", *PRINTER, "--dither", "--aa", "none")

    # --- the same bytes ---

    def test_threads_change_nothing(self):
        for name in ("a.sl1", "a.goo", "a.nanodlp", "a.cli"):
            digests = set()
            for threads in (1, 2, 64):
                for aa in ("volume",):
                    self.slice(name, "--aa", aa, "--threads", threads)
                    digests.add(hashlib.sha256(self.path(name).read_bytes()).hexdigest())
            self.assertEqual(len(digests), 1, name)

    # --- places ---

    def test_images_are_turned_as_asked(self):
        upright = self.layers("--place", "7,5")[4]
        across = [bytes(row[::-1]) for row in upright]
        self.assertEqual(self.layers("--place", "7,5", "--mirror", "x")[4], across)
        self.assertEqual(self.layers("--place", "7,5", "--mirror", "y")[4], upright[::-1])
        self.assertEqual(self.layers("--place", "7,5", "--mirror", "xy")[4], across[::-1])
        turned = [bytes(column[::-1]) for column in zip(*across)]  # rows from the plate's far x
        turned = [bytes(upright[y][WIDTH - 1 - x] for y in range(HEIGHT)) for x in range(WIDTH)]
        self.assertEqual(self.layers("--place", "7,5", "--orientation", "portrait")[4], turned)
        self.assertEqual(
            self.layers("--place", "7,5", "--orientation", "portrait", "--mirror", "x")[4],
            [row[::-1] for row in turned])

    def test_what_does_not_fit_is_refused_with_the_numbers(self):
        self.refuse(4, "slice", "part.off", "-o", "x.sl1", *PRINTER, "--scale", "2",
                    says=("16.94", "16 x 12 mm"))
        self.refuse(4, "slice", "part.off", "-o", "x.sl1", *PRINTER, "--place", "2,6",
                    says=("0 to 16",))
        self.refuse(4, "slice", "part.off", "-o", "x.sl1", *PRINTER, "--max-height", "3",
                    says=("3.4 mm high",))
        self.refuse(4, "slice", "part.off", "-o", "x.sl1", *PRINTER, "--units", "in")
        self.refuse(2, "slice", "part.off", "-o", "x.sl1", "--pixels", "80,60", says="--display")
        self.refuse(2, "slice", "part.off", "-o", "x.ctb", *PRINTER, says=".sl1")
        self.refuse(2, "slice", "part.off", "-o", "x", *PRINTER, "--format", "sl2", says="sl1")

    def test_a_file_of_the_printer_is_read(self):
        self.write("printer.ini", "# a printer\ndisplay_pixels_x = 80\ndisplay_pixels_y = 60\n"
                   "display_width = 16\ndisplay_height = 12\nlayer_height = 0.25\n"
                   "display_mirror_x = 1\ngamma_correction = 1\nprinter_model = TEST\n")
        self.succeed("slice", "part.off", "-o", "a.sl1", "--printer", "printer.ini")
        layers, config, printer = readers.sl1(self.path("a.sl1"))
        self.assertEqual(config["printerModel"], "TEST")
        self.assertEqual(flat(layers), flat(self.layers("--mirror", "x")))
        self.write("bad.ini", "layer_height = thick\n")
        self.refuse(3, "slice", "part.off", "-o", "b.sl1", "--printer", "bad.ini", says="bad.ini:1")
        self.write("bundle.ini", "[printer:SL1]\nlayer_height = 1\n")
        self.refuse(3, "slice", "part.off", "-o", "b.sl1", "--printer", "bundle.ini",
                    says="sections")

    def test_first_layer_has_a_height_of_its_own(self):
        self.slice("a.goo", "--first-layer-height", "0.5")
        _, _, definitions = readers.goo(self.path("a.goo"))
        self.assertEqual([d["z"] for d in definitions[:3]], [0.5, 0.75, 1.0])

    def test_outlines_grow_and_shrink(self):
        self.write("box.off", off(*box_faces((0, 0, 0), (4.0, 2.0, 1.0))))
        volumes = {}
        for by in ("0.3", "-0.3"):
            slices = self.report_of("slice", "box.off", "-o", "out", *PRINTER, "--xy-offset",
                                    by)["slices"]
            volumes[by] = slices["volume_mm3"]
        self.assertAlmostEqual(volumes["0.3"], 8 + 2 * 0.3 * 6 + math.pi * 0.09, 2)
        self.assertAlmostEqual(volumes["-0.3"], 3.4 * 1.4, 1)
        self.refuse(2, "slice", "part.off", "-o", "x.cli", *PRINTER, "--xy-offset", "0.1",
                    says="--xy-offset")
        self.refuse(4, "slice", "part.off", "-o", "x", *PRINTER, "--xy-offset", "5")
        self.write("foot.ini", "elefant_foot_compensation = 0.2\nfaded_layers = 2\n")
        self.slice("foot", "--printer", "foot.ini", model="box.off")
        layers, _ = readers.png_folder(self.path("foot"))
        sums = [sum(map(sum, layer)) for layer in layers]
        self.assertLess(sums[0], sums[1])
        self.assertLess(sums[1], sums[2])
        self.assertEqual(sums[2], sums[3])

    def test_open_meshes_are_answered(self):
        points, faces = ball(10, 1.7, (0, 0, 0))
        self.write("bowl.off", off(points, [f for f in faces if max(points[c][2] for c in f) < 1]))
        for aa in ("volume", "area", "none"):
            slices = self.report_of("slice", "bowl.off", "-o", "bowl", *PRINTER, "--aa",
                                    aa)["slices"]
            self.assertGreater(slices["volume_mm3"], 0.7 * volume((points, faces)) * 0.8)
        self.write("sheet.off", off([(0, 0, 0), (1, 0, 0), (0, 1, 0.5)], [[0, 1, 2]]))
        self.refuse(3, "slice", "sheet.off", "-o", "x", *PRINTER)

    def test_limits(self):
        self.refuse(4, "slice", "part.off", "-o", "x.sl1", *PRINTER, "--max-memory", "60M")
        self.refuse(5, "slice", "part.off", "-o", "x", *PRINTER, "--max-time", "0.0001")
        self.refuse(7, "slice", "part.off", "-o", "nowhere/x.sl1", *PRINTER)
        self.refuse(7, "slice", "part.off", "-o", "nowhere/x", *PRINTER)
        self.refuse(2, "slice", "part.off", "-o", "part.off", *PRINTER, "--format", "sl1")

    # --- folders ---

    def test_a_folder_is_replaced_where_it_holds_layers_alone(self):
        self.slice("out")
        self.slice("out", "--aa", "area")
        self.path("out/mine.txt").write_text("keep me")
        self.refuse(2, "slice", "part.off", "-o", "out", *PRINTER, says="mine.txt")
        self.assertEqual(self.path("out/mine.txt").read_text(), "keep me")

    # --- other inputs ---

    def test_tets_are_sliced_like_their_surface(self):
        self.write("cube.msh", gmsh(*lattice(3, side=2.9)))
        self.write("cube.off", off(*box_faces((0, 0, 0), (2.9, 2.9, 2.9))))
        self.assertEqual(flat(self.layers(model="cube.msh")), flat(self.layers(model="cube.off")))

    def test_materials_are_the_palette(self):
        points, tets = lattice(2, side=4)
        low = [sum(points[c][0] for c in tet) < 8 for tet in tets]
        self.write("two.msh", gmsh(points, tets, [1 if l else 7 for l in low]))
        slices = self.report_of("slice", "two.msh", "-o", "two", *PRINTER, "--materials")["slices"]
        self.assertEqual(slices["materials"], ["1", "7"])
        layers, manifest = readers.png_folder(self.path("two"))
        image = layers[0]
        counts = {v: sum(row.count(v) for row in image) for v in (0, 1, 2)}
        self.assertEqual(counts, {0: 80 * 60 - 400, 1: 200, 2: 200})
        self.assertLess(image[30].index(1), image[30].index(2))
        self.assertEqual([m["value"] for m in manifest["materials"]], [0, 1, 2])
        _, palette = readers.png((self.path("two") / "layer00000.png").read_bytes())
        self.assertEqual(len(palette), 3)

    def test_a_volume_of_the_printers_voxels_is_taken_as_it_is(self):
        self.write("box.off", off(*box_faces((0, 0, 0), (4.0, 2.0, 1.0))))
        self.succeed("voxelize", "box.off", "-o", "box.vdb", "--voxel-size", "0.2,0.2,0.25",
                     "--origin", "0.1,0.1,0.125", "--grid", "mask")
        self.assertEqual(flat(self.layers(model="box.vdb")), flat(self.layers(model="box.off")))
        self.succeed("voxelize", "part.off", "-o", "part.vdb", "--voxel-size", "0.2,0.2,0.25",
                     "--grid", "coverage")
        report = self.report_of("slice", "part.vdb", "-o", "cover", *PRINTER)
        self.assertLess(abs(report["slices"]["volume_mm3"] / volume(MODEL) - 1), 1e-6)

    def test_a_level_set_becomes_a_surface_first(self):
        self.write("ball.off", off(*ball(24, 2, (0, 0, 0))))
        self.succeed("voxelize", "ball.off", "-o", "ball.vdb", "--voxel-size", "0.1", "--grid",
                     "surface")
        report = self.report_of("slice", "ball.vdb", "-o", "ball", *PRINTER)
        expected = volume(ball(24, 2, (0, 0, 0)))
        self.assertLess(abs(report["slices"]["volume_mm3"] / expected - 1), 0.01)

    def test_holes_are_mended_and_named(self):
        points, faces = ball(10, 1.7, (0, 0, 0))
        self.write("hole.off", off(points, faces[1:]))
        result = self.succeed("slice", "hole.off", "-o", "a.sl1", *PRINTER)
        self.assertIn("open edges", result.err)

    # --- other programs ---

    @unittest.skipUnless(importlib.util.find_spec("lib3mf"), "needs lib3mf")
    def test_slices_are_read_by_lib3mf(self):
        import lib3mf
        self.slice("part.3mf")
        model = lib3mf.get_wrapper().CreateModel()
        reader = model.QueryReader("3mf")
        reader.SetStrictModeActive(True)
        reader.ReadFromFile(str(self.path("part.3mf")))
        self.assertEqual(reader.GetWarningCount(), 0)
        expected, *_ = readers.three_mf(self.path("part.3mf"))
        stacks = model.GetSliceStacks()
        self.assertTrue(stacks.MoveNext())
        stack = stacks.GetCurrentSliceStack()
        self.assertEqual(stack.GetSliceCount(), len(expected))
        for i, (top, contours) in enumerate(expected):
            self.assertAlmostEqual(stack.GetSlice(i).GetZTop(), top, 5)
            self.assertEqual(stack.GetSlice(i).GetPolygonCount(), len(contours))
        meshes = model.GetMeshObjects()
        self.assertTrue(meshes.MoveNext())
        self.assertTrue(meshes.GetCurrentMeshObject().IsManifoldAndOriented())


    @unittest.skipUnless(shutil.which("prusa-slicer"), "needs prusa-slicer")
    def test_area_is_prusaslicers(self):
        self.compare_with_prusaslicer(
            joined(ball(30, 17, (0, 0, 17)), inverted(ball(20, 8, (2, 1, 16))),
                   box_faces((20.3, -19, 0.0), (47.7, -10.3, 21.1))), "landscape", 0, 0)

    @unittest.skipUnless(shutil.which("prusa-slicer"), "needs prusa-slicer")
    def test_turned_images_are_prusaslicers(self):
        # Corners are on PrusaSlicer's grid of 1/256 pixel.
        model = joined(box_faces((0, 0, 0), (41.25, 5.6875, 4.2)),
                       box_faces((0, 7.125, 0), (12.9375, 33.3125, 4.2)))
        self.compare_with_prusaslicer(model, "portrait", 1, 0)
        self.compare_with_prusaslicer(model, "portrait", 0, 1)
        self.compare_with_prusaslicer(model, "landscape", 0, 1)

    def compare_with_prusaslicer(self, model, orientation, mirror_x, mirror_y):
        self.write("model.stl", stl(*model))
        self.write("prusa.ini", "printer_technology = SLA\ndisplay_width = 120\n"
                   "display_height = 68\ndisplay_pixels_x = 480\ndisplay_pixels_y = 272\n"
                   f"display_orientation = {orientation}\ndisplay_mirror_x = {mirror_x}\n"
                   f"display_mirror_y = {mirror_y}\n"
                   "layer_height = 0.5\ninitial_layer_height = 0.5\nexposure_time = 8\n"
                   "initial_exposure_time = 35\nfaded_layers = 10\ngamma_correction = 1\n"
                   "max_print_height = 150\nsupports_enable = 0\npad_enable = 0\n"
                   "support_object_elevation = 0\nelefant_foot_compensation = 0\n"
                   "slice_closing_radius = 0\nbed_shape = 0x0,120x0,120x68,0x68\n"
                   "absolute_correction = 0\nthumbnails =\n")
        done = subprocess.run(
            ["prusa-slicer", "--loglevel", "1", "--load", "prusa.ini", "--center", "60,34",
             "--export-sla", "-o", "prusa.sl1", "model.stl"], cwd=self.folder,
            stdout=subprocess.PIPE, stderr=subprocess.STDOUT, timeout=300)
        self.assertEqual(done.returncode, 0, done.stdout)
        self.succeed("slice", "model.stl", "-o", "ours.sl1", "--printer", "prusa.ini", "--aa",
                     "area")
        theirs, their_config, their_keys = readers.sl1(self.path("prusa.sl1"))
        ours, config, keys = readers.sl1(self.path("ours.sl1"))
        self.assertEqual(set(their_config) - set(config), set())
        for key in ("display_width", "display_pixels_x", "layer_height", "display_orientation"):
            self.assertEqual(keys[key], their_keys[key], key)
        count = min(len(ours), len(theirs))
        self.assertLessEqual(abs(len(ours) - len(theirs)), 1)
        our_sum = their_sum = 0
        for k in range(count):
            a, b = b"".join(ours[k]), b"".join(theirs[k])
            self.assertEqual(len(a), len(b))
            worst = max(abs(x - y) for x, y in zip(a, b))
            self.assertLessEqual(worst, 2, "layer %d" % k)
            our_sum += sum(a)
            their_sum += sum(b)
        self.assertLessEqual(abs(our_sum - their_sum), 1e-4 * their_sum)


def islands(pixels):
    """Sets of pixels that are connected along rows and columns."""
    left, count = set(pixels), 0
    while left:
        count += 1
        todo = [left.pop()]
        while todo:
            x, y = todo.pop()
            for p in ((x + 1, y), (x - 1, y), (x, y + 1), (x, y - 1)):
                if p in left:
                    left.remove(p)
                    todo.append(p)
    return count


def stl(points, faces):
    import struct
    data = b"\0" * 80 + struct.pack("<I", len(faces))
    for face in faces:
        data += struct.pack("<12f", 0, 0, 0, *(c for i in face for c in points[i])) + b"\0\0"
    return data


if __name__ == "__main__":
    unittest.main()
