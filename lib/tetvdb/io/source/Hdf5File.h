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

/// Every `stride`-th of `count` positions along each dimension, starting at `start`.
struct Slab {
  std::vector<std::uint64_t> start, stride, count;
};

/// Not thread-safe; a process must open files from one thread only. Paths are those within the
/// file: "/Mesh/geometry". Throws Error(Invalid) with "file:path".
class Hdf5File {
public:
  /// Opens source.path if the source is a mapped file, else the bytes themselves.
  explicit Hdf5File(const Source& source);
  /// Opens the file `path`.
  explicit Hdf5File(const std::string& path);
  ~Hdf5File();
  Hdf5File(Hdf5File&&) noexcept;

  /// Whether a dataset or group of that path exists in the file.
  bool has(const std::string& path) const;
  /// Names of the members of a group, in alphabetical order; empty if there is no group.
  std::vector<std::string> members(const std::string& group) const;
  /// Whether `path` is a group of the file.
  bool isGroup(const std::string& path) const;
  /// Bytes of a dataset's integers or floating-point numbers; 0 if it has neither.
  std::size_t numberBytes(const std::string& dataset) const;
  /// Lengths of a dataset's dimensions. Throws if there is no dataset.
  std::vector<std::uint64_t> shape(const std::string& dataset) const;
  /// The numbers of a dataset, each of at most 64 bits (widened as in mesh/Attribute.h); with
  /// `slab` only those, whose dimensions must be as many as the dataset's. Datasets must not be
  /// larger than the file can hold after decompression.
  Attribute::Values read(const std::string& dataset, const Slab* slab = nullptr) const;
  /// The path of the first object that is a link to another file or whose numbers are stored in
  /// one; "" if there is none. Reads every object of the file.
  std::string firstOutside() const;
  /// A text attribute of a group; none if it does not exist.
  std::optional<std::string> text(const std::string& group, const char* attribute) const;
  /// A numeric attribute of a group with `count` numbers, at most 16; empty if there is none.
  std::vector<double> numbers(const std::string& group, const char* attribute,
                              std::size_t count) const;
  /// An integer attribute of a group: its first number; none if it does not exist.
  std::optional<std::int64_t> integer(const std::string& group, const char* attribute) const;

private:
  struct State;
  std::unique_ptr<State> state_;
};

/// A byte of a file.
struct ByteChange {
  std::uint64_t position = 0;
  char value = 0;
};

/// The bytes that differ in the same file with another number in a dataset of one: the number's own
/// and checksums. Needs as much memory as the file; for a child process. Throws Error(Invalid).
std::vector<ByteChange> changesForNumber(const Source& source, const std::string& dataset,
                                         double number);

} // namespace tetvdb
