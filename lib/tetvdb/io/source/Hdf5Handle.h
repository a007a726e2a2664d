// SPDX-License-Identifier: Apache-2.0
//
// An identifier of the HDF5 library that closes itself. Internal: brings in hdf5.h.
#pragma once

#define H5_USE_110_API // its functions have other parameters from HDF5 1.12 on
#include <hdf5.h>
#include <utility>

namespace tetvdb {

class Hdf5Handle {
public:
  using Close = herr_t (*)(hid_t);
  Hdf5Handle(hid_t id, Close closer) : id_(id), close_(closer) {}
  ~Hdf5Handle() {
    if (id_ >= 0)
      close_(id_);
  }
  Hdf5Handle(Hdf5Handle&& other) noexcept
      : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Hdf5Handle(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(const Hdf5Handle&) = delete;
  Hdf5Handle& operator=(Hdf5Handle&&) = delete;

  hid_t get() const { return id_; }
  explicit operator bool() const { return id_ >= 0; }
  /// Whether all that waits has been written.
  bool close() { return close_(std::exchange(id_, -1)) >= 0; }

private:
  hid_t id_;
  Close close_;
};

} // namespace tetvdb
