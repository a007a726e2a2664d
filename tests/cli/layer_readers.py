# SPDX-License-Identifier: Apache-2.0
"""Second readers of the formats that `tetvdb slice` writes, each written from the format's
description alone. Layers are lists of rows of bytes, row 0 on top, or lists of closed contours in
millimetres."""

import io
import json
import struct
import xml.etree.ElementTree as xml
import zipfile
import zlib


def png(data):
    """8-bit grey or indexed PNG (ISO/IEC 15948): rows, palette or None."""
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, packed, palette, kinds = 8, b"", None, []
    while at < len(data):
        size, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + size]
        check, = struct.unpack(">I", data[at + 8 + size:at + 12 + size])
        assert check == zlib.crc32(kind + body)
        kinds.append(kind)
        if kind == b"IHDR":
            width, height, depth, color, method, filters, interlace = struct.unpack(">IIBBBBB", body)
            assert (depth, method, filters, interlace) == (8, 0, 0, 0) and color in (0, 3)
        elif kind == b"PLTE":
            palette = [tuple(body[i:i + 3]) for i in range(0, size, 3)]
        elif kind == b"IDAT":
            packed += body
        at += 12 + size
    assert at == len(data) and kinds[0] == b"IHDR" and kinds[-1] == b"IEND"
    assert (color == 3) == (palette is not None)
    raw = zlib.decompress(packed)
    assert len(raw) == height * (width + 1)
    rows, before = [], bytearray(width)
    for y in range(height):
        method, row = raw[y * (width + 1)], bytearray(raw[y * (width + 1) + 1:(y + 1) * (width + 1)])
        for x in range(width):
            left, up = row[x - 1] if x else 0, before[x]
            corner = before[x - 1] if x else 0
            if method == 1:
                add = left
            elif method == 2:
                add = up
            elif method == 3:
                add = (left + up) // 2
            elif method == 4:
                guess = left + up - corner
                add = min((abs(guess - left), 0, left), (abs(guess - up), 1, up),
                          (abs(guess - corner), 2, corner))[2]
            else:
                add = 0
            row[x] = (row[x] + add) & 255
        rows.append(bytes(row))
        before = row
    return rows, palette


def png_folder(path):
    manifest = json.loads((path / "manifest.json").read_text())
    names = [layer["file"] for layer in manifest["layers"]]
    assert sorted(p.name for p in path.iterdir()) == sorted(names + ["manifest.json"])
    return [png((path / name).read_bytes())[0] for name in names], manifest


def settings(text):
    return dict(line.split(" = ", 1) for line in text.decode().splitlines())


def sl1(path):
    """Layers and the keys of both configurations. The last five digits of a name are its layer's
    number."""
    with zipfile.ZipFile(path) as file:
        assert file.testzip() is None
        config = settings(file.read("config.ini"))
        printer = settings(file.read("prusaslicer.ini"))
        names = sorted((n for n in file.namelist() if n.endswith(".png")), key=str.lower)
        assert len(names) == int(config["numSlow"]) + int(config["numFast"])
        assert names == ["%s%05d.png" % (config["jobDir"], i) for i in range(len(names))]
        return [png(file.read(name))[0] for name in names], config, printer


def uvtools_zip(path):
    with zipfile.ZipFile(path) as file:
        assert file.testzip() is None
        manifest = xml.fromstring(file.read("manifest.uvtools"))
        assert manifest.tag == "Manifest"
        count = sum(n[:-4].isdigit() for n in file.namelist() if n.endswith(".png"))
        return ([png(file.read("%d.png" % (i + 1)))[0] for i in range(count)],
                {child.tag: child.text for child in manifest})


def nanodlp(path):
    with zipfile.ZipFile(path) as file:
        assert file.testzip() is None
        plate = json.loads(file.read("plate.json"))
        info = json.loads(file.read("info.json"))
        assert json.loads(file.read("meta.json"))["FormatVersion"] == 1
        json.loads(file.read("profile.json"))
        assert len(png(file.read("3d.png"))[0]) == 100
        layers = [png(file.read("%d.png" % (i + 1)))[0] for i in range(plate["LayersCount"])]
        return layers, plate, info


