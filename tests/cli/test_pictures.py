# SPDX-License-Identifier: Apache-2.0
"""Pictures of volumes, previews and comparisons; and the user's benchmark."""

import math
import unittest

from program import CommandLineTest, box_faces, lattice, medit, off, vtu
from test_render import read_png


def ball(radius=1.0, n=24, center=(0.0, 0.0, 0.0)):
    """A sphere of 2 n^2 quadrangles, cut into triangles: points, faces."""
    points, faces = [], []
    for i in range(n + 1):
        for j in range(2 * n):
            theta, phi = math.pi * i / n, math.pi * j / n
            points.append((center[0] + radius * math.sin(theta) * math.cos(phi),
                           center[1] + radius * math.sin(theta) * math.sin(phi),
                           center[2] + radius * math.cos(theta)))
    for i in range(n):
        for j in range(2 * n):
            a, b = i * 2 * n + j, i * 2 * n + (j + 1) % (2 * n)
            faces += [[a, a + 2 * n, b], [b, a + 2 * n, b + 2 * n]]
    return points, faces


def is_red(p):
    return p[0] > 90 and p[0] > 2 * p[1] and p[0] > 2 * p[2]


def is_blue(p):
    return p[2] > 90 and p[2] > 1.8 * p[0] and p[2] > 1.5 * p[1]


