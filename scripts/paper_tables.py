#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The tables of "Robust Voxelization and Visualization by Improved Tetrahedral Mesh Generation",
measured again with this program: writes docs/paper_tables.md.

    scripts/paper_tables.py --tables 1                     # times of three sizes, 256^3
    scripts/paper_tables.py --tables 2 CORPUS/tri          # 10,000 samples, and what 5 million would take
    scripts/paper_tables.py --tables 3 CORPUS/tri          # how many models become voxels, by mesher
    scripts/paper_tables.py --tables epsilon CORPUS/tri    # IoU against epsilon

Needs the build folder (bin/tetvdb, bin/tetvdb_bench); TetGen's rows stay empty where it is not
installed. Times depend on what else the machine does. With --results, what was measured of each
model is kept and a run that was broken off goes on where it was; sections of --out that are not
measured now stay.
"""
import argparse
import csv
import json
import os
import pathlib
import re
import resource
import statistics
import subprocess
import sys
import tempfile
import time

import mesher_studies as studies

TABLES = ("1", "2", "3", "epsilon")
MILLIONS = 5
VOXELS = 256
SMALL_FACES = 20000
MESHERS = ("winding", "envelope", "tetgen", "covering")
TITLES = {"winding": "winding number", "envelope": "envelope mesher", "tetgen": "TetGen",
          "covering": "centroid covering"}
HEAD = """# The paper's tables

