// SPDX-License-Identifier: Apache-2.0
//
// Finds the models of a data set in a folder or a list.
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
/// keys `path` (or `file`, `object_path`), and optionally `id` (or `object_id`), `class` (or
/// `category`, `label`) and `split`; other keys are ignored. Paths are relative to the list's
/// folder; missing values are taken from the path as above.
///
/// The entries are sorted by identifier, so that the order of the list has no influence. Throws
/// Error(Invalid), with the line, for a list that is malformed, an identifier that occurs twice or
/// leaves its folder, and where there are no models; Error(Limit) for lists above 1 GiB.
std::vector<DatasetEntry> readManifest(const std::string& path);

/// A hash of the identifier, by which models are distributed to tasks.
std::uint64_t hashOfId(const std::string& id);

} // namespace tetvdb
