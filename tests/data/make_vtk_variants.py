#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
#
# Writes one small mesh in many ways with VTK (Debian: python3-vtk9, python3-numpy):
#   make_vtk_variants.py DIR        the files that are in tests/data/vtk
#   make_vtk_variants.py DIR --all  every combination of encoding, compressor, header and byte order
# The tests hold the same mesh as formulas: see tests/io/VtkMesh.h.

import itertools
import os
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

# A cube, a wedge beside it, a pyramid on it, tets, cells without volume.
POINTS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1),
          (2, 0.5, 0), (2, 0.5, 1), (0.5, 0.5, 2), (3, 0, 0), (3, 1, 0), (2.5, 0.5, 1.5),
          (2.5, 0.25, 0), (3, 0.5, 0), (2.5, 0.75, 0), (2.25, 0.5, 0.75), (2.75, 0.25, 0.75),
          (2.75, 0.75, 0.75)]
CELLS = [
    (vtk.VTK_LINE, [0, 1]),
    (vtk.VTK_TETRA, [1, 8, 2, 9]),
    (vtk.VTK_TRIANGLE, [0, 1, 2]),
    (vtk.VTK_HEXAHEDRON, [0, 1, 2, 3, 4, 5, 6, 7]),
    (vtk.VTK_WEDGE, [1, 2, 8, 5, 6, 9]),
    (vtk.VTK_PYRAMID, [4, 5, 6, 7, 10]),
    (vtk.VTK_TETRA, [8, 11, 12, 13]),
    (vtk.VTK_TETRA, [8, 11, 12, 9]),
    (vtk.VTK_VOXEL, [0, 1, 3, 2, 4, 5, 7, 6]),
    (vtk.VTK_QUADRATIC_TETRA, [8, 11, 12, 13, 14, 15, 16, 17, 18, 19]),
]
# A tet and a cube as polyhedra, with a tet between them.
POLYHEDRA = [
    (vtk.VTK_POLYHEDRON, [[8, 11, 12], [8, 11, 13], [11, 12, 13], [8, 12, 13]]),
    (vtk.VTK_TETRA, [8, 11, 12, 13]),
    (vtk.VTK_POLYHEDRON, [[0, 1, 2, 3], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6],
                          [3, 0, 4, 7]]),
]
CELL_TYPES = {
    "int8": np.int8, "uint8": np.uint8, "int16": np.int16, "uint16": np.uint16,
    "int32": np.int32, "uint32": np.uint32, "int64": np.int64, "uint64": np.uint64,
}


def add_array(data, name, values):
    array = numpy_to_vtk(values, deep=True)
    array.SetName(name)
    data.AddArray(array)


