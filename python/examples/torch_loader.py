# SPDX-License-Identifier: Apache-2.0
"""Models as occupancy and signed distances for training, by a loader's workers."""

import numpy as np
import torch

import tetvdb


def tetrahedron(size):
    points = torch.tensor([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]]) * size
    return points, torch.tensor([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])


class Models(torch.utils.data.Dataset):
    def __len__(self):
        return 12

    def __getitem__(self, i):
        points, faces = tetrahedron(1.0 + i)
        volume = tetvdb.voxelize(points, faces, fit=32, padding=2, grid="mask")
        voxels = volume["mask"].to_numpy(box=((0, 0, 0), (31, 31, 31)))
        samples = np.random.default_rng(i).uniform(0, 1 + i, (1000, 3))
        inside, distance = tetvdb.query(points, samples, faces, distance=True)
        return torch.from_numpy(voxels), torch.from_numpy(inside), torch.from_numpy(distance)


if __name__ == "__main__":
    loader = torch.utils.data.DataLoader(Models(), batch_size=4, num_workers=2)
    for voxels, inside, distance in loader:
        print(tuple(voxels.shape), "filled", voxels.float().mean().item(),
              "inside", inside.float().mean().item(), "nearest", distance.abs().min().item())
