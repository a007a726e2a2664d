# SPDX-License-Identifier: Apache-2.0
"""Meshes and simulations as VDBs in Houdini, by the program `tetvdb`.

    import tetvdb_houdini
    tetvdb_houdini.import_mesh("/data/run.pvd", arrays="temperature,vel", resolution=400)

or from the shelf, see docs/dcc.md. The program is that of the variable TETVDB_PROGRAM, else the one in
PATH. Written from Houdini's documentation: tested with a stand-in for `hou`, not in Houdini.
"""

import functools
import json
import os
import re
import shlex
import shutil
import subprocess
import tempfile
import threading
import time

import hou


class TetvdbError(Exception):
    """What went wrong, for the user to read."""


def find_program():
    path = os.environ.get("TETVDB_PROGRAM", "") or shutil.which("tetvdb")
    if not path or not os.access(path, os.X_OK):
        raise TetvdbError("tetvdb was not found: put it in PATH, or set TETVDB_PROGRAM to its path")
    return path


@functools.lru_cache(maxsize=None)
def stepped_endings(program):
    """The endings of files that hold several steps, as `tetvdb formats` says."""
    try:
        asked = subprocess.run([program, "formats", "--json", "-"], stdin=subprocess.DEVNULL,
                               stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                               universal_newlines=True, timeout=60)
    except (OSError, subprocess.TimeoutExpired) as error:
        raise TetvdbError(f"{program} does not start: {error}") from error
    if asked.returncode != 0:
        raise TetvdbError(asked.stderr.strip() or "tetvdb formats failed")
    return [ending for row in json.loads(asked.stdout)["formats"] if row["steps_in_one_file"]
            for ending in row["endings"]]


def pattern_of(path):
    """out.$F4.vtu as out.*.vtu, which tetvdb takes for a sequence; other paths as they are."""
    parts = re.split(r"\$\{?F\d*\}?", path)
    if len(parts) == 1:
        return path
    return "*".join(re.sub(r"([*?\[])", r"[\1]", part) for part in parts)


def voxelize_arguments(path, output, resolution=256, voxel_size=None, arrays="", surface=False,
                       y_up=True, all_steps=True, more=""):
    """The arguments of tetvdb. `path` may have $F4 in it; all steps of a file that holds several are
    frames."""
    grids = ["density"] + ["surface"] * surface
    grids += [name.strip() for name in arrays.split(",") if name.strip()]
    arguments = ["voxelize", pattern_of(path), "-o", output, "--grid", ",".join(grids)]
    if voxel_size:
        arguments += ["--voxel-size", repr(float(voxel_size))]
    else:
        arguments += ["--resolution", str(int(resolution))]
    if y_up:
        arguments += ["--up-axis", "y"]
    if all_steps and os.path.splitext(path)[1].lower() in stepped_endings(find_program()):
        arguments += ["--frames", "all"]
    return arguments + shlex.split(more)


def run(arguments):
    """Runs tetvdb with progress, until Escape; its report, or TetvdbError."""
    with tempfile.TemporaryDirectory(prefix="tetvdb-") as folder:
        report = os.path.join(folder, "report.json")
        command = [find_program(), *arguments, "-v", "--json", report]
        try:
            process = subprocess.Popen(command, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.DEVNULL, stderr=subprocess.PIPE,
                                       universal_newlines=True, errors="replace")
        except OSError as error:
            raise TetvdbError(f"{command[0]} does not start: {error.strerror}") from error
        said, step = [], [0.0]

        def read():
            # "tetvdb: STAGE" and "tetvdb: STAGE 40 %, about 30 s left" say how far it is as a whole.
            for line in process.stderr:
                found = re.fullmatch(r"tetvdb: [a-z ]+?(?: (\d+) %(?:, about \d+ \w+ left)?)?",
                                     line.rstrip())
                if found:
                    step[0] = int(found.group(1)) / 100 if found.group(1) else step[0]
                elif line.strip():
                    said.append(line.rstrip())

        reader = threading.Thread(target=read, daemon=True)
        reader.start()
        try:
            with hou.InterruptableOperation("TetVDB", open_interrupt_dialog=True) as operation:
                while process.poll() is None:
                    operation.updateProgress(step[0])
                    time.sleep(0.05)
        finally:
            # Also when Escape has raised hou.OperationInterrupted: no file is left half written.
            if process.poll() is None:
                process.terminate()
            status = process.wait()
            reader.join()
            process.stderr.close()
        if status not in (0, 1):
            errors = [line for line in said if not line.startswith("tetvdb: warning")]
            raise TetvdbError(errors[-1] if errors else f"tetvdb ended with status {status}")
        with open(report, encoding="utf-8") as file:
            return json.load(file)


def file_of(report):
    """The File node's path: run.0001.vdb of several as run.$F4.vdb."""
    path = os.path.abspath(report["output"][0]["path"]).replace(os.sep, "/")
    if "frames" not in report:
        return path
    digits = re.search(r"(\d+)\.vdb$", path).group(1)
    return path[:-len(digits) - 4] + f"$F{len(digits)}.vdb"


