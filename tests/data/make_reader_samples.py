# SPDX-License-Identifier: Apache-2.0
"""Makes tests/data/readers: meshes as VTK and h5py write them, for the tests of our readers.

    /usr/bin/python3 make_reader_samples.py OUTPUT     (needs python3-vtk9, python3-h5py, numpy)

The mesh of all: a block of 2 x 2 x 2 hexahedra of side 1, T = x + 10 y + 100 z and V = (x, y, z) at
its points, C = 1.5 times the cell's number in its cells. The surface: a sphere of 12 by 8 parts.
"""

import pathlib
import sys

import h5py
import numpy as np
import vtk

POINTS = np.array([(x, y, z) for z in range(3) for y in range(3) for x in range(3)], np.float32)
T = (POINTS @ np.array([1, 10, 100], np.float32)).astype(np.float32)


def hexahedra():
    def corner(x, y, z):
        return x + 3 * y + 9 * z

    return [[corner(x + i, y + j, z + k) for i, j, k in
             ((0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1))]
            for z in range(2) for y in range(2) for x in range(2)]


def array(name, values):
    found = vtk.vtkFloatArray() if values.dtype == np.float32 else vtk.vtkIntArray()
    found.SetName(name)
    found.SetNumberOfComponents(1 if values.ndim == 1 else values.shape[1])
    for value in values.reshape(-1):
        found.InsertNextValue(value.item())
    found.SetNumberOfTuples(len(values))
    return found


def grid(shift=0.0, part=None):
    made = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    for x, y, z in POINTS:
        points.InsertNextPoint(x + shift, y, z)
    made.SetPoints(points)
    for cell in hexahedra():
        made.InsertNextCell(12, 8, cell)
    made.GetPointData().AddArray(array("T", T))
    made.GetPointData().AddArray(array("V", POINTS))
    made.GetCellData().AddArray(array("C", 1.5 * np.arange(8, dtype=np.float32)))
    if part is not None:
        made.GetCellData().AddArray(array("BlockId", np.full(8, part, np.int32)))
    return made


def write(writer, path, data):
    writer.SetFileName(str(path))
    writer.SetInputData(data)
    writer.Write()


def sphere(strips):
    source = vtk.vtkSphereSource()
    source.SetThetaResolution(12)
    source.SetPhiResolution(8)
    source.Update()
    if not strips:
        return source.GetOutput()
    made = vtk.vtkStripper()
    made.SetInputData(source.GetOutput())
    made.Update()
    return made.GetOutput()


def surfaces(folder):
    for name, strips, mode in (("sphere_ascii", False, "Ascii"), ("sphere_raw", False, "Appended"),
                               ("strips", True, "Binary")):
        writer = vtk.vtkXMLPolyDataWriter()
        getattr(writer, f"SetDataModeTo{mode}")()
        writer.SetEncodeAppendedData(False)
        write(writer, folder / f"{name}.vtp", sphere(strips))
    for name, strips in (("sphere", False), ("strips", True)):
        writer = vtk.vtkPolyDataWriter()
        getattr(writer, "SetFileTypeToBinary" if strips else "SetFileTypeToASCII")()
        write(writer, folder / f"{name}.vtk", sphere(strips))
    appended = vtk.vtkAppendFilter()
    appended.AddInputData(sphere(False))
    appended.Update()
    write(vtk.vtkXMLUnstructuredGridWriter(), folder / "sphere.vtu", appended.GetOutput())


def blocks(folder):
    made = vtk.vtkMultiBlockDataSet()
    for i, name in enumerate(("left", "right")):
        made.SetBlock(i, grid(3.0 * i))
        made.GetMetaData(i).Set(vtk.vtkCompositeDataSet.NAME(), name)
    write(vtk.vtkXMLMultiBlockDataWriter(), folder / "blocks.vtm", made)


def ensight(folder):
    writer = vtk.vtkEnSightWriter()
    writer.SetPath(str(folder))
    writer.SetBaseName("ensight")
    writer.SetInputData(grid(part=1))
    writer.Write()
    writer.WriteCaseFile(1)


def text(group, name, value):
    group.attrs.create(name, np.bytes_(value))


def vtkhdf(path, steps):
    """Two parts side by side; with steps the arrays alone change."""
    cells = np.array(hexahedra())
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = [2, 0] if steps else [1, 0]
        text(root, "Type", "UnstructuredGrid")
        root["NumberOfPoints"] = [27, 27]
        root["NumberOfCells"] = [8, 8]
        root["NumberOfConnectivityIds"] = [64, 64]
        moved = POINTS + np.array([3, 0, 0], np.float32)
        root["Points"] = np.concatenate([POINTS, moved])
        root["Types"] = np.full(16, 12, np.uint8)
        root["Offsets"] = np.concatenate([8 * np.arange(9), 8 * np.arange(9)])
        root.create_dataset("Connectivity", data=np.concatenate([cells.reshape(-1)] * 2),
                            chunks=(32,), compression="gzip")
        both, number = np.concatenate([T, T]), 1.5 * np.arange(16, dtype=np.float32)
        if not steps:
            root["PointData/T"] = both
            root["PointData/V"] = np.concatenate([POINTS, moved])
            root["CellData/C"] = number
            return
        root["PointData/T"] = np.concatenate([both, both + 1000])
        root["CellData/C"] = np.concatenate([number, number + 1000])
        group = root.create_group("Steps")
        group.attrs["NSteps"] = 2
        group["Values"] = [0.5, 2.0]
        for name in ("PartOffsets", "PointOffsets"):
            group[name] = [0, 0]
        for name in ("CellOffsets", "ConnectivityIdOffsets"):
            group[name] = [[0], [0]]
        group["NumberOfParts"] = [2, 2]
        group["PointDataOffsets/T"] = [0, 54]
        group["CellDataOffsets/C"] = [0, 16]


def vtkhdf_surface(path):
    points = POINTS[[0, 2, 6, 18]]
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = [2, 0]
        text(root, "Type", "PolyData")
        root["NumberOfPoints"] = [4]
        root["Points"] = points
        for name, offsets, nodes in (("Vertices", [0], []), ("Lines", [0, 2], [0, 1]),
                                     ("Polygons", [0, 3, 6, 9], [0, 2, 1, 0, 1, 3, 0, 3, 2]),
                                     ("Strips", [0, 3], [1, 2, 3])):
            group = root.create_group(name)
            group["NumberOfCells"] = [len(offsets) - 1]
            group["NumberOfConnectivityIds"] = [len(nodes)]
            group["Offsets"] = np.array(offsets, np.int64)
            group["Connectivity"] = np.array(nodes, np.int64)


if __name__ == "__main__":
    OUT = pathlib.Path(sys.argv[1])
    OUT.mkdir(parents=True, exist_ok=True)
    surfaces(OUT)
    blocks(OUT)
    ensight(OUT)
    vtkhdf(OUT / "block.vtkhdf", False)
    vtkhdf(OUT / "steps.vtkhdf", True)
    vtkhdf_surface(OUT / "surface.vtkhdf")
