#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Repeats the paper's studies of meshing triangles and writes docs/meshing.md.

    scripts/mesher_studies.py --build build/release --out docs/meshing.md CORPUS/tri

Needs the build folder (bin/tetvdb, bin/tet_checker) and a folder of triangle files; the column of
TetGen stays empty where it is not installed. Files are taken one after another, small ones first;
other work on the machine affects the times. With --results, measurements are kept, and an interrupted
run continues.
"""
import argparse
import itertools
import json
import os
import pathlib
import resource
import shutil
import statistics
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
STUDIES = ("success", "epsilon", "quality")
CHECKED_FACES = 50000  # above, brute force takes too long
CHECK_SAMPLES = ("20000", "500", "5000")  # on the surface, of winding numbers, for overlaps
CHECK_TIME = 60
VOXELS = 128  # along the longest side, the usual limit of training data
EPSILONS = (1e-4, 3e-4, 1e-3, 3e-3, 5e-3, 1e-2, 2e-2)
AUGMENTING = tuple(e for e in EPSILONS if e >= 3e-3)
GOOD_ENERGY = 10
FINE = (256, 512)
TRIALS = 3
MODELS = 8

# Linux counts the memory of whoever starts a program as the program's own peak, so that a small
# process has to do it. The alarm outlives exec: whoever is past the limit ends by SIGALRM.
MEASURE = """
import os, signal, sys, time
start = time.monotonic()
child = os.fork()
if child == 0:
    signal.alarm(int(sys.argv[1]))
    os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
    os.execv(sys.argv[2], sys.argv[2:])
