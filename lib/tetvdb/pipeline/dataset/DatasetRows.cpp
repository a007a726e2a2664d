// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/DatasetRows.h"

#include "tetvdb/io/source/Source.h"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <string_view>
#include <sys/file.h>
#include <unistd.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

DatasetRow rowOf(const DatasetItem& item, Status status) {
  return {{"name", item.name()},
          {"id", item.entry.id},
          {"variant", item.variant},
          {"class", item.entry.className},
          {"split", item.entry.split},
          {"path", item.entry.path},
          {"status", static_cast<int>(status)}};
}

} // namespace

DatasetRow successRow(const DatasetItem& item, const ItemResult& result, const Report& report,
                      double seconds) {
  DatasetRow row = rowOf(item, report.partial ? Status::Partial : Status::Ok);
  row["file_hash"] = result.fileHash;
  row["faces"] = result.faces;
  row["clean_faces"] = result.cleanFaces;
  row["open_edges"] = result.openEdges;
  row["volume"] = result.volume;
  row["transform"] = result.transform;
  DatasetRow grids = DatasetRow::array();
  for (const ItemGrid& grid : result.grids)
    grids.push_back({{"size", grid.size}, {"occupied", grid.occupied}, {"hash", grid.hash}});
  row["grids"] = std::move(grids);
  row["files"] = result.files;
  DatasetRow codes = DatasetRow::array();
  for (const Warning& warning : report.warnings)
    codes.push_back(warning.code);
  row["warnings"] = std::move(codes);
  std::map<std::string, double> stages;
  for (const Stage& stage : report.stages)
    stages[stage.name] += stage.seconds;
  row["stages"] = stages;
  row["seconds"] = seconds;
  return row;
}

DatasetRow failureRow(const DatasetItem& item, Status status, const std::string& error,
                      const std::string& stage, double seconds) {
  DatasetRow row = rowOf(item, status);
  row["error"] = error;
  row["stage"] = stage;
  row["seconds"] = seconds;
  return row;
}

bool isSuccess(const DatasetRow& row) {
  return row.at("status") == static_cast<int>(Status::Ok) ||
         row.at("status") == static_cast<int>(Status::Partial);
}

RowJournal::RowJournal(const std::string& path) : path_(path) {
  std::error_code error;
  fs::create_directories(fs::path(path).parent_path(), error);
  descriptor_ = ::open(path.c_str(), O_RDWR | O_APPEND | O_CREAT | O_CLOEXEC, 0666);
  if (descriptor_ < 0)
    throw Error(Status::Write, path, std::string("cannot be written: ") + std::strerror(errno));
  // Where files cannot be locked, this is the caller's to ensure.
  if (::flock(descriptor_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
    ::close(descriptor_);
    throw Error(Status::Write, path, "another process makes these models at present",
                "wait until it has ended, or end it");
  }
  // The incomplete line of an earlier process.
  const off_t size = ::lseek(descriptor_, 0, SEEK_END);
  char last = '\n';
  if (size > 0 && ::pread(descriptor_, &last, 1, size - 1) == 1 && last != '\n' &&
      ::write(descriptor_, "\n", 1) != 1)
    throw Error(Status::Write, path, std::string("cannot be written: ") + std::strerror(errno));
}

RowJournal::~RowJournal() {
  ::close(descriptor_);
}

void RowJournal::append(const DatasetRow& row) {
  const std::string line = row.dump(-1, ' ', false, DatasetRow::error_handler_t::replace) + "\n";
  std::string_view left = line;
  while (!left.empty()) {
    const ssize_t some = ::write(descriptor_, left.data(), left.size());
    if (some < 0 && errno == EINTR)
      continue;
    if (some <= 0)
      throw Error(Status::Write, path_, std::string("cannot be written: ") + std::strerror(errno),
                  "free some space and run the command again with `resume`");
    left.remove_prefix(static_cast<std::size_t>(some));
  }
}

std::map<std::string, DatasetRow> readRows(const std::string& folder) {
  std::vector<std::string> journals;
  std::error_code error;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (entry.path().extension() == ".jsonl")
      journals.push_back(entry.path().string());
  std::sort(journals.begin(), journals.end());
  std::map<std::string, DatasetRow> rows;
  for (const std::string& journal : journals) {
    if (fs::file_size(journal, error) == 0)
      continue;
    const MappedFile file(journal);
    std::string_view text = file.bytes();
    while (!text.empty()) {
      const std::size_t end = text.find('\n');
      if (end == text.npos)
        break; // a process died while it wrote this
      DatasetRow row = DatasetRow::parse(text.substr(0, end), nullptr, false);
      text.remove_prefix(end + 1);
      // A part of a line that a later process has ended.
      if (!row.is_object() || !row.contains("name") || !row["name"].is_string() ||
          !row.contains("status") || !row["status"].is_number_integer())
        continue;
      const std::string name = row["name"];
      rows[name] = std::move(row);
    }
  }
  return rows;
}

} // namespace tetvdb
