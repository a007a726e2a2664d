#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Runs TetVDB and other programs on triangle files from practice: writes docs/robustness.md.

    scripts/robustness.py --build build/release CORPUS/tri --page report.html > docs/robustness.md

Defects, voxels, seconds and memory are those of `tetvdb report`, whose page with a picture of every file
is left at --page. The page's last section, Repair, is scripts/repair_study.py's, and has to be put back.
Needs python3-openvdb and python3-numpy; PrusaSlicer's column stays empty where it is not installed.
The truth is tests/corpus/winding_judge, which sums solid angles face by face and shares no code with
the library. Files are taken one after another; times depend on what else the machine does.
"""
import argparse
import json
import os
import pathlib
import re
import resource
import shutil
import subprocess
import sys
import tempfile

import numpy
import pyopenvdb

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAIRS = 5e9  # faces times points: above, the voxels are sampled
COARSE, FINE = 64, 256
TIME = 300  # seconds that a file may take
MOVE = numpy.array([2.0 ** -24, 2.0 ** -34, 2.0 ** -44])  # of centres, in place of (e, e^2, e^3)


class Ours:
    def __init__(self, program, folder):
        self.program, self.folder = program, folder

    def report(self, *arguments):
        done = subprocess.run([self.program, *map(str, arguments), "--json", "-", "-q"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True)
        return json.loads(done.stdout) if done.stdout else {"error": done.stderr.strip(),
                                                            "status": done.returncode}


def defects_of(row):
    """Short words for what `tetvdb report` counted."""
    names = (("open edges", "open"), ("non-manifold edges", "non-manifold"), ("misoriented edges", "misoriented"),
             ("degenerate faces", "degenerate"), ("duplicate faces", "duplicate"), ("crossings", "crossings"))
    words = [f"{row['defects'][key]} {word}" for key, word in names if row["defects"].get(key)]
    return ", ".join(words) or ("none" if row["kind"] else "")


class Truth:
    """Winding numbers above 0.5 of the cleaned mesh in a box of voxels, centres perturbed as docs/
    algorithms.md has it."""

    def __init__(self, judge, cleaned, space, margin, folder):
        lattice = space.on_lattice(cleaned)
        cells = int(numpy.prod(space.shape))
        self.every = max(1, -(-cells * len(cleaned.triangles) // int(PAIRS)))
        self.at = numpy.arange(0, cells, self.every)
        centres = numpy.stack(numpy.unravel_index(self.at, tuple(space.shape)), axis=1)
        winding = judge.judge("winding", lattice, centres + MOVE, folder)
        decided = numpy.abs(winding - 0.5) > margin
        self.at, self.inside = self.at[decided], winding[decided] > 0.5

    def settle(self, values, soup, lattice, judge, folder):
        """At centres on faces, where `values` differ: exact sides instead of moved centres; centres on
        boundary edges, where the winding number is not continuous, are left out."""
        differ = (values.reshape(-1)[self.at] != self.inside).nonzero()[0]
        centres = numpy.stack(numpy.unravel_index(self.at[differ], values.shape), axis=1).astype(float)
        if len(differ) == 0:
            return
        touching = judge.judge("distance", soup, centres, folder) < judge.TOUCHING
        boundary = soup.boundary()
        on_boundary = numpy.zeros(len(differ), dtype=bool)
        if len(boundary.triangles):
            on_boundary = judge.judge("distance", boundary, centres, folder) < judge.TOUCHING
        for i in (touching & ~on_boundary).nonzero()[0]:
            self.inside[differ[i]] ^= judge.jump(lattice, centres[i], centres[i] + MOVE, folder) != 0
        kept = numpy.ones(len(self.at), dtype=bool)
        kept[differ[on_boundary]] = False
        self.at, self.inside = self.at[kept], self.inside[kept]

    def overlap(self, values):
        """Intersection over union with a dense box; None where both are empty."""
        other = values.reshape(-1)[self.at]
        union = int((self.inside | other).sum())
        return int((self.inside & other).sum()) / union if union else None


def mesh_to_volume(raw, grid, space):
    """What OpenVDB's meshToVolume calls inside: None where it fails."""
    points = raw.points.astype(numpy.float32)
    try:
        level_set = pyopenvdb.FloatGrid.createLevelSetFromPolygons(
            points, triangles=raw.triangles.astype(numpy.uint32), transform=grid.transform, halfWidth=3)
    except Exception:
        return None
    values = numpy.full(tuple(space.shape), 1, dtype=numpy.float32)
    level_set.copyToArray(values, ijk=tuple(int(b) for b in space.base))
    return values < 0


