# SPDX-License-Identifier: Apache-2.0
"""Volumes that are streamed, and shards of them: the bytes of one process, in bounded memory."""

import json
import math
import os
import random
import re
import resource
import signal
import subprocess
import time
import unittest

from program import PROGRAM, SANITIZED, SCALE, CommandLineTest, box_faces, off


def ball(radius, n, centre=(0, 0, 0)):
    points, faces = [(0, 0, 1)], []
    for r in range(1, n):
        for s in range(2 * n):
            a, b = math.pi * r / n, math.pi * s / n
            points.append((math.sin(a) * math.cos(b), math.sin(a) * math.sin(b), math.cos(a)))
    points.append((0, 0, -1))
    at = lambda r, s: 1 + (r - 1) * 2 * n + s % (2 * n)
    for s in range(2 * n):
        faces.append((0, at(1, s), at(1, s + 1)))
        faces.append((len(points) - 1, at(n - 1, s + 1), at(n - 1, s)))
        for r in range(1, n - 1):
            faces += [(at(r, s), at(r + 1, s), at(r + 1, s + 1)), (at(r, s), at(r + 1, s + 1), at(r, s + 1))]
    return [tuple(radius * c + o for c, o in zip(p, centre)) for p in points], faces


def rod(length, width):
    """A box that is turned: it passes through several cubes of 4096^3."""
    points, faces = box_faces()
    turned = []
    for x, y, z in points:
        x, y, z = x * length, y * width, z * width
        turned.append((x * 0.8 - y * 0.6 - 4600, x * 0.48 + y * 0.64 - z * 0.6 - 4000,
                       x * 0.36 + y * 0.48 + z * 0.8 - 3000))
    return turned, faces


def tet_bar(cells, size):
    """Gmsh's text of cubes in a row, six tets each, turned: it passes through several cubes of 4096^3."""
    points = [(i * size, j * size, k * size) for i in range(cells + 1) for j in range(2) for k in range(2)]
    turned = [(x * 0.8 - y * 0.6 - 1800, x * 0.48 + y * 0.64 - z * 0.6 - 1000, x * 0.36 + y * 0.48 + z * 0.8 - 500)
              for x, y, z in points]
    tets = []
    for i in range(cells):
        at = lambda a, j, k: 4 * (i + a) + 2 * j + k + 1
        for p in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
            corner, path = [0, 0, 0], [at(0, 0, 0)]
            for axis in p:
                corner[axis] = 1
                path.append(at(*corner))
            tets.append(path)
    return "\n".join(["$MeshFormat", "2.2 0 8", "$EndMeshFormat", "$Nodes", str(len(turned))] +
                     ["%d %r %r %r" % (n + 1, *p) for n, p in enumerate(turned)] +
                     ["$EndNodes", "$Elements", str(len(tets))] +
                     ["%d 4 2 %d %d %d %d %d %d" % (n + 1, n % 3 + 1, n % 3 + 1, *t) for n, t in enumerate(tets)] +
                     ["$EndElements", ""])


def parts_of(report):
    """Names of the parts of a report's stages."""
    return {part["name"] for stage in report["stages"] for part in stage.get("parts", ())}


def peak_of(test, *arguments, ends=0):
    """Of the program's resident memory, in bytes; it ends with this status."""
    done = subprocess.run(["/usr/bin/env", "python3", "-c", """
import resource, subprocess, sys
status = subprocess.run(sys.argv[1:], stdout=subprocess.DEVNULL).returncode
print(status, resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss * 1024)""", PROGRAM,
                           *map(str, arguments)], cwd=test.folder, capture_output=True, text=True)
    status, peak = map(int, done.stdout.split())
    test.assertEqual(status, ends, done.stderr)
    return peak


def beside_program(test, megabytes):
    """A limit that leaves so much beside what the program takes as it starts, which depends on OpenVDB's build."""
    return "%dM" % (peak_of(test, "--version") / 1e6 + megabytes)


