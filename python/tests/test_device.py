# SPDX-License-Identifier: Apache-2.0
"""What a GPU makes is what the CPU makes; skipped where there is none."""

import gc

import numpy as np
import pytest

import tetvdb
from conftest import cube_triangles, sphere_triangles
from test_dataset import models  # noqa: F401


def has_device():
    try:
        tetvdb.voxelize(*cube_triangles(), resolution=8, device="cuda")
    except tetvdb.Error as error:
        assert error.status == 6
        return False
    return True


pytestmark = pytest.mark.skipif(not has_device(), reason="there is no GPU")


@pytest.mark.parametrize("grid", ["mask", "density"])
def test_closed_triangles(grid):
    points, faces = sphere_triangles()
    here = tetvdb.voxelize(points, faces, resolution=100, grid=grid, device="cpu")
    there = tetvdb.voxelize(points, faces, resolution=100, grid=grid, device="cuda")
    assert there.report["device"].startswith("cuda:0")
    assert there.hash() == here.hash()


def test_open_triangles():
    points, faces = sphere_triangles()  # the hole of three faces is not plane
    there = tetvdb.voxelize(points, faces[3:], resolution=50, grid="mask", device="cuda")
    assert there.report["device"].startswith("cuda:0")
    here = tetvdb.voxelize(points, faces[3:], resolution=50, grid="mask", device="cpu")
    assert there.hash() == here.hash()


@pytest.mark.filterwarnings("ignore::tetvdb.MeshWarning")
@pytest.mark.parametrize("content", ["occupancy", "occupancy,distance",
                                     "occupancy,distance,surface,coordinates"])
@pytest.mark.parametrize("band", [3, "all"])
@pytest.mark.parametrize("workers", [0, 3])
def test_models_of_a_data_set(models, content, band, workers):
    settings = dict(resolution=[33, 64], content=content, variants=1, turn="any", batch_size=4,
                    move_jitter=0.1, band=band)
    here = list(tetvdb.Dataset(models, **settings))
    there = list(tetvdb.Dataset(models, device="cuda", workers=workers, **settings))
    assert len(here) == len(there)
    for right, made in zip(here, there):
        assert made.names == right.names
        assert set(made.keys()) == set(right.keys())
        assert isinstance(made["occupancy_64"], tetvdb.DeviceTensor)
        assert made.dense.shape == (len(made), 64, 64, 64)
        assert made.dense.device == "cuda:0"
        assert (made.dense.to_numpy() == right.dense).all()
        assert (made.sparse == right.sparse).all()
        for name, array in right.items():
            if name.startswith(("occupancy_", "distance_")):
                assert isinstance(made[name], tetvdb.DeviceTensor)
                assert made[name].dtype == ("float32" if name[0] == "d" else "uint8")
                assert (made[name].to_numpy() == array).all()
            elif isinstance(array, np.ndarray):
                assert (made[name] == array).all()


def test_tensors_of_torch(models):
    torch = pytest.importorskip("torch")
    if not torch.cuda.is_available():
        pytest.skip("PyTorch has no GPU")
    here = [batch.dense for batch in tetvdb.Dataset(models, resolution=48, batch_size=3)]
    stream = torch.cuda.Stream()
    sums = []
    with torch.cuda.stream(stream):
        for batch in tetvdb.Dataset(models, resolution=48, batch_size=3, device="cuda"):
            tensor = torch.from_dlpack(batch.dense)
            assert tensor.is_cuda and tensor.dtype == torch.uint8
            assert tensor.data_ptr() == batch.dense.__cuda_array_interface__["data"][0]
            # Work that is not done when the tensor goes: its memory may not be used again before.
            slow = tensor.float()
            for _ in range(50):
                slow = slow * 1.0
            sums.append((slow + tensor).sum(dtype=torch.float64) / 2)
            del tensor, batch
            gc.collect()
    stream.synchronize()
    assert [int(total) for total in sums] == [int(dense.sum()) for dense in here]
    kept = torch.from_dlpack(next(iter(tetvdb.Dataset(models, resolution=48, device="cuda"))).dense)
    gc.collect()
    assert (kept.cpu().numpy() == here[0][:1]).all()


@pytest.mark.filterwarnings("ignore::tetvdb.MeshWarning")
def test_distances_for_torch(models):
    torch = pytest.importorskip("torch")
    if not torch.cuda.is_available():
        pytest.skip("PyTorch has no GPU")
    settings = dict(resolution=48, content="distance", band=3, batch_size=3)
    for right, made in zip(tetvdb.Dataset(models, **settings),
                           tetvdb.Dataset(models, device="cuda", **settings).torch()):
        tensor = made["distance_48"]
        assert tensor.is_cuda and tensor.dtype == torch.float32
        assert (tensor.cpu().numpy() == right.dense).all()


def test_streams_that_are_refused(models):
    tensor = tetvdb.Dataset(models, resolution=16, device="cuda")[0]["occupancy_16"]
    assert tensor.__dlpack_device__() == (2, 0)
    for stream, error in ((0, ValueError), (-2, ValueError), ("main", TypeError)):
        with pytest.raises(error):
            tensor.__dlpack__(stream=stream)
    for stream in (None, -1, 1, 2):
        assert "dltensor" in repr(tensor.__dlpack__(stream=stream))
    with pytest.raises(ValueError):
        tetvdb.DeviceTensor.stack([])
