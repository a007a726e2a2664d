# SPDX-License-Identifier: Apache-2.0
"""Meshes and simulations as volumes in Blender: File > Import > Mesh as Volume (TetVDB).

Runs the program `tetvdb` beside Blender, loads the .vdb files that it writes, and gives them a
material. File > Import > Volume Tiles (TetVDB) loads a folder that `tetvdb voxelize --tiles` or
`tetvdb convert --tiles` has written, as one collection. Install this file with Edit > Preferences > Add-ons > Install; see docs/dcc.md.
"""

bl_info = {
    "name": "TetVDB: Mesh as Volume",
    "description": "Imports tetrahedra, triangles and simulations over time as OpenVDB volumes",
    "author": "TetVDB",
    "version": (1, 0, 0),
    "blender": (3, 4, 0),
    "location": "File > Import > Mesh as Volume (TetVDB)",
    "category": "Import-Export",
}

import functools
import json
import os
import re
import shlex
import shutil
import subprocess
import tempfile
import threading
from xml.sax.saxutils import quoteattr

import bpy
from bpy.props import (BoolProperty, CollectionProperty, EnumProperty, FloatProperty,
                       IntProperty, StringProperty)
from bpy_extras.io_utils import ImportHelper

# From cold to hot.
RAMP = ((0.0, (0.0, 0.0, 0.05)), (0.25, (0.25, 0.0, 0.35)), (0.5, (0.8, 0.1, 0.15)),
        (0.75, (1.0, 0.5, 0.0)), (1.0, (1.0, 1.0, 0.6)))
# The density that a material asks for makes a model this many times as thick as the way after
# which 1/e of the light is left, whatever its unit of length.
OPTICAL_LENGTH = 20.0


class TetvdbError(Exception):
    """What went wrong, for the user to read."""


def preferred_program(context):
    """What the preferences say; an add-on that --addons has switched on has none."""
    addon = context.preferences.addons.get(__name__)
    return addon.preferences.program if addon and addon.preferences else ""


def find_program(preferred):
    """The program's path: the preferences', else the one in PATH."""
    if preferred:
        path = bpy.path.abspath(preferred)
        if os.path.isfile(path) and os.access(path, os.X_OK):
            return path
        raise TetvdbError(f"'{path}' is no program: set the path of tetvdb in the add-on's "
                          "preferences")
    path = shutil.which("tetvdb")
    if path is None:
        raise TetvdbError("tetvdb is not in PATH: set its path in the add-on's preferences")
    return path


@functools.lru_cache(maxsize=None)
def rows_of(program, table):
    """The rows of one of the program's tables, "formats" or "grids"."""
    try:
        asked = subprocess.run([program, table, "--json", "-"], stdin=subprocess.DEVNULL,
                               capture_output=True, text=True, timeout=60)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise TetvdbError(f"{program} does not start: {error}") from error
    if asked.returncode != 0:
        raise TetvdbError(asked.stderr.strip() or f"tetvdb {table} failed")
    return json.loads(asked.stdout)[table]


def mesh_endings(program, stepped=False):
    """The endings of mesh files; with `stepped` of those that hold steps in one file."""
    return [ending for row in rows_of(program, "formats")
            if row["read"] and {"tets", "triangles"} & set(row["holds"])
            and (row["steps_in_one_file"] or not stepped) for ending in row["endings"]]


def frame_number(path):
    """A path around the last number in its name: what comes before, the number, what comes after;
    the number is None where there is none."""
    folder, name = os.path.split(path)
    stem, suffix = os.path.splitext(name)
    found = re.fullmatch(r"(.*?)([0-9]+)([^0-9]*)", stem)
    if found is None:
        return os.path.join(folder, stem), None, suffix
    return os.path.join(folder, found.group(1)), int(found.group(2)), found.group(3) + suffix


def are_frames(paths):
    """Whether names differ only in their last number, by the rule of tetvdb."""
    parts = [frame_number(path) for path in paths]
    return (len(paths) > 1 and all(number is not None for _, number, _ in parts)
            and len({(before, after) for before, _, after in parts}) == 1
            and len({number for _, number, _ in parts}) == len(paths))