def writes(folder, process):
    """Whether it has a file in this folder open that is none of the inputs."""
    try:
        open_files = [os.readlink(f"/proc/{process.pid}/fd/{n}")
                      for n in os.listdir(f"/proc/{process.pid}/fd")]
    except OSError:  # closed meanwhile
        return False
    return any(name.startswith(f"{folder}/") and not name.endswith((".off", ".msh", ".vtu"))
               for name in open_files)


def stop_while_it_writes(test, grid):
    """Ends a shard of large.off by SIGTERM; nothing may be left."""
    before = sorted(os.listdir(test.folder))
    process = subprocess.Popen([PROGRAM, "voxelize", "large.off", "-o", "out.vdb", "--voxel-size", "1",
                                "--grid", grid, "--shard", "1/2"], cwd=test.folder,
                               stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    deadline = time.monotonic() + 60
    while not writes(test.folder, process) and time.monotonic() < deadline:
        time.sleep(0.02)
    test.assertTrue(writes(test.folder, process))
    process.send_signal(signal.SIGTERM)
    test.assertEqual(process.wait(60), 5)
    test.assertEqual(sorted(os.listdir(test.folder)), before)


class Streams(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("ball.off", off(*ball(1000, 60)))
        self.write("rod.off", off(*rod(9000, 60)))

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_budgets(self):
        options = ("ball.off", "--voxel-size", "1", "--grid", "density")
        self.succeed("voxelize", *options, "-o", "trees.vdb")
        expected = self.path("trees.vdb").read_bytes()
        for budget in (128, 200):  # trees take 450 MB
            peak = peak_of(self, "voxelize", *options, "-o", "out.vdb", "--max-memory", "%dM" % budget)
            self.assertLess(peak, budget << 20)
            self.assertTrue(self.path("out.vdb").read_bytes() == expected, budget)

    def test_a_full_disk_leaves_nothing(self):
        before = sorted(os.listdir(self.folder))

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (3 << 20, 3 << 20))

        result = self.run_program("voxelize", "ball.off", "-o", "out.vdb", "--voxel-size", "1", "--grid", "mask",
                                  "--shard", "0/1", preexec_fn=limit)
        self.assertEqual(result.status, 7, result.err)
        result = self.run_program("voxelize", "ball.off", "-o", "out.vdb", "--voxel-size", "1", "--grid", "mask",
                                  "--shard", "0/2", preexec_fn=limit)
        self.assertEqual(result.status, 7, result.err)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_a_signal_leaves_nothing(self):
        self.write("large.off", off(*ball(8000, 60)))
        stop_while_it_writes(self, "mask")

    def test_mask_type(self):
        types = {}
        for name in ("bool", "mask"):
            report = self.report_of("voxelize", "rod.off", "-o", name + ".vdb", "--voxel-size", "1", "--grid",
                                    "mask", "--mask-type", name)
            grid = report["grids"][0]
            types[name] = (b"Tree_%s_5_4_3" % name.encode() in self.path(name + ".vdb").read_bytes(),
                           grid["active_voxels"], report["output"][0]["bytes"])
        self.assertTrue(types["bool"][0] and types["mask"][0])
        self.assertEqual(types["bool"][1], types["mask"][1])
        self.assertLess(types["mask"][2], 0.75 * types["bool"][2])


    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_nanovdb(self):
        options = ("ball.off", "--voxel-size", "1.5", "--grid", "mask,density")
        self.succeed("voxelize", *options, "-o", "trees.nvdb")
        peak = peak_of(self, "voxelize", *options, "-o", "out.nvdb", "--max-memory", "200M")  # trees take 400 MB
        self.assertLess(peak, 200 << 20)
        self.assertTrue(self.path("out.nvdb").read_bytes() == self.path("trees.nvdb").read_bytes())
        self.succeed("voxelize", *options, "-o", "trees.vdb")
        self.succeed("compare", "trees.vdb", "out.nvdb")

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_convert(self):
        options = ("ball.off", "--voxel-size", "3", "--grid", "mask,surface")
        for name in ("a.vdb", "a.nvdb"):
            self.succeed("voxelize", *options, "-o", name)
        self.succeed("compare", "a.vdb", "a.nvdb")
        for source in ("a.vdb", "a.nvdb"):  # trees take 400 MB
            for target in ("out.vdb", "out.nvdb"):
                peak = peak_of(self, "convert", source, "-o", target, "--max-memory", "150M")
                self.assertLess(peak, 150 << 20, (source, target))
                if source == "a.vdb" or target == "out.nvdb":  # .nvdb files have no metadata
                    same = self.path(target.replace("out", "a"))
                    self.assertTrue(self.path(target).read_bytes() == same.read_bytes(), (source, target))
                else:
                    self.succeed("compare", "a.vdb", target)
        self.assertEqual(sorted(os.listdir(self.folder)),
                         ["a.nvdb", "a.vdb", "ball.off", "out.nvdb", "out.vdb", "rod.off"])

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_convert_says_what_it_takes(self):
        self.succeed("voxelize", "ball.off", "-o", "a.vdb", "--voxel-size", "2", "--grid", "mask,surface")
        self.succeed("convert", "a.vdb", "-o", "a.nvdb")
        for source in ("a.vdb", "a.nvdb"):
            refused = self.refuse(4, "convert", source, "-o", "b.nvdb", "--max-memory", "70M", "--threads", "2",
                                  says=(source, "part by part", "--max-memory"))
            least = int(re.search(r"takes (\d+) MB", refused.err).group(1)) + 4  # resident memory varies
            peak = peak_of(self, "convert", source, "-o", "b.nvdb", "--max-memory", "%d" % (least * 10**6),
                           "--threads", "2")
            self.assertLess(peak, least * 10**6, source)
        self.succeed("voxelize", "ball.off", "-o", "small.vdb", "--voxel-size", "40", "--grid", "mask")
        self.succeed("convert", "small.vdb", "-o", "small.nvdb", "--max-memory", "70M")

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_levels_stream(self):
        self.write("far.off", off(*ball(1500, 60)))
        options = ("far.off", "--voxel-size", "5", "--grid", "density,coverage", "--lod", "1:6", "--threads", "2")
        self.assertNotIn("stream", parts_of(self.report_of("voxelize", *options, "-o", "trees.vdb")))
        limit = ("--max-memory", beside_program(self, 165))  # trees take 115 MB, and with their levels 215
        self.assertIn("stream", parts_of(self.report_of("voxelize", *options, "-o", "out.vdb", *limit)))
        self.assertTrue(self.path("out.vdb").read_bytes() == self.path("trees.vdb").read_bytes())
        self.assertLess(peak_of(self, "voxelize", *options, "-o", "out.vdb", *limit), int(limit[1][:-1]) * 10**6)

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_check_reads_by_parts(self):
        self.succeed("voxelize", "rod.off", "-o", "out.vdb", "--voxel-size", "1", "--grid", "density,surface")
        peak = peak_of(self, "check", "out.vdb", ends=8)  # 9000 m long; whole trees take 320 MB
        self.assertLess(peak, 220 << 20)

    def test_what_nanovdb_cannot_hold(self):
        before = sorted(os.listdir(self.folder))
        for options, words in ((("--shard", "0/2"), "--shard: is for .vdb files"),
                               (("--mask-type", "mask"), "--mask-type: is for .vdb files")):
            result = self.run_program("voxelize", "ball.off", "-o", "out.nvdb", "--voxel-size", "1", "--grid", "mask",
                                      *options)
            self.assertEqual(result.status, 2, result.err)
            self.assertIn(words, result.err)
        self.assertEqual(sorted(os.listdir(self.folder)), before)


class ValuesStream(CommandLineTest):
    """Grids of other values than inside and outside."""

    GRIDS = ("surface", "fog", "coverage")

    def setUp(self):
        super().setUp()
        self.write("ball.off", off(*ball(300, 40)))
        self.write("rod.off", off(*rod(9000, 15)))
        self.write("tets.msh", tet_bar(90, 40))

    def expect_same(self, source, *grids, parts=3, more=(), size="1"):
        options = (source, "--voxel-size", size, "--grid", ",".join(grids), *more)
        self.succeed("voxelize", *options, "-o", "trees.vdb")
        expected = self.path("trees.vdb").read_bytes()
        for i in range(parts):
            self.succeed("voxelize", *options, "-o", "part.vdb", "--shard", "%d/%d" % (i, parts), "--threads", 1 + i)
        self.succeed("merge", *("part.%d-of-%d.vdb" % (i, parts) for i in range(parts)), "-o", "merged.vdb")
        self.assertTrue(self.path("merged.vdb").read_bytes() == expected, grids)

    def test_shards_of_any_grid(self):
        alone = (("surface",),) if SCALE > 1 else ()
        for grids in (*alone, ("fog", "mask"), ("coverage", "density", "surface")):
            self.expect_same("rod.off", *grids)

    def test_shards_of_tets(self):
        self.expect_same("tets.msh", "tet_id", "material", "surface")

    def test_levels_of_shards(self):
        # --half: parts have what is rounded when all voxels of a node are known.
        self.expect_same("rod.off", "fog", "coverage", "mask", more=("--lod", "1:12", "--half"))

    def test_levels_of_shards_of_arrays(self):
        points = [" ".join("%r" % (8000.0 * c - 4000) for c in p)
                  for p in ((0, 0, 0), (1, 0.01, 0), (1, 0, 0.01), (0.99, 0.01, 0.02))]
        self.write("needle.vtk", "# vtk DataFile Version 3.0\nneedle\nASCII\nDATASET UNSTRUCTURED_GRID\n"
                   "POINTS 4 double\n%s\nCELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\nPOINT_DATA 4\n"
                   "SCALARS heat float 1\nLOOKUP_TABLE default\n1 2 3 4.5\n"
                   "VECTORS flow float\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n" % "\n".join(points))
        self.expect_same("needle.vtk", "heat", "flow", "density", more=("--lod", "2:9"))

    def test_shards_of_materials(self):
        self.write("other.off", off(*ball(200, 30, (4000, 20, 0))))
        options = ("ball.off", "other.off", "--voxel-size", "1", "--grid", "material,density")
        self.succeed("voxelize", *options, "-o", "trees.vdb")
        for i in range(2):
            self.succeed("voxelize", *options, "-o", "part.vdb", "--shard", "%d/2" % i)
        self.succeed("merge", "part.0-of-2.vdb", "part.1-of-2.vdb", "-o", "merged.vdb")
        self.assertTrue(self.path("merged.vdb").read_bytes() == self.path("trees.vdb").read_bytes())

    def test_shards_of_open_meshes(self):
        points, faces = ball(300, 40)
        self.write("open.off", off([(x, y + 4096, z) for x, y, z in points], faces[80:]))
        self.expect_same("open.off", "surface", parts=2)

    def test_a_whole_box(self):
        points, faces = ball(30, 12, (30, -20, 4096))
        self.write("closed.off", off(points, faces))
        self.write("open.off", off(points, faces[48:]))
        self.write("short.msh", tet_bar(5, 20))
        for source, grids in (("closed.off", ("surface",)), ("open.off", ("surface", "density")),
                              ("short.msh", ("tet_id", "coverage", "surface"))):
            self.expect_same(source, *grids, parts=2, more=("--half-width", "all"))
        # Where the box reaches into root children that no face is near, and deepest inside.
        self.expect_same("rod.off", "surface", parts=3, size="40", more=("--half-width", "all"))
        points, faces = ball(110, 20, (30, -20, 4096))
        self.write("open.off", off(points, faces[40:]))
        options = ("open.off", "--voxel-size", "1", "--grid", "surface", "--half-width", "all")
        for name in ("trees.vdb", "trees.nvdb"):
            self.succeed("voxelize", *options, "-o", name)
            self.expect_streamed(beside_program(self, 65), name, *options, "--threads", "1")

    def expect_streamed(self, limit, trees, *options):
        """By this limit, within it, and with the bytes of `trees`."""
        out = "out" + trees[5:]
        peak = peak_of(self, "voxelize", *options, "-o", out, "--max-memory", limit, "--json", "report.json")
        self.assertIn("stream", parts_of(json.loads(self.path("report.json").read_text())))
        self.assertTrue(self.path(out).read_bytes() == self.path(trees).read_bytes(), (trees, limit))
        if not SANITIZED:
            self.assertLess(peak, int(limit[:-1]) << 20)

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_a_limit_streams(self):
        options = ("ball.off", "--voxel-size", "0.5", "--grid", "surface")
        trees = self.report_of("voxelize", *options, "-o", "trees.vdb")
        self.assertNotIn("stream", parts_of(trees))
        self.expect_streamed("120M", "trees.vdb", *options)  # trees take 700 MB

    def test_a_full_disk_leaves_nothing(self):
        before = sorted(os.listdir(self.folder))

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (3 << 20, 3 << 20))

        for shard in ("0/1", "0/2"):
            result = self.run_program("voxelize", "ball.off", "-o", "out.vdb", "--voxel-size", "0.5", "--grid",
                                      "surface", "--shard", shard, preexec_fn=limit)
            self.assertEqual(result.status, 7, result.err)
        self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_a_signal_leaves_nothing(self):
        self.write("large.off", off(*ball(3000, 60)))
        stop_while_it_writes(self, "surface")

    def test_one_progress_over_all_passes(self):
        points, faces = ball(300, 40)
        self.write("open.off", off(points, faces[:-9]))
        for name, size, grids in (("ball.off", "0.5", "surface,fog"), ("open.off", "0.8", "surface,fog"),
                                  ("ball.off", "0.2", "mask")):
            result = self.run_program("voxelize", name, "-o", "out.vdb", "--voxel-size", size, "--grid", grids,
                                      "--max-memory", "200M", "-v")
            self.assertIn(result.status, (0, 1), result.err)  # an open mesh
            lines = result.err.splitlines()
            steps = [step for step in (re.fullmatch(r"tetvdb: ([a-z]+)(?: (\d+) %.*)?", line) for line in lines) if step]
            self.assertEqual([step[1] for step in steps if step[2] is None], ["read", "clean", "voxelize", "stream"])
            percents = [int(step[2]) for step in steps if step[2] is not None]
            self.assertEqual(percents, sorted(set(percents)))
            self.assertLessEqual(percents[-1], 100)
            if grids != "mask":  # seconds long: a plan with "fields" and "write" would end at half
                self.assertGreater(percents[-1], 60)

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_what_does_not_fit_is_refused(self):
        self.refuse(4, "voxelize", "ball.off", "-o", "out.vdb", "--voxel-size", "0.5", "--grid", "surface,fog,coverage",
                    "--max-memory", "40M", says=("--max-memory",))
        self.assertFalse(self.path("out.vdb").exists())


