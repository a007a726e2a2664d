# SPDX-License-Identifier: Apache-2.0
"""Settings of the command line as keywords: fields, files besides, frames, exposure, devices."""

import os
import subprocess
import zipfile

import numpy as np
import pytest

import tetvdb
from conftest import cube_tets, cube_triangles


class Field:
    """A cube of side 8 with arrays whose values are known everywhere."""

    def __init__(self, shift=0.0):
        self.points, tets = cube_tets((0, 0, 0), (8, 8, 8))
        self.celltypes = np.full(6, 10, np.uint8)
        self.cells = np.insert(tets, 0, 4, axis=1).ravel()
        x, y, z = self.points.T
        self.point_data = {"height": 2 * z, "vel": np.stack((3 + 0 * x, 4 + 0 * x, 0 * x), axis=1),
                           "disp": np.stack((0 * x, 0 * x, shift + 0 * x), axis=1)}
        self.cell_data = {"kind": np.full(6, 5)}


def values_of(volume, name):
    return dict(zip(map(tuple, volume[name].sparse()[0].tolist()), volume[name].sparse()[1]))


def test_derived_and_remapped_fields():
    for derive, remap, clamp in (({"speed": "vel:magnitude"}, {"height": (0, 1)}, {"height": (2, 10)}),
                                 (["speed=vel:magnitude"], ["height=0:1"], "height=2:10")):
        v = tetvdb.voxelize(Field(), voxel_size=1, grid=["density", "height"], derive=derive,
                            remap=remap, clamp=clamp, background={"height": -1})
        assert np.allclose(list(values_of(v, "speed").values()), 5)
        for (x, y, z), value in values_of(v, "height").items():
            assert abs(value - (np.clip(2 * z, 2, 10) - 2) / 8) < 1e-5
        outside = v["height"].to_numpy(box=((-2, -2, -2), (-2, -2, -2)))
        assert outside[0, 0, 0] == -1


def test_warp():
    still = tetvdb.voxelize(Field(shift=3.0), voxel_size=1)
    moved = tetvdb.voxelize(Field(shift=3.0), voxel_size=1, warp="disp*2")
    low, high = np.array(still["density"].box)
    assert (np.array(moved["density"].box) == (low + (0, 0, 6), high + (0, 0, 6))).all()


@pytest.mark.parametrize("settings", [
    {"derive": "vel"}, {"derive": {"a": "vel:colour"}}, {"remap": "0"}, {"remap": {"height": "x:y"}},
    {"clamp": (3, 1)}, {"background": "some"}, {"warp": "disp*"}, {"warp": "height"},
    {"device": "cuda:"}, {"device": "cuda:1,1"}, {"device": "cuda:x"}, {"device": "tpu"}])
def test_settings_that_are_refused(settings):
    with pytest.raises(tetvdb.Error) as caught:
        tetvdb.voxelize(Field(), voxel_size=1, grid=["density", "height"], **settings)
    assert caught.value.status in (2, 3)
    assert f"`{next(iter(settings))}`" in str(caught.value) or "vel" in str(caught.value) \
        or "height" in str(caught.value)


def test_fields_without_arrays():
    with pytest.raises(tetvdb.Error, match="`remap`: is for grids made of arrays"):
        tetvdb.voxelize(Field(), voxel_size=1, remap="0:1")


def test_numbered_devices_are_asked_for():
    """Where there is no such GPU, the refusal names it; where there is, the job is done."""
    try:
        volume = tetvdb.voxelize(*cube_tets((0, 0, 0), (8, 8, 8)), voxel_size=1, device="cuda:63")
    except tetvdb.Error as error:
        assert error.code == "device"
    else:
        assert volume["density"].active_voxels == 512


def test_mesh_and_picture_besides(tmp_path):
    mesh, picture = tmp_path / "a.vtu", tmp_path / "a.png"
    v = tetvdb.voxelize(Field(), voxel_size=1, write_mesh=mesh, preview=picture)
    assert v["density"].active_voxels == 512
    assert picture.read_bytes().startswith(b"\x89PNG")
    again = tetvdb.voxelize(mesh, voxel_size=1, grid="height")
    assert all(abs(value - 2 * z) < 1e-5 for (x, y, z), value in values_of(again, "height").items())
    assert v.report["preview"]["path"] == str(picture)
    cleaned = tmp_path / "a.off"
    tetvdb.voxelize(*cube_triangles(), resolution=4, write_mesh=cleaned)
    assert tetvdb.info(cleaned)["triangles"] == 12


