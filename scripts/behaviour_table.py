#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What the program makes of every mesh of a folder, as hashes: a table made before a change of the code and one made
after it must be equal.

    scripts/behaviour_table.py --program build/release/bin/tetvdb CORPUS -o TABLE.tsv [--jobs 2] [--match TEXT]
    scripts/behaviour_table.py --compare BEFORE.tsv AFTER.tsv

A row is a file, a job and what came of it: the exit status and `info --hash` of a volume, or the SHA-256 of a mesh.
Jobs are each kind of grid that a file can have (its arrays too), `repair`, and `tetrahedralize` of small files. A job
that takes more than a minute is a row without a hash: such rows are compared only where both tables have one.
--compare prints the rows that differ and ends with status 1 if there are any.
"""
import argparse
import concurrent.futures
import hashlib
import json
import pathlib
import subprocess
import sys
import tempfile

TIME = 60  # seconds that a job may take
SHAPES = "density,mask,surface,coverage"
JOBS = {
    "triangles": {
        "shapes": ["voxelize", "--resolution", "64", "--grid", SHAPES],
        "distance": ["voxelize", "--resolution", "32", "--grid", "surface", "--half-width", "all"],
        "fit": ["voxelize", "--fit", "48", "--grid", "density"],
        "repair": ["repair"],
    },
    "tets": {
        "shapes": ["voxelize", "--resolution", "64", "--grid", SHAPES + ",tet_id"],
        "regions": ["voxelize", "--resolution", "64", "--grid", "material"],
    },
}
SMALL = 200_000  # bytes of a file of triangles that is tetrahedralized too


def run(program, *arguments):
    try:
        return subprocess.run([program, *map(str, arguments)], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                              timeout=TIME)
    except subprocess.TimeoutExpired:
        return None


def hash_of(program, output):
    if output.suffix != ".vdb":
        return hashlib.sha256(output.read_bytes()).hexdigest()[:16]
    done = run(program, "info", "--hash", output)
    return hashlib.sha256(done.stdout.replace(bytes(output), b"")).hexdigest()[:16] if done else "-"


def outcome(program, arguments, file, output):
    done = run(program, *arguments[:1], file, "-o", output, *arguments[1:], "-q")
    if done is None:
        return "too slow"
    return f"{done.returncode} {hash_of(program, output) if output.exists() else '-'}"


def rows_of(program, root, file):
    name = str(file.relative_to(root))
    described = run(program, "info", "--json", "-", "-q", file)
    rows = [(name, "info", "too slow" if described is None else str(described.returncode))]
    if described is None or not described.stdout:
        return rows
    inputs = json.loads(described.stdout).get("input", [])
    if not inputs:
        return rows
    kind = inputs[0].get("kind", "")
    jobs = dict(JOBS.get(kind, {}))
    if kind == "triangles" and file.stat().st_size < SMALL:
        jobs["tets"] = ["tetrahedralize", "--epsilon", "5e-3d"]
    arrays = [array["name"] for array in inputs[0].get("arrays", [])] if kind == "tets" else []
    if arrays:
        jobs["arrays"] = ["voxelize", "--resolution", "32", "--grid", ",".join(arrays)]
    with tempfile.TemporaryDirectory() as folder:
        for job, arguments in jobs.items():
            ending = {"repair": ".stl", "tets": ".msh"}.get(job, ".vdb")
            rows.append((name, job, outcome(program, arguments, file, pathlib.Path(folder) / (job + ending))))
    return rows


def make(program, root, match, jobs, table):
    files = sorted(path for path in root.rglob("*") if path.is_file() and match in str(path))
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool, open(table, "w", encoding="utf-8") as out:
        for rows in pool.map(lambda file: rows_of(program, root, file), files):
            for row in rows:
                print(*row, sep="\t", file=out, flush=True)


def compare(before, after):
    tables = [dict(line.rstrip("\n").rsplit("\t", 1) for line in open(path, encoding="utf-8"))
              for path in (before, after)]
    differing = 0
    for row in sorted(set(tables[0]) | set(tables[1])):
        values = [table.get(row, "no row") for table in tables]
        if values[0] != values[1] and "too slow" not in values:
            print(row, *values, sep="\t")
            differing += 1
    print(f"{differing} of {len(tables[0])} rows differ")
    return 1 if differing else 0


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("corpus", nargs="?", type=pathlib.Path, help="folder of meshes")
    parser.add_argument("--program", default="build/release/bin/tetvdb")
    parser.add_argument("-o", "--output", help="the table to write")
    parser.add_argument("--jobs", type=int, default=2, help="files at a time")
    parser.add_argument("--match", default="", help="take only paths that contain this text")
    parser.add_argument("--compare", nargs=2, metavar=("BEFORE", "AFTER"))
    options = parser.parse_args()
    if options.compare:
        return compare(*options.compare)
    if not options.corpus or not options.output:
        parser.error("a folder of meshes and -o TABLE are needed, or --compare")
    make(options.program, options.corpus, options.match, options.jobs, options.output)
    return 0


if __name__ == "__main__":
    sys.exit(main())
