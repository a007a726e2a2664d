#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Times `tetvdb prepare --hollow` beside PrusaSlicer's hollowing of the same meshes, in one run, as in
docs/print.md. PrusaSlicer hollows only on the way to an .sl1 file: its time is the difference between
two such runs, with hollowing and without.

    scripts/prepare_benchmark.py [--program build/release/bin/tetvdb] [--repeat 3] [--small]
"""

import argparse
import pathlib
import shutil
import sys
import tempfile

from slice_benchmark import PRINTER, bumpy_ellipsoid, measure

WALL = "2"


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
                    [program, "prepare", mesh.name, "-o", "out.ply", "--hollow", WALL], folder)
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
    if peer is None:
        print("no prusa-slicer found", file=sys.stderr)


if __name__ == "__main__":
    main()
