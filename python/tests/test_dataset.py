# SPDX-License-Identifier: Apache-2.0
"""tetvdb.Dataset: the items of `tetvdb dataset`, whatever reads them in whatever process."""

import multiprocessing
import os
import pickle
import subprocess
import warnings

import numpy as np
import pytest

import tetvdb
from conftest import cube_triangles, sphere_triangles


def write_obj(path, points, faces):
    path.parent.mkdir(parents=True, exist_ok=True)
    lines = ["v %r %r %r" % tuple(map(float, p)) for p in points]
    lines += ["f %d %d %d" % tuple(int(i) + 1 for i in f) for f in faces]
    path.write_text("\n".join(lines) + "\n")


@pytest.fixture
def models(tmp_path):
    """Nine solids of three classes."""
    folder = tmp_path / "models"
    for i in range(3):
        write_obj(folder / "box" / "train" / f"b{i}.obj", *cube_triangles((0, 0, 0), (4, 2, i + 1)))
        points, faces = sphere_triangles(rings=6 + i, sectors=9)
        write_obj(folder / "ball" / "test" / f"s{i}.obj", points + (i, 5, 0), faces)
        write_obj(folder / "open" / f"o{i}.obj", *[points, faces[i + 1:]])
    return folder


SETTINGS = {"resolution": [12, 20], "content": "occupancy,distance,surface,coordinates,points,samples",
            "points": 60, "near_points": 30, "samples": 25, "band": 2, "padding": 0.2,
            "variants": 1, "turn": "any", "scale_jitter": 0.2, "move_jitter": 0.01, "seed": 7}


def test_models_are_those_of_the_program(models, tmp_path):
    program = os.environ.get("TETVDB_PROGRAM")
    if not program:
        pytest.skip("TETVDB_PROGRAM names no program")
    out = tmp_path / "out"
    subprocess.run([program, "dataset", models, "-o", out, "--no-preview", "--no-pack",
                    "--resolution", "12,20", "--content", SETTINGS["content"], "--points", "60",
                    "--near-points", "30", "--samples", "25", "--band", "2", "--padding", "0.2",
                    "--variants", "1", "--turn", "any", "--scale-jitter", "0.2", "--move-jitter",
                    "0.01", "--seed", "7", "-q"], check=True)
    data = tetvdb.Dataset(models, **SETTINGS)
    assert len(data) == 18
    for i in range(len(data)):
        model = data[i]
        right = np.load(out / (model["name"] + ".npz"))
        assert set(model) == set(right) | {"name", "id", "class", "split"}
        for name in right:
            assert model[name].dtype == right[name].dtype
            assert (model[name] == right[name]).all()
    assert data[0]["class"] == "ball" and data[0]["split"] == "test"


def all_of(batches):
    """Name to the hash of the arrays."""
    found = {}
    for batch in batches:
        for i, name in enumerate(batch.names):
            assert name not in found
            found[name] = b"".join(batch[key][i].tobytes() for key in sorted(batch.keys()))
    return found


def test_batches(models):
    data = tetvdb.Dataset(models, resolution=16, batch_size=4, content="occupancy,coordinates")
    batches = list(data)
    assert [len(batch) for batch in batches] == [4, 4, 1]
    first = batches[0]
    assert first.names == first.ids == ["ball/test/s0", "ball/test/s1", "ball/test/s2", "box/train/b0"]
    assert first.classes == ["ball"] * 3 + ["box"] and first.splits == ["test"] * 3 + ["train"]
    assert first.dense.shape == (4, 16, 16, 16) and first.dense.dtype == np.uint8
    assert first.transform.shape == first.grid.shape == (4, 4, 4)
    assert (first.sparse == np.argwhere(first.dense)).all() and first.sparse.dtype == np.int32
    for i in range(4):
        assert (first["coordinates_16"][i] == first.sparse[first.sparse[:, 0] == i, 1:]).all()
    # The box 4 x 2 x 1 in voxels of 1.1 / 16.
    assert first.dense[3].sum() == 14 * 8 * 4


def test_points(models):
    data = tetvdb.Dataset(models / "box", resolution=8, content="points,samples", points=500,
                          samples=40, batch_size=3)
    (batch,) = data
    inside = (abs(batch.points) < np.array([[[0.5, 0.25, 0.125]], [[0.5, 0.25, 0.25]],
                                             [[0.5, 0.25, 0.375]]])).all(-1)
    assert (batch.occupancy == inside).all()
    assert ((batch.distance < 0) == inside).all()
    assert batch.samples.shape == batch.normals.shape == (3, 40, 3)
    with pytest.raises(KeyError):
        batch.dense


def test_workers_and_order_change_nothing(models):
    expected = all_of(tetvdb.Dataset(models, **SETTINGS))
    names = list(expected)
    for settings in ({"workers": 3}, {"workers": 2, "batch_size": 5, "prefetch": 1},
                     {"threads": 2, "batch_size": 7}):
        data = tetvdb.Dataset(models, **SETTINGS, **settings)
        assert all_of(data) == expected
        assert [n for batch in data for n in batch.names] == names
    shuffled = tetvdb.Dataset(models, **SETTINGS, shuffle=True, workers=2)
    orders = []
    for epoch in (0, 1, 0):
        shuffled.set_epoch(epoch)
        batches = list(shuffled)
        assert all_of(batches) == expected
        orders.append([n for batch in batches for n in batch.names])
    assert orders[0] != orders[1] and orders[0] == orders[2] and orders[0] != names
    shares = [all_of(tetvdb.Dataset(models, **SETTINGS, shard=f"{i}/3")) for i in range(3)]
    assert sum(map(len, shares)) == 18
    assert {**shares[0], **shares[1], **shares[2]} == expected


