// SPDX-License-Identifier: Apache-2.0
#include "tetvdb/pipeline/dataset/Manifest.h"

#include "tetvdb/core/Error.h"
#include "tetvdb/core/Letters.h"
#include "tetvdb/io/Formats.h"
#include "tetvdb/io/MeshFileName.h"
#include "tetvdb/io/source/Source.h"

#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>
#include <string_view>
#include <xxhash.h>

namespace tetvdb {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMaxListBytes = std::size_t(1) << 30;

// The keys of lists for a value, in order of preference.
using Names = std::vector<std::string_view>;
const Names kPath{"path", "file", "object_path"}, kId{"id", "object_id"},
    kClass{"class", "category", "label"}, kSplit{"split"};

using Row = std::map<std::string, std::string>;

// No value: the list does not have the key.
std::optional<std::string> valueOf(const Row& row, const Names& names) {
  for (const std::string_view name : names)
    if (const auto found = row.find(std::string(name)); found != row.end())
      return found->second;
  return std::nullopt;
}

bool isSplit(const std::string& folder) {
  const std::string name = lowerCase(folder);
  constexpr std::array<std::string_view, 5> known{"train", "test", "val", "valid", "validation"};
  return std::find(known.begin(), known.end(), name) != known.end();
}

// Names are files' paths in the output: no part of one may leave the folder or hide.
bool isSafeId(const std::string& id) {
  if (id.empty() || id.size() > 1024 || id.front() == '/' || id.back() == '/')
    return false;
  for (const char c : id)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f || c == '\\')
      return false;
  for (const fs::path& part : fs::path(id))
    if (part == ".." || part == "." || part.empty() || part.string().front() == '.')
      return false;
  return true;
}

// A list's rows, with the line that each begins in.
struct ListRow {
  Row values;
  std::size_t line = 0;
};

class CsvReader {
public:
  CsvReader(std::string_view text, const std::string& path) : text_(text), path_(path) {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF")
      at_ = 3;
  }

  std::vector<ListRow> read() {
    std::vector<std::string> header;
    std::vector<ListRow> rows;
    while (at_ < text_.size()) {
      const std::size_t line = line_;
      const std::vector<std::string> fields = record();
      if (fields.size() == 1 && fields[0].empty())
        continue;
      if (header.empty()) {
        for (const std::string& field : fields)
          header.push_back(lowerCase(trimmed(field)));
        continue;
      }
      if (fields.size() != header.size())
        throw Error(Status::Invalid, path_,
                    "line " + std::to_string(line) + " has " + std::to_string(fields.size()) +
                        " fields, the header " + std::to_string(header.size()));
      ListRow row;
      row.line = line;
      for (std::size_t i = 0; i < fields.size(); ++i)
        row.values.emplace(header[i], fields[i]);
      rows.push_back(std::move(row));
    }
    return rows;
  }

private:
  std::vector<std::string> record() {
    std::vector<std::string> fields(1);
    while (at_ < text_.size()) {
      const char c = text_[at_++];
      if (c == '"' && fields.back().empty()) {
        quoted(fields.back());
      } else if (c == ',') {
        fields.emplace_back();
      } else if (c == '\n') {
        ++line_;
        break;
      } else if (c != '\r') {
        fields.back() += c;
      }
    }
    return fields;
  }

  void quoted(std::string& field) {
    const std::size_t line = line_;
    while (at_ < text_.size()) {
      const char c = text_[at_++];
      if (c == '"' && (at_ >= text_.size() || text_[at_] != '"'))
        return;
      at_ += c == '"';
      line_ += c == '\n';
      field += c;
    }
    throw Error(Status::Invalid, path_, "line " + std::to_string(line) + ": a quote has no end");
  }

  std::string_view text_;
  const std::string& path_;
  std::size_t at_ = 0, line_ = 1;
};

