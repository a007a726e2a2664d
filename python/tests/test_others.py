# SPDX-License-Identifier: Apache-2.0
import json
import os
import subprocess

import numpy as np
import pytest

import tetvdb
from conftest import cube_tets, cube_triangles, sphere_triangles


def signed_volume(mesh):
    a, b, c = (mesh.vertices[mesh.faces[:, i]] for i in range(3))
    return np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6


def edges_close(faces):
    edges = np.concatenate((faces[:, [0, 1]], faces[:, [1, 2]], faces[:, [2, 0]]))
    forward = {tuple(e) for e in edges}
    return len(forward) == len(edges) and all((b, a) in forward for a, b in forward)


def test_repair_of_what_is_in_order_changes_nothing():
    points, faces = sphere_triangles(rings=8, sectors=12)
    mesh = tetvdb.repair(points, faces)
    assert (mesh.vertices == points).all() and (mesh.faces == faces).all()
    assert mesh.report["command"] == "repair" and mesh.report["repair"]["remeshed"] is False


def test_repair_closes_a_hole():
    points, faces = cube_triangles()
    mesh = tetvdb.repair(points, faces[1:])
    assert edges_close(mesh.faces) and abs(signed_volume(mesh) - 1) < 1e-12


def test_repair_of_a_volume():
    volume = tetvdb.voxelize(*sphere_triangles(), resolution=40, grid="surface")
    mesh = tetvdb.repair(volume)
    assert edges_close(mesh.faces)
    assert abs(signed_volume(mesh) / 4.14 - 1) < 0.02


def test_info_of_triangles():
    points, faces = cube_triangles()
    about = tetvdb.info(points, faces)
    assert about["kind"] == "triangles" and about["triangles"] == 12
    assert about["volume"] == pytest.approx(1) and about["area"] == pytest.approx(6)
    assert about["defects"]["watertight"] is True
    assert tetvdb.info(points, faces[1:])["defects"]["boundary_edges"] == 3


def test_info_of_tets_and_volumes():
    about = tetvdb.info(*cube_tets((0, 0, 0), (2, 2, 2)))
    assert (about["kind"], about["tets"], about["volume"]) == ("tets", 6, pytest.approx(8))
    volume = tetvdb.voxelize(*cube_tets(), resolution=8)
    about = tetvdb.info(volume, hash=True)
    assert about["hash"] == volume.hash()
    assert [g["active_voxels"] for g in about["grids"]] == [512]


def test_info_is_that_of_the_program(tmp_path):
    program = os.environ.get("TETVDB_PROGRAM")
    if not program:
        pytest.skip("TETVDB_PROGRAM names no program")
    path = tmp_path / "cube.stl"
    tetvdb.repair(*cube_triangles()).write(path)
    text = subprocess.run([program, "info", path, "--json", "-", "-q"], check=True,
                          capture_output=True, text=True).stdout
    start = text.index("{")
    assert tetvdb.info(path) == json.loads(text[start:])["input"][0]


def test_render():
    image = tetvdb.render(*sphere_triangles(), size=(120, 90), background="white")
    assert image.shape == (90, 120, 3) and image.dtype == np.uint8
    assert (image[0, 0] == 255).all()
    shown = (image != 255).any(axis=2)
    # A circle: as high as wide, about pi / 4 of its square.
    rows, columns = shown.any(axis=1).sum(), shown.any(axis=0).sum()
    assert abs(int(rows) - int(columns)) <= 3
    assert abs(shown.sum() / (rows * columns) - np.pi / 4) < 0.03
    through = tetvdb.render(*sphere_triangles(), size=(64, 64), background="transparent")
    assert through.shape == (64, 64, 4) and through[0, 0, 3] == 0
    turned = tetvdb.render(*sphere_triangles(), size=(40, 30), turntable=3)
    assert turned.shape == (3, 30, 40, 3)
    with pytest.raises(tetvdb.Error) as caught:
        tetvdb.render(*sphere_triangles(), color="heat")
    assert caught.value.status == 2


def test_render_of_a_volume():
    volume = tetvdb.voxelize(*sphere_triangles(), resolution=32)
    assert tetvdb.render(volume, size=(64, 48), style="voxels").std() > 5
    assert tetvdb.render(volume, size=(64, 48), slice="z=0.5").shape == (48, 64, 3)


def test_slice_of_a_box():
    points, faces = cube_triangles((0, 0, 0), (8, 6, 4))
    layers, report = tetvdb.slice(points, faces, pixels=(20, 16), display=(20, 16), layer_height=1)
    assert layers.shape == (4, 16, 20) and layers.dtype == np.uint8
    expected = np.zeros((16, 20), np.uint8)
    expected[5:11, 6:14] = 255
    assert (layers == expected).all()
    assert report["slices"]["layers"] == 4
    assert report["slices"]["volume_mm3"] == pytest.approx(192)


def test_slice_into_a_file(tmp_path):
    path = tmp_path / "box.sl1"
    layers, report = tetvdb.slice(*cube_triangles((0, 0, 0), (8, 6, 4)), output=path,
                                  pixels=(20, 16), display=(20, 16), layer_height=1)
    assert layers is None and path.stat().st_size == report["output"][0]["bytes"]


def test_slice_that_does_not_fit():
    with pytest.raises(tetvdb.Error) as caught:
        tetvdb.slice(*cube_triangles((0, 0, 0), (80, 6, 4)), pixels=(20, 16), display=(20, 16),
                     layer_height=1)
    assert caught.value.status == 4
