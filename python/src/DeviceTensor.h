// SPDX-License-Identifier: Apache-2.0
//
// tetvdb.DeviceTensor: voxels in a GPU's memory.
#pragma once

#include <cstddef>
#include <memory>
#include <nanobind/nanobind.h>
#include <vector>

namespace tetvdb::nano {
class DeviceArray;
}

namespace tetvdb::python {

namespace nb = nanobind;

void addDeviceTensor(nb::module_& module);

/// The Python object of an array, in C order, of floats or else of bytes.
nb::object deviceTensor(std::shared_ptr<nano::DeviceArray> array, std::vector<std::size_t> shape,
                        bool floats);

} // namespace tetvdb::python
