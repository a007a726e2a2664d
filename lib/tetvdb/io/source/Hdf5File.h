// SPDX-License-Identifier: Apache-2.0
//
// One HDF5 file, for readers that run in a child process (io/source/IsolatedRead.h): the library
// crashes on some damaged files. Links to other files, external storage and plugins are refused.
#pragma once

#include "tetvdb/io/source/Source.h"
#include "tetvdb/mesh/Attribute.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tetvdb {

/// Every `stride`-th of `count` places along each dimension, from `start` on.
struct Slab {
  std::vector<std::uint64_t> start, stride, count;
};

/// Not thread-safe; one process opens files from one thread alone. Paths are those within the file:
/// "/Mesh/geometry". Throws Error(Invalid) with "file:path".
class Hdf5File {
public:
  /// Opens source.path where the source is a mapped file, else the bytes themselves.
  explicit Hdf5File(const Source& source);
  /// Opens the file `path`.
  explicit Hdf5File(const std::string& path);
  ~Hdf5File();
  Hdf5File(Hdf5File&&) noexcept;

  /// Whether there is a dataset or group of that path within the file.
  bool has(const std::string& path) const;
  /// Names of the members of a group, in their alphabetical order; empty where there is no group.
  std::vector<std::string> members(const std::string& group) const;
  /// Lengths of a dataset's dimensions. Throws where there is no dataset.
  std::vector<std::uint64_t> shape(const std::string& dataset) const;
  /// The numbers of a dataset, each of at most 64 bits (widened as mesh/Attribute.h says); with
  /// `slab` those alone, whose dimensions are as many as the dataset's. No dataset may claim more
  /// than the file can hold after decompression.
  Attribute::Values read(const std::string& dataset, const Slab* slab = nullptr) const;
  /// The first object, by its path, that is a link to another file or whose numbers lie in one; ""
  /// where there is none. Looks at every object of the file.
  std::string firstOutside() const;
  /// A text attribute of a group; nothing where there is none.
  std::optional<std::string> text(const std::string& group, const char* attribute) const;
  /// A whole-number attribute of a group: its first number; nothing where there is none.
  std::optional<std::int64_t> integer(const std::string& group, const char* attribute) const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

} // namespace tetvdb