class Shards(CommandLineTest):
    OPTIONS = ("--voxel-size", "1", "--grid", "mask,density")
    one = None  # the whole volume: made by the first test

    def setUp(self):
        super().setUp()
        self.write("rod.off", off(*rod(9000, 60)))
        if Shards.one is None:
            self.succeed("voxelize", "rod.off", "-o", "one.vdb", *self.OPTIONS)
            Shards.one = self.path("one.vdb").read_bytes()
        self.write("one.vdb", self.one)

    def shard(self, index, count, *more, status=0):
        return self.succeed("voxelize", "rod.off", "-o", "part.vdb", *self.OPTIONS, "--shard",
                            "%d/%d" % (index, count), *more, status=status)

    def parts(self, count):
        return ["part.%d-of-%d.vdb" % (i, count) for i in range(count)]

    def test_any_number_in_any_order(self):
        for count in (3, 16) if SCALE > 1 else (5,):
            order = list(range(count))
            random.Random(count).shuffle(order)
            for i in order:
                self.shard(i, count, "--threads", 1 + i % 2)
            names = self.parts(count)
            random.Random(-count).shuffle(names)
            self.succeed("merge", *names, "-o", "merged.vdb")
            self.assertTrue(self.path("merged.vdb").read_bytes() == self.one, count)

    def test_levels(self):
        levels = ("--lod", "1:12")
        self.succeed("voxelize", "rod.off", "-o", "one.vdb", *self.OPTIONS, *levels)
        one = self.path("one.vdb").read_bytes()
        for count in (1, 7) if SCALE > 1 else (7,):
            order = list(range(count))
            random.Random(count).shuffle(order)
            for i in order:
                self.shard(i, count, *levels, "--threads", 1 + i % 2)
            names = self.parts(count) if count > 1 else ["part.vdb"]
            if count > 1:
                random.Random(-count).shuffle(names)
                self.succeed("merge", *names, "-o", "merged.vdb")
            self.assertTrue(self.path("merged.vdb" if count > 1 else names[0]).read_bytes() == one, count)
        # A part can be used as it is: voxels of a level that no other part has.
        grids = {g["name"]: g["active_voxels"] for g in self.report_of("info", "one.vdb")["input"][0]["grids"]}
        found = dict.fromkeys(grids, 0)
        for name in self.parts(7):
            for grid in self.report_of("info", name)["input"][0]["grids"]:
                found[grid["name"]] += grid["active_voxels"]
        self.assertEqual(found, grids)
        self.shard(0, 7)  # has no levels
        self.refuse(3, "merge", *self.parts(7), "-o", "m.vdb", says=("part.",))
        self.shard(0, 7, "--lod", "1:3")
        self.refuse(3, "merge", *self.parts(7), "-o", "m.vdb", says=("another volume",))

    def test_levels_of_tiles_alone(self):
        points, faces = box_faces()
        self.write("box.off", off([(x * 12288 - 0.5, y * 4096 - 0.5, z * 4096 - 0.5) for x, y, z in points], faces))
        options = (*self.OPTIONS, "--lod", "1:12")
        self.succeed("voxelize", "box.off", "-o", "one.vdb", *options, "--shard", "0/1")
        for i in range(3):
            self.succeed("voxelize", "box.off", "-o", "tile.vdb", *options, "--shard", "%d/3" % i)
        self.succeed("merge", *("tile.%d-of-3.vdb" % i for i in range(3)), "-o", "merged.vdb")
        self.assertTrue(self.path("merged.vdb").read_bytes() == self.path("one.vdb").read_bytes())

    def test_parts_are_volumes(self):
        whole = self.report_of("info", "one.vdb")["input"][0]["grids"][0]["active_voxels"]
        for i in range(3):
            self.shard(i, 3)
        parts = [self.report_of("info", name)["input"][0]["grids"][0]["active_voxels"] for name in self.parts(3)]
        self.assertEqual(sum(parts), whole)

    def test_one_killed_and_run_again(self):
        self.shard(0, 2)
        process = subprocess.Popen([PROGRAM, "voxelize", "rod.off", "-o", "part.vdb", *self.OPTIONS, "--shard",
                                    "1/2"], cwd=self.folder, stderr=subprocess.DEVNULL)
        time.sleep(0.05)
        process.kill()
        process.wait()
        self.shard(1, 2)
        self.succeed("merge", *self.parts(2), "-o", "merged.vdb")
        self.assertTrue(self.path("merged.vdb").read_bytes() == self.one)

    def test_tiles_alone(self):
        points, faces = box_faces()
        self.write("box.off", off([tuple(c * 4096 - 0.5 for c in p) for p in points], faces))
        self.succeed("voxelize", "box.off", "-o", "one.vdb", *self.OPTIONS)
        for i in range(2):
            self.succeed("voxelize", "box.off", "-o", "tile.vdb", *self.OPTIONS, "--shard", "%d/2" % i)
        self.succeed("merge", "tile.0-of-2.vdb", "tile.1-of-2.vdb", "-o", "merged.vdb")
        self.succeed("compare", "one.vdb", "merged.vdb")
        self.assertEqual(self.succeed("info", "one.vdb", "--hash").out.split()[-1],
                         self.succeed("info", "merged.vdb", "--hash").out.split()[-1])

    def test_what_is_wrong_is_refused_by_name(self):
        for i in range(3):
            self.shard(i, 3)
        names = self.parts(3)
        self.refuse(3, "merge", *names[:2], "-o", "m.vdb", says=("2/3",))
        self.refuse(3, "merge", *names, names[1], "-o", "m.vdb", says=(names[1],))
        self.refuse(3, "merge", names[0], "one.vdb", "-o", "m.vdb", says=("one.vdb",))
        self.succeed("voxelize", "rod.off", "-o", "other.vdb", "--voxel-size", "1.25", "--grid", "mask,density",
                     "--shard", "2/3")
        self.refuse(3, "merge", *names[:2], "other.2-of-3.vdb", "-o", "m.vdb", says=("other.2-of-3.vdb",))
        whole = self.path(names[1]).read_bytes()
        for size in (len(whole) - 1, len(whole) // 2, 2000, 100, 10, 0):
            self.write("cut.vdb", whole[:size])
            self.refuse(3, "merge", names[0], "cut.vdb", names[2], "-o", "m.vdb", says=("cut.vdb",))
        self.write("rod.mesh", "MeshVersionFormatted 2\nDimension 3\n")
        self.refuse(3, "merge", "rod.mesh", "-o", "m.vdb", says=("rod.mesh",))
        self.refuse(3, "merge", "absent.vdb", "-o", "m.vdb", says=("absent.vdb", "No such file"))

    def test_what_cannot_be_a_shard(self):
        for options in (("-o", "a.vdb", "--preview", "a.png"), ("-o", "a.vdb", "--inside", "flood"), ("-o", "a.nvdb"), ("-o", "a.npz"),
                        ("-o", "a.vdb", "--shell", "3"), ("-o", "a.vdb", "--mesher", "envelope"),
                        ("-o", "a.vdb", "--grid", "surface", "--device", "cuda"),
                        ("-o", "a.vdb", "--rule", "any", "--device", "cuda"), ("-o", "a.vdb", "--device", "cuda:0,1")):
            self.refuse(2, "voxelize", "rod.off", "--voxel-size", "1", "--shard", "0/2", *options,
                        says=("--shard",))
        self.write("rod_1.off", off(*rod(900, 60)))
        self.write("rod_2.off", off(*rod(900, 60)))
        self.refuse(2, "voxelize", "rod_1.off", "rod_2.off", "-o", "a.vdb", "--voxel-size", "1", "--shard", "0/2",
                    says=("--shard", "sequence"))
        for shard in ("2/2", "-1/2", "1", "auto"):
            self.refuse(2, "voxelize", "rod.off", "-o", "a.vdb", "--voxel-size", "1", "--shard", shard,
                        says=("--shard",))

    def test_plan(self):
        shards = self.report_of("plan", "rod.off", "--shards", "4", *self.OPTIONS)["shards"]
        self.assertEqual(len(shards), 4)
        self.assertAlmostEqual(sum(s["share"] for s in shards), 1)
        self.assertTrue(all(s["root_children"] >= s["full"] >= 0 for s in shards))
        self.assertGreaterEqual(sum(s["root_children"] for s in shards), 4)
        text = self.succeed("plan", "rod.off", "--shards", "4", *self.OPTIONS).out
        self.assertEqual(len(text.splitlines()), 5)
        self.assertIn("root children", text)
        # What is planned is what is made.
        low, high = [], []
        for i, planned in enumerate(shards):
            self.shard(i, 4)
            grid = self.report_of("info", "part.%d-of-4.vdb" % i)["input"][0]["grids"][0]
            if grid["active_voxels"] == 0:
                continue
            self.assertTrue(all(a <= b for a, b in zip(planned["box"]["min"], grid["box"]["min"])), grid)
            self.assertTrue(all(a >= b for a, b in zip(planned["box"]["max"], grid["box"]["max"])), grid)

    def test_tasks_of_launchers(self):
        for i in range(2):
            self.succeed("voxelize", "rod.off", "-o", "part.vdb", *self.OPTIONS, "--shard", "auto",
                         env={**os.environ, "SLURM_ARRAY_TASK_ID": str(5 + i), "SLURM_ARRAY_TASK_MIN": "5",
                              "SLURM_ARRAY_TASK_COUNT": "2", "SLURM_PROCID": "0"})
        self.succeed("merge", *self.parts(2), "-o", "merged.vdb")
        self.assertTrue(self.path("merged.vdb").read_bytes() == self.one)


if __name__ == "__main__":
    unittest.main()
