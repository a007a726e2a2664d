# SPDX-License-Identifier: Apache-2.0
"""Models as batches of arrays: tetvdb.Dataset."""

from __future__ import annotations

import collections
import random
import sys
import warnings
from typing import Any, Iterator, List, Optional, Sequence, Tuple, Union

from . import _tetvdb


class Batch:
    """Several models' arrays. batch["occupancy_64"] has them one behind the other, (B, ...); of
    arrays whose lengths differ from model to model it is a list.

    names, ids, classes, splits: lists of str. A name is the identifier, with "_v1" of a variant.
    """

    def __init__(self, abouts: Sequence[dict], models: Sequence[dict], resolution: int):
        import numpy

        self.names = [about["name"] for about in abouts]
        self.ids = [about["id"] for about in abouts]
        self.classes = [about["class"] for about in abouts]
        self.splits = [about["split"] for about in abouts]
        self._resolution = resolution
        self._arrays = {}
        for name in models[0]:
            arrays = [model[name] for model in models]
            if isinstance(arrays[0], _tetvdb.DeviceTensor):
                self._arrays[name] = _tetvdb.DeviceTensor.stack(arrays)
                continue
            alike = all(array.shape == arrays[0].shape for array in arrays)
            ragged = "coordinates_" in name or not alike
            self._arrays[name] = arrays if ragged else numpy.stack(arrays)

    def __len__(self) -> int:
        return len(self.names)

    def __getitem__(self, name: str) -> Any:
        return self._arrays[name]

    def __contains__(self, name: str) -> bool:
        return name in self._arrays

    def keys(self):
        return self._arrays.keys()

    def items(self):
        return self._arrays.items()

    def _voxels(self) -> str:
        for kind in ("occupancy", "surface", "distance"):
            if f"{kind}_{self._resolution}" in self._arrays:
                return f"{kind}_{self._resolution}"
        raise KeyError("the data set's content has neither occupancy, surface nor distance")

    @property
    def dense(self) -> Any:
        """(B, N, N, N) of the highest resolution: occupancy as uint8, else surface voxels as uint8,
        else distances as float32. torch.from_dlpack() takes it without a copy. With device="cuda"
        occupancy and distances are a tetvdb.DeviceTensor, in the GPU's memory."""
        array = self._arrays[self._voxels()]
        if isinstance(array, _tetvdb.DeviceTensor):
            return array
        return array.view("uint8") if array.dtype == bool else array

    @property
    def sparse(self) -> Any:
        """int32 (M, 4): the batch's number and x, y, z of all voxels that `dense` has as 1, ascending."""
        import numpy

        array = self._arrays[self._voxels()]
        if isinstance(array, _tetvdb.DeviceTensor):
            array = array.to_numpy()
        if array.dtype == numpy.float32:
            array = array < 0
        return numpy.argwhere(array).astype(numpy.int32)

    @property
    def transform(self) -> Any:
        """(B, 4, 4): from the coordinates of a model's file to those of its arrays."""
        return self._arrays["transform"]

    @property
    def grid(self) -> Any:
        """(B, 4, 4): from the numbers of a voxel of `dense` to the coordinates of points."""
        return self._arrays[f"grid_{self._resolution}"]

    @property
    def points(self) -> Any:
        """(B, P, 3): query points; their answers are `occupancy` and `distance`."""
        return self._arrays["points"]

    @property
    def occupancy(self) -> Any:
        """bool (B, P): whether `points` are inside."""
        return self._arrays["points_occupancy"]

    @property
    def distance(self) -> Any:
        """(B, P): signed distances of `points`, negative inside."""
        return self._arrays["points_distance"]

    @property
    def samples(self) -> Any:
        """(B, S, 3): points of the surface."""
        return self._arrays["samples"]

    @property
    def normals(self) -> Any:
        """(B, S, 3): the surface's normals at `samples`."""
        return self._arrays["normals"]


