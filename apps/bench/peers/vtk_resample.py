# SPDX-License-Identifier: Apache-2.0
"""Times VTK's vtkResampleToImage for tetvdb_bench.

usage: vtk_resample.py MESH.vtu CELL_ARRAY THREADS

Prints "ready VERSION" once the mesh is in memory. Then for every line
    NX NY NZ X0 X1 Y0 Y1 Z0 Z1
on standard input it samples the mesh at NX x NY x NZ points and prints the seconds that the filter
took and the number of points that lie in a cell.
"""
import sys
import time

try:
    from vtkmodules.vtkCommonCore import vtkSMPTools, vtkVersion
    from vtkmodules.vtkFiltersCore import vtkResampleToImage
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
    from vtkmodules.util.numpy_support import vtk_to_numpy
except ImportError as error:
    print("python3-vtk9 is not installed (%s)" % error, flush=True)
    sys.exit(1)


def main():
    path, array, threads = sys.argv[1], sys.argv[2], int(sys.argv[3])
    vtkSMPTools.Initialize(threads)
    reader = vtkXMLUnstructuredGridReader()
    reader.SetFileName(path)
    reader.Update()
    mesh = reader.GetOutput()
    # Links and bounds are made once per mesh; they are not the filter's.
    mesh.GetBounds()
    for i in reversed(range(mesh.GetCellData().GetNumberOfArrays())):
        name = mesh.GetCellData().GetArrayName(i)
        if name != array:
            mesh.GetCellData().RemoveArray(name)
    if mesh.GetNumberOfCells() == 0 or not mesh.GetCellData().HasArray(array):
        print("VTK found no cells with array %s in %s" % (array, path), flush=True)
        sys.exit(1)
    print("ready %s, %s, %d threads" % (vtkVersion.GetVTKVersion(), vtkSMPTools.GetBackend(),
                                       vtkSMPTools.GetEstimatedNumberOfThreads()), flush=True)

    for line in sys.stdin:
        numbers = line.split()
        size = [int(n) for n in numbers[:3]]
        bounds = [float(n) for n in numbers[3:9]]
        resample = vtkResampleToImage()
        resample.SetInputDataObject(mesh)
        resample.SetSamplingDimensions(size)
        resample.SetUseInputBounds(False)
        resample.SetSamplingBounds(bounds)
        start = time.perf_counter()
        resample.Update()
        seconds = time.perf_counter() - start
        output = resample.GetOutput()
        inside = vtk_to_numpy(output.GetPointData().GetArray("vtkValidPointMask"))
        print("%.9f %d" % (seconds, int((inside != 0).sum())), flush=True)
        del inside, output, resample


if __name__ == "__main__":
    main()
