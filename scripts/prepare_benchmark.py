#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Times `tetvdb prepare --hollow` beside PrusaSlicer's hollowing of the same meshes, in one run, as in
docs/print.md. PrusaSlicer hollows only on the way to an .sl1 file: its time is the difference between
two such runs, with hollowing and without. Then what merging the cavity's triangles gives and takes.

    scripts/prepare_benchmark.py [--program build/release/bin/tetvdb] [--repeat 3] [--small]
"""

import argparse
import json
import math
import pathlib
import shutil
import sys
import tempfile

from slice_benchmark import PRINTER, bumpy_ellipsoid, measure

WALL = "2"


def bottle(path, around=96):
    """A solid bottle, 40 high, as .obj."""
    profile = [(8 + 1.5 * math.sin(math.pi * i / 16), 1.5 * (1 - math.cos(math.pi * i / 16))) for i in range(9)]
    profile += [(9.5 - 3 * (1 - math.cos(math.pi * i / 16)), 24 + i / 2) for i in range(17)]
    profile += [(3.5, 38), (3.5, 40)]
    rows = [[1 + around * i + j for j in range(around)] for i in range(len(profile))]
    bottom = around * len(profile) + 1
    faces = [(row[j], row[j - around + 1], above[j - around + 1]) for row, above in zip(rows, rows[1:])
             for j in range(around)]
    faces += [(row[j], above[j - around + 1], above[j]) for row, above in zip(rows, rows[1:]) for j in range(around)]
    faces += [(bottom, rows[0][j - around + 1], rows[0][j]) for j in range(around)]
    faces += [(bottom + 1, rows[-1][j], rows[-1][j - around + 1]) for j in range(around)]
    with open(path, "w") as out:
        for r, z in profile:
            for j in range(around):
                a = 2 * math.pi * j / around
                out.write("v %r %r %r\n" % (r * math.cos(a), r * math.sin(a), z))
        out.write("v 0 0 0\nv 0 0 40\n")
        out.writelines("f %d %d %d\n" % face for face in faces)


def merged(program, mesh, folder):
    for options in (["--simplify", "0"], []):
        _, cpu, _ = measure([program, "prepare", mesh, "-o", "out.stl", "--hollow", WALL, *options,
                             "--json", "report.json", "--force"], folder)
        report = json.loads((folder / "report.json").read_text())["prepare"]
        print(f"{mesh} {' '.join(options)}: cavity {report['cavity_triangles']}, all {report['triangles']} triangles, "
              f"{(folder / 'out.stl').stat().st_size / 1e6:.2f} MB, processor {cpu:.2f} s")


def main():
    parser = argparse.ArgumentParser(description=__doc__,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default="build/release/bin/tetvdb")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--small", action="store_true", help="only the mesh of 300 k triangles")
    options = parser.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    peer = shutil.which("prusa-slicer")
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "printer.ini").write_text(PRINTER)
        bumpy_ellipsoid(folder / "300k.stl", 500, 301, 1.0)
        if not options.small:
            bumpy_ellipsoid(folder / "2M.stl", 1600, 626, 1.0)
        for mesh in sorted(folder.glob("*.stl")):
            for _ in range(options.repeat):
                wall, cpu, peak = measure(
                    [program, "prepare", mesh.name, "-o", "out.ply", "--hollow", WALL, "--simplify", "0"], folder)
                print(f"{mesh.stem}: tetvdb {wall:.2f} s, processor {cpu:.2f} s, "
                      f"{peak / 1e6:.0f} MB")
                if peer is None:
                    continue
                sla = [peer, "--export-sla", "--load", "printer.ini", "-o", "out.sl1",
                       "--hollowing-min-thickness", WALL, "--hollowing-quality", "1",
                       "--hollowing-closing-distance", "0"]
                solid = measure(sla + [mesh.name], folder)
                hollow = measure(sla + ["--hollowing-enable", mesh.name], folder)
                print(f"{mesh.stem}: PrusaSlicer processor {hollow[1] - solid[1]:.2f} s of "
                      f"{hollow[1]:.2f} s, {hollow[2] / 1e6:.0f} MB")
        bottle(folder / "bottle.obj")
        for mesh in ("bottle.obj", "300k.stl"):
            merged(program, mesh, folder)
    if peer is None:
        print("no prusa-slicer found", file=sys.stderr)


if __name__ == "__main__":
    main()