def collection_of(paths):
    """A .pvd collection of frames, in the order of their numbers."""
    ordered = enumerate(map(os.path.abspath, sorted(paths, key=lambda path: frame_number(path)[1])))
    entries = "".join(f'<DataSet timestep="{step}" part="0" file={quoteattr(path)}/>'
                      for step, path in ordered)
    return f'<VTKFile type="Collection" version="0.1"><Collection>{entries}</Collection></VTKFile>'


def inputs_of(paths, sequence, folder, program):
    """What tetvdb is given as input, and the options that belong to it. Several frames are listed
    in a file in `folder`, since a command line has room for a few hundred."""
    if sequence and are_frames(paths):
        listed = os.path.join(folder, "frames.pvd")
        with open(listed, "w", encoding="utf-8") as file:
            file.write(collection_of(paths))
        return [listed], ["--allow-outside"] # of the folder that the list is in
    if len(paths) > 1:
        return list(paths), ["--union"]
    if sequence and os.path.splitext(paths[0])[1].lower() in mesh_endings(program, stepped=True):
        return list(paths), ["--frames", "all"]
    return list(paths), []


def words_of(text):
    """The words of More Options. Backslashes part Windows' folders and quote nothing there."""
    lexer = shlex.shlex(text, posix=True, punctuation_chars=False)
    lexer.whitespace_split = True
    lexer.commenters = ""
    if os.name == "nt":
        lexer.escape = ""
    try:
        return list(lexer)
    except ValueError as error:
        raise TetvdbError(f"More Options: {text}: a quotation mark is missing") from error


def grids_of(arrays, surface):
    """The value of --grid: density first, then the arrays."""
    names = ["density"] + (["surface"] if surface else [])
    for name in (part.strip() for part in arrays.split(",")):
        if name and name not in names:
            names.append(name)
    return ",".join(names)


def voxelize_arguments(paths, output, options, folder, program):
    """The arguments of tetvdb, from an operator or anything else with its properties."""
    size = (["--voxel-size", repr(round(options.voxel_size, 9))]
            if options.size_by == "VOXEL_SIZE" else ["--resolution", str(options.resolution)])
    # Blackbody wants kelvin.
    remap = options.remap and options.arrays.strip() and options.shading != "BLACKBODY"
    more = ["--remap", "0:1"] if remap else []
    if options.warp.strip():
        more += ["--warp", options.warp.strip()]
    inputs, frames = inputs_of(paths, options.sequence, folder, program)
    return (["voxelize", *inputs, "-o", output, "--grid", grids_of(options.arrays, options.surface)]
            + size + frames + more + words_of(options.more))


class Job:
    """One run of tetvdb beside Blender. `arguments` is a function of a folder for files that are
    needed as long as it runs."""

    def __init__(self, program, arguments):
        self.folder = tempfile.TemporaryDirectory(prefix="tetvdb-")
        self.report_path = os.path.join(self.folder.name, "report.json")
        self.command = [program, *arguments(self.folder.name), "-v", "--json", self.report_path]
        self._start()

    def _start(self):
        self.stage, self.fraction, self.said = "", 0.0, []
        try:
            self.process = subprocess.Popen(self.command, stdin=subprocess.DEVNULL,
                                            stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                            text=True, errors="replace")
        except OSError as error:
            self.folder.cleanup()
            raise TetvdbError(f"{self.command[0]} does not start: {error.strerror}") from error
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        # "tetvdb: STAGE" and "tetvdb: STAGE 40 %, about 30 s left" say how far it is as a whole; the
        # rest is kept.
        for line in self.process.stderr:
            line = line.rstrip()
            step = re.fullmatch(r"tetvdb: ([a-z ]+?)(?: (\d+) %(?:, about \d+ \w+ left)?)?", line)
            if step:
                self.stage = step.group(1)
                if step.group(2):
                    self.fraction = int(step.group(2)) / 100
            elif line:
                self.said.append(line)

    def running(self):
        if self.process.poll() is None:
            return True
        # A file of such a format may hold only a mesh, and no steps.
        if self.process.returncode == 3 and "--frames" in self.command:
            self._close()
            if any("has no time steps" in line for line in self.said):
                first = self.command.index("--frames")
                del self.command[first:first + 2]
                self._start()
                return True
        return False

    def _close(self):
        self.reader.join()
        self.process.stderr.close()

    def cancel(self):
        """Stops it cleanly: no output is left half written."""
        if self.process.poll() is None:
            self.process.terminate()

    def finish(self):
        """Waits; the report, or TetvdbError with what the program says."""
        while self.running():
            self.process.wait()
        status = self.process.returncode
        self._close()
        try:
            with open(self.report_path, encoding="utf-8") as file:
                report = json.load(file)
        except (OSError, ValueError):
            report = {}
        finally:
            self.folder.cleanup()
        if status == 5:
            raise TetvdbError("cancelled; nothing was imported")
        if status not in (0, 1):
            said = [line for line in self.said if not line.startswith("tetvdb: warning")]
            raise TetvdbError(said[-1] if said else f"tetvdb ended with status {status}")
        return report