def test_arrays_that_are_written(tmp_path):
    v = tetvdb.voxelize(*cube_tets((0, 0, 0), (8, 8, 8)), voxel_size=1, grid="mask")
    whole, part, sparse = (tmp_path / f"{name}.npz" for name in ("whole", "part", "sparse"))
    v.write(whole, compress=True)
    v.write(part, box=((-1, 0, 0), (3, 9, 2)))
    v.write(sparse, sparse=True)
    assert np.load(whole)["mask"].sum() == 512
    with zipfile.ZipFile(whole) as file:
        assert {entry.compress_type for entry in file.infolist()} == {zipfile.ZIP_DEFLATED}
    assert np.load(part)["mask"].shape == (5, 10, 3)
    coordinates, _ = v["mask"].sparse()
    found = [a for a in np.load(sparse).values() if a.shape == coordinates.shape]
    assert len(found) == 1 and (found[0] == coordinates).all()
    with pytest.raises(tetvdb.Error, match="`compress`"):
        v.write(tmp_path / "a.vdb", compress=True)


def write_frames(folder):
    for number in (1, 2, 3):
        tetvdb.voxelize(Field(shift=float(number)), voxel_size=1,
                        write_mesh=folder / f"run_{number}.vtu")


def test_frames(tmp_path):
    write_frames(tmp_path)
    report = tetvdb.voxelize_frames(tmp_path / "run_*.vtu", tmp_path / "out.vdb", voxel_size=1,
                                    grid=["density", "height"], warp="disp", remap={"height": (0, 1)})
    assert [frame["output"] for frame in report["frames"]] == \
        [str(tmp_path / f"out.000{i}.vdb") for i in (1, 2, 3)]
    for i, frame in enumerate(report["frames"], 1):
        v = tetvdb.read(frame["output"])
        direct = tetvdb.voxelize(tmp_path / f"run_{i}.vtu", voxel_size=1, warp="disp")
        assert v["density"].box == direct["density"].box
        assert max(v["height"].sparse()[1]) <= 1
    again = tetvdb.voxelize_frames([tmp_path / f"run_{i}.vtu" for i in (1, 2, 3)],
                                   tmp_path / "out.vdb", voxel_size=1, frames="2:3")
    assert len(again["frames"]) == 2
    with pytest.raises(tetvdb.Error, match="no sequence"):
        tetvdb.voxelize_frames(tmp_path / "run_1.vtu", tmp_path / "one.vdb")
    with pytest.raises(tetvdb.Error, match="`frames`"):
        tetvdb.voxelize_frames(tmp_path / "run_*.vtu", tmp_path / "out.vdb", frames="x")
    with pytest.raises(TypeError):
        tetvdb.voxelize_frames(tmp_path / "run_*.vtu", tmp_path / "out.vdb", resolutoin=3)


def test_frames_are_those_of_the_program(tmp_path):
    program = os.environ.get("TETVDB_PROGRAM")
    if not program:
        pytest.skip("TETVDB_PROGRAM names no program")
    write_frames(tmp_path)
    pattern = str(tmp_path / "run_*.vtu")
    tetvdb.voxelize_frames(pattern, tmp_path / "a.vdb", voxel_size=0.5, grid="density,height",
                           derive={"speed": "vel:magnitude"})
    subprocess.run([program, "voxelize", pattern, "-o", tmp_path / "b.vdb", "--voxel-size", "0.5",
                    "--grid", "density,height", "--derive", "speed=vel:magnitude", "-q"], check=True)
    for i in (1, 2, 3):
        assert tetvdb.read(tmp_path / f"a.000{i}.vdb").hash() == \
            tetvdb.read(tmp_path / f"b.000{i}.vdb").hash()


def test_regions_of_info(tmp_path):
    path = tmp_path / "a.vtu"
    tetvdb.voxelize(Field(), voxel_size=1, write_mesh=path)
    assert tetvdb.info(path, region_array="kind")["tets"] == 6
    with pytest.raises(tetvdb.Error, match="'sort'"):
        tetvdb.info(path, region_array="sort")


