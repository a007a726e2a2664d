# SPDX-License-Identifier: Apache-2.0
"""Triangles into tetrahedra: the command itself, and voxelize by way of it."""

import math
import random
import signal
import struct
import subprocess
import time
import unittest

from program import PROGRAM, SCALE, CommandLineTest, ball, box_faces, joined, lattice, medit, off


def sphere(n, radius=1.0):
    """An octahedron whose edges are cut in n, drawn onto the sphere: points, 8 n^2 faces."""
    numbers, points, faces = {}, [], []

    def number(key):
        if key not in numbers:
            numbers[key] = len(points)
            length = math.sqrt(sum(c * c for c in key)) / radius
            points.append(tuple(c / length for c in key))
        return numbers[key]

    for octant in range(8):
        signs = [-1 if octant >> axis & 1 else 1 for axis in range(3)]
        at = lambda i, j: number((signs[0] * (n - i - j), signs[1] * i, signs[2] * j))
        for i in range(n):
            for j in range(n - i):
                some = [[at(i, j), at(i + 1, j), at(i, j + 1)]]
                if i + j + 1 < n:
                    some.append([at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)])
                faces += some if math.prod(signs) > 0 else [face[::-1] for face in some]
    return points, faces


def scaled(mesh, factor, shift=0.0):
    return [tuple(factor * c + shift for c in p) for p in mesh[0]], mesh[1]


def minus(a, b):
    return tuple(x - y for x, y in zip(a, b))


def determinant(u, v, w):
    return (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
            + u[2] * (v[0] * w[1] - v[1] * w[0]))


def volume_of(points, faces):
    origin = points[faces[0][0]]
    return sum(determinant(*(minus(points[c], origin) for c in face)) for face in faces) / 6


def area_of(points, faces):
    total = 0
    for a, b, c in faces:
        u, v = minus(points[b], points[a]), minus(points[c], points[a])
        cross = (u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0])
        total += math.sqrt(sum(x * x for x in cross)) / 2
    return total


class Tets:
    """A Medit file, read without the program."""

    def __init__(self, path):
        words = iter(path.read_text().split())
        self.points, self.tets, self.regions = [], [], []
        for word in words:
            if word == "Vertices":
                for _ in range(int(next(words))):
                    self.points.append(tuple(float(next(words)) for _ in range(3)))
                    next(words)
            elif word == "Tetrahedra":
                for _ in range(int(next(words))):
                    self.tets.append([int(next(words)) - 1 for _ in range(4)])
                    self.regions.append(int(next(words)))

    def volumes(self):
        """By region."""
        sums = {}
        for tet, region in zip(self.tets, self.regions):
            origin = self.points[tet[0]]
            sixfold = determinant(*(minus(self.points[c], origin) for c in tet[1:]))
            sums[region] = sums.get(region, 0) + sixfold / 6
        return sums

    def faults(self):
        """Tets that are not positive, and faces that are neither between two tets nor on the boundary."""
        wrong, sides = 0, {}
        for a, b, c, d in self.tets:
            origin = self.points[a]
            wrong += determinant(*(minus(self.points[v], origin) for v in (b, c, d))) <= 0
            for face in ((b, d, c), (a, c, d), (a, d, b), (a, b, c)):
                least = face.index(min(face))
                face = face[least:] + face[:least]
                sides[face] = sides.get(face, 0) + 1
        return wrong, sum(count > 1 for count in sides.values())


