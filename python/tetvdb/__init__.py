# SPDX-License-Identifier: Apache-2.0
"""Meshes into sparse OpenVDB volumes.

    import tetvdb

    v = tetvdb.voxelize("part.stl", resolution=512)    # or arrays, or a mesh of another library
    v["density"].to_numpy()
    v.write("part.vdb")

A mesh is a path; points (N, 3) with triangles (M, 3) or tets (M, 4), arrays of NumPy or of anything
with __dlpack__; or an object of trimesh, meshio, PyVista or Open3D. Several in a list become one
volume. Settings have the names of the command line's options, with underscores; lengths are in
the mesh's units. docs/python.md is the guide.
"""

from __future__ import annotations

from typing import Any, NamedTuple, Optional, Sequence, Union

from . import _tetvdb
from ._dataset import Batch, Dataset
from ._inputs import GRID_KINDS as _GRID_KINDS
from ._inputs import _array
from ._inputs import inputs_of as _inputs_of
from ._tetvdb import (DeviceTensor, Error, Grid, MeshWarning, TetMesh, TriangleMesh, Volume, __version__,
                      allow_outside, read)

__all__ = ["Batch", "Dataset", "DeviceTensor", "Error", "Grid", "MeshWarning", "Queried", "Sliced",
           "Solid", "TetMesh", "TriangleMesh", "Volume", "allow_outside", "check", "from_arrays", "info", "prepare_mesh",
           "query", "read", "render", "repair", "slice", "tetrahedralize", "voxelize", "voxelize_file",
           "voxelize_frames", "__version__"]

_Length = Union[float, str]


def from_arrays(arrays: Any, *, voxel_size: Any = None, origin: Optional[Sequence[float]] = None,
                transform: Any = None, first: Sequence[int] = (0, 0, 0),
                background: Optional[float] = None) -> Volume:
    """A sparse volume of dense arrays, by the rules of `read` for files of arrays.

    arrays: an array [x, y, z], with up to 4 components on a last axis, of NumPy or of anything with
        __dlpack__ in the processor's memory; or a dict of such arrays by the names of their grids.
    voxel_size: a voxel's side, or three (default 1); origin: centre of voxel (0, 0, 0); or
        transform: 4 x 4, from index space to world space, for column vectors.
    first: the voxel of element [0, 0, 0]. `grid.to_numpy()`, `grid.transform` and `grid.origin` of
        a grid give the grid again.
    background: value of voxels that are left out (default 0; of an array that is cut off like a
        level set its largest value).
    """
    import numpy

    named = arrays.items() if isinstance(arrays, dict) else [("", arrays)]
    sides = [voxel_size] * 3 if isinstance(voxel_size, (int, float)) else voxel_size
    matrix = None if transform is None else numpy.asarray(transform, dtype=float).reshape(16).tolist()
    return _tetvdb.from_arrays([(name, numpy.ascontiguousarray(_array(array))) for name, array in named], sides, origin,
                               matrix, [int(i) for i in first], background)


