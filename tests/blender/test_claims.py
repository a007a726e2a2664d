# SPDX-License-Identifier: Apache-2.0
"""What `tetvdb check --target blender` says of a file, and what Blender does with it.

Files are made by OpenVDB's Python module, so that they have what TetVDB does not write. The claims are
about Blender 3.4 as Debian builds it, without NanoVDB; with another version these tests are skipped."""

import re
import unittest

import numpy

try:
    import pyopenvdb as openvdb
except ImportError:
    import openvdb

import blender
from program import lattice, medit
from test_fields import vtu_with

SIZE = 0.1
LOW, HIGH = 2, 13  # the voxels of block(): twelve a side, within the leaves around
LENGTH = (HIGH + 1 - LOW) * SIZE
LOOK = dict(centre=(0.8, 0.8, 0.8), width=2, pixels=20, samples=8)


def block(name="density", value=1.0, size=SIZE, grid_class="fog volume", high=HIGH):
    grid = openvdb.FloatGrid(0.0)
    values = numpy.zeros((high + 1 - LOW, HIGH + 1 - LOW, HIGH + 1 - LOW), numpy.float32)
    values[...] = value
    grid.copyFromArray(values, ijk=(LOW,) * 3, tolerance=-1)
    return finish(grid, name, size, grid_class)


def finish(grid, name, size=SIZE, grid_class="fog volume"):
    grid.name = name
    if grid_class:
        grid.gridClass = grid_class
    grid.transform = openvdb.createLinearTransform(voxelSize=size)
    return grid


