# SPDX-License-Identifier: Apache-2.0
"""`tetvdb prepare`: hollow solids, filled cavities and offsets as a user meets them, judged by
second readers, by counting edges and by PrusaSlicer where it is installed."""

import math
import shutil
import struct
import subprocess
import unittest

import layer_readers as readers
import program
from program import ball, box_faces, inverted, joined, lattice, off, volume

PLATE = ["--pixels", "200,200", "--display", "40,40", "--layer-height", "0.2"]


def stl(path):
    """Points that are equal become one; faces in the order of the file."""
    data = path.read_bytes()
    count, = struct.unpack_from("<I", data, 80)
    numbers = {}
    number = lambda point: numbers.setdefault(point, len(numbers))
    faces = [[number(c[:3]), number(c[3:6]), number(c[6:])]
             for c in struct.iter_unpack("<12x9f2x", data[84:84 + 50 * count])]
    return list(numbers), faces


def volume_before(mesh, x):
    """Of what lies below a plane: the flow of (min(., x), 0, 0) outward, whose divergence is 1 there.
    Within faces that the plane cuts, to first order."""
    total = 0
    for a, b, c in mesh[1]:
        a, b, c = mesh[0][a], mesh[0][b], mesh[0][c]
        across = (b[1] - a[1]) * (c[2] - a[2]) - (b[2] - a[2]) * (c[1] - a[1])
        total += across / 2 * (min(a[0], x) + min(b[0], x) + min(c[0], x)) / 3
    return total


def components(mesh):
    parent = list(range(len(mesh[0])))

    def find(v):
        while parent[v] != v:
            parent[v] = parent[parent[v]]
            v = parent[v]
        return v

    for a, b, c in mesh[1]:
        parent[find(b)] = find(a)
        parent[find(c)] = find(a)
    return len({find(face[0]) for face in mesh[1]})