"Robust Voxelization and Visualization by Improved Tetrahedral Mesh Generation" (Chen, Tai, Chen, Ouhyoung) has three tables and a study of
epsilon. `scripts/paper_tables.py` measures them again, one command each, and makes this page; the paper's machines
are others, so that its columns are for orders of magnitude."""


def command_of(arguments, table):
    words = ["scripts/paper_tables.py", "--tables", table]
    for name in ("samples", "limit", "smallest"):
        value = getattr(arguments, name)
        if value is not None and value != arguments.defaults[name] and (name != "samples" or table == "2"):
            words += ["--" + name, f"{value:g}"]
    return " ".join(words + (["CORPUS/tri"] if table != "1" else []))


def machine():
    model = re.search(r"model name\s*: (.*)", pathlib.Path("/proc/cpuinfo").read_text())
    return (f"{os.cpu_count()} cores, {model.group(1) if model else 'unknown'}, {time.strftime('%-d %B %Y')}; load average "
            f"{os.getloadavg()[2]:.0f} in the last 15 minutes")


def disk_of(folder):
    """The disk under a folder, as the system names it."""
    told = subprocess.run(["findmnt", "-nro", "SOURCE,FSTYPE", "-T", folder], stdout=subprocess.PIPE, text=True)
    source, kind = (told.stdout.split() + ["unknown", "unknown"])[:2]
    model = pathlib.Path("/sys/block") / re.sub(r"p?\d*$", "", source.rpartition("/")[2]) / "device/model"
    return f"{source}{' (' + model.read_text().strip() + ')' if model.exists() else ' (virtual)'}, {kind}"


# --- Table 1

def table1(bench, arguments, paths, kept):
    result = bench.path("tets.json")
    subprocess.run([str(arguments.build / "bin/tetvdb_bench"), "tets", "--json", str(result)], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    rows = {row["what"]: row for row in json.loads(result.read_text())["cases"][0]["rows"]}
    lines = []
    for power, cpu, gpu in ((7, "98.931", "9.77"), (6, "2.947", "2.776"), (5, "0.503", "1.665")):
        row = next(r for what, r in rows.items() if what.startswith("mask") and f"10^{power} tets" in what)
        ours, peer = (statistics.median(row[who]) for who in ("ours_seconds", "peer_seconds"))
        lines.append([f"10^{power}", f"{ours:.3f}", f"{peer:.3f}", f"{peer / ours:.1f}", cpu, gpu])
    return ("A ball of so many tets to a mask of 256^3, seconds (medians): tets in memory to the finished sparse tree, and the "
            "paper's loop over dense boxes, both on all cores.\n\n"
            + studies.table(("tets", "TetVDB", "the paper's loop here", "ratio", "paper: CPU", "paper: CPU+GPU"), lines))


# --- Table 2

def faces_of(bench, path):
    inputs = bench.ask("info", path, "--max-intersections", 0).get("input") or [{}]
    return inputs[0].get("triangles", 0)


def table2(bench, arguments, paths, kept):
    models = []
    for path in paths:
        row = kept.row("faces", path.name, lambda: {"name": path.name, "faces": faces_of(bench, path)})
        if 0 < row["faces"] < SMALL_FACES:
            models.append(path)
    listed, out = bench.path("models.csv"), bench.path("samples")
    with listed.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(("path", "id"))
        writer.writerows((path.resolve(), path.name.replace(".", "_")) for path in models)
    variants = -(-arguments.samples // len(models)) - 1
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    start = time.monotonic()
    subprocess.run([bench.program, "dataset", str(listed), "-o", str(out), "--resolution", str(VOXELS),
                    "--variants", str(variants), "--turn", "any", "--no-preview", "-q"], check=True)
    wall = time.monotonic() - start
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    cpu = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    with (out / "success.csv").open(newline="") as file:
        made = list(csv.DictReader(file))
    with (out / "failed.csv").open(newline="") as file:
        failed = len(list(csv.DictReader(file)))
    size = sum((out / name).stat().st_size for row in made for name in row["files"].split(";"))
    n = len(made)

    def stage(*names):
        return sum(float(row[f"{name}_seconds"] or 0) for row in made for name in names)

    # The clock of a busy machine tells the stages' shares; processor time is what they take.
    second = cpu / n / stage("read", "clean", "voxelize", "write")

    def line(title, names, *paper):
        seconds = second * stage(*names)
        return [title, f"{1e3 * seconds:.2f}", f"{seconds * MILLIONS * 1e6 / 3600:.0f}", *paper]

    lines = [line("reading and cleaning", ("read", "clean"), "-", "-"),
             line("voxelization", ("voxelize",), "0.10 (GPU)", "21.0 (GPU)"),
             line("packing and writing", ("write",), "-", "-"),
             ["transfers, allocation", "none", "none", "18.1 + 412.1", "16.3 + 462.5"]]
    return (f"{n} samples of {len(models)} models below {SMALL_FACES} faces ({failed} samples failed: models without an inside), each turned at "
            f"random, occupancy of {VOXELS}^3, packed and deflated, a file each. Times are processor time, of one core; {MILLIONS} million samples are "
            f"extrapolated.\n\n"
            + studies.table((f"of a sample", "ms", f"hours, {MILLIONS} million", "paper, hours", "Ogayar-Anguita et al., hours"), lines)
            + f"\n\nTogether {wall:.1f} s and {cpu:.1f} s of processor time on {os.cpu_count()} cores, {n / wall:.0f} samples a second: "
            f"{wall / n * MILLIONS * 1e6 / 3600:.0f} hours for {MILLIONS} million on this machine as busy as it was, "
            f"{cpu / n * MILLIONS * 1e6 / 3600:.0f} hours of one core. The files take {size / 1e6:.0f} MB, {size / n / 1e3:.1f} kB each: "
            f"{size / n * MILLIONS * 1e6 / 1e12:.2f} TB for {MILLIONS} million. Disk: {disk_of(bench.folder)}.")


# --- Table 3

def outcome_of(status):
    return "ok" if status in (0, 1) else "too late" if status in (5, studies.TOO_LATE) else "none"


def by_tetvdb(bench, path, mesher, output, *more):
    status, seconds, _, report = bench.run("voxelize", path, "-o", output, "--mesher", mesher, "--grid", "mask", *more)
    method = ((report.get("mesh") or {}).get("mesher") or {}).get("method", mesher)
    made = outcome_of(status)
    return {"outcome": made if method == mesher else "too late", "seconds": seconds}, report


def by_tetgen(bench, path, truth, voxel):
    made = studies.run_tetgen(bench, path, "-pkQ")
    result = {"outcome": made["outcome"] if made["outcome"] in ("ok", "too late") else "none",
              "seconds": made.get("seconds")}
    if result["outcome"] == "ok":
        volume = bench.path("tetgen.vdb")
        status = bench.run("voxelize", bench.path("cleaned.1.vtk"), "-o", volume, "--grid", "mask", "--voxel-size", voxel)[0]
        result["outcome"] = outcome_of(status)
        result["iou"] = studies.iou(bench, truth, volume) if status in (0, 1) else None
    return result


def by_covering(bench, path):
    result = bench.path("covering.json")
    done = subprocess.run([str(pathlib.Path(bench.program).parent / "tetvdb_bench"), "centroid", "--repeat", "1", "--mesh",
                           str(path), "--json", str(result)], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    if done.returncode != 0:
        return {"outcome": "none"}
    case = json.loads(result.read_text())["cases"][0]
    voxels, iou = re.search(r"by the peer (\d+): IoU ([\d.]+)", case["notes"][0]).groups()
    return {"outcome": "ok" if int(voxels) else "none", "iou": float(iou), "seconds": statistics.median(case["rows"][0]["peer_seconds"])}


def voxels_of(bench, path):
    """One row: each mesher's outcome, and its IoU with the volume by winding number."""
    bench.clear()
    truth, other = bench.path("truth.vdb"), bench.path("envelope.vdb")
    row = {"name": path.name}
    row["winding"], report = by_tetvdb(bench, path, "winding", truth, "--resolution", VOXELS)
    if row["winding"]["outcome"] != "ok":
        return row
    row["winding"]["iou"] = 1.0
    voxel = repr(report["grids"][0]["voxel_size"][0])
    row["envelope"], _ = by_tetvdb(bench, path, "envelope", other, "--epsilon", "1e-3d", "--voxel-size", voxel)
    if row["envelope"]["outcome"] == "ok":
        row["envelope"]["iou"] = studies.iou(bench, truth, other)
    if bench.tetgen:
        row["tetgen"] = by_tetgen(bench, path, truth, voxel)
    row["covering"] = by_covering(bench, path)
    return row


