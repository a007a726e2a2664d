# SPDX-License-Identifier: Apache-2.0
"""Mesh files as VTK, libcgns and h5py write them, and as the formats' documents describe them.

write_all(folder) yields a Written for each file.
"""

import ctypes
import ctypes.util
import dataclasses
import itertools
import pathlib
import re

import h5py
import numpy as np
import vtkmodules.vtkCommonDataModel as model
import vtkmodules.vtkFiltersCore as core
import vtkmodules.vtkFiltersSources as sources
import vtkmodules.vtkIOParallel as parallel
import vtkmodules.vtkIOXML as xml
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints

import vtk_oracle

CORNERS = {
    "tetra": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "pyramid": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (.5, .5, 1)],
    "wedge": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
    "hexahedron": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
}
# VTK's order of the nodes on edges and faces.
EDGES = {
    "tetra": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
    "pyramid": [(0, 1), (1, 2), (2, 3), (3, 0), (0, 4), (1, 4), (2, 4), (3, 4)],
    "wedge": [(0, 1), (1, 2), (2, 0), (3, 4), (4, 5), (5, 3), (0, 3), (1, 4), (2, 5)],
    "hexahedron": [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
}
FACES = {
    "wedge": [(0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
    "hexahedron": [(0, 3, 7, 4), (1, 2, 6, 5), (0, 1, 5, 4), (3, 2, 6, 7), (0, 1, 2, 3), (4, 5, 6, 7), tuple(range(8))],
}
TYPES = {"tetra": 10, "pyramid": 14, "wedge": 13, "hexahedron": 12, "tetra10": 24, "pyramid13": 27,
         "wedge15": 26, "wedge18": 32, "hexahedron20": 25, "hexahedron27": 29}
# Where other formats put VTK's node i: mids of vertical edges before those of the top.
HEX20 = list(range(12)) + [16, 17, 18, 19, 12, 13, 14, 15]
WEDGE15 = list(range(9)) + [12, 13, 14, 9, 10, 11]
CGNS = {"tetra": ("TETRA_4", 10), "tetra10": ("TETRA_10", 11), "pyramid": ("PYRA_5", 12),
        "wedge": ("PENTA_6", 14), "wedge15": ("PENTA_15", 15), "wedge18": ("PENTA_18", 16),
        "hexahedron": ("HEXA_8", 17), "hexahedron20": ("HEXA_20", 18), "hexahedron27": ("HEXA_27", 19),
        "pyramid13": ("PYRA_13", 21)}
CGNS_ORDER = {"hexahedron20": HEX20, "hexahedron27": HEX20 + [24, 22, 21, 23, 20, 25, 26], "wedge15": WEDGE15,
              "wedge18": WEDGE15 + [15, 16, 17]}
FRD = {"hexahedron": 1, "wedge": 2, "tetra": 3, "hexahedron20": 4, "wedge15": 5, "tetra10": 6}
ENSIGHT = {"tetra": "tetra4", "tetra10": "tetra10", "pyramid": "pyramid5", "pyramid13": "pyramid13",
           "wedge": "penta6", "wedge15": "penta15", "hexahedron": "hexa8", "hexahedron20": "hexa20"}
NEU = {"hexahedron": 4, "wedge": 5, "tetra": 6, "pyramid": 7}


def nodes_of(kind):
    """A cell's nodes in the unit cube, in VTK's order."""
    base = kind.rstrip("0123456789")
    corners = [np.array(c, float) for c in CORNERS[base]]
    every = corners + [(corners[a] + corners[b]) / 2 for a, b in EDGES[base]]
    every += [np.mean([corners[k] for k in face], axis=0) for face in FACES.get(base, [])]
    return np.array(every[:int(kind[len(base):] or len(corners))])


@dataclasses.dataclass
class Written:
    name: str  # for messages
    path: pathlib.Path
    found: vtk_oracle.Found  # what VTK finds in the mesh itself
    missing: tuple = ()  # arrays that the format does not hold
    volume: float = 0.0  # of the curved cells; 0: not known


class Mesh:
    """Cells of some kinds beside each other: points, cells (kind, nodes), T and V at points, C in cells."""

    def __init__(self, kinds, copies=2, shift=0.0):
        points, self.cells = [], []
        for number, kind in enumerate(itertools.chain.from_iterable([kind] * copies for kind in kinds)):
            nodes = nodes_of(kind)
            first = sum(len(p) for p in points)
            x, y, z = (nodes + [2.5 * number, 0, 0]).T
            points.append(np.array([x + .3 * z * (1 - z), y + .2 * z * (1 - z) + shift, z]).T)
            self.cells.append((kind, list(range(first, first + len(nodes)))))
        self.points = np.concatenate(points).astype(np.float32).astype(float)
        self.T = (self.points @ [1, 10, 100]).astype(np.float32)
        self.V = (self.points * [1, 2, 3]).astype(np.float32)
        self.C = 1.5 * np.arange(len(self.cells), dtype=np.float32)

    def grid(self):
        made = model.vtkUnstructuredGrid()
        made.SetPoints(vtk_points(self.points))
        for kind, nodes in self.cells:
            made.InsertNextCell(TYPES[kind], len(nodes), nodes)
        add_arrays(made.GetPointData(), {"T": self.T, "V": self.V})
        add_arrays(made.GetCellData(), {"C": self.C})
        return made

    def volume(self):
        """The map that bends the cells keeps their volumes. Other pyramids are not quadratic."""
        sizes = {"tetra": 1 / 6, "pyramid": 1 / 3, "wedge": 1 / 2, "hexahedron": 1.0}
        return sum(sizes[kind.rstrip("0123456789")] for kind, _ in self.cells) \
            if all(kind != "pyramid13" for kind, _ in self.cells) else 0.0

    def found(self):
        return found_in(self.grid())


def volume_of(parts):
    """0 where it is not known."""
    volumes = [part.volume() for part in parts]
    return sum(volumes) if min(volumes) > 0 else 0.0


def vtk_points(values):
    points = vtkPoints()
    points.SetDataTypeToDouble()
    points.SetData(numpy_to_vtk(np.ascontiguousarray(values), deep=1))
    return points


def add_arrays(data, arrays):
    for name, values in arrays.items():
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
        array.SetName(name)
        data.AddArray(array)


def found_in(*blocks):
    found = vtk_oracle.Found()
    for block in blocks:
        found.add(block)
    return found


def confirm(path, found, ending=None):
    """VTK reads the file that was written without it as the mesh that was meant."""
    read = vtk_oracle.look(path, ending)
    assert (read.points, read.solids) == (found.points, found.solids), (path, vars(read), vars(found))
    assert abs(read.volume - found.volume) < 1e-6 * found.volume, (path, read.volume, found.volume)


# --- VTK's own formats ---

def surfaces():
    """Polygons, strips, points and lines."""
    def output(source, **settings):
        for name, value in settings.items():
            getattr(source, "Set" + name)(value)
        source.Update()
        return source.GetOutput()

    sphere = output(sources.vtkSphereSource(), ThetaResolution=13, PhiResolution=9)
    yield "sphere", sphere
    yield "strips", output(core.vtkStripper(), InputData=sphere)
    yield "cylinder", output(sources.vtkCylinderSource(), Resolution=24)
    yield "cube", output(sources.vtkCubeSource())
    both = core.vtkAppendPolyData()
    for one in (output(sources.vtkLineSource()), output(sources.vtkPointSource(), NumberOfPoints=5),
                output(core.vtkStripper(), InputData=sphere), output(sources.vtkCubeSource(), Center=(3, 0, 0))):
        both.AddInputData(one)
    both.Update()
    yield "points, lines, strips, polygons", both.GetOutput()


def vtp_files(folder):
    number = 0
    for name, surface in surfaces():
        for mode, compressor, header, order, raw in itertools.product(
                ("Ascii", "Binary", "Appended"), ("None", "ZLib", "LZ4", "LZMA"), (32, 64), (0, 1), (False, True)):
            if mode == "Ascii" and (compressor, header, order) != ("None", 32, 0) or raw and mode != "Appended":
                continue
            number += 1
            path = folder / ("s%d.vtp" % number)
            writer = xml.vtkXMLPolyDataWriter()
            getattr(writer, "SetDataModeTo" + mode)()
            writer.SetCompressorType(("None", "ZLib", "LZ4", "LZMA").index(compressor))
            writer.SetHeaderType(header)
            writer.SetByteOrder(order)
            writer.SetEncodeAppendedData(not raw)
            writer.SetFileName(str(path))
            writer.SetInputData(surface)
            writer.Write()
            yield Written("%s %s %s %d %d %d .vtp" % (name, mode, compressor, header, order, raw), path, found_in(surface))


def blocks_file(folder):
    made = model.vtkMultiBlockDataSet()
    grids = [Mesh([kind]).grid() for kind in TYPES]
    inner = model.vtkMultiBlockDataSet()
    for i, grid in enumerate(grids[5:]):
        inner.SetBlock(i, grid)
    for i, grid in enumerate(grids[:5]):
        made.SetBlock(2 * i, grid)  # every second block is empty
    made.SetBlock(11, inner)
    writer = xml.vtkXMLMultiBlockDataWriter()
    path = folder / "nested.vtm"
    writer.SetFileName(str(path))
    writer.SetInputData(made)
    writer.Write()
    yield Written("nested .vtm", path, found_in(*grids))


# --- VTKHDF ---

def write_vtkhdf(path, parts, steps):
    """The mesh in parts, `still`, or with a step before it: `moving`, that step's mesh elsewhere, or
    `shared`, its arrays alone different. The type is left out of still files of one part, as the
    format's first version had it.
    """
    moving = steps == "moving"
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = [1, 0] if steps == "still" else [2, 0]
        if steps != "still" or len(parts) > 1:
            root.attrs.create("Type", np.bytes_("UnstructuredGrid"))
        sizes = [len(part.cells) for part in parts]
        ids = [sum(len(nodes) for _, nodes in part.cells) for part in parts]
        points = [len(part.points) for part in parts]
        repeat = 2 if moving else 1
        join = np.concatenate
        lists = 1 if steps == "still" else 2  # every step lists its parts, shared or not
        root["NumberOfPoints"], root["NumberOfCells"] = points * lists, sizes * lists
        root["NumberOfConnectivityIds"] = ids * lists
        every = join([part.points for part in parts])
        root["Points"] = join([every + 100, every]) if moving else every
        types = [TYPES[kind] for part in parts for kind, _ in part.cells]
        root["Types"] = np.array(types * repeat, np.uint8)
        offsets = [np.cumsum([0] + [len(nodes) for _, nodes in part.cells]) for part in parts]
        root["Offsets"] = join(offsets * repeat)
        root["Connectivity"] = join([join([nodes for _, nodes in part.cells]) for part in parts] * repeat)
        for group, name, which in (("PointData", "T", "T"), ("PointData", "V", "V"), ("CellData", "C", "C")):
            values = join([getattr(part, which) for part in parts])
            root["%s/%s" % (group, name)] = values if steps == "still" else join([values - 5000, values])
        if steps != "still":
            table = root.create_group("Steps")
            table.attrs["NSteps"] = 2
            table["Values"] = [0.0, 1.0]
            table["PartOffsets"], table["NumberOfParts"] = [0, len(parts)], [len(parts)] * 2
            table["PointOffsets"] = [0, sum(points) * moving]
            table["CellOffsets"] = [[0], [sum(sizes) * moving]]
            table["ConnectivityIdOffsets"] = [[0], [sum(ids) * moving]]
            for name in ("T", "V"):
                table["PointDataOffsets/" + name] = [0, sum(points)]
            table["CellDataOffsets/C"] = [0, sum(sizes)]


def vtkhdf_files(folder):
    for number, kinds in enumerate([[kind] for kind in TYPES] + [list(TYPES), ["tetra", "hexahedron"]]):
        for count, steps in itertools.product((1, 3), ("still", "moving", "shared")):
            parts = [Mesh(kinds, copies, 3 * copies) for copies in range(1, count + 1)]
            path = folder / ("g%d_%d_%s.vtkhdf" % (number, count, steps))
            write_vtkhdf(path, parts, steps)
            found = found_in(*[part.grid() for part in parts])
            if steps == "still":  # the reader of VTK 9.1 knows no steps
                confirm(path, found)
            yield Written("%s in %d parts, %s .vtkhdf" % (kinds, count, steps), path, found, (), volume_of(parts))


# --- CGNS ---

def size_type():
    """cgsize_t of the library that is installed."""
    header = pathlib.Path("/usr/include/cgnstypes.h")
    wide = header.exists() and re.search(r"CG_BUILD_64BIT\s+1", header.read_text())
    return ctypes.c_int64 if wide else ctypes.c_int32


SIZE = size_type()


class Cgns:
    """A file that libcgns writes: kind 1 is ADF, 2 is HDF5, 3 is ADF2."""

    def __init__(self, path, kind):
        name = ctypes.util.find_library("cgns")
        if name is None:
            raise OSError("libcgns is missing")
        self.library = ctypes.CDLL(name)
        self.library.cg_get_error.restype = ctypes.c_char_p
        self.file = ctypes.c_int()
        self.do("cg_set_file_type", kind)
        self.do("cg_open", str(path).encode(), 1, ctypes.byref(self.file))

    def do(self, call, *arguments):
        if getattr(self.library, call)(*arguments) != 0:
            raise OSError("%s: %s" % (call, self.library.cg_get_error().decode()))

    def make(self, call, *arguments):
        number = ctypes.c_int()
        self.do(call, self.file, *arguments, ctypes.byref(number))
        return number.value

    @staticmethod
    def numbers(values, kind=SIZE):
        return np.ascontiguousarray(values, kind).ctypes.data_as(ctypes.c_void_p)

    def zone(self, base, name, size, structured, points):
        zone = self.make("cg_zone_write", base, name, self.numbers(size), 2 if structured else 3)
        for axis, letter in enumerate("XYZ"):
            self.make("cg_coord_write", base, zone, 4, ("Coordinate" + letter).encode(),
                      self.numbers(points[:, axis], np.float64))
        return zone

    def solution(self, base, zone, location, fields):
        if not fields:
            return
        number = self.make("cg_sol_write", base, zone, b"AtPoints" if location == 2 else b"InCells", location)
        for name, values in fields.items():
            self.make("cg_field_write", base, zone, number, 3, name.encode(), self.numbers(values, np.float32))

    def close(self):
        self.do("cg_close", self.file)


def write_cgns(path, kind, meshes, mixed):
    out = Cgns(path, kind)
    base = out.make("cg_base_write", b"Base", 3, 3)
    for number, mesh in enumerate(meshes):
        zone = out.zone(base, b"Zone%d" % number, [len(mesh.points), len(mesh.cells), 0], False, mesh.points)
        ordered = [(kind, [nodes[i] + 1 for i in CGNS_ORDER.get(kind, range(len(nodes)))])
                   for kind, nodes in mesh.cells]
        if mixed:
            rows = [[CGNS[kind][1]] + nodes for kind, nodes in ordered]
            flat = list(itertools.chain.from_iterable(rows))
            offsets = np.cumsum([0] + [len(row) for row in rows])
            out.make("cg_poly_section_write", base, zone, b"All", 20, SIZE(1),
                     SIZE(len(rows)), 0, out.numbers(flat), out.numbers(offsets))
        else:
            at = 1
            for kind, group in itertools.groupby(ordered, lambda cell: cell[0]):
                group = [nodes for _, nodes in group]
                out.make("cg_section_write", base, zone, CGNS[kind][0].encode(), CGNS[kind][1],
                         SIZE(at), SIZE(at + len(group) - 1), 0, out.numbers(group))
                at += len(group)
        out.solution(base, zone, 2, {"T": mesh.T})
        out.solution(base, zone, 3, {"C": mesh.C})
    out.close()


def write_cgns_block(path, kind, sides):
    """A structured zone; returns the same cells as a VTK grid."""
    n = np.array(sides)
    k, j, i = np.meshgrid(*(np.arange(m) for m in n[::-1]), indexing="ij")
    points = np.stack([i + .1 * j, j + .05 * k * k, k * 1.5], -1).reshape(-1, 3).astype(float)
    grid = model.vtkStructuredGrid()
    grid.SetDimensions(*sides)
    grid.SetPoints(vtk_points(points))
    fields = {"T": (points @ [1, 10, 100]).astype(np.float32)}, \
        {"C": np.arange(np.prod(n - 1), dtype=np.float32)}
    add_arrays(grid.GetPointData(), fields[0])
    add_arrays(grid.GetCellData(), fields[1])
    out = Cgns(path, kind)
    base = out.make("cg_base_write", b"Base", 3, 3)
    zone = out.zone(base, b"Block", list(n) + list(n - 1) + [0, 0, 0], True, points)
    out.solution(base, zone, 2, fields[0])
    out.solution(base, zone, 3, fields[1])
    out.close()
    return found_in(grid)


def cgns_files(folder):
    for kind, name in ((1, "ADF"), (2, "HDF5"), (3, "ADF2")):
        known = [one for one in CGNS if (kind, one) != (3, "pyramid13")]  # newer than ADF2
        for number, kinds in enumerate([[one] for one in known] + [known]):
            # What libcgns makes of mixed elements in ADF2 it does not read itself.
            for mixed in (False,) if kind == 3 else (False, True):
                path = folder / ("c%s%d%d.cgns" % (name, number, mixed))
                meshes = [Mesh(kinds, copies, 3 * copies) for copies in (1, 2)]
                write_cgns(path, kind, meshes, mixed)
                found = found_in(*[mesh.grid() for mesh in meshes])
                if "pyramid13" not in kinds:  # VTK 9.1 leaves PYRA_13 out
                    confirm(path, found)
                yield Written("%s %s mixed=%d CGNS" % (kinds, name, mixed), path, found, ("V",),
                              volume_of(meshes))
        path = folder / ("block%s.cgns" % name)
        found = write_cgns_block(path, kind, (4, 3, 5))
        confirm(path, found)
        yield Written("block %s CGNS" % name, path, found)


# --- EnSight Gold ---

def ensight_by_vtk(folder):
    for number, kinds in enumerate([[kind] for kind in ("tetra", "pyramid", "wedge", "hexahedron")]
                                   + [["tetra", "pyramid", "wedge", "hexahedron"]]):
        grid = Mesh(kinds).grid()
        add_arrays(grid.GetCellData(), {"BlockId": np.ones(grid.GetNumberOfCells(), np.int32)})
        writer = parallel.vtkEnSightWriter()
        writer.SetPath(str(folder))
        writer.SetBaseName("e%d" % number)
        writer.SetInputData(grid)
        writer.Write()
        writer.WriteCaseFile(1)
        ctypes.CDLL(None).fflush(None)  # the writer does not close the case
        found = found_in(grid)
        found.ranges = {(on, name + ("_n" if on == "points" else "_c")): ends
                        for (on, name), ends in found.ranges.items() if name != "BlockId"}
        yield Written("%s EnSight by VTK" % kinds, folder / ("e%d.0.case" % number), found)


def write_ensight(folder, name, meshes, ids, partial):
    """Text, as the manual describes it; a part a mesh, a section a kind of cell."""
    lines = ["geometry", "of a test", "node id " + ids, "element id " + ids]
    at_points, in_cells = ["T"], ["C"]
    for number, mesh in enumerate(meshes, 1):
        lines += ["part", "%10d" % number, "part %d" % number, "coordinates", "%10d" % len(mesh.points)]
        if ids == "given":
            lines += ["%10d" % (7 * i + 3) for i in range(len(mesh.points))]
        lines += ["%12.5e" % x for axis in range(3) for x in mesh.points[:, axis]]
        at_points += ["part", "%10d" % number]
        if partial:
            at_points += ["coordinates partial", "%10d" % len(mesh.T)]
            at_points += ["%10d" % (i + 1) for i in range(len(mesh.T))]
        else:
            at_points += ["coordinates"]
        at_points += ["%12.5e" % x for x in mesh.T]
        in_cells += ["part", "%10d" % number]
        done = 0
        for kind, group in itertools.groupby(mesh.cells, lambda cell: cell[0]):
            group = [nodes for _, nodes in group]
            lines += [ENSIGHT[kind], "%10d" % len(group)]
            if ids == "given":
                lines += ["%10d" % (5 * i + 2) for i in range(len(group))]
            lines += ["".join("%10d" % (node + 1) for node in nodes) for nodes in group]
            in_cells += [ENSIGHT[kind]] + ["%12.5e" % x for x in mesh.C[done:done + len(group)]]
            done += len(group)
    for ending, text in (("geo", lines), ("T", at_points), ("C", in_cells)):
        (folder / (name + "." + ending)).write_text("\n".join(text) + "\n")
    path = folder / (name + ".case")
    path.write_text("FORMAT\ntype: ensight gold\nGEOMETRY\nmodel: %s.geo\nVARIABLE\n"
                    "scalar per node: T %s.T\nscalar per element: C %s.C\n" % (name, name, name))
    return path


def ensight_files(folder):
    yield from ensight_by_vtk(folder)
    for number, kinds in enumerate([[kind] for kind in ENSIGHT] + [list(ENSIGHT)]):
        for ids, partial in itertools.product(("off", "given", "assign"), (False, True)):
            meshes = [Mesh(kinds, copies, 3 * copies) for copies in (1, 2)]
            for mesh in meshes:
                mesh.points = np.array([float("%12.5e" % x) for x in mesh.points.ravel()]).reshape(-1, 3)
                mesh.T = np.array([np.float32("%12.5e" % x) for x in mesh.T])
            path = write_ensight(folder, "t%d%s%d" % (number, ids, partial), meshes, ids, partial)
            found = found_in(*[mesh.grid() for mesh in meshes])
            if not partial:
                confirm(path, found)
            yield Written("%s ids %s partial=%d EnSight" % (kinds, ids, partial), path, found, ("V",),
                          volume_of(meshes))


# --- CalculiX ---

def frd_text(mesh, long):
    width = 10 if long else 5
    node = lambda i: "%*d" % (width, 3 * i + 1)
    out = ["    1C", "    2C" + " " * 18 + "%12d" % len(mesh.points) + " " * 37 + "%d" % long]
    out += [" -1" + node(i) + "".join("%12.5E" % x for x in p) for i, p in enumerate(mesh.points)] + [" -3"]
    out += ["    3C" + " " * 18 + "%12d" % len(mesh.cells) + " " * 37 + "%d" % long]
    per_line = 10 if long else 15
    for number, (kind, nodes) in enumerate(mesh.cells):
        order = {"hexahedron20": HEX20, "wedge15": WEDGE15}.get(kind, range(len(nodes)))
        nodes = [node(nodes[i]) for i in order]
        out.append(" -1%*d%5d%5d%5d" % (width, number + 1, FRD[kind], 0, 1))
        out += [" -2" + "".join(nodes[i:i + per_line]) for i in range(0, len(nodes), per_line)]
    out += [" -3"]
    for name, values in (("T", mesh.T[:, None]), ("V", mesh.V)):
        out += ["  100CL  101%12.5E%12d" % (1, len(values)) + " " * 20 + " 0    1" + " " * 11 + "%d" % long,
                " -4  %-8s%5d    1" % (name, values.shape[1])]
        out += [" -5  %-8s    1    2%5d    0" % ("D%d" % k, k + 1) for k in range(values.shape[1])]
        out += [" -1" + node(i) + "".join("%12.5E" % x for x in row) for i, row in enumerate(values)] + [" -3"]
    return "\n".join(out + [" 9999", ""])


def frd_files(folder):
    for number, kinds in enumerate([[kind] for kind in FRD] + [list(FRD)]):
        for long in (0, 1):
            mesh = Mesh(kinds)
            path = folder / ("f%d%d.frd" % (number, long))
            path.write_text(frd_text(mesh, long))
            text = lambda values: np.array([float("%12.5E" % x) for x in values.ravel()]).reshape(values.shape)
            mesh.points, mesh.T, mesh.V = text(mesh.points), text(mesh.T), text(mesh.V)
            yield Written("%s long=%d .frd" % (kinds, long), path, mesh.found(), ("C",), mesh.volume())


# --- Gambit ---

# Gambit goes through the base of bricks and pyramids row by row.
NEU_ORDER = {"hexahedron": [0, 1, 3, 2, 4, 5, 7, 6], "pyramid": [0, 1, 3, 2, 4]}


def neu_text(mesh):
    out = ["        CONTROL INFO 2.4.6", "** GAMBIT NEUTRAL FILE", "test", "PROGRAM: test VERSION: 1", "today",
           "     NUMNP     NELEM     NGRPS    NBSETS     NDFCD     NDFVL",
           "%10d%10d%10d%10d%10d%10d" % (len(mesh.points), len(mesh.cells), 1, 0, 3, 3), "ENDOFSECTION",
           "   NODAL COORDINATES 2.4.6"]
    out += ["%10d%20.11e%20.11e%20.11e" % (i + 1, *p) for i, p in enumerate(mesh.points)] + ["ENDOFSECTION"]
    out += ["      ELEMENTS/CELLS 2.4.6"]
    for number, (kind, nodes) in enumerate(mesh.cells):
        words = ["%8d" % (nodes[i] + 1) for i in NEU_ORDER.get(kind, range(len(nodes)))]
        head = "%8d %2d %2d " % (number + 1, NEU[kind], len(nodes))
        out += [head + "".join(words[:7])] + [" " * 15 + "".join(words[i:i + 7]) for i in range(7, len(words), 7)]
    out += ["ENDOFSECTION", "       ELEMENT GROUP 2.4.6",
            "GROUP: %10d ELEMENTS: %10d MATERIAL: %10d NFLAGS: %10d" % (1, len(mesh.cells), 2, 1),
            "%32s" % "fluid", "%8d" % 0]
    numbers = ["%8d" % (i + 1) for i in range(len(mesh.cells))]
    out += ["".join(numbers[i:i + 10]) for i in range(0, len(numbers), 10)]
    return "\n".join(out + ["ENDOFSECTION", ""])


def neu_files(folder):
    for number, kinds in enumerate([[kind] for kind in NEU] + [list(NEU)]):
        mesh = Mesh(kinds, 6)
        path = folder / ("n%d.neu" % number)
        path.write_text(neu_text(mesh))
        found = mesh.found()
        confirm(path, found)
        yield Written("%s .neu" % kinds, path, found, ("T", "V", "C"), mesh.volume())


# --- SU2 and I-DEAS: files that VTK does not read ---

SU2 = {"tetra": 10, "hexahedron": 12, "wedge": 13, "pyramid": 14}
UNV = {"tetra": 111, "wedge": 112, "wedge15": 113, "hexahedron": 115, "hexahedron20": 116, "tetra10": 118}
# VTK's nodes in the file's order: around the base with midpoints, up, around the other base.
UNV_ORDER = {"tetra10": [0, 4, 1, 5, 2, 6, 7, 8, 9, 3],
             "wedge15": [0, 6, 1, 7, 2, 8, 12, 13, 14, 3, 9, 4, 10, 5, 11],
             "hexahedron20": [0, 8, 1, 9, 2, 10, 3, 11, 16, 17, 18, 19, 4, 12, 5, 13, 6, 14, 7, 15]}


def su2_text(mesh):
    out = ["NDIME= 3", "NELEM= %d" % len(mesh.cells)]
    out += ["%d %s %d" % (SU2[kind], " ".join(map(str, nodes)), i) for i, (kind, nodes) in enumerate(mesh.cells)]
    out += ["NPOIN= %d" % len(mesh.points)] + ["%.17g %.17g %.17g %d" % (*p, i) for i, p in enumerate(mesh.points)]
    return "\n".join(out + ["NMARK= 0", ""])


def unv_text(mesh):
    out = ["    -1", "  2411"]
    for i, p in enumerate(mesh.points):
        out += ["%10d%10d%10d%10d" % (3 * i + 1, 1, 1, 11), "".join("%25.16E" % x for x in p).replace("E", "D")]
    out += ["    -1", "    -1", "  2412"]
    for number, (kind, nodes) in enumerate(mesh.cells):
        words = ["%10d" % (3 * nodes[i] + 1) for i in UNV_ORDER.get(kind, range(len(nodes)))]
        out += ["%10d%10d%10d%10d%10d%10d" % (number + 1, UNV[kind], 1, 1, 7, len(nodes))]
        out += ["".join(words[i:i + 8]) for i in range(0, len(words), 8)]
    return "\n".join(out + ["    -1", ""])


def plain_files(folder):
    for ending, kinds, text in (("su2", SU2, su2_text), ("unv", UNV, unv_text)):
        for number, some in enumerate([[kind] for kind in kinds] + [list(kinds)]):
            mesh = Mesh(some, 3)
            path = folder / ("p%d.%s" % (number, ending))
            path.write_text(text(mesh))
            yield Written("%s .%s" % (some, ending), path, mesh.found(), ("T", "V", "C"), mesh.volume())


# --- OpenFOAM ---

SIDES = {"tetra": [(0, 2, 1), (0, 1, 3), (1, 2, 3), (2, 0, 3)],
         "pyramid": [(0, 3, 2, 1), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)],
         "wedge": [(0, 2, 1), (3, 4, 5), (0, 1, 4, 3), (1, 2, 5, 4), (2, 0, 3, 5)],
         "hexahedron": [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)]}


def foam_header(kind, name, place):
    return ("FoamFile\n{\n    version 2.0;\n    format ascii;\n    class %s;\n    location \"%s\";\n"
            "    object %s;\n}\n\n" % (kind, place, name))


def foam_list(values):
    return "%d\n(\n%s\n)\n" % (len(values), "\n".join(
        "(%s)" % " ".join("%.9g" % x for x in value) if np.ndim(value) else "%.9g" % value for value in values))


def write_case(folder, mesh):
    """Its own faces for each cell, of which none has a neighbour."""
    poly, time = folder / "constant" / "polyMesh", folder / "0.5"
    for made in (poly, time, folder / "system"):
        made.mkdir(parents=True)
    faces = [(cell, [nodes[k] for k in side]) for cell, (kind, nodes) in enumerate(mesh.cells) for side in SIDES[kind]]
    (poly / "points").write_text(foam_header("vectorField", "points", "constant/polyMesh") + foam_list(mesh.points))
    (poly / "faces").write_text(
        foam_header("faceList", "faces", "constant/polyMesh") + "%d\n(\n%s\n)\n" % (
            len(faces), "\n".join("%d(%s)" % (len(face), " ".join(map(str, face))) for _, face in faces)))
    (poly / "owner").write_text(
        foam_header("labelList", "owner", "constant/polyMesh") + foam_list([owner for owner, _ in faces]))
    (poly / "neighbour").write_text(foam_header("labelList", "neighbour", "constant/polyMesh") + "0()\n")
    (poly / "boundary").write_text(
        foam_header("polyBoundaryMesh", "boundary", "constant/polyMesh") +
        "1\n(\n    walls\n    {\n        type wall;\n        nFaces %d;\n        startFace 0;\n    }\n)\n" % len(faces))
    walls = "boundaryField\n{\n    walls\n    {\n        type zeroGradient;\n    }\n}\n"
    (time / "C").write_text(foam_header("volScalarField", "C", "0.5") + "dimensions [0 0 0 0 0 0 0];\n\n"
                            "internalField nonuniform List<scalar>\n%s;\n\n%s" % (foam_list(mesh.C), walls))
    (folder / "system" / "controlDict").write_text(
        foam_header("dictionary", "controlDict", "system") +
        "application none;\nstartFrom startTime;\nstartTime 0;\nstopAt endTime;\nendTime 1;\ndeltaT 0.5;\n"
        "writeInterval 0.5;\nwriteFormat ascii;\n")
    (folder / "case.foam").touch()
    return folder / "case.foam"


def foam_files(folder):
    kinds = list(SIDES)
    for number, some in enumerate([[kind] for kind in kinds] + [kinds]):
        mesh = Mesh(some, 3)
        path = write_case(folder / ("foam%d" % number), mesh)
        confirm(path, mesh.found())
        yield Written("%s of OpenFOAM" % some, path, mesh.found(), ("T", "V"), mesh.volume())


def write_all(folder):
    for files in (vtp_files, blocks_file, vtkhdf_files, cgns_files, ensight_files, frd_files, neu_files, plain_files,
                  foam_files):
        yield from files(folder)
