# SPDX-License-Identifier: Apache-2.0
"""A field on PyVista's cells as a grid of its own, and back into PyVista as an image."""

import numpy as np
import pyvista

import tetvdb

block = pyvista.ImageData(dimensions=(6, 6, 6)).cast_to_unstructured_grid()
block.point_data["temperature"] = block.points[:, 2] * 10.0

volume = tetvdb.voxelize(block, voxel_size=0.25, grid=["density", "temperature"])
temperature = volume["temperature"]
values = temperature.to_numpy()
print("temperature", values.min(), "to", values.max())

image = pyvista.ImageData(dimensions=values.shape, spacing=temperature.voxel_size,
                          origin=temperature.array_transform[:3, 3])
image.point_data["temperature"] = values.ravel(order="F")
assert np.allclose(image.points[:, 2] * 10.0, image.point_data["temperature"], atol=1e-3)
