// SPDX-License-Identifier: Apache-2.0
#include "DeviceTensor.h"

#include "MeshArrays.h"
#include "nanovdb_kernels/DeviceArray.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <string>
#include <utility>

namespace tetvdb::python {
namespace {

// As DLPack and __cuda_array_interface__ number streams.
constexpr std::int64_t kNoStream = -1, kLegacyStream = 1;

class DeviceTensor {
public:
  DeviceTensor(std::shared_ptr<nano::DeviceArray> array, std::vector<std::size_t> shape,
               bool floats)
      : array_(std::move(array)), shape_(std::move(shape)), floats_(floats) {}

  // The bytes are there before this object is; the stream is remembered, so that they stay until
  // its work is done.
  nb::object dlpack(nb::handle stream) const {
    std::int64_t reader = kLegacyStream;
    if (!stream.is_none() && !nb::try_cast(stream, reader))
      throw nb::type_error("stream: give None or an integer, as the DLPack protocol says");
    if (reader == 0 || reader < kNoStream)
      throw nb::value_error("stream: 0 is ambiguous, give 1 for the legacy default stream");
    if (reader != kNoStream)
      array_->readBy(static_cast<std::uint64_t>(reader));
    auto* kept = new std::shared_ptr<nano::DeviceArray>(array_);
    const nb::capsule owner(
        kept, [](void* p) noexcept { delete static_cast<std::shared_ptr<nano::DeviceArray>*>(p); });
    const nb::ndarray<> view(array_->data(), shape_.size(), shape_.data(), owner, nullptr, type(),
                             nb::device::cuda::value, array_->device());
    return nb::cast(view); // without a framework: the capsule
  }
  nb::tuple dlpackDevice() const {
    return nb::make_tuple(int(nb::device::cuda::value), array_->device());
  }

  nb::dict cudaArrayInterface() const {
    array_->readBy(static_cast<std::uint64_t>(kLegacyStream));
    nb::dict about;
    about["version"] = 3;
    about["shape"] = shape();
    about["typestr"] = floats_ ? "<f4" : "|u1";
    about["data"] = nb::make_tuple(reinterpret_cast<std::uintptr_t>(array_->data()), false);
    about["strides"] = nb::none();
    return about;
  }

  nb::object toNumpy() const {
    std::vector<std::uint8_t> bytes(array_->bytes());
    {
      const nb::gil_scoped_release released;
      array_->download(bytes.data());
    }
    return arrayObject(std::move(bytes), shape_, type());
  }

  nb::tuple shape() const {
    nb::list sides;
    for (const std::size_t side : shape_)
      sides.append(side);
    return nb::tuple(sides);
  }
  std::string dtype() const { return floats_ ? "float32" : "uint8"; }
  std::string device() const { return "cuda:" + std::to_string(array_->device()); }

  // Tensors of one shape one behind the other.
  static DeviceTensor stack(const std::vector<DeviceTensor*>& tensors) {
    if (tensors.empty())
      throw nb::value_error("there are no tensors");
    const nano::DeviceArray& first = *tensors.front()->array_;
    for (const DeviceTensor* tensor : tensors)
      if (tensor->shape_ != tensors.front()->shape_ || tensor->floats_ != tensors.front()->floats_)
        throw nb::value_error("the tensors differ in shape or type");
    const nb::gil_scoped_release released;
    auto all = std::make_shared<nano::DeviceArray>(first.device(), first.bytes() * tensors.size());
    for (std::size_t i = 0; i < tensors.size(); ++i)
      all->set(i * first.bytes(), *tensors[i]->array_);
    std::vector<std::size_t> shape{tensors.size()};
    shape.insert(shape.end(), tensors.front()->shape_.begin(), tensors.front()->shape_.end());
    return {std::move(all), std::move(shape), tensors.front()->floats_};
  }

private:
  nb::dlpack::dtype type() const {
    return floats_ ? nb::dtype<float>() : nb::dtype<std::uint8_t>();
  }

  std::shared_ptr<nano::DeviceArray> array_;
  std::vector<std::size_t> shape_;
  bool floats_;
};

} // namespace

void addDeviceTensor(nb::module_& module) {
  nb::class_<DeviceTensor>(
      module, "DeviceTensor",
      "Voxels in a GPU's memory, uint8 or float32, in C order. torch.from_dlpack(tensor) and "
      "cupy.from_dlpack(tensor) take it without a copy; the stream that they give is honoured: the "
      "memory is not used again before the work on it is done.")
      .def(
          "__dlpack__",
          [](const DeviceTensor& self, nb::handle stream, nb::kwargs) {
            return self.dlpack(stream);
          },
          nb::kw_only(), nb::arg("stream") = nb::none(), nb::arg("kwargs"))
      .def("__dlpack_device__", &DeviceTensor::dlpackDevice)
      .def_prop_ro("__cuda_array_interface__", &DeviceTensor::cudaArrayInterface)
      .def("to_numpy", &DeviceTensor::toNumpy, "A copy in host memory.")
      .def_prop_ro("shape", &DeviceTensor::shape)
      .def_prop_ro("dtype", &DeviceTensor::dtype, "\"uint8\" or \"float32\".")
      .def_prop_ro("device", &DeviceTensor::device, "\"cuda:0\" and so on.")
      .def_static("stack", &DeviceTensor::stack, nb::arg("tensors"),
                  "Tensors of one shape as one, with a first dimension more.");
}

nb::object deviceTensor(std::shared_ptr<nano::DeviceArray> array, std::vector<std::size_t> shape,
                        bool floats) {
  return nb::cast(DeviceTensor(std::move(array), std::move(shape), floats));
}

} // namespace tetvdb::python
