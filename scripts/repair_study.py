#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""What `tetvdb repair` keeps of meshes: prints the tables of docs/robustness.md, section Repair.

    scripts/repair_study.py --program build/release/bin/tetvdb [--corpus CORPUS/tri] [--spoiled] [--tsv RESULTS.tsv]
        [--every N] [--sample]

--corpus: files as they are found. Every file is repaired into an STL file. PrusaSlicer (`prusa-slicer --info`), which shares no code with the library,
says whether it is manifold; that column stays empty where it is not installed. Faces kept are those that the report
counts as the same as 32-bit floats, of the faces that cleaning left. Ends with status 1 where PrusaSlicer finds a result
that is not manifold.

--spoiled: clean closed models (tests/corpus/clean_meshes.py), spoiled in known ways (spoiled_meshes.py). Of a case whose
solid is defined, faces kept are the share of those of the clean model's faces that the spoiled file still has (of walls
that are doubled, either face); a defect is local if the file still has nine of ten; faces that have a point of the file on an edge, or lie where two copies
touch, cannot stay and do not count, and copies that overlap are not local. The output's faces and volume are
those that its file holds. The volume is compared with the clean model's, of copies that overlap with their union's. A loss of more than 1 % with
status 0 and no warning is silent. --every N takes every N-th file or case.

