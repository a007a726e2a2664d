# SPDX-License-Identifier: Apache-2.0
"""Runs "Your first ten commands" of docs/guide.md as they stand there, on the files that the page
names, and judges the answers by numpy and OpenVDB's Python module."""

import json
import pathlib
import re
import shlex
import struct
import subprocess
import unittest

import numpy
import pyopenvdb

import program
from program import box_faces, lattice
from test_exact import icosphere, volume_of
from test_fields import vtu_with

GUIDE = pathlib.Path(__file__).resolve().parents[2] / "docs/guide.md"


def commands():
    """The lines of the section, as a user would type them."""
    text = GUIDE.read_text().split("## Your first ten commands", 1)[1].split("\n## ", 1)[0]
    return re.findall(r"^    (tetvdb .+)$", text, re.MULTILINE)


def stl(points, faces):
    data = bytearray(80) + struct.pack("<I", len(faces))
    for face in faces:
        data += struct.pack("<12fH", 0, 0, 0, *(c for i in face for c in points[i]), 0)
    return bytes(data)


def as_floats(points):
    return [tuple(float(numpy.float32(c)) for c in p) for p in points]


class FirstCommands(program.CommandLineTest):
    def setUp(self):
        super().setUp()
        self.points, self.faces = icosphere(3)
        self.points = as_floats(self.points)
        self.write("ball.stl", stl(self.points, self.faces))
        self.write("cube.stl", stl(*box_faces((0.0,) * 3, (10.0,) * 3)))
        self.write("plate.stl", stl(*box_faces((0.0, 0.0, 0.0), (6.0, 4.0, 1.0))))
        self.write("pin.stl", stl(*box_faces((2.0, 1.0, 1.0), (4.0, 3.0, 4.0))))
        points, tets = lattice(2)
        points = [(4 * x, y, z) for x, y, z in points]
        self.write("beam.vtu", vtu_with(points, tets, [("temperature",
                                                        [0.1 + 0.2 * p[0] for p in points])]))

    def run_line(self, line):
        """As it stands; its report comes from a second run, which must write the same."""
        words = shlex.split(line)
        self.assertEqual(words.pop(0), "tetvdb")
        done = subprocess.run([program.PROGRAM, *words], cwd=self.folder, timeout=120,
                              stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True)
        self.assertEqual(done.returncode, 0, f"{line}: {done.stderr}")
        self.assertNotIn("warning", done.stderr, line)
        report = json.loads(subprocess.run([program.PROGRAM, *words, "--json", "-"],
                                           cwd=self.folder, stdout=subprocess.PIPE,
                                           stderr=subprocess.PIPE, check=True).stdout)
        self.assertEqual(report["warnings"], [], line)
        self.assertEqual(report["status"], 0, line)
        return done.stdout + done.stderr, report

    def grid(self, file, name):
        return pyopenvdb.read(str(self.path(file)), name)

    def dense(self, grid, low, high):
        values = numpy.empty([b - a + 1 for a, b in zip(low, high)])
        grid.copyToArray(values, ijk=low)
        return values

    def heights(self, size, low, high):
        """Of voxel centres above the plane of the ball's face that is lowest below them, in world
        units: below 0 inside, since the ball is convex."""
        axes = [numpy.arange(a, b + 1) * size for a, b in zip(low, high)]
        x, y, z = numpy.meshgrid(*axes, indexing="ij")
        highest = numpy.full(x.shape, -numpy.inf)
        for a, b, c in (numpy.array([self.points[i] for i in face]) for face in self.faces):
            n = numpy.cross(b - a, c - a)
            n /= numpy.linalg.norm(n)
            numpy.maximum(highest, n[0] * x + n[1] * y + n[2] * z - n @ a, out=highest)
        return highest

    def test_the_lines_of_the_guide(self):
        lines = commands()
        self.assertEqual(len(lines), 10)
        answers = [self.run_line(line) for line in lines]
        said, report = answers[0]
        self.assertRegex(said, r"verdict +watertight")
        solid = report["input"][0]
        self.assertEqual((solid["triangles"], solid["area"]), (12, 600))
        self.assertAlmostEqual(solid["volume"], 1000, delta=1e-9)
        for (said, report), resolution in ((answers[1], 128), (answers[2], 256)):
            [grid] = report["grids"]
            self.assertEqual(grid["active_voxels"], resolution ** 3)
            self.assertEqual(grid["volume"], 1000)
        self.check_level_set()
        self.check_coverage(answers[4][1])
        [grid] = answers[5][1]["grids"]
        for axis in range(3):
            self.assertGreaterEqual(grid["box"]["min"][axis], 2)
            self.assertLessEqual(grid["box"]["max"][axis], 61)
        self.assertEqual(max(b - a + 1 for a, b in zip(grid["box"]["min"], grid["box"]["max"])), 60)
        self.check_materials(answers[6][1])
        self.check_temperatures()
        self.assertEqual(answers[8][1]["repair"]["triangles"], 12)
        self.assertAlmostEqual(answers[8][1]["repair"]["volume"], 1000, delta=1e-9)
        self.assertEqual(self.path("ball.png").read_bytes()[16:24], struct.pack(">II", 640, 480))

    def check_level_set(self):
        surface = self.grid("ball.vdb", "surface")
        size = surface.transform.voxelSize()[0]
        low, high = (-36,) * 3, (36,) * 3
        values = self.dense(surface, low, high)
        heights = self.heights(size, low, high)
        decided = numpy.abs(heights) > 1e-6 * size # corners lie on a lattice of 2^-20 voxel
        self.assertTrue(numpy.array_equal(values[decided] < 0, heights[decided] < 0))
        # Inside of a convex body the nearest plane is as far as the surface.
        band = (heights < 0) & (heights > -2.9 * size)
        self.assertGreater(band.sum(), 10000)
        self.assertLess(numpy.abs(values - heights)[band].max(), 1e-5 * size)

    def check_coverage(self, report):
        true = volume_of(self.points, self.faces)
        [grid] = report["grids"]
        self.assertLess(abs(grid["filled"] / true - 1), 1e-10)
        stored = self.grid("shares.vdb", "coverage")
        values = self.dense(stored, (-36,) * 3, (36,) * 3)
        self.assertLess(abs(values.sum() * stored.transform.voxelSize()[0] ** 3 / true - 1), 1e-8)

    def check_materials(self, report):
        low, high = (-2, -2, -2), (26, 18, 18)
        x, y, z = numpy.meshgrid(*(numpy.arange(a, b + 1) for a, b in zip(low, high)),
                                 indexing="ij")
        within = lambda v, a, b: (v >= a) & (v < b) # of two opposite faces one has its centres
        plate = within(x, 0, 24) & within(y, 0, 16) & within(z, 0, 4)
        pin = within(x, 8, 16) & within(y, 4, 12) & within(z, 4, 16)
        found = self.dense(self.grid("parts.vdb", "density"), low, high)
        self.assertTrue(numpy.array_equal(found, plate | pin))
        # The module does not read grids of whole numbers.
        material = report["grids"][0]
        self.assertEqual(material["active_voxels"], (plate | pin).sum())
        self.assertEqual((material["min"], material["max"]), (1, 2))

    def check_temperatures(self):
        temperature = self.grid("beam.vdb", "temperature")
        size = temperature.transform.voxelSize()[0]
        count = 0
        for voxel in temperature.citerOnValues():
            for x in range(voxel.min[0], voxel.max[0] + 1):
                self.assertAlmostEqual(voxel.value, 0.1 + 0.2 * x * size, delta=1e-6)
            count += voxel.count
        self.assertEqual(count, 40 * 10 * 10)
        self.assertEqual(self.grid("beam.vdb", "density").activeVoxelCount(), count)


if __name__ == "__main__":
    unittest.main(verbosity=2)
