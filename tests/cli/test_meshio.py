# SPDX-License-Identifier: Apache-2.0
"""Meshes that meshio wrote: every format and cell that both know, one bent cell a file.

A cell is bent by a quadratic map that keeps its volume, and carries an array that is linear in space, so
that a node in a wrong place shows in the volume or in the values.
"""

import contextlib
import sys
import unittest

from program import CommandLineTest

try:
    import meshio
    import numpy
    import pyopenvdb
    import scipy.io
except ImportError as missing:
    print("skipped:", missing)
    sys.exit(77)

CORNERS = {
    "tetra": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)],
    "pyramid": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (.5, .5, 1)],
    "wedge": [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)],
    "hexahedron": [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)],
}
VOLUMES = {"tetra": 1 / 6, "pyramid": 1 / 3, "wedge": 1 / 2, "hexahedron": 1}
# meshio's order is VTK's: vtkQuadraticTetra, vtkQuadraticHexahedron, vtkTriQuadraticHexahedron.
EDGES = {
    "tetra": [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)],
    "hexahedron": [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)],
}
FACES = [(0, .5, .5), (1, .5, .5), (.5, 0, .5), (.5, 1, .5), (.5, .5, 0), (.5, .5, 1), (.5, .5, .5)]
# Extension, meshio's name and options, whether arrays come through.
FORMATS = [(".vtu", "vtu", {}, True), (".vtk", "vtk", {}, True), (".msh", "gmsh22", {}, True),
           (".msh", "gmsh", {}, True), (".msh", "gmsh", {"binary": False}, True),
           (".xdmf", "xdmf", {"data_format": "XML"}, True), (".xdmf", "xdmf", {"data_format": "Binary"}, True),
           (".xdmf", "xdmf", {"data_format": "HDF"}, True), (".inp", "abaqus", {}, False),
           (".bdf", "nastran", {"point_format": "free"}, False),
           (".bdf", "nastran", {"point_format": "fixed-large"}, False), (".mesh", "medit", {}, False), (".vol", "netgen", {}, False), (".node", "tetgen", {}, False)]
# What meshio cannot write there.
MISSING = {"abaqus": {"pyramid", "hexahedron27"}, "nastran": {"hexahedron27"}, "medit": {"tetra10", "hexahedron20", "hexahedron27"},
           "netgen": {"hexahedron20", "hexahedron27"},
           "tetgen": {"tetra10", "pyramid", "wedge", "hexahedron", "hexahedron20", "hexahedron27"}}


def middle(a, b):
    return tuple((x + y) / 2 for x, y in zip(a, b))


def cells():
    """meshio's name, nodes before bending, volume."""
    for kind, corners in CORNERS.items():
        yield kind, corners, VOLUMES[kind]
        if kind in EDGES:
            middles = [middle(corners[a], corners[b]) for a, b in EDGES[kind]]
            yield f"{kind}{len(corners) + len(middles)}", corners + middles, VOLUMES[kind]
            if kind == "hexahedron":
                yield "hexahedron27", corners + middles + FACES, VOLUMES[kind]


def bent(p):
    x, y, z = p
    return x + .3 * z * (1 - z), y + .2 * z * (1 - z), z


def linear(p):
    return 2 * p[0] + p[1] - p[2] + 1