class Tetrahedralize(CommandLineTest):
    def put(self, name, mesh):
        self.write(name, off(*mesh))

    def tets_of(self, *arguments, status=0):
        """Report and mesh of a run; the mesh has to be valid and the report true."""
        report = self.report_of("tetrahedralize", *arguments, "-o", "out.mesh", status=status)
        tets = Tets(self.path("out.mesh"))
        self.assertEqual(tets.faults(), (0, 0))
        mesh = report["mesh"]
        self.assertEqual((mesh["tets"], mesh["vertices"]), (len(tets.tets), len(tets.points)))
        self.assertAlmostEqual(mesh["volume"], sum(tets.volumes().values()),
                               delta=1e-9 * abs(mesh["volume"]))
        return report, tets

    def test_report(self):
        self.put("box.off", box_faces())
        report, tets = self.tets_of("box.off", "--threads", 2)
        self.assertEqual(
            list(report), ["version", "command", "status", "device", "threads", "input", "mesh",
                           "stages", "output", "warnings"])
        self.assertEqual((report["command"], report["status"], report["threads"]),
                         ("tetrahedralize", 0, 2))
        [source] = report["input"]
        self.assertEqual((source["kind"], source["format"], source["triangles"]),
                         ("triangles", "OFF", 12))
        mesh = report["mesh"]
        self.assertAlmostEqual(mesh["epsilon_asked"], 1e-3 * 3**0.5)
        self.assertAlmostEqual(mesh["edge_length"], 0.05 * 3**0.5)
        self.assertLessEqual(mesh["epsilon_reached"], mesh["epsilon_asked"])
        self.assertEqual(mesh["epsilon_reached"], mesh["check"]["out_to_in"])
        self.assertEqual((mesh["not_inserted"], mesh["check"]["lost_points"]), (0, 0))
        self.assertGreater(mesh["check"]["owed_points"], 0)
        self.assertGreaterEqual(mesh["quality"]["worst_energy"], mesh["quality"]["mean_energy"])
        self.assertGreaterEqual(mesh["quality"]["mean_energy"], 3)
        self.assertGreater(mesh["quality"]["box_over_volume"], 3)
        self.assertEqual(mesh["regions"], [{"number": 1, "name": "box", "tets": len(tets.tets)}])
        self.assertIsNone(mesh["boolean"])
        self.assertEqual([s["name"] for s in report["stages"]],
                         ["read", "clean", "tetrahedralize", "write"])
        self.assertEqual(report["output"][0]["bytes"], self.path("out.mesh").stat().st_size)

    def test_solids(self):
        for name, mesh in (("box", box_faces()), ("sphere", sphere(12)),
                           ("shell", joined(box_faces((0, 0, 0), (4, 4, 4)),
                                            scaled((box_faces()[0],
                                                    [f[::-1] for f in box_faces()[1]]), 2, 1)))):
            self.put(name + ".off", mesh)
            for epsilon in ("5e-4d", "3e-3d", "0.02"):
                with self.subTest(name=name, epsilon=epsilon):
                    report, _ = self.tets_of(name + ".off", "--epsilon", epsilon)
                    asked = report["mesh"]["epsilon_asked"]
                    self.assertAlmostEqual(report["mesh"]["volume"], volume_of(*mesh),
                                           delta=1.1 * asked * area_of(*mesh))
                    self.assertLessEqual(report["mesh"]["epsilon_reached"], asked)

    def test_every_format_and_its_regions(self):
        self.put("a.off", box_faces())
        self.put("b.off", box_faces((2.0, 0.0, 0.0), (3.0, 1.0, 1.0)))
        for ending in ("msh", "mesh", "vtu"):
            report = self.report_of("tetrahedralize", "a.off", "b.off", "-o", "out." + ending)
            said = report["mesh"]["regions"]
            self.assertEqual([(r["number"], r["name"]) for r in said], [(1, "a"), (2, "b")])
            [mesh] = self.report_of("info", "out." + ending)["input"]
            self.assertEqual([(r["number"], r["cells"]) for r in mesh["regions"]],
                             [(r["number"], r["tets"]) for r in said])
            self.assertEqual(mesh["defects"], {"inverted": 0, "flat": 0})
            self.assertAlmostEqual(mesh["volume"], report["mesh"]["volume"])
            names = ["a", "b"] if ending == "msh" else ["", ""]
            self.assertEqual([r["name"] for r in mesh["regions"]], names)

    def test_names_come_once(self):
        self.path("sub").mkdir()
        self.put("a.off", box_faces())
        self.put("sub/a.off", box_faces((2.0, 0.0, 0.0), (3.0, 1.0, 1.0)))
        report, _ = self.tets_of("a.off", "sub/a.off")
        self.assertEqual([r["name"] for r in report["mesh"]["regions"]], ["a", "a_2"])

    def test_materials_and_booleans(self):
        self.put("a.off", box_faces())
        self.put("b.off", box_faces((0.5, 0.5, 0.5), (1.5, 1.5, 1.5)))
        for boolean, truth in ((None, {1: 1, 2: 0.875}), ("union", {1: 1.875}),
                               ("difference", {1: 0.875}), ("intersection", {1: 0.125})):
            with self.subTest(boolean=boolean):
                options = ("--boolean", boolean) if boolean else ()
                report, tets = self.tets_of("a.off", "b.off", *options)
                error = 12 * report["mesh"]["epsilon_asked"]
                volumes = tets.volumes()
                self.assertEqual(sorted(volumes), sorted(truth))
                for region, volume in truth.items():
                    self.assertAlmostEqual(volumes[region], volume, delta=error)
                self.assertEqual(report["mesh"]["boolean"], boolean)
                if boolean:
                    self.assertEqual(report["mesh"]["regions"][0]["name"], boolean)
        report, tets = self.tets_of("b.off", "a.off") # the first owns what both hold
        self.assertAlmostEqual(tets.volumes()[1], 1, delta=12 * report["mesh"]["epsilon_asked"])

    def test_materials_that_touch(self):
        self.put("a.off", box_faces())
        self.put("b.off", box_faces((1.0, 0.0, 0.0), (2.0, 1.0, 1.0)))
        report, tets = self.tets_of("a.off", "b.off")
        for region in (1, 2):
            self.assertAlmostEqual(tets.volumes()[region], 1,
                                   delta=6 * report["mesh"]["epsilon_asked"])

    def test_outside(self):
        self.put("box.off", box_faces())
        report, tets = self.tets_of("box.off", "--keep-outside")
        volumes = tets.volumes()
        self.assertEqual([r["name"] for r in report["mesh"]["regions"]], ["outside", "box"])
        self.assertAlmostEqual(volumes[1], 1, delta=6 * report["mesh"]["epsilon_asked"])
        self.assertGreater(volumes[0], 0)
        extent = [max(p[k] for p in tets.points) - min(p[k] for p in tets.points)
                  for k in range(3)]
        self.assertAlmostEqual(volumes[0] + volumes[1], math.prod(extent),
                               delta=1e-6 * math.prod(extent))

    def test_quality(self):
        self.put("ball.off", sphere(6))
        report, _ = self.tets_of("ball.off", "--stop-energy", 12, "--edge-length", 0.4)
        self.assertLessEqual(report["mesh"]["quality"]["worst_energy"], 12)
        self.assertAlmostEqual(report["mesh"]["edge_length"], 0.4)
        report, _ = self.tets_of("ball.off", "--max-passes", 0)
        self.assertEqual(report["mesh"]["passes"], 0)

    def test_dirt(self):
        points, faces = sphere(8)
        truth, area = volume_of(points, faces), area_of(points, faces)
        turned = [face[::-1] if i % 5 == 0 else face for i, face in enumerate(faces)]
        for name, mesh in (("turned", (points, turned)), ("doubled", (points, faces + faces)),
                           ("open", (points, faces[1:])),
                           ("soup", joined(*[([points[c] for c in f], [[0, 1, 2]])
                                             for f in faces])),
                           ("flat", (points, faces + [[0, 0, 1], [2, 2, 2]]))):
            with self.subTest(name=name):
                self.put(name + ".off", mesh)
                report, _ = self.tets_of(name + ".off")
                hole = 0.02 if name == "open" else 0
                self.assertAlmostEqual(report["mesh"]["volume"], truth,
                                       delta=1.1 * report["mesh"]["epsilon_asked"] * area + hole)

    def test_one_box_ten_thousand_times(self):
        points, faces = box_faces()
        self.put("many.off", (points, faces * 10000))
        report, _ = self.tets_of("many.off")
        self.assertAlmostEqual(report["mesh"]["volume"], 1, delta=0.012)

    def test_sizes_and_places(self):
        for factor, shift in ((1e8, 0.0), (1e-8, 0.0), (1.0, 1e8), (1e-3, -7e5)):
            with self.subTest(factor=factor, shift=shift):
                self.put("box.off", scaled(box_faces(), factor, shift))
                report, tets = self.tets_of("box.off")
                # Far from the origin doubles are coarse, in the file as well.
                error = 1.1 * report["mesh"]["epsilon_asked"] + 4e-16 * abs(shift)
                self.assertAlmostEqual(report["mesh"]["volume"] / factor**3, 1,
                                       delta=6 * error / factor)

    def test_any_number_of_threads(self):
        self.put("ball.off", sphere(20))
        self.put("box.off", box_faces((0.0, 0.0, 0.0), (1.5, 1.5, 1.5)))
        files = set()
        for threads in (1, 2, 4):
            self.succeed("tetrahedralize", "ball.off", "box.off", "-o", "out.msh", "--threads",
                         threads)
            files.add(self.path("out.msh").read_bytes())
        self.assertEqual(len(files), 1)

    def test_summary(self):
        self.put("box.off", box_faces())
        loud = self.succeed("tetrahedralize", "box.off", "-o", "out.msh")
        self.assertIn("out.msh", loud.out)
        self.assertIn("tets", loud.out)
        self.assertEqual(loud.err, "")
        quiet = self.succeed("tetrahedralize", "box.off", "-o", "out.msh", "-q")
        self.assertEqual((quiet.out, quiet.err), ("", ""))
        verbose = self.succeed("tetrahedralize", "box.off", "-o", "out.msh", "-v")
        for stage in ("read", "clean", "tetrahedralize", "write"):
            self.assertIn(stage, verbose.err)
        self.assertIn("Examples", self.succeed("tetrahedralize", "--help").out)


