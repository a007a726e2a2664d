# SPDX-License-Identifier: Apache-2.0
"""tetvdb.Dataset for PyTorch's loaders. Imported only on demand."""

import torch

from ._tetvdb import DeviceTensor


def _tensor(array):
    if isinstance(array, list):
        return [_tensor(one) for one in array]
    if isinstance(array, DeviceTensor):
        return torch.from_dlpack(array)
    if array.dtype == bool:  # DLPack of NumPy knows it since 1.25
        return torch.from_dlpack(array.view("uint8")).view(torch.bool)
    return torch.from_dlpack(array)


class TensorBatches(torch.utils.data.IterableDataset):
    """Whole batches; a worker of a loader yields its share of them."""

    def __init__(self, data):
        super().__init__()
        self.data = data

    def __iter__(self):
        for batch in self.data:
            tensors = {name: _tensor(array) for name, array in batch.items()}
            tensors.update(names=batch.names, ids=batch.ids, classes=batch.classes,
                           splits=batch.splits)
            yield tensors
