# SPDX-License-Identifier: Apache-2.0
"""The shelf tool of scripts/houdini, with a stand-in for Houdini's module that writes down what is
asked of it. Houdini itself is not here: whether its nodes do as they are told is not tested."""

import json
import os
import pathlib
import sys
import types
import unittest
import xml.etree.ElementTree

HERE = pathlib.Path(__file__).resolve().parent
HOUDINI = HERE.parent.parent / "scripts" / "houdini"
sys.path[:0] = [str(HERE.parent / "cli"), str(HOUDINI / "scripts" / "python")]

import program
from program import lattice
from test_fields import vtu_with


class Interrupted(Exception):
    pass


class Parameter:
    def __init__(self, node, name):
        self.node, self.name = node, name

    def set(self, value):
        self.node.parameters[self.name] = value


class Node:
    NAMES = {"file": ("file", "missingframe"), "convertvdb": ("group", "conversion"),
             "geo": (), "null": (), "merge": ()}

    def __init__(self, kind, name):
        self.kind, self.name = kind, name
        self.children, self.parameters, self.input, self.flags = [], {}, None, set()
        self.inputs = []

    def createNode(self, kind, name):
        self.children.append(Node(kind, name))
        return self.children[-1]

    def parm(self, name):
        return Parameter(self, name) if name in self.NAMES[self.kind] else None

    def setNextInput(self, node):
        self.inputs.append(node.name)

    def setFirstInput(self, node):
        self.input = node.name

    def layoutChildren(self):
        pass

    def setDisplayFlag(self, on):
        self.flags.add("display")

    def setRenderFlag(self, on):
        self.flags.add("render")


class Operation:
    """Interrupts after so many updates."""
    updates_left = None
    fractions = []

    def __init__(self, name, open_interrupt_dialog):
        pass

    def __enter__(self):
        return self

    def __exit__(self, *error):
        return False

    def updateProgress(self, fraction):
        Operation.fractions.append(fraction)
        if Operation.updates_left is not None:
            Operation.updates_left -= 1
            if Operation.updates_left < 0:
                raise Interrupted()


class Session:
    """A fresh stand-in for each test, under the name `hou`."""

    def __init__(self):
        self.objects, self.ranges, self.messages = Node("geo", "obj"), [], []
        self.picked, self.answers = "", None
        hou = types.ModuleType("hou")
        hou.node = {"/obj": self.objects}.__getitem__
        hou.OperationInterrupted = Interrupted
        hou.InterruptableOperation = Operation
        hou.fileType = types.SimpleNamespace(Any="any")
        hou.severityType = types.SimpleNamespace(Error="error")
        hou.text = types.SimpleNamespace(expandString=lambda text: text.replace("$HIP", "/hip"))
        hou.playbar = types.SimpleNamespace(
            setFrameRange=lambda *r: self.ranges.append(r), setPlaybackRange=lambda *r: None)
        hou.ui = types.SimpleNamespace(
            selectFile=lambda title, file_type: self.picked, readMultiInput=self.ask,
            displayMessage=lambda text, title, severity: self.messages.append((severity, text)))
        sys.modules["hou"] = hou

    def ask(self, message, labels, buttons, close_choice, initial_contents, title):
        assert len(labels) == len(initial_contents) and len(buttons) > close_choice
        return (close_choice, initial_contents) if self.answers is None else (0, self.answers)