def voxelize(mesh: Any, cells: Any = None, *, grid: Union[str, Sequence[str]] = "density",
             resolution: Optional[int] = None, voxel_size: Any = None, fit: Optional[int] = None,
             padding: Optional[int] = None, origin: Optional[Sequence[float]] = None,
             half_width: Union[None, float, str] = None, rule: Optional[str] = None,
             half: bool = False, up_axis: Optional[str] = None, units: Optional[str] = None,
             allow_empty: bool = False, mesher: Optional[str] = None,
             epsilon: Optional[_Length] = None, inside: Optional[str] = None,
             shell: Optional[float] = None, shell_side: Optional[str] = None,
             weld: Optional[float] = None, keep_orientation: bool = False,
             region: Any = None, exclude: Any = None, region_array: Optional[str] = None,
             bbox: Optional[Sequence[float]] = None, derive: Any = None, remap: Any = None,
             clamp: Any = None, background: Any = None, warp: Optional[str] = None,
             smooth: bool = False,
             write_mesh: Any = None, preview: Any = None, device: Optional[str] = None,
             threads: Optional[int] = None, max_memory: Union[None, int, str] = None,
             max_time: Optional[float] = None) -> Volume:
    """Turns meshes, of triangles or of solid cells, into a sparse volume.

    mesh, cells: see the module's documentation; `cells` goes with an array of points.
    grid: density, mask, surface, fog, coverage, tet_id, material, or arrays of the mesh by name.
    resolution: voxels along the longest side (default 256); or voxel_size: a voxel's side, or three;
        or fit: a cube of so many voxels, numbered from 0, with the model at its centre and `padding`
        voxels free on each side.
    origin: centre of voxel (0, 0, 0).
    half_width: voxels on either side of the surface that hold distances (default 3), or "all".
    rule: voxels of density and mask: "centre", "any" or "all".
    inside: "winding", "nonzero", "parity" or "flood"; shell: no solid but a shell of that thickness.
    mesher: "auto", "winding" or "envelope", the last within epsilon: a length, "1e-3d", "0.5v".
    weld, keep_orientation: how triangles are cleaned.
    region, exclude, region_array, bbox: which cells are kept.
    derive: grids made of arrays, {"speed": "vel:magnitude"}: magnitude, mises, trace, determinant,
        principal1 to 3, a component; remap, clamp: ranges, "0:1" or {"temperature": (0, 1)};
        background: values outside, 0 or {"temperature": 293}; as the command line has them.
    warp: move points by a vector array first, "disp" or "disp*2"; smooth: interpolate arrays over
        cells, by their means at points.
    write_mesh: a file for the tets, or the cleaned triangles; preview: a .png of what was done.
    device: "auto", "cpu", "cuda", "cuda:1" or "cuda:0,1".
    threads, max_memory, max_time: limits.

    Raises tetvdb.Error. Warns with tetvdb.MeshWarning. The volume's `report` says what was done.
    """
    settings = locals()
    del settings["mesh"], settings["cells"]
    _spell_fields(settings)
    names = grid.split(",") if isinstance(grid, str) else grid
    attributes = (not _GRID_KINDS.issuperset(names) or "material" in names
                  or any(s is not None for s in (region, exclude, region_array, derive, warp,
                                                 write_mesh)))
    return _tetvdb.voxelize(_inputs_of(mesh, cells, attributes), settings)


def _spell_fields(settings: dict) -> None:
    """What is said of arrays by dicts and tuples, as the command line has it."""

    def text(value):
        return ":".join(map(str, value)) if isinstance(value, (tuple, list)) else str(value)

    for name in ("derive", "remap", "clamp", "background"):
        given = settings[name]
        if hasattr(given, "items"):
            settings[name] = [f"{grid}={text(value)}" for grid, value in given.items()]
        elif name != "derive" and isinstance(given, tuple):
            settings[name] = text(given)


def voxelize_file(inputs: Any, output: Any, **settings: Any) -> dict:
    """Turns mesh files into a volume file, which need not fit into memory.

    inputs: a file, several of them, or the folder of a mesh that prepare_mesh() has prepared.
    output: "name.vdb"; or .nvdb or an array file.
    settings: as of voxelize().

    Volumes are streamed where their trees would not fit into `max_memory`. Returns the report. Raises
    tetvdb.Error. Warns with tetvdb.MeshWarning.
    """
    import os

    return _tetvdb.voxelize_file(_paths_of(inputs), os.fspath(output), _with_fields(settings))


def prepare_mesh(path: Any, folder: Any, *, grid: Union[str, Sequence[str]] = "density",
                 resolution: Optional[int] = None, voxel_size: Any = None,
                 origin: Optional[Sequence[float]] = None, up_axis: Optional[str] = None,
                 derive: Any = None, region_array: Optional[str] = None,
                 threads: Optional[int] = None, max_memory: Union[None, int, str] = None,
                 max_time: Optional[float] = None) -> dict:
    """Cuts a mesh of cells that is larger than memory into a folder of parts, for voxelize_file().

    path: a .vtu, .msh or .xdmf file of linear cells. folder: is whole or absent; one of an earlier run
        is replaced.
    grid, derive: what the parts are for: tet_id, material and arrays need the tets.
    resolution, voxel_size, origin, up_axis: as of voxelize(), for which they are decided here.

    Returns the report, whose "prepared" says what the folder holds. Raises tetvdb.Error. Warns with
    tetvdb.MeshWarning.
    """
    import os

    settings = locals()
    for name in ("path", "folder", "os"):
        del settings[name]
    return _tetvdb.prepare_mesh(os.fsdecode(os.fspath(path)), os.fspath(folder),
                                _with_fields(settings))


