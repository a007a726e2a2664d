# SPDX-License-Identifier: Apache-2.0
"""A mesh of trimesh, with a hole in it, as a solid."""

import trimesh

import tetvdb

mesh = trimesh.creation.icosphere(subdivisions=3)
mesh.update_faces(range(20, len(mesh.faces)))  # no longer watertight

volume = tetvdb.voxelize(mesh, resolution=100, grid=["mask", "surface"])
mask = volume["mask"]
filled = mask.active_voxels * mask.voxel_size[0] ** 3
print(f"volume {filled:.3f}, of the ball 4.189")

# Back into world space, for trimesh or anything else.
matrix = mask.array_transform
grid = trimesh.voxel.VoxelGrid(mask.to_numpy(), transform=matrix)
print("centre of mass", grid.points.mean(axis=0).round(3))
