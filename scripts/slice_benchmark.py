#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Times `tetvdb slice` beside prusa-slicer --export-sla of the same meshes, and `tetvdb check`, in
one run, as in docs/print.md. Wall seconds, processor seconds and peak memory of every program.

    scripts/slice_benchmark.py [--program build/release/bin/tetvdb] [--repeat 3] [--small]
"""

import argparse
import math
import os
import pathlib
import shutil
import struct
import sys
import tempfile
import time

PRINTER = """printer_technology = SLA
display_width = 120.96
display_height = 68.04
display_pixels_x = 2560
display_pixels_y = 1440
display_orientation = landscape
display_mirror_x = 0
display_mirror_y = 0
layer_height = 0.05
initial_layer_height = 0.05
exposure_time = 8
initial_exposure_time = 35
faded_layers = 10
gamma_correction = 1
max_print_height = 150
supports_enable = 0
pad_enable = 0
support_object_elevation = 0
elefant_foot_compensation = 0
slice_closing_radius = 0
absolute_correction = 0
bed_shape = 0x0,120.96x0,120.96x68.04,0x68.04
thumbnails =
"""


def bumpy_ellipsoid(path, around, along, scale):
    """A closed mesh of 2 around (along - 1) triangles, as binary STL."""
    rows = []
    for i in range(1, along):
        t = math.pi * i / along
        s, row = math.sin(t), []
        for j in range(around):
            p = 2 * math.pi * j / around
            r = 10 * scale * (1 + 0.03 * math.sin(9 * p) * s ** 2 * math.sin(11 * t)
                              + 0.01 * math.sin(40 * p) * s ** 4 * math.sin(37 * t))
            row.append((1.6 * r * s * math.cos(p), 1.2 * r * s * math.sin(p), r * math.cos(t)))
        rows.append(row)
    top, bottom = (0.0, 0.0, 10.0 * scale), (0.0, 0.0, -10.0 * scale)
    pack = struct.Struct("<12fH").pack
    with open(path, "wb") as file:
        file.write(b"\0" * 80 + struct.pack("<I", 2 * around * (along - 1)))
        add = lambda a, b, c: file.write(pack(0, 0, 0, *a, *b, *c, 0))
        for j in range(around):
            k = (j + 1) % around
            add(top, rows[0][j], rows[0][k])
            add(bottom, rows[-1][k], rows[-1][j])
            for upper, lower in zip(rows, rows[1:]):
                add(upper[j], lower[j], lower[k])
                add(upper[j], lower[k], upper[k])


def lattice(path, counts, cell, width):
    """Struts along three axes as boxes that overlap, as binary STL."""
    strut = [n * cell + width for n in counts]
    boxes = []
    for axis in range(3):
        u, v = (axis + 1) % 3, (axis + 2) % 3
        for i in range(counts[u] + 1):
            for j in range(counts[v] + 1):
                low, high = [0.0] * 3, [0.0] * 3
                high[axis] = strut[axis]
                low[u], low[v] = i * cell + 1e-3 * axis, j * cell + 1e-3 * axis
                high[u], high[v] = i * cell + width - 1e-3 * axis, j * cell + width - 1e-3 * axis
                boxes.append((low, high))
    faces = [(0, 2, 1), (0, 3, 2), (4, 5, 6), (4, 6, 7), (0, 1, 5), (0, 5, 4), (1, 2, 6), (1, 6, 5),
             (2, 3, 7), (2, 7, 6), (3, 0, 4), (3, 4, 7)]
    pack = struct.Struct("<12fH").pack
    with open(path, "wb") as file:
        file.write(b"\0" * 80 + struct.pack("<I", 12 * len(boxes)))
        for (x0, y0, z0), (x1, y1, z1) in boxes:
            p = [(x0, y0, z0), (x1, y0, z0), (x1, y1, z0), (x0, y1, z0),
                 (x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1)]
            for a, b, c in faces:
                file.write(pack(0, 0, 0, *p[a], *p[b], *p[c], 0))


def measure(command, folder):
    """Wall seconds, processor seconds, peak bytes."""
    start = time.monotonic()
    child = os.fork()
    if child == 0:
        os.chdir(folder)
        null = os.open(os.devnull, os.O_WRONLY)
        os.dup2(null, 1)
        os.dup2(null, 2)
        os.execvp(command[0], command)
    _, status, usage = os.wait4(child, 0)
    found = command[1] == "check" and os.waitstatus_to_exitcode(status) == 8
    if status != 0 and not found:
        sys.exit("%s failed" % " ".join(command))
    return time.monotonic() - start, usage.ru_utime + usage.ru_stime, usage.ru_maxrss * 1024


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--program", default="build/release/bin/tetvdb")
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--small", action="store_true", help="a hundredth of the triangles")
    options = parser.parse_args()
    program = str(pathlib.Path(options.program).resolve())
    folder = tempfile.mkdtemp(prefix="tetvdb-slice-")
    try:
        small = 10 if options.small else 1
        bumpy_ellipsoid(folder + "/fine.stl", 1414 // small, 708 // small, 1)
        bumpy_ellipsoid(folder + "/large.stl", 550 // small, 274 // small, 4.6)
        (pathlib.Path(folder) / "printer.ini").write_text(PRINTER)
        display = ["--pixels", "11520,5120", "--display", "218.88,122.88", "--layer-height",
                   "0.0485"]
        hd = ["--printer", "printer.ini"]
        lattice(folder + "/lattice.stl", (66 // small, 38 // small, 30 // small), 3.0, 0.6)
        sla = ["--target", "sla", *display[:-1], "0.0307"]
        few = ["--checks", "islands,cups,traps"]
        runs = {
            "fine, 400 layers of 2560 x 1440, area":
                [program, "slice", "fine.stl", "-o", "a.sl1", *hd, "--aa", "area"],
            "the same by prusa-slicer":
                ["prusa-slicer", "--load", "printer.ini", "--center", "60.48,34.02",
                 "--export-sla", "-o", "b.sl1", "fine.stl"],
            "fine, volume": [program, "slice", "fine.stl", "-o", "c.sl1", *hd],
            "large, 1897 layers of 11520 x 5120, volume, .sl1":
                [program, "slice", "large.stl", "-o", "d.sl1", *display],
            "the same, .goo": [program, "slice", "large.stl", "-o", "e.goo", *display],
            "large, 2997 layers, check": [program, "check", "large.stl", *sla],
            "the same, islands, cups and traps": [program, "check", "large.stl", *sla, *few],
            "lattice, 2951 layers, check": [program, "check", "lattice.stl", *sla],
            "the lattice, islands, cups and traps":
                [program, "check", "lattice.stl", *sla, *few],
        }
        for name, command in runs.items():
            if not shutil.which(command[0]):
                print("%-50s not there" % name)
                continue
            times = sorted(measure(command, folder) for _ in range(options.repeat))
            wall, cpu, memory = times[len(times) // 2]
            print("%-50s wall %6.2f s, processor %6.2f s, %5.0f MB" % (name, wall, cpu,
                                                                     memory / 1e6))
    finally:
        shutil.rmtree(folder, ignore_errors=True)


if __name__ == "__main__":
    main()