def _paths_of(inputs: Any) -> list:
    """One path or several, as texts."""
    import os

    paths = [inputs] if isinstance(inputs, (str, bytes)) or hasattr(inputs, "__fspath__") else inputs
    return [os.fsdecode(os.fspath(path)) for path in paths]


def _with_fields(settings: dict) -> dict:
    """Settings of voxelize() with what is said of arrays in the command line's words."""
    settings = {**dict.fromkeys(("derive", "remap", "clamp", "background")), "grid": "density",
                **settings}
    _spell_fields(settings)
    return settings


def voxelize_frames(inputs: Any, output: Any, *, frames: Optional[str] = None,
                    allow_gaps: bool = False, again: bool = False, **settings: Any) -> dict:
    """Turns the frames of a sequence into files that play: name.0001.vdb, name.0002.vdb, ...

    inputs: a .pvd collection, a pattern such as "run_*.vtu", files that differ in one number, or with
        `frames` a file that holds several steps.
    output: "name.vdb"; or .nvdb or an array file.
    frames: "all", "FIRST:LAST" or "FIRST:LAST:STRIDE", counted from 1. allow_gaps: although numbers
        are missing. again: those too that an earlier run has finished.
    settings: as of voxelize(), but for write_mesh and preview.

    All frames have one transform and one range of values to be remapped. Returns the report, whose
    "frames" has each one's input and file. Raises tetvdb.Error.
    """
    import os

    settings = _with_fields(settings)
    settings.update(frames=frames, allow_gaps=allow_gaps, again=again)
    return _tetvdb.voxelize_frames(_paths_of(inputs), os.fspath(output), settings)


def tetrahedralize(mesh: Any, cells: Any = None, *, epsilon: Optional[_Length] = None,
                   edge_length: Optional[_Length] = None, stop_energy: Optional[float] = None,
                   max_passes: Optional[int] = None, boolean: Optional[str] = None,
                   keep_outside: bool = False, weld: Optional[float] = None,
                   keep_orientation: bool = False, threads: Optional[int] = None,
                   max_memory: Union[None, int, str] = None,
                   max_time: Optional[float] = None) -> TetMesh:
    """Turns triangles with any defect into tetrahedra within epsilon of them.

    epsilon: a length, or a share of the diagonal of the box such as "1e-3d", the default.
    edge_length: what edges should have where the surface allows it (default "0.05d").
    stop_energy: improve until no tet's AMIPS energy is above it; 10 is a good mesh.
    boolean: one solid of several meshes: "union", "difference" or "intersection".
    keep_outside: the tets around the solid too, as region 0.

    Raises tetvdb.Error. Warns with tetvdb.MeshWarning. The mesh's `report` says what was done.
    """
    settings = locals()
    del settings["mesh"], settings["cells"]
    return _tetvdb.tetrahedralize(_inputs_of(mesh, cells), settings)


class Queried(NamedTuple):
    """What query() returns; None for what was not asked for."""

    occupancy: Any  #: bool (N)
    distance: Any  #: float64 (N)


class Solid:
    """A mesh made ready to be asked about many points, several times."""

    def __init__(self, mesh: Any, cells: Any = None, *, weld: Optional[float] = None,
                 keep_orientation: bool = False, threads: Optional[int] = None,
                 max_memory: Union[None, int, str] = None, max_time: Optional[float] = None):
        settings = {"weld": weld, "keep_orientation": keep_orientation, "threads": threads,
                    "max_memory": max_memory, "max_time": max_time}
        self._solid = _tetvdb.solid(_inputs_of(mesh, cells), settings)

    @property
    def open_edges(self) -> int:
        """Edges at which the mesh does not close, once cleaned: 0 of a closed one."""
        return self._solid.open_edges

    def query(self, points: Any, occupancy: bool = True, distance: bool = False) -> Queried:
        """Of every point (N, 3) whether it is inside, and its signed distance to the surface."""
        return Queried(*self._solid.ask(_array(points), occupancy, distance))