class BadInput(CommandLineTest):
    def refuse_mesh(self, name, content, statuses=3, says=()):
        self.write(name, content)
        self.refuse(statuses, "tetrahedralize", name, "-o", "out.msh", says=says)

    def test_nothing_inside(self):
        self.refuse_mesh("sheet.off", off([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0),
                                           (0.0, 1.0, 0.0)], [[0, 1, 2], [0, 2, 3]]))
        self.refuse_mesh("one.off", off([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)],
                                        [[0, 1, 2]]))
        points, faces = box_faces()
        self.refuse_mesh("point.off", off([(1.0, 2.0, 3.0)] * 8, faces))
        self.refuse_mesh("line.off", off([(p[0], 0.0, 0.0) for p in points], faces))
        self.refuse_mesh("flat.off", off([(p[0], p[1], 0.0) for p in points], faces))
        self.refuse_mesh("no_faces.off", off(points, []))

    def test_numbers_that_are_none(self):
        points, faces = box_faces()
        self.refuse_mesh("nan.off", off([(math.nan,) * 3] * 8, faces), says="nan.off")
        self.refuse_mesh("inf.off", off([tuple(math.inf * (c or -1) for c in p)
                                         for p in points], faces), says="inf.off")
        stl = bytes(80) + struct.pack("<I", 12) + 12 * (struct.pack("<12f", *[math.nan] * 12)
                                                        + bytes(2))
        self.refuse_mesh("nan.stl", stl, says="nan.stl")
        # What is left is a box with a face too many that has a corner nowhere.
        self.write("part.off", off(points + [(math.nan,) * 3], faces + [[0, 1, 8]]))
        report = self.report_of("tetrahedralize", "part.off", "-o", "out.msh", status=1)
        self.assertIn("bad-faces", [w["code"] for w in report["warnings"]])
        self.assertAlmostEqual(report["mesh"]["volume"], 1, delta=0.012)
        quiet = self.succeed("tetrahedralize", "part.off", "-o", "out.msh", "-q", status=1)
        self.assertEqual(quiet.lines, ["tetvdb: warning: " + w["text"] for w in report["warnings"]])

    def test_other_kinds_of_files(self):
        self.write("box.mesh", medit(*lattice(1)))
        self.write("page.off", "<html><body>404 not found</body></html>\n")
        self.refuse(2, "tetrahedralize", "box.mesh", "-o", "out.msh", says="box.mesh")
        self.refuse((2, 3), "tetrahedralize", "page.off", "-o", "out.msh", says="page.off")
        self.refuse(3, "tetrahedralize", "none.stl", "-o", "out.msh", says="none.stl")

    def test_options(self):
        self.write("box.off", off(*box_faces()))
        job = ("tetrahedralize", "box.off", "-o", "out.msh")
        for epsilon in ("0", "-1", "-1e-3d", "nan", "inf", "0d", "1x", "0.5v", "d", "", "1e-3dd"):
            self.refuse(2, *job, "--epsilon=" + epsilon, says="--epsilon")
        for epsilon in ("5", "3d"): # larger than the model
            self.refuse((2, 3), *job, "--epsilon", epsilon)
        for length in ("0", "-1", "nan", "1v"):
            self.refuse(2, *job, "--edge-length=" + length, says="--edge-length")
        for energy in ("0", "2.9", "-1", "nan", "inf", "x"):
            self.refuse(2, *job, "--stop-energy=" + energy, says="--stop-energy")
        self.refuse(2, *job, "--max-passes=-1", says="--max-passes")
        self.refuse(2, *job, "--boolean", "xor", says="--boolean")
        self.refuse(2, *job, "--boolean", "union", says="--boolean")
        self.refuse(2, *job, "--weld", "-1", says="--weld")
        self.refuse(2, *job, "--max-memory", "4X", says="--max-memory")
        self.refuse(2, "tetrahedralize", "box.off", says="-o")
        self.refuse(2, "tetrahedralize", "-o", "out.msh")

    def test_outputs(self):
        self.write("box.off", off(*box_faces()))
        for name in ("out.stl", "out.vdb", "out", "out.msh.gz"):
            self.refuse(2, "tetrahedralize", "box.off", "-o", name, says=name)
        self.path("folder.msh").mkdir()
        self.refuse(7, "tetrahedralize", "box.off", "-o", "folder.msh", says="folder.msh")
        self.refuse(7, "tetrahedralize", "box.off", "-o", "no/out.msh", says="no/out.msh")
        self.write("box.msh", off(*box_faces())) # what a file holds decides, not its name
        self.refuse(2, "tetrahedralize", "box.msh", "-o", "box.msh", says="box.msh")