def table3(bench, arguments, paths, kept):
    rows = []
    for path in paths[:arguments.smallest]:
        rows.append(kept.row("voxels", path.name, lambda: voxels_of(bench, path)))
        print(f"3: {len(rows)} {path.name}", file=sys.stderr, flush=True)
    late = sum(row["winding"]["outcome"] == "too late" for row in rows)
    solids = [row for row in rows if row["winding"]["outcome"] != "none"]
    lines = []
    for mesher in MESHERS:
        results = [row.get(mesher, {"outcome": "none"}) for row in solids]
        if mesher == "tetgen" and not any("tetgen" in row for row in solids):
            continue
        outcomes = [r["outcome"] for r in results]
        near = [r.get("iou") or 0 for r in results]
        right = sum(v >= 0.9 for v in near)
        paper = {"envelope": ("10", "8", "99.4 %"), "tetgen": ("46", "1183", "59.1 %")}.get(mesher, ("", "", ""))
        lines.append([TITLES[mesher], outcomes.count("too late"), outcomes.count("none"), outcomes.count("ok"), right,
                      sum(v >= 0.99 for v in near), studies.percent(right, len(solids)), *paper])
    return (f"{len(solids)} of {len(rows)} files hold a solid ({len(rows) - len(solids)} cannot be read or have no inside"
            f"{f', {late} are not known in time' if late else ''}). Each is made to voxels, {VOXELS} along the longest side, within "
            f"{arguments.limit:g} s: by winding number, by our tets within 1e-3 of the diagonal, by TetGen's tets of the cleaned triangles "
            "(`tetgen -p`), and by the centroid covering, which always answers. Success is an IoU of 0.9 or more with the "
            "volume by winding number, which is that column's own measure; the paper's figures are of 3000 models of "
            "Thingi10k, 20 minutes each.\n\n"
            + studies.table(("mesher", "time limit", "no outcome", "voxels", "IoU 0.9", "IoU 0.99", "success",
                             "paper: time limit", "paper: no outcome", "paper: success"), lines))


# --- Epsilon

