# SPDX-License-Identifier: Apache-2.0
"""Pictures: render."""

import struct
import unittest
import zlib

from program import CommandLineTest, box_faces, gmsh, lattice, medit, off


def read_png(path):
    """Width, height and rows of (r, g, b[, a]) tuples of an 8-bit PNG, by its specification."""
    data = path.read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, header = 8, b"", None
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        assert struct.unpack(">I", data[at + 8 + size:at + 12 + size])[0] == zlib.crc32(kind + body)
        if kind == b"IHDR":
            header = struct.unpack(">IIBBBBB", body)
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    width, height, depth, color = header[:4]
    assert depth == 8 and color in (2, 6) and header[6] == 0
    channels = {2: 3, 6: 4}[color]
    raw, stride = zlib.decompress(packed), width * channels
    rows, before = [], bytes(stride)
    for y in range(height):
        kind = raw[y * (stride + 1)]
        line = bytearray(raw[y * (stride + 1) + 1:(y + 1) * (stride + 1)])
        for i in range(stride):
            left = line[i - channels] if i >= channels else 0
            up = before[i]
            corner = before[i - channels] if i >= channels else 0
            if kind == 1:
                line[i] = line[i] + left & 255
            elif kind == 2:
                line[i] = line[i] + up & 255
            elif kind == 3:
                line[i] = line[i] + (left + up) // 2 & 255
            elif kind == 4:
                guess = left + up - corner
                near = min((abs(guess - left), 0, left), (abs(guess - up), 1, up),
                           (abs(guess - corner), 2, corner))
                line[i] = line[i] + near[2] & 255
        before = bytes(line)
        rows.append([tuple(line[x * channels:(x + 1) * channels]) for x in range(width)])
    return width, height, rows


def box(low=(0, 0, 0), high=(1, 1, 1)):
    return off(*box_faces(low, high))