def prusa(path):
    """`prusa-slicer --info`: manifold, open edges, volume."""
    if shutil.which("prusa-slicer") is None or path.suffix.lower() not in (".stl", ".obj", ".3mf"):
        return ""
    try:
        done = subprocess.run(["prusa-slicer", "--info", str(path)], stdout=subprocess.PIPE,
                              stderr=subprocess.STDOUT, text=True, timeout=120)
    except subprocess.TimeoutExpired:
        return "no answer in 120 s"
    found = dict(re.findall(r"^(\w+) = +(\S+)", done.stdout, re.M))
    if "manifold" not in found:
        return "fails" if done.returncode == 0 else f"fails ({done.returncode})"
    return ("manifold" if found["manifold"] == "yes" else f"{found.get('open_edges', '?')} open") + \
        ", volume {:.4g}".format(float(found.get("volume", "nan")))


class Row:
    def __init__(self, found):
        """`found`: the file's row of `tetvdb report`."""
        self.name, self.found = found["name"], found
        self.defects = defects_of(found)
        self.voxels, self.megabytes = found["voxels"], found["megabytes"]
        self.seconds = sum(found.get("stages", {}).values()) - found.get("picture_seconds", 0)
        self.answer = self.prusa = ""
        self.ours = self.openvdb = None
        self.sampled = 1
        self.openvdb_failed = False
        self.answered = True


def examine(path, row, ours, judge):
    folder = ours.folder
    coarse, off = os.path.join(folder, "coarse.vdb"), os.path.join(folder, "cleaned.off")
    for old in (coarse, off):
        if os.path.exists(old):
            os.remove(old)
    row.prusa = prusa(path)
    report = ours.report("voxelize", str(path), "-o", coarse, "--grid", "mask", "--resolution", str(COARSE),
                         "--write-mesh", off)
    if report["status"] not in (0, 1):
        sentence = re.sub(rf"^tetvdb: |{re.escape(str(path))}(:\d+)?: ", "", report["error"])
        row.answer = sentence.split(";")[0]
        row.answered = report["status"] == 3 and "\n" not in report["error"]
        if row.found["status"] in (0, 1):
            row.answer += f" at {COARSE}^3"
        return
    closed = report["mesh"]["closed"]
    row.answer = ("crossings" if closed else "winding number") + \
        (" ~" if judge.undecided_within(report) == judge.ROUGH else "") + (", in part" if report["status"] == 1 else "")
    raw, _ = judge.read_raw(str(path))
    cleaned = judge.read_off(off)
    grid = pyopenvdb.readAll(coarse)[0][0]
    space = judge.Space(cleaned, numpy.array(grid.transform.voxelSize()),
                        numpy.array(grid.transform.indexToWorld((0, 0, 0))))
    space.cover(*grid.evalActiveVoxelBoundingBox())
    values = judge.dense(grid, space)
    truth = Truth(judge, cleaned, space, judge.undecided_within(report), folder)
    truth.settle(values, space.of(cleaned), space.on_lattice(cleaned), judge, folder)
    row.sampled = truth.every
    row.ours = truth.overlap(values)
    other = mesh_to_volume(raw, grid, space)
    if other is None or not other.any():
        row.openvdb_failed = True
    else:
        row.openvdb = truth.overlap(other)


def share(value):
    return "" if value is None else "1" if value == 1 else f"{value:.4f}" if value > 0.9999 else f"{value:.3f}"


def mean(values):
    values = list(values)
    return sum(values) / len(values) if values else 0