def test_iteration_that_is_left(models):
    data = tetvdb.Dataset(models, resolution=32, workers=2, prefetch=4)
    for batch in data:
        break
    assert len(list(data)) == 9


def hash_of_all(data):
    return sorted(all_of(data).items())


@pytest.mark.parametrize("method", ["fork", "spawn"])
def test_processes(models, method):
    data = tetvdb.Dataset(models, resolution=16, workers=2)
    expected = hash_of_all(data)
    with multiprocessing.get_context(method).Pool(2) as pool:
        assert pool.map(hash_of_all, [data] * 3) == [expected] * 3
    assert hash_of_all(pickle.loads(pickle.dumps(data))) == expected


def test_models_that_fail(models):
    (models / "bad.obj").write_text("v 0 0 0\nf 1 2 3\n")
    data = tetvdb.Dataset(models, resolution=8, batch_size=4, workers=2)
    with pytest.warns(tetvdb.MeshWarning, match="^bad: "):
        assert sum(map(len, data)) == 9
    assert [name for name, error in data.failures] == ["bad"]
    assert data.failures[0][1].status == 3
    with pytest.raises(tetvdb.Error):
        list(tetvdb.Dataset(models, resolution=8, errors="raise"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert len(list(tetvdb.Dataset(models, resolution=8, errors="ignore"))) == 9
    with pytest.raises(tetvdb.Error):
        next(i for i in range(10) if tetvdb.Dataset(models, resolution=8)[i] is None)


@pytest.mark.parametrize("settings,status", [
    ({"device": "cuda:99"}, 6), ({"device": "tpu"}, 2),
    ({"resolution": 0}, 2), ({"resolution": 1.5}, 2), ({"resolution": [64, 4096]}, 2),
    ({"content": "voxels"}, 2), ({"normalize": "widest"}, 2), ({"padding": -1}, 2),
    ({"shard": "3/3"}, 2), ({"epsilon_range": (0.2, 0.1)}, 2), ({"band": "some"}, 2),
    ({"points": -1}, 2), ({"seed": 0.5}, 2), ({"variants": 1e12}, 2), ({"scale_jitter": 1}, 2)])
def test_settings_that_are_refused(models, settings, status):
    with pytest.raises(tetvdb.Error) as caught:
        tetvdb.Dataset(models, **settings)
    assert caught.value.status == status
    name = next(iter(settings))
    assert (f"`{name}`" in str(caught.value) or f"`{name}={settings[name]}`" in str(caught.value)
            or "shard" in settings)


def test_arguments_that_are_refused(models, tmp_path):
    for settings in ({"batch_size": 0}, {"workers": -1}, {"prefetch": -1}, {"errors": "hide"}):
        with pytest.raises(ValueError):
            tetvdb.Dataset(models, **settings)
    with pytest.raises(tetvdb.Error):
        tetvdb.Dataset(tmp_path / "none")
    with pytest.raises(IndexError):
        tetvdb.Dataset(models)[9]
    with pytest.raises(tetvdb.Error) as caught:
        tetvdb.Dataset(models, resolution=400, content="distance", band=40, max_time=0.01)[8]
    assert caught.value.code == "cancelled"


def test_tensors_share_memory(models):
    torch = pytest.importorskip("torch")
    for batch in tetvdb.Dataset(models, resolution=16, batch_size=3, content="occupancy,distance"):
        voxels = torch.from_dlpack(batch.dense)
        assert voxels.shape == (3, 16, 16, 16) and voxels.dtype == torch.uint8
        assert voxels.data_ptr() == batch["occupancy_16"].__array_interface__["data"][0]
        voxels[0, 0, 0, 0] = 1
        assert batch["occupancy_16"][0, 0, 0, 0]
        distances = torch.from_dlpack(batch["distance_16"])
        assert distances.data_ptr() == batch["distance_16"].__array_interface__["data"][0]
    # And the other way: a tensor is a mesh's array as it is.
    points, faces = map(torch.from_numpy, cube_triangles())
    assert tetvdb.voxelize(points, faces, resolution=4)["density"].active_voxels == 64


@pytest.mark.parametrize("method", ["fork", "spawn"])
@pytest.mark.parametrize("workers", [0, 2])
def test_loaders_of_torch(models, method, workers):
    torch = pytest.importorskip("torch")
    data = tetvdb.Dataset(models, resolution=12, batch_size=2, content="occupancy,points", points=50)
    expected = {data[i]["name"]: data[i]["occupancy_12"] for i in range(len(data))}
    context = method if workers else None
    whole = torch.utils.data.DataLoader(data.torch(), batch_size=None, num_workers=workers,
                                        multiprocessing_context=context)
    found = {}
    for batch in whole:
        assert batch["occupancy_12"].dtype == torch.bool and batch["points"].shape[1:] == (50, 3)
        for i, name in enumerate(batch["names"]):
            assert name not in found
            found[name] = batch["occupancy_12"][i].numpy()
    assert set(found) == set(expected)
    assert all((found[name] == expected[name]).all() for name in found)
    mapped = torch.utils.data.DataLoader(data, batch_size=4, num_workers=workers,
                                         multiprocessing_context=context)
    names = []
    for batch in mapped:
        names += batch["name"]
        assert all((v.numpy() == expected[n]).all() for n, v in zip(batch["name"], batch["occupancy_12"]))
    assert names == list(expected)
