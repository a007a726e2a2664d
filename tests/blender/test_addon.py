# SPDX-License-Identifier: Apache-2.0
"""The add-on of scripts/blender, in Blender."""

import json
import math
import unittest

import numpy

import blender
import program
from program import lattice
from test_fields import vtu_with

SIZE = 0.05


def block(corner=(0.1, 0.1, 0.1), side=1.0, heat=lambda x: 300 + 200 * x):
    points, tets = lattice(2, origin=corner, side=side)
    return vtu_with(points, tets, [("temperature", [heat(p[0]) for p in points]),
                                   ("vel", [(3.0, 0.0, 4.0 * p[0]) for p in points])])


def xdmf(steps):
    """A cube that moves by 0.5 a step, and starts there."""
    grids = ""
    for step in range(1, steps + 1):
        points, tets = lattice(1, origin=(0.5 * step, 0, 0))
        item = lambda rows, kind: (
            f'<DataItem Dimensions="{len(rows)} {len(rows[0])}" NumberType="{kind}" Format="XML">'
            + " ".join(str(x) for row in rows for x in row) + "</DataItem>")
        grids += (f'<Grid Name="s"><Time Value="{step}"/><Topology TopologyType="Tetrahedron" '
                  f'NumberOfElements="{len(tets)}">{item(tets, "Int")}</Topology>'
                  f'<Geometry GeometryType="XYZ">{item(points, "Float")}</Geometry></Grid>')
    return ('<Xdmf Version="3.0"><Domain><Grid Name="run" GridType="Collection" '
            f'CollectionType="Temporal">{grids}</Grid></Domain></Xdmf>')


