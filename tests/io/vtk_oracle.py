# SPDX-License-Identifier: Apache-2.0
"""What VTK's readers find in a mesh file: counts, volume and ranges of arrays.

Nothing of the library is in it. Volumes are those of the tets that each solid cell's corners are
cut into; `slack` is by how much another cut of the same cells changes the sum.
"""

import numpy as np
import vtkmodules.vtkCommonDataModel as model
import vtkmodules.vtkIOCGNSReader as cgns
import vtkmodules.vtkIOEnSight as ensight
import vtkmodules.vtkIOGeometry as geometry
import vtkmodules.vtkIOHDF as hdf
import vtkmodules.vtkIOLegacy as legacy
import vtkmodules.vtkIOXML as xml
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkIdList, vtkObject, vtkPoints
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as pipeline

vtkObject.GlobalWarningDisplayOff()

READERS = {".vtk": legacy.vtkGenericDataObjectReader, ".vtu": xml.vtkXMLUnstructuredGridReader,
           ".pvtu": xml.vtkXMLPUnstructuredGridReader, ".vtp": xml.vtkXMLPolyDataReader,
           ".vtm": xml.vtkXMLMultiBlockDataReader, ".vtkhdf": hdf.vtkHDFReader, ".hdf": hdf.vtkHDFReader,
           ".cgns": cgns.vtkCGNSReader, ".case": ensight.vtkGenericEnSightReader,
           ".encas": ensight.vtkGenericEnSightReader, ".neu": geometry.vtkGAMBITReader,
           ".foam": geometry.vtkOpenFOAMReader}

# Two cuts of each cell, by VTK's order of corners.
CUTS = {
    "tetra": [[(0, 1, 2, 3)]] * 2,
    "hexahedron": [[(0, 1, 2, 6), (0, 2, 3, 6), (0, 3, 7, 6), (0, 7, 4, 6), (0, 4, 5, 6), (0, 5, 1, 6)],
                   [(1, 2, 3, 7), (1, 3, 0, 7), (1, 0, 4, 7), (1, 4, 5, 7), (1, 5, 6, 7), (1, 6, 2, 7)]],
    "voxel": [[(0, 1, 3, 7), (0, 3, 2, 7), (0, 2, 6, 7), (0, 6, 4, 7), (0, 4, 5, 7), (0, 5, 1, 7)]] * 2,
    "wedge": [[(0, 1, 2, 3), (1, 2, 3, 4), (2, 3, 4, 5)], [(0, 1, 2, 5), (0, 1, 5, 4), (0, 4, 5, 3)]],
    "pyramid": [[(0, 1, 2, 4), (0, 2, 3, 4)], [(1, 2, 3, 4), (1, 3, 0, 4)]],
}
KINDS = {model.VTK_TETRA: "tetra", model.VTK_QUADRATIC_TETRA: "tetra", model.VTK_VOXEL: "voxel",
         model.VTK_HEXAHEDRON: "hexahedron", model.VTK_QUADRATIC_HEXAHEDRON: "hexahedron",
         model.VTK_TRIQUADRATIC_HEXAHEDRON: "hexahedron", model.VTK_WEDGE: "wedge",
         model.VTK_QUADRATIC_WEDGE: "wedge", model.VTK_BIQUADRATIC_QUADRATIC_WEDGE: "wedge",
         model.VTK_PYRAMID: "pyramid", model.VTK_QUADRATIC_PYRAMID: "pyramid"}


def blocks_of(data):
    """All data sets with points in a data object, in order."""
    if data is None:
        return []
    if data.IsA("vtkCompositeDataSet"):
        walk = data.NewIterator()
        found = []
        while not walk.IsDoneWithTraversal():
            found += blocks_of(walk.GetCurrentDataObject())
            walk.GoToNextItem()
        return found
    return [data] if data.IsA("vtkDataSet") else []


def signed_volumes(points, tets):
    a, b, c, d = (points[[tet[k] for tet in tets]] for k in range(4))
    return np.einsum("ij,ij->i", np.cross(b - a, c - a), d - a) / 6