class Meshio(CommandLineTest):
    def check_field(self, path, scale=1.0):
        grids = {grid.name: grid for grid in pyopenvdb.readAll(str(self.path(path)))[0]}
        count = 0
        for voxel in grids["T"].citerOnValues():
            ijk = tuple((a + b) / 2 for a, b in zip(voxel.min, voxel.max))
            place = grids["T"].transform.indexToWorld(ijk)
            self.assertAlmostEqual(voxel.value, scale * linear(place), delta=2e-6 * abs(scale))
            count += voxel.count
        self.assertGreater(count, 100)
        return grids

    def test_every_format_and_cell(self):
        done = 0
        for kind, nodes, volume in cells():
            points = numpy.array([bent(p) for p in nodes])
            mesh = meshio.Mesh(points, [(kind, numpy.arange(len(points)).reshape(1, -1))],
                               point_data={"T": numpy.array([linear(p) for p in points])},
                               cell_data={"q": [numpy.array([7.0])]})
            for number, (ending, form, options, arrays) in enumerate(FORMATS):
                if kind in MISSING.get(form, ()):
                    continue
                with self.subTest(kind=kind, form=form, options=options):
                    name = f"{kind}{number}{ending}"
                    meshio.write(self.path(name), mesh, file_format=form, **options)
                    report = self.report_of("voxelize", name, "-o", "out.vdb", "--resolution", 24, "--grid",
                                            "coverage,T,q" if arrays else "coverage")
                    filled = {grid["name"]: grid for grid in report["grids"]}["coverage"]["filled"]
                    self.assertAlmostEqual(filled, volume, delta=1e-10)
                    if arrays:
                        grids = self.check_field("out.vdb")
                        self.assertEqual({voxel.value for voxel in grids["q"].citerOnValues()}, {7.0})
                    done += 1
        self.assertGreater(done, 60)

    def write_exodus(self, name, points, blocks):
        with scipy.io.netcdf_file(str(self.path(name)), "w") as file:
            cells = sum(len(nodes) for _, nodes in blocks)
            for dimension, size in (("num_dim", 3), ("num_nodes", len(points)), ("num_elem", cells),
                                    ("num_el_blk", len(blocks))):
                file.createDimension(dimension, size)
            for axis in range(3):
                file.createVariable("coord" + "xyz"[axis], "d", ("num_nodes",))[:] = points[:, axis]
            for number, (kind, nodes) in enumerate(blocks, 1):
                file.createDimension(f"num_el_in_blk{number}", len(nodes))
                file.createDimension(f"num_nod_per_el{number}", nodes.shape[1])
                connect = file.createVariable(f"connect{number}", "i",
                                              (f"num_el_in_blk{number}", f"num_nod_per_el{number}"))
                connect[:] = nodes + 1
                connect.elem_type = kind

    def test_surfaces_in_every_format(self):
        """A box of quadrilaterals and triangles, also where solid cells could be."""
        points = numpy.array([(x + .3 * z, y + .1 * x, z) for x, y, z in CORNERS["hexahedron"]])
        quads = numpy.array([(0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)])
        triangles = numpy.array([(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7)])
        surface = [("quad", quads), ("triangle", triangles)]

        def write(name, cells):
            mesh = meshio.Mesh(points, cells)
            if form == "gmsh":
                mesh.point_data["gmsh:dim_tags"] = numpy.tile((2, 1), (len(points), 1))
                for tag in ("gmsh:geometrical", "gmsh:physical"):
                    mesh.cell_data[tag] = [numpy.full(len(nodes), i) for i, (_, nodes) in enumerate(cells, 1)]
            meshio.write(self.path(name), mesh, file_format=form, **options)

        shells = [("SHELL4", quads), ("tri3", triangles)]
        forms = FORMATS[:-1] + [(".avs", "avsucd", {}, False), (".meshb", "medit", {}, False),
                                (".exo", None, {}, False)]
        for number, (ending, form, options, _) in enumerate(forms):
            with self.subTest(form=form, options=options):
                name = f"box{number}{ending}"
                if form:
                    write(name, surface)
                else:
                    self.write_exodus(name, points, shells)
                report = self.report_of("voxelize", name, "-o", "out.vdb", "--resolution", 24, "--grid", "coverage")
                self.assertEqual(report["status"], 0)
                self.assertEqual(report["mesh"]["triangles"], 12)
                self.assertAlmostEqual(report["grids"][0]["filled"], 1, delta=1e-6)
        # The faces of a mesh of solid cells are no surface.
        tets = numpy.array([(0, 1, 2, 6)])
        for number, (ending, form, options, _) in enumerate(forms):
            with self.subTest(form=form, options=options):
                name = f"tet{number}{ending}"
                if form:
                    write(name, [("triangle", triangles), ("tetra", tets)])
                else:
                    self.write_exodus(name, points, [("tri3", triangles), ("TETRA", tets)])
                report = self.report_of("voxelize", name, "-o", "out.vdb", "--resolution", 24, "--grid", "coverage")
                self.assertEqual(report["mesh"]["tets"], 1)
                self.assertAlmostEqual(report["grids"][0]["filled"], 1 / 6, delta=1e-6)

    def test_a_time_series(self):
        points = numpy.array([bent(p) for p in CORNERS["hexahedron"]])
        values = numpy.array([linear(p) for p in points])
        # Its HDF5 file goes where the process stands.
        with contextlib.chdir(self.folder), meshio.xdmf.TimeSeriesWriter("run.xdmf") as writer:
            writer.write_points_cells(points, [("hexahedron", numpy.arange(8).reshape(1, -1))])
            for step in (0, 0.5, 2):
                writer.write_data(step, point_data={"T": (step + 1) * values})
        report = self.report_of("voxelize", "run.xdmf", "-o", "out.vdb", "--resolution", 16, "--grid", "T",
                                "--frames", "all")
        self.assertEqual([frame["time"] for frame in report["frames"]], [0, 0.5, 2])
        for frame, scale in ((1, 1), (2, 1.5), (3, 3)):
            self.check_field(f"out.{frame:04}.vdb", scale)


if __name__ == "__main__":
    unittest.main()