def set_parameter(node, name, value):
    """Where this Houdini's node has it."""
    parameter = node.parm(name)
    if parameter is not None:
        parameter.set(value)


def load(report, name, surface=False):
    """A geometry object: File node -> OUT, and beside it OUT_SURFACE, polygons of the level set."""
    geometry = hou.node("/obj").createNode("geo", re.sub(r"\W", "_", name))
    reader = geometry.createNode("file", "read_vdb")
    reader.parm("file").set(file_of(report))
    set_parameter(reader, "missingframe", "empty")
    shown = geometry.createNode("null", "OUT")
    shown.setFirstInput(reader)
    if surface:
        polygons = geometry.createNode("convertvdb", "surface")
        polygons.setFirstInput(reader)
        set_parameter(polygons, "group", "@name=surface")
        set_parameter(polygons, "conversion", "poly")
        result = geometry.createNode("null", "OUT_SURFACE")
        result.setFirstInput(polygons)
    geometry.layoutChildren()
    shown.setDisplayFlag(True)
    shown.setRenderFlag(True)
    if "frames" in report:
        hou.playbar.setFrameRange(1, len(report["frames"]))
        hou.playbar.setPlaybackRange(1, len(report["frames"]))
    return geometry


def import_mesh(path, output=None, surface=False, **options):
    """Makes VDBs of a mesh or a simulation and loads them: the object. `options` are those of
    voxelize_arguments(). Without `output` the files lie beside the mesh. Raises TetvdbError."""
    path = hou.text.expandString(path) if "$F" not in path else path
    stem = re.sub(r"[._]?\$\{?F\d*\}?", "", os.path.splitext(path)[0])
    arguments = voxelize_arguments(path, output or stem + ".vdb", surface=surface, **options)
    try:
        report = run(arguments)
    except TetvdbError as error:
        # A file of such a format may hold only a mesh, and no steps.
        if "--frames" not in arguments or "has no time steps" not in str(error):
            raise
        first = arguments.index("--frames")
        report = run(arguments[:first] + arguments[first + 2:])
    return load(report, os.path.basename(stem), surface)


def load_tiles(path):
    """A geometry object of the tiles that tiles.json lists: a File node each -> Merge -> OUT. Raises
    TetvdbError."""
    path = os.path.abspath(hou.text.expandString(path)).replace(os.sep, "/")
    folder = os.path.dirname(path)
    try:
        with open(path, encoding="utf-8") as file:
            tiles = json.load(file)
        if tiles["tiles_version"] != 1:
            raise TetvdbError(f"{path} has version {tiles['tiles_version']}, and 1 is known")
        names = [os.path.basename(tile["file"]) for tile in tiles["tiles"]]
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise TetvdbError(f"{path} is no tiles.json of tetvdb: {error}") from error
    geometry = hou.node("/obj").createNode("geo", re.sub(r"\W", "_", os.path.basename(folder)))
    merged = geometry.createNode("merge", "tiles")
    for name in names:
        reader = geometry.createNode("file", re.sub(r"\W", "_", os.path.splitext(name)[0]))
        reader.parm("file").set(folder + "/" + name)
        merged.setNextInput(reader)
    shown = geometry.createNode("null", "OUT")
    shown.setFirstInput(merged)
    geometry.layoutChildren()
    shown.setDisplayFlag(True)
    shown.setRenderFlag(True)
    return geometry


def tiles_tool():
    """Asks for a tiles.json, and says what went wrong."""
    path = hou.ui.selectFile(title="tiles.json", file_type=hou.fileType.Any)
    if not path:
        return None
    try:
        return load_tiles(path)
    except TetvdbError as error:
        hou.ui.displayMessage(str(error), title="TetVDB", severity=hou.severityType.Error)
        return None


def shelf_tool():
    """Asks for a file and for options, and says what went wrong."""
    path = hou.ui.selectFile(title="Mesh or simulation", file_type=hou.fileType.Any)
    if not path:
        return None
    labels = ("Voxels along the longest side", "or voxel size", "Arrays (a,b or all)",
              "Surface too (yes/no)", "y up (yes/no)", "More options")
    button, answers = hou.ui.readMultiInput(
        "TetVDB: mesh as VDB", labels, buttons=("Import", "Cancel"), close_choice=1,
        initial_contents=("256", "", "", "no", "yes", ""), title="TetVDB")
    if button != 0:
        return None
    resolution, size, arrays, surface, y_up, more = (answer.strip() for answer in answers)
    yes = lambda answer: answer.lower() in ("yes", "y", "1", "true")
    try:
        return import_mesh(path, surface=yes(surface), resolution=int(resolution or 256),
                           voxel_size=float(size) if size else None, arrays=arrays,
                           y_up=yes(y_up), more=more)
    except hou.OperationInterrupted:
        return None
    except (TetvdbError, ValueError) as error:
        hou.ui.displayMessage(str(error), title="TetVDB", severity=hou.severityType.Error)
        return None
