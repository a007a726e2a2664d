# SPDX-License-Identifier: Apache-2.0
"""Values of grids made of arrays, judged by VTK's probe: nothing of the library in it.

Skipped (77) where VTK's or OpenVDB's Python modules are missing.
"""

import os
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy as np
    try:
        import openvdb as vdb
    except ImportError:
        import pyopenvdb as vdb
    import vtkmodules.vtkCommonDataModel as model
    from vtkmodules.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray, vtk_to_numpy
    from vtkmodules.vtkCommonCore import reference, vtkPoints
    from vtkmodules.vtkFiltersCore import vtkProbeFilter
    from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridWriter
except ImportError as error:
    print("skipped: %s" % error)
    sys.exit(77)

PROGRAM = os.environ["TETVDB_PROGRAM"]


def block(n, seed):
    """Kuhn's subdivision of n^3 cubes, inner points moved."""
    rng = np.random.default_rng(seed)
    side = n + 1
    points = np.stack(np.meshgrid(*[np.arange(side)] * 3, indexing="ij"), -1).reshape(-1, 3) * 1.0
    inner = ((points > 0) & (points < n)).all(1)
    points[inner] += rng.uniform(-0.2, 0.2, (inner.sum(), 3))
    points = points / n * 2 - [1, 0.5, 0]
    number = lambda p: (p[..., 0] * side + p[..., 1]) * side + p[..., 2]
    corner = np.stack(np.meshgrid(*[np.arange(n)] * 3, indexing="ij"), -1).reshape(-1, 3)
    tets = []
    for path in ((0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)):
        at = corner.copy()
        tet = [number(at)]
        for axis in path:
            at = at.copy()
            at[:, axis] += 1
            tet.append(number(at))
        tets.append(np.stack(tet, -1))
    return points, np.concatenate(tets), rng


def grid_of(points, tets, point_arrays, cell_arrays, kind=model.VTK_TETRA):
    mesh = model.vtkUnstructuredGrid()
    at = vtkPoints()
    at.SetDataTypeToDouble()
    at.SetData(numpy_to_vtk(points, deep=1))
    mesh.SetPoints(at)
    cells = model.vtkCellArray()
    cells.SetData(tets.shape[1], numpy_to_vtkIdTypeArray(tets.ravel().astype(np.int64), deep=1))
    mesh.SetCells(kind, cells)
    for data, arrays in ((mesh.GetPointData(), point_arrays), (mesh.GetCellData(), cell_arrays)):
        for name, values in arrays.items():
            array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
            array.SetName(name)
            data.AddArray(array)
    return mesh


def active(grid):
    """Indices and values of a grid's active voxels."""
    low, high = grid.evalActiveVoxelBoundingBox()
    shape = [h - l + 1 for l, h in zip(low, high)]
    mask = np.zeros(shape, dtype=bool)
    accessor = grid.deepCopy()
    values = np.zeros(shape + ([3] if "vec" in grid.valueTypeName else []), dtype=np.float32)
    accessor.copyToArray(values, ijk=low)
    for item in grid.citerOnValues():
        a, b = [np.subtract(corner, low) for corner in (item.min, item.max)]
        mask[a[0]:b[0] + 1, a[1]:b[1] + 1, a[2]:b[2] + 1] = True
    index = np.argwhere(mask)
    return index + low, values[mask]


def judge_owners(points, tets, mesh, where, owners, found):
    """Every voxel lies in the tet that `id` says, and has that tet's values."""
    v = points[tets[owners]]
    edges = np.stack([v[:, i] - v[:, 0] for i in (1, 2, 3)], -1)
    weights = np.linalg.solve(edges, (where - v[:, 0])[..., None])[..., 0]
    weights = np.concatenate([1 - weights.sum(1, keepdims=True), weights], 1)
    assert weights.min() > -1e-5, weights.min()
    for name in ("T", "vel"):
        corners = vtk_to_numpy(mesh.GetPointData().GetArray(name))[tets[owners]]
        expected = np.einsum("nk,nk...->n...", weights, corners)
        off = np.abs(found[name] - expected).max() / np.abs(corners).max()
        assert off < 3e-7, (name, off)
    q = vtk_to_numpy(mesh.GetCellData().GetArray("q"))[owners].astype(np.float32)
    assert (found["q"] == q).all()


def warped_cells(kind, n, seed):
    """n^3 cubes whose points are moved, as they are, or cut in two wedges or six pyramids each."""
    rng = np.random.default_rng(seed)
    at, number, cells = [], {}, []

    def point(p):
        key = tuple(round(float(x), 6) for x in p)
        if key not in number:
            number[key] = len(at)
            at.append(key)
        return number[key]

    square = [(0, 0), (1, 0), (1, 1), (0, 1)]
    for i, j, k in np.ndindex(n, n, n):
        base = np.array([i, j, k])
        if kind == model.VTK_HEXAHEDRON:
            cells.append([point(base + (a, b, c)) for c in (0, 1) for a, b in square])
        elif kind == model.VTK_WEDGE:
            for corners in (square[:3], [square[0], square[2], square[3]]):
                cells.append([point(base + (a, b, c)) for c in (0, 1) for a, b in corners])
        else:
            for axis in range(3):
                for level in (0, 1):
                    face = [np.roll((level, a, b), axis) for a, b in square]
                    face = face if level == 0 else face[::-1]
                    cells.append([point(base + f) for f in face] + [point(base + 0.5)])
    points = np.array(at) + rng.uniform(-0.12, 0.12, (len(at), 3))
    return points / n, np.array(cells), rng


