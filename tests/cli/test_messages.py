# SPDX-License-Identifier: Apache-2.0
"""What the program says: names that were misspelled, help, numbers, how far it is."""

import os
import pathlib
import pty
import re
import subprocess
import unittest

from program import PROGRAM, CommandLineTest, box_faces, gmsh, lattice, medit, off

GRIDS = ("density", "mask", "surface", "fog", "coverage", "tet_id", "material")
COMMANDS = ("voxelize", "tetrahedralize", "info", "compare", "repair", "render", "check", "report",
            "plan", "merge", "formats", "grids")
LIBRARY = pathlib.Path(__file__).resolve().parents[2] / "lib" / "tetvdb"


def legacy_vtk(points, tets, array):
    lines = ["# vtk DataFile Version 3.0", "a mesh", "ASCII", "DATASET UNSTRUCTURED_GRID",
             f"POINTS {len(points)} double", *("%r %r %r" % p for p in points),
             f"CELLS {len(tets)} {5 * len(tets)}", *("4 %d %d %d %d" % tuple(t) for t in tets),
             f"CELL_TYPES {len(tets)}", *["10"] * len(tets), f"POINT_DATA {len(points)}",
             f"SCALARS {array} double 1", "LOOKUP_TABLE default", *("%r" % p[0] for p in points)]
    return "\n".join(lines) + "\n"


