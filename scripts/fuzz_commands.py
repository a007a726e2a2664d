#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The command line under random options and files.

Each run is a command of `tetvdb` with options of its own list (as `tetvdb completions fish` has
it), values that are right, extreme or senseless, and files of tests/data, of a few kinds made here,
or mutants of either. Wrong is: a signal, more than a minute of processor time, a status that is not in the table, a
temporary or an output file after a failure, an input that was changed, a report that is no JSON or
has another status, a failure without a message, messages with control characters.

    scripts/fuzz_commands.py --seconds 600 --seed 1      prints what is wrong, as commands to repeat
    scripts/fuzz_commands.py --runs 40 --seed 7
"""

import argparse
import hashlib
import json
import os
import pathlib
import random
import re
import resource
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
LONGEST = 60  # processor seconds of a run, and a fifteenth of the seconds by the clock
MEMORY = 4 << 30
SANITIZED = os.environ.get("TETVDB_SANITIZED", "") not in ("", "0") # the program's build
STATUSES = range(9)
FAILED = (2, 3, 4, 5, 6, 7)
INPUT_BYTES = 200_000
TEXT = ("", "x", "0", "-1", "1", "2", "3.5", "1e-30", "1e9", "1e30", "1e308", "1e400", "nan", "inf",
        "-inf", "0x10", "1,2,3", "1,2", "0,0,0", "-1,-1,-1,1,1,1", ",", "a,b", "1:2", "2:1", "a:b", "=",
        "x=1", "..", "/", "-", "--", "\x01\x7f", "ä", "9" * 40, "%d%s%n", "*", "density", "None", "auto",
        "4294967296", "99999999999999999999", "1/2", "3/2", "0/0", "1d", "1v", "1e-2d", "1G", "0M")
# Values that do something, by option; others take theirs from the words of their help.
VALUES = {
    "--grid": ("density", "surface", "mask", "coverage", "tet_id", "material", "fog", "density,mask",
               "surface,density,coverage", "temperature", "normal"),
    "--resolution": ("1", "2", "7", "16", "40", "64"), "--fit": ("1", "8", "16", "33"),
    "--padding": ("0", "1", "2"), "--voxel-size": ("0.1", "0.3", "1", "0.2,0.3,0.1"),
    "--threads": ("1", "2", "5"), "--max-memory": ("1M", "50M", "500M", "2G"),
    "--max-time": ("0.01", "1", "10"), "--epsilon": ("1e-2d", "1e-3d", "0.5v", "0.05"),
    "--shell": ("0.1", "0.4", "2"), "--half-width": ("1", "3", "5", "all"),
    "--size": ("32x32", "1x1", "64x48"), "--pixels": ("40,30", "7,5"), "--display": ("8,6", "16,12"),
    "--layer-height": ("0.5", "0.1"), "--workers": ("1", "2"), "--points": ("0", "10", "1000"),
    "--near-points": ("0", "10"), "--variants": ("0", "1"), "--faces": ("4", "20", "100"),
    "--turntable": ("1", "2"), "--tiles": ("tiles",), "--lod": ("1:2", "1:3"), "--shard": ("0/2", "1/2"),
    "--cut": ("x=0", "y=0.5", "z=1"), "--derive": ("a=b:mises",), "--hollow": ("0.1", "0.4"),
    "--json": ("report.json", "-", "report.json"), "--preview": ("preview.png",),
    "--write-mesh": ("mesh.stl", "mesh.msh", "mesh.vtu"), "--samples": ("10", "1000"),
    "--edge-length": ("0.3", "1"), "--content": ("occupancy", "points,samples", "distance", "surface"),
    "--formats": ("npz",), "--target": ("blender", "houdini", "sla", "lpbf", "fdm"), "--archives": ("1", "2"),
}
VALUES.update({
    "--style": ("auto", "surface", "voxels", "fog"), "--units": ("mm", "in"), "--up-axis": ("y", "z"),
    "--up": ("y", "z"), "--shards": ("1", "3"), "--format": ("npz", "npy", "vdb", "hdf5", "zarr", "binvox"),
    "--normalize": ("longest", "diagonal", "none"), "--range": ("0:1", "-1:5"), "--box": ("0,0,0,5,5,5",),
    "--simplify": ("0.1", "1"), "--tolerance": ("0", "0.1"), "--inside": ("winding", "nonzero", "parity", "flood"),
    "--orientation": ("landscape", "portrait"), "--rule": ("any", "all", "centre"), "--mesher": (
        "auto", "winding", "envelope"), "--aa": ("area", "volume", "none"), "--shell-side": ("outward", "inward"),
    "--turn": ("vertical", "any"), "--boolean": ("union", "difference", "intersection"), "--mask-type": (
        "bool", "mask"), "--exposure": ("2", "8"), "--origin": ("0,0,0", "1,2,3"), "--region": ("1", "2"),
    "--bbox": ("0,0,0,1,1,1", "-9,-9,-9,9,9,9"), "--seed": ("1",), "--scale": ("1", "2.5"), "--view": (
        "iso", "front", "1,1,1"), "--color": ("temperature", "depth"), "--device": ("auto", "cpu", "cuda"),
    "--printer": ("printer.ini",), "--frames": ("all", "1:2"), "--mirror": ("x", "xy", "none"), "--infill": (
        "gyroid:1", "0.5"), "--drain": ("0,0,0:0.2", "auto"), "--levels": ("2", "16"), "--gamma": ("1", "2.2"),
})
# Files that a command can work on, by ending; now and then it gets others.
TRIANGLES = (".stl", ".vtp", ".vtk", ".vtm")
CELLS = (".msh", ".mesh", ".vtu", ".vtk", ".vtkhdf", ".inp", ".node", ".xdmf", ".case")
VOLUMES = (".vdb", ".nvdb")
TAKES = {"tetrahedralize": TRIANGLES, "repair": TRIANGLES + VOLUMES, "prepare": TRIANGLES + VOLUMES,
         "slice": TRIANGLES + CELLS, "merge": ("2.vdb",), "plan": TRIANGLES + CELLS,
         "voxelize": TRIANGLES + CELLS + TRIANGLES, "check": VOLUMES, "dataset": (".csv",)}
SINGLE = ("repair", "prepare", "convert", "dataset")
RARE = ("formats", "grids", "completions", "manual")
# What keeps the extremes from taking long where that is right: their number is that of the work.
MODEST = {"--resolution", "--fit", "--voxel-size", "--size", "--pixels", "--points", "--near-points",
          "--samples", "--sharp-points", "--variants", "--turntable", "--threads", "--workers", "--lod",
          "--layer-height", "--half-width", "--edge-length", "--epsilon", "--stop-energy", "--faces",
          "--hollow", "--shell", "--archives", "--cell", "--max-points"}
OUTPUTS = {
    "voxelize": ("vdb", "vdb", "nvdb", "npy", "npz", "vti", "nrrd", "h5", "tif", "raw", "binvox"),
    "tetrahedralize": ("msh", "vtu", "mesh", "stl"), "repair": ("stl", "obj", "ply", "off", "3mf", "vdb"),
    "convert": ("vdb", "nvdb", "npz", "obj", "stl", "vtu", "msh", "vti", "nrrd"),
    "prepare": ("stl", "obj", "vdb", "3mf"), "slice": ("sl1", "zip", "nanodlp", "goo", "cli", "svg", "3mf", "tif"),
    "dataset": ("",), "render": ("png",), "report": ("html", "htm"), "merge": ("vdb",),
    "compare": ("png",),
}


def box_stl(low, high):
    corners = [[(low, high)[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]
    squares = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    faces = [(q[0], q[k], q[k + 1]) for q in squares for k in (1, 2)]
    data = bytes(80) + struct.pack("<I", len(faces))
    for face in faces:
        data += struct.pack("<12fH", 0, 0, 0, *(c for i in face for c in corners[i]), 0)
    return data


class Inputs:
    """Files by name."""

    def __init__(self, program, folder):
        self.files = {}
        for path in sorted((ROOT / "tests/data").rglob("*")):
            if path.is_file() and path.stat().st_size < INPUT_BYTES and path.suffix not in (".py", ".md"):
                self.files[path.name] = path.read_bytes()
        self.files["box.stl"] = box_stl((0, 0, 0), (1, 2, 3))
        self.files["open.stl"] = box_stl((0, 0, 0), (1, 1, 1))[:80] + struct.pack("<I", 10) + box_stl(
            (0, 0, 0), (1, 1, 1))[84:84 + 500]
        (folder / "box.stl").write_bytes(self.files["box.stl"])
        for name, options in (("fog.vdb", ()), ("level.vdb", ("--grid", "surface")), ("fog.nvdb", ()),
                              ("part.0-of-2.vdb", ("--shard", "0/2", "--grid", "mask"))):
            out = name.replace(".0-of-2", "")
            subprocess.run([program, "voxelize", "box.stl", "-o", out, "--resolution", "20", "-q",
                            *options], cwd=folder, check=True)
            self.files[name] = (folder / name).read_bytes()
        self.files["model.csv"] = b"path,class\nbox.stl,a\nopen.stl,b\nnone.stl,c\n"
        self.files["printer.ini"] = b"display_pixels_x = 40\ndisplay_pixels_y = 30\ndisplay_width = 8\n" \
                                    b"display_height = 6\nlayer_height = 0.5\n"

    def choose(self, command, rng):
        """A name and what is in the file."""
        names = sorted(self.files)
        if rng.random() < 0.9:
            endings = TAKES.get(command, TRIANGLES + CELLS + VOLUMES)
            names = [name for name in names if name.endswith(endings)]
        name = rng.choice(names)
        content = self.files[name]
        if rng.random() < 0.3:
            content = mutant(content, rng)
        return name, content


def mutant(content, rng):
    data = bytearray(content)
    for _ in range(rng.choice((1, 1, 2, 8))):
        if not data:
            break
        at, kind = rng.randrange(len(data)), rng.randrange(6)
        if kind == 0:
            data[at] = rng.randrange(256)
        elif kind == 1:
            del data[at:at + rng.choice((1, 4, 40, len(data)))]
        elif kind == 2:
            data[at:at] = data[at:at + rng.choice((1, 12, 50))]
        elif kind == 3:
            data[at:at + 4] = struct.pack("<I", rng.choice((0, 1, 2**31, 2**32 - 1, 0x7f800000)))
        elif kind == 4:
            data[at:at] = rng.choice((b"nan", b"1e39", b"-1", b"999999999", b"\0", b"\n"))
        else:
            other = rng.randrange(len(data))
            data[at:at + 8] = data[other:other + 8]
    return bytes(data)


def options_of(program):
    """Of each command: names of options, and whether they take a value."""
    text = subprocess.run([program, "completions", "fish"], capture_output=True, text=True,
                          check=True).stdout
    commands = {}
    for line in text.splitlines():
        if found := re.search(r"__fish_use_subcommand -f -a (\S+)", line):
            commands[found[1]] = []
        elif found := re.search(r"__fish_seen_subcommand_from (\S+)'((?: -[ls] \S+)+)( -r)?", line):
            names = re.findall(r"-([ls]) (\S+)", found[2])
            commands[found[1]].append((["--" + n if kind == "l" else "-" + n for kind, n in names],
                                       found[3] is not None))
    return commands


def set_limits():
    if not SANITIZED: # whose shadow memory counts
        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
    resource.setrlimit(resource.RLIMIT_CPU, (LONGEST, LONGEST))


class Fuzzer:
    def __init__(self, program, seed):
        self.program, self.seed = program, seed
        self.commands = options_of(program)
        self.home = pathlib.Path(tempfile.mkdtemp(prefix="tetvdb-fuzz-"))
        made = self.home / "made"
        made.mkdir()
        self.inputs = Inputs(program, made)
        self.statuses = {}

    def value(self, name, rng):
        known = VALUES.get(name)
        if rng.random() < 0.9:
            return rng.choice(known or ("0", "1", "2", "0.5", "10"))
        if name in MODEST:
            return rng.choice([t for t in TEXT if not re.match(r"[\d.e]+$", t) or t in ("0", "1e308")])
        return rng.choice(TEXT)

    def words(self, command, folder, rng):
        """A command's words; the files that they name are made."""
        words = [command]
        count = rng.choice((1, 1, 1, 2, 3)) if command not in SINGLE or rng.random() < 0.02 else 1
        if command == "compare" and rng.random() < 0.95:
            count = 2
        for _ in range(count if command not in ("formats", "grids") else 0):
            name, content = self.inputs.choose(command, rng)
            (folder / name).write_bytes(content)
            words.append(name)
        if command in ("completions", "manual"):
            words = [command, rng.choice(("bash", "zsh", "fish", "pages", ""))]
        if command in ("dataset", "report") and rng.random() < 0.5:
            words[1:] = ["."]
        if command in OUTPUTS and (command != "compare" or rng.random() < 0.2):
            ending = rng.choice(OUTPUTS[command])
            words += ["-o", ("out." + ending) if ending else "out"]
        if command == "slice" and rng.random() < 0.8:
            (folder / "printer.ini").write_bytes(self.inputs.files["printer.ini"])
            words += ["--printer", "printer.ini"]
        chosen = rng.sample(self.commands[command], min(len(self.commands[command]), rng.choice(
            (0, 1, 1, 2, 2, 3, 5))))
        for names, takes in chosen:
            if "--output" in names or "--help" in names:
                continue
            words.append(rng.choice(names))
            if takes:
                words.append(self.value(names[-1], rng))
        have = {name for names, _ in self.commands[command] for name in names}
        if "--max-time" in have and "--max-time" not in words and command != "check":
            words += ["--max-time", "10"]
        for name, value in (("--resolution", "24"), ("--workers", "1")):
            others = ("--voxel-size", "--fit", "--dry-run", name)
            if name in have and not any(o in words for o in others) and command != "repair":
                words += [name, value]
        if "--shards" in have and "--shards" not in words:
            words += ["--shards", "2"]
        if rng.random() < 0.03:
            words.insert(rng.randrange(len(words)), rng.choice(TEXT))
        return [word.replace("\0", "") for word in words]

    def run(self, number):
        """What is wrong with the run of that number, as a sentence; empty: nothing."""
        rng = random.Random(f"{self.seed} {number}")
        folder = self.home / "run"
        shutil.rmtree(folder, ignore_errors=True)
        (folder / "tmp").mkdir(parents=True)
        command = rng.choice(sorted(self.commands))
        if command in RARE:
            command = rng.choice(sorted(self.commands))
        words = self.words(command, folder, rng)
        before = self.state(folder)
        began = time.monotonic()
        try:
            done = subprocess.run(
                [self.program, *words], cwd=folder, stdin=subprocess.DEVNULL, capture_output=True,
                timeout=15 * LONGEST, env={**os.environ, "TMPDIR": str(folder / "tmp")},
                preexec_fn=set_limits)
        except subprocess.TimeoutExpired:
            return words, f"takes more than {15 * LONGEST} s"
        self.took = time.monotonic() - began
        key = (words[0], done.returncode)
        self.statuses[key] = self.statuses.get(key, 0) + 1
        return words, self.judge(words, folder, before, done)

    def state(self, folder):
        return {str(path.relative_to(folder)): hashlib.sha256(path.read_bytes()).digest()
                for path in folder.rglob("*") if path.is_file()}

    def judge(self, words, folder, before, done):
        status, said = done.returncode, done.stderr.decode(errors="replace")
        if status not in STATUSES:
            return f"status {status}; {said[-300:]}"
        after = self.state(folder)
        for name, content in before.items():
            if after.get(name) != content and name in after and name not in self.written(words):
                return f"changed {name}"
            if name not in after:
                return f"removed {name}"
        new = set(after) - set(before)
        strange = [name for name in new if ".tmp" in name or name.startswith("tmp/")]
        if strange:
            return f"left {strange}"
        report = self.report_path(words)
        if status in FAILED and words[0] not in ("dataset", "manual") and new - {report}:
            return f"status {status}, but wrote {sorted(new - {report})}"
        if status in FAILED and not said.strip():
            return f"status {status} without a message"
        if any(ord(c) < 32 and c != "\n" or 0x7f <= ord(c) < 0xa0 for c in said):
            return "control characters in a message"
        if any(len(line) > 2100 for line in said.splitlines()):
            return "a message of more than 2000 characters"
        if report in new:
            try:
                told = json.loads((folder / report).read_text())
            except ValueError:
                return f"{report} is no JSON"
            if told.get("status") != status:
                return f"status {status}, {told.get('status')} in the report"
        return ""

    def report_path(self, words):
        for i, word in enumerate(words[:-1]):
            if word == "--json" and words[i + 1] != "-":
                return words[i + 1]
        return ""

    def written(self, words):
        """Files that a command may replace: those after options that name outputs."""
        return {words[i + 1] for i, word in enumerate(words[:-1])
                if word in ("-o", "--output", "--json", "--write-mesh", "--preview")}

    def close(self):
        shutil.rmtree(self.home, ignore_errors=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--program", default=os.environ.get(
        "TETVDB_PROGRAM", str(ROOT / "build/release/bin/tetvdb")))
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--seconds", type=float, default=0, help="stop after that time")
    parser.add_argument("--runs", type=int, default=0, help="stop after that many runs")
    parser.add_argument("--first", type=int, default=0, help="number of the first run")
    parser.add_argument("--keep", type=pathlib.Path, help="a folder for the files of what is wrong")
    settings = parser.parse_args()
    fuzzer = Fuzzer(str(pathlib.Path(settings.program).resolve()), settings.seed)
    began, number, wrong, slow = time.monotonic(), settings.first, 0, []
    while (not settings.runs or number < settings.first + settings.runs) and (
            not settings.seconds or time.monotonic() - began < settings.seconds):
        words, fault = fuzzer.run(number)
        if fault:
            wrong += 1
            print(f"run {number}: tetvdb {shlex.join(words)}\n  {fault}", flush=True)
            if settings.keep:
                shutil.copytree(fuzzer.home / "run", settings.keep / str(number), dirs_exist_ok=True)
        elif fuzzer.took > 15:
            slow.append((round(fuzzer.took), number, shlex.join(words)))
        number += 1
    for line in sorted(slow, reverse=True)[:20]:
        print("slow: %d s, run %d: tetvdb %s" % line)
    counts = {}
    for (_, status), n in fuzzer.statuses.items():
        counts[status] = counts.get(status, 0) + n
    print(f"{number - settings.first} runs, seed {settings.seed}: {wrong} wrong; statuses "
          f"{dict(sorted(counts.items()))}")
    fuzzer.close()
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
