// SPDX-License-Identifier: Apache-2.0
//
// An HDF5 file that is whole or absent. Internal: brings in hdf5.h.
#pragma once

#include "tetvdb/core/AtomicFile.h"
#include "tetvdb/core/Error.h"
#include "tetvdb/io/source/Hdf5Handle.h"

#include <cerrno>
#include <cstring>
#include <string>

namespace tetvdb {

/// Has a temporary name until commit(); without commit() the file is removed. For one thread at a
/// time. Throws Error(Write).
class NewHdf5File {
public:
  explicit NewHdf5File(const std::string& path) : atomic_(path), file_(create(atomic_), H5Fclose) {
    check(file_.get());
  }

  hid_t id() const { return file_.get(); }
  /// `id`, or the error where a call of the library failed.
  hid_t check(hid_t id) const {
    if (id < 0)
      fail();
    return id;
  }
  void commit() {
    errno = 0;
    if (!file_.close())
      fail();
    atomic_.commit();
  }
  [[noreturn]] void fail() const {
    throw Error(Status::Write, atomic_.path(),
                std::string("cannot write") +
                    (errno == 0 ? std::string() : std::string(": ") + std::strerror(errno)),
                "free some space or write elsewhere; nothing was left behind");
  }

private:
  // Stops the library from printing errors, and from closing at the program's end what could not be
  // written.
  static hid_t create(AtomicFile& file) {
    H5dont_atexit();
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    H5PLset_loading_state(0);
    errno = 0;
    return H5Fcreate(file.nameForLibraries().c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
  }

  AtomicFile atomic_;
  Hdf5Handle file_;
};

} // namespace tetvdb
