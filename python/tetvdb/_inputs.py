# SPDX-License-Identifier: Apache-2.0
"""Tells apart what a caller gives as a mesh, without importing the library that made it.

inputs_of() returns the list of tuples that the extension takes: see python/src/Inputs.h.
"""

import os

# Names that are no arrays of a mesh.
GRID_KINDS = frozenset(("density", "mask", "surface", "fog", "coverage", "tet_id", "material"))

# meshio's names of cells as VTK's types; meshio keeps VTK's order of nodes.
_VTK_TYPES = {
    "vertex": 1, "line": 3, "triangle": 5, "polygon": 7, "quad": 9, "tetra": 10,
    "hexahedron": 12, "wedge": 13, "pyramid": 14, "penta_prism": 15, "hexa_prism": 16,
    "line3": 21, "triangle6": 22, "quad8": 23, "tetra10": 24, "hexahedron20": 25,
    "wedge15": 26, "pyramid13": 27, "quad9": 28, "hexahedron27": 29, "triangle7": 34,
}
# Corners of the flat ones that are faces.
_FACE_CORNERS = {5: 3, 7: 0, 9: 4, 22: 3, 23: 4, 28: 4, 34: 3}
_SOLID_TYPES = frozenset((10, 11, 12, 13, 14, 15, 16, 24, 25, 26, 27, 29, 41, 42))


def _is_path(value):
    return isinstance(value, (str, bytes)) or hasattr(value, "__fspath__")


def _path(value):
    return os.fsdecode(os.fspath(value))


def _array(value):
    """An array that the extension can read in place, or a copy where there is no such view."""
    detach = getattr(value, "detach", None)  # a tensor with a gradient has no __dlpack__
    if detach is not None:
        value = detach()
    if hasattr(value, "__dlpack__") or hasattr(value, "__array_interface__"):
        return value
    import numpy

    return numpy.asarray(value)


def _is_array(value):
    return (hasattr(value, "__dlpack__") or hasattr(value, "__array__")
            or hasattr(value, "__array_interface__"))


def _is_mesh(value):
    return (_is_path(value) or _has(value, "vertices", "faces") or _has(value, "points", "tets")
            or hasattr(value, "cells_dict") or _has(value, "points", "celltypes")
            or _has(value, "vertices", "triangles") or _has(value, "vertex", "triangle")
            or _has(value, "points", "faces") or hasattr(value, "to_bytes"))


def _has(value, *names):
    return all(hasattr(value, name) for name in names)


def _fans(numpy, counts, nodes):
    """Polygons as triangles: a fan from each one's first corner."""
    counts = numpy.asarray(counts, dtype=numpy.int64)
    nodes = numpy.asarray(nodes)
    firsts = numpy.concatenate(([0], numpy.cumsum(counts)[:-1])) if len(counts) else counts
    fans = numpy.maximum(counts - 2, 0)
    polygon = numpy.repeat(numpy.arange(len(counts)), fans)
    step = numpy.arange(len(polygon)) - numpy.repeat(numpy.cumsum(fans) - fans, fans)
    first = firsts[polygon]
    return numpy.stack((nodes[first], nodes[first + step + 1], nodes[first + step + 2]), axis=1)


def _polygons(flat):
    """Triangles of VTK's legacy list: a count, then so many points, and so on."""
    import numpy

    flat = numpy.asarray(flat)
    if flat.ndim == 2:
        return flat
    if flat.size % 4 == 0 and (flat[::4] == 3).all():
        return flat.reshape(-1, 4)[:, 1:]
    counts, at = [], 0
    while at < flat.size:
        counts.append(int(flat[at]))
        at += counts[-1] + 1
    starts = numpy.cumsum(numpy.asarray(counts) + 1) - (numpy.asarray(counts) + 1)
    return _fans(numpy, counts, numpy.delete(flat, starts))


def _data(values):
    """A mapping from names to arrays, as far as they are numbers."""
    if values is None:
        return None
    import numpy

    found = {}
    for name in values.keys():
        array = numpy.asarray(values[name])
        if array.dtype.kind in "biuf" and array.ndim > 0:
            found[str(name)] = array.astype(numpy.uint8) if array.dtype.kind == "b" else array
    return found


def _of_meshio(name, mesh, attributes):
    import numpy

    types, nodes, ends, end, faces, kept = [], [], [], 0, [], []
    solid = False
    blocks = [(block.type, numpy.asarray(block.data)) for block in mesh.cells] \
        if hasattr(mesh, "cells") else list(mesh.cells_dict.items())
    for number, (kind, cells) in enumerate(blocks):
        vtk = _VTK_TYPES.get(kind, 0)
        solid = solid or vtk in _SOLID_TYPES
        if vtk in _FACE_CORNERS:
            corners = _FACE_CORNERS[vtk] or cells.shape[1]
            faces.append(_fans(numpy, [corners] * len(cells), cells[:, :corners].ravel()))
        if cells.ndim != 2:  # a ragged list: polyhedra
            continue
        types.append(numpy.full(len(cells), vtk, numpy.uint8))
        nodes.append(cells.ravel())
        ends.append(end + numpy.arange(1, len(cells) + 1, dtype=numpy.int64) * cells.shape[1])
        end += cells.size
        kept.append(number)
    points = _points(mesh.points)
    if not solid:
        if not faces:
            raise TypeError(f"{name} has neither faces nor solid cells")
        return ("triangles", name, points, numpy.concatenate(faces))
    cell_data = None
    if attributes and getattr(mesh, "cell_data", None):
        cell_data = {key: numpy.concatenate([numpy.asarray(values[i]) for i in kept])
                     for key, values in mesh.cell_data.items()}
    return ("cells", name, points, numpy.concatenate(types), numpy.concatenate(ends),
            numpy.concatenate(nodes), _data(mesh.point_data) if attributes else None,
            _data(cell_data))


