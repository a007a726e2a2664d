# SPDX-License-Identifier: Apache-2.0
"""What `tetvdb info` finds in mesh files, judged by VTK's readers: nothing of the library in it.

    judge_readers.py [FOLDER...]    every file of the folders that VTK reads too

Without folders: files that VTK and h5py write here, every kind of cell in .vtp, .vtm, VTKHDF, CGNS,
EnSight Gold, .frd and .neu. Skipped (77) where VTK's or OpenVDB's Python modules, numpy or h5py are missing.
"""

import json
import os
import pathlib
import subprocess
import sys
import tempfile

try:
    import numpy as np
    try:
        import openvdb as vdb
    except ImportError:
        import pyopenvdb as vdb
    import vtk_oracle
    import written_meshes
except ImportError as error:
    print("skipped: %s" % error)
    sys.exit(77)

PROGRAM = os.environ["TETVDB_PROGRAM"]


def report_of(paths):
    """Of one run of `tetvdb info`; files that are refused have an "error"."""
    done = subprocess.run([PROGRAM, "info", *map(str, paths), "--json", "-", "--max-intersections", "0"],
                          stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
    assert done.returncode >= 0, "killed by signal %d" % -done.returncode
    report = json.loads(done.stdout)
    assert [section["path"] for section in report["input"]] == list(map(str, paths)), done.stderr
    return report


def near(ours, theirs, slack):
    return abs(ours - theirs) <= slack


def range_of(section, on, name):
    """The range of an array, or of the arrays that hold its components one by one."""
    arrays = [a for a in section.get("attributes", []) if a["on"] == on]
    same = [a for a in arrays if a["name"] == name] or [
        a for a in arrays if a["name"] in (name + "X", name + "Y", name + "Z")]
    same = [a for a in same if a["min"] is not None]
    return (min(a["min"] for a in same), max(a["max"] for a in same)) if same else None


def differences(section, found, skip=()):
    """Sentences about what differs; none where the file was read as VTK reads it."""
    wrong = []
    if section["vertices"] != found.points:
        wrong.append("%d points in place of %d" % (section["vertices"], found.points))
    if (section["kind"] == "tets") != (found.solids > 0):
        return wrong + ["taken for %s, with %d solid cells" % (section["kind"], found.solids)]
    if section["kind"] == "triangles":
        # Polygons that are not flat have another area by another cut.
        if not near(section["area"], found.area, 1e-3 * found.area):
            wrong.append("has the area %r in place of %r" % (section["area"], found.area))
        return wrong
    solids = sum(count for kind, count in section["cells"].items() if kind not in FLAT)
    if solids != found.solids:
        wrong.append("%s in place of %d solid cells" % (section["cells"], found.solids))
    if not near(section["volume"], found.volume, 2 * found.slack + 1e-6 * found.volume):
        wrong.append("volume %r in place of %r" % (section["volume"], found.volume))
    for (on, name), (least, most) in found.ranges.items():
        if name in skip:
            continue
        ours = range_of(section, on, name)
        if ours is None:
            wrong.append("no array %r on %s" % (name, on))
            continue
        slack = 1e-6 * max(abs(least), abs(most), 1e-30)
        if not (near(ours[0], least, slack) and near(ours[1], most, slack)):
            wrong.append("%r on %s goes from %r to %r in place of %r to %r"
                         % (name, on, *ours, least, most))
    return wrong


FLAT = {"vertex", "poly-vertex", "line", "poly-line", "triangle", "triangle-strip", "polygon", "pixel", "quad",
        "point", "bar2", "bar3", "tria3", "tria6", "quad4", "quad8", "nsided", "ghost", "tr3", "tr6", "qu4",
        "qu8", "be2", "be3", "edge", "quadrilateral", "NODE", "BAR_2", "TRI_3", "QUAD_4", "TRI_6", "QUAD_8",
        "QUAD_9", "BAR_3", "NGON_n", "triangle6", "quad8", "quad9", "line3", "vertices"}


def voxel_differences(one):
    """The curved cells' volume, and T in the voxels, which is linear in space."""
    out = one.path.parent / "out.vdb"
    named = "coverage" if "T" in one.missing else "coverage,T"
    done = subprocess.run([PROGRAM, "voxelize", str(one.path), "-o", str(out), "--voxel-size", "0.07", "--grid", named,
                           "--json", "-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120)
    if done.returncode != 0:
        return [done.stderr.decode(errors="replace").strip()]
    wrong = []
    filled = {grid["name"]: grid for grid in json.loads(done.stdout)["grids"]}["coverage"]["filled"]
    if not near(filled, one.volume, 2e-5 * one.volume):
        wrong.append("fills %r in place of %r" % (filled, one.volume))
    if "T" not in one.missing:
        grid = vdb.read(str(out), "T")
        worst = max((abs(voxel.value - np.dot([1, 10, 100], grid.transform.indexToWorld(voxel.min)))
                     for voxel in grid.citerOnValues() if voxel.count == 1), default=np.inf)
        if not worst < 2e-3:
            wrong.append("T is off by %r in voxels" % worst)
    return wrong


def judge_folder(folder):
    failed = judged = 0
    for path in sorted(pathlib.Path(folder).rglob("*")):
        if path.suffix not in vtk_oracle.READERS or not path.is_file():
            continue
        try:
            found = vtk_oracle.look(path)
            if found.points == 0:
                raise ValueError("VTK reads no points")
        except Exception as error:
            print("%s: VTK does not read it: %s" % (path, error))
            continue
        report = report_of([path])
        section, warnings = report["input"][0], report["warnings"]
        if "error" in section:
            print("%s: REFUSED %s (VTK: %d points, %d solid cells)"
                  % (path, section["error"], found.points, found.solids))
            failed += found.solids > 0 or found.faces > 0
            continue
        wrong = differences(section, found)
        judged += 1
        failed += bool(wrong)
        print("%s: %s" % (path, "; ".join(wrong) or "same"), [w["code"] for w in warnings] or "")
    print("%d judged, %d differ" % (judged, failed))
    return failed


def main():
    if len(sys.argv) > 1:
        sys.exit(min(1, sum(judge_folder(folder) for folder in sys.argv[1:])))
    failed = judged = curved = 0
    with tempfile.TemporaryDirectory() as folder:
        written = list(written_meshes.write_all(pathlib.Path(folder)))
        sections = []
        for first in range(0, len(written), 50):  # a start of the program costs more than a file
            sections += report_of([one.path for one in written[first:first + 50]])["input"]
        for one, section in zip(written, sections):
            if "error" in section:
                wrong = [section["error"]]
            else:
                wrong = differences(section, one.found, one.missing)
                if one.volume > 0:
                    wrong += voxel_differences(one)
                    curved += 1
            judged += 1
            if wrong:
                failed += 1
                print("%s: %s" % (one.name, "; ".join(wrong)))
    print("%d files judged, %d of them voxelized, %d differ" % (judged, curved, failed))
    assert judged > 400 and curved > 100, (judged, curved)
    sys.exit(1 if failed else 0)


if __name__ == "__main__":
    main()
