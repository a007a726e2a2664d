#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Results of cleaning on models of known solids.

    TETVDB_CLEANING_JUDGE=build/release/bin/cleaning_judge scripts/cleaning_study.py [--corpus FOLDER]
        [--before RESULTS.tsv] [--tsv RESULTS.tsv] [--markdown TABLE.md] [--write FOLDER] [--sample] [KIND...]

Clean closed models (tests/corpus/clean_meshes.py, and with --corpus the files of FOLDER that are listed in
CLEAN_FILES) are spoiled in known ways (spoiled_meshes.py), cleaned and voxelized at 64^3; the solid is compared with
the clean model's. A case is right at an intersection over union of 0.99 or more; a part is lost where a tenth of the
volume or more is missing, silently where the status is 0. Cases whose solid does not follow from the file any more are
counted apart. --write also writes every spoiled mesh as PLY. --sample takes every 29th case and fails where fewer than
99 % are right or a part is lost silently.
"""
import argparse
import collections
import os
import pathlib
import struct
import subprocess
import sys

try:
    import numpy
except ImportError as missing:
    print(f"SKIPPED: {missing} (Debian: apt-get install python3-numpy)")
    sys.exit(77)

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parent.parent / "tests" / "corpus"))
import clean_meshes  # noqa: E402
import spoiled_meshes  # noqa: E402
import tri_oracle  # noqa: E402

RESOLUTION = 64
RIGHT = 0.99
LOST = 0.1
EVERY = 29  # of --sample
CLEAN_FILES = ["ForgeScan__abc5.stl", "PrusaSlicer__two_hollow_squares.obj", "PyMeshLab__bone.ply",
    "cgal__triceratops.off", "franka_ros__link0.stl", "manifold__472042.stl", "manifold__65004.stl",
    "manifold__72214.stl", "manifold__88566.stl", "numpy-stl__StarWithEmptyHeader.stl",
    "trimesh__fuze_ascii.ply", "wildmeshing__37322.stl"]  # that `info` calls watertight


class Judge:
    def __init__(self, program):
        self.process = subprocess.Popen([program, str(RESOLUTION)], stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def ask(self, kind, points, faces):
        send = self.process.stdin
        send.write(struct.pack("=qqq", kind, len(points), len(faces)))
        send.write(numpy.ascontiguousarray(points, dtype="<f8").tobytes())
        send.write(numpy.ascontiguousarray(faces, dtype="<i4").tobytes())
        send.flush()
        line = self.process.stdout.readline().decode().split()
        if len(line) != 8:
            sys.exit("the judge has ended")
        return line


Case = collections.namedtuple("Case", "model kind strength undefined status iou lost gained clean_s voxelize_s warnings")


def case_of(name, spoiled, line):
    status, clean, voxels, common = (int(number) for number in line[:4])
    union = clean + voxels - common
    return Case(name, spoiled.kind, spoiled.strength, spoiled.undefined, status, common / union if union else 1.0,
                1 - common / clean, voxels / clean - common / clean, float(line[4]), float(line[5]), line[7])


def welded(path):
    """The triangles of a file over its distinct points."""
    file = tri_oracle.read(str(path))
    points, place = numpy.unique(numpy.array(file.points, dtype=float) + 0.0, axis=0, return_inverse=True)
    place = place.reshape(-1)
    faces = [[place[polygon[0]], place[polygon[j]], place[polygon[j + 1]]]
             for polygon in file.polygons for j in range(1, len(polygon) - 1)]
    return points, numpy.array(faces, dtype=numpy.int64)


def clean_models(corpus):
    yield from clean_meshes.generated()
    for file in CLEAN_FILES if corpus else []:
        points, faces = welded(corpus / file)
        assert clean_meshes.is_closed((points, faces)), file
        yield file, (points, faces)


def measure(options, judge):
    number = 0
    for name, clean in clean_models(options.corpus):
        judged = None
        for spoiled in spoiled_meshes.of(name, clean, options.kinds or None):
            number += 1
            if options.sample and number % EVERY != 0:
                continue
            if judged is not spoiled.truth:
                judge.ask(0, *spoiled.truth)
                judged = spoiled.truth
            if options.write:
                label = "".join(c if c.isalnum() or c in ".-" else "_"
                                for c in f"{name}-{spoiled.kind}-{spoiled.strength}")
                spoiled_meshes.write_ply(options.write / (label + ".ply"), spoiled.points, spoiled.faces)
            yield case_of(name, spoiled, judge.ask(1, spoiled.points, spoiled.faces))


def is_lost(case):
    return case.lost >= LOST and case.status == 0


def summary(cases):
    right = sum(case.iou >= RIGHT for case in cases)
    return right, sum(is_lost(case) for case in cases), sum(case.lost >= LOST and case.status != 0 for case in cases)


def write_tsv(path, cases):
    with open(path, "w") as out:
        out.write("\t".join(Case._fields) + "\n")
        for case in cases:
            out.write("\t".join(f"{v:.6g}" if isinstance(v, float) else str(v) for v in case) + "\n")


def read_tsv(path):
    with open(path) as lines:
        next(lines)
        for line in lines:
            v = line.rstrip("\n").split("\t")
            yield Case(v[0], v[1], v[2], v[3], int(v[4]), *map(float, v[5:10]), v[10])


def markdown(cases, before):
    """A table by kind of defect; `before`: cases of an earlier state, for the columns beside."""
    def groups(of):
        table = collections.defaultdict(list)
        for case in of:
            if not case.undefined:
                table[case.kind].append(case)
        table["**all**"] = [case for case in of if not case.undefined]
        return table
    now, then = groups(cases), groups(before)
    lines = ["| defect | cases |" + (" correct before | silent losses before |" if before else "") +
             " correct | silent losses | reported losses |",
             "|---|--:|" + ("--:|--:|" if before else "") + "--:|--:|--:|"]
    for kind, group in now.items():
        line = f"| {kind} | {len(group)} |"
        if before:
            right, lost, _ = summary(then[kind])
            line += f" {100 * right / max(1, len(then[kind])):.1f} % | {lost} |"
        right, lost, said = summary(group)
        lines.append(line + f" {100 * right / max(1, len(group)):.1f} % | {lost} | {said} |")
    unclear = [case for case in cases if case.undefined]
    reasons = collections.Counter(case.undefined for case in unclear)
    lines.append("")
    for reason, count in reasons.most_common():
        lines.append(f"- Not counted, {count} cases: {reason}.")
    return "\n".join(lines) + "\n"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--corpus", type=pathlib.Path)
    parser.add_argument("--before", type=pathlib.Path)
    parser.add_argument("--tsv", type=pathlib.Path)
    parser.add_argument("--markdown", type=pathlib.Path)
    parser.add_argument("--write", type=pathlib.Path)
    parser.add_argument("--sample", action="store_true")
    parser.add_argument("kinds", nargs="*")
    options = parser.parse_args()
    if options.write:
        options.write.mkdir(parents=True, exist_ok=True)
    judge = Judge(os.environ.get("TETVDB_CLEANING_JUDGE", "build/release/bin/cleaning_judge"))
    cases = []
    for case in measure(options, judge):
        cases.append(case)
        if case.iou < RIGHT and not case.undefined:
            print(f"{case.model:18} {case.kind:34} {case.strength:18} IoU {case.iou:.3f} lost {case.lost:.3f} "
                  f"gained {case.gained:.3f} status {case.status} {case.warnings}", flush=True)
    defined = [case for case in cases if not case.undefined]
    right, lost, said = summary(defined)
    print(f"{right} of {len(defined)} right ({100 * right / max(1, len(defined)):.2f} %); a part lost: {lost} silently, "
          f"{said} with status; {len(cases) - len(defined)} not defined; cleaning "
          f"{sum(c.clean_s for c in cases):.2f} s, voxelizing {sum(c.voxelize_s for c in cases):.2f} s")
    if options.tsv:
        write_tsv(options.tsv, cases)
    if options.markdown:
        before = list(read_tsv(options.before)) if options.before else []
        options.markdown.write_text(markdown(cases, before))
    if options.sample and (right < 0.99 * len(defined) or lost > 0):
        sys.exit(1)


if __name__ == "__main__":
    main()