class HoudiniTool(program.CommandLineTest):
    def setUp(self):
        super().setUp()
        self.session = Session()
        Operation.updates_left, Operation.fractions = None, []
        sys.modules.pop("tetvdb_houdini", None)
        import tetvdb_houdini
        self.tool = tetvdb_houdini
        os.environ["TETVDB_PROGRAM"] = program.PROGRAM

    def mesh(self, name, shift=0.0):
        points, tets = lattice(2, origin=(shift, 0.0, 0.0))
        return self.write(name, vtu_with(points, tets,
                                         [("T", [p[2] for p in points])]))

    def nodes(self):
        geometry, = self.session.objects.children
        return geometry, {node.name: node for node in geometry.children}

    def test_arguments(self):
        make = self.tool.voxelize_arguments
        self.assertEqual(make("a.vtu", "b.vdb"),
                         ["voxelize", "a.vtu", "-o", "b.vdb", "--grid", "density", "--resolution",
                          "256", "--up-axis", "y"])
        self.assertEqual(
            make("a[1].$F4.vtu", "b.vdb", voxel_size="0.1", arrays=" T , vel,", surface=True,
                 y_up=False, more="--region 'left wing' --half"),
            ["voxelize", "a[[]1].*.vtu", "-o", "b.vdb", "--grid", "density,surface,T,vel",
             "--voxel-size", "0.1", "--region", "left wing", "--half"])
        self.assertEqual(make("a.E", "b.vdb", y_up=False)[-2:], ["--frames", "all"])
        self.assertEqual(make("a.exo", "b.vdb", y_up=False, all_steps=False)[-1], "256")
        for text in ("a.$F.vtu", "a.${F4}.vtu", "a.$F4.vtu"):
            self.assertEqual(self.tool.pattern_of(text), "a.*.vtu")

    def test_tiles_are_loaded(self):
        points, tets = lattice(2, side=40.0)
        self.write("a.vtu", vtu_with(points, tets, []))
        self.succeed("voxelize", "a.vtu", "--tiles", "my tiles", "--tile-size", 512, "--voxel-size", 1,
                     "--origin", "20,20,0.5")
        self.session.picked = str(self.path("my tiles/tiles.json"))
        self.tool.tiles_tool()
        self.assertEqual(self.session.messages, [])
        geometry, nodes = self.nodes()
        self.assertEqual(geometry.name, "my_tiles")
        self.assertEqual(list(nodes), ["tiles", "tile_0", "tile_1", "tile_2", "tile_3", "OUT"])
        self.assertEqual(nodes["tiles"].inputs, ["tile_0", "tile_1", "tile_2", "tile_3"])
        self.assertEqual(nodes["OUT"].input, "tiles")
        self.assertEqual(nodes["tile_3"].parameters, {"file": str(self.path("my tiles/tile_3.vdb"))})
        self.assertEqual(nodes["OUT"].flags, {"display", "render"})
        self.session.picked = str(self.path("a.vtu"))
        self.tool.tiles_tool()
        self.assertIn("no tiles.json", self.session.messages[0][1])

    def test_mesh_is_loaded(self):
        path = self.mesh("my part.vtu")
        self.tool.import_mesh(str(path), resolution=16, arrays="T", surface=True)
        geometry, nodes = self.nodes()
        self.assertEqual((geometry.kind, geometry.name), ("geo", "my_part"))
        self.assertEqual(list(nodes), ["read_vdb", "OUT", "surface", "OUT_SURFACE"])
        read = nodes["read_vdb"].parameters
        self.assertEqual(read, {"file": str(self.path("my part.vdb")), "missingframe": "empty"})
        self.assertEqual(nodes["surface"].parameters, {"group": "@name=surface",
                                                       "conversion": "poly"})
        self.assertEqual({name: node.input for name, node in nodes.items()},
                         {"read_vdb": None, "OUT": "read_vdb", "surface": "read_vdb",
                          "OUT_SURFACE": "surface"})
        self.assertEqual([name for name, node in nodes.items() if "display" in node.flags], ["OUT"])
        self.assertEqual(self.session.ranges, [])
        info = self.report_of("info", read["file"])["input"][0]
        self.assertEqual({grid["name"] for grid in info["grids"]}, {"density", "surface", "T"})
        self.assertEqual(info["metadata"]["up_axis"], "y")
        self.succeed("check", read["file"], "--target", "houdini")

    def test_sequence_is_loaded(self):
        for frame in (1, 2, 3):
            self.mesh(f"step.{frame:04}.vtu", shift=frame)
        self.tool.import_mesh(str(self.path("step.$F4.vtu")), voxel_size=0.25)
        _, nodes = self.nodes()
        self.assertEqual(nodes["read_vdb"].parameters["file"], str(self.path("step.$F4.vdb")))
        self.assertEqual(self.session.ranges, [(1, 3)])
        self.assertEqual(sorted(p.name for p in self.folder.glob("*.vdb")),
                         [f"step.{frame:04}.vdb" for frame in (1, 2, 3)])

    def test_exodus_with_and_without_steps(self):
        for name, file in (("mixed_hdf5.exo", "one.$F4.vdb"),
                           ("petsc__FourBrickTet-large.exo", "two.vdb")):
            self.session.objects.children.clear()
            self.tool.import_mesh(str(program.DATA / "vtk" / name), resolution=16,
                                  output=str(self.path(file.replace(".$F4", ""))))
            _, nodes = self.nodes()
            self.assertEqual(nodes["read_vdb"].parameters["file"], str(self.path(file)))

    def test_errors_are_raised(self):
        path = self.write("no.vtu", "nothing")
        with self.assertRaisesRegex(self.tool.TetvdbError, "no.vtu"):
            self.tool.import_mesh(str(path))
        for wrong in ("/nowhere/tetvdb", str(path)):
            os.environ["TETVDB_PROGRAM"] = wrong
            with self.assertRaisesRegex(self.tool.TetvdbError, "TETVDB_PROGRAM"):
                self.tool.import_mesh(str(path))
        self.assertEqual(self.session.objects.children, [])

    def test_escape_stops_the_program(self):
        path = self.mesh("a.vtu")
        Operation.updates_left = 3
        with self.assertRaises(Interrupted):
            self.tool.import_mesh(str(path), resolution=3000, surface=True)
        self.assertEqual([p.name for p in self.folder.iterdir()], ["a.vtu"])
        self.assertEqual(self.session.objects.children, [])

    def test_shelf(self):
        document = xml.etree.ElementTree.parse(HOUDINI / "toolbar" / "tetvdb.shelf").getroot()
        self.assertEqual(document.tag, "shelfDocument")
        tool = document.find("tool")
        self.assertEqual(document.find("toolshelf/memberTool").get("name"), tool.get("name"))
        script = tool.find("script")
        self.assertEqual(script.get("scriptType"), "python")

        def click():
            exec(compile(script.text, "tetvdb.shelf", "exec"), {})

        click()  # nothing was picked
        self.session.picked = str(self.mesh("a.vtu"))
        click()  # cancelled
        self.assertEqual(self.session.objects.children, [])
        self.session.answers = ("24", "", "T", "no", "yes", "")
        click()
        _, nodes = self.nodes()
        self.assertEqual(list(nodes), ["read_vdb", "OUT"])
        self.assertEqual(self.session.messages, [])
        for answers, says in ((("24", "", "pressure", "no", "yes", ""), "pressure"),
                              (("many", "", "", "no", "yes", ""), "many")):
            self.session.answers = answers
            click()
            severity, text = self.session.messages.pop()
            self.assertEqual(severity, "error")
            self.assertIn(says, text)

    def test_package(self):
        package = json.loads((HOUDINI / "tetvdb.json").read_text())
        variable, = package["env"][0]
        self.assertEqual(package["hpath"], "$" + variable)
        # Where Houdini looks for shelves and modules in such a folder.
        self.assertTrue((HOUDINI / "toolbar" / "tetvdb.shelf").exists())
        self.assertTrue((HOUDINI / "scripts" / "python" / "tetvdb_houdini.py").exists())


if __name__ == "__main__":
    unittest.main()
