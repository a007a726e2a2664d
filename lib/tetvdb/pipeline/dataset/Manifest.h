// SPDX-License-Identifier: Apache-2.0
//
// The models of a data set, as a folder or a list names them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace tetvdb {

struct DatasetEntry {
  std::string path;      ///< of the mesh file
  std::string id;        ///< unique; folders apart by '/', without "..", not empty
  std::string className; ///< empty: none
  std::string split;     ///< "train", "test", ...; empty: none
};

/// Of a folder: every mesh file in it and below; the identifier is the path within the folder
/// without ending (with it where two files would have the same), the split the first folder on the
/// way whose name is train, test, val, valid or validation in any case, the class the first other
/// one. Of a .csv file (RFC 4180, with a header) or a .jsonl or .ndjson file (an object a line):
/// keys `path` (or `file`, `object_path`), and where they are there `id` (or `object_id`), `class`
/// (or `category`, `label`) and `split`; other keys are passed over. Paths are relative to the
/// list's folder; what a list does not have is made of the path as above.
///
/// Sorted by identifier, so that the order of the list has no influence. Throws Error(Invalid),
/// with the line, for a list that is malformed, an identifier that comes twice or leaves its
/// folder, and where there are no models; Error(Limit) for lists above 1 GiB.
std::vector<DatasetEntry> readManifest(const std::string& path);

/// A number by the identifier alone: tasks share the models by it.
std::uint64_t hashOfId(const std::string& id);

} // namespace tetvdb