def grids_of_frames(report, program):
    """What is known of the grids of every frame, or of the only one."""
    if "frames" not in report:
        return [report["grids"]]
    frames = [frame["grids"] for frame in report["frames"]]
    # Of frames that an earlier run has made, the report has no more than the names.
    known = [frame["output"] for frame in report["frames"] if not frame["grids"]]
    if known:
        asked = subprocess.run([program, "info", "--json", "-", *known], stdin=subprocess.DEVNULL,
                               capture_output=True, text=True)
        if asked.returncode != 0:
            raise TetvdbError(asked.stderr.strip() or "tetvdb info failed")
        read = iter(json.loads(asked.stdout)["input"])
        frames = [grids or next(read)["grids"] for grids in frames]
    return frames


def ranges_of(frames):
    """{grid: (type, min, max)} over all frames."""
    ranges = {}
    for grid in (grid for grids in frames for grid in grids if grid["active_voxels"] > 0):
        kind, low, high = ranges.get(grid["name"], (grid["type"], grid["min"], grid["max"]))
        ranges[grid["name"]] = kind, min(low, grid["min"]), max(high, grid["max"])
    return ranges


def longest_side(frames):
    """Of the density in all frames together, in the mesh's units."""
    shown = [grid for grids in frames for grid in grids
             if grid["name"] == "density" and grid["active_voxels"] > 0]
    if not shown:
        return 0.0
    return max((max(grid["box"]["max"][axis] for grid in shown) + 1
                - min(grid["box"]["min"][axis] for grid in shown)) * shown[0]["voxel_size"][axis]
               for axis in range(3))


def shader_name(grid, grids):
    """By which name materials know a grid: Blender takes the first of these for the volume's
    velocity, and calls it so."""
    for name in ("velocity", "vel", "v"):
        if name in grids:
            return "velocity" if grid == name else grid
    return grid