def summary(rows, version, total, pictures):
    judged = [r for r in rows if r.ours is not None]
    slowest = max(rows, key=lambda r: r.seconds)
    largest = max(rows, key=lambda r: r.megabytes)
    refused = [r for r in rows if r.ours is None]
    exact = sum(r.ours == 1 for r in judged)
    lowest = min(judged, key=lambda r: r.ours)
    worst = "" if lowest.ours == 1 else f", lowest {lowest.ours:.5f} ({lowest.name})"
    theirs = [r.openvdb or 0 for r in judged]
    closed = [r for r in judged if r.answer.startswith("crossings")]
    opened = [r for r in judged if not r.answer.startswith("crossings")]
    asked = [r for r in rows if r.prusa]
    return f"""# Robustness

{len(rows)} triangle files from practice: prints, scans, CAD exports, game models, regression
cases of other libraries. `scripts/robustness.py` generates this page from `tetvdb report` and the results of other programs; TetVDB {version}.
All results use default options, that is, the winding number; [meshing.md](meshing.md) has the results of `tetrahedralize` for such files.

- **Completed: {sum(r.answered for r in rows)} of {len(rows)}.** {len(judged)} became a solid; {len(refused)} were refused with a one-line message,
  since they cannot be read or have no inside at {COARSE} voxels (sheets, for which the message suggests `--shell`).
- **Worst time** at {FINE}^3: {slowest.seconds:.1f} s ({slowest.name}); median {numpy.median([r.seconds for r in rows]):.2f} s.
  **Worst memory**: {largest.megabytes:.0f} MB ({largest.name}).
- **Agreement** with brute force at {COARSE}^3, as intersection over union: TetVDB {mean(r.ours for r in judged):.6f} on average,
  {exact} of {len(judged)} files exact{worst}. OpenVDB's meshToVolume: {mean(theirs):.3f} on average
  ({mean(r.openvdb or 0 for r in closed):.3f} for the {len(closed)} closed files, {mean(r.openvdb or 0 for r in opened):.3f} for the {len(opened)} open ones); {sum(r.openvdb_failed for r in judged)} without an inside.
- **PrusaSlicer** reads {sum('volume' in r.prusa for r in asked)} of the {len(asked)} files in its formats and reports {sum(r.prusa.startswith('manifold') for r in asked)} as manifold.

## Method

- *Reference*: a voxel is inside if the winding number of the cleaned mesh is above 0.5 at its centre (perturbed
  by e, e^2, e^3 if it lies on a face), summed face by face in double precision over all voxels of the mesh's box enlarged
  by 4, by a program that shares no code with the library. If faces times voxels exceed 5 x 10^9,
  evenly spaced voxels are used (marked `*`). Winding numbers
  within 1e-4 of 0.5 are excluded (within 0.02 if the program warns that it used approximate values, `~`), and centres on the
  edge of an open mesh, where the winding number jumps. Whether *cleaning* is correct
  is not measured here but on models of known solids, in [cleaning.md](cleaning.md): meshToVolume receives the file's own faces, and some of its differences are a matter of interpretation.
- *meshToVolume*: `FloatGrid.createLevelSetFromPolygons` of OpenVDB's Python module, half-width 3; voxels with
  values below 0 are inside. It is intended for closed surfaces. "none": it found no inside.
- *PrusaSlicer*: `prusa-slicer --info`: manifold or the number of open edges, and volume, for the formats it reads.
- *Seconds, MB, defects* and voxels from `tetvdb report CORPUS --resolution {FINE}`, each file in a separate
  process: the stages read, clean, voxelize and write (without pictures, which took {pictures:.0f} s of {total:.0f} s
  in total), and peak resident memory including pictures. Defects: open, non-manifold and misoriented edges, degenerate and
  duplicate faces, pairs of intersecting faces.

## Files
"""


def markdown(rows):
    lines = ["| file | defects | answer | voxels, 256^3 | s | MB | IoU | meshToVolume | PrusaSlicer |",
             "|---|---|---|--:|--:|--:|--:|--:|---|"]
    for r in rows:
        theirs = "none" if r.openvdb_failed else share(r.openvdb)
        lines.append(f"| {r.name} | {r.defects} | {r.answer} | {'' if r.voxels is None else r.voxels} | {r.seconds:.2f} | "
                     f"{r.megabytes:.0f} | {share(r.ours)}{'*' if r.sampled > 1 else ''} | {theirs} | {r.prusa} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="with the triangle files")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--page", type=pathlib.Path, help="keep the report's page, .html")
    arguments = parser.parse_args()
    program = str(arguments.build / "bin/tetvdb")
    os.environ["TETVDB_PROGRAM"] = program
    os.environ["TETVDB_JUDGE"] = str(arguments.build / "bin/winding_judge")
    os.environ["TETVDB_JUDGE_THREADS"] = str(os.cpu_count())
    sys.path.insert(0, str(ROOT / "tests/corpus"))
    sys.dont_write_bytecode = True
    import judge_triangles as judge

    with tempfile.TemporaryDirectory(prefix="tetvdb-robustness-") as folder:
        ours = Ours(program, folder)
        page = arguments.page or os.path.join(folder, "report.html")
        report = ours.report("report", arguments.folder, "-o", page, "--resolution", FINE, "--max-time", TIME)
        if "models" not in report:
            raise SystemExit(report["error"])
        rows = [Row(found) for found in sorted(report["models"], key=lambda model: model["name"].lower())]
        for done, row in enumerate(rows, 1):
            examine(arguments.folder / row.name, row, ours, judge)
            print(f"{done}/{len(rows)} {row.name}", file=sys.stderr, flush=True)
    version = subprocess.run([program, "--version"], stdout=subprocess.PIPE, text=True).stdout.split()[-1]
    print(summary(rows, version, report["seconds"], report["picture_seconds"]))
    print(markdown(rows))


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # what crashes here need not leave its memory
    main()