class Found:
    """Sums over the blocks of a file."""

    def __init__(self):
        self.points = self.solids = self.faces = 0
        self.volume = self.slack = 0.0
        self.area = 0.0
        self.ranges = {}  # ("points" or "cells", name): [least, greatest], finite values alone

    def add(self, block):
        points = np.array([block.GetPoint(i) for i in range(block.GetNumberOfPoints())]).reshape(-1, 3)
        solid = np.zeros(block.GetNumberOfCells(), bool)
        corners, ids, places = {}, vtkIdList(), vtkPoints()
        for i in range(block.GetNumberOfCells()):
            dimension = block.GetCell(i).GetCellDimension()
            if dimension == 2:
                self.add_face(block.GetCell(i), points, ids, places)
            if dimension < 3:
                continue
            solid[i] = True
            kind = KINDS.get(block.GetCellType(i))
            if kind is None:
                self.add_other(block.GetCell(i), points, ids, places)
                continue
            nodes = block.GetCell(i).GetPointIds()
            count = {"tetra": 4, "hexahedron": 8, "voxel": 8, "wedge": 6, "pyramid": 5}[kind]
            corners.setdefault(kind, []).append([nodes.GetId(k) for k in range(count)])
        for kind, cells in corners.items():
            sums = [np.abs(signed_volumes(points, [[cell[k] for k in tet] for cell in cells for tet in cut])).sum()
                    for cut in CUTS[kind]]
            self.volume += sums[0]
            self.slack += abs(sums[1] - sums[0])
        self.points += len(points)
        self.solids += int(solid.sum())
        self.add_ranges("points", block.GetPointData(), slice(None))
        if solid.any():
            self.add_ranges("cells", block.GetCellData(), solid)

    def add_other(self, cell, points, ids, places):
        cell.Triangulate(0, ids, places)
        tets = [[ids.GetId(4 * k + j) for j in range(4)] for k in range(ids.GetNumberOfIds() // 4)]
        volume = np.abs(signed_volumes(points, tets)).sum()
        self.volume += volume
        self.slack += 1e-4 * volume

    def add_face(self, cell, points, ids, places):
        self.faces += max(1, cell.GetNumberOfPoints() - 2) if cell.IsA("vtkTriangleStrip") else 1
        cell.Triangulate(0, ids, places)
        for k in range(0, ids.GetNumberOfIds() - 2, 3):
            a, b, c = (points[ids.GetId(k + j)] for j in range(3))
            self.area += np.linalg.norm(np.cross(b - a, c - a)) / 2

    def add_ranges(self, on, data, chosen):
        for i in range(data.GetNumberOfArrays()):
            array = data.GetArray(i)
            if array is None or array.GetNumberOfTuples() == 0:
                continue
            values = vtk_to_numpy(array)[chosen]
            values = values[np.isfinite(values)]
            if values.size:
                known = self.ranges.setdefault((on, array.GetName()), [np.inf, -np.inf])
                known[0] = min(known[0], float(values.min()))
                known[1] = max(known[1], float(values.max()))


def read(path, ending):
    """The data object of the file's last step."""
    reader = READERS[ending]()
    if hasattr(reader, "SetCaseFileName"):
        reader.SetFilePath(str(path.parent))
        reader.SetCaseFileName(path.name)
    else:
        reader.SetFileName(str(path))
    reader.UpdateInformation()
    if ending == ".foam":
        reader.CreateCellToPointOff()
        reader.DecomposePolyhedraOff()
        reader.EnableAllCellArrays()
    if ending == ".cgns":
        reader.EnableAllBases()
        reader.EnableAllPointArrays()
        reader.EnableAllCellArrays()
        reader.LoadBndPatchOff() if hasattr(reader, "LoadBndPatchOff") else None
    times = reader.GetOutputInformation(0).Get(pipeline.TIME_STEPS())
    if times:
        reader.UpdateTimeStep(times[-1])
    else:
        reader.Update()
    return reader.GetOutputDataObject(0)


def look(path, ending=None):
    found = Found()
    for block in blocks_of(read(path, ending or path.suffix)):
        found.add(block)
    return found