def goo(path):
    """GOO 3.0. Layers, the header's numbers, and those of every layer."""
    data = path.read_bytes()
    assert data[:12] == b"V3.0\x07\0\0\0DLP\0" and data[-11:] == b"\0\0\0\x07\0\0\0DLP\0"
    at = 12 + 32 + 24 + 24 + 32 + 32 + 32 + 6
    for side in (116, 290):
        at += 2 * side * side
        assert data[at:at + 2] == b"\r\n"
        at += 2
    count, width, height = struct.unpack(">IHH", data[at:at + 8])
    at += 10
    floats = struct.unpack(">5f", data[at:at + 20])
    header = dict(zip(("width", "height", "z", "thickness", "exposure"), floats))
    at += 20 + 1 + 7 * 4
    header["bottom_exposure"], header["bottom_layers"] = struct.unpack(">fI", data[at:at + 8])
    at += 8 + 16 * 4 + 4 + 1
    header["seconds"], header["volume"] = struct.unpack(">If", data[at:at + 8])
    at += 8 + 8 + 8
    first, = struct.unpack(">I", data[at:at + 4])
    at += 4 + 1 + 2
    assert first == at == 195477
    layers, definitions = [], []
    for _ in range(count):
        fields = struct.unpack(">H15fH", data[at:at + 2 + 60 + 2])
        definitions.append({"z": fields[2], "exposure": fields[3]})
        at += 64
        if data[at - 2 + 0:at] == b"\r\n":
            raise AssertionError("the definition is too short")
        assert data[at:at + 2] == b"\r\n"
        size, = struct.unpack(">I", data[at + 2:at + 6])
        body = data[at + 6:at + 6 + size]
        assert body[0] == 0x55 and body[-1] == ~sum(body[1:-1]) & 255
        at += 6 + size
        assert data[at:at + 2] == b"\r\n"
        at += 2
        pixels, i, value = bytearray(), 1, 0
        while i < size - 1:
            head = body[i]
            i += 1
            kind, more = head >> 6, head >> 4 & 3
            if kind == 2:
                value += (head & 15) * (-1 if more & 2 else 1)
                length = 1
                if more & 1:
                    length = body[i]
                    i += 1
            else:
                value = {0: 0, 3: 255}.get(kind, None)
                if kind == 1:
                    value = body[i]
                    i += 1
                length = 0
                for _ in range(more):
                    length = length << 8 | body[i]
                    i += 1
                length = length << 4 | head & 15
            pixels += bytes([value]) * length
        assert len(pixels) == width * height
        layers.append([bytes(pixels[y * width:(y + 1) * width]) for y in range(height)])
    assert at == len(data) - 11
    return layers, header, definitions


def bits(rows, width):
    return [bytes(255 if row[x >> 3] >> (7 - (x & 7)) & 1 else 0 for x in range(width))
            for row in rows]


def tiff(path):
    """Bilevel pages (TIFF 6.0), deflated."""
    data = path.read_bytes()
    assert data[:4] == b"II*\0"
    at, layers = struct.unpack("<I", data[4:8])[0], []
    while at:
        count, = struct.unpack("<H", data[at:at + 2])
        tags, before = {}, 0
        for i in range(count):
            tag, kind, n, value = struct.unpack("<HHII", data[at + 2 + 12 * i:at + 14 + 12 * i])
            assert tag > before and n == 1
            before, tags[tag] = tag, value
        assert (tags[258], tags[259], tags[262], tags[277]) == (1, 8, 1, 1)
        width, height = tags[256], tags[257]
        assert tags[278] == height
        raw = zlib.decompress(data[tags[273]:tags[273] + tags[279]])
        row = (width + 7) // 8
        assert len(raw) == row * height
        layers.append(bits([raw[y * row:(y + 1) * row] for y in range(height)], width))
        over, under = struct.unpack("<II", data[tags[282]:tags[282] + 8])
        at, = struct.unpack("<I", data[at + 2 + 12 * count:at + 6 + 12 * count])
    return layers, over / under


def bmp_folder(path):
    layers = []
    manifest = json.loads((path / "manifest.json").read_text())
    for layer in manifest["layers"]:
        data = (path / layer["file"]).read_bytes()
        kind, size, _, offset, head, width, height, planes, depth, packed = struct.unpack(
            "<2sIIIIiiHHI", data[:34])
        assert (kind, size, head, planes, depth, packed) == (b"BM", len(data), 40, 1, 1, 0)
        assert data[54:62] == b"\0\0\0\0\xff\xff\xff\0" and offset == 62 and height > 0
        row = (width + 31) // 32 * 4
        rows = [data[offset + y * row:offset + (y + 1) * row] for y in range(height)]
        layers.append(bits(rows[::-1], width))
    return layers