class Render(CommandLineTest):
    def setUp(self):
        super().setUp()
        self.write("box.off", box())

    def test_a_picture(self):
        report = self.report_of("render", "box.off", "-o", "out.png", "--view", "front",
                                "--size", "100x80", "--background", "black")
        self.assertEqual(
            list(report), ["version", "command", "status", "device", "threads", "input", "picture",
                           "stages", "output", "warnings"])
        self.assertEqual(report["input"][0]["triangles"], 12)
        self.assertEqual([s["name"] for s in report["stages"]], ["read", "scene", "render", "write"])
        picture = report["picture"]
        self.assertEqual((picture["width"], picture["height"]), (100, 80))
        self.assertEqual(report["output"][0]["path"], "out.png")
        width, height, rows = read_png(self.path("out.png"))
        self.assertEqual((width, height), (100, 80))
        self.assertEqual(report["output"][0]["bytes"], self.path("out.png").stat().st_size)
        # The square fills 92 % of the height.
        self.assertEqual(rows[40][5], (0, 0, 0))
        self.assertGreater(min(rows[40][50]), 100)
        lit = sum(min(pixel) > 50 for pixel in rows[40])
        self.assertTrue(72 <= lit <= 75, lit)

    def test_transparent_and_colours(self):
        self.succeed("render", "box.off", "-o", "a.png", "--size", "64x48", "--background",
                     "transparent")
        _, _, rows = read_png(self.path("a.png"))
        self.assertEqual(rows[0][0], (0, 0, 0, 0))
        self.assertEqual(rows[24][32][3], 255)
        self.succeed("render", "box.off", "-o", "b.png", "--size", "64x48", "--background",
                     "#ff8000,#0080ff")
        _, _, rows = read_png(self.path("b.png"))
        self.assertGreater(rows[0][0][0], 250)
        self.assertGreater(rows[47][0][2], 250)

    def test_the_same_bytes_for_any_number_of_threads(self):
        self.write("box.mesh", medit(*lattice(4)))
        files = []
        for threads in (1, 2, 5):
            name = f"{threads}.png"
            self.succeed("render", "box.mesh", "-o", name, "--size", "160x120", "--cut", "x=0.6",
                         "--color", "quality", "--wire", "--threads", threads)
            files.append(self.path(name).read_bytes())
        self.assertEqual(files[0], files[1])
        self.assertEqual(files[0], files[2])

    def test_contact_sheet(self):
        self.write("large.off", box((0, 0, 0), (2, 2, 2)))
        self.succeed("render", "box.off", "large.off", "-o", "out.png", "--view", "front",
                     "--background", "black")
        width, height, rows = read_png(self.path("out.png"))
        self.assertEqual((width, height), (1280, 480))
        widths = [sum(min(p) > 50 for p in rows[240][a:a + 640]) for a in (0, 640)]
        self.assertAlmostEqual(widths[1] / widths[0], 2, delta=0.05)
        caption = [p for row in rows[:20] for p in row[:200] if min(p) > 200]
        self.assertGreater(len(caption), 50)

    def test_turntable(self):
        self.succeed("render", "box.off", "-o", "out.png", "--turntable", 4, "--size", "64x48",
                     "--view", "1,-2,1")
        names = sorted(p.name for p in self.folder.glob("*.png"))
        self.assertEqual(names, [f"out.000{i}.png" for i in range(1, 5)])
        # A quarter turn of a cube looks the same but for the light from the sides.
        cover = [sum(p != rows[0][0] for row in rows for p in row)
                 for _, _, rows in (read_png(self.path(n)) for n in names)]
        self.assertEqual(len({c // 50 for c in cover}), 1, cover)

    def test_cut_and_values(self):
        points, tets = lattice(4)
        self.write("box.msh", gmsh(points, tets, [1 + (t % 2) for t in range(len(tets))],
                                   {1: "bone", 2: "skin"}))
        report = self.report_of("render", "box.msh", "-o", "r.png", "--color", "region",
                                "--size", "320x240")
        self.assertEqual(report["picture"]["colors"]["kinds"], ["bone", "skin"])
        report = self.report_of("render", "box.msh", "-o", "q.png", "--color", "quality",
                                "--cut", "x=0.4", "--size", "320x240")
        self.assertEqual(report["picture"]["colors"]["title"], "AMIPS energy")
        self.assertEqual(report["picture"]["subjects"][0]["cut_tets"], 4 * 4 * 6)
        same = self.path("q.png").read_bytes()
        self.succeed("render", "box.msh", "-o", "u.png", "--color", "quality", "--cut", "x=0.4u",
                     "--size", "320x240")
        self.assertEqual(self.path("u.png").read_bytes(), same)
        text = self.succeed("render", "box.msh", "-o", "q.png", "--color", "quality", "--range",
                            "3:300", "--size", "320x240").out
        self.assertIn("from 3 to 300", text)

    def test_defects(self):
        points, faces = box_faces()
        self.write("open.off", off(points, faces[:-2]))
        report = self.report_of("render", "open.off", "-o", "out.png", "--defects", "--size",
                                "200x200", "--view", "right", "--background", "white")
        self.assertEqual(report["picture"]["subjects"][0]["defects"],
                         {"open_edges": 4, "nonmanifold_edges": 0, "flipped_faces": 0})
        _, _, rows = read_png(self.path("out.png"))
        red = sum(p[0] > 180 and p[1] < 40 and p[2] < 40 for row in rows for p in row)
        # A frame of 4 x 184 pixels, three wide, of which the outer ones are red in part.
        self.assertTrue(2 * 4 * 180 <= red <= 3 * 4 * 188, red)
        self.assertIn("4 open edges", self.succeed("render", "open.off", "-o", "out.png",
                                                   "--defects").out)

    def test_what_is_refused(self):
        self.write("box.mesh", medit(*lattice(1)))
        self.refuse(2, "render", "box.off", "-o", "out.jpg", says=".png")
        self.refuse(3, "render", "missing.stl", "-o", "out.png", says="missing.stl")
        self.refuse(7, "render", "box.off", "-o", "no/out.png")
        self.refuse(2, "render", "box.off", "-o", "out.png", "--view", "above", says="above")
        self.refuse(2, "render", "box.off", "-o", "out.png", "--color", "quality", says="box.off")
        self.refuse(2, "render", "box.mesh", "-o", "out.png", "--color", "heat", says="heat")
        self.refuse(2, "render", "box.mesh", "-o", "out.png", "--defects", says="box.mesh")
        for cut in ("w=0.5", "x=2", "x=", "x", "x=0.5m", "x=nanu"):
            self.refuse(2, "render", "box.mesh", "-o", "out.png", "--cut", cut, says="--cut")
        for size in ("640", "0x5", "640x480x3", "-1x5", "99999x9"):
            self.refuse(2, "render", "box.off", "-o", "out.png", f"--size={size}", says="--size")
        for low_high in ("5", "5:1", "a:b", "1:1", "0:inf"):
            self.refuse(2, "render", "box.mesh", "-o", "out.png", "--color", "quality", "--range",
                        low_high, says="range")
        for paint in ("blue", "#12", "#12345g", "white,", "a,b"):
            self.refuse(2, "render", "box.off", "-o", "out.png", "--background", paint,
                        says="--background")
        self.refuse(2, "render", "box.mesh", "-o", "out.png", "--color", "quality", "--colormap",
                    "jet", says="viridis")
        self.refuse(3, "render", "box.mesh", "-o", "out.png", "--cut", "x=-5u", says="cut")
        self.refuse(4, "render", "box.off", "-o", "out.png", "--size", "8000x8000", "--max-memory",
                    "300M", says="memory")

    def test_an_input_is_not_overwritten(self):
        self.write("box.png", box())
        self.refuse(2, "render", "box.png", "-o", "box.png", says="input")


if __name__ == "__main__":
    unittest.main()