def judge_shapes(mesh, array, name, voxel_size, folder, least):
    """Each voxel's value against vtkCell.EvaluatePosition() of the cell that owns it, to 1e-5 of
    the range, but where the centre lies outside of that cell."""
    ids = numpy_to_vtk(np.arange(mesh.GetNumberOfCells(), dtype=np.float64), deep=1)
    ids.SetName("owner")
    mesh.GetCellData().AddArray(ids)
    writer = vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(folder / "b.vtu"))
    writer.SetInputData(mesh)
    writer.Write()
    subprocess.run([PROGRAM, "voxelize", str(folder / "b.vtu"), "-o", str(folder / "b.vdb"),
                    "--voxel-size", repr(voxel_size), "--grid", array + ",owner", "-q"], check=True)
    index, values = active(vdb.read(str(folder / "b.vdb"), array))
    same, owners = active(vdb.read(str(folder / "b.vdb"), "owner"))
    assert (index == same).all()
    nodes = vtk_to_numpy(mesh.GetPointData().GetArray(array)).astype(np.float64)
    spread = np.ptp(nodes)
    rng = np.random.default_rng(0)
    some = rng.choice(len(index), min(len(index), 20000), replace=False)
    worst, judged = 0, 0
    by_owner = some[np.argsort(owners[some], kind="stable")]
    last = -1
    for v in by_owner:
        owner = int(round(float(owners[v])))
        if owner != last:
            cell = mesh.GetCell(owner)
            of_cell = [nodes[cell.GetPointId(i)] for i in range(cell.GetNumberOfPoints())]
            last = owner
        closest, sub, place, distance, weights = [0.0] * 3, reference(0), [0.0] * 3, \
            reference(0.0), [0.0] * len(of_cell)
        where = [float(x) * voxel_size for x in index[v]]
        if cell.EvaluatePosition(where, closest, sub, place, distance, weights) != 1:
            continue
        if min(place) < 0 or max(place) > 1:
            continue
        judged += 1
        worst = max(worst, abs(float(values[v]) - np.dot(weights, of_cell)) / spread)
    print("%s: %d of %d voxels judged, largest difference %.2g of the range"
          % (name, judged, len(some), worst))
    assert judged > least * len(some), (judged, len(some))
    assert worst < 1e-5, worst


def judge_linear_cells():
    with tempfile.TemporaryDirectory() as folder:
        for kind, name in ((model.VTK_HEXAHEDRON, "hexahedra"), (model.VTK_WEDGE, "wedges"),
                           (model.VTK_PYRAMID, "pyramids")):
            points, cells, rng = warped_cells(kind, 4, 5)
            mesh = grid_of(points, cells, {"T": rng.uniform(-40, 1200, len(points))}, {}, kind)
            judge_shapes(mesh, "T", name, 0.02, pathlib.Path(folder), 0.9)


def main():
    judge_linear_cells()
    points, tets, rng = block(6, 1)
    cells = np.arange(len(tets))
    mesh = grid_of(points, tets,
                   {"T": rng.uniform(-40, 1200, len(points)),
                    "vel": rng.uniform(-1, 1, (len(points), 3))},
                   {"q": rng.uniform(0, 5, len(tets)), "id": cells.astype(np.float64)})
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        writer = vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(folder / "a.vtu"))
        writer.SetInputData(mesh)
        writer.Write()
        subprocess.run([PROGRAM, "voxelize", str(folder / "a.vtu"), "-o", str(folder / "a.vdb"),
                        "--voxel-size", "0.037", "--grid", "T,vel,q,id", "-q"], check=True)
        grids = {grid.name: grid for grid in vdb.readAllGridMetadata(str(folder / "a.vdb"))}
        worst, found = {}, {}
        for name in grids:
            grid = vdb.read(str(folder / "a.vdb"), name)
            index, values = active(grid)
            probe = vtkProbeFilter()
            at = vtkPoints()
            at.SetDataTypeToDouble()
            at.SetData(numpy_to_vtk(index * 0.037, deep=1))
            cloud = model.vtkPolyData()
            cloud.SetPoints(at)
            probe.SetInputData(cloud)
            probe.SetSourceData(mesh)
            probe.Update()
            output = probe.GetOutput().GetPointData()
            valid = vtk_to_numpy(output.GetArray("vtkValidPointMask")) > 0
            theirs = vtk_to_numpy(output.GetArray(name))
            assert len(values) > 100000, len(values)
            assert valid.mean() > 0.999, (name, valid.mean())
            off = np.abs(values - theirs)
            off = (off.max(-1) if off.ndim > 1 else off)[valid]
            size = np.abs(theirs).max()
            # VTK takes a centre for inside if it is within 1e-3 of a cell's size of it, and
            # extrapolates: there the two differ a little, elsewhere by rounding.
            worst[name] = off.max() / size, (off > 3e-7 * size).mean()
            assert worst[name][1] < 0.02, (name, worst[name])
            if name in ("T", "vel"):
                assert worst[name][0] < 0.01, (name, worst[name])
            if name == "id":
                owners = np.rint(values).astype(int)
                where = index * 0.037
            found[name] = values
    judge_owners(points, tets, mesh, where, owners, found)
    print("largest difference from VTK, share that differs:", worst)


if __name__ == "__main__":
    main()
