# SPDX-License-Identifier: Apache-2.0
"""TetVDB's volumes as Blender sees them, beside what geometry says of the meshes.

Blender draws the sample with index i as the cell from i to i + 1, half a voxel (`shift` below) up
from where OpenVDB has it."""

import math
import unittest

import numpy

import blender
import program
from program import lattice
from test_fields import vtu_with

SIDES = (1.0, 0.8, 0.6)
CORNER = (0.3, -1.1, 2.2)
EDGES = 4 * sum(SIDES)
VOLUME = math.prod(SIDES)


def turn(points):
    """About the axis (1, 2, 3) by one radian."""
    axis = numpy.array([1.0, 2.0, 3.0]) / math.sqrt(14)
    cross = numpy.array([[0, -axis[2], axis[1]], [axis[2], 0, -axis[0]], [-axis[1], axis[0], 0]])
    rotation = numpy.eye(3) + math.sin(1) * cross + (1 - math.cos(1)) * cross @ cross
    return [tuple(map(float, rotation @ numpy.array(p))) for p in points]


def box(corner=(0, 0, 0), sides=SIDES, cells=2):
    """Six tets a cell."""
    points, tets = lattice(cells)
    return [tuple(c + s * x for c, s, x in zip(corner, sides, p)) for p in points], tets