class Claims(blender.Test):
    def setUp(self):
        if self.version != (3, 4):
            self.skipTest(f"claims about Blender 3.4, and this is {self.version}")
        super().setUp()

    def save(self, name, *grids):
        openvdb.write(str(self.path(name)), grids=list(grids))

    def findings(self, *names):
        """What check says: {code: weight}; its exit status must be that of the weights."""
        result = self.run_program("check", *names, "--target", "blender", "--json", "-")
        found = {f["code"]: f["weight"] for f in result.report()["findings"]}
        wrong = any(weight != "note" for weight in found.values())
        self.assertEqual(result.status, 8 if wrong else 0, found)
        return found

    def look(self, name, grid="density", **arguments):
        return self.picture_question(name, grid, **{**LOOK, **arguments})

    def middle(self, picture):
        """The light through the middle of the block."""
        return picture.values[8:12, 8:12].mean()

    def assert_nothing(self, picture):
        self.assertEqual(numpy.abs(picture.values).max(), 0)

    @blender.asks
    def test_nothing_wrong(self):
        self.save("a.vdb", block())
        self.assertEqual(self.findings("a.vdb"), {})
        yield [self.look("a.vdb")]
        self.assertAlmostEqual(self.middle(self.taken[0]), LENGTH, delta=1e-3)

    @blender.asks
    def test_tiles(self):
        tiles = openvdb.FloatGrid(0.0)
        tiles.fill((0, 0, 0), (15, 15, 15), 1.0)
        self.save("alone.vdb", finish(tiles, "density"))
        self.assertEqual(self.findings("alone.vdb"), {"tiles-alone": "error"})
        # The same voxels by tetvdb.
        points, tets = lattice(1, side=1.6)
        self.write("a.mesh", medit(points, tets))
        self.succeed("voxelize", "a.mesh", "-o", "opened.vdb", "--voxel-size", SIZE)
        self.assertEqual(self.findings("opened.vdb"), {})
        yield [self.look("alone.vdb"), self.look("opened.vdb", samples=32)]
        alone, opened = self.taken
        self.assert_nothing(alone)
        # The half of a surface's soft edge that lies outside is cut where it borders on a tile: an
        # eighth of a voxel is lost at either end. The leaf is the lower left eighth of the cube.
        for rows, lost in ((slice(12, 16), 1 / 4), (slice(4, 8), 1 / 8)):
            self.assertAlmostEqual(opened.values[rows, rows].mean(), 1.6 - lost * SIZE,
                                   delta=0.03 * SIZE)

    @blender.asks
    def test_voxels_that_are_not_there(self):
        self.save("a.vdb", block(), finish(openvdb.FloatGrid(0.0), "empty"))
        self.assertEqual(self.findings("a.vdb"), {"no-voxels": "error"})
        answer, _ = yield [self.question("list", "a.vdb"), self.look("a.vdb", "empty")]
        self.assertEqual((answer["error"], len(answer["grids"])), ("", 2))
        self.assert_nothing(self.taken[0])

    @blender.asks
    def test_small_values(self):
        self.save("faint.vdb", block(value=9e-4))
        self.save("seen.vdb", block(value=1.1e-3))
        values = numpy.full((12, 12, 12), 9e-4, numpy.float32)
        values[6:] = 1
        self.save("beside.vdb", block(value=values))
        self.assertEqual(self.findings("faint.vdb"), {"hidden-values": "warning"})
        self.assertEqual(self.findings("seen.vdb"), {})
        self.assertEqual(self.findings("beside.vdb"), {})
        yield [self.look("faint.vdb", gain=1e5), self.look("seen.vdb", gain=1e5),
               self.look("beside.vdb", gain=1e5)]
        faint, seen, beside = self.taken
        self.assert_nothing(faint)
        self.assertAlmostEqual(self.middle(seen), 110 * LENGTH, delta=0.2)
        # What is hidden is the grid, or parts of it far from larger values: not a voxel.
        self.assertAlmostEqual(beside.values[8:12, 5].mean(), 90 * LENGTH, delta=1)

    @blender.asks
    def test_negative_values(self):
        values = numpy.full((12, 12, 12), -1.0, numpy.float32)
        values[6:] = 1
        self.save("a.vdb", block(value=values))
        self.assertEqual(self.findings("a.vdb"), {"hidden-values": "warning"})
        yield [self.look("a.vdb", kind="absorption", background=1), self.look("a.vdb")]
        through, glow = self.taken
        self.assertTrue((through.values[8:12, 4:8] == 1).all())  # as densities: nothing
        self.assertAlmostEqual(through.values[8:12, 11:14].mean(), numpy.exp(-LENGTH), delta=3e-3)
        self.assertAlmostEqual(glow.values[8:12, 5].mean(), -LENGTH, delta=1e-3)  # as numbers

    @blender.asks
    def test_large_values(self):
        self.save("a.vdb", block(value=2000))
        self.assertEqual(self.findings("a.vdb"), {"hidden-values": "warning"})
        yield [self.look("a.vdb", kind="absorption", background=1)]
        self.assertEqual(self.middle(self.taken[0]), 0)

    @blender.asks
    def test_memory(self):
        # 4 bytes for each voxel of the box around the active ones. (Builds with NanoVDB take less.)
        def corners(side):
            grid = openvdb.FloatGrid(0.0)
            for i in (0, side - 1):
                grid.getAccessor().setValueOn((i, i, i), 1.0)
            return finish(grid, "density")

        for side in (100, 300, 793, 794):
            self.save(f"{side}.vdb", corners(side))
        self.assertEqual(self.findings("793.vdb"), {})  # 1.995 GB
        self.assertEqual(self.findings("794.vdb"), {"memory": "warning"})  # 2.002 GB
        yield [self.look("100.vdb", samples=1), self.look("300.vdb", samples=1)]
        peaks = []
        for picture in self.taken:
            log = self.said.split(f"picture {picture.path}")[1].split("picture ")[0]
            peaks.append(max(float(size) for size in re.findall(r"Peak:([0-9.]+)M", log)))
        self.assertAlmostEqual(peaks[1] - peaks[0], 4 * (300 ** 3 - 100 ** 3) / 2 ** 20, delta=2)

    @blender.asks
    def test_class(self):
        sphere = openvdb.createLevelSetSphere(radius=0.5, voxelSize=0.05)
        sphere.name = "surface"
        self.save("set.vdb", sphere)
        without = sphere.deepCopy()
        without.gridClass = "unknown"
        self.save("unset.vdb", without)
        self.save("inside.vdb", block(grid_class="level set"))
        self.assertEqual(self.findings("set.vdb"), {})
        self.assertEqual(self.findings("unset.vdb").get("class"), "warning")
        self.assertEqual(self.findings("inside.vdb").get("class"), "warning")
        answers = yield [self.question("surface", "set.vdb", grid="surface", threshold=0),
                         self.question("surface", "unset.vdb", grid="surface", threshold=0),
                         self.question("surface", "inside.vdb", grid="density", threshold=0.5)]
        exact = 4 / 3 * numpy.pi * 0.5 ** 3
        for answer, sign, volume in zip(answers, (1, -1, -1), (exact, exact, LENGTH ** 3)):
            self.assertAlmostEqual(answer["volume"] * sign, volume, delta=0.03 * volume)

    @blender.asks
    def test_names(self):
        self.save("none.vdb", block(name=""))
        self.save("two.vdb", block(), block(value=3.0))
        self.assertEqual(self.findings("none.vdb").get("name"), "error")
        self.assertEqual(self.findings("two.vdb"), {"name": "error"})
        yield [self.look("none.vdb", ""), self.look("none.vdb", "density"), self.look("two.vdb")]
        self.assert_nothing(self.taken[0])
        self.assert_nothing(self.taken[1])
        self.assertAlmostEqual(self.middle(self.taken[2]), LENGTH, delta=1e-3)  # not 3, nor 4

    @blender.asks
    def test_velocity_names(self):
        # Of a grid named velocity, vel or v, Blender makes the volume's velocity: shaders know it
        # by the first of these names alone.
        grids = {}
        for name in ("velocity", "vel", "v", "flow"):
            grid = openvdb.Vec3SGrid((0, 0, 0))
            grid.copyFromArray(numpy.full((12, 12, 12, 3), (1, 2, 3), numpy.float32), ijk=(2, 2, 2))
            self.save(name + ".vdb", finish(grid, name, grid_class=None), block())
            grids[name] = self.findings(name + ".vdb")
        self.save("number.vdb", block("v"), block())
        self.assertEqual(self.findings("number.vdb"), {"velocity-name": "note"})
        look = lambda file, name: self.look(file + ".vdb", name, kind="color", times="density")
        asked = [("velocity", "velocity"), ("vel", "vel"), ("vel", "velocity"), ("v", "v"),
                 ("v", "velocity"), ("flow", "flow")]
        *_, vel, v, flow = yield [
            *(look(*each) for each in asked), self.look("number.vdb", "v"),
            self.look("number.vdb", "velocity"),
            *(self.question("list", name + ".vdb") for name in ("vel", "v", "flow"))]
        self.assertEqual([each["velocity"] for each in (vel, v, flow)], ["vel", "v", ""])
        self.assertEqual(vel["velocity_unit"], "FRAME")
        self.assert_nothing(self.taken[-2])
        self.assertAlmostEqual(self.middle(self.taken[-1]), LENGTH, delta=1e-3)
        for (file, name), picture in zip(asked, self.taken):
            seen = picture.colors[8:12, 8:12].mean((0, 1))
            wanted = 0 if name in ("vel", "v") else LENGTH * numpy.array([1, 2, 3])
            self.assertLess(numpy.abs(seen - wanted).max(), 5e-3, (file, name))
        self.assertEqual(grids["velocity"], {})
        self.assertEqual(grids["flow"], {})
        self.assertEqual(grids["vel"], {"velocity-name": "note"})
        self.assertEqual(grids["v"], {"velocity-name": "note"})

    @blender.asks
    def test_background(self):
        # Blender draws what lies around the voxels, up to their tile's border, as well.
        points, tets = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], [[0, 1, 2, 3]]
        self.write("a.vtu", vtu_with(points, tets, [("T", [5.0] * 4)]))
        for name, value in (("none.vdb", 0), ("some.vdb", 1), ("less.vdb", -1)):
            self.succeed("voxelize", "a.vtu", "-o", name, "--grid", "T,density", "--voxel-size",
                         0.02, "--background", value)
        self.assertEqual(self.findings("none.vdb"), {})
        self.assertEqual(self.findings("some.vdb"), {"background": "warning"})
        self.assertEqual(self.findings("less.vdb"), {"background": "note"})
        look = dict(centre=(0.4, 0.4, 0.4), width=2, pixels=40)
        yield [self.look("none.vdb", "T", **look), self.look("some.vdb", "T", **look),
               self.look("less.vdb", "T", **look),
               self.look("some.vdb", "T", times="density", **look)]
        x, y = numpy.meshgrid(self.taken[0].u, self.taken[0].v)
        outside = (x + y > 1.06) | (x < -0.06) | (y < -0.06)
        for picture, sign in zip(self.taken, (0, 1, -1, 0)):
            beside = picture.values[outside]
            # Half of a leaf, 0.08, in places at the least.
            self.assertEqual((sign * beside > 0.05).any(), sign != 0)
            self.assertEqual((beside != 0).any(), sign != 0)

    @blender.asks
    def test_transforms(self):
        self.save("two.vdb", block("density"), block("fine", size=SIZE / 2))
        frustum = block()
        frustum.transform = openvdb.createFrustumTransform((0, 0, 0), (15, 15, 15), 0.5, 1.6, SIZE)
        self.save("frustum.vdb", frustum)
        self.assertEqual(self.findings("two.vdb"), {"transform": "warning"})
        self.assertEqual(self.findings("frustum.vdb"), {"transform": "error"})
        far = dict(width=200, pixels=100)
        yield [self.look("two.vdb"), self.look("two.vdb", "fine", centre=(0.4, 0.4, 0.4), width=1),
               *(self.look("frustum.vdb", view=view, **far) for view in "xyz")]
        # Blender draws each in its own place.
        self.assertAlmostEqual(self.middle(self.taken[0]), LENGTH, delta=1e-3)
        self.assertAlmostEqual(self.middle(self.taken[1]), LENGTH / 2, delta=1e-3)
        for picture in self.taken[2:]:
            self.assert_nothing(picture)

    @blender.asks
    def test_other_files(self):
        self.write("a.mesh", medit(*lattice(2)))
        self.succeed("voxelize", "a.mesh", "-o", "a.nvdb", "--resolution", 16)
        self.assertEqual(self.findings("a.nvdb"), {"file-type": "error"})
        answer, = yield [self.question("list", "a.nvdb")]
        self.assertEqual(answer["grids"], [])
        self.assertIn("not a VDB file", answer["error"])

    @blender.asks
    def test_up_axis(self):
        points, tets = lattice(2)
        tall = [(x, y, 3 * z) for x, y, z in points]
        self.write("a.mesh", medit(tall, tets))
        for name, axis in (("z.vdb", "z"), ("y.vdb", "y")):
            self.succeed("voxelize", "a.mesh", "-o", name, "--voxel-size", 0.1, "--up-axis", axis)
        self.assertEqual(self.findings("z.vdb"), {})
        self.assertEqual(self.findings("y.vdb"), {"up-axis": "warning"})
        answers = yield [self.question("surface", name, grid="density", threshold=0.5)
                         for name in ("z.vdb", "y.vdb")]
        sides = [[b - a for a, b in zip(*answer["box"])] for answer in answers]
        self.assertAlmostEqual(sides[0][2], 3, delta=0.01)
        self.assertAlmostEqual(sides[1][1], 3, delta=0.01)
        self.assertAlmostEqual(sides[1][2], 1, delta=0.01)

    def frames(self, *names, **arguments):
        return {"ask": "sequence", "paths": [str(self.path(name)) for name in names],
                "grid": "density", "threshold": 0.5,
                **{key: list(value) for key, value in arguments.items()}}

    @blender.asks
    def test_gap(self):
        names = [f"s.{i:04}.vdb" for i in (1, 2, 4)]
        for i, name in enumerate(names):
            self.save(name, block(high=9 + i))
        self.assertEqual(self.findings(*names[:2]), {})
        self.assertEqual(self.findings(*names), {"sequence-gap": "error"})
        answer, = yield [self.frames(*names, frames=[1, 2, 3, 4])]
        self.assertEqual([(o["is_sequence"], o["frames"]) for o in answer["objects"]], [(True, 2)])
        self.assertEqual([f["file"] for f in answer["frames"]], [*names[:2], "", ""])
        self.assertEqual([f["vertices"] > 0 for f in answer["frames"]], [True, True, False, False])

    @blender.asks
    def test_names_of_frames(self):
        fine = [["u_8.vdb", "u_9.vdb", "u_10.vdb"], ["k.1001.vdb", "k.1002.vdb"],
                ["m-1.vdb", "m-2.vdb"], ["z.0000.vdb", "z.0001.vdb"], ["7.vdb", "8.vdb"]]
        after = ["n.0001_low.vdb", "n.0002_low.vdb"]
        padded = ["w.1.vdb", "w.02.vdb", "w.3.vdb"]
        unknown = [["a.vdb", "b.vdb"], ["q.0001.5.vdb", "q.0002.5.vdb"]]
        for names in [*fine, after, padded, *unknown]:
            for count, name in enumerate(names):
                self.save(name, block(high=9 + count))
            found = {} if names in fine else {"sequence-name": "error"}
            self.assertEqual(self.findings(*names), found, names)
        answers = yield [self.frames(*names, frames=range(1, len(names) + 1))
                         for names in [*fine, after, padded, *unknown]]
        states = [[(o["is_sequence"], o["frames"]) for o in answer["objects"]]
                  for answer in answers]
        shown = [[f["file"] for f in answer["frames"]] for answer in answers]
        for names, state, files in zip(fine, states, shown):
            self.assertEqual(state, [(True, len(names))])
            self.assertEqual(files, names)
        # These are called sequences, but the first file stays, or one is not found.
        self.assertEqual(states[-4:-2], [[(True, 2)], [(True, 3)]])
        self.assertEqual(shown[-4:-2], [[after[0]] * 2, [padded[0], "", padded[2]]])
        for state in states[-2:]:
            self.assertEqual(state, [(False, 0), (False, 0)])

    @blender.asks
    def test_frames_that_differ(self):
        names = [f"s.{i:04}.vdb" for i in (1, 2, 3)]
        self.save(names[0], block())
        self.save(names[1], block("other"))
        self.save(names[2], block(size=SIZE / 2))
        self.assertEqual(self.findings(*names[:2]).get("sequence-grids"), "error")
        self.assertEqual(self.findings(names[0], names[2]).get("sequence-transform"), "warning")
        answer, = yield [self.frames(*names, frames=[1, 2, 3])]
        self.assertEqual([f["vertices"] > 0 for f in answer["frames"]], [True, False, True])
        first, last = answer["frames"][0], answer["frames"][2]
        self.assertAlmostEqual(last["volume"] * 8, first["volume"], delta=1e-4)


if __name__ == "__main__":
    unittest.main()