_, status, usage = os.wait4(child, 0)
print(os.waitstatus_to_exitcode(status), time.monotonic() - start, usage.ru_maxrss)
"""
TOO_LATE = -14  # SIGALRM


def measure(limit, command):
    """Exit status, seconds, peak megabytes."""
    done = subprocess.run([sys.executable, "-I", "-S", "-c", MEASURE, str(int(limit)), *map(str, command)],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    status, seconds, kilobytes = done.stdout.split()
    return int(status), float(seconds), int(kilobytes) / 1024


class Bench:
    """The programs, the limits, and a folder for what they write."""

    def __init__(self, arguments, folder):
        self.program = str(arguments.build / "bin/tetvdb")
        self.checker = str(arguments.build / "bin/tet_checker")
        self.tetgen = shutil.which("tetgen")
        self.limit, self.tetgen_limit = arguments.limit, arguments.tetgen_limit or arguments.limit
        self.folder = pathlib.Path(folder)

    def path(self, name):
        return self.folder / name

    def clear(self):
        for old in self.folder.iterdir():
            old.unlink()

    def run(self, *arguments):
        """One run of tetvdb: status, seconds, megabytes, report. --max-time is the polite limit; who
        overlooks it by a quarter is ended."""
        report = self.path("report.json")
        report.unlink(missing_ok=True)
        status, seconds, megabytes = measure(
            self.limit * 1.25 + 5,
            [self.program, *arguments, "-q", "--max-time", self.limit, "--json", report])
        try:
            return status, seconds, megabytes, json.loads(report.read_text())
        except (OSError, ValueError):
            return status, seconds, megabytes, {}

    def ask(self, *arguments):
        done = subprocess.run([self.program, *map(str, arguments), "--json", "-", "-q"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True)
        return json.loads(done.stdout) if done.stdout else {}


def run_tetgen(bench, path, switches="-pQ"):
    """What TetGen makes of the cleaned triangles: outcome, seconds, megabytes, tets."""
    cleaned = bench.path("cleaned.off")
    bench.run("voxelize", path, "--mesher", "winding", "--write-mesh", cleaned)
    if not cleaned.exists():
        return {"outcome": ""}
    status, seconds, megabytes = measure(bench.tetgen_limit, [bench.tetgen, switches, cleaned])
    elements = bench.path("cleaned.1.ele")
    tets = int(elements.open().readline().split()[0]) if status == 0 and elements.exists() else 0
    outcome = "ok" if tets else "empty" if status == 0 else "too late" if status == TOO_LATE else \
        "crashes" if status == -11 else "gives up"
    return {"outcome": outcome, "seconds": seconds, "megabytes": megabytes, "tets": tets}


def examine(bench, path):
    """One row of the study of success."""
    bench.clear()
    mesh = bench.path("solid.msh")
    status, seconds, megabytes, report = bench.run("tetrahedralize", path, "-o", mesh)
    row = {"name": path.name, "status": status, "seconds": seconds, "megabytes": megabytes,
           "error": report.get("error", ""), "faces": sum(i.get("triangles", 0) for i in report.get("input", []))}
    if status in (0, 1) and mesh.exists():
        made = report["mesh"]
        row.update(tets=made["tets"], left_out=made["not_inserted"], lost=made["check"]["lost_points"],
                   owed=made["check"]["owed_points"], out=made["check"]["out_to_in"] / made["epsilon_asked"],
                   volume=made["check"]["volume"], winding_volume=made["check"]["winding_volume"],
                   warnings=report.get("warnings", []))
        if row["faces"] < CHECKED_FACES:
            row["checker"] = check(bench, mesh, path, made["epsilon_asked"])
    if bench.tetgen:
        row["tetgen"] = run_tetgen(bench, path)
    return row


def check(bench, mesh, path, epsilon):
    """The checker's word, which shares no code with the mesher: its faults, or what kept it from judging."""
    try:
        done = subprocess.run([bench.checker, mesh, path, repr(epsilon), *CHECK_SAMPLES], timeout=CHECK_TIME,
                              stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    except subprocess.TimeoutExpired:
        return "no word in time"
    try:
        return json.loads(done.stdout)["faults"] or "valid"
    except (ValueError, KeyError):
        return f"cannot judge ({done.returncode})"


def choose_models(bench, paths):
    """Closed clean models of 1000 to 30000 faces, evenly taken by size."""
    found = []
    for path in paths:
        inputs = bench.ask("info", path).get("input") or [{}]  # none of what cannot be read
        defects = inputs[0].get("defects", {})
        faces = inputs[0].get("triangles", 0)
        flaws = ("boundary_edges", "nonmanifold_edges", "misoriented_edges", "degenerate_faces", "self_intersections")
        if 1000 <= faces <= 30000 and defects and not any(defects.get(flaw, 1) for flaw in flaws):
            found.append((faces, path.name, path))
    found.sort()
    taken = min(MODELS, len(found))
    return [found[round(i * (len(found) - 1) / max(1, taken - 1))][2] for i in range(taken)]


def iou(bench, a, b):
    grids = bench.ask("compare", a, b).get("compare", {}).get("grids", [])
    return grids[0]["iou"] if grids else None


def study_epsilon(bench, path):
    """One model through all epsilons: IoU with the exact volume, and of each volume with each other."""
    bench.clear()
    truth = bench.path("truth.vdb")
    status, _, _, report = bench.run("voxelize", path, "-o", truth, "--mesher", "winding", "--grid", "mask",
                                     "--resolution", VOXELS)
    if status not in (0, 1):
        return {"name": path.name, "error": report.get("error", f"status {status}"), "runs": []}
    voxel = report["grids"][0]["voxel_size"][0]
    row = {"name": path.name, "faces": report["input"][0]["triangles"], "voxels": report["grids"][0]["active_voxels"],
           "runs": [], "pairs": []}
    for epsilon in EPSILONS:
        volume = bench.path(f"{epsilon}.vdb")
        status, seconds, megabytes, report = bench.run(
            "voxelize", path, "-o", volume, "--mesher", "envelope", "--epsilon", f"{epsilon}d", "--grid", "mask",
            "--voxel-size", repr(voxel))
        mesh = report.get("mesh") or {}
        method = (mesh.get("mesher") or {}).get("method")
        made = status in (0, 1) and volume.exists() and method == "envelope"  # else the exact volume stands in
        row["runs"].append({"epsilon": epsilon, "status": status, "seconds": seconds, "megabytes": megabytes,
                            "tets": mesh.get("tets"), "method": method,
                            "epsilon_in_voxels": (mesh.get("epsilon_asked") or 0) / voxel,
                            "iou": iou(bench, truth, volume) if made else None})
    for a, b in itertools.combinations(AUGMENTING, 2):
        first, second = bench.path(f"{a}.vdb"), bench.path(f"{b}.vdb")
        if first.exists() and second.exists():
            row["pairs"].append([a, b, iou(bench, first, second)])
    return row


def voxelizing_seconds(report):
    return next(s["seconds"] for s in report["stages"] if s["name"] == "voxelize")


def study_quality(bench, path):
    """One model meshed to both ends, and each mesh voxelized."""
    bench.clear()
    row = {"name": path.name, "meshes": []}
    for stop in ((), ("--stop-energy", GOOD_ENERGY)):
        mesh = bench.path("solid.msh")
        status, seconds, _, report = bench.run("tetrahedralize", path, "-o", mesh, *stop)
        made = {"stop": bool(stop), "status": status, "seconds": seconds}
        row["meshes"].append(made)
        if status not in (0, 1):
            continue
        quality = report["mesh"]["quality"]
        made.update(tets=report["mesh"]["tets"], box=quality["box_over_volume"], worst=quality["worst_energy"],
                    mean=quality["mean_energy"], voxelize={})
        for grid, voxels in itertools.product(("mask", "tet_id"), FINE):
            reports = [bench.run("voxelize", mesh, "-o", bench.path("solid.vdb"), "--grid", grid, "--resolution",
                                 voxels)[3] for _ in range(TRIALS)]
            made["voxelize"][f"{grid} {voxels}"] = min(map(voxelizing_seconds, reports))
    return row


class Kept:
    """What was measured, one JSON object a line, so that a broken run goes on."""

    def __init__(self, path):
        self.path, self.rows = path, {}
        if path and path.exists():
            for line in path.read_text().splitlines():
                entry = json.loads(line)
                self.rows[entry["study"], entry["row"]["name"]] = entry["row"]

    def row(self, study, name, measured):
        if (study, name) not in self.rows:
            self.rows[study, name] = measured()
            if self.path:
                with self.path.open("a") as file:
                    print(json.dumps({"study": study, "row": self.rows[study, name]}), file=file)
        return self.rows[study, name]


def mean(values):
    values = [v for v in values if v is not None]
    return sum(values) / len(values) if values else float("nan")


def median_of(values):
    values = [v for v in values if v is not None]
    return statistics.median(values) if values else float("nan")


def percentile(values, share):
    values = sorted(values)
    return values[min(len(values) - 1, int(share * len(values)))]


def percent(part, whole):
    return f"{100 * part / whole:.1f} %" if whole else "-"


def table(heads, rows, numbers_from=1):
    lines = ["| " + " | ".join(heads) + " |",
             "|" + "".join("---|" if i < numbers_from else "--:|" for i in range(len(heads)))]
    return "\n".join(lines + ["| " + " | ".join(map(str, row)) + " |" for row in rows])


def wall(seconds):
    return f"{seconds:.0f}" if seconds >= 100 else f"{seconds:.1f}" if seconds >= 10 else f"{seconds:.2f}"


MEANINGS = {0: "done, all guarantees met", 1: "done, a guarantee not met (a face not inserted, a point lost), with a warning",
            3: "nothing to mesh (no inside, or unreadable), with an error", 4: "memory limit", 5: "time limit", TOO_LATE: "time limit overlooked, ended from outside"}


def success_text(rows, arguments, tetgen):
    by_status = {s: sum(r["status"] == s for r in rows) for s in sorted({r["status"] for r in rows})}
    meshed = [r for r in rows if r["status"] in (0, 1)]
    within = sum(r["seconds"] <= 60 and r["status"] in (0, 1, 3) for r in rows)
    whole = sum(r["left_out"] == 0 for r in meshed)
    checked = [r for r in meshed if "checker" in r]
    faults = {}
    for r in checked:
        faults[r["checker"]] = faults.get(r["checker"], 0) + 1
    lines = [table(("status", "meaning", "files", "share"),
                   [(s, MEANINGS.get(s, "ended by a signal" if s < 0 else "refused"), n, percent(n, len(rows)))
                    for s, n in by_status.items()], 2), "",
             f"- **Answered within 60 s** (statuses 0, 1 and 3): {within} of {len(rows)} ({percent(within, len(rows))}).",
             f"- **All faces inserted**: {whole} of {len(meshed)} meshes ({percent(whole, len(meshed))}); "
             f"without lost points: {sum(r['lost'] == 0 for r in meshed)}.",
             f"- **tet_checker** judged {len(checked)} meshes of fewer than {CHECKED_FACES} faces: "
             + ", ".join(f"{n} {word}" for word, n in sorted(faults.items(), key=lambda f: (-f[1], f[0])))
             + ". It asks for the winding\n  numbers of the file's own faces; where cleaning closes holes or turns faces, "
             "points are on the wrong side of these."]
    codes = [w["code"] for r in meshed if r["status"] == 1 for w in r["warnings"]]
    lines.append("- **Warnings** of the meshes with status 1 (a file may have several): "
                 + ", ".join(f"{codes.count(c)} {c}" for c in sorted(set(codes), key=lambda c: (-codes.count(c), c))) + ".")
    lines += ["", table(("", "median", "90 %", "95 %", "99 %", "largest"),
                        [[title] + [form(percentile([r[key] for r in rows], p)) for p in (0.5, 0.9, 0.95, 0.99, 1)]
                         for title, key, form in (("seconds", "seconds", wall),
                                                  ("peak MB", "megabytes", lambda v: f"{v:.0f}"))])]
    if tetgen:
        solid = [r for r in rows if r["status"] != 3 and "tetgen" in r]
        outcomes = [r["tetgen"]["outcome"] for r in solid]
        ours = sum(r["status"] in (0, 1) for r in solid)
        lines += ["", f"Compared with TetGen (`tetgen -p` on the cleaned triangles, limit {arguments.tetgen_limit or arguments.limit:.0f} s), "
                  f"over the {len(solid)} files that hold a solid, and the paper's own figures (3000 models of Thingi10k, 20 minutes):", "",
                  table(("", "TetVDB", "TetGen", "the paper's mesher", "TetGen in the paper"),
                        [("tets (TetVDB: status 0 or 1)", f"{ours} ({percent(ours, len(solid))})",
                          f"{outcomes.count('ok')} ({percent(outcomes.count('ok'), len(solid))})", "99.4 %", "59.1 %"),
                         ("time limit", sum(r["status"] in (5, TOO_LATE) for r in solid), outcomes.count("too late"), 10, 46),
                         ("no outcome", sum(r["status"] not in (0, 1, 5, TOO_LATE) for r in solid),
                          sum(o not in ("ok", "too late") for o in outcomes), 8, 1183)])]
        words = {w: outcomes.count(w) for w in ("gives up", "crashes", "empty", "")}
        lines += ["", f"TetGen's {sum(words.values())} without outcome: {words['gives up']} given up (mostly crossing "
                  f"faces), {words['crashes']} crashed, {words['empty']} empty (open, so that everything is outside), "
                  f"{words['']} could not be cleaned."]
    return "\n".join(lines)


def files_table(rows):
    def cells(r):
        if r["status"] not in (0, 1):
            made = [""] * 6
        else:
            reference = r["winding_volume"]
            made = [r["tets"], r["left_out"], r["lost"], f"{r['out']:.2f}",
                    f"{r['volume'] / reference:.4f}" if reference else "", r.get("checker", "")]
        other = r.get("tetgen", {})
        return [r["name"], r["faces"] or "", r["status"], wall(r["seconds"]), f"{r['megabytes']:.0f}", *made,
                other.get("outcome", "") + (f", {wall(other['seconds'])} s" if other.get("outcome") == "ok" else "")]

    return table(("file", "faces", "status", "s", "MB", "tets", "left out", "lost", "out", "volume", "tet_checker",
                  "TetGen"), [cells(r) for r in sorted(rows, key=lambda r: r["name"].lower())])


def at(row, epsilon):
    return next((r for r in row["runs"] if r["epsilon"] == epsilon), {})


def epsilon_text(rows):
    def line(epsilon):
        runs = [at(row, epsilon) for row in rows]
        values = [r["iou"] for r in runs if r.get("iou") is not None]
        return [f"{epsilon:g}", f"{mean(r.get('epsilon_in_voxels') for r in runs):.2f}", f"{mean(values):.4f}",
                f"{min(values, default=float('nan')):.4f}", f"{mean(r.get('seconds') for r in runs):.2f}",
                f"{median_of(r.get('tets') for r in runs):.0f}", sum(r.get("status") == 0 for r in runs)]

    def up_to(limit):
        """The largest epsilon up to which every model's IoU is at least this."""
        kept = list(itertools.takewhile(lambda e: all(at(row, e).get("iou") is None or at(row, e)["iou"] >= limit
                                                     for row in rows), EPSILONS))
        return f"{kept[-1]:g}" if kept else "no epsilon"

    each = [[row["name"], row.get("faces", "")] + ["-" if at(row, e).get("iou") is None else f"{at(row, e)['iou']:.4f}"
                                                   for e in EPSILONS] for row in rows]
    return "\n\n".join((
        table(("epsilon / diagonal", "in voxels", "mean IoU", "min IoU", "mean s", "median tets",
               f"status 0, of {len(rows)}"), [line(e) for e in EPSILONS]),
        f"Every model is above 0.99 up to {up_to(0.99)}, above 0.95 up to {up_to(0.95)} and "
        f"above 0.9 up to {up_to(0.9)}.\nModels of parts thinner than twice epsilon change most, since both sides of these "
        "are within epsilon of each other; where points\nor more than 5 % of the volume are lost, they are meshed within a "
        "half to a sixteenth of epsilon. Where a planar side lies on\nvoxel centres, any movement of it adds or removes "
        "a layer of voxels; the sides on the box's own planes are such. Status 1 are\nmeshes that lose points even so, and "
        "runs without tets in time (-), where the exact volume is written instead; both have a warning.",
        "IoU model by model:",
        table(("model", "faces", *(f"{e:g}" for e in EPSILONS)), each)))


def augmentation_text(rows):
    def others(epsilon):
        return mean(1 - value for row in rows for a, b, value in row.get("pairs", ()) if epsilon in (a, b)
                    and value is not None)

    lines = [[f"{e:g}", f"{mean(1 - v for v in (at(row, e).get('iou') for row in rows) if v is not None):.4f}",
              f"{others(e):.4f}", f"{median_of(at(row, e).get('tets') for row in rows):.0f}",
              f"{mean(at(row, e).get('seconds') for row in rows):.2f}"] for e in AUGMENTING]
    return table(("epsilon / diagonal", "1 - IoU with the exact shape", "mean 1 - IoU with the other epsilons",
                  "median tets", "mean s"), lines)


def augmentation_words(rows):
    low, high = AUGMENTING[0], AUGMENTING[-1]
    tets = {e: f"{median_of(at(row, e).get('tets') for row in rows):.0f}" for e in (low, high)}
    return f"""Differences stay within epsilon of the surface, except in holes. The mesher is deterministic: every shape can be
reproduced from its epsilon, without a seed. The median number of tets
goes from {tets[low]} at {low:g} to {tets[high]} at {high:g}; with few tets planar regions tilt and thin ones
vanish, so that the largest epsilon depends on what counts as the same shape."""


def quality_text(rows):
    keys = [f"{grid} {voxels}" for grid in ("mask", "tet_id") for voxels in FINE]
    lines = []
    for row in rows:
        for made in row["meshes"]:
            stop = f"energy {GOOD_ENERGY}" if made["stop"] else "default"
            if "tets" not in made:
                lines.append([row["name"], stop, f"status {made['status']}", wall(made["seconds"])] + [""] * (3 + len(keys)))
                continue
            lines.append([row["name"], stop, made["tets"], wall(made["seconds"]), f"{made['worst']:.3g}",
                          f"{made['mean']:.2f}", f"{made['box']:.1f}"] + [f"{made['voxelize'][k]:.3f}" for k in keys])
    both = [row["meshes"] for row in rows if len(row["meshes"]) == 2 and all("tets" in m for m in row["meshes"])]
    parts = [table(("model", "stop", "tets", "s", "worst energy", "mean energy", "box/volume", *keys), lines, 2)]
    if both:
        ratios = ", ".join(f"{mean(b['voxelize'][k] / a['voxelize'][k] for a, b in both):.2f} ({k})" for k in keys)
        parts.append(
            f"On average of the models, improvement takes {mean(b['seconds'] / a['seconds'] for a, b in both):.1f} times the "
            f"seconds of meshing, the tets become {mean(b['tets'] / a['tets'] for a, b in both):.2f} times as many and box over "
            f"volume goes from {mean(a['box'] for a, _ in both):.1f} to {mean(b['box'] for _, b in both):.1f}; the seconds of "
            f"voxelization change by the factors {ratios}.")
    return "\n\n".join(parts)


def page(version, arguments, tetgen, files, success, epsilon, quality):
    limit = f"{arguments.limit:.0f} s"
    short = "" if arguments.limit >= 1200 else " where the paper gave 1200 s"
    part = "" if len(success) == files else f"(the smallest of {files}) "
    parts = [f"""# The paper's studies

The experiments of "Robust Voxelization and Visualization by Improved Tetrahedral Mesh Generation" (Chen, Tai, Chen,
Ouhyoung) on meshing triangles within epsilon, repeated with `tetvdb tetrahedralize`.
`scripts/mesher_studies.py` makes this page; TetVDB {version}.
[robustness.md](robustness.md) has the study of the winding number."""]
    if arguments.note:
        parts.append(arguments.note)
    if success:
        parts += [f"""## Success

{len(success)} triangle files {part}of public data sets, not repaired, with default options (epsilon 1e-3 of the diagonal), a limit of {limit}
a file{short}. "Status" is the program's exit status.""", success_text(success, arguments, tetgen)]
    if epsilon:
        parts += [f"""## Error bounds

{len(epsilon)} closed models without defects. Reference: the exact volume by winding number, {VOXELS} voxels along the longest side;
compared with `voxelize --mesher envelope --epsilon` on the same lattice. The paper reports nearly identical volumes below 1e-3
and small differences below 1e-2. Seconds are of the whole process, meshing included.""", epsilon_text(epsilon),
                  """## Augmentation

The paper suggests larger epsilons for augmenting training data: several epsilons make several shapes of one mesh.
Their differences, as 1 - IoU:""", augmentation_text(epsilon),
                  augmentation_words(epsilon)]
    if quality:
        parts += [f"""## Quality

The paper states that well-shaped tets voxelize faster, since their bounding boxes hold few voxels outside of the tet. "Box/volume": the
summed volume of the tets' boxes over the tets' own. "s": meshing, the whole process. The rest: seconds of the stage
`voxelize` of `tetvdb voxelize MESH.msh`, best of {TRIALS}; `mask` is made from the boundary where that is quicker,
`tet_id` needs every tet.""", quality_text(quality)]
    if success:
        parts += [f"""## Files

"left out": faces of the input that were not inserted; "lost": points of the input that are owed and farther than epsilon
from the boundary; "out": the largest distance of the boundary from the input, over epsilon; "volume": over the winding
number's. "tet_checker" is the independent check of the tests (bin/tet_checker, {' '.join(CHECK_SAMPLES)} samples), which shares no code with the
mesher. Seconds and peak memory are of the whole process; other work on the machine affects them.""", files_table(success)]
    return "\n\n".join(parts) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", type=pathlib.Path, help="with the triangle files")
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path, help="page to write (default: standard output)")
    parser.add_argument("--limit", type=float, default=1200, help="seconds a file may take (default %(default)s)")
    parser.add_argument("--tetgen-limit", type=float, help="seconds TetGen may take (default: as --limit)")
    parser.add_argument("--only", default=",".join(STUDIES), help="studies to do (default %(default)s)")
    parser.add_argument("--smallest", type=int, help="how many files, small ones first (default: all)")
    parser.add_argument("--models", help="files for epsilon and quality, with commas (default: "
                        f"{MODELS} closed clean ones of 1000 to 30000 faces)")
    parser.add_argument("--note", help="a paragraph for the head of the page: which state was measured, on what")
    parser.add_argument("--results", type=pathlib.Path, help="where measurements are kept, a JSON object a line")
    arguments = parser.parse_args()
    studies = arguments.only.split(",")
    for study in studies:
        if study not in STUDIES:
            parser.error(f"--only knows {', '.join(STUDIES)}, not {study}")

    paths = sorted((p for p in arguments.folder.iterdir() if p.is_file()), key=lambda p: (p.stat().st_size, p.name))
    kept = Kept(arguments.results)
    made = {study: [] for study in STUDIES}
    with tempfile.TemporaryDirectory(prefix="tetvdb-studies-") as folder:
        bench = Bench(arguments, folder)

        def do(study, those, measured):
            for path in those if study in studies else ():
                row = kept.row(study, path.name, lambda: measured(bench, path))
                made[study].append(row)
                print(f"{study} {len(made[study])}/{len(those)} {path.name}", file=sys.stderr, flush=True)

        do("success", paths[:arguments.smallest], examine)
        if "epsilon" in studies or "quality" in studies:
            models = [arguments.folder / name for name in arguments.models.split(",")] if arguments.models else \
                choose_models(bench, paths)
            do("epsilon", models, study_epsilon)
            do("quality", models, study_quality)
        version = subprocess.run([bench.program, "--version"], stdout=subprocess.PIPE, text=True).stdout.split()[-1]
        text = page(version, arguments, bench.tetgen, len(paths), *(made[study] for study in STUDIES))
    if arguments.out:
        arguments.out.write_text(text)
    else:
        print(text, end="")


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # what crashes here need not leave its memory
    main()
