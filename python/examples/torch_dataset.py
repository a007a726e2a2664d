# SPDX-License-Identifier: Apache-2.0
"""A folder of models as batches for training: tetvdb.Dataset in a loader, and alone."""

import pathlib
import sys
import tempfile

import torch

import tetvdb

BOX = """v 0 0 0
v {0} 0 0
v {0} {1} 0
v 0 {1} 0
v 0 0 {2}
v {0} 0 {2}
v {0} {1} {2}
v 0 {1} {2}
f 1 4 3 2
f 5 6 7 8
f 1 2 6 5
f 2 3 7 6
f 3 4 8 7
f 4 1 5 8
"""


def write_models(folder):
    for split in ("train", "test"):
        for i in range(1, 9):
            path = folder / "box" / split / f"{i}.obj"
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(BOX.format(8, i, 4))


def main(folder):
    # Each worker of the loader makes its share of the batches; tensors share the arrays' memory.
    data = tetvdb.Dataset(folder, resolution=32, content="occupancy,points", points=1000,
                          batch_size=4, shuffle=True, variants=1, turn="any", seed=1)
    loader = torch.utils.data.DataLoader(data.torch(), batch_size=None, num_workers=2)
    for epoch in range(2):
        data.set_epoch(epoch)
        for batch in loader:
            voxels, inside = batch["occupancy_32"].float(), batch["points_occupancy"].float()
            print(epoch, batch["names"][0], tuple(voxels.shape), "filled", voxels.mean().item(),
                  "inside", inside.mean().item())

    # Without a loader: threads make batches ahead.
    for batch in tetvdb.Dataset(folder, resolution=32, batch_size=4, workers=2):
        voxels = torch.from_dlpack(batch.dense)
        coordinates = torch.from_dlpack(batch.sparse)
        assert int(voxels.sum()) == len(coordinates)


if __name__ == "__main__":
    if len(sys.argv) > 1:
        main(sys.argv[1])
    else:
        with tempfile.TemporaryDirectory() as made:
            write_models(pathlib.Path(made))
            main(made)