def epsilon(bench, arguments, paths, kept):
    rows = []
    names = kept.row("chosen", "models", lambda: {"name": "models",
                                                  "paths": [str(p) for p in studies.choose_models(bench, paths)]})["paths"]
    for path in map(pathlib.Path, names):
        rows.append(kept.row("epsilon", path.name, lambda: studies.study_epsilon(bench, path)))
        print(f"epsilon: {len(rows)} {path.name}", file=sys.stderr, flush=True)
    lines = []
    for value in studies.EPSILONS:
        found = [studies.at(row, value) for row in rows]
        ious = [r["iou"] for r in found if r.get("iou") is not None]
        spread = statistics.stdev(ious) if len(ious) > 1 else float("nan")
        lines.append([f"{value:g}", f"{studies.mean(r.get('epsilon_in_voxels') for r in found):.2f}", len(ious),
                      f"{studies.mean(ious):.4f}", f"{spread:.4f}", f"{min(ious):.4f}", f"{max(ious):.4f}"])
    return (f"{len(rows)} closed models without defects of 1000 to 30000 faces, {studies.VOXELS} voxels along the longest side. IoU of the volume "
            "by the envelope mesher with the exact one, on the same lattice, over the models that were meshed in time; the spread is "
            "the standard deviation. The paper reports small differences below 1e-2 and nearly none below 1e-3. Where a plane side of a model "
            "lies on voxel centres, any displacement of it adds or removes a layer of voxels, which explains the minima at small epsilons.\n\n"
            + studies.table(("epsilon / diagonal", "in voxels", "models", "mean IoU", "spread", "min", "max"), lines))


SECTIONS = {"1": ("Table 1: times", table1), "2": ("Table 2: five million samples", table2),
            "3": ("Table 3: success", table3), "epsilon": ("Error bounds", epsilon)}


def write_page(path, made):
    """Sections measured now in place of those that are there."""
    sections = dict(re.findall(r"^(## .*?)\n\n(.*?)\n*(?=^## |\Z)", path.read_text(), re.M | re.S)) if path.exists() else {}
    sections.update(made)
    order = ["## " + SECTIONS[table][0] for table in TABLES]
    path.write_text("\n\n".join([HEAD] + [f"{title}\n\n{sections[title].strip()}" for title in order if title in sections]) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("folder", nargs="?", type=pathlib.Path, help="with the triangle files, for all but table 1")
    parser.add_argument("--tables", default=",".join(TABLES), help="which ones (default %(default)s)")
    parser.add_argument("--build", type=pathlib.Path, default=studies.ROOT / "build/release")
    parser.add_argument("--out", type=pathlib.Path, default=studies.ROOT / "docs/paper_tables.md")
    parser.add_argument("--samples", type=int, default=10000, help="of table 2 (default %(default)s)")
    parser.add_argument("--limit", type=float, default=60, help="seconds of a model, table 3 and epsilon (default %(default)s)")
    parser.add_argument("--smallest", type=int, help="how many files of table 3, small ones first (default: all)")
    parser.add_argument("--results", type=pathlib.Path, help="where measurements are kept, a JSON object a line")
    arguments = parser.parse_args()
    arguments.tetgen_limit = None
    arguments.defaults = {name: parser.get_default(name) for name in ("samples", "limit", "smallest")}
    tables = arguments.tables.split(",")
    for table in tables:
        if table not in TABLES:
            parser.error(f"--tables knows {', '.join(TABLES)}, not {table}")
        if table != "1" and arguments.folder is None:
            parser.error(f"table {table} needs the folder with the triangle files")
    paths = sorted((p for p in arguments.folder.iterdir() if p.is_file()), key=lambda p: (p.stat().st_size, p.name)) \
        if arguments.folder else []
    kept = studies.Kept(arguments.results)
    for table in tables:
        title, measured = SECTIONS[table]
        with tempfile.TemporaryDirectory(prefix="tetvdb-tables-") as folder:
            text = measured(studies.Bench(arguments, folder), arguments, paths, kept)
        write_page(arguments.out, {"## " + title: f"{text}\n\n    {command_of(arguments, table)}\n\n{machine()}."})


if __name__ == "__main__":
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # what crashes here need not leave its memory
    main()
