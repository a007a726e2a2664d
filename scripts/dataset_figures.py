#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What `tetvdb dataset` takes and what fails, over a folder of models, beside trimesh.

    scripts/dataset_figures.py --build build/release CORPUS/tri [--trimesh PYTHON]

Occupancy of 256^3, packed and deflated. All times are processor time, so that other work on the
machine counts little. --trimesh names a Python with trimesh and scipy: voxelized(pitch).fill() of
some of the closed ones in the same run.
"""
import argparse
import csv
import json
import pathlib
import resource
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
VOXELS = 256
SMALL_FACES = 20000

PEER = """
import sys, time, trimesh
mesh = trimesh.load(sys.argv[1], force="mesh")
start = time.process_time()
mesh.voxelized(mesh.extents.max() * 1.1 / int(sys.argv[2])).fill()
print(time.process_time() - start)
"""


def rows(path):
    with path.open(newline="") as file:
        return list(csv.DictReader(file))


def seconds(row):
    return float(row["processor_seconds"] or "nan")


def percentile(values, share):
    return sorted(values)[min(len(values) - 1, int(share * len(values)))]


def is_solid(program, path):
    """Whether `info` finds a volume, of what it can read."""
    done = subprocess.run([program, "info", path, "--json", "-", "-q"], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                          text=True)
    try:
        about = json.loads(done.stdout)["input"][0]
    except (ValueError, KeyError, IndexError):
        return False
    return done.returncode == 0 and bool(about.get("defects", {}).get("watertight", about.get("tets", 0) > 0))


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--trimesh", help="a Python that has trimesh and scipy")
    parser.add_argument("--peers", type=int, default=8, help="models that trimesh is asked for (default %(default)s)")
    parser.add_argument("--peer-limit", type=float, default=300, help="seconds for each (default %(default)s)")
    arguments = parser.parse_args()
    program = str(arguments.build / "bin/tetvdb")
    with tempfile.TemporaryDirectory(prefix="tetvdb-figures-") as folder:
        out = pathlib.Path(folder) / "out"
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run([program, "dataset", str(arguments.folder), "-o", str(out), "--resolution", str(VOXELS), "--no-preview",
                        "-q"], check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        whole = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        made, failed = rows(out / "success.csv"), rows(out / "failed.csv")
    small = [r for r in made if r["open_edges"] == "0" and int(r["faces"]) < SMALL_FACES]
    times = [seconds(r) for r in made]
    print(f"{len(made)} of {len(made) + len(failed)} models became voxels; {whole:.1f} s of processor time, start of processes included")
    print(f"all: mean {1e3 * statistics.mean(times):.0f} ms, median {1e3 * statistics.median(times):.0f} ms, p99 {percentile(times, 0.99):.2f} s, "
          f"largest {max(times):.2f} s")
    best = [seconds(r) for r in small]
    print(f"closed, below {SMALL_FACES} faces: {len(small)}, mean {1e3 * statistics.mean(best):.1f} ms, p99 {1e3 * percentile(best, 0.99):.0f} ms: "
          f"{1 / statistics.mean(best):.0f} a second of a core")
    print(f"crashes: {sum('signal' in r['error'] for r in failed)}, time-outs: {sum(r['status'] == '5' for r in failed)}")
    solid = {r["name"]: is_solid(program, r["path"]) for r in made + failed}
    lost = [r["name"] for r in failed if solid[r["name"]]]
    print(f"of {sum(solid.values())} that info says are watertight, {sum(solid.values()) - len(lost)} became voxels {lost}")
    if arguments.trimesh:
        ours = theirs = 0.0
        for row in sorted(small, key=lambda r: int(r["faces"]))[len(small) // 4::max(1, len(small) // arguments.peers)][:arguments.peers]:
            try:
                done = subprocess.run([arguments.trimesh, "-c", PEER, row["path"], str(VOXELS)], stdout=subprocess.PIPE,
                                      stderr=subprocess.DEVNULL, text=True, timeout=arguments.peer_limit)
            except subprocess.TimeoutExpired:
                print(f"  {row['name']}: trimesh is not done after {arguments.peer_limit:g} s", flush=True)
                continue
            if done.returncode == 0:
                ours += seconds(row)
                theirs += float(done.stdout)
                print(f"  {row['name']}, {row['faces']} faces: {1e3 * seconds(row):.0f} ms, trimesh {float(done.stdout):.2f} s", flush=True)
        if ours > 0:
            print(f"trimesh takes {theirs / ours:.0f} times as long")


if __name__ == "__main__":
    sys.exit(main())