def grid(cells, attributes=True):
    mesh = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for point in POINTS:
        points.InsertNextPoint(point)
    mesh.SetPoints(points)
    for kind, nodes in cells:
        ids = vtk.vtkIdList()
        if kind == vtk.VTK_POLYHEDRON:
            ids.InsertNextId(len(nodes))
            for face in nodes:
                for i in [len(face)] + face:
                    ids.InsertNextId(i)
        else:
            for i in nodes:
                ids.InsertNextId(i)
        mesh.InsertNextCell(kind, ids)
    if not attributes:
        return mesh
    n = np.arange(len(POINTS))
    add_array(mesh.GetPointData(), "T", (n * 0.5 - 3).astype(np.float32))
    add_array(mesh.GetPointData(), "flow speed", np.stack([n * 1.1, n * -2.2, n + 1e-9], -1))
    e = np.arange(len(cells))
    add_array(mesh.GetCellData(), "material", (e // 3 + 1).astype(np.int32))
    for name, kind in CELL_TYPES.items():
        add_array(mesh.GetCellData(), name, (e * 7 + 1).astype(kind))
    names = vtk.vtkStringArray()
    names.SetName("names")
    for i in e:
        names.InsertNextValue("cell number %d" % i)
    mesh.GetCellData().AddArray(names)
    bits = vtk.vtkBitArray()
    bits.SetName("bits")
    for i in e:
        bits.InsertNextValue(int(i) % 3 == 0)
    mesh.GetCellData().AddArray(bits)
    time = numpy_to_vtk(np.array([0.25]), deep=True)
    time.SetName("TimeValue")
    mesh.GetFieldData().AddArray(time)
    return mesh


def write_vtu(path, mesh, mode, compressor, header, order, pieces=1):
    w = vtk.vtkXMLUnstructuredGridWriter()
    w.SetFileName(path)
    w.SetInputData(mesh)
    if mode == "ascii":
        w.SetDataModeToAscii()
    elif mode == "inline":
        w.SetDataModeToBinary()
    else:
        w.SetDataModeToAppended()
        w.SetEncodeAppendedData(mode == "base64")
    w.SetCompressorType({"none": w.NONE, "zlib": w.ZLIB, "lz4": w.LZ4, "lzma": w.LZMA}[compressor])
    w.SetBlockSize(96)  # so that arrays have several blocks
    w.SetHeaderTypeToUInt64() if header == 64 else w.SetHeaderTypeToUInt32()
    w.SetByteOrderToBigEndian() if order == "big" else w.SetByteOrderToLittleEndian()
    w.SetNumberOfPieces(pieces)
    w.Write()


def write_vtk(path, mesh, binary, version):
    w = vtk.vtkUnstructuredGridWriter()
    w.SetFileName(path)
    w.SetInputData(mesh)
    w.SetFileTypeToBinary() if binary else w.SetFileTypeToASCII()
    w.SetFileVersion(version)
    w.Write()


def write_exodus(path, mesh):
    for name in list(CELL_TYPES) + ["names", "bits"]:  # the writer takes Float64 and crashes on strings
        mesh.GetCellData().RemoveArray(name)
    w = vtk.vtkExodusIIWriter()
    w.SetFileName(path)
    w.SetInputData(mesh)
    w.WriteOutBlockIdArrayOn()
    w.WriteAllTimeStepsOff()
    w.Write()


def structured():
    """Bent, with an array at points, one at cells, and hidden cells and a hidden point."""
    size = (4, 3, 3)
    mesh = vtk.vtkStructuredGrid()
    mesh.SetDimensions(*size)
    points = vtk.vtkPoints()
    points.SetDataTypeToDouble()
    for k, j, i in itertools.product(*map(range, reversed(size))):
        points.InsertNextPoint(i + 0.25 * j, j - 0.125 * k, k + 0.0625 * i * j)
    mesh.SetPoints(points)
    add_array(mesh.GetPointData(), "T", np.arange(mesh.GetNumberOfPoints()) * 0.5)
    add_array(mesh.GetCellData(), "number", np.arange(mesh.GetNumberOfCells(), dtype=np.int32))
    mesh.BlankCell(1)
    mesh.BlankCell(10)
    mesh.BlankPoint(mesh.GetNumberOfPoints() - 1)
    return mesh


def rectilinear():
    mesh = vtk.vtkRectilinearGrid()
    mesh.SetDimensions(3, 2, 4)
    for axis, x in zip("XYZ", ([-1, 0.5, 2], [0, 3], [1, 1.25, 2, 4])):
        along = numpy_to_vtk(np.array(x, dtype=np.float32), deep=True)
        along.SetName(axis.lower())
        getattr(mesh, "Set%sCoordinates" % axis)(along)
    add_array(mesh.GetPointData(), "T", np.arange(mesh.GetNumberOfPoints()) * 0.5)
    return mesh


def write_grid(path, mesh, writer, binary=True):
    w = writer()
    w.SetFileName(path)
    w.SetInputData(mesh)
    if not path.endswith(".vtk"):
        w.SetDataModeToBinary() if binary else w.SetDataModeToAscii()
    elif binary:
        w.SetFileTypeToBinary()
    w.Write()


def visible(mesh):
    """VTK's own cells of a structured or rectilinear grid, those that are not hidden."""
    cells = vtk.vtkIdList()
    for i in range(mesh.GetNumberOfCells()):
        if mesh.IsCellVisible(i):
            cells.InsertNextId(i)
    extract = vtk.vtkExtractCells()
    extract.SetInputData(mesh)
    extract.SetCellList(cells)
    extract.Update()
    return extract.GetOutput()


KEPT = {
    ("ascii", "none", 32, "little"), ("inline", "none", 32, "little"),
    ("inline", "none", 64, "big"), ("inline", "zlib", 32, "big"), ("inline", "zlib", 64, "little"),
    ("inline", "lz4", 64, "big"), ("inline", "lzma", 32, "little"),
    ("base64", "none", 64, "little"), ("base64", "zlib", 32, "little"),
    ("base64", "lzma", 64, "big"), ("raw", "none", 32, "big"), ("raw", "none", 64, "little"),
    ("raw", "zlib", 64, "little"), ("raw", "lz4", 32, "little"), ("raw", "lzma", 64, "little"),
}


def main():
    folder, everything = sys.argv[1], "--all" in sys.argv
    os.makedirs(folder, exist_ok=True)
    at = lambda name: os.path.join(folder, name)
    mixed, polyhedra = grid(CELLS), grid(POLYHEDRA, attributes=False)
    for variant in itertools.product(["ascii", "inline", "base64", "raw"],
                                     ["none", "zlib", "lz4", "lzma"], [32, 64], ["little", "big"]):
        if everything or variant in KEPT:
            write_vtu(at("mixed_%s_%s_%d_%s.vtu" % variant), mixed, *variant)
    write_vtu(at("polyhedra.vtu"), polyhedra, "ascii", "none", 32, "little")
    for version in (42, 51):
        for binary in (False, True):
            name = "%s_%d.vtk" % ("binary" if binary else "ascii", version)
            write_vtk(at("mixed_" + name), mixed, binary, version)
    write_vtk(at("polyhedra_ascii_42.vtk"), polyhedra, False, 42)
    write_vtk(at("polyhedra_binary_51.vtk"), polyhedra, True, 51)
    # Exodus knows no voxels.
    write_exodus(at("mixed.exo"), grid([c for c in CELLS if c[0] != vtk.VTK_VOXEL]))
    # Two pieces, and an empty one, as ParaView writes them.
    write_vtu(at("piece_0.vtu"), grid(CELLS[:4]), "raw", "zlib", 32, "little")
    write_vtu(at("piece_1.vtu"), grid(CELLS[4:]), "ascii", "none", 32, "little")
    write_vtu(at("piece_2.vtu"), vtk.vtkUnstructuredGrid(), "raw", "zlib", 32, "little")
    with open(at("pieces.pvtu"), "w") as f:
        f.write('<?xml version="1.0"?>\n<VTKFile type="PUnstructuredGrid" version="0.1" '
                'byte_order="LittleEndian">\n  <PUnstructuredGrid GhostLevel="0">\n')
        for i in range(3):
            f.write('    <Piece Source="piece_%d.vtu"/>\n' % i)
        f.write("  </PUnstructuredGrid>\n</VTKFile>\n")
    bent, straight = structured(), rectilinear()
    write_grid(at("structured.vts"), bent, vtk.vtkXMLStructuredGridWriter)
    write_grid(at("structured_binary.vtk"), bent, vtk.vtkStructuredGridWriter)
    write_grid(at("structured_visible.vtu"), visible(bent), vtk.vtkXMLUnstructuredGridWriter, False)
    write_grid(at("rectilinear.vtr"), straight, vtk.vtkXMLRectilinearGridWriter, False)
    write_grid(at("rectilinear_ascii.vtk"), straight, vtk.vtkRectilinearGridWriter, False)
    write_grid(at("rectilinear_visible.vtu"), visible(straight), vtk.vtkXMLUnstructuredGridWriter, False)


if __name__ == "__main__":
    main()