def make_material(name, grid, ranges, length, shading):
    """Principled Volume: `density` as the density, and in color what `grid` is, if it is given."""
    material = bpy.data.materials.new(name)
    material.use_nodes = True
    tree = material.node_tree
    tree.nodes.clear()

    def node(kind, x, y, label=""):
        made = tree.nodes.new(kind)
        made.location, made.label = (x, y), label
        return made

    output = node("ShaderNodeOutputMaterial", 300, 0)
    volume = node("ShaderNodeVolumePrincipled", 0, 0)
    tree.links.new(volume.outputs["Volume"], output.inputs["Volume"])
    density = OPTICAL_LENGTH / length if length > 0 else 1.0
    volume.inputs["Density"].default_value = density
    volume.inputs["Density Attribute"].default_value = "density"
    volume.inputs["Color Attribute"].default_value = ""
    volume.inputs["Temperature Attribute"].default_value = ""
    if not grid or shading == "DENSITY":
        return material

    known = shader_name(grid, ranges)
    kind, low, high = ranges[grid]
    if shading == "BLACKBODY":
        # Kelvin is temperature times attribute.
        volume.inputs["Temperature"].default_value = 1.0
        volume.inputs["Temperature Attribute"].default_value = known
        volume.inputs["Blackbody Intensity"].default_value = 1.0
        return material
    inside = node("ShaderNodeAttribute", -1300, -300, "density")
    inside.attribute_name = "density"
    attribute = node("ShaderNodeAttribute", -1300, 0, grid)
    attribute.attribute_name = known
    if kind.startswith("vec"):
        size = node("ShaderNodeVectorMath", -900, 0)
        size.operation = "LENGTH"
        tree.links.new(attribute.outputs["Vector"], size.inputs[0])
    else:
        # Blender fades numbers to 0 within half a voxel of the surface, and the density likewise.
        size = node("ShaderNodeMath", -900, 0, "As inside")
        size.operation = "DIVIDE"
        tree.links.new(attribute.outputs["Fac"], size.inputs[0])
        tree.links.new(inside.outputs["Fac"], size.inputs[1])
    spread = node("ShaderNodeMapRange", -700, 0, f"{grid}: {low:.6g} to {high:.6g}")
    spread.inputs["From Min"].default_value = low
    spread.inputs["From Max"].default_value = high if high > low else low + 1
    tree.links.new(size.outputs["Value"], spread.inputs["Value"])
    ramp = node("ShaderNodeValToRGB", -450, 0)
    stops = ramp.color_ramp.elements
    while len(stops) < len(RAMP):
        stops.new(0.5)
    for stop, (position, color) in zip(stops, RAMP):
        stop.position, stop.color = position, (*color, 1.0)
    tree.links.new(spread.outputs["Result"], ramp.inputs["Fac"])
    tree.links.new(ramp.outputs["Color"], volume.inputs["Color"])
    tree.links.new(ramp.outputs["Color"], volume.inputs["Emission Color"])
    # Light where there is something: emission knows no density of its own.
    glow = node("ShaderNodeMath", -200, -300, "Glow")
    glow.operation = "MULTIPLY"
    glow.inputs[1].default_value = density / 2
    tree.links.new(inside.outputs["Fac"], glow.inputs[0])
    tree.links.new(glow.outputs["Value"], volume.inputs["Emission Strength"])
    return material


def load_volume(name, report):
    """An object of the volume, or of the sequence, that the report names, and whether it is new.
    Objects that an earlier import has made of the same file show the new one: Blender keeps what it
    has read of a file as long as a data block names it, so the old data block is dropped."""
    paths = [os.path.abspath(each["path"]) for each in report["output"]]
    old = [each for each in bpy.data.volumes
           if os.path.abspath(bpy.path.abspath(each.filepath)) == paths[0]]
    things = [each for each in bpy.data.objects if each.type == "VOLUME" and each.data in old]
    for each in old:
        each.grids.unload()
    volume = bpy.data.volumes.new(name)
    for thing in things:
        thing.data = volume
    for each in old:
        bpy.data.volumes.remove(each)
    volume.name = name
    volume.filepath = paths[0]
    if "frames" in report:
        volume.is_sequence = True
        volume.frame_start = 1
        volume.frame_duration = len(paths)
        volume.frame_offset = int(re.search(r"(\d+)\.vdb$", paths[0]).group(1)) - 1
        volume.sequence_mode = "EXTEND"
    shown = [each for each in things if each.users_collection]
    if shown:
        return shown[0], False
    thing = bpy.data.objects.new(name, volume)
    bpy.context.collection.objects.link(thing)
    return thing, True


