# SPDX-License-Identifier: Apache-2.0
"""Meshes that are prepared part by part give the bytes of the mesh read as a whole."""

import base64
import os
import resource
import signal
import struct
import subprocess
import time
import unittest
import zlib
from random import Random

from program import PROGRAM, SANITIZED, SCALE, CommandLineTest
from test_huge import peak_of, writes

TRIANGLE, TETRA, VOXEL, HEXAHEDRON, WEDGE, PYRAMID = 5, 10, 11, 12, 13, 14  # of VTK
TETS_OF_CUBE = ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2))


class Mesh:
    """A block of cubes of six tets, some of them turned over, with values; triangles on one side."""

    def __init__(self, nx, ny, nz, place):
        at = lambda x, y, z: (x * (ny + 1) + y) * (nz + 1) + z
        self.points = [place(x, y, z) for x in range(nx + 1) for y in range(ny + 1) for z in range(nz + 1)]
        self.tets = []
        for x in range(nx):
            for y in range(ny):
                for z in range(nz):
                    for path in TETS_OF_CUBE:
                        corner, tet = [x, y, z], [at(x, y, z)]
                        for axis in path:
                            corner[axis] += 1
                            tet.append(at(*corner))
                        self.tets.append(tet)
        self.triangles = [[at(0, y, z), at(0, y + 1, z), at(0, y, z + 1)] for y in range(ny) for z in range(nz)]
        self.cells = self.triangles[::2] + self.tets[: len(self.tets) // 2] + self.triangles[1::2] + \
            self.tets[len(self.tets) // 2:]
        self.types = [TETRA if len(cell) == 4 else TRIANGLE for cell in self.cells]

    def heat(self):
        return [0.25 * i % 17 - 3 for i in range(len(self.points))]

    def region(self):
        return [i // 40 % 3 + 1 for i in range(len(self.cells))]


class MixedMesh(Mesh):
    """A block of cubes, each one hexahedron, two wedges, six pyramids or six tets; triangles among them.

    Wedges and tets have the diagonals of faces that the smallest vertices of their neighbours choose where
    `place` keeps the order of points; points are moved within their cubes, so that faces are warped.
    """

    def __init__(self, nx, ny, nz, place, voxels=False, seed=3):
        random = Random(seed)
        at = lambda x, y, z: (x * (ny + 1) + y) * (nz + 1) + z
        move = lambda n: 0 if voxels else random.uniform(-0.1, 0.1)
        self.points = [place(x + move(x), y + move(y), z + move(z))
                       for x in range(nx + 1) for y in range(ny + 1) for z in range(nz + 1)]
        self.cells, self.types = [], []
        for x in range(nx):
            for y in range(ny):
                for z in range(nz):
                    corner = lambda i: at(x + (i in (1, 2, 5, 6)), y + (i in (2, 3, 6, 7)), z + (i > 3))
                    self.cube([corner(i) for i in range(8)], random.choice("hhwptv" if voxels else "hhwpt"))

    def cube(self, at, kind):
        add = lambda kind, places: (self.types.append(kind), self.cells.append([at[i] for i in places]))
        if kind == "h":
            add(HEXAHEDRON, range(8))
        elif kind == "v":
            add(VOXEL, (0, 1, 3, 2, 4, 5, 7, 6))
        elif kind == "w":
            add(WEDGE, (0, 1, 2, 4, 5, 6))
            add(WEDGE, (0, 2, 3, 4, 6, 7))
        elif kind == "p":
            at = at + [len(self.points)]
            self.points.append(tuple(sum(self.points[i][k] for i in at[:8]) / 8 for k in range(3)))
            add = lambda kind, places: (self.types.append(kind), self.cells.append([at[i] for i in places]))
            for base in ((0, 1, 2, 3), (4, 7, 6, 5), (0, 4, 5, 1), (1, 5, 6, 2), (2, 6, 7, 3), (3, 7, 4, 0)):
                add(PYRAMID, base + (8,))
        else:
            add(TRIANGLE, (0, 1, 2))
            for a, b in ((1, 2), (2, 3), (3, 7), (7, 4), (4, 5), (5, 1)):
                add(TETRA, (0, a, b, 6))


def turned(scale, shift):
    def place(x, y, z):
        x, y, z = (c * s for c, s in zip((x, y, z), scale))
        return (x * 0.8 - y * 0.6 + shift[0], x * 0.48 + y * 0.64 - z * 0.6 + shift[1],
                x * 0.36 + y * 0.48 + z * 0.8 + shift[2])
    return place


def vtu(mesh, encoding, compressor=None, order="<", wide=True, pieces=1):
    """The mesh as .vtu: encoding ascii, binary (inline base64), raw or base64 (appended)."""
    appended = bytearray()
    header = order + ("Q" if wide else "I")
    word = lambda *numbers: b"".join(struct.pack(header, n) for n in numbers)

    def encoded(data):
        if compressor:
            blocks = [data[i:i + 1000] for i in range(0, len(data), 1000)]
            packed = [zlib.compress(b) for b in blocks]
            last = len(blocks[-1]) % 1000 if blocks else 0
            head, body = word(len(blocks), 1000, last, *map(len, packed)), b"".join(packed)
        else:
            head, body = word(len(data)), data
        if encoding == "raw":
            return head + body
        return base64.b64encode(head) + base64.b64encode(body) if compressor else base64.b64encode(head + body)

    def array(name, kind, numbers, components=1):
        form = {"Float32": "f", "Float64": "d", "Int32": "i", "Int64": "q", "UInt8": "B"}[kind]
        start = '<DataArray type="%s" Name="%s" NumberOfComponents="%d" ' % (kind, name, components)
        if encoding == "ascii":
            return start + 'format="ascii">' + " ".join(map(repr, numbers)) + "</DataArray>"
        data = encoded(struct.pack(order + str(len(numbers)) + form, *numbers))
        if encoding == "binary":
            return start + 'format="binary">' + data.decode() + "</DataArray>"
        offset = len(appended)
        appended.extend(data)
        return start + 'format="appended" offset="%d"/>' % offset

    flat = lambda rows: [n for row in rows for n in row]
    text = '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="%s" header_type="%s"%s><UnstructuredGrid>' % (
        "LittleEndian" if order == "<" else "BigEndian", "UInt64" if wide else "UInt32",
        ' compressor="vtkZLibDataCompressor"' if compressor else "")
    for piece in range(pieces):
        cells = mesh.cells[piece::pieces]
        ends, end = [], 0
        for cell in cells:
            end += len(cell)
            ends.append(end)
        text += '<Piece NumberOfPoints="%d" NumberOfCells="%d">' % (len(mesh.points), len(cells))
        text += "<Points>" + array("Points", "Float64", flat(mesh.points), 3) + "</Points><Cells>"
        text += array("connectivity", "Int32", flat(cells)) + array("offsets", "Int64", ends)
        text += array("types", "UInt8", mesh.types[piece::pieces]) + "</Cells>"
        text += "<PointData>" + array("heat", "Float32", mesh.heat()) + "</PointData>"
        text += "<CellData>" + array("region", "Int32", mesh.region()[piece::pieces])
        text += array("load", "Float64", [0.5 * i for i in range(2 * len(cells))], 2) + "</CellData></Piece>"
    text += "</UnstructuredGrid>"
    if appended:
        text += '<AppendedData encoding="%s">_' % encoding
        return text.encode() + bytes(appended) + b"</AppendedData></VTKFile>"
    return (text + "</VTKFile>").encode()


def msh(mesh, version, binary, order="<", first=1, step=1, data=True):
    """The mesh as Gmsh's .msh, nodes numbered from `first` by `step`."""
    out = ["$MeshFormat\n%s %d 8\n" % (version, binary)]
    raw = lambda form, *numbers: out.append(struct.pack(order + form, *numbers))
    line = lambda *words: out.append(" ".join(map(repr, words)) + "\n")
    number = lambda i: first + step * i
    if binary:
        raw("i", 1)
        out.append("\n")
    out.append("$EndMeshFormat\n$Nodes\n")
    many = len(mesh.points)
    if version == "4.1":
        head = (1, many, first, number(many - 1))
        if binary:
            raw("4Q", *head)
            raw("3iQ", 3, 1, 0, many)
            raw("%dQ" % many, *map(number, range(many)))
            for p in mesh.points:
                raw("3d", *p)
            out.append("\n")
        else:
            line(*head)
            line(3, 1, 0, many)
            for i in range(many):
                line(number(i))
            for p in mesh.points:
                line(*p)
    else:
        line(many)
        for i, p in enumerate(mesh.points):
            raw("i3d", number(i), *p) if binary else line(number(i), *p)
        if binary:
            out.append("\n")
    out.append("$EndNodes\n$Elements\n")
    runs = []  # of cells of one type and region
    for i, key in enumerate(zip(mesh.types, mesh.region())):
        if runs and runs[-1][0] == key:
            runs[-1][1].append(i)
        else:
            runs.append((key, [i]))
    kind = {TRIANGLE: 2, TETRA: 4, HEXAHEDRON: 5, WEDGE: 6, PYRAMID: 7}
    if version == "4.1":
        head = (len(runs), len(mesh.cells), 1, len(mesh.cells))
        raw("4Q", *head) if binary else line(*head)
        for (shape, region), cells in runs:
            block = (2 if shape == TRIANGLE else 3, region, kind[shape], len(cells))
            raw("3iQ", *block) if binary else line(*block)
            for i in cells:
                row = (i + 1, *map(number, mesh.cells[i]))
                raw("%dQ" % len(row), *row) if binary else line(*row)
    else:
        line(len(mesh.cells))
        for (shape, region), cells in runs:
            if binary:
                raw("3i", kind[shape], len(cells), 2)
            for i in cells:
                row = (i + 1, region, region, *map(number, mesh.cells[i]))
                raw("%di" % len(row), *row) if binary else line(row[0], kind[shape], 2, *row[1:])
    if binary:
        out.append("\n")
    out.append("$EndElements\n")
    for section, name, values in (("NodeData", "heat", mesh.heat()),
                                  ("ElementData", "load", [0.5 * i for i in range(len(mesh.cells))])):
        if not data:
            continue
        out.append('$%s\n1\n"%s"\n1\n0.0\n3\n0\n1\n%d\n' % (section, name, len(values)))
        for i, value in enumerate(values):
            which = number(i) if section == "NodeData" else i + 1
            raw("id", which, value) if binary else line(which, value)
        if binary:
            out.append("\n")
        out.append("$End%s\n" % section)
    return b"".join(part.encode() if isinstance(part, str) else part for part in out)


class Prepared(CommandLineTest):
    SIZE = ("--voxel-size", "1")
    GRIDS = ("--grid", "mask,tet_id,material,heat,load")

    def setUp(self):
        super().setUp()
        self.mesh = Mesh(12, 3, 2, turned((12, 9, 10), (-60, -20, -70)))

    def expect_same(self, name, *more, size=SIZE, grids=GRIDS, shards=0):
        self.succeed("voxelize", name, "-o", "whole.vdb", *size, *grids, *more)
        self.succeed("plan", name, "--prepare", "parts", *size, *grids, *more)
        self.succeed("voxelize", "parts", "-o", "out.vdb", *grids)
        expected = self.path("whole.vdb").read_bytes()
        self.assertTrue(self.path("out.vdb").read_bytes() == expected, name)
        if shards == 0:
            return
        for i in range(shards):
            self.succeed("voxelize", "parts", "-o", "shard.vdb", *grids, "--shard", "%d/%d" % (i, shards))
        self.succeed("merge", *("shard.%d-of-%d.vdb" % (i, shards) for i in range(shards)), "-o", "merged.vdb")
        self.assertTrue(self.path("merged.vdb").read_bytes() == expected, name)

    def test_encodings_of_vtu(self):
        for encoding in ("ascii", "binary", "raw", "base64"):
            for compressor, order, wide in ((None, "<", True), (None, ">", False), ("zlib", "<", False)):
                if encoding == "ascii" and (compressor or order == ">"):
                    continue
                self.write("mesh.vtu", vtu(self.mesh, encoding, compressor, order, wide))
                self.expect_same("mesh.vtu")

    def test_pieces_of_vtu(self):
        self.write("mesh.vtu", vtu(self.mesh, "raw", pieces=3))
        self.expect_same("mesh.vtu")

    def test_versions_of_msh(self):
        grids = ("--grid", "mask,tet_id,material,heat,load")
        for version in ("2.2", "4.1"):
            for binary in (False, True):
                for order in ("<", ">")[:1 + binary]:
                    self.write("mesh.msh", msh(self.mesh, version, binary, order))
                    self.expect_same("mesh.msh", grids=grids)
        self.write("mesh.msh", msh(self.mesh, "2.2", True, first=7, step=3))
        self.expect_same("mesh.msh", grids=grids)

    def test_hexahedra_wedges_and_pyramids(self):
        # Warped cells in no order, and VTK's voxels.
        mixed = MixedMesh(12, 4, 3, turned((12, 9, 10), (-60, -20, -70)))
        boxes = MixedMesh(12, 4, 3, lambda x, y, z: (11.5 * x - 40, 9.25 * y + 3, 10 * z - 7), voxels=True)
        for name, mesh in (("mixed.vtu", mixed), ("boxes.vtu", boxes)):
            self.write(name, vtu(mesh, "raw", pieces=2))
        for grids in (self.GRIDS, ("--grid", "density"), ("--grid", "surface,coverage,fog"), ("--grid", "heat"),
                      ("--grid", "load,material")):
            self.expect_same("mixed.vtu", grids=grids, shards=2)
        self.expect_same("boxes.vtu", shards=2)
        self.write("mixed.vtu", vtu(mixed, "raw", "zlib"))
        self.expect_same("mixed.vtu", "--up-axis", "y", size=("--resolution", "150"))
        for version in ("2.2", "4.1"):
            self.write("mixed.msh", msh(mixed, version, True, first=5, step=2))
            self.expect_same("mixed.msh")
        # Voxels larger than most cells: the ranges of arrays are those of all points and cells in use.
        mapped = ("--grid", "heat,load:magnitude,material", "--remap", "0:1")
        self.write("mixed.vtu", vtu(mixed, "raw"))
        self.succeed("voxelize", "mixed.vtu", "-o", "whole.vdb", "--voxel-size", "31", *mapped)
        self.succeed("plan", "mixed.vtu", "--prepare", "parts", "--voxel-size", "31", *mapped)
        self.succeed("voxelize", "parts", "-o", "out.vdb", *mapped)
        self.assertTrue(self.path("out.vdb").read_bytes() == self.path("whole.vdb").read_bytes())

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_mixed_cells_in_several_parts(self):
        mesh = MixedMesh(60, 14, 12, turned((6, 6, 6), (200, 200, 200)))
        self.write("mesh.vtu", vtu(mesh, "raw"))
        grids = ("--grid", "tet_id,heat")
        self.succeed("voxelize", "mesh.vtu", "-o", "whole.vdb", *self.SIZE, *grids)
        made = self.report_of("plan", "mesh.vtu", "--prepare", "parts", *self.SIZE, *grids, "--max-memory",
                              "130M")["prepared"]
        self.assertGreaterEqual(made["parts"], 2)
        self.succeed("voxelize", "parts", "-o", "out.vdb", *grids, "--max-memory", "200M")
        self.assertTrue(self.path("out.vdb").read_bytes() == self.path("whole.vdb").read_bytes())

    def test_shards_of_several_cubes(self):
        mesh = Mesh(90, 1, 1, turned((100, 30, 30), (-4000, -2900, -1700)))
        self.write("mesh.vtu", vtu(mesh, "raw"))
        self.expect_same("mesh.vtu", shards=3)
        if SCALE > 1:
            self.expect_same("mesh.vtu", grids=("--grid", "mask"), shards=2)
        self.expect_same("mesh.vtu", grids=("--grid", "surface,tet_id"), shards=2)
        shards = self.report_of("plan", "parts", "--shards", "3", "--grid", "tet_id")["shards"]
        self.assertAlmostEqual(sum(s["share"] for s in shards), 1)

    def test_a_whole_box(self):
        self.write("mesh.vtu", vtu(self.mesh, "raw"))
        self.expect_same("mesh.vtu", grids=("--grid", "surface,tet_id", "--half-width", "all"), shards=2)

    def test_the_size_follows_from_the_resolution_and_the_axes(self):
        self.write("mesh.vtu", vtu(self.mesh, "raw"))
        self.expect_same("mesh.vtu", "--up-axis", "y", size=("--resolution", "100", "--origin", "3,2,1"))

    def test_tiles_and_levels(self):
        self.write("mesh.vtu", vtu(self.mesh, "raw"))
        self.succeed("plan", "mesh.vtu", "--prepare", "parts", *self.SIZE, "--grid", "mask")
        for source, size in (("mesh.vtu", self.SIZE), ("parts", ())):
            self.succeed("voxelize", source, "-o", source + ".vdb", *size, "--grid", "mask", "--lod", "1:3")
        self.assertTrue(self.path("mesh.vtu.vdb").read_bytes() == self.path("parts.vdb").read_bytes())
        for source, size in (("mesh.vtu", self.SIZE), ("parts", ())):
            self.succeed("voxelize", source, "-o", source + ".nvdb", *size, "--grid", "mask,coverage", "--lod", "1:3")
        self.assertTrue(self.path("mesh.vtu.nvdb").read_bytes() == self.path("parts.nvdb").read_bytes())

    def test_tiles_of_values(self):
        mesh = Mesh(60, 2, 2, turned((12, 12, 12), (300, -200, 200)))
        self.write("mesh.vtu", vtu(mesh, "raw"))
        grids = ("--grid", "tet_id,heat,coverage,mask")
        limit = () if SANITIZED else ("--max-memory", "100M") # shadow memory counts
        self.succeed("plan", "mesh.vtu", "--prepare", "parts", *self.SIZE, *grids, *limit)
        for size, more in ((512, ()), (4096, ()), (1024, ("--grid", "heat,coverage", "--lod", "1:4"))):
            made = []
            for source, options in (("mesh.vtu", self.SIZE), ("parts", ())):
                self.succeed("voxelize", source, "--tiles", "tiles", "--tile-size", size, *options, *(more or grids))
                made.append({path.name: path.read_bytes() for path in self.path("tiles").iterdir()})
            self.assertGreater(len(made[0]), 1 + (size < 4096))
            self.assertTrue(made[0] == made[1], size)

    def test_the_report(self):
        self.write("mesh.vtu", vtu(self.mesh, "raw"))
        report = self.report_of("plan", "mesh.vtu", "--prepare", "parts", "--shards", "2", *self.SIZE, *self.GRIDS)
        prepared = report["prepared"]
        self.assertEqual(prepared["tets"], len(self.mesh.tets))
        self.assertEqual(prepared["points"], len(self.mesh.points))
        self.assertEqual(prepared["arrays"], ["heat", "load"])
        self.assertEqual(prepared["bytes"], sum(p.stat().st_size for p in self.path("parts").iterdir()
                                                if p.name != "prepared.json"))
        self.assertEqual(len(report["shards"]), 2)
        # A derived array, whose range is found in the parts, and one that was not prepared.
        self.succeed("voxelize", "parts", "-o", "a.vdb", "--grid", "load:magnitude")
        self.succeed("voxelize", "mesh.vtu", "-o", "b.vdb", *self.SIZE, "--grid", "load:magnitude")
        self.assertTrue(self.path("a.vdb").read_bytes() == self.path("b.vdb").read_bytes())
        self.refuse(2, "voxelize", "parts", "-o", "c.vdb", "--grid", "cold", says=("cold", "heat"))

    def test_nanovdb(self):
        self.write("mesh.vtu", vtu(self.mesh, "raw"))
        self.succeed("plan", "mesh.vtu", "--prepare", "parts", *self.SIZE, "--grid", "tet_id,heat")
        for grid in ("density", "tet_id", "heat"):
            self.succeed("voxelize", "parts", "-o", "a.nvdb", "--grid", grid)
            self.succeed("voxelize", "mesh.vtu", "-o", "b.nvdb", *self.SIZE, "--grid", grid)
            self.assertTrue(self.path("a.nvdb").read_bytes() == self.path("b.nvdb").read_bytes(), grid)

    def test_what_is_refused(self):
        self.write("mesh.vtu", vtu(self.mesh, "raw"))
        prepare = ("plan", "mesh.vtu", "--prepare", "parts", *self.SIZE)
        self.refuse(2, *prepare, "--region", "1", says=("--region",))
        self.refuse(2, "plan", "mesh.vtu", says=("--shards",))
        self.write("ball.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n")
        self.refuse(2, "plan", "ball.off", "--prepare", "parts", *self.SIZE, says=("part by part", ".vtu"))
        self.path("other").mkdir()
        self.write("other/mine.txt", "")
        self.refuse(2, "plan", "mesh.vtu", "--prepare", "other", *self.SIZE, says=("mine.txt",))
        self.succeed(*prepare, "--grid", "mask")
        self.succeed(*prepare, "--grid", "mask")  # in place of the one before
        for more in (("--resolution", "256"), ("--voxel-size", "2"), ("--origin", "1,2,3"), ("--up-axis", "y"),
                     ("--grid", "tet_id"), ("--grid", "heat"), ("--region", "1"), ("--preview", "a.png")):
            self.refuse(2, "voxelize", "parts", "-o", "a.vdb", *more)
        self.refuse(2, "voxelize", "parts", "mesh.vtu", "-o", "a.vdb", "--union", says=("parts",))
        boundary = self.path("parts/boundary.bin")
        whole = boundary.read_bytes()
        boundary.write_bytes(whole[:-8])
        self.refuse(3, "voxelize", "parts", "-o", "a.vdb", says=("boundary.bin",))
        boundary.write_bytes(whole[:-8] + b"12345678")
        self.refuse(3, "voxelize", "parts", "-o", "a.vdb", says=("boundary.bin",))
        boundary.unlink()
        self.refuse(3, "voxelize", "parts", "-o", "a.vdb", says=("boundary.bin",))

    def test_files_that_are_cut_or_hold_other_cells(self):
        for encoding, compressor in (("raw", None), ("raw", "zlib"), ("binary", None), ("ascii", None)):
            whole = vtu(self.mesh, encoding, compressor)
            for size in (len(whole) // 4, len(whole) // 2, len(whole) * 3 // 4, len(whole) - 60):
                self.write("cut.vtu", whole[:size])
                result = self.run_program("plan", "cut.vtu", "--prepare", "parts", *self.SIZE, *self.GRIDS)
                self.assertIn(result.status, (2, 3), result.err)
                self.assertEqual(len(result.lines), 1, result.err)
                self.assertFalse(self.path("parts").exists())
        for version in ("2.2", "4.1"):
            whole = msh(self.mesh, version, True)
            for size in (len(whole) // 4, len(whole) // 2, len(whole) * 3 // 4):
                self.write("cut.msh", whole[:size])
                self.refuse(3, "plan", "cut.msh", "--prepare", "parts", *self.SIZE, *self.GRIDS)
        whole = vtu(self.mesh, "ascii")
        self.write("bad.vtu", whole.replace(b'Name="types" NumberOfComponents="1" format="ascii">5',
                                            b'Name="types" NumberOfComponents="1" format="ascii">24'))
        self.refuse(3, "plan", "bad.vtu", "--prepare", "parts", *self.SIZE, says=("tetra10", "linear tets"))
        self.write("bad.vtu", whole.replace(b'Name="types" NumberOfComponents="1" format="ascii">5',
                                            b'Name="types" NumberOfComponents="1" format="ascii">13'))
        self.refuse(3, "plan", "bad.vtu", "--prepare", "parts", *self.SIZE, says=("wedge", "6 nodes"))
        last = b" ".join(b"%d" % n for n in self.mesh.cells[-1]) + b"</DataArray>"
        self.write("bad.vtu", whole.replace(last, b"1 2 3 99999</DataArray>"))
        self.refuse(3, "plan", "bad.vtu", "--prepare", "parts", *self.SIZE, says=("refers to a point", "bad.vtu"))

    @unittest.skipIf(SANITIZED, "shadow memory counts")
    def test_budgets(self):
        # 180,000 tets: 3 MB of corners, 18 MB with what is found from them, in parts of less.
        mesh = Mesh(60, 25, 20, turned((6, 6, 6), (200, 200, 200)))
        self.write("mesh.vtu", vtu(mesh, "raw"))
        grids = ("--grid", "tet_id,heat")
        self.succeed("voxelize", "mesh.vtu", "-o", "whole.vdb", *self.SIZE, *grids)
        expected = self.path("whole.vdb").read_bytes()
        limit = ("--max-memory", "130M")
        for command in (("plan", "mesh.vtu", "--prepare", "parts", *self.SIZE), ("voxelize", "parts", "-o", "out.vdb"),
                        ("voxelize", "parts", "--tiles", "tiles", "--tile-size", "512")):
            self.assertLess(peak_of(self, *command, *grids, *limit), 130 << 20, command)
        self.assertTrue(self.path("out.vdb").read_bytes() == expected)

    def test_a_full_disk_leaves_nothing(self):
        self.write("mesh.vtu", vtu(Mesh(60, 20, 20, turned((6, 6, 6), (20, 200, 200))), "raw"))
        before = sorted(os.listdir(self.folder))
        for kilobytes in (300, 1000, 2500):
            def limit():
                resource.setrlimit(resource.RLIMIT_FSIZE, (kilobytes << 10, kilobytes << 10))

            result = self.run_program("plan", "mesh.vtu", "--prepare", "parts", *self.SIZE, *self.GRIDS,
                                      preexec_fn=limit)
            self.assertEqual(result.status, 7, result.err)
            self.assertEqual(sorted(os.listdir(self.folder)), before)

    def test_a_signal_leaves_nothing(self):
        self.write("mesh.vtu", vtu(Mesh(60, 30, 30, turned((6, 6, 6), (0, 0, 0))), "raw"))
        before = sorted(os.listdir(self.folder))
        for wait in (0.05, 0.3):
            process = subprocess.Popen([PROGRAM, "plan", "mesh.vtu", "--prepare", "parts", "--voxel-size", "0.05",
                                        "--grid", "tet_id"], cwd=self.folder, stdout=subprocess.DEVNULL,
                                       stderr=subprocess.DEVNULL)
            deadline = time.monotonic() + 60
            while not writes(self.folder, process) and process.poll() is None and time.monotonic() < deadline:
                time.sleep(0.01)
            time.sleep(wait)
            process.send_signal(signal.SIGTERM)
            status = process.wait(60)
            if status == 0:  # it was done before
                self.assertTrue(self.path("parts/prepared.json").exists())
                for path in self.path("parts").iterdir():
                    path.unlink()
                self.path("parts").rmdir()
            else:
                self.assertEqual(status, 5)
            self.assertEqual(sorted(os.listdir(self.folder)), before)


if __name__ == "__main__":
    unittest.main()