class Volumes(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("ball.off", off(*ball()))
        self.succeed("voxelize", "ball.off", "-o", "ball.vdb", "--grid", "density,surface,mask",
                     "--resolution", "64", "--mesher", "winding")

    def silhouette(self, *arguments):
        """Area of what is not background, in world units, from its extent along a row through the
        middle, which is the ball's diameter."""
        self.succeed("render", "ball.vdb", "-o", "out.png", "--view", "front", "--size", "200x200",
                     "--background", "black", *arguments)
        _, _, rows = read_png(self.path("out.png"))
        lit = [[max(p) > 8 for p in row] for row in rows]
        across = sum(lit[100])
        return sum(map(sum, lit)) / across ** 2

    def test_a_ball_has_a_balls_outline_in_every_style(self):
        for style in ("surface", "voxels", "fog"):
            for grid in ("density", "surface", "mask") if style != "fog" else ("density",):
                area = self.silhouette("--style", style, "--grid", grid)
                self.assertAlmostEqual(area, math.pi / 4, delta=0.04, msg=f"{style} of {grid}")

    def test_a_slice_shows_a_disc_in_the_colour_of_its_values(self):
        self.succeed("render", "ball.vdb", "-o", "out.png", "--slice", "z=0.5", "--grid", "surface",
                     "--size", "300x200", "--background", "white", "--colormap", "grey",
                     "--range", "-0.1:0.1")
        width, height, rows = read_png(self.path("out.png"))
        # The band is all that is active: a ring of 2 x 3 voxels, dark inside, bright outside.
        row = rows[height // 2]
        inked = [x for x in range(width) if row[x] != (255, 255, 255)]
        ring = [row[x][0] for x in inked if x < width // 3]
        self.assertGreater(len(ring), 6)
        self.assertGreater(ring[0], ring[-1] + 60)

    def test_what_does_not_fit_is_refused(self):
        self.refuse(2, "render", "ball.vdb", "-o", "out.png", "--grid", "nothing",
                    says=("no grid 'nothing'", "density, mask, surface"))
        self.refuse(2, "render", "ball.vdb", "-o", "out.png", "--color", "nothing", says="no grid")
        self.refuse(2, "render", "ball.off", "-o", "out.png", "--style", "fog", says="for volumes")
        self.refuse(2, "render", "ball.vdb", "-o", "out.png", "--slice", "z=99u", says="outside")
        self.refuse(2, "render", "ball.vdb", "-o", "out.png", "--slice", "z=0.5", "--style", "fog")

    def test_threads_change_no_byte(self):
        for style in ("surface", "voxels", "fog"):
            pictures = set()
            for threads in (1, 2, 5):
                self.succeed("render", "ball.vdb", "-o", "out.png", "--style", style, "--size",
                             "120x90", "--threads", threads)
                pictures.add(self.path("out.png").read_bytes())
            self.assertEqual(len(pictures), 1, style)

    def test_meshes_and_volumes_on_one_sheet(self):
        report = self.report_of("render", "ball.off", "ball.vdb", "-o", "out.png", "--size", "400x200",
                                "--background", "black", "--view", "front")
        self.assertEqual([i["kind"] for i in report["input"]], ["triangles", "volume"])
        _, _, rows = read_png(self.path("out.png"))
        lit = [sum(max(p) > 8 for p in row[:200]) for row in rows[60:150]]
        right = [sum(max(p) > 8 for p in row[200:]) for row in rows[60:150]]
        self.assertAlmostEqual(max(lit) / max(right), 1, delta=0.05)  # at one scale


class Previews(CommandLineTest):
    def setUp(self):
        super().setUp()
        points, faces = box_faces()
        self.write("open.off", off(points, faces[2:]))
        self.write("tets.mesh", medit(*lattice(3)))

    def panels_of(self, *arguments, status=0):
        report = self.report_of(*arguments, "--preview", "p.png", status=status)
        width, height, rows = read_png(self.path("p.png"))
        preview = report["preview"]
        self.assertEqual((preview["width"], preview["height"]), (width, height))
        self.assertEqual(preview["path"], "p.png")
        self.assertIn("preview", [stage["name"] for stage in report["stages"]])
        self.assertEqual(width, 256 * len(preview["panels"]))
        return preview["panels"], rows

    def test_voxelize(self):
        panels, rows = self.panels_of("voxelize", "open.off", "-o", "v.vdb", "--resolution", "24",
                                      "--mesher", "envelope")
        self.assertEqual(panels, ["input", "tets", "volume", "slice"])
        self.assertTrue(any(is_red(p) for row in rows for p in row[:256]), "open edges are red")
        middle = [p for p in rows[96][768:] if max(p) - min(p) < 12]
        self.assertGreater(len(middle), 240, "a slice of one value has one colour, grey, no legend")
        panels, _ = self.panels_of("voxelize", "open.off", "-o", "v.vdb", "--resolution", "24",
                                   "--mesher", "winding")
        self.assertEqual(panels, ["input", "volume", "slice"])
        panels, rows = self.panels_of("voxelize", "tets.mesh", "-o", "v.vdb", "--resolution", "24")
        self.assertEqual(panels, ["tets", "volume", "slice"])
        self.assertFalse(any(is_red(p) for row in rows for p in row[512:]))

    def test_materials_are_categories(self):
        for name, low in (("a.off", 0.0), ("b.off", 1.0)):
            self.write(name, off(*box_faces((low, 0.0, 0.0), (low + 1, 1.0, 1.0))))
        panels, _ = self.panels_of("voxelize", "a.off", "b.off", "-o", "m.vdb", "--resolution",
                                   "16", "--grid", "density,material")
        self.assertEqual(panels, ["input", "volume", "slice", "material"])
        picture = self.report_of("render", "m.vdb", "-o", "m.png", "--color",
                                 "material")["picture"]
        self.assertEqual(picture["colors"], {"title": "material", "kinds": ["1", "2"]})
        self.succeed("voxelize", "b.off", "a.off", "-o", "n.vdb", "--resolution", "16", "--grid",
                     "density,material")
        # The left half has the first colour, and in the other order the second.
        pictures = []
        for name in ("m", "n"):
            self.succeed("render", name + ".vdb", "-o", name + ".png", "--color", "material",
                         "--view", "front", "--background", "white")
            _, _, rows = read_png(self.path(name + ".png"))
            pictures.append((rows[240][150], rows[240][420]))
        self.assertNotEqual(pictures[0][0], pictures[0][1])
        hue = lambda pixel: max(range(3), key=lambda i: pixel[i])
        self.assertEqual(hue(pictures[0][0]), hue(pictures[1][1]))
        self.assertEqual(hue(pictures[0][1]), hue(pictures[1][0]))

    def test_a_preview_changes_no_volume(self):
        self.succeed("voxelize", "tets.mesh", "-o", "a.vdb", "--resolution", "24")
        self.succeed("voxelize", "tets.mesh", "-o", "b.vdb", "--resolution", "24", "--preview", "p.png")
        self.assertEqual(self.hash_of("a.vdb"), self.hash_of("b.vdb"))

    def test_tetrahedralize_and_repair(self):
        panels, _ = self.panels_of("tetrahedralize", "open.off", "-o", "t.msh", "--epsilon", "0.02")
        self.assertEqual(panels, ["input", "tets"])
        panels, rows = self.panels_of("repair", "open.off", "-o", "r.stl", "--resolution", "32")
        self.assertEqual(panels, ["input", "repaired"])
        self.assertTrue(any(is_red(p) for row in rows for p in row[:256]))
        self.assertFalse(any(is_red(p) for row in rows for p in row[256:]), "nothing is open now")

    def test_bad_previews(self):
        self.refuse(2, "voxelize", "tets.mesh", "-o", "v.vdb", "--preview", "p.jpg", says="png")
        self.refuse(7, "voxelize", "tets.mesh", "-o", "v.vdb", "--preview", "nowhere/p.png")
        self.write("a0.vtu", vtu(*lattice(1)))
        self.write("a1.vtu", vtu(*lattice(1)))
        self.refuse(2, "voxelize", "a*.vtu", "-o", "v.vdb", "--resolution", "8", "--preview", "p.png",
                    says="sequence")


class Comparisons(CommandLineTest):
    def test_volumes(self):
        self.write("one.off", off(*box_faces((0, 0, 0), (2, 1, 1))))
        self.write("two.off", off(*box_faces((1, 0, 0), (3, 1, 1))))
        for name in ("one", "two"):
            self.succeed("voxelize", f"{name}.off", "-o", f"{name}.vdb", "--voxel-size", "0.1", "--grid",
                         "density,surface", "--mesher", "winding")
        self.succeed("compare", "one.vdb", "two.vdb", "-o", "d.png", status=8)
        width, _, rows = read_png(self.path("d.png"))
        third = width // 3
        red = sum(is_red(p) for row in rows for p in row[2 * third:])
        blue = sum(is_blue(p) for row in rows for p in row[2 * third:])
        self.assertGreater(red, 500)
        self.assertGreater(blue, 500)
        self.assertEqual(sum(is_red(p) or is_blue(p) for row in rows for p in row[:2 * third]), 0)
        self.succeed("compare", "one.vdb", "one.vdb", "-o", "s.png")
        _, _, rows = read_png(self.path("s.png"))
        self.assertEqual(sum(is_red(p) or is_blue(p) for row in rows for p in row), 0)

    def test_values(self):
        points, tets = lattice(2)
        for name, factor in (("a", 1.0), ("b", 1.5)):
            data = "\n".join(f"{factor * p[0]!r}" for p in points)
            text = vtu(points, tets).replace(
                "</Piece>", f'<PointData><DataArray type="Float64" Name="T" format="ascii">{data}'
                            "</DataArray></PointData></Piece>")
            self.write(f"{name}.vtu", text)
            self.succeed("voxelize", f"{name}.vtu", "-o", f"{name}.vdb", "--grid", "T", "--voxel-size", "0.05")
        report = self.succeed("compare", "a.vdb", "b.vdb", "-o", "d.png", status=8)
        self.assertIn("with other values", report.out)
        width, _, rows = read_png(self.path("d.png"))
        # In the last panel the yellow end of viridis, in whatever light.
        last = [p for row in rows for p in row[2 * width // 3:]]
        self.assertTrue(any(p[0] > 120 and min(p[:2]) > 2.5 * p[2] for p in last))

    def test_meshes(self):
        self.write("ball.off", off(*ball()))
        self.write("larger.off", off(*ball(1.1)))
        self.succeed("compare", "ball.off", "larger.off", "-o", "d.png", status=8)
        width, height, _ = read_png(self.path("d.png"))
        self.assertGreater(width, height)
        self.refuse(2, "compare", "ball.off", "larger.off", "-o", "d.jpg", says="png")


if __name__ == "__main__":
    unittest.main()