class AddOn(blender.Test):
    probe = blender.HERE / "addon_probe.py"

    def imported(self, name, pictures=(), frames=(), program=None, files=(), before=None,
                 **options):
        options = {"filepath": str(self.path(name)), "size_by": "VOXEL_SIZE", "voxel_size": SIZE,
                   **options}
        if files:
            options.update(directory=str(self.folder), files=[{"name": each} for each in files])
        return {"ask": "import", "options": options, "frames": list(frames), "program": program,
                "pictures": list(pictures), "before": before}

    def volume_of(self, answer):
        self.assertNotIn("error", answer)
        self.assertEqual(answer["result"], ["FINISHED"])
        volume, = (each for each in answer["objects"] if each["type"] == "VOLUME")
        self.assertTrue(volume["selected"])
        return volume

    def from_above(self):
        look = dict(view="z", centre=(0.6, 0.6, 0.6), width=1.6, pixels=32)
        picture = blender.Picture(self.path("seen.npy"), **look)
        return dict(look, save=str(picture.path)), picture

    def assert_glow(self, picture, material, value):
        """A picture from above of the block, whose array is `value` of x. Light of strength e from
        density d is e / d * (1 - exp(-d * length)) of the color, where the add-on has taken
        Blender's half voxel out."""
        low, high = material["range"]
        ramp = numpy.array(material["ramp"])[:, :3]
        columns = (picture.u > 0.2) & (picture.u < 1.0)
        rows = (picture.v > 0.2) & (picture.v < 1.0)
        place = (value(picture.u[columns]) - low) / (high - low)
        glow = 0.5 * (1 - math.exp(-20))
        for channel in range(3):
            wanted = glow * numpy.interp(place, numpy.linspace(0, 1, 21), ramp[:, channel])
            seen = picture.colors[rows][:, columns, channel].mean(0)
            self.assertLess(numpy.abs(seen - wanted).max(), 0.01, f"channel {channel}")
        outside = (picture.u < 0.0) | (picture.u > 1.2)
        self.assertEqual(numpy.abs(picture.values[:, outside]).max(), 0)

    @blender.asks
    def test_registration(self):
        answer, = yield [{"ask": "state"}]
        there, gone = {"menu": 1, "operator": True}, {"menu": 0, "operator": False}
        self.assertEqual(answer, {"on": there, "off": gone, "again": there})

    @blender.asks
    def test_tiles(self):
        """A bar through three tiles: each at its place, and all of it there."""
        low, high = (-0.6, 0.1, 0.1), (0.3, 0.11, 0.11)
        points, faces = program.box_faces(low, high)
        self.write("bar.off", program.off(points, faces))
        self.succeed("voxelize", "bar.off", "--tiles", "bar", "--tile-size", 512, "--voxel-size",
                     0.001, "--origin", "0.0005,0.0005,0.0005")
        self.path("bad").mkdir()
        self.write("bad/tiles.json", "{}")
        answer, bad = yield [{"ask": "tiles", "path": str(self.path("bar/tiles.json")),
                              "scale": 1.0, "centered": True},
                             {"ask": "tiles", "path": str(self.path("bad/tiles.json"))}]
        self.assertIn("tiles.json", bad["error"])
        self.assertEqual(answer["result"], ["FINISHED"])
        self.assertEqual(answer["collection"], "bar")
        index = json.loads(self.path("bar/tiles.json").read_text())
        self.assertEqual([each["name"] for each in answer["tiles"]],
                         [tile["file"][:-4] for tile in index["tiles"]])
        self.assertEqual(len(answer["tiles"]), 3)
        total = 0
        for each, tile in zip(answer["tiles"], index["tiles"]):
            self.assertEqual(each["materials"], ["bar"])
            self.assertTrue(each["selected"])
            self.assertEqual([grid["name"] for grid in each["grids"]], ["density"])
            for axis in range(3):
                own = tile["grids"][0]["box"]
                wanted = 0.001 * own["min"][axis], 0.001 * (own["max"][axis] + 1)
                for side in (0, 1):
                    place = each["surface"]["box"][side][axis] + each["location"][axis]
                    self.assertLess(abs(place - wanted[side]), 0.0011)
            total += each["surface"]["volume"]
        wanted = numpy.prod([b - a for a, b in zip(low, high)])
        self.assertLess(abs(total / wanted - 1), 0.02)

    @blender.asks
    def test_field_in_colors(self):
        self.write("beam.vtu", block())
        look, picture = self.from_above()
        answer, = yield [self.imported(
            "beam.vtu", arrays="temperature", pictures=[look])]
        volume = self.volume_of(answer)
        self.assertEqual(volume["name"], "beam")
        self.assertEqual(volume["file"], "beam.vdb")
        self.assertTrue(self.path("beam.vdb").exists())
        self.assertFalse(volume["is_sequence"])
        self.assertEqual([grid["name"] for grid in volume["grids"]], ["density", "temperature"])
        self.assertEqual(volume["scale"], [1, 1, 1])
        material, = volume["materials"]
        inputs = material["inputs"]
        self.assertEqual(inputs["Density Attribute"], "density")
        self.assertEqual(inputs["Color"], "ShaderNodeValToRGB")
        self.assertEqual(inputs["Emission Color"], "ShaderNodeValToRGB")
        self.assertEqual(sorted(material["attributes"]), ["density", "temperature"])
        # A model of length 1 (twenty voxels): an optical length of 20.
        self.assertAlmostEqual(inputs["Density"], 20, delta=1e-3)
        # Values at the first and the last voxel's centre.
        low, high = material["range"]
        self.assertAlmostEqual(low, 300 + 200 * 0.1, delta=0.001)
        self.assertAlmostEqual(high, 300 + 200 * 1.05, delta=0.001)
        self.assert_glow(picture, material, lambda x: 300 + 200 * x)

    @blender.asks
    def test_place_and_surface(self):
        # In millimetres, as triangles; the surface is the mesh's, not half a voxel beside.
        low, high = (2.0, 3.0, 4.0), (12.0, 8.0, 6.0)
        self.write("part.off", program.off(*program.box_faces(low, high)))
        answer, = yield [self.imported("part.off", voxel_size=0.25, surface=True, scale=0.1,
                                       shading="DENSITY", more="--mesher winding")]
        volume = self.volume_of(answer)
        self.assertEqual([grid["name"] for grid in volume["grids"]], ["density", "surface"])
        material, = volume["materials"]
        self.assertAlmostEqual(material["inputs"]["Density"], 20 / (10 * 0.1), delta=1e-3)
        self.assertEqual(material["attributes"], [])
        surface, = (each for each in answer["objects"] if each["type"] == "MESH")
        seen = surface["surface"]
        self.assertEqual(seen["open_edges"], 0)
        for axis in range(3):
            self.assertAlmostEqual(seen["box"][0][axis], 0.1 * low[axis], delta=1e-3)
            self.assertAlmostEqual(seen["box"][1][axis], 0.1 * high[axis], delta=1e-3)
        self.assertAlmostEqual(seen["volume"], 0.1, delta=0.03 * 0.1)

    @blender.asks
    def test_sequences(self):
        for frame in (1, 2, 3):
            self.write(f"step_{frame + 8}.vtu", block(corner=(0.5 * frame, 0, 0),
                                                      heat=lambda x: 100.0 * frame))
        self.write("run.pvd", '<VTKFile type="Collection" version="0.1"><Collection>' + "".join(
            f'<DataSet timestep="{frame}" part="0" file="step_{frame + 8}.vtu"/>'
            for frame in (1, 2, 3)) + "</Collection></VTKFile>")
        names = [f"step_{frame + 8}.vtu" for frame in (3, 1, 2)]
        self.write("steps.xdmf", xdmf(3))
        collection, again, files, together, steps, last = yield [
            self.imported("run.pvd", arrays="temperature", frames=[1, 2, 3, 4]),
            self.imported("run.pvd", arrays="temperature", frames=[1]),  # all frames are there
            self.imported(names[0], files=names, output=str(self.path("files.vdb")),
                          arrays="temperature", frames=[1, 2, 3]),
            self.imported(names[0], files=names, output=str(self.path("one.vdb")), sequence=False),
            self.imported("steps.xdmf", frames=[1, 2, 3]),
            self.imported("steps.xdmf", output=str(self.path("last.vdb")), sequence=False,
                          frames=[1])]
        for answer, name in ((collection, "run"), (again, "run"), (files, "files")):
            volume = self.volume_of(answer)
            self.assertEqual((volume["is_sequence"], volume["frames"], volume["start"],
                              volume["offset"], volume["mode"]), (True, 3, 1, 0, "EXTEND"))
            self.assertEqual(answer["frame_end"], 3)
            shown = [1, 2, 3, 3][:len(answer["frames"])]
            self.assertEqual([f["file"] for f in answer["frames"]],
                             [f"{name}.{i:04}.vdb" for i in shown])
            for frame, seen in zip(shown, answer["frames"]):
                self.assertAlmostEqual(seen["box"][0][0], 0.5 * frame, delta=0.501 * SIZE)
            material, = volume["materials"]
            self.assertEqual(material["range"], [100, 300])  # of all frames
            self.assertAlmostEqual(material["inputs"]["Density"], 20 / 2, delta=1e-3)
        self.assertFalse(self.volume_of(together)["is_sequence"])
        self.assertEqual(self.volume_of(steps)["frames"], 3)
        self.assertFalse(self.volume_of(last)["is_sequence"])
        for seen, step in zip(steps["frames"] + last["frames"], (1, 2, 3, 3)):
            self.assertAlmostEqual(seen["box"][0][0], 0.5 * step, delta=0.501 * SIZE)

    @blender.asks
    def test_importing_again_shows_the_new_file(self):
        self.write("a.vtu", block())
        self.write("s_1.vtu", block())
        self.write("s_2.vtu", block(corner=(1.1, 0.1, 0.1)))
        once = self.imported("a.vtu", voxel_size=0.5)["options"]
        sequence = self.imported("s_1.vtu", files=["s_1.vtu", "s_2.vtu"], voxel_size=0.5,
                                 output=str(self.path("s.vdb")))["options"]
        again, frames = yield [
            self.imported("a.vtu", arrays="temperature", frames=[1], before=once),
            self.imported("s_1.vtu", files=["s_1.vtu", "s_2.vtu"], frames=[1, 2],
                          output=str(self.path("s.vdb")), before=sequence)]
        for answer in (again, frames):
            volume = self.volume_of(answer)  # one object, in the place to which it was moved
            self.assertEqual((answer["volumes"], volume["location"]), (1, [7, 8, 9]))
            for grid in volume["grids"]:
                self.assertAlmostEqual(grid["matrix"][0][0], SIZE, delta=1e-6)
        volume = self.volume_of(again)
        self.assertEqual(volume["name"], "a")
        self.assertEqual([grid["name"] for grid in volume["grids"]], ["density", "temperature"])
        self.assertEqual(len(volume["materials"]), 1)
        for seen, low in zip(frames["frames"], (0.1, 1.1)):
            self.assertAlmostEqual(seen["box"][0][0], 7 + low, delta=0.501 * SIZE)

    @blender.asks
    def test_selected_files_that_are_no_sequence(self):
        self.write("left.vtu", block(corner=(0, 0, 0)))
        self.write("right.vtu", block(corner=(1, 0, 0)))
        self.write("part 1.vtu", block(corner=(0, 0, 0)))
        quoted, together = yield [
            self.imported("part 1.vtu", frames=[1], more='--units "half an inch"'),
            self.imported("left.vtu", files=["left.vtu", "right.vtu"], frames=[1],
                          output=str(self.path("both.vdb")))]
        self.assertEqual(self.volume_of(quoted)["file"], "part 1.vdb")
        self.assertEqual(self.report_of("info", "part 1.vdb")["input"][0]["metadata"]["units"],
                         "half an inch")
        self.assertFalse(self.volume_of(together)["is_sequence"])
        self.assertAlmostEqual(together["frames"][0]["box"][1][0], 2, delta=1.01 * SIZE)

    @blender.asks
    def test_real_files(self):
        # Name, arrays, and whether it has steps.
        asked = [("quadcopter_frame.mesh", "", False), ("hybrid_tetwedge.msh", "", False),
                 ("table.msh", "all", False), ("vtk/mixed.exo", "T,flow speed", True),
                 ("vtk/mixed_hdf5.exo", "all", True),
                 ("vtk/petsc__FourBrickTet-large.exo", "", False),
                 ("vtk/pieces.pvtu", "all", False)]
        answers = yield [self.imported(name, filepath=str(program.DATA / name), arrays=arrays,
                                       output=str(self.path(f"{i}.vdb")), size_by="RESOLUTION",
                                       resolution=24, frames=[1])
                         for i, (name, arrays, _) in enumerate(asked)]
        for (name, arrays, steps), answer in zip(asked, answers):
            volume = self.volume_of(answer)
            self.assertEqual(volume["is_sequence"], steps, name)
            self.assertEqual(volume["error"], "", name)
            self.assertEqual(len(volume["grids"]) > 1, arrays != "", name)
            self.assertGreater(answer["frames"][0]["volume"], 0, name)

    @blender.asks
    def test_vectors_and_temperatures(self):
        self.write("a.vtu", block())
        look, picture = self.from_above()
        speed, kelvin, chosen, plain, mapped = yield [
            self.imported("a.vtu", arrays="vel", pictures=[look]),
            self.imported("a.vtu", arrays="temperature", shading="BLACKBODY", remap=True),
            self.imported("a.vtu", arrays="all", color_by="vel"),
            self.imported("a.vtu", arrays="all", shading="NONE"),
            self.imported("a.vtu", arrays="temperature", remap=True)]
        for answer in (speed, chosen):
            material, = self.volume_of(answer)["materials"]
            # The magnitude, by the name that Blender gives to the velocity.
            self.assertEqual(sorted(material["attributes"]), ["density", "velocity"])
            self.assertAlmostEqual(material["range"][0], math.hypot(3, 0.4), delta=1e-4)
            self.assertAlmostEqual(material["range"][1], math.hypot(3, 4.2), delta=1e-4)
        self.assert_glow(picture, self.volume_of(speed)["materials"][0],
                         lambda x: numpy.hypot(3, 4 * x))
        inputs = self.volume_of(kelvin)["materials"][0]["inputs"]
        self.assertEqual(inputs["Temperature Attribute"], "temperature")
        self.assertEqual((inputs["Temperature"], inputs["Blackbody Intensity"]), (1, 1))
        self.assertEqual(self.volume_of(plain)["materials"], [])
        # The mesh's range is 0 to 1; the last voxel's centre is a voxel from its end.
        low, high = self.volume_of(mapped)["materials"][0]["range"]
        self.assertAlmostEqual(low, 0, delta=1e-5)
        self.assertAlmostEqual(high, 1 - SIZE, delta=1e-5)

    @blender.asks
    def test_what_goes_wrong(self):
        self.write("a.vtu", block())
        self.write("no.vtu", "nothing")
        self.write("sheet.off", program.off([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [[0, 1, 2]]))
        answers = yield [
            self.imported("no.vtu"), self.imported("a.vtu", arrays="pressure"),
            self.imported("sheet.off"), self.imported("none.vtu"),
            self.imported("a.vtu", program="/nowhere/tetvdb"),
            self.imported("a.vtu", color_by="speed"),
            self.imported("a.vtu", more='--units "half an inch'),
            self.imported("a.vtu", output=str(self.path("a.nvdb"))),
            self.imported("a.vtu", output=str(self.path("no/such/folder.vdb")))]
        for answer, says in zip(answers, ("no.vtu", "pressure", "--shell", "none.vtu",
                                          "add-on's preferences", "speed", "quotation mark",
                                          "name the output .vdb", "no/such")):
            self.assertIn("error", answer, says)
            self.assertIn(says, answer["error"])
            self.assertEqual(answer["objects"], [])

    @blender.asks
    def test_progress_and_cancel(self):
        self.write("a.vtu", block())
        cancelled, whole = yield [
            {"ask": "cancel", "path": str(self.path("a.vtu")), "output": str(self.path("c.vdb"))},
            {"ask": "progress", "path": str(self.path("a.vtu")),
             "output": str(self.path("w.vdb"))}]
        self.assertNotEqual(cancelled["stage"], "")
        self.assertIn("cancelled", cancelled["text"])
        self.assertLess(cancelled["seconds"], 15)
        self.assertFalse(cancelled["left"])
        self.assertFalse(self.path("c.vdb").exists())
        self.assertEqual(whole["status"], 0)
        self.assertEqual([line for line in whole["said"] if "%" in line], [])
        self.assertTrue({"voxelize", "fields", "write"} & {stage for stage, _ in whole["seen"]})


if __name__ == "__main__":
    unittest.main()