class Dataset:
    """Models of a folder or a list as batches, made when they are asked for.

        for batch in tetvdb.Dataset("models.csv", resolution=64, batch_size=8, workers=4):
            voxels = torch.from_dlpack(batch.dense)

    Models are the same, bit for bit, as those that `tetvdb dataset` writes with the same settings,
    whatever the order, the workers and the shard.

    manifest: a folder of meshes, or a list as .csv or .jsonl (docs/datasets.md).
    resolution, content, normalize, padding, up, band, points, near_points, near_distance,
        sharp_points, samples, half_floats, variants, turn, scale_jitter, move_jitter,
        epsilon_range (a pair), seed: as the command line has them.
    batch_size: models of a batch; the last one may have fewer.
    shuffle: in another order each epoch (set_epoch()), which `seed` decides.
    shard: "I/N", this process's share, by identifiers; "auto": as Slurm, mpirun or srun says.
    workers: threads that make models ahead; 0: the caller makes each one when it is its turn.
    prefetch: batches that are made ahead where there are workers.
    errors: of a model that cannot be made: "warn" and go on without it, "raise", or "ignore". Those
        that failed are in `failures`, as pairs of name and tetvdb.Error.
    threads: of one model (1). max_time: seconds for one model (300). max_memory: bytes for one.
    device: "cpu", or "cuda" or "cuda:1": models become voxels on that GPU, and occupancy and
        distances of voxels stay in its memory, tetvdb.DeviceTensors in place of arrays. The values
        are the same. A process that was forked once CUDA runs has no GPU: give `workers`, which
        are threads.

    data[i] is one model: a dict of its arrays, "name", "id", "class" and "split". So a DataLoader of
    PyTorch takes the data set as it is (map-style), or torch() as an IterableDataset of whole
    batches. In a DataLoader's worker, forked or spawned, iterating yields that worker's share.
    Pickles as its settings.
    """

    def __init__(self, manifest: Any, *, resolution: Union[int, Sequence[int]] = 64,
                 content: Union[str, Sequence[str]] = "occupancy", batch_size: int = 1,
                 shuffle: bool = False, shard: Optional[str] = None, workers: int = 0,
                 prefetch: int = 2, errors: str = "warn", normalize: Optional[str] = None,
                 padding: Optional[float] = None, up: Optional[str] = None,
                 band: Union[None, float, str] = None, points: Optional[int] = None,
                 near_points: Optional[int] = None, near_distance: Optional[float] = None,
                 sharp_points: Optional[int] = None, samples: Optional[int] = None,
                 half_floats: bool = False, variants: int = 0, turn: Optional[str] = None,
                 scale_jitter: Optional[float] = None, move_jitter: Optional[float] = None,
                 epsilon_range: Optional[Tuple[float, float]] = None, seed: int = 0,
                 device: Optional[str] = None, threads: Optional[int] = None,
                 max_memory: Union[None, int, str] = None, max_time: Optional[float] = None):
        settings = dict(locals())
        for name in ("self", "manifest", "batch_size", "shuffle", "workers", "prefetch", "errors"):
            del settings[name]
        for name, value, least in (("batch_size", batch_size, 1), ("workers", workers, 0),
                                   ("prefetch", prefetch, 0)):
            if value < least:
                raise ValueError(f"{name} is below {least}")
        if errors not in ("warn", "raise", "ignore"):
            raise ValueError(f"errors is '{errors}': give warn, raise or ignore")
        self._state = (manifest, settings, batch_size, shuffle, workers, prefetch, errors)
        self._open()

    def _open(self):
        manifest, settings, *rest = self._state
        self.batch_size, self.shuffle, self.workers, self.prefetch, self.errors = rest
        self.failures: List[Tuple[str, Exception]] = []
        self.epoch = 0
        self._seed = settings["seed"]
        self._items = _tetvdb._DatasetItems(manifest, settings)

    def __getstate__(self):
        return self._state, self.epoch

    def __setstate__(self, state):
        self._state, epoch = state
        self._open()
        self.epoch = epoch

    def __len__(self) -> int:
        """Models of this shard, not batches."""
        return len(self._items)

    def __getitem__(self, number: int) -> dict:
        if number < 0:
            number += len(self)
        about = self._items.about(number)
        model = self._items.make(number)
        model.update((key, about[key]) for key in ("name", "id", "class", "split"))
        return model

    def set_epoch(self, epoch: int) -> None:
        """Which order the next iteration has, where the data set is shuffled."""
        self.epoch = epoch

    def __iter__(self) -> Iterator[Batch]:
        # Only a process in which PyTorch is loaded can be its worker.
        data = sys.modules.get("torch.utils.data")
        worker = data.get_worker_info() if data is not None else None
        if worker is None:
            return self.batches()
        return self.batches(worker.id, worker.num_workers)

    def batches(self, part: int = 0, parts: int = 1) -> Iterator[Batch]:
        """Batches of every `parts`-th model in order, from number `part` on."""
        numbers = list(range(len(self)))
        if self.shuffle:
            random.Random(f"{self._seed}/{self.epoch}").shuffle(numbers)
        abouts, models = [], []
        for number, model in self._made(numbers[part::parts]):
            abouts.append(self._items.about(number))
            models.append(model)
            if len(models) == self.batch_size:
                yield Batch(abouts, models, self._items.resolutions[-1])
                abouts, models = [], []
        if models:
            yield Batch(abouts, models, self._items.resolutions[-1])

    def _made(self, numbers):
        """Numbers and models in this order, without those that fail."""
        if self.workers == 0:
            for number in numbers:
                yield from self._unless_failed(number, lambda: self._items.make(number))
            return
        from concurrent.futures import ThreadPoolExecutor

        ahead = max(self.workers, self.prefetch * self.batch_size)
        waiting = collections.deque()
        pool = ThreadPoolExecutor(self.workers)
        try:
            for number in numbers:
                waiting.append((number, pool.submit(self._items.make, number)))
                if len(waiting) > ahead:
                    first, job = waiting.popleft()
                    yield from self._unless_failed(first, job.result)
            while waiting:
                first, job = waiting.popleft()
                yield from self._unless_failed(first, job.result)
        finally:
            for _, job in waiting:
                job.cancel()
            pool.shutdown()

    def _unless_failed(self, number, make):
        try:
            model = make()
        except _tetvdb.Error as error:
            if self.errors == "raise":
                raise
            name = self._items.about(number)["name"]
            self.failures.append((name, error))
            if self.errors == "warn":
                warnings.warn(f"{name}: {error}", _tetvdb.MeshWarning, stacklevel=4)
            return
        yield number, model

    def torch(self):
        """A torch.utils.data.IterableDataset of dicts of tensors, a batch each, that share memory
        with the arrays; "names", "ids", "classes" and "splits" are lists.

            loader = torch.utils.data.DataLoader(data.torch(), batch_size=None, num_workers=4)
        """
        from ._torch import TensorBatches

        return TensorBatches(self)
