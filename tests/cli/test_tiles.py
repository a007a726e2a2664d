# SPDX-License-Identifier: Apache-2.0
"""Volumes as folders of tiles, and levels of detail, against numpy and OpenVDB's own Python module."""

import ctypes
import ctypes.util
import itertools
import json
import os
import resource
import shutil
import signal
import subprocess
import sys
import time
import unittest

try:
    import numpy
    import pyopenvdb
except ImportError as missing:
    print("skipped:", missing)
    sys.exit(77)

from program import PROGRAM, SANITIZED, CommandLineTest, ball, box_faces, joined, lattice, off
from test_fields import vtu_with
from test_huge import parts_of, peak_of, rod

SIZES = (512, 1024, 2048, 4096)


def aligned_box(low, high):
    """Whose voxels of size 1 are those from `low` to `high` - 1."""
    return box_faces([c - 0.5 for c in low], [c - 0.5 for c in high])


def xxh128(data):
    """As the program xxh128sum prints it."""
    class Hash(ctypes.Structure):
        _fields_ = [("low", ctypes.c_uint64), ("high", ctypes.c_uint64)]
    function = ctypes.CDLL(ctypes.util.find_library("xxhash") or "libxxhash.so.0").XXH3_128bits
    function.restype, function.argtypes = Hash, [ctypes.c_char_p, ctypes.c_size_t]
    value = function(data, len(data))
    return "%016x%016x" % (value.high, value.low)


def dense(grid, low, shape):
    """Values, inactive ones as they are."""
    array = numpy.zeros(shape, bool if grid.valueTypeName == "bool" else numpy.float32)
    grid.copyToArray(array, ijk=tuple(low))
    return array


class Volumes(CommandLineTest):
    def grids(self, name):
        return {grid.name: grid for grid in pyopenvdb.readAll(str(self.path(name)))[0]}

    def contents(self, folder):
        return {path.name: path.read_bytes() for path in self.path(folder).iterdir()}

    def tiles(self, folder):
        return json.loads(self.path(folder + "/tiles.json").read_text())