--sample: every 179th of the spoiled cases, or every 89th where TETVDB_TEST_SCALE is above 1. Ends with status 1 where
the volume's surface was needed for more than one, where fewer than 95 % of the local ones keep 99 % of their faces or of all their volume within 0.1 %, or where a loss is silent.
"""
import argparse
import collections
import json
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

try:
    import numpy
except ImportError as missing:
    print(f"SKIPPED: {missing} (Debian: apt-get install python3-numpy)")
    sys.exit(77)

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "corpus"))
import clean_meshes  # noqa: E402
import spoiled_meshes  # noqa: E402

TIME = 120  # seconds that a file may take
EVERY = 89 if int(os.environ.get("TETVDB_TEST_SCALE", "1")) > 1 else 179  # of --sample

Row = collections.namedtuple("Row", "name how why faces kept added removed status warnings manifold")


def slicer_says(path):
    if shutil.which("prusa-slicer") is None:
        return ""
    done = subprocess.run(["prusa-slicer", "--info", path], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    return "yes" if "manifold = yes" in done.stdout else "no"


def repaired(program, file, folder):
    out = folder / "out.stl"
    out.unlink(missing_ok=True)
    try:
        done = subprocess.run([program, "repair", file, "-o", out, "--json", "-", "-q"], stdout=subprocess.PIPE,
                              stderr=subprocess.PIPE, text=True, timeout=TIME)
    except subprocess.TimeoutExpired:
        return Row(file.name, "too slow", "", 0, 0, 0, 0, 5, "", "")
    report = json.loads(done.stdout) if done.stdout else {}
    if not out.exists():
        return Row(file.name, "refused", done.stderr.strip().rsplit(": ", 1)[-1], 0, 0, 0, 0, done.returncode, "", "")
    section = report["repair"]
    how = "remeshed" if section["remeshed"] else "in place" if section["local"] else "in order"
    changes = section["changes"]
    return Row(file.name, how, section["why"] or "", section["triangles_before"], changes["kept"], changes["added"],
               changes["removed"], done.returncode, " ".join(w["code"] for w in report["warnings"]), slicer_says(out))


def markdown(rows):
    lines = ["| | files | faces kept, median | PrusaSlicer: manifold | status 1 |", "|---|--:|--:|--:|--:|"]
    for how in ("in order", "in place", "remeshed", "refused", "too slow"):
        group = [row for row in rows if row.how == how]
        if not group:
            continue
        shares = sorted(row.kept / row.faces for row in group if row.faces)
        kept = f"{100 * shares[len(shares) // 2]:.1f} %" if shares else ""
        judged = [row for row in group if row.manifold]
        manifold = f"{sum(row.manifold == 'yes' for row in judged)} of {len(judged)}" if judged else ""
        lines.append(f"| {how} | {len(group)} | {kept} | {manifold} | {sum(row.status == 1 for row in group)} |")
    return "\n".join(lines)


Case = collections.namedtuple("Case", "model kind strength how why local kept volume status warnings")


def faces_of(points, faces):
    """Positions of the corners of each face, whichever comes first, as a set of bytes."""
    corners = points[faces] + 0.0
    order = numpy.lexsort((corners[:, :, 2], corners[:, :, 1], corners[:, :, 0]), axis=1)
    ordered = numpy.ascontiguousarray(numpy.take_along_axis(corners, order[:, :, None], axis=1))
    return {face.tobytes() for face in ordered}


def in_order_there(spoiled, clean):
    """Faces of the clean model that the spoiled file still has, without those that cannot stay: as a point of the file
    lies on an edge of theirs, or as they lie where two copies touch."""
    still = faces_of(spoiled.points, spoiled.faces) & faces_of(*clean)
    if spoiled.kind == "copies that touch":
        points, faces = clean
        first = points[:len(points) // 2]
        return still - faces_of(points, faces[(points[faces][:, :, 0] == first[:, 0].max()).all(axis=1)])
    if "T-junctions" not in spoiled.kind and spoiled.kind != "slivers in edges":
        return still
    there = {point.tobytes() for point in spoiled.points + 0.0}
    points, faces = clean
    on_edge = numpy.zeros(len(faces), dtype=bool)
    for k in range(3):
        p, q = points[faces[:, k]], points[faces[:, (k + 1) % 3]]
        for added in ((p + q) / 2, 0.6 * p + 0.4 * q, 0.6 * q + 0.4 * p):  # as spoiled_meshes.py puts them
            on_edge |= [row.tobytes() in there for row in added + 0.0]
    return still - faces_of(points, faces[on_edge])


def read_ply(path):
    """Points and faces of a binary .ply of doubles, as `tetvdb` writes it."""
    data = path.read_bytes()
    header, end = data[:data.index(b"end_header")].decode(), data.index(b"end_header") + len("end_header\n")
    points, faces = (int(header.split(f"element {name} ")[1].split()[0]) for name in ("vertex", "face"))
    assert "property double z\nelement face" in header and "list uchar" in header, header
    rows = numpy.frombuffer(data, [("n", "u1"), ("v", "<i4", 3)], faces, end + 24 * points)
    return numpy.frombuffer(data, "<f8", 3 * points, end).reshape(-1, 3), rows["v"].astype(numpy.int64)


def case_of(program, name, spoiled, folder):
    file, out = folder / "in.ply", folder / "out.ply"
    spoiled_meshes.write_ply(file, spoiled.points, spoiled.faces)
    out.unlink(missing_ok=True)
    overlap = spoiled.kind == "interpenetrating copies"  # the solid is their union
    truth = (clean_meshes.wound_volume if overlap else clean_meshes.signed_volume)(spoiled.truth)
    still = in_order_there(spoiled, spoiled.truth)
    local = "yes" if 10 * len(still) >= 9 * len(spoiled.truth[1]) and not overlap else "no"
    done = subprocess.run([program, "repair", file, "-o", out, "--json", "-", "-q", "--resolution", "128"],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    if not out.exists():
        return Case(name, spoiled.kind, spoiled.strength, "refused", done.stderr.strip()[-80:], local, 0, -1,
                    done.returncode, "")
    report = json.loads(done.stdout)
    section = report["repair"]
    how = "remeshed" if section["remeshed"] else "in place" if section["local"] else "in order"
    after = read_ply(out)
    # Of a wall and its double either is the wall.
    own = faces_of(spoiled.points, spoiled.faces) if spoiled.kind.startswith("doubled walls") else still
    kept = min(1, len(faces_of(*after) & own) / max(1, len(still)))
    return Case(name, spoiled.kind, spoiled.strength, how, section["why"] or "", local, kept,
                clean_meshes.signed_volume(after) / truth - 1, done.returncode,
                " ".join(w["code"] for w in report["warnings"]))


def cases_of(program, every, folder):
    number = 0
    for name, clean in clean_meshes.generated():
        for spoiled in spoiled_meshes.of(name, clean):
            number += not spoiled.undefined
            if not spoiled.undefined and number % every == 0:
                yield case_of(program, name, spoiled, folder)


def is_silent(case):
    return case.volume < -0.01 and case.status == 0 and not case.warnings


def falls_short(cases):
    local = [case for case in cases if case.local == "yes"]
    return (sum(case.how not in ("in order", "in place") for case in cases) > 1
            or sum(case.kept >= 0.99 for case in local) < 0.95 * len(local)
            or sum(abs(case.volume) <= 1e-3 for case in cases) < 0.95 * len(cases)
            or any(map(is_silent, cases)))


def spoiled_markdown(cases):
    groups = collections.defaultdict(list)
    for case in cases:
        groups[case.kind].append(case)
    groups["**all**"] = cases
    lines = ["| defect | cases | in order or in place | local | of these 99 % of the faces kept | volume within 0.1 % | "
             "a loss of 1 % or more, silent |", "|---|--:|--:|--:|--:|--:|--:|"]
    for kind, group in groups.items():
        local = [case for case in group if case.local == "yes"]
        kept = f"{100 * sum(case.kept >= 0.99 for case in local) / len(local):.1f} %" if local else ""
        lines.append(f"| {kind} | {len(group)} | {sum(case.how in ('in order', 'in place') for case in group)} | "
                     f"{len(local)} | {kept} | {100 * sum(abs(c.volume) <= 1e-3 for c in group) / len(group):.1f} % | "
                     f"{sum(map(is_silent, group))} |")
    return "\n".join(lines)


def write_tsv(path, rows):
    path.write_text("\n".join("\t".join(map(str, row)) for row in (rows[0]._fields, *rows)) + "\n")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--corpus", type=pathlib.Path)
    parser.add_argument("--spoiled", action="store_true")
    parser.add_argument("--program", default="build/release/bin/tetvdb")
    parser.add_argument("--tsv", type=pathlib.Path)
    parser.add_argument("--every", type=int, default=1)
    parser.add_argument("--sample", action="store_true")
    options = parser.parse_args()
    status = 0
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        if options.corpus:
            files = sorted(path for path in options.corpus.iterdir() if path.is_file())[::options.every]
            rows = [repaired(options.program, file, folder) for file in files]
            print(markdown(rows))
            status = 1 if any(row.manifold == "no" for row in rows) else 0
            if options.tsv:
                write_tsv(options.tsv, rows)
        if options.spoiled or options.sample:
            cases = list(cases_of(options.program, EVERY if options.sample else options.every, folder))
            print(spoiled_markdown(cases))
            if options.sample and falls_short(cases):
                print(*(case for case in cases if case.how == "remeshed" or case.kept < 0.99 or abs(case.volume) > 1e-3),
                      sep="\n")
                status = 1
            if options.tsv:
                write_tsv(options.tsv, cases)
    return status


if __name__ == "__main__":
    sys.exit(main())