class PrepareTest(program.CommandLineTest):
    def prepared(self, name, mesh, *options, output="out.stl"):
        self.write(name, off(*mesh))
        report = self.report_of("prepare", name, "-o", output, *options)
        return report["prepare"]

    def solid(self, name="out.stl"):
        mesh = stl(self.path(name))
        edges = [edge for a, b, c in mesh[1] for edge in ((a, b), (b, c), (c, a))]
        once = set(edges)
        self.assertEqual(len(once), len(edges))
        self.assertEqual({(b, a) for a, b in edges}, once)
        self.judge(name)
        return mesh

    def judge(self, name):
        """PrusaSlicer opens it as manifold."""
        if not shutil.which("prusa-slicer"):
            return
        done = subprocess.run(["prusa-slicer", "--info", str(self.path(name))],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                              timeout=300)
        self.assertIn("manifold = yes", done.stdout)

    # --- hollow ---

    def test_a_hollow_ball_has_its_volume_and_its_faces(self):
        mesh = ball(40, 10, (0, 0, 0))
        report = self.prepared("ball.off", mesh, "--hollow", "2", "--voxel-size", "0.1",
                               "--simplify", "0")
        out = self.solid()
        self.assertEqual(out[1][:len(mesh[1])] and len(out[1]) > len(mesh[1]), True)
        single = {tuple(struct.unpack("<3f", struct.pack("<3f", *p))) for p in mesh[0]}
        self.assertLess(single - set(out[0]), {(0, 0, 0)})  # every point of the input is there
        inner = volume(mesh) - volume(out)
        self.assertAlmostEqual(inner / (4 / 3 * math.pi * 512), 1, 2)
        self.assertAlmostEqual(volume(out), report["volume"], 1)
        self.assertAlmostEqual(volume(mesh), report["volume_before"], 6)
        self.assertAlmostEqual(report["volume_saved"], inner, 1)
        self.assertEqual((report["cavities_before"], report["cavities"]), (0, 1))
        self.assertGreaterEqual(report["wall_min"], 2)
        self.assertLess(report["wall_min"], 2.01)
        self.assertEqual(report["faces_kept"], len(mesh[1]))
        self.assertEqual(components(out), 2)

    def test_the_cavity_has_few_faces_and_walls_are_no_thinner(self):
        """Against the cavity as it was made: more solid, by less than what is allowed."""
        mesh = ball(24, 10, (0, 0, 0))
        whole = self.prepared("ball.off", mesh, "--hollow", "2", "--simplify", "0")
        self.assertEqual(whole["cavity_triangles"], whole["triangles"] - len(mesh[1]))
        for voxels, options, times in ((0.25, (), 10), (1, ("--simplify", "1"), 20)):
            report = self.prepared("ball.off", mesh, "--hollow", "2", *options)
            out = self.solid()
            self.assertEqual(report["cavity_triangles"], whole["cavity_triangles"])
            self.assertLess(times * (report["triangles"] - len(mesh[1])), whole["cavity_triangles"])
            self.assertEqual(report["wall_min"], whole["wall_min"])
            self.assertEqual(components(out), 2)
            thicker = (report["volume"] - whole["volume"]) / (4 * math.pi * 8 ** 2)
            self.assertLess(0, thicker)
            self.assertLess(thicker, voxels * 0.1)
            inner = [math.hypot(*p) for p in out[0] if math.hypot(*p) < 9]
            self.assertLess(max(inner), 8)

    def test_the_voxel_follows_the_wall_and_is_said(self):
        report = self.prepared("ball.off", ball(12, 10, (0, 0, 0)), "--hollow", "4")
        self.assertAlmostEqual(report["voxel_size"], 0.2)
        self.assertFalse(report["voxel_is_coarse"])
        result = self.succeed("prepare", "ball.off", "-o", "out.stl", "--hollow", "4")
        self.assertIn("voxels of 0.2", result.out)
        large = ball(12, 2000, (0, 0, 0))
        report = self.prepared("large.off", large, "--hollow", "60", "--simplify", "0")
        self.assertTrue(report["voxel_is_coarse"])
        self.assertGreater(report["voxel_size"], 3)

    def test_walls_that_meet_leave_no_cavity(self):
        self.write("plate.off", off(*box_faces((0, 0, 0), (30, 20, 3.9))))
        report = self.report_of("prepare", "plate.off", "-o", "out.stl", "--hollow", "2",
                                "--voxel-size", "0.2")
        self.assertEqual([w["code"] for w in report["warnings"]], ["no-cavity"])
        self.assertEqual(report["prepare"]["cavities"], 0)
        self.assertAlmostEqual(volume(self.solid()), 30 * 20 * 3.9, 1)

    def test_every_component_gets_its_cavity(self):
        mesh = joined(ball(16, 6, (0, 0, 0)), box_faces((10, 0, 0), (20, 10, 10)),
                      box_faces((30, 0, 0), (31, 10, 10)))
        report = self.prepared("parts.off", mesh, "--hollow", "1.5", "--voxel-size", "0.15")
        self.assertEqual(report["cavities"], 2)
        self.assertEqual(components(self.solid()), 5)

    def test_cavities_that_are_there_stay_or_are_filled(self):
        mesh = joined(box_faces((0, 0, 0), (20, 20, 20)), inverted(box_faces((2, 2, 2), (3, 3, 3))),
                      inverted(box_faces((8, 8, 8), (12, 12, 12))))
        report = self.prepared("block.off", mesh, "--fill-voids", "2")
        self.assertEqual((report["cavities_before"], report["cavities"], report["filled_voids"]),
                         (2, 1, 1))
        self.assertIsNone(report["voxel_size"])
        self.assertAlmostEqual(volume(self.solid()), 8000 - 64, 2)
        report = self.prepared("block.off", mesh, "--hollow", "2", "--voxel-size", "0.25")
        self.assertEqual(report["cavities"], 3)
        inside = volume(self.solid())
        report = self.prepared("block.off", mesh, "--hollow", "2", "--voxel-size", "0.25",
                               "--fill-voids", "100")
        self.assertEqual(report["cavities"], 1)
        self.assertLess(volume(self.solid()), inside)  # no walls around what was filled

    def test_narrow_places_are_closed(self):
        mesh = joined(box_faces((0, 0, 0), (20, 20, 20)), box_faces((30, 0, 0), (50, 6, 6)))
        options = ["--hollow", "2", "--voxel-size", "0.25"]
        self.assertEqual(self.prepared("two.off", mesh, *options)["cavities"], 2)
        self.assertEqual(self.prepared("two.off", mesh, *options, "--close", "1.5")["cavities"], 1)
        self.solid()

    # --- infill ---

    def test_an_infill_fills_its_share_of_the_cavity(self):
        mesh = box_faces((0, 0, 0), (19, 19, 19))  # three cells and the walls
        options = ["--hollow", "2", "--voxel-size", "0.25"]
        empty = self.prepared("box.off", mesh, *options)["volume"]
        lattice_options = ["--infill", "gyroid", "--cell-size", "5", "--density", "0.25"]
        report = self.prepared("box.off", mesh, *options, *lattice_options)
        share = (report["volume"] - empty) / (19 ** 3 - empty)
        self.assertAlmostEqual(share, 0.25, 1)
        self.assertLess(abs(share - 0.25), 0.01)
        self.assertGreaterEqual(report["wall_min"], 2)
        self.assertEqual(report["faces_kept"], 12)
        self.solid()
        default = self.prepared("box.off", mesh, "--hollow", "2", "--infill", "bcc", "--cell-size",
                                "8", "--thickness", "1.6")
        self.assertAlmostEqual(default["voxel_size"], 0.25)  # an eighth of the wall
        self.solid()

    def test_an_array_sets_the_thickness(self):
        points, tets = lattice(4, side=20)
        text = program.vtu(points, tets).replace(
            "</Piece>", '<PointData><DataArray type="Float64" Name="stress" format="ascii">'
            + " ".join(str(p[0] - 7) for p in points) + "</DataArray></PointData></Piece>")
        self.write("beam.vtu", text)
        run = lambda thickness, name: self.report_of(
            "prepare", "beam.vtu", "-o", name, "--hollow", "1", "--voxel-size", "0.4", "--infill",
            "schwarz-p", "--cell-size", "5", "--thickness", thickness)["prepare"]
        thin, thick = run("0.8", "thin.stl"), run("2.4", "thick.stl")
        mixed = run("stress:0.8:2.4", "mixed.stl")
        self.assertLess(thin["volume"], mixed["volume"])
        self.assertLess(mixed["volume"], thick["volume"])
        # In slabs of whole cells, about linear from the thin one at x = 0 to the thick one at 20.
        meshes = [self.solid(name) for name in ("thin.stl", "mixed.stl", "thick.stl")]
        shares = []
        for low in (0, 15):
            volumes = [volume_before(mesh, low + 5) - volume_before(mesh, low) for mesh in meshes]
            shares.append((volumes[1] - volumes[0]) / (volumes[2] - volumes[0]))
        self.assertLess(abs(shares[0] - 0.15), 0.08)  # of 1 to 5
        self.assertLess(abs(shares[1] - 0.85), 0.08)

    def test_infills_that_cannot_be_are_refused(self):
        self.write("box.off", off(*box_faces((0, 0, 0), (20, 20, 20))))
        refuse = lambda status, says, *options: self.refuse(
            status, "prepare", "box.off", "-o", "out.stl", "--hollow", "2", *options, says=says)
        refuse(2, "gyroid", "--infill", "foam", "--cell-size", "5", "--density", "0.2")
        refuse(2, "--cell-size", "--infill", "gyroid", "--density", "0.2")
        refuse(2, "--density", "--infill", "gyroid", "--cell-size", "5")
        refuse(2, "--density", "--infill", "gyroid", "--cell-size", "5", "--density", "1.2")
        refuse(2, "--infill", "--density", "0.2")
        refuse(2, "tetrahedra", "--infill", "gyroid", "--cell-size", "5", "--thickness",
               "stress:0.4:1.6")
        self.refuse(2, "prepare", "box.off", "-o", "out.stl", "--infill", "gyroid", "--cell-size",
                    "5", "--density", "0.2", says="--hollow")
        points, tets = lattice(2, side=10)
        self.write("block.vtu", program.vtu(points, tets))
        self.refuse(2, "prepare", "block.vtu", "-o", "out.stl", "--hollow", "1", "--infill",
                    "gyroid", "--cell-size", "5", "--thickness", "stress:0.4:1.6", says="stress")

    # --- drains ---

    def test_holes_connect_cavities_with_the_outside(self):
        mesh = box_faces((0, 0, 0), (20, 20, 20))
        options = ["--hollow", "2", "--voxel-size", "0.25", "--simplify", "0"]
        closed = self.prepared("box.off", mesh, *options)
        report = self.prepared("box.off", mesh, *options, "--drain", "auto:1.5", "--drain",
                               "0,9.7,8.6,1,0,0,1")
        out = self.solid()
        self.assertEqual((closed["cavities"], report["cavities"], components(out)), (1, 0, 1))
        self.assertEqual(len(report["drains"]), 2)
        side, bottom = report["drains"]
        self.assertEqual(side["point"], [0, 9.7, 8.6])
        for axis, place in enumerate((10, 10, 2)):
            self.assertLess(abs(bottom["point"][axis] - place), 0.1)
        taken = 0
        for drain, name, radius in ((side, "out_plug_1.stl", 1), (bottom, "out_plug_2.stl", 1.5)):
            self.assertTrue(drain["plug"].endswith(name))
            plug = volume(self.solid(name))
            self.assertAlmostEqual(plug, drain["plug_volume"], 3)
            # Walls are thicker by up to the square of the voxel over twice the wall.
            self.assertGreater(plug, math.pi * radius ** 2 * 2)
            self.assertLess(plug, math.pi * radius ** 2 * (2 + 0.25 ** 2 / 4))
            taken += plug
        self.assertAlmostEqual(closed["volume"] - report["volume"], taken, 3)
        self.assertLess(0, report["faces_kept"])
        self.assertLess(report["faces_kept"], len(mesh[1]))

    def test_a_hole_that_meets_no_cavity_is_refused(self):
        self.write("box.off", off(*box_faces((0, 0, 0), (20, 20, 20))))
        refuse = lambda status, says, *options: self.refuse(
            status, "prepare", "box.off", "-o", "out.stl", *options, says=says)
        refuse(3, "--drain", "--drain", "0,10,10,1,0,0,1")
        refuse(3, "--drain", "--hollow", "2", "--voxel-size", "0.5", "--drain",
               "60,10,10,0,1,0,1")
        refuse(2, "--drain", "--drain", "1,2,3")
        refuse(2, "--drain", "--drain", "0,10,10,0,0,0,1")
        refuse(2, "--drain", "--drain", "auto")
        refuse(2, "--drain", "--drain", "auto:-1")

    # --- offset ---

    def test_a_grown_ball_and_a_shrunk_box(self):
        self.prepared("ball.off", ball(40, 10, (0, 0, 0)), "--offset", "1")
        self.assertAlmostEqual(volume(self.solid()) / (4 / 3 * math.pi * 1331), 1, 2)
        report = self.prepared("box.off", box_faces((0, 0, 0), (10, 12, 14)), "--offset", "-1",
                               "--voxel-size", "0.23")
        points, faces = self.solid()
        self.assertAlmostEqual(volume((points, faces)), 8 * 10 * 12, 2)  # corners are sharp
        self.assertEqual(report["faces_kept"], 0)
        for corner in ((1, 1, 1), (9, 11, 13), (1, 11, 1)):
            self.assertLess(min(math.dist(p, corner) for p in points), 1e-3)

    # --- volumes ---

    def test_a_level_set_goes_straight_into_layers(self):
        mesh = ball(24, 10, (0, 0, 0))
        self.prepared("ball.off", mesh, "--hollow", "2", "--voxel-size", "0.2", output="ball.vdb")
        grid, = self.report_of("info", "ball.vdb")["input"][0]["grids"]
        self.assertEqual((grid["name"], grid["class"]), ("surface", "level set"))
        self.prepared("ball.off", mesh, "--hollow", "2", "--voxel-size", "0.2", "--simplify", "0",
                      output="ball.stl")
        sums = []
        for name in ("ball.vdb", "ball.stl"):
            self.succeed("slice", name, "-o", "layers", *PLATE)
            layers, manifest = readers.png_folder(self.path("layers"))
            sums.append(sum(sum(row) for layer in layers for row in layer) / 255 * 8e-3)
            middle = layers[len(layers) // 2]
            self.assertEqual((middle[100][100], middle[100][145], middle[100][160]), (0, 255, 0))
        self.assertAlmostEqual(sums[0] / sums[1], 1, 2)

    def test_tets_and_volumes_go_in(self):
        points, tets = lattice(2, side=10)
        self.write("block.vtu", program.vtu(points, tets))
        report = self.report_of("prepare", "block.vtu", "-o", "a.stl", "--hollow", "1",
                                "--simplify", "0")["prepare"]
        self.assertEqual(report["source"], "tets")
        self.assertAlmostEqual(volume(self.solid("a.stl")), 1000 - 512, 0)
        self.succeed("voxelize", "block.vtu", "-o", "block.vdb", "--grid", "surface",
                     "--voxel-size", "0.25")
        report = self.report_of("prepare", "block.vdb", "-o", "b.stl", "--hollow", "1",
                                "--voxel-size", "0.1", "--simplify", "0")["prepare"]
        self.assertEqual(report["source"], "volume")
        self.assertAlmostEqual(volume(self.solid("b.stl")) / (1000 - 512), 1, 1)

    # --- refusals ---

    def test_what_cannot_be_is_refused_with_advice(self):
        self.write("box.off", off(*box_faces((0, 0, 0), (10, 10, 10))))
        refuse = lambda status, says, *options: self.refuse(
            status, "prepare", "box.off", "-o", "out.stl", *options, says=says)
        refuse(2, "--hollow")
        refuse(2, "--hollow", "--hollow", "-1")
        refuse(2, "--hollow", "--close", "1")
        refuse(2, "--voxel-size", "--hollow", "1", "--voxel-size", "0.6")
        refuse(2, "--simplify", "--hollow", "1", "--simplify", "-1")
        refuse(2, "--offset", "--offset", "0")
        refuse(3, "shrink it by less", "--offset", "-6")
        refuse(4, "--voxel-size", "--hollow", "0.001")
        refuse(4, "--voxel-size", "--hollow", "1", "--voxel-size", "0.0001")
        self.refuse(2, "prepare", "box.off", "-o", "out.xyz", "--hollow", "1")
        self.refuse(2, "prepare", "box.off", "-o", "box.off", "--hollow", "1")
        self.write("sheet.off", off([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [[0, 1, 2]]))
        self.refuse(3, "prepare", "sheet.off", "-o", "out.stl", "--hollow", "1", says="repair")

    def test_a_mesh_with_a_hole_is_mended_with_a_warning(self):
        points, faces = ball(16, 10, (0, 0, 0))
        self.write("open.off", off(points, faces[1:]))
        report = self.report_of("prepare", "open.off", "-o", "out.stl", "--hollow", "2",
                                "--voxel-size", "0.25")
        self.assertIn("repaired", [w["code"] for w in report["warnings"]])
        self.assertEqual(components(self.solid()), 2)

    def test_what_cannot_be_mended_in_place_is_remade_with_a_warning(self):
        # Three plates that meet in an edge.
        points = [(0, 3, 2), (0, 3, -2), (-3, 0, 2), (0, 0, 2), (-3, 0, -2), (0, 0, -2), (3, 0, 2), (3, 0, -2)]
        plates = [(0, 3, 5, 1), (2, 3, 5, 4), (3, 6, 7, 5)]
        self.write("plates.off", off(points, [list(f) for a, b, c, d in plates for f in ((a, b, c), (a, c, d))]))
        report = self.report_of("prepare", "plates.off", "-o", "out.stl", "--hollow", "0.2", "--voxel-size", "0.05")
        self.assertIn("remeshed", [w["code"] for w in report["warnings"]])
        self.assertNotIn("repaired", [w["code"] for w in report["warnings"]])
        self.assertTrue(report["prepare"]["repaired"])
        self.assertEqual(report["prepare"]["faces_kept"], 0)
        self.assertEqual(components(self.solid()), 2)


if __name__ == "__main__":
    unittest.main()