def read_tiles(path):
    """What tiles.json says; TetvdbError where it says nothing, or its files are not there."""
    try:
        with open(path, encoding="utf-8") as file:
            tiles = json.load(file)
        if tiles["tiles_version"] != 1:
            raise TetvdbError(f"'{path}' has version {tiles['tiles_version']}, and 1 is known")
        folder = os.path.dirname(os.path.abspath(path))
        paths = [os.path.join(folder, tile["file"]) for tile in tiles["tiles"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise TetvdbError(f"'{path}' is no tiles.json of tetvdb: {error}") from error
    for each in paths:
        if os.path.dirname(os.path.abspath(each)) != folder or not os.path.isfile(each):
            raise TetvdbError(f"there is no file '{each}'")
    return tiles, paths


def load_tiles(path, scale, centered, color_by):
    """A collection with an object a tile, all with one material, named after the folder."""
    tiles, paths = read_tiles(path)
    grids = [tiles["grids"]]
    ranges = ranges_of(grids)
    if color_by and color_by not in ranges:
        raise TetvdbError(f"there is no grid '{color_by}' to color by, but " + ", ".join(ranges))
    name = os.path.basename(os.path.dirname(os.path.abspath(path)))
    collection = bpy.data.collections.new(name)
    bpy.context.scene.collection.children.link(collection)
    material = make_material(name, color_by, ranges, longest_side(grids) * scale,
                             "RAMP" if color_by else "DENSITY")
    things = []
    for each in paths:
        thing, _ = load_volume(os.path.splitext(os.path.basename(each))[0],
                               {"output": [{"path": each}]})
        for other in list(thing.users_collection):
            other.objects.unlink(thing)
        collection.objects.link(thing)
        thing.data.materials.append(material)
        thing.scale = (scale,) * 3
        if centered:
            thing.location = [-scale * side / 2 for side in tiles["grids"][0]["voxel_size"]]
        things.append(thing)
    return collection, things


def add_surface(name, volume_object):
    """A mesh that follows the volume's level set, in the volume's place, unless there is one."""
    if any(modifier.type == "VOLUME_TO_MESH" and modifier.object == volume_object
           for thing in bpy.data.objects for modifier in thing.modifiers):
        return None
    thing = bpy.data.objects.new(name, bpy.data.meshes.new(name))
    bpy.context.collection.objects.link(thing)
    modifier = thing.modifiers.new("Surface", "VOLUME_TO_MESH")
    modifier.object = volume_object
    modifier.grid_name = "surface"
    modifier.threshold = 0.0
    modifier.resolution_mode = "GRID"
    return thing


class TetvdbPreferences(bpy.types.AddonPreferences):
    bl_idname = __name__

    program: StringProperty(
        name="Program", subtype="FILE_PATH",
        description="The program tetvdb; empty: the one in PATH")

    def draw(self, context):
        self.layout.prop(self, "program")
        try:
            path = find_program(self.program)
            self.layout.label(text=path, icon="CHECKMARK")
        except TetvdbError as error:
            self.layout.label(text=str(error), icon="ERROR")


class IMPORT_SCENE_OT_tetvdb(bpy.types.Operator, ImportHelper):
    """Turns tetrahedra, triangles or a simulation into a volume, and loads it"""

    bl_idname = "import_scene.tetvdb"
    bl_label = "Import Mesh as Volume"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default="*", options={"HIDDEN", "SKIP_SAVE"})
    files: CollectionProperty(type=bpy.types.OperatorFileListElement,
                              options={"HIDDEN", "SKIP_SAVE"})
    directory: StringProperty(subtype="DIR_PATH", options={"HIDDEN", "SKIP_SAVE"})

    size_by: EnumProperty(name="Voxels", default="RESOLUTION", items=(
        ("RESOLUTION", "Along the Longest Side", "How many voxels the model is long"),
        ("VOXEL_SIZE", "Size", "How large a voxel is, in the mesh's units")))
    resolution: IntProperty(
        name="Resolution", default=256, min=1, soft_max=2048,
        description="Voxels along the longest side; memory and time grow with its square")
    voxel_size: FloatProperty(
        name="Voxel Size", default=0.01, min=2e-5, precision=5,
        description="A voxel's side, in the mesh's units")
    arrays: StringProperty(
        name="Arrays", description="Arrays of the mesh that become grids, with commas between "
        "their names, such as temperature,vel; 'all' takes all")
    remap: BoolProperty(
        name="Values to 0..1",
        description="Map each array's range, that of all frames, to 0..1. Colors need it not: "
        "the material spreads them over the range")
    sequence: BoolProperty(
        name="Sequence", default=True,
        description="Selected files whose names differ only in their last number, and the steps of "
        "a file that holds several, are frames (those of a .pvd always are). Other files, and all if "
        "this is off, are laid together; of steps the last is taken")
    warp: StringProperty(
        name="Deform By", description="An array by which points move, and a factor: disp*10")
    surface: BoolProperty(
        name="Surface", description="Add a mesh that follows the surface (Volume to Mesh)")
    scale: FloatProperty(
        name="Scale", default=1.0, min=1e-6, precision=4,
        description="Of the object: 0.001 if the mesh is in millimetres")
    centered: BoolProperty(
        name="Lie on Meshes", default=True,
        description="Move the object by half a voxel down, by which Blender draws volumes too "
        "high: the volume then lies where its mesh does")
    shading: EnumProperty(name="Material", default="RAMP", items=(
        ("RAMP", "Color Ramp", "The first array in colors"),
        ("BLACKBODY", "Blackbody", "The first array as a temperature in kelvin"),
        ("DENSITY", "Density", "No array: smoke"),
        ("NONE", "None", "No material")))
    color_by: StringProperty(
        name="Color By", description="The array that is shown in color; empty: the first")
    output: StringProperty(
        name="Write To", subtype="FILE_PATH",
        description="The .vdb file; frames are numbered. Empty: beside the mesh")
    more: StringProperty(
        name="More Options", description="For tetvdb voxelize, such as --region bone --half")

    def draw(self, context):
        layout = self.layout
        layout.use_property_split = True
        layout.prop(self, "size_by")
        layout.prop(self, "resolution" if self.size_by == "RESOLUTION" else "voxel_size")
        layout.prop(self, "sequence")
        box = layout.box()
        box.prop(self, "arrays")
        box.prop(self, "remap")
        box.prop(self, "warp")
        box.prop(self, "shading")
        if self.shading in ("RAMP", "BLACKBODY"):
            box.prop(self, "color_by")
        layout.prop(self, "surface")
        layout.prop(self, "scale")
        layout.prop(self, "centered")
        layout.prop(self, "output")
        layout.prop(self, "more")

    def invoke(self, context, event):
        try:
            program = find_program(preferred_program(context))
            self.filter_glob = ";".join("*" + ending for ending in mesh_endings(program))
        except TetvdbError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        return super().invoke(context, event)

    def paths(self):
        names = [each.name for each in self.files if each.name]
        if names:
            return [os.path.join(self.directory, name) for name in sorted(names)]
        return [self.filepath]

    def execute(self, context):
        try:
            paths = [bpy.path.abspath(path) for path in self.paths()]
            for path in paths:
                if not os.path.isfile(path):
                    raise TetvdbError(f"there is no file '{path}'")
            stem = os.path.splitext(paths[0])[0]
            output = bpy.path.abspath(self.output) if self.output else stem + ".vdb"
            if os.path.splitext(output)[1].lower() != ".vdb":
                raise TetvdbError(f"'{output}': Blender opens .vdb files; name the output .vdb")
            self.stem = os.path.basename(stem)
            program = find_program(preferred_program(context))
            self.job = Job(program, lambda folder: voxelize_arguments(paths, output, self, folder,
                                                                      program))
            if not bpy.app.background:
                return self.start_waiting(context)
            return self.load(context)
        except TetvdbError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    # While tetvdb works, Blender goes on.
    def start_waiting(self, context):
        self.timer = context.window_manager.event_timer_add(0.1, window=context.window)
        context.window_manager.progress_begin(0, 100)
        context.window_manager.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context, event):
        if event.type == "ESC":
            self.job.cancel()
            return {"RUNNING_MODAL"}
        if event.type != "TIMER":
            return {"PASS_THROUGH"}
        if self.job.running():
            percent = round(100 * self.job.fraction)
            context.window_manager.progress_update(percent)
            context.workspace.status_text_set(f"TetVDB: {self.job.stage} {percent} %   Esc: stop")
            return {"RUNNING_MODAL"}
        context.window_manager.event_timer_remove(self.timer)
        context.window_manager.progress_end()
        context.workspace.status_text_set(None)
        try:
            return self.load(context)
        except TetvdbError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}

    def load(self, context):
        report = self.job.finish()
        for warning in report.get("warnings", []):
            self.report({"WARNING"}, warning["text"])
        frames = grids_of_frames(report, self.job.command[0])
        ranges = ranges_of(frames)
        grid = self.color_grid(ranges)
        thing, is_new = load_volume(self.stem, report)
        if self.shading != "NONE":
            thing.data.materials.append(make_material(
                self.stem, grid, ranges, longest_side(frames) * self.scale,
                self.shading))
        if is_new:
            thing.scale = (self.scale,) * 3
        if is_new and self.centered:
            thing.location = [-self.scale * side / 2 for side in frames[0][0]["voxel_size"]]
        if self.surface:
            add_surface(self.stem + " surface", thing)
        count = len(report.get("frames", []))
        context.scene.frame_end = max(context.scene.frame_end, count)
        for each in context.selected_objects:
            each.select_set(False)
        thing.select_set(True)
        context.view_layer.objects.active = thing
        self.report({"INFO"}, f"{self.stem}: " + ", ".join(ranges)
                    + (f", {count} frames" if count else ""))
        return {"FINISHED"}

    def color_grid(self, ranges):
        if self.color_by:
            if self.color_by not in ranges:
                raise TetvdbError(f"there is no grid '{self.color_by}' to color by, but "
                                  + ", ".join(ranges))
            return self.color_by
        no_arrays = {row["name"] for row in rows_of(self.job.command[0], "grids")}
        return next((name for name in ranges if name not in no_arrays), "")