class Tiles(Volumes):
    OPTIONS = ("--voxel-size", "1")

    def check_index(self, folder, whole, size):
        """What tiles.json says against the files, their boxes and numbers of voxels against the whole
        volume's: the tiles' grids by name."""
        index, names = self.tiles(folder), self.grids(whole)
        self.assertEqual((index["tiles_version"], index["tile_size"]), (1, size))
        self.assertEqual({grid["name"] for grid in index["grids"]}, set(names))
        self.assertEqual([tile["file"] for tile in index["tiles"]],
                         ["tile_%d.vdb" % i for i in range(len(index["tiles"]))])
        self.assertEqual({path.name for path in self.path(folder).iterdir()},
                         {"tiles.json", *(tile["file"] for tile in index["tiles"])})
        corners = set()
        parts = {name: [] for name in names}
        for tile in index["tiles"]:
            low, high = tile["box"]["min"], tile["box"]["max"]
            self.assertTrue(all(a % size == 0 and b == a + size - 1 for a, b in zip(low, high)))
            corners.add(tuple(low))
            data = self.path(folder + "/" + tile["file"]).read_bytes()
            self.assertEqual((tile["bytes"], tile["xxh128"]), (len(data), xxh128(data)))
            grids = self.grids(folder + "/" + tile["file"])
            self.assertEqual(set(grids), set(names))
            for own in tile["grids"]:
                grid, all_of_it = grids[own["name"]], names[own["name"]]
                self.assertEqual(grid.activeVoxelCount(), own["active_voxels"])
                self.assertEqual(grid.gridClass, all_of_it.gridClass)
                self.assertEqual(grid.background, all_of_it.background)
                for point in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)):
                    self.assertEqual(grid.transform.indexToWorld(point),
                                     all_of_it.transform.indexToWorld(point))
                if own["active_voxels"]:
                    box = grid.evalActiveVoxelBoundingBox()
                    self.assertEqual([list(c) for c in box], [own["box"]["min"], own["box"]["max"]])
                    self.assertTrue(all(a <= b for a, b in zip(low, box[0])))
                    self.assertTrue(all(a >= b for a, b in zip(high, box[1])))
                parts[own["name"]].append(grid)
        self.assertEqual(len(corners), len(index["tiles"]))
        for grid in index["grids"]:
            name = grid["name"]
            self.assertEqual(grid["active_voxels"], names[name].activeVoxelCount())
            matrix = numpy.array(grid["index_to_world"])
            for point in ((3, 5, 7), (-1000, 0, 20)):
                self.assertTrue(numpy.allclose((matrix @ [*point, 1])[:3],
                                               names[name].transform.indexToWorld(point), rtol=1e-14))
            self.assertEqual(grid["active_voxels"],
                             sum(own["active_voxels"] for tile in index["tiles"] for own in tile["grids"]
                                 if own["name"] == name))
        return parts

    def assert_same_voxels(self, parts, whole):
        """As many active ones, each where the whole volume has it."""
        self.assertEqual(sum(part.activeVoxelCount() for part in parts), whole.activeVoxelCount())
        other = whole.getConstAccessor()
        for part in parts:
            for run in itertools.islice(part.citerOnValues(), 0, None, 7):
                for corner in (run.min, run.max):
                    self.assertEqual(other.probeValue(corner), (run.value, True))

    def test_every_size(self):
        self.write("rod.off", off(*rod(6000, 12)))
        for grids, sizes in (("mask,density", SIZES), ("surface,coverage", (1024,))):
            self.succeed("voxelize", "rod.off", "-o", "rod.vdb", *self.OPTIONS, "--grid", grids)
            for size in sizes:
                self.succeed("voxelize", "rod.off", "--tiles", "made", "--tile-size", size, *self.OPTIONS,
                             "--grid", grids)
                parts = self.check_index("made", "rod.vdb", size)
                if size != 1024:
                    continue
                for name, grid in self.grids("rod.vdb").items():
                    self.assert_same_voxels(parts[name], grid)
                # The same of the volume that is there.
                self.succeed("convert", "rod.vdb", "--tiles", "cut", "--tile-size", size)
                self.check_index("cut", "rod.vdb", size)
                by_name = lambda tile: sorted(tile["grids"], key=lambda grid: grid["name"])
                self.assertEqual(list(map(by_name, self.tiles("cut")["tiles"])),
                                 list(map(by_name, self.tiles("made")["tiles"])))
            places = [tile["box"]["min"] for tile in self.tiles("made")["tiles"]]
            self.assertGreater(len(places), 2)
            self.assertLess(min(min(place) for place in places), 0)

    def test_uniform_tiles(self):
        """Nodes without leaves: of 4096^3, of 128^3, and both."""
        for name, low, high in (("large", (-4096, 0, 4096), (4096, 4096, 8192)),
                                ("small", (-128, 0, 896), (640, 256, 1152)),
                                ("leaves", (-8, 504, 0), (8, 520, 8))):
            self.write(name + ".off", off(*aligned_box(low, high)))
            self.succeed("voxelize", name + ".off", "-o", name + ".vdb", *self.OPTIONS)
            voxels = numpy.prod([b - a for a, b in zip(low, high)])
            for size in (2048, 4096) if name == "large" else SIZES:
                self.succeed("voxelize", name + ".off", "--tiles", name, "--tile-size", size, *self.OPTIONS)
                parts, = self.check_index(name, name + ".vdb", size).values()
                self.assertEqual(sum(part.activeVoxelCount() for part in parts), voxels)
                self.assertEqual(self.tiles(name)["grids"][0]["box"],
                                 {"min": list(low), "max": [c - 1 for c in high]})
                cubes = numpy.prod([-(-b // size) - a // size for a, b in zip(low, high)])
                self.assertEqual(len(self.tiles(name)["tiles"]), cubes)
                # Blender draws nothing of a grid without leaves.
                for tile in self.tiles(name)["tiles"]:
                    grid, = self.grids(name + "/" + tile["file"]).values()
                    self.assertGreater(grid.leafCount(), 0)

    def test_a_level_set_keeps_its_inside(self):
        self.write("ball.off", off(*ball(24, 700, (0, 0, 0))))
        self.succeed("voxelize", "ball.off", "--tiles", "ball", "--tile-size", 512, *self.OPTIONS, "--grid",
                     "surface")
        for tile in self.tiles("ball")["tiles"]:
            grid, = self.grids("ball/" + tile["file"]).values()
            reader = grid.getConstAccessor()
            for corner in itertools.product((40, 470), repeat=3):
                at = tuple(a + b for a, b in zip(tile["box"]["min"], corner))
                distance = sum(c * c for c in at) ** 0.5 - 700
                if abs(distance) > 20:
                    self.assertAlmostEqual(reader.getValue(at), 3 if distance > 0 else -3)

    def test_threads(self):
        self.write("balls.off", off(*joined(ball(20, 300, (-100, 50, 4000)), ball(16, 200, (150, 0, 4200)))))
        made = []
        for threads in (1, 2, 8):
            self.succeed("voxelize", "balls.off", "--tiles", "t", "--tile-size", 512, *self.OPTIONS, "--grid",
                         "mask,density", "--threads", threads)
            made.append(self.contents("t"))
        self.assertGreater(len(made[0]), 4)
        self.assertTrue(made[0] == made[1] == made[2])

    def test_arrays_of_a_mesh(self):
        points, tets = lattice(3, origin=(-30.0, 490.0, -10.0), side=60.0)
        self.write("a.vtu", vtu_with(points, tets, [("T", [p[0] for p in points]),
                                                    ("vel", [(p[1], 0.0, 1.0) for p in points])]))
        self.succeed("voxelize", "a.vtu", "-o", "a.vdb", *self.OPTIONS, "--grid", "tet_id,T,vel")
        self.succeed("voxelize", "a.vtu", "--tiles", "a", *self.OPTIONS, "--grid", "tet_id,T,vel",
                     "--tile-size", 512)
        index = self.tiles("a")
        self.assertEqual([(g["name"], g["type"]) for g in index["grids"]],
                         [("tet_id", "int32"), ("T", "float"), ("vel", "vec3s")])
        self.assertEqual(len(index["tiles"]), 8)
        whole = self.report_of("info", "a.vdb")["input"][0]["grids"]
        self.assertEqual(index["grids"][0]["active_voxels"], whole[0]["active_voxels"])

    def test_what_is_in_the_way(self):
        self.write("box.off", off(*aligned_box((0, 0, 0), (20, 20, 20))))
        make = ("voxelize", "box.off", *self.OPTIONS)
        self.succeed(*make, "--tiles", "out")
        first = self.contents("out")
        self.succeed(*make, "--tiles", "out/") # its own tiles
        self.assertEqual(self.contents("out"), first)
        self.write("out/notes.txt", "mine")
        self.refuse(2, *make, "--tiles", "out", says="notes.txt")
        self.path("out/notes.txt").unlink()
        self.path("other").mkdir()
        self.write("other/tile_0.vdb", "mine")
        self.refuse(2, *make, "--tiles", "other", says="other")
        self.write("file", "mine")
        self.refuse(2, *make, "--tiles", "file", says="file")
        self.refuse(7, *make, "--tiles", "missing/out", says="missing/out")
        self.refuse(2, *make, "--tiles", "out.vdb", says="--tiles")
        self.refuse(2, *make, "--tiles", "new", "-o", "a.vdb", says="--tiles")
        self.refuse(2, *make, "--tiles", "new", "--shard", "0/2", says=("--tiles", "shards"))
        for size in (0, 100, 256, 8192):
            self.refuse(2, *make, "--tiles", "new", "--tile-size", size, says="--tile-size")
        self.refuse(2, *make, "-o", "a.vdb", "--tile-size", 512, says="--tiles")
        self.refuse(2, "convert", "out/tile_0.vdb", "--tiles", "out", says="tile_0.vdb")
        self.refuse(2, "convert", "box.off", "--tiles", "new", says="--tiles")
        self.refuse(2, "convert", "out/tile_0.vdb", "--tiles", "new", "--grid", "missing", says="missing")
        self.assertEqual(self.contents("out"), first)

    def test_empty(self):
        self.write("small.off", off(*ball(6, 0.1, (0.5, 0.5, 0.5))))
        self.refuse(3, "voxelize", "small.off", "--tiles", "none", *self.OPTIONS)
        self.succeed("voxelize", "small.off", "--tiles", "none", *self.OPTIONS, "--allow-empty")
        self.assertEqual(self.tiles("none")["tiles"], [])

    def test_a_full_disk_leaves_nothing(self):
        self.write("ball.off", off(*ball(40, 900, (0, 0, 0))))
        self.succeed("voxelize", "ball.off", "-o", "ball.vdb", *self.OPTIONS, "--grid", "mask")
        before = sorted(os.listdir(self.folder))

        def limit():
            resource.setrlimit(resource.RLIMIT_FSIZE, (1 << 20, 1 << 20))

        for job in (("voxelize", "ball.off", *self.OPTIONS, "--grid", "mask"), ("convert", "ball.vdb"),
                    ("voxelize", "ball.off", *self.OPTIONS, "--grid", "surface", "--max-memory", "200M")):
            for size in (512, 4096):
                result = self.run_program(*job, "--tiles", "out", "--tile-size", size, preexec_fn=limit)
                self.assertEqual(result.status, 7, result.err)
                self.assertEqual(sorted(os.listdir(self.folder)), before)

    def started_tiles(self, *options):
        """A job that has written a tile and has not ended."""
        for _ in range(5):
            process = subprocess.Popen([PROGRAM, "voxelize", *options, "--tiles", "out", *self.OPTIONS],
                                       cwd=self.folder, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            while process.poll() is None:
                try:
                    if any(self.folder.glob(".out.*/tile_*.vdb")):
                        return process
                except FileNotFoundError:  # the folder was renamed meanwhile
                    pass
                time.sleep(0.005)
            self.assertEqual(process.returncode, 0)  # it was faster than this loop
            shutil.rmtree(self.path("out"))
        self.fail("the job ends before a tile is seen")

    def test_a_signal_leaves_nothing(self):
        self.write("ball.off", off(*ball(60, 6000, (0, 0, 0))))
        self.write("small.off", off(*ball(60, 1500, (0, 0, 0))))
        before = sorted(os.listdir(self.folder))
        mask = ("ball.off", "--grid", "mask", "--tile-size", "1024")
        surface = ("small.off", "--grid", "surface", "--tile-size", "512", "--max-memory", "300M")
        for options, sent, left in ((mask, signal.SIGTERM, 0), (surface, signal.SIGTERM, 0),
                                    (mask, signal.SIGKILL, 1)):
            process = self.started_tiles(*options)
            process.send_signal(sent)
            self.assertEqual(process.wait(60), 5 if left == 0 else -signal.SIGKILL)
            now = sorted(os.listdir(self.folder))
            self.assertEqual(len(now), len(before) + left)
            self.assertNotIn("out", now)

    def expect_within(self, limit, expected, *options):
        """Streamed by this limit, within it, and the same files."""
        peak = peak_of(self, "voxelize", *options, "--tiles", "out", "--max-memory", limit, "--json", "report.json")
        self.assertIn("stream", parts_of(json.loads(self.path("report.json").read_text())))
        self.assertTrue(self.contents("out") == expected, (options, limit))
        if not SANITIZED:
            self.assertLess(peak, int(limit[:-1]) << 20)

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_a_limit_streams(self):
        self.write("ball.off", off(*ball(60, 400, (100, -200, 300))))
        for grids, size, more in (("surface,coverage", 512, ()), ("coverage,fog", 4096, ("--lod", "2:5"))):
            options = ("ball.off", *self.OPTIONS, "--grid", grids, "--tile-size", size, *more)
            trees = self.report_of("voxelize", *options, "--tiles", "trees")
            self.assertNotIn("stream", parts_of(trees))
            # Trees take 400 MB.
            self.expect_within("160M" if more else "140M", self.contents("trees"), *options)

    def test_a_limit_streams_arrays(self):
        points, tets = lattice(10, origin=(-100.0, -200.0, 400.0), side=300.0)
        self.write("a.vtu", vtu_with(points, tets, [("T", [p[0] for p in points]),
                                                    ("vel", [(p[1], 0.0, 1.0) for p in points])]))
        options = ("a.vtu", *self.OPTIONS, "--grid", "tet_id,T,vel", "--tile-size", 512)
        self.succeed("voxelize", *options, "--tiles", "trees")
        self.expect_within("300M", self.contents("trees"), *options)  # trees take 0.6 GB
        options = ("a.vtu", *self.OPTIONS, "--grid", "T", "--tile-size", 512)
        self.succeed("voxelize", *options, "--tiles", "trees")
        self.expect_within("230M", self.contents("trees"), *options)  # 110 MB, and what tiles copy of them


def shares(voxels, k):
    """Of an array of 0 and 1: the sums of its cubes of 2^k, as integers."""
    step = 1 << k
    shape = [n // step for n in voxels.shape]
    return voxels.reshape(shape[0], step, shape[1], step, shape[2], step).sum((1, 3, 5), dtype=numpy.int64)


class Levels(Volumes):
    OPTIONS = ("--voxel-size", "1")

    def check_shares(self, name, fine, levels, low, shape):
        """Levels of the grid `fine` of a file, voxel by voxel; `low` and `shape` in multiples of the
        coarsest voxel."""
        grids = self.grids(name)
        voxels = dense(grids[fine], low, shape) != 0
        self.assertEqual(voxels.sum(), grids[fine].activeVoxelCount())
        for k in levels:
            coarse = grids["%s_level_%d" % (fine, k)]
            counts = shares(voxels, k)
            wanted = (counts / 8.0 ** k).astype(numpy.float32)
            found = dense(coarse, [c >> k for c in low], counts.shape)
            self.assertTrue((found == wanted).all(), (fine, k))
            self.assertEqual(coarse.activeVoxelCount(), (counts > 0).sum())
            self.assertEqual(coarse.gridClass, "fog volume")
            self.check_place(grids[fine], coarse, k)

    def check_place(self, fine, coarse, k):
        for i in ((0, 0, 0), (3, -2, 5), (-7, 1, 0)):
            first = [c << k for c in i]
            last = [c + (1 << k) - 1 for c in first]
            a, b = fine.transform.indexToWorld(tuple(first)), fine.transform.indexToWorld(tuple(last))
            centre = coarse.transform.indexToWorld(i)
            for axis in range(3):
                self.assertAlmostEqual(centre[axis], (a[axis] + b[axis]) / 2, places=9)

    def test_shares_of_voxels(self):
        for name, mesh, size, low, shape in (
                ("ball", ball(24, 90, (10.3, -20.1, 33.7)), 1, (-128, -128, -64), (256, 256, 256)),
                ("corner", ball(16, 60, (4096, 0, -4096)), 1, (4032, -64, -4160), (128, 128, 128)),
                ("thin", rod(260, 3), 1, None, None),
                ("box", aligned_box((-128, 0, 0), (136, 128, 256)), 1, (-128, 0, 0), (320, 128, 256))):
            if low is None:
                low, high = numpy.floor(numpy.min(mesh[0], 0)), numpy.ceil(numpy.max(mesh[0], 0))
                low = [int(c) // 64 * 64 for c in low]
                shape = [-(-(int(b) + 1 - a) // 64) * 64 for a, b in zip(low, high)]
            self.write(name + ".off", off(*mesh))
            self.succeed("voxelize", name + ".off", "-o", name + ".vdb", *self.OPTIONS, "--grid",
                         "density,mask", "--lod", "1:6")
            for grid in ("density", "mask"):
                self.check_shares(name + ".vdb", grid, range(1, 7), low, shape)

    def test_volumes(self):
        """The sum of a level's shares is the volume of what it was made of."""
        self.write("ball.off", off(*ball(24, 90, (10.3, -20.1, 33.7))))
        report = self.succeed("voxelize", "ball.off", "-o", "ball.vdb", "--voxel-size", "0.5", "--grid", "density",
                              "--lod", "1:6", "--json", "-", "-q")
        volumes = [grid["volume"] for grid in json.loads(report.out)["grids"]]
        self.assertEqual(len(volumes), 7)
        for volume in volumes:
            self.assertAlmostEqual(volume / volumes[0], 1, places=6)

    def test_coarsest(self):
        """Voxels that are larger than nodes, and a range that begins late."""
        self.write("box.off", off(*aligned_box((-4096, 0, 100), (8192 + 512, 4096, 4200))))
        self.succeed("voxelize", "box.off", "-o", "box.vdb", *self.OPTIONS, "--grid", "mask", "--lod", "5:12")
        grids = self.grids("box.vdb")
        self.assertEqual(len(grids), 9)

        def along(i, k, low, high):
            """Voxels of low..high-1 that voxel i of level k covers."""
            return max(0, min(high, (i + 1) << k) - max(low, i << k))

        for k in range(5, 13):
            reader = grids["mask_level_%d" % k].getConstAccessor()
            for i in itertools.product((-(4096 >> k), -1, 0, (4095 >> k), (8703 >> k), (9000 >> k) + 1),
                                       (-1, 0, 4095 >> k), (0, 100 >> k, 4100 >> k, (4200 >> k) + 1)):
                count = (along(i[0], k, -4096, 8704) * along(i[1], k, 0, 4096) * along(i[2], k, 100, 4200))
                self.assertEqual(reader.getValue(i), numpy.float32(count / 8.0 ** k), (k, i))
            self.assertGreater(grids["mask_level_%d" % k].activeVoxelCount(), 0)
        total = 12800 * 4096 * 4100
        for k in (9, 12):
            grid = grids["mask_level_%d" % k]
            low, high = grid.evalActiveVoxelBoundingBox()
            array = dense(grid, low, [b - a + 1 for a, b in zip(low, high)]).astype(float)
            self.assertEqual(array.sum() * 8.0 ** k, total)

    def test_uniform_nodes_stay_tiles(self):
        self.write("box.off", off(*aligned_box((0, 0, 0), (4096, 4096, 4096))))
        self.succeed("voxelize", "box.off", "-o", "box.vdb", *self.OPTIONS, "--grid", "mask", "--lod", "1:5")
        for name, grid in self.grids("box.vdb").items():
            self.assertLessEqual(grid.leafCount(), 1, name)
            k = 0 if name == "mask" else int(name[-1])
            self.assertEqual(grid.activeVoxelCount(), (4096 >> k) ** 3)

    def test_values(self):
        """A fog and coverage are averaged over all voxels, arrays over those that are active."""
        points, tets = lattice(3, origin=(-30.3, 5.1, -10.2), side=60.0)
        self.write("a.vtu", vtu_with(points, tets, [("T", [2 * p[0] + 7 for p in points]),
                                                    ("vel", [(p[1], 0.0, p[2]) for p in points])]))
        self.succeed("voxelize", "a.vtu", "-o", "a.vdb", *self.OPTIONS, "--grid", "coverage,fog,T,vel",
                     "--lod", "1:4")
        self.succeed("voxelize", "a.vtu", "-o", "m.vdb", *self.OPTIONS, "--grid", "T,vel")
        grids = self.grids("a.vdb")
        low, shape = (-48, 0, -16), (96, 80, 80)
        for name in ("coverage", "fog", "T"):
            values = dense(grids[name], low, shape).astype(float)
            active = numpy.zeros(shape, bool)
            for run in grids[name].citerOnValues():
                a, b = ([c - o for c, o in zip(corner, low)] for corner in (run.min, run.max))
                active[a[0]:b[0] + 1, a[1]:b[1] + 1, a[2]:b[2] + 1] = True
            self.assertEqual(active.sum(), grids[name].activeVoxelCount())
            for k in range(1, 5):
                coarse = grids["%s_level_%d" % (name, k)]
                step = 1 << k
                blocks = [n for pair in ((s // step, step) for s in shape) for n in pair]
                sums = (values * active).reshape(blocks).sum((1, 3, 5))
                counts = active.reshape(blocks).sum((1, 3, 5))
                wanted = sums / 8.0 ** k if name != "T" else sums / numpy.maximum(counts, 1)
                found = dense(coarse, [c >> k for c in low], sums.shape)
                self.assertLess(numpy.abs(found - wanted).max(), 1e-6 * numpy.abs(wanted).max())
                self.assertEqual(coarse.activeVoxelCount(), (counts > 0).sum())
                self.check_place(grids[name], coarse, k)
        vel = grids["vel_level_2"]
        reader, fine = vel.getConstAccessor(), grids["vel"].getConstAccessor()
        for i in ((0, 4, 2), (-7, 1, -3), (7, 16, 12)):
            block = [fine.probeValue(tuple(4 * c + d for c, d in zip(i, each)))
                     for each in itertools.product(range(4), repeat=3)]
            mean = numpy.mean([value for value, active in block if active], 0)
            self.assertTrue(numpy.allclose(reader.getValue(i), mean, rtol=1e-6, atol=1e-5), i)

    def test_threads_and_streams(self):
        self.write("ball.off", off(*ball(24, 200, (0, 100, 4050))))
        made = []
        for threads in (1, 2, 8):
            self.succeed("voxelize", "ball.off", "-o", "a.vdb", *self.OPTIONS, "--grid", "mask,density", "--lod",
                         "2:5", "--threads", threads)
            made.append(self.path("a.vdb").read_bytes())
        self.assertTrue(made[0] == made[1] == made[2])
        # The volume itself is that without levels, which `convert` adds as well.
        self.succeed("voxelize", "ball.off", "-o", "plain.vdb", *self.OPTIONS, "--grid", "mask,density")
        self.succeed("convert", "plain.vdb", "-o", "b.vdb", "--lod", "2:5")
        self.assertEqual(self.hash_of("a.vdb"), self.hash_of("b.vdb"))
        self.succeed("convert", "a.vdb", "-o", "c.vdb", "--grid", "mask,density")
        self.assertEqual(self.hash_of("c.vdb"), self.hash_of("plain.vdb"))
        self.succeed("voxelize", "ball.off", "-o", "e.nvdb", *self.OPTIONS, "--grid", "mask,density", "--lod", "2:5")
        self.assertEqual(self.hash_of("e.nvdb"), self.hash_of("a.vdb"))
        self.succeed("convert", "plain.vdb", "-o", "f.nvdb", "--lod", "2:5")
        self.assertEqual(self.hash_of("f.nvdb"), self.hash_of("a.vdb"))
        self.succeed("convert", "a.vdb", "-o", "d.nvdb")
        self.assertEqual(self.hash_of("d.nvdb"), self.hash_of("a.vdb"))

    def check_tiles(self, folder, whole, size):
        """Levels of tiles against those of a whole volume: each voxel, where a tile has it, and their
        numbers."""
        index, names = self.tiles(folder), self.grids(whole)
        self.assertEqual({grid["name"] for grid in index["grids"]}, set(names))
        voxels = dict.fromkeys(names, 0)
        for tile in index["tiles"]:
            grids = self.grids(folder + "/" + tile["file"])
            self.assertEqual({own["name"]: own["active_voxels"] for own in tile["grids"]},
                             {name: grid.activeVoxelCount() for name, grid in grids.items()})
            self.assertEqual(set(grids), set(names))
            for name, grid in grids.items():
                k = int(name.rpartition("_")[2]) if "_level_" in name else 0
                low = [c >> k for c in tile["box"]["min"]]
                voxels[name] += grid.activeVoxelCount()
                if name == "vel":
                    continue
                # Where the whole has voxels; their number tells of others.
                box = names[name].evalActiveVoxelBoundingBox()
                first = [max(a, b) for a, b in zip(low, box[0])]
                shape = [min(a + (size >> k) - 1, b) - c + 1 for a, b, c in zip(low, box[1], first)]
                if min(shape) > 0:
                    found, wanted = (dense(one, first, shape) for one in (grid, names[name]))
                    self.assertTrue((found == wanted).all(), (tile["file"], name))
                self.assertEqual(grid.transform, names[name].transform)
        self.assertEqual(voxels, {name: grid.activeVoxelCount() for name, grid in names.items()})
        for grid in index["grids"]:
            name = grid["name"]
            self.assertEqual(grid["active_voxels"], voxels[name])
            box = names[name].evalActiveVoxelBoundingBox()
            self.assertEqual([grid["box"]["min"], grid["box"]["max"]], [list(c) for c in box])
            matrix = numpy.array(grid["index_to_world"])
            self.assertTrue(numpy.allclose((matrix @ [3, 5, 7, 1])[:3], names[name].transform.indexToWorld((3, 5, 7))))

    def test_tiles(self):
        self.write("ball.off", off(*ball(24, 100, (-20, 500, 1000))))
        for grids, levels in (("mask,density", "1:9"), ("fog,coverage", "2:4")):
            make = ("voxelize", "ball.off", *self.OPTIONS, "--grid", grids, "--lod", levels)
            self.succeed(*make, "-o", "whole.vdb")
            self.succeed(*make, "--tiles", "made", "--tile-size", 512)
            self.check_tiles("made", "whole.vdb", 512)
            self.succeed("voxelize", "ball.off", "-o", "plain.vdb", *self.OPTIONS, "--grid", grids)
            self.succeed("convert", "plain.vdb", "--tiles", "cut", "--tile-size", 512, "--lod", levels)
            self.check_tiles("cut", "whole.vdb", 512)

    def test_transform(self):
        """Voxels with three sizes and an origin."""
        self.write("ball.off", off(*ball(12, 3, (1, 2, 3))))
        self.succeed("voxelize", "ball.off", "-o", "a.vdb", "--voxel-size", "0.1,0.2,0.25", "--origin",
                     "0.7,-3.1,9.3", "--lod", "1:3")
        grids = self.grids("a.vdb")
        for k in (1, 2, 3):
            self.check_place(grids["density"], grids["density_level_%d" % k], k)
            self.assertEqual(grids["density_level_%d" % k].transform.voxelSize(),
                             tuple(s * 2 ** k for s in (0.1, 0.2, 0.25)))

    def test_a_sequence(self):
        for i in (1, 2):
            self.write("ball_%d.off" % i, off(*ball(8, 10, (0, 0, 5 * i))))
        self.succeed("voxelize", "ball_1.off", "ball_2.off", "-o", "run.vdb", *self.OPTIONS, "--lod", "1:2")
        self.assertEqual(len(self.grids("run.0002.vdb")), 3)
        self.succeed("voxelize", "ball_1.off", "ball_2.off", "-o", "run.vdb", *self.OPTIONS, "--lod", "1")
        self.assertEqual(len(self.grids("run.0002.vdb")), 2)

    def test_what_is_refused(self):
        self.write("ball.off", off(*ball(8, 10, (0, 0, 0))))
        make = ("voxelize", "ball.off", *self.OPTIONS)
        for lod in ("0:3", "3:1", "1:13", "a", "1:", "1:2:3", "-1"):
            self.refuse(2, *make, "-o", "a.vdb", "--lod", lod, says="--lod")
        self.refuse(2, *make, "-o", "a.vdb", "--grid", "surface", "--lod", "1", says=("surface", "level set"))
        self.refuse(2, *make, "-o", "a.vdb", "--grid", "material", "--lod", "1", says=("material", "mean"))
        self.refuse(2, *make, "-o", "a.npz", "--lod", "1", says="--lod")
        self.refuse(2, *make, "--tiles", "t", "--tile-size", 512, "--lod", "1:10", says=("--lod", "--tile-size"))
        self.refuse(2, *make, "--tiles", "t", "--grid", "surface", "--lod", "1", says="level set")
        self.assertFalse(self.path("t").exists())
        self.succeed(*make, "-o", "s.vdb", "--grid", "surface")
        self.refuse(2, "convert", "s.vdb", "-o", "a.vdb", "--lod", "1", says="level set")
        self.refuse(2, "convert", "s.vdb", "-o", "a.obj", "--lod", "1", says="--lod")
        self.refuse(2, "convert", "ball.off", "-o", "a.stl", "--lod", "1", says="--lod")


if __name__ == "__main__":
    unittest.main()