def sphere(radius, inward=False, steps=64):
    """Points and triangles of a ball of as many steps of longitude, and half of latitude."""
    points, faces = [(0.0, 0.0, radius)], []
    for row in range(1, steps // 2):
        polar = math.pi * row / (steps // 2)
        for column in range(steps):
            angle = 2 * math.pi * column / steps
            points.append((radius * math.sin(polar) * math.cos(angle),
                           radius * math.sin(polar) * math.sin(angle), radius * math.cos(polar)))
    points.append((0.0, 0.0, -radius))
    last, rows = len(points) - 1, steps // 2 - 1
    at = lambda row, column: 1 + row * steps + column % steps
    for column in range(steps):
        faces.append((0, at(0, column), at(0, column + 1)))
        faces.append((last, at(rows - 1, column + 1), at(rows - 1, column)))
        for row in range(rows - 1):
            a, b = at(row, column), at(row, column + 1)
            c, d = at(row + 1, column), at(row + 1, column + 1)
            faces += [(a, c, d), (a, d, b)]
    return points, [face[::-1] for face in faces] if inward else faces


def ball_volume(radius):
    return 4 / 3 * math.pi * radius ** 3


class Volumes(blender.Test):
    def voxelize(self, mesh, name, *arguments):
        """`mesh` is points and tets, or the name of a file."""
        if not isinstance(mesh, str):
            mesh = self.write(name + ".mesh", program.medit(*mesh)).name
        self.succeed("voxelize", mesh, "-o", name, *arguments)
        self.succeed("check", name)

    def assert_near(self, actual, expected, delta, of=""):
        self.assertEqual(len(actual), len(expected), of)
        for a, e in zip(actual, expected):
            self.assertAlmostEqual(a, e, delta=delta, msg=f"{of}: {actual} is not {expected}")

    @blender.asks
    def test_grids_have_names_types_and_places(self):
        points, tets = box(CORNER)
        self.write("a.vtu", vtu_with(
            points, tets, [("temperature", [1.0 + p[0] for p in points]), ("vel", points)],
            [("part", [1] * len(tets), "Int32")]))
        number = {"density": "FLOAT", "surface": "FLOAT", "fog": "FLOAT", "coverage": "FLOAT",
                  "mask": "BOOLEAN", "tet_id": "INT", "material": "INT", "part": "INT",
                  "temperature": "FLOAT", "vel": "VECTOR_FLOAT"}
        grids = ",".join(number)
        origin = (0.013, -0.02, 0.041)
        place = ("--origin", ",".join(map(str, origin)))
        self.succeed("voxelize", "a.vtu", "-o", "cubes.vdb", "--grid", grids, "--voxel-size", 0.05,
                     *place)
        self.succeed("voxelize", "a.vtu", "-o", "half.vdb", "--grid", grids, "--voxel-size", 0.05,
                     "--half", *place)
        self.succeed("voxelize", "a.vtu", "-o", "slabs.vdb", "--grid",
                     ",".join(set(number) - {"surface", "fog"}), "--voxel-size", "0.04,0.06,0.1",
                     *place)
        answers = yield [self.question("list", name)
                         for name in ("cubes.vdb", "half.vdb", "slabs.vdb")]
        for answer, size in zip(answers, ((0.05,) * 3, (0.05,) * 3, (0.04, 0.06, 0.1))):
            self.assertEqual(answer["error"], "")
            expected = {name: kind for name, kind in number.items()
                        if size[0] == size[2] or name not in ("surface", "fog")}
            self.assertEqual({grid["name"]: grid["type"] for grid in answer["grids"]}, expected)
            for grid in answer["grids"]:
                self.assertTrue(grid["loaded"], grid)
                self.assertEqual(grid["channels"], 3 if grid["name"] == "vel" else 1)
                for i, row in enumerate(grid["matrix"]):
                    wanted = [0, 0, 0, 1] if i == 3 else [0, 0, 0, origin[i]]
                    if i < 3:
                        wanted[i] = size[i]
                    self.assert_near(row, wanted, 1e-7, grid["name"])

    @blender.asks
    def test_surface_of_a_level_set(self):
        # Where faces meet at a right angle, the surface's vertices lie within half a voxel inside:
        # at most a triangle of h * h / 2 is cut from an edge.
        size = 0.04
        points, tets = box(CORNER)
        self.voxelize((turn(points), tets), "turned.vdb", "--grid", "surface", "--voxel-size", size)
        outer, inner = sphere(0.9), sphere(0.5, inward=True)
        faces = outer[1] + [tuple(i + len(outer[0]) for i in face) for face in inner[1]]
        self.write("shell.off", program.off(outer[0] + inner[0], faces))
        self.voxelize("shell.off", "shell.vdb", "--grid", "surface", "--voxel-size", size,
                      "--mesher", "winding")
        box_, shell = yield [self.question("surface", name, grid="surface", threshold=0)
                             for name in ("turned.vdb", "shell.vdb")]
        self.assertEqual(box_["open_edges"], 0)
        self.assertLess(box_["volume"], VOLUME)
        self.assertGreater(box_["volume"], VOLUME - EDGES * size ** 2 / 2)
        centre, = turn([[c + s / 2 for c, s in zip(CORNER, SIDES)]])
        self.assert_near(box_["centroid"], [c + size / 2 for c in centre], 0.02 * size)
        # The polygon of 64 steps has 0.4 % less than the ball. A cavity is a cavity.
        self.assertEqual(shell["open_edges"], 0)
        exact = ball_volume(0.9) - ball_volume(0.5)
        self.assertAlmostEqual(shell["volume"], exact, delta=0.006 * exact)
        self.assert_near(shell["centroid"], [size / 2] * 3, 0.02 * size)
        self.assert_near(shell["box"][0], [size / 2 - 0.9] * 3, 0.1 * size)
        self.assert_near(shell["box"][1], [size / 2 + 0.9] * 3, 0.1 * size)

    @blender.asks
    def test_surface_of_a_density(self):
        # Between voxels of 1 and of 0 Blender's surface passes half-way, along an edge of the box
        # through the mean of the crossings: 0.25 h * h less there.
        size = 0.05
        self.voxelize(box(), "a.vdb", "--grid", "density,mask", "--voxel-size", size)
        answers = yield [self.question("surface", "a.vdb", grid=grid, threshold=0.5)
                         for grid in ("density", "mask")]
        for answer in answers:
            self.assertEqual(answer["open_edges"], 0)
            self.assertAlmostEqual(answer["volume"], VOLUME - EDGES * size ** 2 / 4,
                                   delta=8 * size ** 3)
            # Voxel centres of the box's lower faces are in, those of the upper are not.
            self.assert_near(answer["box"][0], (0, 0, 0), 1e-5)
            self.assert_near(answer["box"][1], SIDES, 1e-5)

    @blender.asks
    def test_light_through_a_wedge(self):
        # Thickness 0.2 + 0.8 x: what comes through is exp(-gain * thickness). A slab besides.
        points, tets = lattice(4)
        wedge = [(x, y, z * (0.2 + 0.8 * x)) for x, y, z in points]
        gain, size = 3.0, 0.03125
        self.voxelize((wedge, tets), "wedge.vdb", "--grid", "coverage", "--voxel-size", size)
        self.voxelize(box((0.1, 0.1, 0.1)), "slab.vdb", "--grid", "density", "--voxel-size", 0.05)
        look = dict(kind="absorption", gain=gain, background=1, centre=(0.5, 0.5, 0.5), width=1.6)
        yield [self.picture_question("wedge.vdb", "coverage", **look),
               self.picture_question("slab.vdb", "density", **look)]
        through, slab = self.taken
        inside = lambda along, low, high: (along > low) & (along < high)
        columns, rows = inside(through.u, 0.1, 0.95), inside(through.v, 0.1, 0.95)
        thickness = 0.2 + 0.8 * (through.u[columns] - size / 2)
        seen = through.values[rows][:, columns]
        self.assertLess(numpy.abs(seen / numpy.exp(-gain * thickness) - 1).max(), 0.015)
        empty = ~inside(through.u, -0.1, 1.15)
        self.assertTrue((through.values[:, empty] == 1).all())
        columns, rows = inside(slab.u, 0.2, 1.0), inside(slab.v, 0.2, 0.8)
        seen = slab.values[rows][:, columns]
        self.assertLess(numpy.abs(seen / math.exp(-gain * SIDES[2]) - 1).max(), 0.015)

    @blender.asks
    def test_silhouette_of_a_ball(self):
        # Glowing fog: a pixel is the length of the ray within the ball.
        radius, size = 0.9, 0.05
        self.write("ball.off", program.off(*sphere(radius)))
        self.voxelize("ball.off", "ball.vdb", "--grid", "density,coverage", "--voxel-size", size,
                      "--mesher", "winding")
        yield [self.picture_question("ball.vdb", grid, width=2.4, pixels=48)
               for grid in ("coverage", "density")]
        # Rays through voxels that are in or out are rounded to voxels at both ends: by a third of a
        # voxel in the mean.
        for picture, whole, mean in zip(self.taken, (0.005, 0.01), (0.2, 0.4)):
            distance = numpy.hypot(*numpy.meshgrid(picture.u - size / 2, picture.v - size / 2))
            chord = 2 * numpy.sqrt(numpy.maximum(radius ** 2 - distance ** 2, 0))
            self.assertAlmostEqual(picture.total(), ball_volume(radius),
                                   delta=whole * ball_volume(radius))
            self.assertTrue((picture.values[distance > radius + 2 * size] == 0).all())
            within = distance < radius - size
            self.assertLess(numpy.abs(picture.values - chord)[within].max(), 2 * size)
            self.assertLess(numpy.abs(picture.values - chord)[within].mean(), mean * size)

    @blender.asks
    def test_values(self):
        # Linear fields, so that a ray's integral is the value times the thickness.
        points, tets = box((0.1, 0.1, 0.1))
        self.write("a.vtu", vtu_with(
            points, tets, [("temperature", [1 + 2 * p[0] for p in points]),
                           ("vel", [(p[0], 2 * p[1], 0.5) for p in points])],
            [("part", [7] * len(tets), "Int32")]))
        size = 0.05
        arguments = ("--voxel-size", size, "--grid", "temperature,vel,part,mask")
        self.succeed("voxelize", "a.vtu", "-o", "a.vdb", *arguments)
        self.succeed("voxelize", "a.vtu", "-o", "half.vdb", *arguments, "--half")
        self.succeed("voxelize", "a.vtu", "-o", "up.vdb", *arguments, "--up-axis", "y")
        look = dict(centre=(0.6, 0.5, 0.5), width=1.4, pixels=28)
        yield [self.picture_question("a.vdb", "temperature", **look),
               self.picture_question("half.vdb", "temperature", **look),
               self.picture_question("a.vdb", "part", **look),
               self.picture_question("a.vdb", "mask", **look),
               # Blender makes this the volume's velocity grid, which its shaders call so.
               self.picture_question("a.vdb", "velocity", kind="color", times="mask",
                                     **look),
               # The mesh's z is now y, and its y minus z.
               self.picture_question("up.vdb", "velocity", kind="color", times="mask",
                                     view="y", **{**look, "centre": (0.6, 0.4, -0.5)})]
        thickness = 0.6

        def compare(picture, low, high, *functions):
            columns = (picture.u > low[0]) & (picture.u < high[0])
            rows = (picture.v > low[1]) & (picture.v < high[1])
            u, v = numpy.meshgrid(picture.u[columns] - size / 2, picture.v[rows] - size / 2)
            for channel, function in enumerate(functions):
                seen = picture.colors[rows][:, columns, channel]
                self.assertLess(numpy.abs(seen - thickness * function(u, v)).max(), 0.006,
                                f"{picture.path.name}, channel {channel}")

        inside = ((0.2, 0.2), (1.0, 0.8))
        temperature, half, part, mask, vel, up = self.taken
        for picture in (temperature, half):
            compare(picture, *inside, lambda x, y: 1 + 2 * x)
        compare(part, *inside, lambda x, y: 7 + 0 * x)
        compare(mask, *inside, lambda x, y: 1 + 0 * x)
        compare(vel, *inside, lambda x, y: x, lambda x, y: 2 * y, lambda x, y: 0.5 + 0 * x)
        # (vx, vy, vz) is now (vx, vz, -vy), and y of the mesh is -z of the picture.
        compare(up, (0.2, -0.8), (1.0, -0.2), lambda x, z: x, lambda x, z: 0.5 + 0 * x,
                lambda x, z: 2 * z)

    @blender.asks
    def test_numbers_of_tets(self):
        # Tet 0 is not to be seen, tet 1 counts once, tet 2 twice. Around the tets Blender draws the
        # background, which is -1: `density` masks it.
        tet = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
        points = [(3 * i + p[0], p[1], p[2]) for i in range(3) for p in tet]
        mesh = points, [[4 * i + k for k in range(4)] for i in range(3)]
        self.voxelize(mesh, "a.vdb", "--grid", "tet_id,density", "--voxel-size", 0.02)
        yield [self.picture_question("a.vdb", "tet_id", times="density", width=0.5, pixels=32,
                                     centre=(3 * i + 0.4, 0.4, 0.4)) for i in range(3)]
        # Seen from above, the tet is 1 - x - y high.
        for number, picture in enumerate(self.taken):
            x, y = numpy.meshgrid(picture.u - 3 * number, picture.v)
            height = 1 - x - y
            thick = height > 0.2
            wanted = number * height[thick]
            self.assertLess(numpy.abs(picture.values[thick] - wanted).max(),
                            0.02 * 1.5 * (number + 1))

    def places(self):
        """Name, arguments, voxel, and the box of the volume. No face of the box lies on one of a
        tile, where Blender is not exact (test_claims.py, test_tiles)."""
        high = [c + s for c, s in zip(CORNER, SIDES)]
        return [
            ("plain.vdb", ("--voxel-size", 0.05), (0.05,) * 3, CORNER, high),
            ("moved.vdb", ("--voxel-size", 0.05, "--origin", "0.013,-0.02,0.041"), (0.05,) * 3,
             CORNER, high),
            ("slabs.vdb", ("--voxel-size", "0.04,0.06,0.1", "--origin", "0.3,0.2,0.1"),
             (0.04, 0.06, 0.1), CORNER, high),
            ("up.vdb", ("--voxel-size", "0.05,0.04,0.06", "--up-axis", "y"), (0.05, 0.04, 0.06),
             (CORNER[0], CORNER[2], -high[1]), (high[0], high[2], -CORNER[1])),
        ]

    @blender.asks
    def test_place_and_size(self):
        self.write("a.mesh", program.medit(*box(CORNER)))
        questions = []
        for name, arguments, _, low, high in self.places():
            self.succeed("voxelize", "a.mesh", "-o", name, "--grid", "density,coverage", *arguments)
            centre = [(a + b) / 2 for a, b in zip(low, high)]
            questions.append(self.question("surface", name, grid="density", threshold=0.5))
            questions += [self.picture_question(name, "coverage", view=view, centre=centre,
                                                width=1.5, pixels=60) for view in "xyz"]
        answers = yield questions
        for i, (name, _, voxel, low, high) in enumerate(self.places()):
            surface = answers[4 * i]
            for seen, wanted in zip(surface["box"], (low, high)):
                for axis in range(3):
                    # A face lies up to half a voxel from the last centre inside.
                    self.assertAlmostEqual(seen[axis] - voxel[axis] / 2, wanted[axis],
                                           delta=0.501 * voxel[axis], msg=f"{name}, axis {axis}")
            # Coverage is exact, and so are its integral and centroid.
            for picture in self.taken[3 * i:3 * i + 3]:
                self.assertAlmostEqual(picture.total(), VOLUME, delta=0.001 * VOLUME)
                for axis, seen in picture.centroid().items():
                    self.assertAlmostEqual(
                        seen - voxel[axis] / 2, (low[axis] + high[axis]) / 2,
                        delta=0.02 * voxel[axis], msg=f"{picture.path.name}, axis {axis}")

    @blender.asks
    def test_sequence(self):
        # Four frames, stored out of order: a box that grows, moves and warms.
        size, sides = 0.05, lambda frame: (0.2 * frame + 0.2, 0.8, 0.6)
        for frame in (1, 2, 3, 4):
            points, tets = box((0.5 * frame, 0, 0.1), sides(frame))
            self.write(f"step{frame}.vtu", vtu_with(points, tets,
                                                    [("heat", [float(frame)] * len(points))]))
        self.write("run.pvd", '<VTKFile type="Collection" version="0.1"><Collection>' + "".join(
            f'<DataSet timestep="{frame / 10}" part="0" file="step{frame}.vtu"/>'
            for frame in (3, 1, 4, 2)) + "</Collection></VTKFile>")
        self.succeed("voxelize", "run.pvd", "-o", "run.vdb", "--grid", "coverage,heat",
                     "--voxel-size", size)
        names = [f"run.{i:04}.vdb" for i in (1, 2, 3, 4)]
        self.succeed("check", *names)
        look = dict(view="z", centre=[2, 0.4, 0.4], width=4, pixels=160, samples=16)
        saves = {frame: self.path(f"{frame}.npy") for frame in (1, 3, 4)}
        answer, = yield [{
            "ask": "sequence", "paths": [str(self.path(name)) for name in names], "grid": "heat",
            "threshold": 0.5, "frames": [0, 1, 2, 3, 4, 5],
            "pictures": [dict(look, frame=frame, save=str(save)) for frame, save in saves.items()]}]
        self.assertEqual([(o["is_sequence"], o["frames"], o["start"], o["offset"])
                          for o in answer["objects"]], [(True, 4, 1, 0)])
        self.assertEqual([f["file"] for f in answer["frames"]], ["", *names, ""])
        self.assertEqual([f["error"] for f in answer["frames"]], [""] * 6)
        self.assertEqual([len(f["grids"]) for f in answer["frames"]], [0, 2, 2, 2, 2, 0])
        for frame in (1, 2, 3, 4):
            seen = answer["frames"][frame]
            # The surface of 0.5 moves out as the value rises: up to half a voxel a side.
            for side, (low, high) in enumerate(zip(*seen["box"])):
                self.assertAlmostEqual(high - low, sides(frame)[side], delta=1.01 * size)
            self.assertAlmostEqual(seen["centroid"][0], 0.5 * frame + sides(frame)[0] / 2,
                                   delta=0.05 * size)
        for frame, save in saves.items():
            picture = blender.Picture(save, "z", (2, 0.4, 0.4), 4, 160)
            wanted = frame * math.prod(sides(frame))
            self.assertAlmostEqual(picture.total(), wanted, delta=0.005 * wanted)
            self.assertAlmostEqual(picture.centroid()[0], 0.5 * frame + sides(frame)[0] / 2,
                                   delta=0.05 * size)


if __name__ == "__main__":
    unittest.main()