std::vector<ListRow> readJsonLines(std::string_view text, const std::string& path) {
  std::vector<ListRow> rows;
  std::size_t line = 0;
  while (!text.empty()) {
    ++line;
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view one = trimmed(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    if (one.empty())
      continue;
    const nlohmann::json object = nlohmann::json::parse(one, nullptr, false);
    if (!object.is_object())
      throw Error(Status::Invalid, path, "line " + std::to_string(line) + " is no JSON object");
    ListRow row;
    row.line = line;
    for (const auto& [key, value] : object.items())
      if (value.is_string() || value.is_number())
        row.values[lowerCase(key)] = value.is_string() ? value.get<std::string>() : value.dump();
    rows.push_back(std::move(row));
  }
  return rows;
}

// Path within the folder, ending apart.
struct NamedFile {
  std::string path, stem, ending;
};

std::vector<DatasetEntry> entriesOf(const std::vector<NamedFile>& files) {
  std::map<std::string, std::size_t> uses;
  for (const NamedFile& file : files)
    ++uses[file.stem];
  std::vector<DatasetEntry> entries;
  for (const NamedFile& file : files) {
    DatasetEntry entry;
    entry.path = file.path;
    entry.id = uses[file.stem] > 1 ? file.stem + "_" + file.ending.substr(1) : file.stem;
    for (const fs::path& part : fs::path(file.stem).parent_path()) {
      if (entry.split.empty() && isSplit(part.string()))
        entry.split = lowerCase(part.string());
      else if (entry.className.empty() && !isSplit(part.string()))
        entry.className = part.string();
    }
    entries.push_back(std::move(entry));
  }
  return entries;
}

NamedFile namedFile(const fs::path& path, const fs::path& within) {
  const std::string ending = path.extension().string();
  fs::path stem = within;
  return {path.string(), stem.replace_extension().generic_string(),
          ending.size() > 1 ? lowerCase(ending) : "._"};
}

std::vector<DatasetEntry> readFolder(const std::string& folder) {
  std::vector<NamedFile> files;
  std::error_code error;
  for (const auto& entry : fs::recursive_directory_iterator(
           folder, fs::directory_options::skip_permission_denied, error))
    if (entry.is_regular_file(error) && isMeshFileName(entry.path().string()))
      files.push_back(namedFile(entry.path(), entry.path().lexically_relative(folder)));
  std::sort(files.begin(), files.end(),
            [](const NamedFile& a, const NamedFile& b) { return a.path < b.path; });
  return entriesOf(files);
}

std::vector<DatasetEntry> readList(const std::string& path) {
  const MappedFile file(path);
  if (file.bytes().size() > kMaxListBytes)
    throw Error(Status::Limit, path, "the list has more than 1 GiB", "split it");
  const std::string ending = endingOf(path);
  const std::vector<ListRow> rows =
      ending == ".csv" ? CsvReader(file.bytes(), path).read() : readJsonLines(file.bytes(), path);
  const fs::path folder = fs::path(path).parent_path();
  std::vector<NamedFile> files;
  for (const ListRow& row : rows) {
    const std::string name = valueOf(row.values, kPath).value_or("");
    if (name.empty())
      throw Error(Status::Invalid, path, "line " + std::to_string(row.line) + " names no file",
                  "give each model a 'path'");
    const fs::path given(name);
    const fs::path within = given.is_absolute() ? given.relative_path() : given.lexically_normal();
    files.push_back(namedFile(given.is_absolute() ? given : folder / given, within));
  }
  std::vector<DatasetEntry> entries = entriesOf(files);
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row& values = rows[i].values;
    entries[i].id = valueOf(values, kId).value_or(entries[i].id);
    entries[i].className = valueOf(values, kClass).value_or(entries[i].className);
    entries[i].split = valueOf(values, kSplit).value_or(entries[i].split);
    const std::string* names[] = {&entries[i].id, &entries[i].className, &entries[i].split};
    for (const std::string* one : names)
      if (const std::string& name = *one; !isSafeId(name) && (!name.empty() || one == names[0]))
        throw Error(Status::Invalid, path,
                    "line " + std::to_string(rows[i].line) + ": '" + name +
                        "' cannot name a file of the data set",
                    "use letters, digits, '_', '-' and '/'");
  }
  return entries;
}

} // namespace

std::vector<DatasetEntry> readManifest(const std::string& path) {
  std::error_code error;
  std::vector<DatasetEntry> entries;
  if (fs::is_directory(path, error)) {
    entries = readFolder(path);
    if (entries.empty())
      throw Error(Status::Invalid, path, "holds no mesh files",
                  "name a folder with files that end in " + endingList(FormatUse::ReadMesh));
  } else {
    const std::string ending = endingOf(path);
    if (ending != ".csv" && ending != ".jsonl" && ending != ".ndjson")
      throw Error(Status::Usage, path, "is neither a folder nor a list of models",
                  "name a folder, or a .csv or .jsonl file with a 'path' for each model");
    entries = readList(path);
    if (entries.empty())
      throw Error(Status::Invalid, path, "lists no models");
  }
  std::sort(entries.begin(), entries.end(),
            [](const DatasetEntry& a, const DatasetEntry& b) { return a.id < b.id; });
  for (std::size_t i = 1; i < entries.size(); ++i)
    if (entries[i].id == entries[i - 1].id)
      throw Error(Status::Invalid, path,
                  "has two models with the identifier '" + entries[i].id + "'",
                  "give each an 'id' of its own");
  return entries;
}

std::uint64_t hashOfId(const std::string& id) {
  return XXH3_64bits(id.data(), id.size());
}

} // namespace tetvdb
