// SPDX-License-Identifier: Apache-2.0
//
// The results of the models of a data set: one JSON object a model, in the order in which they end.
#pragma once

#include "tetvdb/core/Error.h"
#include "tetvdb/pipeline/dataset/MakeItem.h"

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace tetvdb {

using DatasetRow = nlohmann::ordered_json;

/// The row of a model that is done. The caller may add "processor_seconds".
DatasetRow successRow(const DatasetItem& item, const ItemResult& result, const Report& report,
                      double seconds);
/// The row of a model that failed; `stage`: the stage in which it failed, empty if that is not
/// known.
DatasetRow failureRow(const DatasetItem& item, Status status, const std::string& error,
                      const std::string& stage, double seconds);

bool isSuccess(const DatasetRow& row);

/// Appends rows to a file, each with one write, so that at most the last line is incomplete if the
/// process dies.
class RowJournal {
public:
  /// Locks the file. Throws Error(Write), also where another process has locked it.
  explicit RowJournal(const std::string& path);
  ~RowJournal();
  RowJournal(const RowJournal&) = delete;
  RowJournal& operator=(const RowJournal&) = delete;

  void append(const DatasetRow& row);

private:
  std::string path_;
  int descriptor_ = -1;
};

/// The rows of all journals in `folder` by the model's name; if a model has several rows, the last
/// row of the last journal. Lines that are no rows, as a process leaves them that dies while it
/// writes, are skipped: their models count as not done.
std::map<std::string, DatasetRow> readRows(const std::string& folder);

} // namespace tetvdb