def query(mesh: Any, points: Any, cells: Any = None, *, occupancy: bool = True,
          distance: bool = False, weld: Optional[float] = None, keep_orientation: bool = False,
          threads: Optional[int] = None, max_time: Optional[float] = None) -> Queried:
    """Asks whether points are inside a mesh, and how far they are from its surface.

    points: (N, 3). occupancy: inside where the winding number is above 0.5, exact for a closed mesh.
    distance: to the nearest face, below zero inside.

        inside, distance = tetvdb.query(mesh, points, distance=True)

    For several calls with one mesh make a Solid. Raises tetvdb.Error.
    """
    solid = Solid(mesh, cells, weld=weld, keep_orientation=keep_orientation, threads=threads,
                  max_time=max_time)
    return solid.query(points, occupancy, distance)


def repair(mesh: Any, cells: Any = None, *, grid: Optional[str] = None,
           resolution: Optional[int] = None, voxel_size: Any = None,
           simplify: Optional[float] = None, remesh: bool = False, faces: Optional[int] = None,
           error: Optional[_Length] = None, smooth: Optional[_Length] = None,
           scale: Optional[float] = None, units: Optional[str] = None, inside: Optional[str] = None,
           shell: Optional[float] = None, weld: Optional[float] = None,
           keep_orientation: bool = False, threads: Optional[int] = None,
           max_memory: Union[None, int, str] = None,
           max_time: Optional[float] = None) -> TriangleMesh:
    """Makes a closed, manifold surface of any mesh, or of a volume.

    What is in order stays bit for bit; what is not is repaired where it is broken, or else the
    surface is made anew from voxels of `voxel_size`, or `resolution` along the longest side.
    faces, error: simplify to so many faces, or while both surfaces stay within `error`.
    smooth: even the surface out; no vertex moves farther.
    grid: of a volume (default: the first solid one).

    Raises tetvdb.Error. Warns with tetvdb.MeshWarning. The mesh's `report` says what was done.
    """
    settings = locals()
    del settings["mesh"], settings["cells"]
    return _tetvdb.repair(_inputs_of(mesh, cells), settings)


def info(mesh: Any, cells: Any = None, *, hash: bool = False,
         max_intersections: Optional[int] = None, region_array: Optional[str] = None,
         threads: Optional[int] = None) -> dict:
    """Says what a mesh or a volume holds: counts, box, volume, the defects of triangles.

    A dict, an element of "input" in the report of 'tetvdb info --json'. hash: of a volume, its hash.
    max_intersections: stop counting pairs of faces that cross there; 0: do not count.
    region_array: the cell array that holds region numbers.
    """
    settings = {"hash": hash, "max_intersections": max_intersections,
                "region_array": region_array, "threads": threads}
    return _tetvdb.info(_inputs_of(mesh, cells, True), settings)


def render(mesh: Any, cells: Any = None, *, view: Optional[str] = None,
           size: Optional[Sequence[int]] = None, color: Optional[str] = None,
           color_map: Optional[str] = None, range: Optional[str] = None, cut: Optional[str] = None,
           wire: bool = False, smooth: bool = False, defects: bool = False,
           perspective: bool = False, background: Optional[str] = None,
           up_axis: Optional[str] = None, style: Optional[str] = None, grid: Optional[str] = None,
           slice: Optional[str] = None, turntable: Optional[int] = None,
           threads: Optional[int] = None, max_memory: Union[None, int, str] = None,
           max_time: Optional[float] = None) -> Any:
    """Draws meshes or volumes; several in a list stand side by side.

    Returns uint8 (height, width, 3), or 4 with a transparent background; of a turntable (N, ...).
    view: "iso", "front", "top", ..., or "x,y,z" to the eye. size: (width, height).
    color: an array of the mesh, "quality" or "region". cut: "x=0.5" of the box, "x=12.5u" in units.
    style: of a volume, "voxels", "surface" or "fog"; slice: a plane across it, as `cut`.
    """
    settings = locals()
    del settings["mesh"], settings["cells"]
    return _tetvdb.render(_inputs_of(mesh, cells, color is not None), settings)