class IMPORT_SCENE_OT_tetvdb_tiles(bpy.types.Operator, ImportHelper):
    """Loads a volume that lies in a folder as tiles, as one collection"""

    bl_idname = "import_scene.tetvdb_tiles"
    bl_label = "Import Volume Tiles"
    bl_options = {"REGISTER", "UNDO"}

    filter_glob: StringProperty(default="tiles.json", options={"HIDDEN", "SKIP_SAVE"})
    scale: FloatProperty(
        name="Scale", default=1.0, min=1e-6, precision=4,
        description="Of the objects: 0.001 if the volume is in millimetres")
    centered: BoolProperty(
        name="Lie on Meshes", default=True,
        description="Move the objects by half a voxel down, by which Blender draws volumes too "
        "high: the volume then lies where its mesh does")
    color_by: StringProperty(
        name="Color By", description="The grid that is shown in color; empty: none")

    def execute(self, context):
        try:
            collection, things = load_tiles(bpy.path.abspath(self.filepath), self.scale,
                                            self.centered, self.color_by)
        except TetvdbError as error:
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        for each in context.selected_objects:
            each.select_set(False)
        for each in things:
            each.select_set(True)
        if things:
            context.view_layer.objects.active = things[0]
        self.report({"INFO"}, f"{collection.name}: {len(things)} tiles")
        return {"FINISHED"}


def menu_entry(self, context):
    self.layout.operator(IMPORT_SCENE_OT_tetvdb.bl_idname, text="Mesh as Volume (TetVDB)")
    self.layout.operator(IMPORT_SCENE_OT_tetvdb_tiles.bl_idname, text="Volume Tiles (TetVDB)")


CLASSES = (TetvdbPreferences, IMPORT_SCENE_OT_tetvdb, IMPORT_SCENE_OT_tetvdb_tiles)


def register():
    for each in CLASSES:
        bpy.utils.register_class(each)
    bpy.types.TOPBAR_MT_file_import.append(menu_entry)


def unregister():
    bpy.types.TOPBAR_MT_file_import.remove(menu_entry)
    for each in reversed(CLASSES):
        bpy.utils.unregister_class(each)
