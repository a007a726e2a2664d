#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""How meshing's time and memory grow with the number of faces: a table, and a plot as SVG.

    scripts/mesher_growth.py --build build/release --out docs/meshing-growth.svg

The model is one shape, a sphere with bumps a twentieth of its radius high, in more and more
triangles. The table goes to the standard output. Processor seconds are of all threads together:
they depend less than seconds on what else the machine does.
"""
import argparse
import math
import os
import pathlib
import subprocess
import tempfile
import time

import numpy

ROOT = pathlib.Path(__file__).resolve().parent.parent
FACES = (1000, 4000, 16000, 64000, 250000, 1000000)
BUMPS, HEIGHT = 12, 0.05


def write_sphere(path, faces):
    """Binary STL of about that many faces; returns how many."""
    rings = max(4, round(math.sqrt(faces / 4)))
    around = 2 * rings
    theta = numpy.linspace(0, math.pi, rings + 1)[:, None]
    phi = numpy.arange(around + 1)[None, :] * (2 * math.pi / around)
    radius = 1 + HEIGHT * numpy.sin(BUMPS * theta) * numpy.cos(BUMPS * phi) * numpy.sin(theta)
    points = numpy.stack([radius * numpy.sin(theta) * numpy.cos(phi), radius * numpy.sin(theta) * numpy.sin(phi),
                          radius * numpy.cos(theta) + 0 * phi], axis=-1).astype("<f4")
    points[:, -1] = points[:, 0]
    points[0] = points[0, 0]
    points[-1] = points[-1, 0]
    a, b, c, d = points[:-1, :-1], points[1:, :-1], points[1:, 1:], points[:-1, 1:]
    corners = numpy.concatenate([numpy.stack([a, b, c], axis=2)[:-1].reshape(-1, 3, 3),
                                 numpy.stack([a, c, d], axis=2)[1:].reshape(-1, 3, 3)])
    records = numpy.zeros(len(corners), dtype=[("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("extra", "<u2")])
    records["corners"] = corners
    with open(path, "wb") as stl:
        stl.write(bytes(80) + numpy.uint32(len(records)).tobytes() + records.tobytes())
    return len(records)


def measure(command):
    """Seconds, processor seconds, peak megabytes."""
    start = time.monotonic()
    child = subprocess.Popen([str(word) for word in command])
    _, status, usage = os.wait4(child.pid, 0)
    seconds = time.monotonic() - start
    if os.waitstatus_to_exitcode(status) != 0:
        raise SystemExit(f"exit status {os.waitstatus_to_exitcode(status)}: {' '.join(map(str, command))}")
    return seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024


def plot(rows):
    """Log-log: processor seconds against faces, and the line through the last row that grows as faces do."""
    width, height, left, top, right, bottom = 640, 400, 70, 20, 20, 50
    faces = [row[0] for row in rows]
    seconds = [row[2] for row in rows]
    low, high = math.floor(math.log10(min(seconds))), math.ceil(math.log10(max(seconds)))
    first, last = math.floor(math.log10(faces[0])), math.ceil(math.log10(faces[-1]))

    def x(n):
        return left + (math.log10(n) - first) / (last - first) * (width - left - right)

    def y(s):
        return top + (high - math.log10(s)) / (high - low) * (height - top - bottom)

    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="sans-serif" '
             'font-size="12">', f'<rect width="{width}" height="{height}" fill="white"/>']
    for power in range(first, last + 1):
        at = x(10**power)
        parts.append(f'<path d="M{at:.1f} {top}V{height - bottom}" stroke="#ddd"/>'
                     f'<text x="{at:.1f}" y="{height - bottom + 18}" text-anchor="middle">10^{power}</text>')
    for power in range(low, high + 1):
        at = y(10**power)
        parts.append(f'<path d="M{left} {at:.1f}H{width - right}" stroke="#ddd"/>'
                     f'<text x="{left - 8}" y="{at + 4:.1f}" text-anchor="end">{10.0**power:g} s</text>')
    slope = seconds[-1] / faces[-1]
    start = max(faces[0], 10**low / slope)
    parts.append(f'<path d="M{x(start):.1f} {y(slope * start):.1f}L{x(faces[-1]):.1f} {y(seconds[-1]):.1f}" '
                 'stroke="#999" stroke-dasharray="5 4" fill="none"/>')
    line = "L".join(f"{x(n):.1f} {y(s):.1f}" for n, s in zip(faces, seconds))
    parts.append(f'<path d="M{line}" stroke="#1f77b4" stroke-width="2" fill="none"/>')
    parts += [f'<circle cx="{x(n):.1f}" cy="{y(s):.1f}" r="4" fill="#1f77b4"/>' for n, s in zip(faces, seconds)]
    parts.append(f'<text x="{(left + width - right) / 2:.0f}" y="{height - 10}" text-anchor="middle">faces of the input; '
                 'dashed: in proportion to them</text>')
    parts.append(f'<text x="16" y="{height / 2:.0f}" text-anchor="middle" transform="rotate(-90 16 {height / 2:.0f})">'
                 'processor time, all threads</text></svg>')
    return "\n".join(parts) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path, help="plot to write, .svg")
    parser.add_argument("--most", type=int, default=FACES[-1], help="faces of the largest model (default %(default)s)")
    parser.add_argument("--threads", type=int, default=2)
    arguments = parser.parse_args()
    rows = []
    print("| faces | seconds | processor seconds | us a face | peak MB |")
    print("|--:|--:|--:|--:|--:|")
    with tempfile.TemporaryDirectory() as folder:
        stl, tets = pathlib.Path(folder) / "sphere.stl", pathlib.Path(folder) / "sphere.msh"
        for wanted in (n for n in FACES if n <= arguments.most):
            faces = write_sphere(stl, wanted)
            seconds, processor, megabytes = measure([arguments.build / "bin/tetvdb", "tetrahedralize", stl, "-o", tets,
                                                     "-q", "--threads", arguments.threads])
            tets.unlink()
            rows.append((faces, seconds, processor))
            print(f"| {faces} | {seconds:.2f} | {processor:.2f} | {1e6 * processor / faces:.0f} | {megabytes:.0f} |",
                  flush=True)
    if arguments.out:
        arguments.out.write_text(plot(rows))


if __name__ == "__main__":
    main()