class Sliced(NamedTuple):
    """What slice() returns."""

    layers: Any  #: uint8 (layers, height, width), from below; None where a file was written
    report: dict  #: the object that the command line writes with --json


def slice(mesh: Any, cells: Any = None, *, output: Any = None, printer: Any = None,
          pixels: Optional[Sequence[int]] = None, display: Optional[Sequence[float]] = None,
          layer_height: Optional[float] = None, first_layer_height: Optional[float] = None,
          place: Union[None, str, Sequence[float]] = None, scale: Optional[float] = None,
          units: Optional[str] = None, grid: Optional[str] = None, aa: Optional[str] = None,
          levels: Optional[int] = None, gamma: Optional[float] = None, dither: bool = False,
          materials: bool = False, format: Optional[str] = None,
          exposure: Optional[float] = None, bottom_exposure: Optional[float] = None,
          bottom_layers: Optional[int] = None, transition_layers: Optional[int] = None,
          lift_height: Optional[float] = None, lift_speed: Optional[float] = None,
          retract_speed: Optional[float] = None, light_off_delay: Optional[float] = None,
          weld: Optional[float] = None,
          keep_orientation: bool = False, threads: Optional[int] = None,
          max_memory: Union[None, int, str] = None, max_time: Optional[float] = None) -> Sliced:
    """Cuts a mesh or a volume into a printer's layers.

    output: a file or folder as the command line takes it; None: the layers come as an array.
    printer: a file of settings; or pixels, display (mm) and layer_height (mm).
    place: "centre", "keep" or (x, y) in mm on the plate.
    aa: what a pixel's level is the share of: "volume", "area", or "none".
    exposure, bottom_exposure (seconds), bottom_layers, transition_layers, lift_height (mm), lift_speed,
        retract_speed (mm a minute), light_off_delay (seconds): in place of the printer's.
    """
    settings = locals()
    del settings["mesh"], settings["cells"]
    return Sliced(*_tetvdb.slice(_inputs_of(mesh, cells), settings))


def check(model: Any, cells: Any = None, *, target: str = "blender", printer: Any = None,
          pixels: Optional[Sequence[int]] = None, display: Optional[Sequence[float]] = None,
          layer_height: Optional[float] = None, first_layer_height: Optional[float] = None,
          place: Union[None, str, Sequence[float]] = None, scale: Optional[float] = None,
          units: Optional[str] = None, grid: Optional[str] = None, aa: Optional[str] = None,
          checks: Union[None, str, Sequence[str]] = None, overhang_angle: Optional[float] = None,
          min_wall: Optional[float] = None, min_floor: Optional[float] = None,
          min_gap: Optional[float] = None, drain: Optional[float] = None,
          min_area: Optional[float] = None, min_volume: Optional[float] = None,
          connectivity: Optional[int] = None, picture: Any = None, weld: Optional[float] = None,
          keep_orientation: bool = False, threads: Optional[int] = None,
          max_memory: Union[None, int, str] = None, max_time: Optional[float] = None) -> dict:
    """Says whether volumes will show in a program, or what will fail when a model is printed.

    target: "blender" or "houdini": model is a volume's file, or a list of them, the frames of a
        sequence; or a kind of printer, "sla" (resin), "lpbf" (metal powder) or "fdm" (filament): model
        is a mesh or a volume. The settings that follow are those of printers, as on the command line.
    checks: only these: "islands,cups". picture: a .png of the model with what was found.

    Returns the report: "findings" has an element each, with "code", "text" and "cure"; "status" is
    8 where there are any that count. Raises tetvdb.Error.
    """
    settings = locals()
    del settings["model"], settings["cells"]
    if target not in ("blender", "houdini"):
        return _tetvdb.check_print(_inputs_of(model, cells), settings)
    import os

    given = {name: value for name, value in settings.items() if value not in (None, False)}
    settings = {name: given[name] for name in ("target", "threads", "max_time") if name in given}
    for name in given:
        if name not in settings and name != "max_memory":
            raise TypeError(f"{name} is for printers, not for {target}")
    paths = [model] if isinstance(model, (str, bytes)) or hasattr(model, "__fspath__") else model
    return _tetvdb.check_volumes([os.fsdecode(os.fspath(path)) for path in paths], settings)