def test_exposure_of_layers(tmp_path):
    path = tmp_path / "box.sl1"
    settings = {"pixels": (20, 16), "display": (20, 16), "layer_height": 1}
    tetvdb.slice(*cube_triangles((0, 0, 0), (8, 6, 4)), output=path, exposure=2.5,
                 bottom_exposure=30, bottom_layers=2, transition_layers=1, lift_height=6,
                 lift_speed=90, retract_speed=120, light_off_delay=1, **settings)
    with zipfile.ZipFile(path) as file:
        config = dict(line.split(" = ", 1) for line in file.read("config.ini").decode().splitlines())
    assert float(config["expTime"]) == 2.5 and float(config["expTimeFirst"]) == 30
    for wrong in ({"exposure": -1}, {"bottom_layers": 0.5}, {"lift_speed": "fast"}):
        with pytest.raises(tetvdb.Error, match=f"`{next(iter(wrong))}`"):
            tetvdb.slice(*cube_triangles((0, 0, 0), (8, 6, 4)), **settings, **wrong)


def test_a_prepared_mesh(tmp_path):
    source, parts = tmp_path / "cube.vtu", tmp_path / "cube.parts"
    tetvdb.voxelize(Field(), voxel_size=1, write_mesh=source)
    grids = {"grid": ["tet_id", "height"], "derive": {"speed": "vel:magnitude"}}
    for memory in (None, "1G"):  # the second in place of the first
        report = tetvdb.prepare_mesh(source, parts, voxel_size=0.25, max_memory=memory, **grids)
    assert report["command"] == "plan" and report["status"] == 0
    prepared = report["prepared"]
    assert prepared["path"] == str(parts) and prepared["tets"] == 6 and prepared["points"] == 8
    assert set(prepared["arrays"]) == {"height", "vel"}
    assert prepared["voxel_size"] == [0.25] * 3
    report = tetvdb.voxelize_file(parts, tmp_path / "parts.vdb", max_memory="1G", **grids)
    assert [grid["name"] for grid in report["grids"]] == ["tet_id", "height", "speed"]
    whole = tetvdb.voxelize(source, voxel_size=0.25, **grids)
    assert tetvdb.read(tmp_path / "parts.vdb").hash() == whole.hash()
    tetvdb.voxelize_file(str(source), tmp_path / "whole.vdb", voxel_size=0.25, **grids)
    assert (tmp_path / "parts.vdb").read_bytes() == (tmp_path / "whole.vdb").read_bytes()
    for setting in ({"resolution": 9}, {"voxel_size": 1}, {"region": 1}):
        with pytest.raises(tetvdb.Error, match="prepared"):
            tetvdb.voxelize_file(parts, tmp_path / "other.vdb", **setting)
    with pytest.raises(tetvdb.Error, match="prepared"):
        tetvdb.voxelize_file([parts, source], tmp_path / "other.vdb")
    assert not (tmp_path / "other.vdb").exists()


def test_what_cannot_be_prepared(tmp_path):
    source = tmp_path / "cube.vtu"
    tetvdb.voxelize(Field(), voxel_size=1, write_mesh=source)
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "text").write_text("mine")
    with pytest.raises(tetvdb.Error, match="mine") as caught:
        tetvdb.prepare_mesh(source, tmp_path / "mine", voxel_size=1)
    assert caught.value.status == 2
    with pytest.raises(tetvdb.Error, match="none.vtu"):
        tetvdb.prepare_mesh(tmp_path / "none.vtu", tmp_path / "new", voxel_size=1)
    with pytest.raises(tetvdb.Error, match="height2"):
        tetvdb.prepare_mesh(source, tmp_path / "new", voxel_size=1, grid="height2")
    with pytest.raises(TypeError):
        tetvdb.prepare_mesh(source, tmp_path / "new", voxel_size=1, half_width=3)
    assert not (tmp_path / "new").exists()


def test_files_are_those_of_the_program(tmp_path):
    program = os.environ.get("TETVDB_PROGRAM")
    if not program:
        pytest.skip("TETVDB_PROGRAM names no program")
    source = tmp_path / "cube.vtu"
    tetvdb.voxelize(Field(), voxel_size=1, write_mesh=source)
    for name, grids in (("a.vdb", "density,height"), ("a.nvdb", "mask,surface"), ("a.npz", "coverage")):
        report = tetvdb.voxelize_file(source, tmp_path / name, voxel_size=0.5, grid=grids)
        assert report["output"][0]["path"] == str(tmp_path / name)
        subprocess.run([program, "voxelize", source, "-o", tmp_path / ("b" + name[1:]), "--voxel-size", "0.5",
                        "--grid", grids, "-q"], check=True)
        assert (tmp_path / name).read_bytes() == (tmp_path / ("b" + name[1:])).read_bytes()