def cli(path):
    """Common Layer Interface, text or binary: tops and contours of layers, the header's lines."""
    data = path.read_bytes()
    head, body = data.split(b"$$HEADEREND", 1)
    header = [line for line in head.decode().splitlines() if line]
    assert header[0] == "$$HEADERSTART" and "$$UNITS/1" in header
    layers = []

    def close(numbers, direction):
        points = [tuple(numbers[i:i + 2]) for i in range(0, len(numbers), 2)]
        assert points[0] == points[-1]
        assert (signed_area(points[:-1]) > 0) == (direction == 1)
        return points[:-1]

    if "$$BINARY" in header:
        at = 0
        while at < len(body):
            code, = struct.unpack("<H", body[at:at + 2])
            at += 2
            if code == 127:
                layers.append((struct.unpack("<f", body[at:at + 4])[0], []))
                at += 4
            else:
                assert code == 130
                _, direction, count = struct.unpack("<iii", body[at:at + 12])
                numbers = struct.unpack("<%df" % (2 * count), body[at + 12:at + 12 + 8 * count])
                layers[-1][1].append(close(numbers, direction))
                at += 12 + 8 * count
    else:
        assert "$$ASCII" in header
        lines = body.decode().split()
        assert lines[0] == "$$GEOMETRYSTART" and lines[-1] == "$$GEOMETRYEND"
        for line in lines[1:-1]:
            command, values = line.split("/")
            numbers = [float(v) for v in values.split(",")]
            if command == "$$LAYER":
                layers.append((numbers[0], []))
            else:
                assert command == "$$POLYLINE" and len(numbers) == 3 + 2 * numbers[2]
                layers[-1][1].append(close(numbers[3:], numbers[1]))
    assert "$$LAYERS/%d" % len(layers) in header
    assert layers[0] == (0, [])
    return layers[1:], header


def svg(path):
    root = xml.parse(path).getroot()
    space = "{http://www.w3.org/2000/svg}"
    slic3r = "{http://slic3r.org/namespaces/slic3r}"
    height = float(root.get("viewBox").split()[3])
    layers = []
    for group in root.findall(space + "g"):
        assert group.get("id") == "layer%d" % len(layers)
        contours = []
        for path_element in group.findall(space + "path"):
            for part in path_element.get("d").split("Z")[:-1]:
                assert part[0] == "M"
                contours.append([(float(x), height - float(y)) for x, y in
                                 (p.split() for p in part[1:].split("L"))])
        layers.append((float(group.get(slic3r + "z")), contours))
    return layers


def three_mf(path):
    """The slices of a 3MF file, and its mesh: points, triangles."""
    core = "{http://schemas.microsoft.com/3dmanufacturing/core/2015/02}"
    slices = "{http://schemas.microsoft.com/3dmanufacturing/slice/2015/07}"
    with zipfile.ZipFile(path) as file:
        assert file.testzip() is None
        relations = xml.fromstring(file.read("_rels/.rels"))
        model = xml.parse(io.BytesIO(file.read(relations[0].get("Target")[1:]))).getroot()
    assert model.get("unit") == "millimeter"
    resources = model.find(core + "resources")
    stack = resources.find(slices + "slicestack")
    thing = resources.find(core + "object")
    assert thing.get(slices + "slicestackid") == stack.get("id")
    assert model.find(core + "build")[0].get("objectid") == thing.get("id")
    layers, before = [], float(stack.get("zbottom"))
    for piece in stack:
        top = float(piece.get("ztop"))
        assert top > before
        before = top
        points = [(float(v.get("x")), float(v.get("y")))
                  for v in piece.findall(slices + "vertices/" + slices + "vertex")]
        contours = []
        for polygon in piece.findall(slices + "polygon"):
            ends = [int(s.get("v2")) for s in polygon]
            assert ends[-1] == int(polygon.get("startv"))
            contours.append([points[i] for i in ends[-1:] + ends[:-1]])
        layers.append((top, contours))
    mesh = thing.find(core + "mesh")
    vertices = [tuple(float(v.get(a)) for a in "xyz") for v in mesh.find(core + "vertices")]
    faces = [tuple(int(t.get(a)) for a in ("v1", "v2", "v3"))
             for t in mesh.find(core + "triangles")]
    return layers, vertices, faces


def signed_area(points):
    return sum(p[0] * q[1] - p[1] * q[0] for p, q in zip(points, points[1:] + points[:1])) / 2


def clipped(points, axis, at, keep_above):
    """Sutherland and Hodgman, one side."""
    out = []
    for p, q in zip(points, points[1:] + points[:1]):
        inside = [(v[axis] >= at) == keep_above or v[axis] == at for v in (p, q)]
        if inside[0]:
            out.append(p)
        if inside[0] != inside[1]:
            t = (at - p[axis]) / (q[axis] - p[axis])
            out.append(tuple(at if k == axis else p[k] + t * (q[k] - p[k]) for k in (0, 1)))
    return out


def shares(contours, width, height):
    """Of every pixel what the contours cover, by clipping; contours in pixels, y downward."""
    image = [[0.0] * width for _ in range(height)]
    for contour in contours:
        for y in range(height):
            row = clipped(clipped(contour, 1, y, True), 1, y + 1, False)
            if len(row) < 3:
                continue
            for x in range(max(int(min(p[0] for p in row)), 0),
                           min(int(max(p[0] for p in row)) + 1, width)):
                cell = clipped(clipped(row, 0, x, True), 0, x + 1, False)
                if len(cell) > 2:
                    image[y][x] += signed_area(cell)
    return image