class Messages(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("box.off", off(*box_faces()))
        self.write("box.mesh", medit(*lattice(2)))

    def test_misspelled_options(self):
        job = ("voxelize", "box.off", "-o", "out.vdb")
        for wrong, right in (("--resoluton", "--resolution"), ("--rezolution=64", "--resolution"),
                             ("--voxelsize", "--voxel-size"), ("--jsn", "--json"),
                             ("--Grid", "--grid"), ("--quite", "--quiet")):
            with self.subTest(wrong=wrong):
                self.refuse(2, *job, wrong, says=(wrong.split("=")[0], f"did you mean {right}?",
                                                  "tetvdb help voxelize"))
        result = self.refuse(2, *job, "--banana", says="--banana")
        self.assertNotIn("did you mean", result.err)
        self.refuse(2, "info", "box.off", "-x", says="-x")

    def test_settings_of_the_library_are_spelled_as_options(self):
        """Texts of the library name settings, the program spells them as options."""
        for source in LIBRARY.rglob("*.cpp"):
            for line in source.read_text(encoding="utf-8").splitlines():
                for text in re.findall(r'"((?:[^"\\]|\\.)*)"', line.split("//")[0]):
                    self.assertNotRegex(text, r"--[a-z]", source.name)
        self.refuse(2, "voxelize", "box.off", "-o", "out.vdb", "--padding", "300", "--fit", "64",
                    says=("--padding", "of --fit"))
        self.refuse(2, "voxelize", "box.off", "-o", "out.vdb", "--inside", "flood", "--mesher",
                    "envelope", says=("--inside", "--mesher winding"))
        sheet = self.write("sheet.off", off([(0, 0, 0), (9, 0, 0), (0, 9, 0)], [(0, 1, 2)]))
        self.assertIn("with --shell", self.run_program("info", sheet).out)

    def test_misspelled_commands(self):
        for wrong, right in (("voxelise", "voxelize"), ("tetrahedralise", "tetrahedralize"),
                             ("inof", "info"), ("cmpare", "compare"), ("Render", "render")):
            with self.subTest(wrong=wrong):
                self.refuse(2, wrong, "box.off", says=(f"'{wrong}'", f"did you mean '{right}'?"))
        result = self.refuse(2, "banana", says=COMMANDS)
        self.assertNotIn("did you mean", result.err)

    def test_misspelled_values(self):
        job = ("voxelize", "box.off", "-o", "out.vdb")
        self.refuse(2, *job, "--mesher", "windng", says=("--mesher", "'windng'", "envelope",
                                                         "did you mean 'winding'?"))
        self.refuse(2, "check", "box.mesh", "--target", "bender",
                    says=("houdini", "did you mean 'blender'?"))
        self.refuse(2, *job, "--resolution", "many", says=("--resolution", "'many'", "number"))
        self.refuse(2, "render", "box.off", "-o", "o.png", "--colormap", "virdis",
                    says=("magma", "did you mean 'viridis'?"))

    def test_misspelled_grids(self):
        self.refuse(2, "voxelize", "box.off", "-o", "out.vdb", "--grid", "densty",
                    says=("'densty'", "did you mean 'density'?", *GRIDS))
        self.refuse(2, "voxelize", "box.mesh", "-o", "out.vdb", "--grid", "suface",
                    says=("'suface'", "did you mean 'surface'?", *GRIDS))
        self.succeed("voxelize", "box.mesh", "-o", "v.vdb", "--grid", "density,mask")
        self.refuse(2, "render", "v.vdb", "-o", "v.png", "--grid", "maks",
                    says=("did you mean 'mask'?", "density"))

    def test_misspelled_arrays_and_regions(self):
        points, tets = lattice(2)
        self.write("hot.vtk", legacy_vtk(points, tets, "Temperature"))
        job = ("voxelize", "hot.vtk", "-o", "out.vdb")
        for option in ("--grid", "--derive"):
            name = "Temprature" if option == "--grid" else "t=Temprature"
            self.refuse(2, *job, option, name, says="did you mean 'Temperature'?")
        self.refuse(2, *job, "--warp", "temperature", says="did you mean 'Temperature'?")
        self.refuse(2, *job, "--grid", "density", "--region-array", "x", says="array 'x'")
        self.refuse(2, "render", "hot.vtk", "-o", "o.png", "--color", "Temprature",
                    says="did you mean 'Temperature'?")
        # Grids are no arrays: to derive from one is not what was meant.
        result = self.refuse(2, *job, "--derive", "t=densty", says="Temperature")
        self.assertNotIn("did you mean", result.err)

        names = {1: "housing", 2: "shaft"}
        self.write("two.msh", gmsh(points, tets, [i % 2 + 1 for i in range(len(tets))], names))
        self.refuse(2, "voxelize", "two.msh", "-o", "out.vdb", "--region", "houzing",
                    says=("did you mean 'housing'?", "shaft"))

    def test_help(self):
        whole = self.succeed("--help").out
        self.assertEqual(self.succeed("help").out, whole)
        for command in COMMANDS:
            self.assertIn(command, whole)
            self.assertEqual(self.succeed("help", command).out,
                             self.succeed(command, "--help").out)
        self.refuse(2, "help", "voxelise", says="did you mean 'voxelize'?")

    def test_numbers(self):
        points, faces = box_faces((0.1, 0.1, 0.1), (0.4, 0.4, 0.4))
        far = [(x + 1234567.0, y, z + 1e-17) for x, y, z in points]
        self.write("far.off", off(far, faces))
        self.assertIn("(1234567.1, 0.1, 0.1) to (1234567.4, 0.4, 0.4)",
                      self.succeed("info", "far.off").out)
        # Rounding beside the rest is zero, without a sign.
        self.write("noise.off", off([(x - 0.1, y - 0.1 - 1e-17, z - 0.1 - 1e-17)
                                     for x, y, z in points], faces))
        self.assertIn("(0, 0, 0) to (0.3, 0.3, 0.3)", self.succeed("info", "noise.off").out)
        # A ball's third of a voxel does not come with 17 digits, nor a small file as 0.0 MB.
        text = self.succeed("voxelize", "noise.off", "-o", "o.vdb", "--resolution", 90,
                            "--mesher", "winding").out
        self.assertIn("voxels of 0.003333333,", text)
        self.assertRegex(text, r"o\.vdb: [1-9][0-9.]* kB,")
        self.assertRegex(self.succeed("convert", "noise.off", "-o", "o.stl").out,
                         r"o\.stl: 684 bytes,")
        self.assertRegex(self.succeed("prepare", "noise.off", "-o", "p.stl", "--offset", "0.02",
                                      "--voxel-size", "0.01").out,
                         r"p\.stl: [1-9][0-9.]* kB,")
        self.assertRegex(self.succeed("slice", "noise.off", "-o", "layers", "--pixels", "20,20",
                                      "--display", "2,2", "--layer-height", "0.1").out,
                         r"layers: [1-9][0-9.]* (bytes|kB),")


class TotalProgress(CommandLineTest):
    def on_terminal(self, *arguments):
        """What is written to a terminal that is the program's standard error."""
        outer, inner = pty.openpty()
        job = subprocess.Popen([PROGRAM, *map(str, arguments)], cwd=self.folder, stderr=inner,
                               stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        os.close(inner)
        text = b""
        while True:
            try:
                part = os.read(outer, 65536)
            except OSError: # Linux: nobody holds the other end any more
                break
            if not part:
                break
            text += part
        os.close(outer)
        self.assertEqual(job.wait(timeout=120), 0, text)
        return text.decode()

    def test_the_bar_is_of_the_whole_job(self):
        self.write("a.off", off(*box_faces()))
        for job in (("voxelize", "a.off", "-o", "a.vdb", "--grid", "surface,coverage",
                     "--resolution", 300, "--preview", "a.png"),
                    ("tetrahedralize", "a.off", "-o", "a.msh"),
                    ("render", "a.off", "-o", "t.png", "--turntable", 3)):
            with self.subTest(job=job):
                shown = re.findall(r"\r\x1b\[K([a-z ]+?) *\[[# ]{32}\] +(\d+) %", self.on_terminal(*job))
                self.assertGreater(len(shown), 3)
                percents = [int(percent) for _, percent in shown]
                self.assertEqual(percents, sorted(percents))
                self.assertLessEqual(percents[-1], 100)
                # The last stage begins where the others have ended.
                self.assertEqual(shown[-1][0], "write")
                self.assertGreaterEqual(percents[-1], 80)


if __name__ == "__main__":
    unittest.main(verbosity=2)