class Limits(CommandLineTest):
    # Much to do: fine, and better than it can become.
    HARD = ("--epsilon", "1e-4d", "--stop-energy", "3.01")

    def setUp(self):
        super().setUp()
        self.write("ball.off", off(*sphere(90)))

    def test_time(self):
        self.refuse(5, "tetrahedralize", "ball.off", "-o", "out.msh", *self.HARD, "--max-time",
                    "0.3", says="time limit")
        self.refuse(5, "tetrahedralize", "ball.off", "-o", "out.msh", "--max-time", "1e-6")

    def test_memory(self):
        self.refuse(4, "tetrahedralize", "ball.off", "-o", "out.msh", "--max-memory", "1M",
                    says="memory")

    def test_interrupt_leaves_nothing(self):
        for number, delay in ((signal.SIGINT, 0.05), (signal.SIGTERM, 0.4)):
            job = subprocess.Popen(
                [PROGRAM, "tetrahedralize", "ball.off", "-o", "out.msh", "-v", *self.HARD],
                cwd=self.folder, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
            while "tetrahedralize" not in job.stderr.readline() and job.poll() is None:
                pass
            time.sleep(delay)
            begin = time.monotonic()
            job.send_signal(number)
            _, err = job.communicate(timeout=120)
            self.assertEqual(job.returncode, 5, err)
            self.assertIn("cancelled", err)
            self.assertLess(time.monotonic() - begin, 20)
            self.assertEqual([p.name for p in self.folder.iterdir()], ["ball.off"])


class VoxelizeByWayOfTets(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("box.off", off(*box_faces()))

    def voxelize(self, *arguments, status=0):
        return self.report_of("voxelize", *arguments, "-o", "out.vdb", status=status)

    def test_which_method_is_taken(self):
        for options, method, word in (
                (("--resolution", 40), "winding", "no output requires tets"),
                (("--resolution", 300), "winding", "no output requires tets"),
                (("--resolution", 40, "--grid", "material"), "winding", "no output"),
                (("--resolution", 300, "--epsilon", "0.5v"), "envelope", "--epsilon"),
                (("--resolution", 300, "--grid", "tet_id"), "envelope", "tet_id"),
                (("--resolution", 40, "--inside", "parity"), "winding", "--inside"),
                (("--resolution", 40, "--shell", "0.2"), "winding", "--shell"),
                (("--resolution", 40, "--mesher", "winding"), "winding", "asked for"),
                (("--resolution", 300, "--mesher", "envelope"), "envelope", "asked for")):
            with self.subTest(options=options):
                report = self.voxelize("box.off", *options)
                mesher = report["mesh"]["mesher"]
                self.assertEqual(mesher["method"], method)
                self.assertIn(word, mesher["why"])
                stages = [s["name"] for s in report["stages"]]
                self.assertEqual("tetrahedralize" in stages, method == "envelope")
                self.assertEqual("tets" in report["mesh"], method == "envelope")
        said = self.succeed("voxelize", "box.off", "-o", "out.vdb", "--resolution", 40, "-v").err
        self.assertIn("mesher: winding, since no output requires tets", said)
        self.assertIsNone(self.report_of("voxelize", "box.off", "--write-mesh",
                                         "out.stl")["mesh"]["mesher"])

    def test_epsilon(self):
        for text, length in (("0.25v", 0.025 / 4), ("2e-3d", 2e-3 * 3**0.5), ("0.004", 0.004)):
            mesh = self.voxelize("box.off", "--voxel-size", 0.025, "--epsilon", text)["mesh"]
            self.assertAlmostEqual(mesh["epsilon_asked"], length)
            self.assertLessEqual(mesh["epsilon_reached"], length)
        mesh = self.voxelize("box.off", "--voxel-size", "0.025,0.05,0.1", "--mesher",
                             "envelope")["mesh"]
        self.assertAlmostEqual(mesh["epsilon_asked"], 0.0125)

    def test_only_voxels_at_the_surface_differ(self):
        self.write("ball.off", off(*sphere(16)))
        for name, voxels, size in (("box.off", 50, 1 / 50), ("ball.off", 60, 2 / 60)):
            grids = {}
            for mesher in ("envelope", "winding"):
                report = self.voxelize(name, "--voxel-size", size, "--mesher", mesher, "--grid",
                                       "mask")
                [grids[mesher]] = report["grids"]
            self.assertEqual(grids["envelope"]["voxel_size"], grids["winding"]["voxel_size"])
            surface = 6 * voxels**2
            self.assertAlmostEqual(grids["envelope"]["active_voxels"],
                                   grids["winding"]["active_voxels"], delta=surface)

    def test_never_more_voxels_than_asked_for(self):
        self.write("ball.off", off(*sphere(16)))
        for mesher in ("envelope", "winding"):
            [grid] = self.voxelize("ball.off", "--resolution", 60, "--mesher", mesher)["grids"]
            for axis in range(3):
                self.assertLessEqual(grid["box"]["max"][axis] - grid["box"]["min"][axis] + 1, 60)

    def test_tet_numbers_and_mesh(self):
        report = self.voxelize("box.off", "--resolution", 32, "--grid", "tet_id,density",
                               "--write-mesh", "tets.msh")
        tets = report["mesh"]["tets"]
        self.assertEqual([o["path"] for o in report["output"]], ["out.vdb", "tets.msh"])
        self.assertEqual(self.report_of("info", "tets.msh")["input"][0]["tets"], tets)
        grids = self.report_of("info", "out.vdb")["input"][0]["grids"]
        numbers = next(g for g in grids if g["name"] == "tet_id")
        self.assertGreaterEqual(numbers["min"], 0)
        self.assertLess(numbers["max"], tets)
        # The mesh's own voxels are these.
        self.succeed("voxelize", "tets.msh", "-o", "again.vdb", "--voxel-size",
                     repr(report["grids"][0]["voxel_size"][0]), "--grid", "tet_id,density")
        self.assertEqual(self.hash_of("again.vdb"), self.hash_of("out.vdb"))
        alone = self.report_of("voxelize", "box.off", "--write-mesh", "alone.vtu")
        self.assertEqual(self.report_of("info", "alone.vtu")["input"][0]["tets"],
                         alone["mesh"]["tets"])

    def test_materials(self):
        self.write("b.off", off(*box_faces((0.5, 0.5, 0.5), (1.5, 1.5, 1.5))))
        arguments = ("box.off", "b.off", "--resolution", 30, "--grid", "material,density")
        report = self.voxelize(*arguments, "--mesher", "envelope")
        self.assertAlmostEqual(report["mesh"]["volume"], 1.875, delta=0.3)
        by_tets = {g["name"]: g for g in report["grids"]}
        report = self.voxelize(*arguments, "--grid", "coverage,mask,surface")
        self.assertEqual(report["mesh"]["mesher"]["method"], "winding")
        self.assertNotIn("tetrahedralize", [s["name"] for s in report["stages"]])
        grids = {g["name"]: g for g in report["grids"]}
        for found in (by_tets, grids):
            self.assertEqual((found["material"]["min"], found["material"]["max"]), (1, 2))
        # 20^3 voxels and 20^3 without the 10^3 that the first file owns.
        for name in ("material", "density", "mask"):
            self.assertEqual(grids[name]["active_voxels"], 15000)
        # Where the files overlap, voxels on the surface are counted once, but for their parts.
        self.assertAlmostEqual(grids["coverage"]["filled"], 1.875, delta=0.01)
        self.assertAlmostEqual(grids["surface"]["volume"], 1.875, delta=1e-9)
        # The first file owns what both have.
        self.write("c.off", off(*box_faces((0.25, 0.25, 0.25), (0.5, 0.5, 0.5))))
        hidden = self.voxelize("box.off", "c.off", "--resolution", 20, "--grid", "material")
        self.assertEqual((hidden["grids"][0]["min"], hidden["grids"][0]["max"]), (1, 1))
        shown = self.voxelize("c.off", "box.off", "--resolution", 20, "--grid", "material")
        self.assertEqual((shown["grids"][0]["min"], shown["grids"][0]["max"]), (1, 2))
        self.assertEqual(shown["grids"][0]["active_voxels"], hidden["grids"][0]["active_voxels"])
        # One that has no inside is named.
        self.write("sheet.off", off([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)],
                                    [[0, 1, 2]]))
        report = self.voxelize("box.off", "sheet.off", "--resolution", 20, "--grid", "material",
                               status=1)
        self.assertEqual([w["code"] for w in report["warnings"]], ["no-voxels"])
        self.assertIn("sheet.off", report["warnings"][0]["text"])

    def test_sheet(self):
        self.write("sheet.off", off([(0.0, 0.0, 0.0), (1.0, 0.0, 0.0), (1.0, 1.0, 0.0)],
                                    [[0, 1, 2]]))
        for mesher in ("auto", "envelope", "winding"):
            self.refuse(3, "voxelize", "sheet.off", "-o", "out.vdb", "--mesher", mesher,
                        says="--shell")
        self.refuse(3, "voxelize", "sheet.off", "-o", "out.vdb", "--grid", "tet_id")
        report = self.voxelize("sheet.off", "--allow-empty")
        self.assertEqual(report["grids"][0]["active_voxels"], 0)

    def test_out_of_time(self):
        self.write("ball.off", off(*sphere(120)))
        options = ("--resolution", 100, "--epsilon", "2e-5d")
        for seconds in (4, 2, 1):
            result = self.run_program("voxelize", "ball.off", "-o", "out.vdb", *options,
                                      "--max-time", seconds, "--json", "-")
            if result.status == 0:
                continue # meshed in time
            self.assertEqual(result.status, 1, result.err)
            report = result.report()
            self.assertEqual(report["mesh"]["mesher"]["method"], "winding")
            self.assertIn("time", report["mesh"]["mesher"]["why"])
            self.assertEqual([w["code"] for w in report["warnings"]], ["fell-back"])
            self.assertEqual([s["name"] for s in report["stages"]],
                             ["read", "clean", "tetrahedralize", "voxelize", "write"])
            found = self.hash_of("out.vdb")
            self.voxelize("ball.off", "--resolution", 100, "--mesher", "winding")
            self.assertEqual(self.hash_of("out.vdb"), found)
            return
        self.fail("the mesher was always in time")

    def test_triangles_that_cut_one_another_into_too_many_tets(self):
        """Where insertion takes too long, and where it ends in time, but leaves tets and boundary edges
        that take as long."""
        points, faces = ball(10, 1.0, (0, 0, 0))
        numbers = random.Random(4)
        for i in range(400):
            faces.append([len(points) + k for k in range(3)])
            points += [tuple(numbers.uniform(-1, 1) for _ in range(3)) for _ in range(3)]
        for count in (400, 200) if SCALE > 1 else (200,):  # each takes many seconds
            few = len(faces) - 400 + count
            self.write("soup.off", off(points[:max(max(f) for f in faces[:few]) + 1], faces[:few]))
            report = self.voxelize("soup.off", "--resolution", 64, "--mesher", "envelope", status=1)
            self.assertEqual(report["mesh"]["mesher"]["method"], "winding", count)
            self.assertIn("tets", report["mesh"]["mesher"]["why"])
            self.assertIn("fell-back", [w["code"] for w in report["warnings"]])

    def test_tets_asked_for_and_out_of_time(self):
        self.write("ball.off", off(*sphere(120)))
        # A share of what no machine meshes it in, and more than reading it takes.
        self.refuse(5, "voxelize", "ball.off", "-o", "out.vdb", "--resolution", 100, "--epsilon",
                    "2e-5d", "--grid", "tet_id", "--max-time", 0.3, says="time limit")

    def test_options_that_exclude_each_other(self):
        self.write("box.mesh", medit(*lattice(1)))
        for options in (("--mesher", "winding", "--epsilon", "1e-3d"),
                        ("--mesher", "winding", "--grid", "tet_id"),
                        ("--mesher", "winding", "--write-mesh", "out.msh"),
                        ("--mesher", "envelope", "--shell", "0.1"),
                        ("--mesher", "envelope", "--inside", "flood"),
                        ("--shell", "0.1", "--grid", "tet_id"),
                        ("--inside", "parity", "--epsilon", "1v")):
            self.refuse(2, "voxelize", "box.off", "-o", "out.vdb", *options, says="--")
        for epsilon in ("0", "-1v", "nan", "1 v", "v"):
            self.refuse(2, "voxelize", "box.off", "-o", "out.vdb", "--epsilon=" + epsilon,
                        says="--epsilon")
        self.refuse(2, "voxelize", "box.mesh", "-o", "out.vdb", "--epsilon", "1v",
                    says="--epsilon")
        self.refuse(2, "voxelize", "box.mesh", "-o", "out.vdb", "--mesher", "envelope",
                    says="--mesher")


if __name__ == "__main__":
    unittest.main(verbosity=2)