def _points(values):
    """An array of three columns; those of plane meshes get a third of zeros."""
    import numpy

    points = numpy.asarray(values)
    if points.ndim == 2 and points.shape[1] == 2:
        points = numpy.column_stack((points, numpy.zeros(len(points), points.dtype)))
    return points


def _of_vtk(name, mesh, attributes):
    """PyVista's UnstructuredGrid."""
    import numpy

    types = numpy.asarray(mesh.celltypes)
    flat = numpy.asarray(mesh.cells)
    if hasattr(mesh, "cell_connectivity") and hasattr(mesh, "offset"):
        nodes, ends = numpy.asarray(mesh.cell_connectivity), numpy.asarray(mesh.offset)[1:]
    else:
        counts, at = [], 0
        while at < flat.size:
            counts.append(int(flat[at]))
            at += counts[-1] + 1
        counts = numpy.asarray(counts, dtype=numpy.int64)
        starts = numpy.cumsum(counts + 1) - (counts + 1)
        nodes, ends = numpy.delete(flat, starts), numpy.cumsum(counts)
    if not numpy.isin(types, list(_SOLID_TYPES)).any():
        counts = numpy.diff(numpy.concatenate(([0], ends)))
        is_face = numpy.isin(types, list(_FACE_CORNERS))
        keep = numpy.repeat(is_face, counts)
        return ("triangles", name, mesh.points, _fans(numpy, counts[is_face], nodes[keep]))
    return ("cells", name, mesh.points, types, ends, nodes,
            _data(mesh.point_data) if attributes else None,
            _data(mesh.cell_data) if attributes else None)


def _of_arrays(name, points, cells):
    points, cells = _array(points), _array(cells)
    shape = tuple(cells.shape)
    if len(shape) != 2 or shape[1] not in (3, 4):
        raise TypeError(f"cells of the shape {shape}: give triangles (M, 3) or tets (M, 4)")
    if shape[1] == 3:
        return ("triangles", name, points, cells)
    return ("tets", name, points, cells, None, None)


def _of_object(name, mesh, attributes):
    if hasattr(mesh, "keys") and hasattr(mesh, "hash"):  # tetvdb.Volume
        return ("volume", name, mesh)
    if _has(mesh, "points", "celltypes"):
        return _of_vtk(name, mesh, attributes)
    if hasattr(mesh, "cells_dict"):
        return _of_meshio(name, mesh, attributes)
    if _has(mesh, "points", "tets"):
        return ("tets", name, _array(mesh.points), _array(mesh.tets), None, None)
    if _has(mesh, "vertices", "faces"):  # trimesh
        return ("triangles", name, _array(mesh.vertices), _array(mesh.faces))
    if _has(mesh, "vertices", "triangles"):  # Open3D
        return ("triangles", name, _array(mesh.vertices), _array(mesh.triangles))
    if _has(mesh, "vertex", "triangle"):  # Open3D's tensors
        return ("triangles", name, _array(mesh.vertex.positions), _array(mesh.triangle.indices))
    if _has(mesh, "points", "faces"):  # PyVista's PolyData
        return ("triangles", name, _array(mesh.points), _polygons(mesh.faces))
    raise TypeError(f"a {type(mesh).__name__} is no mesh: give a path, points and cells, or an "
                    "object with vertices and faces, points and cells, or points and tets")


def inputs_of(mesh, cells=None, attributes=False):
    """One input or, from a list of them, several. `attributes`: with the meshes' data."""
    if cells is not None:
        return [_of_arrays("mesh", mesh, cells)]
    if _is_path(mesh):
        return [("file", _path(mesh))]
    if isinstance(mesh, (list, tuple)):
        if len(mesh) == 2 and not _is_mesh(mesh[0]) and not isinstance(mesh[0], (list, tuple)):
            return [_of_arrays("mesh", *mesh)]
        if not mesh:
            raise TypeError("no mesh was given")
        found = []
        for number, one in enumerate(mesh, 1):
            if _is_path(one):
                found.append(("file", _path(one)))
            elif isinstance(one, (list, tuple)):
                found.append(_of_arrays(f"mesh{number}", *one))
            else:
                found.append(_of_object(f"mesh{number}", one, attributes))
        return found
    return [_of_object("mesh", mesh, attributes)]
