// SPDX-License-Identifier: Apache-2.0
//
// Files with a header of named fields, after which the numbers of one array follow, or which names
// the file of the numbers. Internal.
#pragma once

#include "tetvdb/core/Progress.h"
#include "tetvdb/io/source/Source.h"
#include "tetvdb/io/volume/arrays/StoredArray.h"

#include <cstdint>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace tetvdb {

/// Methods throw Error(Invalid) for what is damaged or missing.
class HeaderInput {
protected:
  explicit HeaderInput(const Source& source) : source_(source) {}

  [[noreturn]] void fail(const std::string& what, const char* advice = kExport) const {
    throw Error(Status::Invalid, source_.path, what, advice);
  }

  /// The field of the first of these names that there is; null if there is none.
  const std::string* find(std::initializer_list<const char*> names) const;
  const std::string& needed(const char* name) const;

  /// The numbers are in the file of that name, beside this one.
  void useFile(const std::string& name);
  enum class Encoding { Raw, Text, Packed };
  /// Passes the array to the sink. Its numbers begin `skip` bytes from the beginning, unpacked
  /// ones if they are packed (zlib or gzip); below 0: they are the last ones.
  void pass(Encoding encoding, std::int64_t skip, const ArraySink& sink, Progress& progress);

  const Source& source_;
  std::map<std::string, std::string> fields_;
  std::string_view data_; ///< after the header
  StoredArray array_;

private:
  std::string unpacked(std::int64_t skip) const;
  std::string parsed() const;

  std::optional<MappedFile> beside_;
};

} // namespace tetvdb
