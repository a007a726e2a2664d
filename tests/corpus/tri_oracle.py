#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What the corpus's triangle files hold, by means other than TetVDB's readers.

    tri_oracle.py CORPUS/tri > tri_expected.tsv

A line a file: name, status (`mesh`; `partial` where something had to be left out; `error` where a
reader must refuse), points, triangles (n-gons as fans), polygons, signed volume (the sum over the
triangles of det(a, b, c) / 6) and the sum of its terms' absolute values, which says how exact the
first can be. Polygons that name a vertex that does not exist or is not finite, or that have fewer
than three corners, do not count; vertices that are not finite do, as (0, 0, 0).
"""
import math
import os
import re
import struct
import sys
import xml.etree.ElementTree as ET
import zipfile


class Refused(Exception):
    pass


class Mesh:
    """Points (None where unreadable) and polygons of indices (None where unreadable)."""

    def __init__(self):
        self.points, self.polygons, self.cut = [], [], False
        # Of beams and balls: numbers of points and triangles, volumes, and what their triangles' terms add up to.
        self.lattice = []

    def result(self):
        points = [p if p and all(map(math.isfinite, p)) else None for p in self.points]
        good = [q for q in self.polygons
                if len(q) > 2 and all(i is not None and 0 <= i < len(points) and points[i] for i in q)]
        if not good:
            raise Refused("no faces")
        terms = []
        for polygon in good:
            a = points[polygon[0]]
            for j in range(1, len(polygon) - 1):
                b, c = points[polygon[j]], points[polygon[j + 1]]
                terms.append((a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
                              + a[2] * (b[0] * c[1] - b[1] * c[0])) / 6)
        partial = self.cut or len(good) < len(self.polygons)
        more_points, triangles, volume, absolute = (math.fsum(column) for column in zip((0,) * 4, *self.lattice))
        return ("partial" if partial else "mesh", len(points) + int(more_points), len(terms) + int(triangles),
                len(good) + int(triangles), math.fsum(terms) + volume, math.fsum(map(abs, terms)) + absolute)


def number(word):
    try:
        return float(word)
    except ValueError:
        return math.nan


def whole(word):
    try:
        return int(word)
    except ValueError:
        return None


def soup(facets, cut):
    """A mesh of its own three points a facet; facets that are not finite are gone, points and all."""
    mesh = Mesh()
    good = [f for f in facets if len(f) == 3 and all(math.isfinite(x) for p in f for x in p)]
    for facet in good:
        mesh.polygons.append(list(range(len(mesh.points), len(mesh.points) + 3)))
        mesh.points += facet
    mesh.cut = cut or len(good) < len(facets)
    return mesh


def stl(data):
    room = len(data) - 84
    declared = struct.unpack_from("<I", data, 80)[0] if room >= 0 else 0
    if room != 50 * declared and re.search(rb"\bvertex\s", data[:2000], re.I):
        text = data.decode("latin-1")
        facets = []
        for loop in re.findall(r"\bouter\s+loop\b(.*?)\bendloop\b", text, re.I | re.S):
            facets.append([[number(w) for w in (line.split() + ["nan"] * 3)[:3]]
                           for line in re.split(r"vertex", loop, flags=re.I)[1:]])
        return soup(facets, not re.search(r"\bendsolid\b", text, re.I))
    n = min(declared, room // 50)
    facets = []
    for i in range(n):
        values = struct.unpack_from("<9f", data, 84 + 50 * i + 12)
        facets.append([values[0:3], values[3:6], values[6:9]])
    return soup(facets, n < declared)


def obj(data):
    mesh = Mesh()
    text = data.decode("latin-1").replace("\\\r\n", " ").replace("\\\n", " ")
    for line in text.splitlines():
        words = line.split("#")[0].split()
        if words[:1] == ["v"]:
            mesh.points.append([number(w) for w in words[1:4]] if len(words) > 3 else None)
        elif words[:1] == ["f"]:
            polygon = []
            for word in words[1:]:
                i = whole(word.split("/")[0])
                polygon.append(None if not i else i - 1 if i > 0 else len(mesh.points) + i)
            mesh.polygons.append(polygon)
    return mesh


def off(data):
    lines = [line.split("#")[0].split() for line in data.decode("latin-1").splitlines()]
    lines = [line for line in lines if line]
    glued = re.match(r"OFF(\d.*)", lines[0][0])
    head = ([glued[1]] if glued else []) + lines[0][1:]
    rest = lines[1:]
    if not head:
        head, rest = rest[0], rest[1:]
    n, faces = int(head[0]), int(head[1])
    if n > len(rest):
        raise Refused("vertices missing")
    mesh = Mesh()
    mesh.points = [[number(w) for w in line[:3]] for line in rest[:n]]
    rows = rest[n:n + faces]
    mesh.polygons = [[whole(w) for w in row[1:1 + int(row[0])]] for row in rows]
    mesh.cut = len(rows) < faces
    return mesh


PLY = {"char": "b", "int8": "b", "uchar": "B", "uint8": "B", "short": "h", "int16": "h", "ushort": "H",
       "uint16": "H", "int": "i", "int32": "i", "uint": "I", "uint32": "I", "float": "f",
       "float32": "f", "double": "d", "float64": "d"}


def ply(data):
    end = data.find(b"end_header")
    if end < 0:
        raise Refused("no end_header")
    body = data.index(b"\n", end) + 1
    form, elements = None, []
    for line in data[:end].decode("latin-1").splitlines():
        words = line.split()
        if words[0] == "format":
            form = words[1]
        elif words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append(words[1:])
    mesh = Mesh()
    rows = iter(data[body:].decode("latin-1").splitlines()) if form == "ascii" else None
    order = "<" if form == "binary_little_endian" else ">"
    at = body
    for name, count, properties in elements:
        for _ in range(count):
            row = {}
            if rows is not None:
                words = iter(next(rows, "").split())
                try:
                    for p in properties:
                        if p[0] == "list":
                            row[p[3]] = [whole(next(words)) if p[2][0] in "iuscb" else next(words)
                                         for _ in range(int(next(words)))]
                        else:
                            row[p[1]] = number(next(words))
                except StopIteration:
                    mesh.cut = True
                    break
            else:
                for p in properties:
                    if p[0] == "list":
                        k = struct.unpack_from(order + PLY[p[1]], data, at)[0]
                        at += struct.calcsize(PLY[p[1]])
                        row[p[3]] = list(struct.unpack_from(f"{order}{k}{PLY[p[2]]}", data, at))
                        at += k * struct.calcsize(PLY[p[2]])
                    else:
                        row[p[1]] = struct.unpack_from(order + PLY[p[0]], data, at)[0]
                        at += struct.calcsize(PLY[p[0]])
            if name == "vertex":
                mesh.points.append([row["x"], row["y"], row["z"]])
            elif name == "face":
                mesh.polygons.append(row.get("vertex_indices") or row.get("vertex_index"))
    return mesh


def lattice(mesh, object_, points):
    """The frusta of an object's beams, and a ball at every vertex that some of them end at: 16 sides, 320 faces."""
    settings = next(e for e in object_.iter() if e.tag.endswith("}beamlattice"))
    assert settings.get("cap", "sphere") == "sphere" and not settings.get("clippingmode")
    balls = {}
    for e in object_.iter():
        if not e.tag.endswith("}beam"):
            continue
        first = float(e.get("r1", settings.get("radius")))
        radii = first, float(e.get("r2", first))
        ends = int(e.get("v1")), int(e.get("v2"))
        for end, radius in zip(ends, radii):
            balls[end] = max(balls.get(end, 0), radius)
        a, b = (points[end] for end in ends)
        length = math.dist(a, b)
        side = math.pi * sum(radii) * math.hypot(length, radii[0] - radii[1])
        volume = math.pi * length * (radii[0] ** 2 + radii[0] * radii[1] + radii[1] ** 2) / 3
        mesh.lattice.append((2 * 16 + 2, 4 * 16, volume, side * math.hypot(*a) / 3))
    for vertex, radius in balls.items():
        mesh.lattice.append((162, 320, 4 / 3 * math.pi * radius ** 3,
                             4 / 3 * math.pi * radius ** 2 * math.hypot(*points[vertex])))


