# SPDX-License-Identifier: Apache-2.0
"""tetvdb.check: findings whose causes are made on purpose, and those of the program."""

import json
import os
import subprocess

import numpy as np
import pytest

import tetvdb
from conftest import cube_tets, cube_triangles

PRINTER = {"pixels": (160, 120), "display": (16, 12), "layer_height": 0.1}


def joined(*meshes):
    points, faces, first = [], [], 0
    for p, f in meshes:
        points.append(p)
        faces.append(f + first)
        first += len(p)
    return np.concatenate(points), np.concatenate(faces)


def post_and_island():
    return joined(cube_triangles((0, 0, 0), (3, 3, 2)), cube_triangles((5, 0, 1), (7, 2, 2)))


def codes(report):
    return [finding["code"] for finding in report["findings"]]


def test_islands():
    report = tetvdb.check(*post_and_island(), target="sla", checks="islands", **PRINTER)
    assert codes(report) == ["island"] and report["status"] == 8
    assert report["findings"][0]["height_mm"] == pytest.approx(1.05, abs=0.06)
    assert report["findings"][0]["area_mm2"] == pytest.approx(4, rel=0.05)
    clean = tetvdb.check(*cube_triangles((0, 0, 0), (3, 3, 2)), target="sla", **PRINTER)
    assert codes(clean) == [] and clean["status"] == 0


def test_thin_walls_by_their_limit():
    wall = cube_triangles((0, 0, 0), (5, 0.6, 3))
    for limit, found in ((0.5, False), (0.8, True)):
        report = tetvdb.check(*wall, target="fdm", min_wall=limit, checks=["walls"], **PRINTER)
        assert ("thin-wall" in codes(report)) == found


def test_findings_are_those_of_the_program(tmp_path):
    program = os.environ.get("TETVDB_PROGRAM")
    if not program:
        pytest.skip("TETVDB_PROGRAM names no program")
    path = tmp_path / "a.stl"
    from_arrays = tetvdb.voxelize(*post_and_island(), resolution=8, write_mesh=path)
    assert from_arrays
    done = subprocess.run([program, "check", path, "--target", "sla", "--pixels", "160,120",
                           "--display", "16,12", "--layer-height", "0.1", "--json", "-", "-q"],
                          capture_output=True, text=True)
    assert done.returncode == 8
    theirs = json.loads(done.stdout[done.stdout.index("{"):])
    ours = tetvdb.check(path, target="sla", picture=tmp_path / "a.png", **PRINTER)
    assert codes(ours) == codes(theirs) and ours["print"] == theirs["print"]
    assert (tmp_path / "a.png").read_bytes().startswith(b"\x89PNG")


def test_volumes(tmp_path):
    path = tmp_path / "a.vdb"
    tetvdb.voxelize(*cube_tets((0, 0, 0), (8, 8, 8)), voxel_size=1).write(path)
    assert tetvdb.check(path)["status"] == 0
    ids = tmp_path / "ids.vdb"
    tetvdb.voxelize(*cube_tets((0, 0, 0), (8, 8, 8)), voxel_size=1, grid="tet_id").write(ids)
    report = tetvdb.check([path, ids], target="houdini")
    assert all(set(f) == {"weight", "code", "file", "grid", "text", "cure"} for f in report["findings"])
    assert "sequence-grids" in codes(report)
    with pytest.raises(tetvdb.Error):
        tetvdb.check(tmp_path / "none.vdb")
    with pytest.raises(TypeError, match="min_wall is for printers"):
        tetvdb.check(path, min_wall=1)


@pytest.mark.parametrize("settings", [
    {"target": "laser"}, {"checks": "holes"}, {"connectivity": 6}, {"min_wall": -1},
    {"overhang_angle": "steep"}, {"aa": "some"}])
def test_settings_that_are_refused(settings):
    with pytest.raises(tetvdb.Error, match=f"`{next(iter(settings))}`"):
        tetvdb.check(*cube_triangles(), **{"target": "sla", **PRINTER, **settings})
