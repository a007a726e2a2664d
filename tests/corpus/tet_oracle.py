#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What the corpus's tet files hold, by means other than TetVDB's readers.

    tet_oracle.py CORPUS/tet > tet_expected.tsv

VTK reads .vtk, .vtu and Exodus; small parsers here read the rest. A line a file: name, status
(mesh, or error where a reader must refuse), counts by kind of solid cell, points, and the sum of the
solid cells' absolute and signed volumes. Hexahedra, wedges and pyramids are cut here in a fixed way
from their first corner, so their volumes agree with another cut only as far as faces are plane;
`plane` is yes where no such cell is there.
"""
import os
import re
import struct
import sys

# Corners of the tets of a cell, by VTK's node order.
CUTS = {
    "tetra": [(0, 1, 2, 3)],
    "hexahedron": [(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)],
    "wedge": [(0, 1, 2, 3), (1, 2, 3, 4), (2, 3, 4, 5)],
    "pyramid": [(0, 1, 2, 4), (0, 2, 3, 4)],
}
CORNERS = {"tetra": 4, "hexahedron": 8, "wedge": 6, "pyramid": 5}

GMSH = {4: ("tetra", 4), 5: ("hexahedron", 8), 6: ("wedge", 6), 7: ("pyramid", 5), 11: ("tetra", 10)}
GMSH_FLAT = {1: 2, 2: 3, 3: 4, 8: 3, 9: 6, 10: 9, 15: 1}


def volumes(points, cells):
    signed = absolute = 0.0
    for kind, nodes in cells:
        for cut in CUTS[kind]:
            a, b, c, d = (points[nodes[i]] for i in cut)
            u, v, w = ([q[k] - a[k] for k in range(3)] for q in (b, c, d))
            volume = (u[0] * (v[1] * w[2] - v[2] * w[1]) - u[1] * (v[0] * w[2] - v[2] * w[0])
                      + u[2] * (v[0] * w[1] - v[1] * w[0])) / 6
            signed += volume
            absolute += abs(volume)
    return absolute, signed


class Gmsh:
    """Text and little-endian binary, versions 1, 2 and 4.1."""

    def __init__(self, data):
        self.data, self.at, self.version, self.binary = data, 0, 1.0, False

    def line(self):
        end = self.data.index(b"\n", self.at)
        text = self.data[self.at:end].decode("latin-1").strip()
        self.at = end + 1
        return text

    def take(self, form):
        values = struct.unpack_from("<" + form, self.data, self.at)
        self.at += struct.calcsize("<" + form)
        return values

    def words(self, n):
        """The next n words of a text file."""
        found = []
        for match in re.compile(rb"\S+").finditer(self.data, self.at):
            found.append(match.group())
            if len(found) == n:
                self.at = match.end()
                return found
        raise ValueError("the file ends early")

    def ints(self, n, form="i"):
        if n == 0:
            return []
        return list(self.take(f"{n}{form}")) if self.binary else [int(w) for w in self.words(n)]

    def reals(self, n):
        return list(self.take(f"{n}d")) if self.binary else [float(w) for w in self.words(n)]

    def section(self, name):
        at = re.search(rb"^\$" + name + rb"[ \r]*$", self.data, re.M)
        if not at:
            at = re.search(rb"\$" + name + rb"\r?\n", self.data)
        if at:
            self.at = at.end() + (1 if self.data[at.end():at.end() + 1] == b"\n" else 0)
        return bool(at)

    def finish(self, name):
        if self.words(1)[0] != b"$End" + name:
            raise ValueError("section does not end")

    def read(self):
        if self.section(b"MeshFormat"):
            version, kind, _ = self.line().split()
            self.version, self.binary = float(version), kind == "1"
        points, cells = {}, []
        if self.version < 2:
            self.section(b"NOD")
            for _ in range(self.ints(1)[0]):
                number, *xyz = self.words(4)
                points[int(number)] = [float(x) for x in xyz]
            self.section(b"ELM")
            for _ in range(self.ints(1)[0]):
                _, kind, _, _, n = self.ints(5)
                self.add(cells, kind, self.ints(n))
        elif self.version < 4:
            self.section(b"Nodes")
            for _ in range(int(self.line())):
                number = self.ints(1)[0]
                points[number] = self.reals(3)
            self.finish(b"Nodes")
            self.section(b"Elements")
            left = int(self.line())
            while left > 0:
                if self.binary:
                    kind, follow, tags = self.ints(3)
                else:
                    _, kind, tags = self.ints(3)
                    follow = 1
                nodes = GMSH[kind][1] if kind in GMSH else GMSH_FLAT[kind]
                for _ in range(follow):
                    if self.binary:
                        self.ints(1)
                    self.ints(tags)
                    self.add(cells, kind, self.ints(nodes))
                left -= follow
            self.finish(b"Elements")
        else:
            self.section(b"Nodes")
            blocks, total, _, _ = self.ints(4, "Q")
            for _ in range(blocks):
                dimension, _, parametric = self.ints(3)
                n = self.ints(1, "Q")[0]
                numbers = self.ints(n, "Q")
                for number in numbers:
                    points[number] = self.reals(3)
                    if parametric:
                        self.reals(dimension)
            if len(points) != total:
                raise ValueError("wrong number of nodes")
            self.finish(b"Nodes")
            self.section(b"Elements")
            blocks, total, _, _ = self.ints(4, "Q")
            for _ in range(blocks):
                _, _, kind = self.ints(3)
                nodes = GMSH[kind][1] if kind in GMSH else GMSH_FLAT[kind]
                for _ in range(self.ints(1, "Q")[0]):
                    self.add(cells, kind, self.ints(1 + nodes, "Q")[1:])
            self.finish(b"Elements")
        return points, cells

    def add(self, cells, kind, nodes):
        if kind in GMSH:
            name = GMSH[kind][0]
            cells.append((name, nodes[:CORNERS[name]]))


MEDIT = {"Tetrahedra": ("tetra", 4), "Hexahedra": ("hexahedron", 8), "Prisms": ("wedge", 6),
         "Pyramids": ("pyramid", 5), "Edges": (None, 2), "Triangles": (None, 3),
         "Quadrilaterals": (None, 4)}


def read_medit(data):
    words = iter(re.sub(rb"#[^\n]*", b"", data).decode("latin-1").split())
    points, cells = {}, []
    for word in words:
        if word == "Vertices":
            for i in range(int(next(words))):
                points[i + 1] = [float(next(words)) for _ in range(3)]
                next(words)
        elif word in MEDIT:
            kind, nodes = MEDIT[word]
            for _ in range(int(next(words))):
                numbers = [int(next(words)) for _ in range(nodes + 1)][:-1]
                if kind:
                    cells.append((kind, numbers))
    return points, cells


def read_medit_binary(data):
    """Versions 1 and 2, either byte order."""
    codes = {8: ("tetra", 4), 10: ("hexahedron", 8), 9: ("wedge", 6), 49: ("pyramid", 5)}
    order = "<" if data[0] == 1 else ">"
    version, = struct.unpack_from(order + "i", data, 4)
    real = "f" if version == 1 else "d"
    at, points, cells = 8, {}, []
    while at < len(data):
        code, following = struct.unpack_from(order + "ii", data, at)
        if code == 54:
            break
        count, = struct.unpack_from(order + "i", data, at + 8)
        form = None
        if code == 4:
            form = order + "3" + real + "i"
        elif code in codes:
            form = f"{order}{codes[code][1] + 1}i"
        if form:
            if at + 12 + count * struct.calcsize(form) > len(data):
                raise ValueError("cut off")
            rows = struct.iter_unpack(form, data[at + 12:at + 12 + count * struct.calcsize(form)])
            for i, row in enumerate(rows):
                if code == 4:
                    points[i + 1] = row[:3]
                else:
                    cells.append((codes[code][0], row[:-1]))
        if following == 0:
            break
        if following <= at or following > len(data):
            raise ValueError("keyword out of place")
        at = following
    if not cells:
        raise ValueError("no solid cells")
    return points, cells


def read_tetgen(path):
    base = os.path.splitext(path)[0]

    def rows(name):
        for line in open(name):
            line = line.split("#")[0].split()
            if line:
                yield line

    nodes, tets = rows(base + ".node"), rows(base + ".ele")
    count = int(next(nodes)[0])
    points = {}
    for _, row in zip(range(count), nodes):
        points[int(row[0])] = [float(x) for x in row[1:4]]
    count = int(next(tets)[0])
    return points, [("tetra", [int(x) for x in row[1:5]]) for _, row in zip(range(count), tets)]


def read_abaqus(text):
    points, cells, mode = {}, [], None
    for line in text.splitlines():
        if line.startswith("*"):
            key = line.upper().replace(" ", "")
            mode = "node" if key.startswith("*NODE") else "tet" if "TYPE=C3D4" in key else None
        elif mode:
            fields = line.split(",")
            if mode == "node":
                points[int(fields[0])] = [float(x) for x in fields[1:4]]
            else:
                cells.append(("tetra", [int(x) for x in fields[1:5]]))
    return points, cells


def read_vtk(path):
    import vtkmodules.vtkCommonDataModel as dm
    kinds = {dm.VTK_TETRA: "tetra", dm.VTK_QUADRATIC_TETRA: "tetra", dm.VTK_HEXAHEDRON: "hexahedron",
             dm.VTK_QUADRATIC_HEXAHEDRON: "hexahedron", dm.VTK_TRIQUADRATIC_HEXAHEDRON: "hexahedron",
             dm.VTK_WEDGE: "wedge", dm.VTK_QUADRATIC_WEDGE: "wedge",
             dm.VTK_BIQUADRATIC_QUADRATIC_WEDGE: "wedge", dm.VTK_PYRAMID: "pyramid",
             dm.VTK_QUADRATIC_PYRAMID: "pyramid"}
    if path.endswith(".vtk"):
        from vtkmodules.vtkIOLegacy import vtkUnstructuredGridReader
        reader = vtkUnstructuredGridReader()
    elif path.endswith(".vtu"):
        from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
        reader = vtkXMLUnstructuredGridReader()
    else:
        from vtkmodules.vtkIOExodus import vtkExodusIIReader
        reader = vtkExodusIIReader()
    reader.SetFileName(path)
    reader.Update()
    data = reader.GetOutput()
    blocks = []
    if data.IsA("vtkMultiBlockDataSet"):
        walk = data.NewIterator()
        while not walk.IsDoneWithTraversal():
            blocks.append(walk.GetCurrentDataObject())
            walk.GoToNextItem()
    else:
        blocks = [data]
    points, cells = {}, []
    for block in blocks:
        first = len(points)
        for i in range(block.GetNumberOfPoints()):
            points[first + i] = block.GetPoint(i)
        for i in range(block.GetNumberOfCells()):
            kind = kinds.get(block.GetCellType(i))
            if kind:
                ids = block.GetCell(i).GetPointIds()
                cells.append((kind, [first + ids.GetId(k) for k in range(CORNERS[kind])]))
    return points, cells


def read_bullet(path):
    """A legacy file whose first line VTK refuses, for want of a blank after '#'."""
    text = open(path, "rb").read().replace(b"#vtk", b"# vtk", 1)
    words = iter(text.split(b"\n", 4)[-1].split())
    points, cells = {}, []
    for word in words:
        if word == b"POINTS":
            count = int(next(words))
            next(words)
            for i in range(count):
                points[i] = [float(next(words)) for _ in range(3)]
        elif word == b"CELLS":
            count = int(next(words))
            next(words)
            for _ in range(count):
                n = int(next(words))
                nodes = [int(next(words)) for _ in range(n)]
                if n == 4:
                    cells.append(("tetra", nodes))
    return points, cells


def read(path):
    data = open(path, "rb").read()
    if path.endswith("beam_mesh.vtk"):
        return read_bullet(path)
    if path.endswith((".vtk", ".vtu", ".exo", ".e")):
        return read_vtk(path)
    if path.endswith(".msh"):
        return Gmsh(data).read()
    if path.endswith(".mesh"):
        return read_medit(data)
    if path.endswith(".meshb"):
        return read_medit_binary(data)
    if path.endswith((".node", ".ele")):
        return read_tetgen(path)
    if path.endswith(".inp"):
        return read_abaqus(data.decode("latin-1"))
    raise ValueError("no solid cells")


def main():
    folder = sys.argv[1]
    print("file\tstatus\ttetra\thexahedron\twedge\tpyramid\tvolume\tsigned\tplane")
    for name in sorted(os.listdir(folder)):
        try:
            points, cells = read(os.path.join(folder, name))
            if not cells:
                raise ValueError("no solid cells")
            counts = [sum(1 for kind, _ in cells if kind == wanted) for wanted in CORNERS]
            absolute, signed = volumes(points, cells)
            plane = "yes" if counts[0] == len(cells) else "no"
            print(name, "mesh", *counts, f"{absolute:.15g}", f"{signed:.15g}", plane, sep="\t")
        except Exception as error:
            print(f"{name}: {error}", file=sys.stderr)
            print(name, "error", *["-"] * 7, sep="\t")


main()