def threemf(path):
    archive = zipfile.ZipFile(path)
    name = next(n for n in archive.namelist() if n.endswith(".model"))
    text = archive.read(name).decode("utf-8")
    declared = set(re.findall(r"\bxmlns:(\w+)=", text))
    for prefix in set(re.findall(r"</?(\w+):", text)) - declared:  # of extensions; not core
        text = text.replace(f"<{prefix}:", "<undeclared_").replace(f"</{prefix}:", "</undeclared_")
    root = ET.fromstring(re.sub(r"^<\?xml.*?\?>", "", text.lstrip("\ufeff")))
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    objects = {o.get("id"): o for o in root.iter(core + "object")}
    mesh = Mesh()

    def matrix(text):
        m = [float(w) for w in (text or "1 0 0 0 1 0 0 0 1 0 0 0").split()]
        return [m[0:3], m[3:6], m[6:9], m[9:12]]

    def place(p, m):
        return [p[0] * m[0][k] + p[1] * m[1][k] + p[2] * m[2][k] + m[3][k] for k in range(3)]

    def add(object_, chain):
        for component in object_.iter(core + "component"):
            add(objects[component.get("objectid")], [matrix(component.get("transform"))] + chain)
        base = len(mesh.points)
        for v in object_.iter(core + "vertex"):
            p = [float(v.get(k)) for k in "xyz"]
            for m in chain:
                p = place(p, m)
            mesh.points.append(p)
        mesh.polygons += [[base + int(t.get(k)) for k in ("v1", "v2", "v3")]
                          for t in object_.iter(core + "triangle")]
        if any(e.tag.endswith("}beam") for e in object_.iter()):
            lattice(mesh, object_, mesh.points[base:])
            if not any(object_.iter(core + "triangle")): # its vertices are those of beams alone
                del mesh.points[base:]

    for item in root.iter(core + "item"):
        add(objects[item.get("objectid")], [matrix(item.get("transform"))])
    return mesh


def read(path):
    ending = os.path.splitext(path)[1].lower()
    if ending == ".3mf":
        return threemf(path)
    with open(path, "rb") as file:
        return {".stl": stl, ".obj": obj, ".off": off, ".ply": ply}[ending](file.read())


def main(folder):
    print("file\tstatus\tpoints\ttriangles\tpolygons\tvolume\tabsolute")
    for name in sorted(os.listdir(folder)):
        try:
            status, *numbers = read(os.path.join(folder, name)).result()
            print(name, status, *numbers[:3], *("%.15g" % x for x in numbers[3:]), sep="\t")
        except Refused:
            print(name, "error", *"-----", sep="\t")


if __name__ == "__main__":
    main(sys.argv[1])
